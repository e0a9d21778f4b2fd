"""Where a maximum of velocity lies between frames: a polynomial for each, and how far that may be off.

Where all beads are recorded, the equation of motion gives acceleration and its rate at each frame; velocity and its
first two derivatives at the two frames around a maximum fix a polynomial of degree five, and with displacement one of
degree six. Where only some beads are recorded, that degree comes from displacement and velocity at four frames. What a
polynomial of a lower degree gives instead shows how uncertain that is; `kinks` adds what no polynomial follows. Where
the slope of a polynomial may be negative, but is not for certain, there may be a maximum before the next one
(`crossings`); such brackets are not certain, and extend the errors of the maximum that follows.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from analysis import hermite, motion
from analysis.columns import Columns
from analysis.tracking import crossings
from analysis.tracking.kinks import SAMPLES, kinks
from analysis.trajectory import Flags, Floats, Integers, Trajectory
from lammps_inputs import physics
from lammps_inputs.limits import rates
from lammps_inputs.loads import Load, Motion
from lammps_inputs.system import System

FAR_APART = {"verlet": (2.7, 1.0 / 3.0), "suzuki4": (2.0, 2.0 / 3.0)}
"""Time between frames from which on displacements improve a polynomial, by scheme of LAMMPS: a factor on a power of
the time of a cycle, all in the time scale of the fastest motion. Nearer together they may harm: velocity Verlet's
velocities differ from the slope of its displacements by ``timestep**2 / 6`` times the jerk.

Measured in chains, coupled ones, dimers and chains under a load, at steps from 0.003 to 0.05: errors of arrivals by
displacements are some ``0.9 timestep**2 / spacing`` with velocity Verlet and ``0.06 cycle**4 / spacing`` with Suzuki's
scheme, those by velocities alone some ``1e-3 spacing**5``.
"""

FARTHEST_APART = 0.5
"""Time between frames, in units of T or of the fastest motion's time scale if that is longer, from which on
displacements are used at any time step: where that is so long that they harm, the error of the run is larger.
"""

NEAR = 0.2
"""Time between frames, in the time scale of the fastest motion, up to which displacements do not help: the reference's
velocities differ from the slope of its displacements by some ``1e-9`` V, and arrivals by ``2e-8 / spacing``.
"""

QUICK = 0.5
"""Time between frames, in the time scale of the fastest motion, from which on that is short."""

DISTINCT = 0.25
"""Change of a polynomial by displacements, over the one that velocity Verlet makes, below which both are distinct."""

AGREEING = 0.25
"""Share of the bound of a polynomial by velocities that is left where displacements agree with it."""

FREQUENCY = 2.5
"""Largest angular frequency of a Hertz chain without load after a kick of V, in units of 1 / T."""

FLOOR = 1e-9
"""Error that rounding and bisection leave, in the wave's own time and in V."""

ROUNDING = 1e-12
"""Slopes below this, in V per frame, may be rounding."""

HARDENING = 2.0
"""Exponent of contacts above which waves are clearly shorter in time than Hertz's."""

NODES = (0, 1, 2, 3)
"""Frames that fix a maximum where only some beads are recorded."""

_POWERS = 7

_SAMPLES = 9


@dataclass(frozen=True)
class Brackets(Columns):
    """Maxima between frames: a polynomial of velocity for each, and the pieces of it where the maximum lies.

    Those that may not exist are there, too; they are `certain` where the slope becomes negative for certain.
    """

    chain: Integers
    bead: Integers
    origin: Floats
    spacing: Floats
    slowness: Floats
    """See `slowness_of`."""
    places: Floats
    """Where the slope may fall to zero first, where that of the polynomial does, and where it has fallen for certain:
    lower and upper end of each, [place, end, maximum] in s = (time - origin) / spacing."""
    certain: Flags
    pressing: Floats
    """See `analysis.motion.pressing`."""
    displacement: Floats
    """Displacement at the origin, [maximum] in units of L."""
    velocity: Floats
    """[power, maximum] in s."""
    off: Floats
    """How far ``velocity`` and its slope may be off, [0 or 1, maximum]."""
    forces_known: Flags
    """Whether frames determine the forces on all beads."""
    direction: int
    """1 where velocities are towards higher bead numbers, -1 towards lower ones."""

    def first_certain(self) -> Flags:
        """Mask, [maximum], of those of each bead up to the first one that is certain."""
        order = np.lexsort((self.origin + self.places[1, 0] * self.spacing, self.bead, self.chain))
        certain = self.certain[order].astype(np.int64)
        number = np.cumsum(certain) - certain
        chain, bead = self.chain[order], self.bead[order]
        new = np.ones(len(order), dtype=bool)
        new[1:] = (chain[1:] != chain[:-1]) | (bead[1:] != bead[:-1])
        at_first = np.maximum.accumulate(np.where(new, number, -1))
        chosen = np.zeros(len(order), dtype=bool)
        chosen[order[number == at_first]] = True
        return chosen


