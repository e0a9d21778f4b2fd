"""Departures of a trajectory from its scene: least squares of factors on forces and masses.

From one frame to the next the momentum of an atom changes by the impulses of all forces on it, which follow from the
recorded motion (`analysis.compare.momentum`), so that

    m_i (v_i(t_n+1) - v_i(t_n)) = sum over k of f_k I_k,i,n

is linear in the factors f_k, 1 where the trajectory follows the scene. Each kind of force or mass has a factor first.
If these do not explain the motion, each link of one kind has one, or each mass; then one force may be another function
of the strain, or of time.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from analysis.compare.momentum import (
    HOLDING,
    STATIC,
    ForceOfState,
    LinkImpulses,
    MomentumEquations,
    integrals,
    name_of_beads,
    name_of_load,
)
from analysis.trajectory import Floats, Trajectory
from lammps_inputs.laws.spring import Linear
from lammps_inputs.links import Links
from lammps_inputs.loads import Load

LEAST_FRAMES = 10

TOO_FAR = 0.03
"""Share of the change of momentum, root mean square, that the interpolation may leave of the reference's."""

NOISE = 3.0
"""Residual over what the interpolation leaves of the reference's, up to which it counts as noise."""

EXPLAINED, NEARLY = 0.03, 0.1
"""Share of the residual that other factors may leave, and another law, to which powers of the strain are only near."""

_BETTER = 0.1
"""Residual that more factors, or another law, must leave at most, over that of fewer factors that explain it, too."""

_SAFETY = 3.0
"""Uncertainty of a factor over the change of it that would make all that is left, as the least that it may be."""

_MASS_TOO = 1.5
"""Kinds of forces that must be wrong by one factor for the mass of most beads to be taken to be wrong instead."""

_MOST_SINGLE = 4
"""Links or beads of a kind that are given one by one."""

_LOADS = (0.0, 0.25, 0.5, 2.0, 4.0)
"""Static loads, over that of the scene, from which the fit starts beside that of the scene."""

_ITERATIONS, _SETTLED = 12, 1e-3
"""Steps to the static load, at most; change of it, over that of the scene, for which the equations are linear."""

_FELT = 1e-6
"""Size of a column over that of the largest one, below which its force has reached nothing."""

_DISTINCT = 1e-9
"""Least eigenvalue of the matrix of correlations of columns that can be distinguished."""

_MOST_STEPS = 200
"""Iterations of the least squares of single links."""

_POWERS, _LEAST = (-2.0, -1.0, 0.0, 0.5, 1.0, 2.0), 0.01
"""Powers of the strain by which the force of another law is multiplied; share of the largest strain
that is added to it, so that negative powers are finite.
"""

_MOST_CHANGE, _DIFFERENCE = 3.0, 1e-4
"""Difference of an exponent or a gap that is looked for, at most; difference by which derivatives are computed."""

_FREQUENCIES = (1.0, 0.8, 0.9, 1.1, 1.25)
"""Frequencies over that of the scene from which the fit of a course over time starts."""


@dataclass(frozen=True)
class Departure:
    """Force or mass of a trajectory that is not the scene's.

    Attributes:
        name: of the force or the beads.
        quantity: what differs: "strength", "mass", "exponent" or "gap" of contacts, "law" (another function of the
            strain), "course" (another function of time) or a parameter of this function.
        factor: on the number of the scene; of what the scene lacks the number itself, dimensionless; of an exponent
            or a gap the difference, of a phase the angle in radians. NaN of a law or a course.
        uncertainty: of the factor.
        scene: factor of the scene: 1, of what it lacks and of an exponent 0, of a phase the angle.
        effect: share of all changes of momentum that it makes, root mean square.
        place: where, of a single link or bead.
        count: number of links or beads of this kind that differ, where only the one that differs most is given.
    """

    name: str
    quantity: str
    factor: float
    uncertainty: float
    scene: float
    effect: float
    place: str = ""
    count: int = 1


@dataclass(frozen=True)
class Identification:
    """Departures of a trajectory from its scene, and how far they are known.

    Attributes:
        departures: largest effect first; empty if none explain the motion.
        unexplained: share of the changes of momentum, root mean square, that the forces of the scene do not explain.
        interpolation: share that they do not explain of the reference's, by interpolation between frames.
        place: line and bead, counted from 0, where most is unexplained.
        ambiguous: whether several causes explain the motion alike, so that none is given.
    """

    departures: tuple[Departure, ...]
    unexplained: float
    interpolation: float
    place: tuple[int, int]
    ambiguous: bool


