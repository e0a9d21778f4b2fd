"""What is wrong with a trajectory, as far as it can be determined from the numbers alone.

What is measured: to how many digits the numbers were rounded (`precision`), by how much a quantity is shifted in time
(`time_shift`; displacement and velocity may be so by different amounts), and, from the change of momentum between
frames against the impulses of all links, how heavy each bead was felt to be and how strong its contacts
(`identify_beads`), how strong each kind of link was (`identify_strengths`) and which springs the chains felt
(`identify_springs`). What follows from the measurements is for others to say.

Impulses are [interval, chain, bead], the intervals between two frames. Every bead must be recorded.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from analysis.trajectory import Floats, Trajectory
from lammps_inputs import Problem, System, laws, physics
from lammps_inputs.laws.preloaded import pressed
from lammps_inputs.links import Along, Link
from lammps_inputs.loads import Load

LEAST_FRAMES = 10


def integral(value: Floats, rate: Floats, intervals: Floats) -> Floats:
    """Integral between consecutive frames from values and rates there (corrected trapezoid, order 4)."""
    ends = 0.5 * intervals * (value[1:] + value[:-1])
    return np.asarray(ends + intervals**2 / 12.0 * (rate[:-1] - rate[1:]))


def intervals(trajectory: Trajectory) -> Floats:
    """Time between two frames, [interval, 1, 1]."""
    return np.diff(trajectory.time)[:, np.newaxis, np.newaxis]


def of_link(link: Link, trajectory: Trajectory) -> Floats:
    """Impulse of each of some links, by their forces and how these change at the frames."""
    (x, v), link = _seen(link, trajectory), link.at(trajectory.time)
    return integral(link.force(x), link.force_rate(x, v), intervals(trajectory))


def of_damper(damper: Link, trajectory: Trajectory) -> Floats:
    """Impulse of each of some dampers, which have given one for every strain."""
    return np.diff(damper.given(_seen(damper, trajectory)[0]), axis=0)


def _seen(link: Link, trajectory: Trajectory) -> tuple[Floats, Floats]:
    """Displacements and velocities of the beads; of all atoms for a link of others."""
    inner = physics.is_inner(trajectory.problem.system, link)
    return trajectory.atoms if inner else (trajectory.displacement, trajectory.velocity)


def on_beads(link: Link, impulse: Floats, trajectory: Trajectory) -> Floats:
    """What impulses of links, or of dampers, give the beads."""
    column = np.zeros_like(_seen(link, trajectory)[0][1:])
    link.drive(column, impulse)
    return column[:, : trajectory.problem.chains]


def _enough(trajectory: Trajectory) -> bool:
    """Whether there are frames enough, and numbers in each, to determine the forces on the beads."""
    return trajectory.problem.forces_known and trajectory.frames >= LEAST_FRAMES


def links_of(system: System) -> tuple[Link, ...]:
    """All links of a system, those of inner atoms last."""
    return *system.links, *system.inner_links


def given_by_links(trajectory: Trajectory, *, loads: bool = True) -> Floats:
    """Change of the beads' momentum but for what forces from outside, if these count, gave."""
    change: Floats = np.diff(trajectory.velocity, axis=0) * trajectory.problem.system.mass
    for load in trajectory.problem.system.loads if loads else ():
        change[:, load.chain - 1, load.bead - 1] -= np.diff(load.impulse(trajectory.time))
    return change


def unexplained(trajectory: Trajectory, without: Sequence[Link] = (), *, loads: bool = True) -> Floats:
    """What all links and dampers but some, and if these count forces from outside, leave of the change of momentum."""
    change, system = given_by_links(trajectory, loads=loads), trajectory.problem.system
    for link, impulse in (
        *((link, of_link(link, trajectory)) for link in links_of(system) if all(link is not one for one in without)),
        *((damper, of_damper(damper, trajectory)) for damper in system.dampers),
    ):
        if physics.is_inner(system, link):
            change -= on_beads(link, impulse, trajectory)
        else:
            link.drive(change, -impulse)
    return change


def beyond(own: Trajectory, reference: Trajectory) -> Floats:
    """The same, without what the method leaves of the reference's, and without beads whose motion is given."""
    return _but_for_driven(unexplained(own) - unexplained(reference), own.problem)


MOST = 4000
"""Beads in all chains that are looked at one by one."""

TELLING = 1e-3
"""Share of the largest squared impulses of a chain's contacts that those of a contact must have."""

SAME = 0.01
"""How near factors must be to count as the same."""


