"""Energies at instants between frames, with their uncertainty.

What lies beyond some beads and contacts changes their energy slowly, by the work that it does on them. So that energy
is interpolated itself, rather than the states of which it is made: by the polynomial of degree five through its value
and its first two derivatives at the two frames around the instant. The derivatives are differences along the motion,
which the acceleration and its rate continue for a moment (`moments`).

The uncertainty is, with a margin, the largest difference between the frames from the polynomial of degree three, which
has no second derivatives; and what the rates at the two frames leave unexplained of the change from one to the other.
The latter shows forces that set in or jump in between, and velocities that belong to another moment than positions.
"""

from typing import NamedTuple

import numpy as np

from analysis import hermite, motion
from analysis.meters import Part
from analysis.trajectory import Floats, Integers, Trajectory
from lammps_inputs.facts import Fact

STEP = 1e-3
"""Time from one moment to the next, as a share of that between frames."""

NUDGE = 1e-7
"""Time from a frame to its first moment, as a share of that between frames.

Forces that set in at the frame itself, such as those of beads that touch at the start, have set in then.
"""

MARGIN = 2.0
"""Measured against frames 4 to 80 times as dense in chains of all ingredients: without it, one energy in a thousand is
off by more, mostly by less than twice as much.
"""

SAMPLES = 9
"""Instants between two frames at which polynomials are compared."""

LARGEST_UNCERTAINTY = 0.05
"""Share of the energy input beyond which the uncertainty of an energy leaves no statement."""


class Pairs(NamedTuple):
    """Instants in a part of a run, each between two frames.

    Attributes:
        block: the frames.
        entry: [instant] positions among all instants.
        frame: [instant] position of the first of its two frames in the block.
        share: [instant] share of the time between the two frames that has passed.
    """

    block: Trajectory
    entry: Integers
    frame: Integers
    share: Floats


def since_frames(time: Floats, every: float) -> tuple[Integers, Floats]:
    """Number of the frame before each instant, and the share of the time to the next that has passed.

    Args:
        time: [instant] in units of T; an instant that is not finite is before the run.
        every: time between frames.

    Returns:
        Two arrays, [instant].
    """
    frames = np.where(np.isfinite(time), time, -2.0 * every) / every
    number = np.floor(frames).astype(np.int64)
    return number, frames - number


def pairs_in(part: Part, time: Floats) -> Pairs:
    """Instants from the first frame of a part to the first of the next; ``time`` is [instant] as for `since_frames`."""
    number, share = since_frames(time, part.around.problem.every)
    position = number - part.start
    last = part.count - 1 if part.is_last else part.count
    entry = np.flatnonzero((position >= 0) & (position < last))
    return Pairs(part.to_next, entry, position[entry], share[entry])


def steps_from(block: Trajectory) -> tuple[float, float]:
    """Time from one moment to the next beside the first and beside the second of two frames, towards each other.

    Where frames determine no forces without the past, those just before them are unknown: then both are after frames.
    """
    step = STEP * block.spacing
    return step, -step if block.problem.system.holds(Fact.FRAMES) else step


def moments(x: Floats, v: Floats, acceleration: Floats, rate: Floats, step: Floats) -> tuple[Floats, Floats]:
    """Displacements and velocities now, and one and two steps later, each [moment, ...].

    Args:
        x, v, acceleration, rate: displacement and its first three derivatives, of one shape, dimensionless.
        step: time from one moment to the next in units of T, of that shape or broadcast to it.
    """
    time = np.array([0.0, 1.0, 2.0]).reshape((3,) + (1,) * x.ndim) * step
    return (
        x + time * (v + 0.5 * time * (acceleration + time / 3.0 * rate)),
        v + time * (acceleration + 0.5 * time * rate),
    )


def moments_of_chains(block: Trajectory, frame: Integers, step: Floats, beads: slice) -> tuple[Floats, Floats, Floats]:
    """States of all atoms at three moments beside chosen frames.

    Args:
        block: frames of all beads.
        frame: [entry] positions of the frames.
        step: [entry] time from one moment to the next.
        beads: range of positions that includes, beside all beads that move, one at rest at either end.

    Returns:
        Time, [moment, entry]; displacement and velocity, each [moment, entry, line, bead].
    """
    first, nudge = block.first + beads.start, NUDGE / STEP * step
    x, v = (values[frame][..., beads] for values in block.atoms)
    of_atoms = step[:, np.newaxis, np.newaxis]

    def acceleration(time: Floats, x: Floats, v: Floats) -> Floats:
        """Acceleration of all atoms, [entry, line, bead]."""
        return motion.acceleration(block.system_at(frame, time), x, first, time=time, velocity=v)

    start = block.time[frame] + nudge
    x = x + NUDGE / STEP * of_atoms * v
    now = acceleration(start, x, v)
    later = acceleration(start + step, x + of_atoms * (v + 0.5 * of_atoms * now), v + of_atoms * now)
    time = start + np.arange(3.0)[:, np.newaxis] * step
    return time, *moments(x, v, now, (later - now) / of_atoms, of_atoms)


def derivatives(energy: Floats, step: Floats) -> Floats:
    """Energy and its first two derivatives, [derivative, ...], from its values at three moments, [moment, ...]."""
    first, second, third = energy
    return np.array(
        [first, (4.0 * second - 3.0 * first - third) / (2.0 * step), (third - 2.0 * second + first) / step**2]
    )


class Interpolated(NamedTuple):
    """Energies at instants, all of one shape, in units of m V**2.

    Attributes:
        value: the energies.
        uncertainty: how far they may be off because of the time between frames.
        rate: how fast they change, per T.
    """

    value: Floats
    uncertainty: Floats
    rate: Floats


def interpolated(energies: Floats, share: Floats, spacing: float) -> Interpolated:
    """Energies at instants between two frames.

    Args:
        energies: energy and its first two derivatives at both frames, [frame, derivative, ...].
        share: share of the time between the frames that has passed by each instant, of the trailing shape.
        spacing: time between the frames, in units of T.
    """
    (first, first_rate, first_curvature), (second, second_rate, second_curvature) = energies
    curve, other = (hermite.coefficients((0, 1), energies[:, :count], spacing) for count in (3, 2))
    difference = curve.copy()
    difference[: len(other)] -= other
    sizes = [np.abs(hermite.value(difference, np.full_like(first, s))) for s in np.linspace(0.0, 1.0, SAMPLES)]
    explained = 0.5 * spacing * (first_rate + second_rate) + spacing**2 / 12.0 * (first_curvature - second_curvature)
    return Interpolated(
        hermite.value(curve, share),
        MARGIN * (np.max(sizes, axis=0) + np.abs(second - first - explained)),
        hermite.value(hermite.derivative(curve), share) / spacing,
    )
