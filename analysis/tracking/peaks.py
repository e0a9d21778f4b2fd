"""Every passage of a compressive pulse at a bead: a maximum over time of its velocity, found between the frames.

Where all beads are recorded, the equation of motion gives acceleration and its rate at each frame; velocity and its
first two derivatives at the two frames around a maximum fix a polynomial of degree five, and with displacement one of
degree six. Where only some beads are recorded, that degree comes from displacement and velocity at four frames; where
the record is noisy, degree three from velocity alone. What a polynomial of a lower degree says instead tells how sure
that is. Reads a run block by block, so its memory does not grow with the number of frames; nothing depends on where the
blocks begin.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analysis import hermite, motion
from analysis.mirror import direction_of, mirrored_bead
from analysis.shape.exact_wave import solitary_wave
from analysis.trajectory import Floats, Trajectory, joined
from lammps_inputs import Problem

Integers = NDArray[np.int64]

THRESHOLD = 1e-3
"""Smallest maximum that counts as a pulse, in units of V."""

FAR_APART = 0.5
"""Time between frames from which on displacements help to find a maximum, in units of T. Nearer together they harm:
velocity Verlet's velocities differ from the slope of its displacements by ``timestep**2 / 6`` times the jerk.
"""


FLOOR = 1e-9
"""Error that rounding and bisection leave, in T and V."""

KINK = 0.4 * 0.012, 0.4 * 0.051
"""Error of velocity, and of its slope, by a contact that closes or opens between two frames, over what its force then
does in that time: of the polynomial of degree five on ``max(s - a, 0)**2.5``, the largest for any a.
"""

APART = 1.5
"""Least distance of two maxima of a noisy record, in passages of the higher wave: its foot ends there."""


def on_a_grid(every: Floats | float, peak_velocity: Floats | float, *, all_recorded: bool = True) -> tuple[Any, Any]:
    """Bounds on the errors of arrival (T) and peak velocity (V) of an exact wave, found on a grid of times."""
    frames = every * peak_velocity**0.2  # in the wave's own time
    if all_recorded:
        far = np.asarray(every) >= FAR_APART
        arrival = np.where(far, 6e-4, 4e-3) * frames**5
        relative = np.where(far, 2e-4, 2.5e-3) * frames**6
    else:
        arrival, relative = 4e-2 * frames**6, 1e-2 * frames**6
    return FLOOR + arrival / peak_velocity**0.2, FLOOR + relative * peak_velocity


@dataclass(frozen=True)
class Peaks:
    """Maxima of bead velocity over time, sorted by chain, bead, time; one entry per maximum.

    Attributes:
        chain, bead: counted from 1.
        time: of the maximum, in units of T.
        velocity: the maximum along ``direction``, in units of V; always positive.
        overlap: the bead's larger overlap with a neighbour at the nearest frame, in units of L, negative where both
            are apart; NaN where not all beads are recorded.
        centre: centre in time of all the impulse that the bead was given until then, in units of T. It is ``time - x /
            velocity`` with the displacement x at the maximum, which hardly depends on ``time``: also where a bead flies
            on at its largest velocity, it is sharp.
        time_error, velocity_error, centre_error: how far these may be off because of the time between frames; the time
            of a bead that flies freely is not known at all (inf), see `sharp`.
        direction: of the velocities: 1 towards higher bead numbers, -1 towards lower ones.
    """

    chain: NDArray[np.int64]
    bead: NDArray[np.int64]
    time: Floats
    velocity: Floats
    overlap: Floats
    centre: Floats
    time_error: Floats
    velocity_error: Floats
    centre_error: Floats
    direction: int = 1

    def where(self, chosen: NDArray[np.bool_] | Integers) -> "Peaks":
        """The maxima that a mask or positions choose."""
        columns = {field.name: getattr(self, field.name)[chosen] for field in fields(self) if field.name != "direction"}
        return replace(self, **columns)

    def __len__(self) -> int:
        return len(self.time)


FREE = 0.05
"""Overlap at its peak, over velocity**0.8, below which a bead is taken for one that flies freely (the exact solitary
wave has 0.66). Such a velocity reaches a level and stays: when it is largest is not to be told.
"""


def sharp(peaks: Peaks) -> NDArray[np.bool_]:
    """Which passages have a time that can be told: all but those of beads that fly freely, as far as that is known."""
    return ~(peaks.overlap < FREE * peaks.velocity**0.8)


def in_mirror(peaks: Peaks, problem: Problem) -> Peaks:
    """The same maxima as numbered in the mirror, where they run the other way; twice is the maxima themselves."""
    bead = mirrored_bead(problem, peaks.bead)
    order = np.lexsort((peaks.time, bead, peaks.chain))
    return replace(peaks, bead=bead, direction=-peaks.direction).where(order)


class PeakFinder:
    """Finds maxima in a run that is given piece by piece; holds three frames and what it found.

    A bead that starts at its largest velocity (a kicked one) has a maximum at the start. A velocity that reaches a
    level and stays there, as that of a bead that leaves the free end, has its maximum where it reaches it.

    Args:
        threshold: smallest maximum that counts, in units of V.
        first_only: whether only the first maximum of each bead is wanted, which is several times faster.
        noisy: whether the states do not obey the equation of motion, so that velocities alone are used.
        direction: 1 for velocities towards higher bead numbers, -1 towards lower ones; None for the way of the hardest
            kick.
    """

    def __init__(
        self,
        threshold: float = THRESHOLD,
        *,
        first_only: bool = False,
        noisy: bool = False,
        direction: int | None = None,
    ) -> None:
        self._threshold = threshold
        self._noisy = noisy
        self._direction = direction
        self._found: list[_Brackets] = []
        self._carried: Trajectory | None = None
        self._started = False
        self._first_only = first_only
        self._passed: NDArray[np.bool_] | None = None

    def add(self, block: Trajectory) -> None:
        """Take the next frames, evenly spaced in time with those before."""
        if self._carried is not None:  # a window may have moved on
            self._carried = self._carried.on(block.first, block.first + block.velocity.shape[2] - 1)
        if self._carried is None or not self._started or block.frames < 3:
            if self._carried is not None:
                block = joined([self._carried, block])
            if not self._started and block.frames >= len(_NODES):
                self._start(block)
            if self._started:
                self._search(block, block.frames - 2)
        else:
            self._search(joined([self._carried, block[:3]]), 4)
            self._search(block, block.frames - 2)
        self._carried = block[-3:] if self._started else block

    def result(self) -> Peaks:
        """The maxima of all frames so far; no frame may be added afterwards.

        Raises:
            ValueError: there was no frame.
        """
        if self._carried is None:
            raise ValueError("no frames to analyse")
        if not self._started:
            self._start(self._carried)
        self._search(self._carried, self._carried.frames - 1, low=self._carried.frames - 2)
        return _refined(self._found, self._way(self._carried))

    def state(self) -> dict[str, NDArray[Any]]:
        """What `resumed` needs to go on later with the frames that follow, as arrays.

        Raises:
            ValueError: there was no frame.
        """
        if self._carried is None:
            raise ValueError("no frames to go on from")
        found = _together(self._found)
        return {
            **{f"found_{field.name}": getattr(found, field.name) for field in fields(_Brackets)},
            "time": self._carried.time,
            "displacement": self._carried.displacement,
            "velocity": self._carried.velocity,
            "first": np.array(self._carried.first),
            "started": np.array(self._started),
            "passed": np.zeros((0, 0), dtype=bool) if self._passed is None else self._passed,
        }

    def resumed(self, problem: Problem, state: Mapping[str, NDArray[Any]]) -> "PeakFinder":
        """Go on, still unused, where another was when it gave its `state`."""
        self._found = [_Brackets(**{field.name: state[f"found_{field.name}"] for field in fields(_Brackets)})]
        self._carried = Trajectory(
            problem, state["time"], state["displacement"], state["velocity"], first=int(state["first"])
        )
        self._started = bool(state["started"])
        self._passed = state["passed"] if state["passed"].size else None
        return self

    def _way(self, block: Trajectory) -> int:
        return direction_of(block.problem) if self._direction is None else self._direction

    def _start(self, block: Trajectory) -> None:
        """The beads that are fastest at the start."""
        self._started = True
        if block.frames > 1:
            v = self._way(block) * block.velocity[:2]
            chain, bead = np.nonzero((v[0] > self._threshold) & (v[0] >= v[1]))
            self._keep(block, np.zeros(len(chain), dtype=np.int64), chain, bead)

    def _search(self, block: Trajectory, high: int, low: int = 1) -> None:
        """Maxima whose largest frame is one of ``low`` to ``high - 1``, all of which have a frame on either side."""
        if not 1 <= low < high:
            return
        moving = block.moving
        v = block.velocity[:, :, moving] if self._way(block) > 0 else -block.velocity[:, :, moving]
        middle = v[low:high]
        is_peak = (middle > self._threshold) & (v[low - 1 : high - 1] < middle) & (middle >= v[low + 1 : high + 1])
        frame, chain, bead = (index.astype(np.int64) for index in np.nonzero(is_peak))
        self._keep(block, frame + low, chain, bead + moving.start)

    def _keep(self, block: Trajectory, frame: Integers, chain: Integers, bead: Integers) -> None:
        """Add the maxima whose largest frames are given, in the order of time."""
        if self._first_only:
            if self._passed is None:
                self._passed = np.zeros((block.problem.chains, len(block.problem.recorded_beads)), dtype=bool)
            place = chain * self._passed.shape[1] + bead + block.first - 1
            _, first = np.unique(place, return_index=True)
            first = first[~self._passed.flat[place[first]]]
            frame, chain, bead = frame[first], chain[first], bead[first]
            self._passed.flat[place[first]] = True
        if len(frame) == 0:
            return
        self._found.append(_bracketed(block, frame, chain, bead, self._way(block), noisy=self._noisy))


def find_peaks(blocks: Iterable[Trajectory], threshold: float = THRESHOLD, *, direction: int | None = None) -> Peaks:
    """Maxima above a threshold in a run given as consecutive blocks of frames; see `PeakFinder`."""
    finder = PeakFinder(threshold, direction=direction)
    for block in blocks:
        finder.add(block)
    return finder.result()


def distinct(peaks: Peaks) -> Peaks:
    """The maxima of a noisy record without those that belong to one passage.

    Left out is whatever is nearer to a higher maximum of its bead than `APART` times the time in which the exact wave
    of that height passes at half its height.
    """
    exact = solitary_wave()
    while len(peaks) > 1:
        near = APART * exact.width / exact.speed_at(peaks.velocity)
        same = (np.diff(peaks.chain) == 0) & (np.diff(peaks.bead) == 0)
        first_higher = peaks.velocity[:-1] >= peaks.velocity[1:]
        merged = same & (np.diff(peaks.time) < np.where(first_higher, near[:-1], near[1:]))
        if not np.any(merged):
            break
        lower = np.zeros(len(peaks), dtype=bool)
        lower[1:] |= merged & first_higher
        lower[:-1] |= merged & ~first_higher
        peaks = peaks.where(~lower)
    return peaks


_NODES = (0, 1, 2, 3)
"""Frames that fix a maximum where only some beads are recorded."""

_POWERS = 7

_SAMPLES = 9


@dataclass(frozen=True)
class _Brackets:
    """Maxima between frames: a polynomial of velocity for each, and the piece of it where the maximum lies."""

    chain: Integers
    bead: Integers
    origin: Floats
    spacing: Floats
    low: Floats
    high: Floats
    overlap: Floats
    displacement: Floats
    """At the origin."""
    velocity: Floats
    """[power, maximum] in s = (time - origin) / spacing."""
    doubt: Floats
    """How far ``velocity`` may be off: a share of what a polynomial of lower degree has more, [power, maximum]."""
    kink: Floats
    """What the force of a contact that closes or opens meanwhile does to the velocity at most."""
    whole: NDArray[np.bool_]
    """Whether all beads were recorded."""


def _bracketed(
    block: Trajectory, frame: Integers, chain: Integers, bead: Integers, way: int, *, noisy: bool
) -> _Brackets:
    """Maxima whose largest frames are given. One at frame 0 stays there."""
    spacing = block.spacing
    x, v = block.displacement, block.velocity
    by_equations = block.problem.recorded is None and not noisy
    if by_equations:
        rising = way * motion.acceleration_and_rate(block, frame, chain, bead)[0] > 0.0
        start = np.maximum(np.where(rising, frame, frame - 1), 0)
        nodes: tuple[int, ...] = (0, 1)
        low, high = np.zeros(len(frame)), np.ones(len(frame))
    else:
        nodes = _NODES[: block.frames]
        start = np.clip(frame - 1, 0, block.frames - len(nodes))
        low = np.maximum(frame - start - 1.0, 0.0)
        high = low + 2.0
    states = []
    for at in (start + node for node in nodes):
        state = [x[at, chain, bead], v[at, chain, bead]]
        if by_equations:
            state += motion.acceleration_and_rate(block, at, chain, bead)
        states.append(state)
    data = way * np.array(states)
    velocity, lower = _polynomials(nodes, data, spacing, by_equations=by_equations, noisy=noisy)
    share = _share_of_doubt(spacing, by_equations=by_equations)
    return _Brackets(
        chain=chain + 1,
        bead=block.beads[bead],
        origin=block.time[start],
        spacing=np.full(len(frame), spacing),
        low=low,
        high=np.where(frame == 0, low, high),
        overlap=motion.larger_overlap(block, frame, chain, bead),
        displacement=data[0, 0],
        velocity=velocity,
        doubt=share * (lower - velocity),
        kink=_kink(block, start, chain, bead) if by_equations else np.zeros(len(frame)),
        whole=np.full(len(frame), block.problem.recorded is None),
    )


def _kink(block: Trajectory, start: Integers, chain: Integers, bead: Integers) -> Floats:
    """What contacts that close or open between a frame and the next can do to a bead's velocity; else 0.

    Such a force begins as the power 1.5 of time, which no polynomial follows.
    """
    problem, spacing, total = block.problem, block.spacing, np.zeros(len(start))
    for side in (-1, 1):
        there = (bead + side >= 0) & (bead + side < block.velocity.shape[2])
        other = np.where(there, bead + side, bead)
        pressed, rate = [], []
        for frame in (start, np.minimum(start + 1, block.frames - 1)):
            x, v = block.displacement, block.velocity
            pressed.append(side * (x[frame, chain, bead] - x[frame, chain, other]) - problem.gap > 0.0)
            rate.append(np.abs(v[frame, chain, bead] - v[frame, chain, other]))
        contact = np.clip(block.first - 1 + np.minimum(bead, bead + side), 0, problem.beads - 2)
        force = motion.contact_force(problem, np.maximum(*rate) * spacing, chain, contact)
        total += np.where(there & (pressed[0] != pressed[1]), force * spacing, 0.0)
    return total


def _polynomials(
    nodes: tuple[int, ...], data: Floats, spacing: float, *, by_equations: bool, noisy: bool
) -> tuple[Floats, Floats]:
    """Velocity as a polynomial, and as one of a lower degree, each [power, maximum].

    Args:
        nodes: frames.
        data: [node, derivative of the displacement, maximum].
        spacing: time between frames.
        by_equations: whether acceleration and its rate are there.
        noisy: whether displacements are of no use.
    """
    by_velocity = hermite.coefficients(nodes, data[:, 1:], spacing)
    by_both = hermite.derivative(hermite.coefficients(nodes, data, spacing)) / spacing
    if noisy:
        best, lower = (by_velocity, by_velocity) if spacing < FAR_APART else (by_both, by_both)
    elif not by_equations:
        best, lower = by_both, by_velocity
    elif spacing < FAR_APART:
        best, lower = by_velocity, hermite.coefficients(nodes, data[:, 1:3], spacing)
    else:
        best, lower = by_both, by_velocity
    return _padded(best), _padded(lower)


def _share_of_doubt(spacing: float, *, by_equations: bool) -> float:
    """Bound on the error of the better polynomial, in what the other differs, as measured on runs of known peaks.

    Measured at couplings from 0.1 to 2 and times between frames from 0.1 to 2, with all beads and with a few; the
    errors are a third of the bound or less where frames are up to 1 T apart. With a few beads nobody knows of contacts
    that close or open between frames; there the whole of the bound is needed where frames are 0.1 T apart.
    """
    if not by_equations:
        return 0.3
    return 0.2 * spacing**2 if spacing < FAR_APART else 0.1


def _padded(polynomials: Floats) -> Floats:
    missing = _POWERS - len(polynomials)
    return np.concatenate([polynomials, np.zeros((missing, *polynomials.shape[1:]))])


def _together(parts: list[_Brackets]) -> _Brackets:
    if not parts:
        none = np.zeros(0, dtype=np.int64)
        empty = np.zeros(0)
        nothing = np.zeros((_POWERS, 0))
        return _Brackets(none, none, empty, empty, empty, empty, empty, empty, nothing, nothing, empty, empty > 0.0)
    columns = {field.name: [getattr(part, field.name) for part in parts] for field in fields(_Brackets)}
    return _Brackets(**{name: np.concatenate(column, axis=-1) for name, column in columns.items()})


def _largest(polynomials: Floats, found: _Brackets) -> Floats:
    """Largest size of a polynomial in each bracket, by some samples."""
    shares = np.linspace(0.0, 1.0, _SAMPLES)
    sizes = [np.abs(hermite.value(polynomials, found.low + c * (found.high - found.low))) for c in shares]
    return np.asarray(np.max(sizes, axis=0))


def _refined(parts: list[_Brackets], direction: int) -> Peaks:
    found = _together(parts)
    slope = hermite.derivative(found.velocity)
    at = hermite.falling_zero(slope, found.low, found.high)
    # between frames far apart there may be several; none that is lower than a frame is the maximum
    frames = found.low, np.minimum(found.low + 1.0, found.high)
    one, other = (hermite.value(found.velocity, frame) for frame in frames)
    lower = hermite.value(found.velocity, at) < np.maximum(one, other) - FLOOR
    at = np.where(lower, np.where(one >= other, *frames), at)
    time, velocity = found.origin + at * found.spacing, hermite.value(found.velocity, at)
    way = found.displacement + found.spacing * hermite.integral(found.velocity, at)
    doubt = _largest(found.doubt, found) + KINK[0] * found.kink
    curvature = -hermite.value(hermite.derivative(slope), at)
    with np.errstate(divide="ignore", invalid="ignore"):
        slope_error = _largest(hermite.derivative(found.doubt), found) + KINK[1] * found.kink
        time_error = slope_error / curvature * found.spacing
    exact_time, exact_velocity = np.where(
        found.whole, on_a_grid(found.spacing, velocity), on_a_grid(found.spacing, velocity, all_recorded=False)
    )
    doubt, time_error = doubt + exact_velocity, time_error + exact_time
    at_start = found.low == found.high
    time_error = np.where(at_start, 0.0, np.where(time_error >= 0.0, time_error, np.inf))
    peaks = Peaks(
        chain=found.chain,
        bead=found.bead,
        time=time,
        velocity=velocity,
        overlap=found.overlap,
        centre=time - way / velocity,
        time_error=time_error,
        velocity_error=np.where(at_start, 0.0, doubt),
        centre_error=np.where(at_start, 0.0, (found.spacing + np.abs(way / velocity)) * doubt / velocity),
        direction=direction,
    )
    peaks = replace(peaks, time_error=np.where(sharp(peaks) | at_start, time_error, np.inf))
    return peaks.where(np.lexsort((time, found.bead, found.chain)))