@dataclass(frozen=True)
class Felt:
    """Factors on the problem's own numbers, 1 being right; NaN where too little moved.

    The masses and contacts of a chain could all be so many times larger without a difference. As many as possible are
    taken to be right.

    Attributes:
        mass: [chain, bead].
        strength: of the contacts, [chain, contact].
    """

    mass: Floats
    strength: Floats


def identify_beads(trajectory: Trajectory) -> Felt | None:
    """Fit masses and contacts bead by bead; None for fewer than ten frames, not all beads, or more than `MOST`.

    On a bead the two contacts are felt as ``A / m``. So a mass that is wrong shows on one bead in both of its contacts,
    a contact that is wrong on both of its beads.
    """
    problem = trajectory.problem
    system = problem.system
    if not _enough(trajectory) or problem.chains * problem.beads > MOST:
        return None
    change = given_by_links(trajectory)
    contacts, others = np.zeros(change[:, :, 1:].shape), []
    for link in links_of(system):
        impulse = of_link(link, trajectory)
        if isinstance(link, Along):
            contacts += impulse
        else:
            others.append(on_beads(link, impulse, trajectory))
    for damper in system.dampers:
        others.append(on_beads(damper, of_damper(damper, trajectory), trajectory))
    # of every contact, as felt by the bead behind it and by the one before it
    behind, ahead = np.full((2, problem.chains, problem.beads - 1), np.nan)
    power = np.sum(contacts**2, axis=0)
    telling = power > TELLING * power.max(axis=1, keepdims=True)
    prescribed = {(motion.chain, motion.bead) for motion in system.motions}  # how they move, whatever they weigh
    for chain, bead in np.ndindex(problem.chains, problem.beads):
        columns = [column[:, chain, bead] for column in others]
        sides = [(ahead, bead - 1, 1.0)] if bead > 0 else []
        sides += [(behind, bead, -1.0)] if bead < problem.beads - 1 else []
        columns += [sign * contacts[:, chain, contact] for _, contact, sign in sides]
        factors = np.linalg.lstsq(np.array(columns).T, change[:, chain, bead], rcond=1e-9)[0]
        for (side, contact, _), factor in zip(sides, factors[len(others) :], strict=True):
            if telling[chain, contact] and (chain + 1, bead + 1) not in prescribed:
                side[chain, contact] = factor
    mass, strength = np.full(change.shape[1:], np.nan), np.full(behind.shape, np.nan)
    for chain in range(problem.chains):
        mass[chain], strength[chain] = _apart(behind[chain], ahead[chain])
    return Felt(mass, strength)


def _apart(behind: Floats, ahead: Floats) -> tuple[Floats, Floats]:
    """Masses, [bead], and contacts of one chain, from ``A / m`` as felt behind and ahead of each contact, [contact]."""
    mass, strength = np.full(len(behind) + 1, np.nan), np.full(len(behind), np.nan)
    good = np.flatnonzero((behind > 0.0) & (ahead > 0.0))
    if len(good) == 0:
        return mass, strength
    # from the first significant contact, as far as all of them are
    run = good[: int(np.argmax(np.r_[np.diff(good) > 1, True])) + 1]
    steps = np.log(behind[run]) - np.log(ahead[run])
    heavy = np.r_[0.0, np.cumsum(steps)]
    strong = np.log(behind[run]) + heavy[:-1]
    both = np.concatenate([heavy, strong])
    near = np.abs(both[:, np.newaxis] - both) < SAME
    usual = float(np.median(both[near[int(np.argmax(near.sum(axis=1)))]]))
    mass[run[0] : run[-1] + 2], strength[run] = np.exp(heavy - usual), np.exp(strong - usual)
    return mass, strength


def impulse_given(trajectory: Trajectory, load: Load) -> Floats:
    """Impulse from outside until each frame, [frame], on the bead of a load: what the links on it do not explain."""
    change = unexplained(trajectory, loads=False)
    return np.concatenate([[0.0], np.cumsum(change[:, load.chain - 1, load.bead - 1])])


SINGLE = "single precision"

MOST_DIGITS = 12
"""Numbers with more digits than that pass for whole ones; float64 has 16."""

_NEAR = 1e-3
"""How near to a rounded one a number must be, as a share of the rounding's step; chance brings one in 500 there."""

_FEWEST = 20