def no_maxima(direction: int) -> Brackets:
    """Brackets of no maximum, to which others are added."""
    integers, values, polynomial = np.zeros(0, dtype=np.int64), np.zeros(0), np.zeros((_POWERS, 0))
    pairs, mask = np.zeros((2, 0)), np.zeros(0, dtype=bool)
    places = np.zeros((3, 2, 0))
    return Brackets(
        integers, integers, values, values, values, places, mask, values, values, polynomial, pairs, mask, direction
    )


class _Fit(NamedTuple):
    """Polynomials of velocity between frames, [..., entry], see `Brackets`."""

    start: Integers
    """Position of the frame at s = 0."""
    chain: Integers
    bead: Integers
    """Position of the bead, from 0, as of the chain."""
    direction: int
    velocity: Floats
    off: Floats
    displacement: Floats
    slope: Floats
    """Slopes at the first two frames, per frame, [0 or 1, entry]; NaN where frames do not determine the forces."""


def _fitted(
    block: Trajectory, start: Integers, chain: Integers, bead: Integers, direction: int, low: Floats, high: Floats
) -> _Fit:
    """Polynomials of velocities of beads through frames from a first one on, whose errors are those from low to high.

    Args:
        block: frames.
        start, chain, bead: [entry] positions in the block.
        direction: 1 for velocities towards higher bead numbers, else -1.
        low, high: [entry] in units of the spacing, from the first frame on.
    """
    spacing, system, by_equations = block.spacing, block.problem.system, block.forces_known
    nodes = (0, 1) if by_equations else NODES[: block.frames]
    data = direction * np.array(
        [_states(block, start + node, chain, bead, by_equations=by_equations) for node in nodes]
    )
    timing = _Timing.of(block)
    acted_on, pushes = np.zeros(len(start), dtype=bool), np.zeros((2, len(start)))
    for load in system.loads:
        loaded = (chain == load.chain - 1) & (block.beads[bead] == load.bead)
        acted_on |= loaded
        if np.any(loaded):
            times = block.time[start[loaded]] + spacing * np.array(nodes)[:, None]
            pushes[:, loaded] += _pushed(
                load, times, partial(_best, timing, nodes), low[loaded], high[loaded]
            ) / physics.mass_of(system, chain[loaded], block.beads[bead[loaded]] - 1)
    velocity, doubts = _polynomials(timing, nodes, data, acted_on)
    off = pushes
    for doubt in doubts:
        off += np.array([_largest(doubt, low, high), _largest(hermite.derivative(doubt), low, high)])
    if by_equations:
        off += kinks(block, start, chain, bead)
    slope = spacing * data[:, 2] if by_equations else np.full((2, len(start)), np.nan)
    return _Fit(start, chain, bead, direction, velocity, off, data[0, 0], slope)


def bracketed(block: Trajectory, frame: Integers, chain: Integers, bead: Integers, direction: int) -> Brackets:
    """Brackets of maxima at beads and largest frames, [maximum] positions in a block, of recorded beads alone.

    A maximum at frame 0 stays there unless the bead is pushed or driven.
    """
    start = np.clip(frame - 1, 0, block.frames - len(NODES[: block.frames]))
    low = np.maximum(frame - start - 1.0, 0.0)
    outside: tuple[Load | Motion, ...] = (*block.problem.system.loads, *block.problem.system.motions)
    acted_on = np.zeros(len(frame), dtype=bool)
    for load in outside:
        acted_on |= (chain == load.chain - 1) & (block.beads[bead] == load.bead)
    fit = _fitted(block, start, chain, bead, direction, low, low + 2.0)
    ends = np.stack([low, np.where(frame == 0, low + acted_on, low + 2.0)])
    rows = np.arange(len(frame))
    return _rows(block, fit, rows, np.stack([ends] * 3), np.ones(len(frame), dtype=bool), frame)