class Explanation(NamedTuple):
    """Departures that explain a motion, but for a residual of this norm; none if several explain it alike."""

    left: float
    departures: list[Departure]


def identify(trajectory: Trajectory, reference: Trajectory) -> Identification:
    """Find what departs from the scene in a trajectory, if that explains the motion.

    Args:
        trajectory: consecutive frames of all atoms.
        reference: the same frames as the scene has them, from which follows what the interpolation leaves.
    """
    equations, right = MomentumEquations(trajectory), MomentumEquations(reference)
    noise, residual = _norm(right.residual), _norm(equations.residual)
    interpolation = noise / right.size
    best: Explanation | None = None
    if residual > NOISE * noise and interpolation < TOO_FAR:
        for explain, share in ((_kinds, EXPLAINED), (_links_and_beads, EXPLAINED), (_functions, NEARLY)):
            limit = max(NOISE * noise, share * residual)
            best = explain(equations, noise, limit if best is None else min(limit, _BETTER * best.left)) or best
            if best is not None and best.left <= NOISE * noise:
                break
    departures = [] if best is None else sorted(best.departures, key=lambda departure: -departure.effect)
    power = np.sum(equations.residual**2, axis=0)
    line, bead = np.unravel_index(int(np.argmax(power)), power.shape)
    return Identification(
        departures=tuple(departures),
        unexplained=residual / equations.size,
        interpolation=interpolation,
        place=(int(line), int(bead)),
        ambiguous=best is not None and not departures,
    )


def _best(candidates: list[Explanation], noise: float, limit: float) -> Explanation | None:
    """Best of several explanations, without departures if another is as good; None if all leave more than a limit."""
    best, *others = sorted(candidates, key=lambda explanation: explanation.left)
    if best.left > limit:
        return None
    alike = others and others[0].left < NOISE * max(noise, best.left)
    return Explanation(best.left, []) if alike else best


def _norm(values: Floats) -> float:
    return float(np.linalg.norm(values))


# --- kinds of forces and masses ---------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class LeastSquares:
    """Fit of a residual by columns.

    Attributes:
        change: [column] change of each factor; 0 where it cannot be distinguished from others.
        bound: [column] largest change of each factor by an error of the residual of norm 1; infinite where it cannot be
            distinguished.
        left: norm of the residual of the fit.
    """

    change: Floats
    bound: Floats
    left: float


def least_squares(residual: Floats, columns: Sequence[Floats]) -> LeastSquares:
    """Fit a residual, [...], by columns of its shape."""
    size = np.array([_norm(column) for column in columns])
    change, bound = np.zeros(len(columns)), np.full(len(columns), np.inf)
    felt = [k for k in range(len(columns)) if size[k] > _FELT * np.max(size)]
    if not felt:
        return LeastSquares(change, bound, _norm(residual))
    unit = [columns[k] / size[k] for k in felt]
    value, vector = np.linalg.eigh(np.array([[np.vdot(a, b) for b in unit] for a in unit]))
    distinct = value > _DISTINCT
    inverse = vector[:, distinct] / value[distinct] @ vector[:, distinct].T
    change[felt] = inverse @ [np.vdot(column, residual) for column in unit] / size[felt]
    mixed = np.sum(vector[:, ~distinct] ** 2, axis=1) > _DISTINCT
    bound[felt] = np.where(mixed, np.inf, np.sqrt(np.diag(inverse)) / size[felt])
    fitted = sum((factor * column for factor, column in zip(change, columns, strict=True)), np.zeros_like(residual))
    return LeastSquares(change, bound, _norm(residual - fitted))


def _kinds(equations: MomentumEquations, noise: float, limit: float) -> Explanation | None:
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
                return Explanation(fit.left, _departures(at_load, fit, noise))
            if abs(change) < _SETTLED:
                break
            load = min(max(at_load.load + change, 0.3 * at_load.load), 3.0 * at_load.load + 10.0 * _SETTLED)
            at_load = MomentumEquations(equations.trajectory, load)
    return None