def precision(values: Floats) -> str | None:
    """What all of many numbers were rounded to: such as "6 digits" (``%g``), "8 decimals", or `SINGLE`; else None.

    Sums with other numbers, such as rest positions, may have followed. Whole numbers are no evidence; None where fewer
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
    """Whether practically all numbers are the rounded ones, which are still many different ones."""
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
    otherwise than by equal linear springs from each to the next (see `identify_strengths` for those).

    Between two frames, the change of a bead's velocity minus the impulse of its contacts is the impulse of its springs.
    Summed over the chains from the first to j, all that is left is the spring between j and j + 1 (of an open row).
    """
    problem = trajectory.problem
    system = problem.system
    if problem.chains < 2 or not physics.open_row(system) or not _enough(trajectory) or system.motions:
        return None  # motions are by unknown forces
    x, v = trajectory.displacement, trajectory.velocity
    change = unexplained(trajectory, system.across)
    felt = np.cumsum(change, axis=1)[:, :-1]
    relative, relative_rate = x[:, 1:] - x[:, :-1], v[:, 1:] - v[:, :-1]
    if np.max(np.abs(relative)) < _APART:
        return None
    spacing = intervals(trajectory)
    stretch = integral(relative, relative_rate, spacing)
    cube = integral(relative**3, 3.0 * relative**2 * relative_rate, spacing)
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
"""Smallest impulse of a kind of link, over the largest of any, at which it (or a difference of two) is identified."""


@dataclass(frozen=True)
class Strengths:
    """How strong the links of a trajectory were felt to be.

    Attributes:
        factors: name of a kind of link -> factor on the problem's own force; 1 is right.
        left: what these leave unexplained, over what the problem's own forces leave (of squared changes of momentum).
        power: what they leave.
    """

    factors: dict[str, float]
    left: float
    power: float


def identify_strengths(trajectory: Trajectory) -> Strengths | None:
    """Find how strong each kind of link was felt to be.

    Least squares of the change of every bead's momentum between frames on the impulses of the links, without those that
    practically nothing has reached, such as a wall. None for fewer than ten frames, where not all beads are recorded,
    and where the impulses of two kinds of link cannot be distinguished.
    """
    problem = trajectory.problem
    if not _enough(trajectory):
        return None
    change = _but_for_driven(given_by_links(trajectory), problem)
    given = [part for link in links_of(problem.system) for part in _parts(link, trajectory)]
    given += [(damper.name, damper, of_damper(damper, trajectory)) for damper in problem.system.dampers]
    columns = np.array(
        [_but_for_driven(on_beads(link, impulse, trajectory), problem).reshape(-1) for _, link, impulse in given]
    )
    size = np.linalg.norm(columns, axis=1)
    felt = np.flatnonzero(size > _TELLING * np.max(size))
    matrix, right = columns[felt].T, change.reshape(-1)
    factors, _, rank, _ = np.linalg.lstsq(matrix, right, rcond=_TELLING)
    if rank < len(felt):
        return None
    left, own = (float(np.sum((right - matrix @ fit) ** 2)) for fit in (factors, np.ones(len(felt))))
    found = {given[place][0]: float(factor) for place, factor in zip(felt, factors, strict=True)}
    return Strengths(found, left / own if own > 0.0 else 0.0, left)


def felt_inner_mass(trajectory: Trajectory) -> float:
    """How heavy inner atoms were felt to be, over the problem's masses, by the impulses of their links on them.

    NaN where none has moved.
    """
    system, lines = trajectory.problem.system, slice(trajectory.problem.chains, None)
    assert system.inner_mass is not None
    momentum = np.diff(trajectory.atoms[1][:, lines], axis=0) * system.inner_mass
    given = np.zeros_like(trajectory.atoms[1][1:])
    for link in system.inner_links:
        link.drive(given, of_link(link, trajectory))
    for damper in system.dampers:
        if physics.is_inner(system, damper):
            damper.drive(given, of_damper(damper, trajectory))
    power = float(np.sum(momentum * momentum))
    return float(np.sum(momentum * given[:, lines])) / power if power > 0.0 else math.nan


def _parts(link: Link, trajectory: Trajectory) -> list[tuple[str, Link, Floats]]:
    """Names and impulses of links; of those that depend on time, what does not and what does apart."""
    whole = of_link(link, trajectory)
    if not laws.varies(link.law):
        return [(link.name, link, whole)]
    steady = of_link(replace(link, law=link.law.steady), trajectory)  # type: ignore[attr-defined]
    return [(link.name, link, steady), (in_time(link), link, whole - steady)]


def in_time(link: Link) -> str:
    """Name of what depends on time of a link's law."""
    return f"change of the {link.name} in time"


_EXPLAINED = 0.05
"""Share of the impulses left unexplained, of those at the right load, that another load must leave at most."""