def between_pairs(
    block: Trajectory, start: Integers, chain: Integers, bead: Integers, direction: int, threshold: float
) -> Brackets:
    """Brackets of maxima between a frame and the next, [pair] positions in a block whose frames determine the forces.

    A bead that is slower for certain after frame 0, before it is faster, has a maximum there.

    Args:
        block: frames.
        start, chain, bead: [pair] positions of the first of two frames, and of beads.
        direction: 1 for velocities towards higher bead numbers, else -1.
        threshold: smallest maximum, in units of V.
    """
    fit = _fitted(block, start, chain, bead, direction, np.zeros(len(start)), np.ones(len(start)))
    along = hermite.derivative(fit.velocity)
    sampled = np.linspace(0.0, 1.0, crossings.SAMPLES)
    slope = np.array([hermite.value(along, np.full(len(start), s)) for s in sampled.tolist()])
    slope[[0, -1]] = fit.slope
    error = fit.off[1] + ROUNDING
    begins = np.flatnonzero((start == 0) & (fit.velocity[0] > threshold))
    slope[:, begins], largest, perhaps = crossings.starts(slope[:, begins], error[begins], fit.velocity[2, begins])
    begins, largest = begins[largest | perhaps], largest[largest | perhaps]
    at_start, at_end = (
        direction * block.velocity[np.minimum(start + n, block.frames - 1), chain, bead] for n in (0, 1)
    )
    change = at_end - at_start
    entry, early, late, certain = crossings.falls(slope, error, change)
    places = np.arange(crossings.SAMPLES - 1)[:, np.newaxis]
    within = (places >= early - 1) & (places < late)
    zero = within & (slope[:-1, entry] > 0.0) & (slope[1:, entry] <= 0.0)
    rise = np.cumsum(slope[:-1], axis=0)[:, entry]
    at = np.where(certain, np.where(zero, rise, -np.inf).argmax(axis=0), early - 1)  # the highest in between
    ends = np.array([[sampled[place], sampled[place + 1]] for place in (early - 1, at, late - 1)])
    highest, doubt = hermite.value(fit.velocity[:, entry], ends[1, 1]), fit.off[0, entry]
    fast = (highest > crossings.FAINT * threshold) & (highest + doubt > threshold)
    certain &= np.maximum(highest - doubt, np.maximum(at_start, at_end)[entry]) > threshold
    entry, certain = np.concatenate([begins, entry[fast]]), np.concatenate([largest, certain[fast]])
    ends = np.concatenate([np.zeros((3, 2, len(begins))), ends[..., fast]], axis=-1)
    return _rows(block, fit, entry, ends, certain, start + (change > 0.0))


def _rows(block: Trajectory, fit: _Fit, entry: Integers, places: Floats, certain: Flags, frame: Integers) -> Brackets:
    """Brackets at positions among the polynomials; frames are those of the contacts, [polynomial]."""
    chain, bead = fit.chain[entry], fit.bead[entry]
    return Brackets(
        chain=chain + 1,
        bead=block.beads[bead],
        origin=block.time[fit.start[entry]],
        spacing=np.full(len(entry), block.spacing),
        slowness=np.full(len(entry), slowness_of(block.problem.system)),
        places=places,
        certain=certain,
        pressing=motion.pressing(block, frame[entry], chain, bead),
        displacement=fit.displacement[entry],
        velocity=fit.velocity[:, entry],
        off=fit.off[:, entry],
        forces_known=np.full(len(entry), block.forces_known),
        direction=fit.direction,
    )


def _states(
    block: Trajectory, frame: Integers, chain: Integers, bead: Integers, *, by_equations: bool
) -> tuple[Floats, ...]:
    """Displacement and its derivatives at chosen positions: three where the equation of motion gives them, else one."""
    state = block.displacement[frame, chain, bead], block.velocity[frame, chain, bead]
    return (*state, *motion.acceleration_and_rate(block, frame, chain, bead)) if by_equations else state


def _pushed(load: Load, times: Floats, fit: Callable[[Floats], Floats], low: Floats, high: Floats) -> Floats:
    """Errors of a fit to the motion of a bead of mass 1 by a force alone, as `Brackets.off`.

    Times are [node, maximum].
    """
    states = [load.travel(times), load.impulse(times), load.force(times), load.rate(times)]
    velocity = fit(np.stack(states, axis=1))
    slope, spacing = hermite.derivative(velocity), times[1] - times[0]
    worst = np.zeros((2, len(low)))
    for share in np.linspace(0.0, 1.0, SAMPLES):
        s = low + share * (high - low)
        time = times[0] + s * spacing
        worst[0] = np.fmax(worst[0], np.abs(hermite.value(velocity, s) - load.impulse(time)))
        worst[1] = np.fmax(worst[1], np.abs(hermite.value(slope, s) - load.force(time) * spacing))
    return worst