def _departures(equations: MomentumEquations, fit: LeastSquares, noise: float) -> list[Departure]:
    """Factors that differ from those of the scene by more than their uncertainty."""
    terms = equations.terms
    is_load = np.array([term.name in (STATIC, HOLDING) for term in terms])
    scene = np.array([1.0 if term.name == STATIC else term.scene for term in terms])
    factor = fit.change + np.array([term.scene for term in terms])
    uncertainty = np.maximum(_SAFETY * fit.bound * max(fit.left, noise), _SETTLED * is_load)

    def over(common: float) -> Floats:
        """Factors, [term], divided by a common factor; those of static loads as they are."""
        return np.asarray(np.where(is_load, factor, factor / common))

    def wrong(common: float) -> Floats:
        """Mask, [term], of the factors that differ then from the scene's by more than their uncertainty."""
        return np.asarray(np.abs(over(common) - scene) > uncertainty)

    # all forces and masses may be so many times larger without a difference: as few as possible are taken to be wrong
    kinds_of_contacts = np.array([" of strength " in term.name for term in terms])
    weight = np.where(kinds_of_contacts, 1.0 / max(1, int(np.count_nonzero(kinds_of_contacts))), 1.0)
    candidates = [float(f) for f in factor[(scene == 1.0) & ~is_load & (uncertainty < 0.1)] if f > 0.0]

    def cost(common: float) -> float:
        return float(np.sum(weight[wrong(common)])) + (_MASS_TOO if common != 1.0 else 0.0)

    common = min([1.0, *candidates], key=cost)
    result = []
    for k in np.flatnonzero(wrong(common)).tolist():
        value = float(over(common)[k])
        effect = abs(value - scene[k]) * _norm(terms[k].column) / equations.size
        quantity = "mass" if terms[k].mass else "strength"
        result.append(Departure(terms[k].name, quantity, value, float(uncertainty[k]), float(scene[k]), effect))
    if common != 1.0:
        name = name_of_beads(equations.usual_mass) if np.ndim(equations.system.mass) else "beads"
        bound = float(np.max(uncertainty[np.isclose(factor, common)]))
        result.append(Departure(name, "mass", 1.0 / common, bound, 1.0, abs(1.0 / common - 1.0)))
    return result


# --- single links and beads -------------------------------------------------------------------------------------------


def _links_and_beads(equations: MomentumEquations, noise: float, limit: float) -> Explanation | None:
    """Factors of single links of one kind, or of single masses; None if they leave more than a limit."""
    # a larger mass is a force against the change of momentum
    masses = LinkImpulses("bead", Links.ground("bead", Linear(0.0)), equations.change[:, : equations.system.chains])
    families = [(part, "strength") for part in equations.scene_links()] + [(masses, "mass")]
    return _best([_one_by_one(equations, part, quantity, noise) for part, quantity in families], noise, limit)


def _one_by_one(equations: MomentumEquations, family: LinkImpulses, quantity: str, noise: float) -> Explanation:
    """Factors of single links, of those that differ from 1 by more than their uncertainty."""
    change, size, left = _single_factors(equations, family)
    uncertainty = _SAFETY * max(left, noise) / np.maximum(size, _FELT * np.max(size) or 1.0)
    wrong = np.argwhere(np.abs(change) > uncertainty)
    wrong = wrong[np.argsort(-np.abs(change[tuple(wrong.T)]), kind="stable")]
    count = 1 if len(wrong) <= _MOST_SINGLE else len(wrong)
    departures = [
        Departure(
            name=family.name,
            place=_place(family.link, line, bead),
            quantity=quantity,
            factor=float(1.0 + change[line, bead]),
            uncertainty=float(uncertainty[line, bead]),
            scene=1.0,
            effect=float(abs(change[line, bead]) * size[line, bead]) / equations.size,
            count=count,
        )
        for line, bead in (wrong if count == 1 else wrong[:1]).tolist()
    ]
    return Explanation(left, departures)


def _single_factors(equations: MomentumEquations, family: LinkImpulses) -> tuple[Floats, Floats, float]:
    """Change of the factor of each link and size of its column, both of the links' shape; norm of the residual."""
    from scipy.sparse.linalg import LinearOperator, lsmr

    link, impulse, shape = family.link, family.impulse, family.impulse.shape[1:]
    size = np.sqrt(np.sum(impulse**2, axis=0) * len(link.ends))
    felt = np.where(size > _FELT * np.max(size), size, np.inf)

    def column(change: Floats) -> Floats:
        """Change of momentum, [interval * line * bead], by scaled changes of factors, [link]."""
        return equations.column(link, impulse * (change.reshape(shape) / felt)).reshape(-1)

    def products(residual: Floats) -> Floats:
        """Products of a residual, [interval * line * bead], with the columns of all links, [link]."""
        rate = link.rate(residual.reshape(equations.change.shape)[:, equations.lines(link)])  # differences of both ends
        return np.asarray(-np.sum(impulse * rate, axis=0) / felt).reshape(-1)

    operator = LinearOperator((equations.change.size, size.size), matvec=column, rmatvec=products, dtype=np.float64)
    residual = equations.residual.reshape(-1)
    change = lsmr(operator, residual, atol=_DISTINCT, btol=_DISTINCT, maxiter=_MOST_STEPS)[0]
    return change.reshape(shape) / felt, size, _norm(residual - column(change))


