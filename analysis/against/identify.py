"""Departures of a trajectory from its scene: linear least squares of a factor for every kind of force and mass.

From one frame to the next the momentum of an atom changes by the impulses of all forces on it, which follow from the
recorded motion (`analysis.against.momentum`), so that

    m_i (v_i(t_n+1) - v_i(t_n)) = sum over k of f_k I_k,i,n

is linear in the factors f_k, 1 where the trajectory follows the scene. Where factors of kinds do not explain the motion,
the links of one kind, or the masses, have a factor each; then one kind of force may have another law.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from analysis.against.momentum import (
    STATIC,
    ForceOfState,
    LinkImpulses,
    MomentumEquations,
    MomentumTerm,
    integrals,
    name_of_beads,
    name_of_load,
)
from analysis.trajectory import Floats, Trajectory
from lammps_inputs.laws.spring import Linear
from lammps_inputs.links import Across, Along, Ground, Link

LEAST_FRAMES = 10

TOO_FAR = 0.03
"""Share of the change of momentum, root mean square, that the interpolation may leave of the reference's."""

NOISE = 3.0
"""Residual over what the interpolation leaves of the reference's, up to which it counts as noise."""

EXPLAINED, NEARLY = 0.03, 0.1
"""Share of the residual that other factors may leave, and another law, of which some powers of the strain are only near."""

_SAFETY = 3.0
"""Uncertainty of a factor over the change of it that would make all that is left, as the least that it may be."""

_MASS_TOO = 1.5
"""Kinds of forces that must be wrong by one factor for the mass of most beads to be taken to be wrong instead."""

_MOST_SINGLE = 4
"""Links or beads of a kind that are given one by one."""

_LOADS = (0.0, 0.25, 0.5, 2.0, 4.0)
"""Static loads, over that of the scene, from which the fit starts beside that of the scene."""

_ITERATIONS, _SETTLED = 12, 1e-3
"""Steps to the static load at most; largest change of it, over that of the scene, for which the equations are linear."""

_FELT = 1e-6
"""Size of a column over that of the largest one, below which its force has reached nothing."""

_DISTINCT = 1e-9
"""Least eigenvalue of the matrix of correlations of columns that can be distinguished."""

_MOST_STEPS = 200
"""Iterations of the least squares of single links."""

_POWERS, _LEAST = (-2.0, -1.0, 0.5, 1.0, 2.0), 0.01
"""Powers of the strain, or of its rate, by which the force of another law is multiplied; and the least of both, over the
largest.
"""


@dataclass(frozen=True)
class Departure:
    """What differs from the scene.

    Attributes:
        name: of the force or the beads.
        what: "strength", "mass", "law" (another function of the strain) or "course" (another one of time).
        factor: on the number of the scene; or the number itself, dimensionless, of what the scene lacks. NaN of a course.
        uncertainty: of the factor; likewise.
        scene: 1, or 0 of what the scene lacks.
        effect: change of momentum that it makes over all changes, root mean square; of a law the share of its impulses
            that the best factor leaves.
        count: number of links or beads of this kind that differ, where only the one that differs most is given.
    """

    name: str
    what: Literal["strength", "mass", "law", "course"]
    factor: float
    uncertainty: float
    scene: float
    effect: float
    count: int = 1


@dataclass(frozen=True)
class Identification:
    """What was found in a trajectory.

    Attributes:
        departures: largest effect first; empty if they do not explain the motion.
        unexplained: share of the changes of momentum, root mean square, that the forces of the scene do not explain.
        interpolation: the same of the reference, which the interpolation between frames leaves.
        place: line and bead, counted from 0, where most is unexplained.
        ambiguous: whether several causes explain the motion alike, so that none is given.
    """

    departures: tuple[Departure, ...]
    unexplained: float
    interpolation: float
    place: tuple[int, int]
    ambiguous: bool