@physics.once
def quickness_of(system: System) -> float:
    """Rate of a system's fastest motion over that of a Hertz chain without load; 1 where nothing moves."""
    return max(rates.fastest(system), rates.drag(system), rates.bending(system)) / FREQUENCY or 1.0


def slowness_of(system: System) -> float:
    """Rate of a system's fastest motion over that of a Hertz chain without load where it is slower, else 1."""
    return min(1.0, quickness_of(system))


@dataclass(frozen=True)
class _Timing:
    """Times between frames and time steps, and what they say of polynomials; in units of T.

    Attributes:
        spacing: time between frames.
        quick: that in the time scale of the system's fastest motion, see `FREQUENCY`.
        step: Verlet step.
        far_apart: time between frames from which on displacements are taken as they are.
        by_equations: whether frames determine the forces on all beads.
        damped: whether contacts have dashpots.
        hard: whether contacts harden fast, see `HARDENING`.
    """

    spacing: float
    quick: float
    step: float
    far_apart: float
    by_equations: bool
    damped: bool
    hard: bool

    @classmethod
    def of(cls, block: Trajectory) -> "_Timing":
        problem, by_equations = block.problem, block.forces_known
        system = problem.system
        quickness = quickness_of(system) if by_equations else 1.0
        factor, power = FAR_APART[problem.scheme]
        far_apart = max(NEAR, factor * (problem.cycle * problem.timestep * quickness) ** power) / quickness
        return cls(
            block.spacing,
            block.spacing * quickness,
            problem.timestep if problem.scheme == "verlet" else 0.0,
            min(FARTHEST_APART / slowness_of(system), far_apart),
            by_equations,
            physics.contact_loss(system) is not None,
            (physics.exponent(system) or 1.5) > HARDENING,
        )

    @property
    def share(self) -> float:
        """Bound on the error of a polynomial in what another one differs, as measured on runs of known peaks.

        A polynomial of degree five is off by the sixth derivative of velocity, and one of degree three differs from it
        by the fourth. Their ratio is ``(omega * spacing)**2 / 120`` in an oscillation, but has no bound where several
        frequencies add up. Where the fastest motion is short compared with the time between frames, the polynomial of
        degree six, which has the sixth derivative, is the other one.

        Measured at couplings from 0.1 to 2 and times between frames from 0.1 to 2, with all beads and with a few; the
        errors are a third of the bound or less where frames are up to 1 T apart. With a few beads nothing shows
        contacts that close or open between frames; there the whole of the bound is needed where frames are 0.1 T apart,
        and also farther apart where dashpots jump then. Contacts that harden fast have shorter waves. In damped chains
        motion is of more than one rate: of 5,800 maxima at times between frames from 0.05 to 0.5, a few were off by up
        to 1.9 times the bound of the others, and 2.6 times at 0.5; it is doubled there, and tripled. Far apart, errors
        grow with the square of the frequency: in dimers at 1 T, up to 0.36 times what the other polynomial differs.
        """
        if not self.by_equations:
            return 3.0 if self.damped else 0.3
        if self.spacing >= self.far_apart:
            return (3.0 if self.damped else 1.0) * (0.25 if self.hard else 0.1) * max(1.0, self.quick**2)
        near = (
            1.25
            if self.quick >= QUICK
            else max(0.2 * min(self.spacing, self.quick) ** 2, (FREQUENCY * self.quick) ** 2 / 100.0)
        )
        return (2.0 if self.damped else 1.0) * near


def _best(timing: _Timing, nodes: tuple[int, ...], data: Floats) -> Floats:
    """Velocities as polynomials [power, entry] of displacement and its derivatives [node, derivative, entry].

    By equations these are three, of which displacement is left out where frames are not far apart; else one.
    """
    derivatives = 4 if timing.by_equations else 2
    if timing.by_equations and timing.spacing < timing.far_apart:
        return _padded(hermite.coefficients(nodes, data[:, 1:derivatives], timing.spacing))
    both = hermite.coefficients(nodes, data[:, :derivatives], timing.spacing)
    return _padded(hermite.derivative(both) / timing.spacing)


