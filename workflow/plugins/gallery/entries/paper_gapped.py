"""Section 3 of the paper: gapped beads, rigid and Hertzian; eqs 2 to 5, Figs 8 and 9, and the statements about them.

Two chains throughout, bead 1 of chain 1 kicked with V = 1. Two models of the same gap: rigid beads (engine
`collisions`) depend on theta = omega D / V alone, omega = sqrt(2 kappa); Hertz beads (eq. 2, the reference) also on
kappa, through the ratio of the duration of a contact to the period of the springs.

The impulse of row n is that which bead n receives from bead n - 1; see `analysis.sharing.impulses`.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from granchain.parts import THETA_OF_EQ_5, Floats, Integers, Problem, Trajectory, impulses, library, page, physics
from granchain.parts import engine as reference
from workflow.plugins.gallery.criteria import MeasuredQuantity, at_least, at_most, near, state
from workflow.plugins.gallery.engines_figure import (
    EngineCurve,
    PublishedPoint,
    engines_figure,
    relative_mode_figure,
    scan_figure,
)
from workflow.plugins.gallery.entry import Entry, Results, Statements
from workflow.plugins.rigid import engine as collisions
from workflow.plugins.rigid import events

AGREE = 0.01
"""Relative difference of the chains' impulses up to which they count as equal (the paper: "identical")."""

SLOWEST = 0.25
"""Speed of the slowest pulse that a run of Hertz beads waits for, in units of V: below equal sharing (1/2)."""

LAST_STRAGGLERS = 0.01
"""Speed of the slowest pulse for rigid beads (V), some of which first collide with beads behind the pulse."""


def problem_at(theta: float, kappa: float, row: int, *, every: float = 0.25, slowest: float = SLOWEST) -> Problem:
    """Problem of two chains in which the pulse passes a row, with ten rows more and the time for a few periods.

    Args:
        theta: omega D / V.
        kappa: stiffness of the springs.
        row: number of the last bead of interest.
        every: time between frames, in units of T.
        slowest: speed of the slowest pulse that passes the row within the duration, in units of V.
    """
    omega = math.sqrt(2.0 * kappa)
    gap = theta / omega
    duration = row * (gap / slowest + 3.0) + 6.0 * math.pi / omega
    scene = {
        "name": "gapped",
        "chains": 2,
        "beads": row + 10,
        "coupling": {"stiffness": kappa},
        "gap": gap,
        "kick": {"velocity": 1.0},
        "duration": every * math.ceil(duration / every),
        "timestep": every,
        "output": {"every": every},
    }
    return library.from_plain(scene, "gapped").problem()


def rigid_problem(theta: float, row: int) -> Problem:
    """Problem of rigid beads at a theta until all have collided; kappa = 1/2, so omega = 1 and D = theta."""
    return problem_at(theta, 0.5, row, slowest=LAST_STRAGGLERS)


def rigid_impulses(problem: Problem) -> impulses.Impulses:
    """Impulses of a problem's rigid beads."""
    return _impulses(problem, collisions.run(problem))


def _impulses(problem: Problem, run: collisions.CollisionRun) -> impulses.Impulses:
    return events.from_events(problem, events.Collisions(run.time, run.chain, run.row, run.striker, run.target))


def hertz_impulses(problem: Problem) -> impulses.Impulses:
    """Impulses of a problem's Hertz beads, by the reference, frame by frame."""
    return impulses.measure(problem, reference.blocks(problem))