def _place(link: Links, line: int, bead: int) -> str:
    """Place of one of some links."""
    if link.kind == "along":
        return f"between beads {bead + 1} and {bead + 2} of chain {line + 1}"
    if link.kind == "closing":
        return f"between the last bead and bead 1 of chain {line + 1}"
    if link.kind == "across":
        lower, higher = link.edges[line]
        return f"between chains {lower + 1} and {higher + 1} in row {bead + 1}"
    return f"{bead + 1} of chain {line + 1}" if link.name == "bead" else f"at bead {bead + 1} of chain {line + 1}"


# --- other laws -------------------------------------------------------------------------------------------------------


def _functions(equations: MomentumEquations, noise: float, limit: float) -> Explanation | None:
    """One force that is another function of strain or time; None if it leaves more than a limit."""
    laws = [_other_law(equations, part) for part in equations.scene_links()]
    courses = [_other_course(equations, load, noise) for load in equations.system.loads]
    return _best(laws + courses, noise, limit)


def _other_law(equations: MomentumEquations, part: LinkImpulses) -> Explanation:
    """Force that is another function of the strain: with another exponent or gap, if one explains it, or unknown."""
    effect = _norm(equations.residual) / equations.size
    exponent = _other_parameters_of(equations, part, _of_exponent)
    gap = _other_parameters_of(equations, part, _of_gap) if part.link.kind in ("along", "closing") else None
    named = [fit for fit in (exponent, gap) if fit is not None]
    multiplied = _multiplied(equations, part)
    if named:
        best = min(named, key=lambda fit: fit.left)
        if best.left <= max(multiplied, EXPLAINED * _norm(equations.residual)):
            departures = [replace(departure, name=part.name, effect=effect) for departure in best.departures]
            return Explanation(best.left, departures)
    return Explanation(multiplied, [Departure(part.name, "law", np.nan, np.nan, 0.0, effect)])


def _multiplied(equations: MomentumEquations, part: LinkImpulses) -> float:
    """Residual of the force multiplied by powers of the strain."""
    link, lines, force = part.link, equations.lines(part.link), equations.force(part.link)
    largest = float(np.max(np.abs(link.strain(equations.trajectory.atoms[0][:, lines])))) or 1.0

    def multiplied(power: float) -> ForceOfState:
        return lambda t, x, v: force(t, x, v) * (_LEAST + np.abs(link.strain(x[:, lines])) / largest) ** power

    impulses = integrals(equations.trajectory, [multiplied(power) for power in _POWERS])
    return least_squares(equations.residual, [equations.column(link, impulse) for impulse in impulses]).left


Family = Callable[[MomentumEquations, LinkImpulses], tuple[str, Callable[[float], ForceOfState]] | None]
"""Name of a number of a law, and the force at a difference of it from the scene's; None where a law has none."""


def _of_exponent(
    equations: MomentumEquations, part: LinkImpulses
) -> tuple[str, Callable[[float], ForceOfState]] | None:
    """Contacts of a power of the overlap, without a static load, or linear springs, that have another power."""
    link, lines, force = part.link, equations.lines(part.link), equations.force(part.link)
    if (link.law.exponent is None and not link.law.linear) or np.any(link.law.load):
        return None

    def of(change: float) -> ForceOfState:
        def changed(t: Floats, x: Floats, v: Floats) -> Floats:
            """Force of each link, [..., link], of the changed exponent."""
            return np.asarray(force(t, x, v) * np.maximum(np.abs(link.strain(x[:, lines])), _DISTINCT) ** change)

        return changed

    return "exponent", of


def _of_gap(equations: MomentumEquations, part: LinkImpulses) -> tuple[str, Callable[[float], ForceOfState]] | None:
    """Contacts without a static load that close at another distance of the beads."""
    link = part.link
    if np.any(link.law.load) or link.law.exponent is None:
        return None
    return "gap", lambda change: equations.force(replace(link, gap=link.gap + change))