def _polynomials(
    timing: _Timing, nodes: tuple[int, ...], data: Floats, acted_on: Flags
) -> tuple[Floats, tuple[Floats, ...]]:
    """Velocity as a polynomial, and terms of how far that may be off, each [power, entry].

    Where frames are not far apart, displacements are used only if they tell velocities that are slopes of displacements
    from those of velocity Verlet, and change the polynomial by less than its error.

    Args:
        timing: times between frames.
        nodes: frames.
        data: [node, derivative of the displacement, entry].
        acted_on: [entry] whether a force from outside acts on the bead.
    """
    spacing, best = timing.spacing, _best(timing, nodes, data)
    by_velocity = _padded(hermite.coefficients(nodes, data[:, 1:], spacing))
    doubt = timing.share * (by_velocity - best)
    if not timing.by_equations:
        return best, (doubt,)
    degree_three = _padded(hermite.coefficients(nodes, data[:, 1:3], spacing))
    if spacing >= timing.far_apart:
        by_chance = 0.3 * (FREQUENCY * timing.quick / 10.0) ** 4 * (degree_three - by_velocity)
        return best, (doubt, by_chance)  # that both polynomials agree by chance
    if timing.quick < NEAR:
        return best, (timing.share * (degree_three - best),)
    shifted = data.copy()
    shifted[1, 0] += timing.step**2 / 6.0 * (data[1, 2] - data[0, 2])
    change, after_shift = (
        _padded(hermite.derivative(hermite.coefficients(nodes, states, spacing)) / spacing) - best
        for states in (data, shifted)
    )
    scheme = np.abs(after_shift[3] - change[3])
    nearer = np.abs(change[3]) <= np.abs(after_shift[3])
    change, farther = np.where(nearer, change, after_shift), np.where(nearer, after_shift, change)
    doubt = timing.share * (farther if timing.quick >= QUICK else degree_three - best)
    ends = np.zeros_like(scheme), np.ones_like(scheme)
    bound = _largest(doubt, *ends) + on_a_grid(spacing, 1.0)[1]
    agree = ~acted_on & (np.abs(change[3]) < DISTINCT * scheme) & (_largest(change, *ends) <= bound)
    return best + np.where(agree, change, 0.0), (np.where(agree, AGREEING, 1.0) * doubt,)


def _padded(polynomials: Floats) -> Floats:
    missing = _POWERS - len(polynomials)
    return np.concatenate([polynomials, np.zeros((missing, *polynomials.shape[1:]))])


def _largest(polynomials: Floats, low: Floats, high: Floats) -> Floats:
    """Largest size of polynomials [power, entry] from low to high, [entry], by some samples."""
    shares = np.linspace(0.0, 1.0, _SAMPLES)
    sizes = [np.abs(hermite.value(polynomials, low + c * (high - low))) for c in shares]
    return np.asarray(np.max(sizes, axis=0))


def places_of(brackets: Brackets) -> tuple[Floats, Floats, Floats]:
    """Earliest place, place, and latest place of each maximum in its bracket, each [maximum] in s."""
    slope, error = hermite.derivative(brackets.velocity), brackets.off[1]
    early, at, late = brackets.places
    zero = hermite.falling_zero(slope, *at)
    # of recorded beads alone, there may be several between frames far apart; none that is lower than a frame is taken
    frames = at[0], np.minimum(at[0] + 1.0, at[1])
    at_low, at_next = (hermite.value(brackets.velocity, frame) for frame in frames)
    lower = ~brackets.forces_known & (hermite.value(brackets.velocity, zero) < np.maximum(at_low, at_next) - FLOOR)
    zero = np.where(lower, np.where(at_low >= at_next, *frames), zero)
    above, below = slope.copy(), slope.copy()
    above[0] -= error
    below[0] += error
    first = hermite.falling_zero(above, early[0], np.minimum(early[1], zero))
    return first, zero, hermite.falling_zero(below, np.maximum(late[0], zero), late[1])


def on_a_grid(every: Floats | float, peak_velocity: Floats | float, *, all_recorded: bool = True) -> tuple[Any, Any]:
    """Bounds on the errors of arrival (T) and peak velocity (V) of an exact wave in frames ``every`` T, all [...].

    Measured for peak velocities from 0.05 to 1 and times between frames up to 1. They fall as ``every**5`` or faster:
    in arrival at 0.1, 4e-8; at 1, 4e-3.
    """
    frames = every * peak_velocity**0.2  # in the wave's own time
    if all_recorded:
        far = np.asarray(every) >= FARTHEST_APART
        arrival = np.where(far, 6e-4, 4e-3) * frames**5
        relative = np.where(far, 2e-4, 2.5e-3) * frames**6
    else:
        arrival, relative = 4e-2 * frames**6, 1e-2 * frames**6
    return (FLOOR + arrival) / peak_velocity**0.2, FLOOR + relative * peak_velocity