def curves(problem: Problem, rows: Sequence[int]) -> list[EngineCurve]:
    """Velocities over time and first impulses of rows of rigid beads (exact) and of Hertz beads (reference)."""
    place = [int(np.flatnonzero(problem.rows.numbers == row)[0]) for row in rows]
    rigid = collisions.run(problem)
    models: dict[str, tuple[Iterable[Trajectory], impulses.Impulses]] = {
        "rigid": (collisions.blocks(rigid), _impulses(problem, rigid)),
        "Hertz": (reference.blocks(problem), hertz_impulses(problem)),
    }
    engine_curves = []
    for name, (blocks, received) in models.items():
        parts = [(block.time, block.velocity[:, :, place].copy()) for block in blocks]
        time, velocity = (np.concatenate(column) for column in zip(*parts, strict=True))
        engine_curves.append(EngineCurve(name, time, velocity, received.bead, received.first))
    return engine_curves


# --- the first row ----------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class FirstRow:
    """The first row up to the first collision of each chain, rigid: eqs 3-5 and the sentence after them.

    Attributes:
        phase: omega t of the two collisions, [chain].
        striker, target: velocities before the collision, [chain], in units of V.
        other_bead: displacement of bead 1 of chain 2 at the first collision, as a share of D.
    """

    phase: Floats
    striker: Floats
    target: Floats
    other_bead: float


def first_row(theta: float) -> FirstRow:
    """The first collision of each chain at some theta at which both collide."""
    problem = rigid_problem(theta, 2)
    run = collisions.run(problem)
    index = np.array([np.flatnonzero((run.row == 1) & (run.chain == chain))[0] for chain in (1, 2)])
    start = collisions.sample(run, run.time[index[:1]])
    share = float(start.displacement[0, 1, 0]) / physics.gap(problem.system)
    return FirstRow(run.time[index].copy(), run.striker[index], run.target[index], share)


def _sharing_in_the_first_row() -> Statements:
    first = first_row(THETA_OF_EQ_5)
    later = {"rigid beads": float(first.phase[1] - first.phase[0]) / np.pi}
    yield state(
        MeasuredQuantity(
            "time between the first collisions of the two chains, omega t / pi", later, near(0.0, 1e-6), "6"
        ),
        published="At the gap of eq. 5 the first row has shared its energy equally when it collides.",
        source="starosvetsky2013, sentence after eq. 5",
        derived="By eqs 3 and 4 the energy is shared equally if velocities and displacements of the two beads are "
        "equal, so that both chains collide at one time. Equal velocities (cos = 0) and equal displacements (sin = "
        "0) exclude each other.",
        correction="At that instant the two velocities are equal but the displacements are not, so chain 2 collides "
        "later, unequally.",
        also=[
            f"chain 1 collides at omega t = {first.phase[0] / np.pi:.6f} pi with {first.striker[0]:.6f} V; bead 1 of "
            f"chain 2 has then moved by {first.other_bead:.4f} D",
            f"chain 2 collides at omega t = {first.phase[1] / np.pi:.6f} pi, with {first.striker[1]:.6f} V against "
            f"{first.target[1]:.6f} V",
        ],
    )


# --- rigid beads over theta -------------------------------------------------------------------------------------------

THETAS = np.linspace(0.02, 8.0, 800)
ROWS = (5, 25)
EQUAL = "Equal: first impulses differ by at most 1% of their mean."


@dataclass(frozen=True)
class Scan:
    """First impulses of rigid rows over theta.

    Attributes:
        theta: omega D / V, [theta].
        bead: numbers of the beads, [row].
        difference: difference of the impulses of the chains, (largest - smallest) / mean, [theta, row]; 2 where one
            chain received nothing.
    """

    theta: Floats
    bead: Integers
    difference: Floats

    def keeping(self, first_bead: int, last_bead: int) -> Floats:
        """Thetas at which the chains agree in every row of a range, [theta]."""
        rows = (self.bead >= first_bead) & (self.bead <= last_bead)
        return self.theta[np.all(self.difference[:, rows] <= AGREE, axis=1)]


def scan(thetas: Floats, last_bead: int = 30) -> Scan:
    """Compute first impulses of rigid rows at thetas, [theta], up to a last bead; it takes about 2 ms a theta."""
    bead = np.arange(2, last_bead + 1)
    first = [rigid_impulses(rigid_problem(theta, last_bead)).first[:, : len(bead)] for theta in thetas]
    return Scan(thetas, bead, np.array([impulses.relative_difference(received) for received in first]))