def _other_parameters_of(equations: MomentumEquations, part: LinkImpulses, family: Family) -> Explanation | None:
    """Factor on a force and difference of one of its numbers, by Gauss and Newton's method; None where it has none."""
    named = family(equations, part)
    if named is None:
        return None
    quantity, force = named
    target = equations.residual + equations.column(part.link, part.impulse)
    strength, change, limit = 1.0, 0.0, _MOST_CHANGE
    for _ in range(_ITERATIONS):
        impulses = integrals(equations.trajectory, [force(change), force(change + _DIFFERENCE)])
        column, further = (equations.column(part.link, impulse) for impulse in impulses)
        fit = least_squares(target - strength * column, [column, strength * (further - column) / _DIFFERENCE])
        step = float(np.clip(fit.change[1], -0.5, 0.5))
        strength, change = strength + float(fit.change[0]), float(np.clip(change + step, -limit, limit))
        if abs(step) < _SETTLED * _DIFFERENCE + 1e-3 * fit.bound[1] * fit.left:
            break
    # a difference of the derivative is known to the difference with which it was computed
    uncertainty = _SAFETY * fit.bound * fit.left + np.array([0.0, _SETTLED * abs(change)])
    departures = []
    if abs(change) > uncertainty[1]:
        departures.append(Departure(part.name, quantity, change, float(uncertainty[1]), 0.0, 0.0))
    if quantity == "gap" and abs(strength - 1.0) > max(uncertainty[0], 1e-3):  # else it depends on the unit of length
        departures.append(Departure(part.name, "strength", strength, float(uncertainty[0]), 1.0, 0.0))
    if not any(departure.quantity == quantity for departure in departures):
        return None
    return Explanation(fit.left, departures)


def _other_course(equations: MomentumEquations, load: Load, noise: float) -> Explanation:
    """Another force from outside on one bead, by its parameters if these explain its impulses."""
    times, residual = equations.trajectory.time, equations.residual[:, load.chain - 1, load.bead - 1]
    others = equations.residual.copy()
    others[:, load.chain - 1, load.bead - 1] = 0.0
    effect = _norm(residual) / equations.size
    departures = [Departure(name_of_load(load), "course", np.nan, np.nan, 1.0, effect)]
    if load.law.numbers:
        departures = (
            other_parameters(
                name_of_load(load),
                load.law.numbers,
                lambda *numbers: np.diff(replace(load, law=load.law.of(*numbers)).impulse(times)),
                np.diff(load.impulse(times)) + residual,
                max(NOISE * noise, EXPLAINED * _norm(residual)),
            )
            or departures
        )
    return Explanation(_norm(others), departures)


def other_parameters(
    name: str, parameters: dict[str, float], course: Callable[..., Floats], values: Floats, limit: float
) -> list[Departure]:
    """Parameters of a function of time that differ from those of the scene; empty if none leave less than a limit.

    Args:
        name: of the force or motion.
        parameters: those of the scene.
        course: the function, [frame], of the parameters.
        values: [frame] what it is in the trajectory.
        limit: norm of what the function may leave of the values.
    """
    from scipy import optimize

    scene = np.array(list(parameters.values()))
    frequency = np.array([key == "omega" for key in parameters])
    phase = np.array([key == "phase" for key in parameters])
    lowest = np.where(phase, scene - np.pi, np.where(scene > 0.0, 0.0, -np.inf))
    highest = np.where(phase, scene + np.pi, np.where(scene < 0.0, 0.0, np.inf))
    for factor in _FREQUENCIES if any(frequency) else (1.0,):
        fit = optimize.least_squares(
            lambda trial: course(*trial) - values,
            np.where(frequency, factor * scene, scene),
            bounds=(lowest, highest),
            x_scale=np.abs(scene) + _LEAST,
        )
        left = _norm(fit.fun)
        if left <= limit:
            break
    else:
        return []
    bound = _SAFETY * left * np.sqrt(np.abs(np.diag(np.linalg.pinv(fit.jac.T @ fit.jac)))) + _DISTINCT
    effect = _norm(course(*scene) - values)
    departures = []
    for key, number, value, uncertainty in zip(parameters, scene.tolist(), fit.x.tolist(), bound.tolist(), strict=True):
        if abs(value - number) <= uncertainty:
            continue
        unit = 1.0 if key == "phase" or number == 0.0 else abs(number)
        departures.append(Departure(name, key, value / unit, uncertainty / unit, number / unit, effect))
    return departures


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