def identify(trajectory: Trajectory, reference: Trajectory) -> Identification:
    """Find what departs from the scene in a trajectory, if that explains the motion.

    Args:
        trajectory: consecutive frames of all atoms.
        reference: the same frames as the scene has them, from which follows what the interpolation leaves.
    """
    equations, right = MomentumEquations(trajectory), MomentumEquations(reference)
    noise, left, total, scale = map(_norm, (right.residual, equations.residual, equations.change, right.change))
    departures: list[Departure] | None = None
    if left > NOISE * noise and noise < TOO_FAR * scale:
        limit = max(NOISE * noise, EXPLAINED * left)
        departures = _kinds(equations, noise, limit)
        if departures is None:
            departures = _links_and_beads(equations, noise, limit)
        if departures is None:
            departures = _functions(equations, max(NOISE * noise, NEARLY * left))
    power = np.sum(equations.residual**2, axis=0)
    line, bead = np.unravel_index(int(np.argmax(power)), power.shape)
    return Identification(
        departures=tuple(sorted(departures or [], key=lambda departure: -departure.effect)),
        unexplained=left / total,
        interpolation=noise / scale,
        place=(int(line), int(bead)),
        ambiguous=departures == [],
    )


def _norm(values: Floats) -> float:
    return float(np.linalg.norm(values))


# --- kinds of forces and masses ---------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class LeastSquares:
    """Fit of a residual by columns.

    Attributes:
        change: [column] change of each factor; 0 where it cannot be distinguished from others.
        bound: [column] change of each factor, at most, by an error of the residual of norm 1; infinite likewise.
        left: norm of what is left.
    """

    change: Floats
    bound: Floats
    left: float


def least_squares(residual: Floats, columns: Sequence[Floats]) -> LeastSquares:
    """Fit a residual by columns of its shape."""
    size = np.array([_norm(column) for column in columns])
    change, bound = np.zeros(len(columns)), np.full(len(columns), np.inf)
    felt = np.flatnonzero(size > _FELT * np.max(size))
    unit = [columns[k] / size[k] for k in felt]
    value, vector = np.linalg.eigh(np.array([[np.vdot(a, b) for b in unit] for a in unit]))
    distinct = value > _DISTINCT
    inverse = vector[:, distinct] / value[distinct] @ vector[:, distinct].T
    change[felt] = inverse @ [np.vdot(column, residual) for column in unit] / size[felt]
    mixed = np.sum(vector[:, ~distinct] ** 2, axis=1) > _DISTINCT
    bound[felt] = np.where(mixed, np.inf, np.sqrt(np.diag(inverse)) / size[felt])
    left = residual - sum(factor * column for factor, column in zip(change, columns, strict=True))
    return LeastSquares(change, bound, _norm(left))


def _kinds(equations: MomentumEquations, noise: float, limit: float) -> list[Departure] | None:
    """Factors of all kinds of forces and masses; None if they leave more than a limit.

    The equations are not linear in the static load, and are solved by Gauss and Newton's method.
    """
    static = next((k for k, term in enumerate(equations.terms) if term.name == STATIC), None)
    for start in (1.0,) if static is None else (1.0, *_LOADS):
        at_load = equations if start == 1.0 else MomentumEquations(equations.trajectory, start)
        for _ in range(_ITERATIONS):
            fit = least_squares(at_load.residual, [term.column for term in at_load.terms])
            change = 0.0 if static is None else float(fit.change[static])
            settled = abs(change) < _SETTLED or (static is not None and abs(change) < fit.bound[static] * fit.left)
            if settled and fit.left <= limit:
                return _departures(at_load, fit, noise)
            if abs(change) < _SETTLED:
                break
            load = min(max(at_load.load + change, 0.3 * at_load.load), 3.0 * at_load.load + 10.0 * _SETTLED)
            at_load = MomentumEquations(equations.trajectory, load)
    return None