def sensitivity(thetas: Iterable[float], bead: int = 25) -> Floats:
    """Largest change of a rigid row's first impulses when D changes by a relative 1e-13, [theta].

    Late rows amplify rounding: where this is not small, the impulse is a property of the arithmetic, not of theta.
    """
    changes = []
    for theta in thetas:
        nominal, perturbed = (
            rigid_impulses(rigid_problem(value, bead)).first[:, bead - 2] for value in (theta, theta * (1.0 + 1e-13))
        )
        changes.append(float(np.max(np.abs(nominal - perturbed))))
    return np.array(changes)


@cache
def _scan() -> Scan:
    return scan(THETAS)


def _partition_of_rigid_beads(rigid: impulses.Impulses) -> Statements:
    swept = _scan()
    sensitive = sensitivity(THETAS[:: len(THETAS) // 100])
    at_25, keeping = swept.keeping(25, 25), {"rigid beads": len(swept.keeping(20, 30))}
    median = dict(zip(swept.bead, np.median(swept.difference, axis=0), strict=True))
    name = "difference of the impulses at the gap of eq. 5"
    apart = {row: {"rigid beads": float(impulses.relative_difference(rigid.first)[rigid.row(row)])} for row in ROWS}
    yield state(
        *(MeasuredQuantity(f"{name}, row {row}", difference, at_most(0.01), "3") for row, difference in apart.items()),
        MeasuredQuantity("gaps at which rows 20 to 30 agree within 1%", keeping, at_least(1.0), "0"),
        published="Rigid beads: the pulse is partitioned equally among the chains.",
        source="starosvetsky2013, Figs 8 and 9, rows 5 and 25",
        derived=EQUAL,
        correction="Rigid rows do not equipartition: single rows agree at single gaps, no gap keeps the agreement. "
        "Late rows amplify rounding, so a picture of row 25 shows the arithmetic as much as the model.",
        also=[
            *(_pair(f"theta = {THETA_OF_EQ_5:.4f}, row {row}", rigid, row) for row in ROWS),
            f"{len(at_25)} of {len(THETAS)} gaps ({len(at_25) / len(THETAS):.1%}) agree within 1% at row 25",
            f"median difference over all gaps: {median[5]:.2f} at row 5, {median[25]:.2f} at row 25",
            "a change of D by 1e-13 changes the impulses of row 25 by more than 0.01 at "
            f"{np.mean(sensitive > 0.01):.1%} of the gaps",
        ],
    )


def _pair(label: str, received: impulses.Impulses, row: int) -> str:
    first, second = received.first[:, received.row(row)]
    return f"{label}: first impulses {first:.3f}, {second:.3f}"


# --- Hertz beads ------------------------------------------------------------------------------------------------------

KAPPAS = (0.1, 1.0)
LAST = 120


@dataclass(frozen=True)
class RelativeMode:
    """Difference of the impulses of the chains over the rows.

    Attributes:
        bead: numbers of the beads, [row].
        difference: (I_1 - I_2) / (I_1 + I_2) of the first impulses, [row]; NaN where nothing passed.
        rows_per_e: number of rows in which the size of the difference falls by e, by least squares of its logarithm;
            inf where it does not fall.
        equal_from: first bead from which on the chains agree to `AGREE`; None if they never do, or only at the end.
    """

    bead: Integers
    difference: Floats
    rows_per_e: float
    equal_from: int | None


def relative_mode(received: impulses.Impulses, first_bead: int, last_bead: int) -> RelativeMode:
    """Relative mode of two chains between two rows; the fit takes every row, also those near a change of sign."""
    rows = slice(received.row(first_bead), received.row(last_bead) + 1)
    bead, first = received.bead[rows], received.first[:, rows]
    with np.errstate(invalid="ignore", divide="ignore"):
        difference = (first[0] - first[1]) / first.sum(axis=0)
    fitted = np.isfinite(difference) & (difference != 0.0)
    slope = float(np.polyfit(bead[fitted], np.log(np.abs(difference[fitted])), 1)[0])
    apart = np.flatnonzero(~(2.0 * np.abs(difference) <= AGREE))
    start = int(apart[-1]) + 1 if len(apart) else 0
    equal_from = int(bead[start]) if start < len(bead) - 5 else None
    return RelativeMode(bead, difference, -1.0 / slope if slope < 0.0 else math.inf, equal_from)


@cache
def _both_models() -> tuple[dict[float, impulses.Impulses], impulses.Impulses]:
    """Impulses at the gap of eq. 5 of Hertz beads by coupling, and of rigid ones."""
    hertz = {kappa: hertz_impulses(problem_at(THETA_OF_EQ_5, kappa, LAST)) for kappa in KAPPAS}
    return hertz, rigid_impulses(rigid_problem(THETA_OF_EQ_5, LAST))


def _partition_of_hertz_beads(hertz: dict[float, impulses.Impulses]) -> Statements:
    modes = {f"kappa = {kappa:g}": relative_mode(received, 10, LAST) for kappa, received in hertz.items()}
    since = {name: math.nan if mode.equal_from is None else mode.equal_from for name, mode in modes.items()}
    yield state(
        MeasuredQuantity("row from which on impulses agree within 1%", since, at_most(LAST), "0"),
        published="Beads with gaps and Hertzian contacts (eq. 2) reach equipartition.",
        source="starosvetsky2013, eq. 2, Figs 8 and 9",
        derived=f"{EQUAL} Contacts have a duration, in which the springs act; that equalises the chains.",
        also=[
            *(
                _pair(f"kappa = {kappa:g}, row {row}", received, row)
                for kappa, received in hertz.items()
                for row in (*ROWS, 100)
            ),
            *(f"{name}: the difference decays by e in {mode.rows_per_e:.1f} rows" for name, mode in modes.items()),
        ],
    )


# --- rigid beads as a limit -------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class RigidLimit:
    """Gapped Hertz beads at theta = 1 as kappa falls, against rigid ones.

    Attributes:
        kappa: stiffnesses of the springs, falling, [kappa].
        bead: numbers of the beads, [row].
        rigid: first impulses of rigid beads, [chain, row], in units of m V.
        hertz: first impulses of Hertz beads, [kappa, chain, row], in units of m V.
        difference: largest difference of the two over the chains, [kappa, row], in units of m V.
        rate: exponent p of ``difference ~ kappa**p`` of each row, over the last three kappas, [row].
    """

    kappa: Floats
    bead: Integers
    rigid: Floats
    hertz: Floats
    difference: Floats
    rate: Floats


def rigid_limit() -> RigidLimit:
    """Compute the limit in which Hertz beads with gaps become rigid ones, in rows 2 to 4.

    A contact lasts about 2.44 T and a period 2 pi / sqrt(2 kappa) T, so their ratio, and with it the difference, falls
    as sqrt(kappa): rate 1/2. At larger kappa a bead may collide in one model only, the more so the farther along the
    chain: the limit is reached row by row.
    """
    kappas, bead = np.array([1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6]), np.arange(2, 5)
    rigid = rigid_impulses(rigid_problem(1.0, 4)).first[:, : len(bead)]
    hertz = np.array([hertz_impulses(problem_at(1.0, kappa, 4)).first[:, : len(bead)] for kappa in kappas])
    difference = np.max(np.abs(hertz - rigid), axis=1)
    rate = np.polyfit(np.log(kappas[-3:]), np.log(difference[-3:]), 1)[0]
    return RigidLimit(kappas, bead, rigid, hertz, difference, np.asarray(rate))


def _limit() -> Statements:
    limit = rigid_limit()
    worst = {
        f"kappa = {kappa:g}": float(difference.max())
        for kappa, difference in zip(limit.kappa, limit.difference, strict=True)
    }
    rates = {f"row {bead}": float(rate) for bead, rate in zip(limit.bead, limit.rate, strict=True)}
    within, rows = at_most(0.01, math.inf), f"rows 2 to {limit.bead[-1]}"
    yield state(
        MeasuredQuantity(f"largest difference of the impulses in {rows}", worst, within, "3"),
        MeasuredQuantity("exponent of the difference in kappa", rates, near(0.5, 0.05), "2"),
        published="The rigid model represents the gapped array.",
        source="starosvetsky2013, section 3",
        derived="A contact lasts 2.44 T and a period of the springs 2 pi T / sqrt(2 kappa): at fixed theta (here 1) "
        "the difference falls as sqrt(kappa).",
        correction="As a limit at fixed theta only: early rows tend to the rigid ones as the square root of kappa. "
        "At the couplings of the figures a contact lasts a considerable part of a period, and the two models differ.",
    )


# --- entry ------------------------------------------------------------------------------------------------------------


def statements(_: Results) -> Statements:
    """Statements on the gap of eq. 5, rigid beads, Hertz beads, and rigid beads as a limit of Hertz beads."""
    hertz, rigid = _both_models()
    yield from _sharing_in_the_first_row()
    yield from _partition_of_rigid_beads(rigid)
    yield from _partition_of_hertz_beads(hertz)
    yield from _limit()


def pictures(_: Results) -> list[page.PageFigure]:
    """Figs 8 and 9, the scan and the relative mode."""
    swept, (hertz, rigid) = _scan(), _both_models()
    figures = []
    for kappa, number in zip(KAPPAS, (8, 9), strict=True):
        problem = problem_at(THETA_OF_EQ_5, kappa, 40, every=0.05)
        caption = f"Fig. {number}: first impulses, and velocities of beads 5 and 25; kappa = {kappa:g}, gap of eq. 5."
        figures.append(page.drawn(f"fig{number}", engines_figure(problem, ROWS, curves(problem, ROWS)), caption))
    shown = (5, 25, 30)
    rows, chosen = np.isin(swept.bead, shown), scan(np.array([THETA_OF_EQ_5]))
    published = PublishedPoint("gap of eq. 5", THETA_OF_EQ_5, chosen.difference[0, rows])
    scanned = scan_figure(swept.theta, swept.difference[:, rows], shown, AGREE, published)
    figures.append(page.drawn("scan", scanned, "Rigid beads: difference of the chains over the gap."))
    labelled = {"rigid": rigid, **{rf"Hertz, $\kappa$ = {kappa:g}": received for kappa, received in hertz.items()}}
    modes = {label: relative_mode(received, 2, LAST) for label, received in labelled.items()}
    curve = relative_mode_figure([(label, mode.bead, mode.difference) for label, mode in modes.items()])
    caption = (
        "Difference of the chains over the rows, at the gap of eq. 5: it decays for Hertzian beads, not for rigid ones."
    )
    return [*figures, page.drawn("relative-mode", curve, caption)]


ENTRY = Entry(
    title="Pulse equipartition, section 3: beads with gaps, rigid and Hertzian (eqs 2 to 5, Figs 8 and 9)",
    introduction=(
        "Two chains whose beads are a clear distance D apart, bead 1 of chain 1 kicked with V = 1. Rigid beads move "
        "by the exact modes of their rows and exchange velocities in collisions; they depend on theta = omega D / V "
        f"alone, with omega = sqrt(2 kappa). The gap of eq. 5 is theta = {THETA_OF_EQ_5:.4f}. The impulse of row n "
        "is that which bead n receives from bead n - 1, in units of m V."
    ),
    sources={"starosvetsky2013": "section 3"},
    scenes={},
    statements=statements,
    pictures=pictures,
)
