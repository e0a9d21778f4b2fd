"""What is wrong with a trajectory, as far as it can be told from the numbers alone.

What is measured: to how many digits the numbers were rounded (`precision`), by how much a quantity is shifted in time
(`time_shift`; displacement and velocity may be so by different amounts), and, from the change of momentum between
frames, how strong each kind of link was (`identify_strengths`) and which springs the chains felt (`identify_springs`).
What follows from the measurements is for others to say.
"""

from dataclasses import dataclass, replace

import numpy as np

from analysis.against import impulses
from analysis.trajectory import Floats, Trajectory
from lammps_inputs import Problem, laws, physics
from lammps_inputs.laws.preloaded import pressed
from lammps_inputs.links import Link

SINGLE = "single precision"

MOST_DIGITS = 12
"""Numbers with more digits than that pass for whole ones; float64 has 16."""

_NEAR = 1e-3
"""How near to a rounded one a number must be, as a share of the rounding's step; chance brings one in 500 there."""

_FEWEST = 20


def precision(values: Floats) -> str | None:
    """What all of many numbers were rounded to: such as "6 digits" (``%g``), "8 decimals", or `SINGLE`; else None.

    Sums with other numbers, such as rest positions, may have followed. Whole numbers tell nothing; None where fewer
    than `_FEWEST` different others are found.
    """
    telling = values[np.isfinite(values) & (values != np.round(values)) & (np.abs(values) > 1e-200)].ravel()
    sample = np.unique(telling[:: max(1, len(telling) // 2000)])
    if len(sample) < _FEWEST:
        return None
    digit = 10.0 ** (np.floor(np.log10(np.abs(sample))) + 1.0)
    found = []
    for word, form, unit in (("digits", "e", digit), ("decimals", "f", np.ones(len(sample)))):
        for count in range(1, MOST_DIGITS + 1):
            step = unit * 10.0**-count
            if np.any(2.0 * np.spacing(np.abs(sample)) > _NEAR * step):  # float64 itself is hardly finer
                break
            places = count - 1 if form == "e" else count
            if _all_near(sample, np.array([float(f"{value:.{places}{form}}") for value in sample.tolist()]), step):
                found.append((count, word))
                break
    if found:
        count, word = min(found)
        return f"{count} {word}"
    with np.errstate(over="ignore", under="ignore"):
        single = sample.astype(np.float32)
        if _all_near(sample, single.astype(np.float64), np.spacing(np.abs(single)).astype(np.float64)):
            return SINGLE
    return None


def _all_near(sample: Floats, rounded: Floats, step: Floats) -> bool:
    """Whether as good as all numbers are the rounded ones, which are still many different ones."""
    near = float(np.mean(np.abs(rounded - sample) <= _NEAR * step))
    return near > 0.99 and len(np.unique(rounded)) >= _FEWEST


@dataclass(frozen=True)
class Shift:
    """Best shift in time of one quantity against a reference.

    Attributes:
        time: how far it is ahead: at t it has the value that the reference has at t + time; in units of T.
        explained: share of the squared difference that the shift explains, 0 to 1.
    """

    time: float
    explained: float


def time_shift(difference: Floats, rate: Floats) -> Shift:
    """Fit ``difference = shift * rate`` by least squares; ``rate`` is the reference's time derivative."""
    power = float(np.sum(rate * rate))
    total = float(np.sum(difference * difference))
    if power == 0.0 or total == 0.0:
        return Shift(0.0, 0.0)
    shift = float(np.sum(difference * rate)) / power
    return Shift(shift, shift * shift * power / total)


@dataclass(frozen=True)
class Springs:
    """Springs that the beads of a trajectory felt.

    Attributes:
        linear: stiffness of each spring between chains j and j + 1 in row i, [spring, row]; NaN where it hardly moved.
        cubic: coefficient of the cube of the relative displacement that fits better than any linear spring; else 0.
        residual: share of the springs' impulses that linear springs leave unexplained, 0 to 1.
    """

    linear: Floats
    cubic: float
    residual: float


_UNEXPLAINED = 1e-4
"""Share of the squared changes of momentum that may be left where an exponent is to explain them."""

_BETTER = 0.03
"""What is left by an exponent that is not the problem's own, over what that leaves."""

_APART = 1e-6
"""Least relative displacement that is more than rounding, in units of L."""


def identify_springs(trajectory: Trajectory) -> Springs | None:
    """Fit the springs between the chains to a trajectory of all beads.

    None for one chain, for fewer than ten frames, where the chains never move apart, and where the problem ties them
    otherwise than by equal linear springs from each to the next (`identify_strengths` knows those).

    Between two frames, the change of a bead's velocity minus the impulse of its contacts is the impulse of its springs.
    Summed over the chains from the first to j, all that is left is the spring between j and j + 1 (of an open row).
    """
    problem = trajectory.problem
    system = problem.system
    if problem.chains < 2 or not physics.open_row(system) or not problem.forces_known or trajectory.frames < 10:
        return None
    if system.motions:  # by forces that nobody knows
        return None
    x, v = trajectory.displacement, trajectory.velocity
    change = impulses.unexplained(trajectory, (*system.along, *system.ground), system.dampers)
    felt = np.cumsum(change, axis=1)[:, :-1]
    relative, relative_rate = x[:, 1:] - x[:, :-1], v[:, 1:] - v[:, :-1]
    if np.max(np.abs(relative)) < _APART:
        return None
    spacing = impulses.spacing(trajectory)
    stretch = impulses.integral(relative, relative_rate, spacing)
    cube = impulses.integral(relative**3, 3.0 * relative**2 * relative_rate, spacing)
    power = np.sum(stretch * stretch, axis=0)
    moved = power > 1e-4 * power.max()
    with np.errstate(divide="ignore", invalid="ignore"):  # rows that never moved
        linear = np.where(moved, np.sum(felt * stretch, axis=0) / power, np.nan)
    total = float(np.sum(felt * felt))
    if total == 0.0:
        return Springs(np.zeros_like(linear), 0.0, 0.0)
    common = float(np.sum(felt * stretch) / np.sum(stretch * stretch))
    left = float(np.sum((felt - common * stretch) ** 2)) / total
    cubic = float(np.sum(felt * cube) / np.sum(cube * cube))
    left_by_cubic = float(np.sum((felt - cubic * cube) ** 2)) / total
    return Springs(linear, cubic if left_by_cubic < 0.1 * left else 0.0, left)


_TELLING = 1e-6
"""Impulse of a kind of link, over the largest of any, from which on it is told; likewise what tells two apart."""


@dataclass(frozen=True)
class Strengths:
    """How strong the links of a trajectory were felt to be.

    Attributes:
        factors: name of a kind of link -> factor on the problem's own force; 1 is right.
        left: what these leave unexplained, over what the problem's own forces leave (of squared changes of momentum).
    """

    factors: dict[str, float]
    left: float


def identify_strengths(trajectory: Trajectory) -> Strengths | None:
    """Find how strong each kind of link was felt to be.

    Least squares of the change of every bead's momentum between frames on the impulses of the links, without those that
    as good as nothing has reached, such as a wall. None for fewer than ten frames, where not all beads are recorded,
    and where the impulses of two kinds of link cannot be told apart.
    """
    problem = trajectory.problem
    if not problem.forces_known or trajectory.frames < 10:
        return None
    change = _but_for_driven(impulses.unexplained(trajectory), problem)
    given = [(link, impulses.of_link(link, trajectory)) for link in problem.system.links]
    given += [(damper, impulses.of_damper(damper, trajectory)) for damper in problem.system.dampers]
    columns = np.array(
        [_but_for_driven(impulses.on_beads(link, impulse, trajectory), problem).reshape(-1) for link, impulse in given]
    )
    size = np.linalg.norm(columns, axis=1)
    felt = np.flatnonzero(size > _TELLING * np.max(size))
    matrix, right = columns[felt].T, change.reshape(-1)
    factors, _, rank, _ = np.linalg.lstsq(matrix, right, rcond=_TELLING)
    if rank < len(felt):
        return None
    left, own = (float(np.sum((right - matrix @ fit) ** 2)) for fit in (factors, np.ones(len(felt))))
    found = {given[place][0].name: float(factor) for place, factor in zip(felt, factors, strict=True)}
    return Strengths(found, left / own if own > 0.0 else 0.0)


_EXPLAINED = 0.05
"""Share of the impulses left unexplained, of those at the right load, that another load must leave at most."""


@dataclass(frozen=True)
class StaticLoad:
    """What bears the beads of a trajectory at rest, over what the problem says; 1 is right.

    Attributes:
        held: forces from outside that hold them (on the ends, weights); NaN where walls alone do.
        pressed: force in the contacts at rest.
    """

    held: float
    pressed: float


def identify_load(trajectory: Trajectory) -> StaticLoad | None:
    """Find the static load of a trajectory; None where the problem has none, or not all beads are recorded.

    What links in incremental form leave of a bead's change of momentum is what holds it too much or too little. How
    hard the contacts are pressed shows in how they give: the load at which they explain most, among some.
    """
    problem = trajectory.problem
    system = problem.system
    if not physics.loaded(system) or not problem.forces_known or trajectory.frames < 10:
        return None
    bearing = (*system.along, *physics.walls(system))
    others = [link for link in system.links if link not in bearing]
    change = impulses.unexplained(trajectory, others, system.dampers)

    def left(factor: float) -> Floats:
        total = change.copy()
        for link in bearing:
            other = replace(link, law=pressed(link.law, factor)) if np.any(laws.load(link.law)) else link
            other.drive(total, -impulses.of_link(other, trajectory))
        return _but_for_driven(total, problem)

    start = trajectory.displacement[0]
    outside = np.zeros_like(start)
    for link in system.links:
        link.drive(outside, -np.broadcast_to(_at_rest(link), link.strain(start).shape))
    power = float(np.sum(outside**2) * np.sum(np.diff(trajectory.time)))
    size = float(np.max(np.abs(outside)))
    far = 1e-9 * size * problem.chains * problem.beads
    held = 1.0 + float(np.sum(left(1.0).sum(axis=0) * outside)) / power if size > far else np.nan
    factors = np.concatenate([[0.0], 10.0 ** (np.arange(-40, 41) / 40.0)])
    missing = np.array([float(np.sum(left(float(factor)) ** 2)) for factor in factors])
    best = int(np.argmin(missing))
    explains = missing[best] < _EXPLAINED * missing[factors == 1.0][0]
    return StaticLoad(held, float(factors[best]) if explains else 1.0)


def _at_rest(link: Link) -> Floats:
    """Force at rest of each link that bears a load."""
    side = getattr(link.law, "side", 1.0)
    return np.asarray(side * laws.load(link.law))


def identify_exponent(trajectory: Trajectory) -> float | None:
    """The power of the overlap that the contacts' force was felt to be; the problem's own unless another explains all.

    None where that is none, contacts differ, not all beads are recorded, or there are few frames.
    """
    from scipy.optimize import minimize_scalar

    problem = trajectory.problem
    system = problem.system
    if (
        physics.exponent(system) is None
        or not physics.alike(system)
        or not problem.forces_known
        or trajectory.frames < 10
    ):
        return None
    (contact,) = system.along
    left = impulses.unexplained(trajectory, (*system.across, *system.ground), system.dampers)
    spacing, v = impulses.spacing(trajectory), trajectory.velocity
    overlap, closing = np.maximum(contact.overlap(trajectory.displacement), 0.0), v[..., :-1] - v[..., 1:]
    rest = laws.rest(contact.law)
    closed = overlap > 0.0
    pressed = np.where(closed, overlap, 1.0)  # below an exponent of 1 the rate of a contact that just opens has no end

    def unexplained(exponent: float) -> float:
        force = overlap**exponent - rest**exponent
        rate = exponent * pressed ** (exponent - 1.0) * closing * closed
        column = impulses.on_beads(contact, impulses.integral(force, rate, spacing), trajectory)
        return float(np.sum(_but_for_driven(left - column, problem) ** 2))

    found = minimize_scalar(unexplained, (1.0, 2.0), (0.9, 4.0), method="bounded", options={"xatol": 1e-6})
    explains = found.fun < _UNEXPLAINED * float(np.sum(_but_for_driven(left, problem) ** 2))
    stated = physics.exponent(system)
    assert stated is not None
    return float(found.x) if explains and found.fun < _BETTER * unexplained(stated) else stated


def _but_for_driven(values: Floats, problem: Problem) -> Floats:
    """Values [..., chain, bead] with 0, in place, at beads whose motion is given: by what forces, nobody knows."""
    for motion in problem.system.motions:
        values[..., motion.chain - 1, motion.bead - 1] = 0.0
    return values