def _departures(equations: MomentumEquations, fit: LeastSquares, noise: float) -> list[Departure]:
    """Factors that differ from those of the scene by more than their uncertainty."""
    terms = equations.terms
    is_static = np.array([term.name == STATIC for term in terms])
    scene = np.array([1.0 if static else term.scene for static, term in zip(is_static, terms, strict=True)])
    factor = fit.change + [term.scene for term in terms]
    uncertainty = np.maximum(_SAFETY * fit.bound * max(fit.left, noise), _SETTLED * is_static)

    def wrong(common: float) -> Floats:
        return np.abs(np.where(is_static, factor, factor / common) - scene) > uncertainty

    # all forces and masses may be so many times larger without a difference: as few as possible are taken to be wrong
    kinds_of_contacts = np.array([" of strength " in term.name for term in terms])
    weight = np.where(kinds_of_contacts, 1.0 / max(1, np.count_nonzero(kinds_of_contacts)), 1.0)
    candidates = [float(f) for f in factor[(scene == 1.0) & ~is_static & (uncertainty < 0.1)] if f > 0.0]
    common = min([1.0, *candidates], key=lambda c: float(np.sum(weight[wrong(c)])) + (_MASS_TOO if c != 1.0 else 0.0))
    total, result = _norm(equations.change), []
    for k in np.flatnonzero(wrong(common)):
        value = float(factor[k] if is_static[k] else factor[k] / common)
        effect = abs(value - scene[k]) * _norm(terms[k].column) / total
        what: Literal["mass", "strength"] = "mass" if terms[k].mass else "strength"
        result.append(Departure(terms[k].name, what, value, float(uncertainty[k]), float(scene[k]), effect))
    if common != 1.0:
        name = name_of_beads(equations.usual_mass) if np.ndim(equations.system.mass) else "beads"
        bound = float(np.max(uncertainty[np.isclose(factor, common)]))
        result.append(Departure(name, "mass", 1.0 / common, bound, 1.0, abs(1.0 / common - 1.0)))
    return result


# --- single links and beads -------------------------------------------------------------------------------------------


def _links_and_beads(equations: MomentumEquations, noise: float, limit: float) -> list[Departure] | None:
    """Factors of the links of one kind, or of all masses, one by one; None if none leave less than a limit, [] if two do."""
    masses = LinkImpulses("bead", Ground("bead", Linear(0.0)), equations.change[:, : equations.system.chains])
    families = [*equations.scene_links(), masses]  # a larger mass is a force against the change of momentum
    fits = [(family, *_one_by_one(equations, family)) for family in families]
    explain = [fit for fit in fits if fit[-1] <= limit]
    if len(explain) != 1:
        return None if not explain else []
    ((family, change, size, left),) = explain
    uncertainty = _SAFETY * max(left, noise) / np.where(size > 0.0, size, np.finfo(float).tiny)
    effect = np.abs(change) * size / _norm(equations.change)
    wrong = np.argwhere(np.abs(change) > uncertainty).tolist()
    worst = max(wrong, key=lambda place: abs(float(change[tuple(place)])), default=None)
    result = []
    for line, bead in wrong if len(wrong) <= _MOST_SINGLE else [worst]:
        numbers = (1.0 + change[line, bead], uncertainty[line, bead], 1.0, effect[line, bead])
        what: Literal["mass", "strength"] = "mass" if family is masses else "strength"
        name = f"{family.name} {_place(family.link, line, bead)}"
        count = 1 if len(wrong) <= _MOST_SINGLE else len(wrong)
        result.append(Departure(name, what, *map(float, numbers), count=count))
    return result


def _one_by_one(equations: MomentumEquations, family: LinkImpulses) -> tuple[Floats, Floats, float]:
    """Change of the factor of each link and size of its column, both of the links' shape; norm of what is left."""
    from scipy.sparse.linalg import LinearOperator, lsmr

    link, impulse, shape = family.link, family.impulse, family.impulse.shape[1:]
    size = np.sqrt(np.sum(impulse**2, axis=0) * (1.0 if isinstance(link, Ground) else 2.0))  # on two beads
    felt = np.where(size > _FELT * np.max(size), size, np.inf)

    def column(change: Floats) -> Floats:
        return equations.column(link, impulse * (change.reshape(shape) / felt)).reshape(-1)

    def products(residual: Floats) -> Floats:
        rate = link.rate(residual.reshape(equations.change.shape)[:, equations.lines(link)])  # differences of both ends
        return (-np.sum(impulse * rate, axis=0) / felt).reshape(-1)

    operator = LinearOperator((equations.change.size, size.size), matvec=column, rmatvec=products, dtype=np.float64)
    residual = equations.residual.reshape(-1)
    change = lsmr(operator, residual, atol=_DISTINCT, btol=_DISTINCT, maxiter=_MOST_STEPS)[0]
    return change.reshape(shape) / felt, size, _norm(residual - column(change))