@dataclass(frozen=True)
class StaticLoad:
    """Static force on the beads of a trajectory over that of the problem; 1 is right.

    Attributes:
        holding: forces from outside that hold them (on the ends, weights); 1 where walls alone do, and unless others
            explain the motion.
        pressed: force in the contacts at rest; likewise.
    """

    holding: float
    pressed: float


def identify_load(trajectory: Trajectory) -> StaticLoad | None:
    """Find the static load of a trajectory; None where the problem has none that contacts of a power of the overlap
    carry, or not all beads are recorded.

    What links in incremental form leave of a bead's change of momentum is what holds it too much or too little. How
    hard the contacts are pressed shows in how they give: the load at which they explain most, among some.
    """
    from scipy.optimize import minimize_scalar

    problem = trajectory.problem
    system = problem.system
    if not physics.loaded(system) or physics.exponent(system) is None or not _enough(trajectory):
        return None
    bearing = (*system.along, *physics.walls(system))
    change = unexplained(trajectory, bearing)

    def left(factor: float) -> Floats:
        total = change.copy()
        for link in bearing:
            other = replace(link, law=pressed(link.law, factor)) if np.any(laws.load(link.law)) else link
            other.drive(total, -of_link(other, trajectory))
        return _but_for_driven(total, problem)

    start = trajectory.displacement[0]
    outside = np.zeros_like(start)
    for link in system.links:
        link.drive(outside, -np.broadcast_to(laws.load(link.law), link.strain(start).shape))
    power = float(np.sum(outside**2) * np.sum(np.diff(trajectory.time)))
    size = float(np.max(np.abs(outside)))
    least = 1e-9 * max(
        float(np.max(laws.load(link.law))) for link in bearing
    )  # where walls hold them, rounding is left
    factors = np.concatenate([[0.0], 10.0 ** (np.arange(-40, 41) / 40.0)])
    missing = np.array([float(np.sum(left(float(factor)) ** 2)) for factor in factors])
    best, usual = int(np.argmin(missing)), left(1.0)
    most = _EXPLAINED * float(np.sum(usual**2))
    holding = 1.0
    if size > least:
        holding += float(np.sum(usual.sum(axis=0) * outside)) / power
        held = (holding - 1.0) * outside * intervals(trajectory)
        holding = holding if np.sum((usual - held) ** 2) < most else 1.0
    if missing[best] >= most or best == 0:
        return StaticLoad(holding, 0.0 if missing[best] < most else 1.0)
    around = float(factors[max(best - 1, 1)]), float(factors[min(best + 1, len(factors) - 1)])
    found = minimize_scalar(lambda factor: float(np.sum(left(factor) ** 2)), bounds=around, options={"xatol": 1e-4})
    return StaticLoad(holding, float(found.x))


def identify_exponent(trajectory: Trajectory) -> float | None:
    """The power of the overlap that the contacts' force was felt to be; the problem's own unless another explains all.

    None where that is none, contacts differ, not all beads are recorded, or there are few frames.
    """
    from scipy.optimize import minimize_scalar

    problem = trajectory.problem
    system = problem.system
    stated = physics.exponent(system)
    if stated is None or not physics.alike(system) or not _enough(trajectory):
        return None
    (contact,) = system.along
    left = unexplained(trajectory, system.along)
    spacing, v = intervals(trajectory), trajectory.velocity
    overlap, closing = np.maximum(contact.overlap(trajectory.displacement), 0.0), v[..., :-1] - v[..., 1:]
    rest = laws.rest(contact.law)
    closed = overlap > 0.0
    pressed = np.where(closed, overlap, 1.0)  # below an exponent of 1 the rate of a contact that just opens has no end

    def left_by(exponent: float) -> float:
        force = overlap**exponent - rest**exponent
        rate = exponent * pressed ** (exponent - 1.0) * closing * closed
        column = on_beads(contact, integral(force, rate, spacing), trajectory)
        return float(np.sum(_but_for_driven(left - column, problem) ** 2))

    found = minimize_scalar(left_by, (1.0, 2.0), (0.9, 4.0), method="bounded", options={"xatol": 1e-6})
    explains = found.fun < _UNEXPLAINED * float(np.sum(_but_for_driven(left, problem) ** 2))
    return float(found.x) if explains and found.fun < _BETTER * left_by(stated) else stated


def _but_for_driven(values: Floats, problem: Problem) -> Floats:
    """Values [..., chain, bead] with 0, in place, at beads whose motion is given, by unknown forces."""
    for motion in problem.system.motions:
        values[..., motion.chain - 1, motion.bead - 1] = 0.0
    return values