def _place(link: Link, line: int, bead: int) -> str:
    """Place of one of some links."""
    if isinstance(link, Along):
        return f"between beads {bead + 1} and {bead + 2} of chain {line + 1}"
    if isinstance(link, Across):
        lower, higher = link.edges[line]
        return f"between chains {lower + 1} and {higher + 1} in row {bead + 1}"
    return f"{bead + 1} of chain {line + 1}" if link.name == "bead" else f"at bead {bead + 1} of chain {line + 1}"


# --- other laws -------------------------------------------------------------------------------------------------------


def _functions(equations: MomentumEquations, limit: float) -> list[Departure] | None:
    """The force that is another function of the strain, or of time; None if none leaves less than a limit, [] if two do."""
    candidates = [_law(equations, part) for part in equations.scene_links()]
    for load in equations.system.loads:
        others = equations.residual.copy()
        others[:, load.chain - 1, load.bead - 1] = 0.0
        effect = _norm(equations.residual - others) / _norm(equations.change)
        candidates.append((_norm(others), Departure(name_of_load(load), "course", np.nan, np.nan, 1.0, effect)))
    (left, departure), *rest = sorted(candidates, key=lambda candidate: candidate[0])
    if left > limit:
        return None
    return [] if rest and rest[0][0] < max(limit, NOISE * left) else [departure]


def _law(equations: MomentumEquations, part: LinkImpulses) -> tuple[float, Departure]:
    """Norm of what is left where the force of links is multiplied by a function of the strain; and the departure."""
    link, lines, force = part.link, equations.lines(part.link), equations.force(part.link)
    x, v = (values[:, lines] for values in equations.trajectory.atoms)
    strain, rate = (float(np.max(np.abs(values))) or 1.0 for values in (link.strain(x), link.rate(v)))

    def weighted(power: float) -> ForceOfState:
        return lambda t, x, v: force(t, x, v) * (_LEAST + np.abs(link.strain(x[:, lines])) / strain) ** power

    def weighted_by_rate(power: float) -> ForceOfState:
        return lambda t, x, v: force(t, x, v) * (_LEAST + np.abs(link.rate(v[:, lines])) / rate) ** power

    forces = [*map(weighted, _POWERS), *(map(weighted_by_rate, _POWERS) if hasattr(link.law, "damping") else ())]
    columns = [equations.column(link, impulse) for impulse in [part.impulse, *integrals(equations.trajectory, forces)]]
    common, free = least_squares(equations.residual, columns[:1]), least_squares(equations.residual, columns)
    share = common.left / _norm(equations.residual + columns[0])
    factor, bound = float(1.0 + common.change[0]), float(common.bound[0] * common.left)
    return free.left, Departure(part.name, "law", factor, bound, 1.0, share)


# --- shifts in time ---------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class TimeShift:
    """Best shift in time of a quantity against a reference.

    Attributes:
        time: how far it is ahead: at t it has the value that the reference has at t + time; in units of T.
        uncertainty: largest difference from it of the shifts of the first and of the second half.
        explained: share of the squared difference that the shift explains, 0 to 1.
    """

    time: float
    uncertainty: float
    explained: float


def time_shift(difference: Floats, rate: Floats) -> TimeShift:
    """Shift of a quantity in time, by least squares of ``difference = shift * rate``.

    Args:
        difference: [frame, ...] from the reference.
        rate: [frame, ...] time derivative of the reference.
    """
    product, power = (np.sum(values.reshape(len(rate), -1), axis=1) for values in (difference * rate, rate * rate))
    total = float(np.sum(difference * difference))
    if total == 0.0 or np.sum(power) == 0.0:
        return TimeShift(0.0, 0.0, 0.0)
    half = 1 + int(np.searchsorted(np.cumsum(power), 0.5 * np.sum(power)))
    shift, *halves = (
        float(np.sum(product[part]) / max(np.sum(power[part]), np.finfo(float).tiny))
        for part in (slice(None), slice(half), slice(half, None))
    )
    uncertainty = max(abs(part - shift) for part in halves)
    return TimeShift(shift, uncertainty, shift * shift * float(np.sum(power)) / total)
