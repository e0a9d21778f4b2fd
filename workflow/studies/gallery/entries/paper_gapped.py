"""Section 3 of the paper: gapped beads, rigid and Hertzian; eqs 2 to 5, Figs 8 and 9, and the statements about them."""

import math
from functools import cache

import numpy as np

from analysis.figures.engines import engines_figure, relative_mode_figure, scan_figure
from analysis.sharing.impulses import Impulses, relative_difference
from workflow.engines.collisions.modes import THETA_OF_EQ_5
from workflow.studies.gallery import rigid_rows
from workflow.studies.gallery.criteria import Measured, at_least, at_most, near, state
from workflow.studies.gallery.entry import Entry, Results
from workflow.studies.page import Picture, Statement, drawn

THETAS = np.linspace(0.02, 8.0, 800)
KAPPAS = (0.1, 1.0)
FIGURES = {0.1: "fig8", 1.0: "fig9"}
ROWS = (5, 25)
EQUAL = "Equal: first impulses differ by at most 1% of their mean."
LAST = 120


@cache
def _scan() -> rigid_rows.Scan:
    return rigid_rows.scan(THETAS)


@cache
def _both_models() -> tuple[dict[float, Impulses], Impulses]:
    """Impulses at the gap of eq. 5 of Hertz beads by coupling, and of rigid ones."""
    hertz = {kappa: rigid_rows.hertz_impulses(rigid_rows.problem_at(THETA_OF_EQ_5, kappa, LAST)) for kappa in KAPPAS}
    return hertz, rigid_rows.rigid_impulses(rigid_rows.rigid_problem(THETA_OF_EQ_5, LAST))


def statements(_: Results) -> list[Statement]:
    """The gap of eq. 5, rigid beads, Hertz beads, and the one as the limit of the other."""
    hertz, rigid = _both_models()
    return [_first_row(), _rigid(rigid), _hertz(hertz), _limit()]


def _first_row() -> Statement:
    first = rigid_rows.first_row(THETA_OF_EQ_5)
    later = {"rigid beads": float(first.phase[1] - first.phase[0]) / np.pi}
    return state(
        Measured("time between the first collisions of the two chains, omega t / pi", later, near(0.0, 1e-6), "6"),
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


def _rigid(rigid: Impulses) -> Statement:
    scan = _scan()
    sensitive = rigid_rows.sensitivity(THETAS[:: len(THETAS) // 100], bead=25)
    at_25, keeping = scan.keeping(25, 25), scan.keeping(20, 30)
    median = dict(zip(scan.bead, np.median(scan.difference(), axis=0), strict=True))
    return state(
        *(
            Measured(
                f"difference of the impulses at the gap of eq. 5, row {row}", _apart(rigid, row), at_most(0.01), "3"
            )
            for row in ROWS
        ),
        Measured(
            "gaps at which rows 20 to 30 agree within 1%", {"rigid beads": float(len(keeping))}, at_least(1.0), "0"
        ),
        published="Rigid beads: the pulse is partitioned equally among the chains.",
        source="starosvetsky2013, Figs 8 and 9, rows 5 and 25",
        derived=EQUAL,
        correction="Rigid rows do not equipartition: single rows agree at single gaps, no gap keeps the agreement. "
        "Late rows amplify rounding, so a picture of row 25 shows the arithmetic as much as the model.",
        also=[
            *(_pair(f"theta = {THETA_OF_EQ_5:.4f}, row {row}", rigid, row) for row in ROWS),
            f"{len(at_25)} of {len(scan.theta)} gaps ({len(at_25) / len(scan.theta):.1%}) agree within 1% at row 25",
            f"median difference over all gaps: {median[5]:.2f} at row 5, {median[25]:.2f} at row 25",
            "a change of D by 1e-13 changes the impulses of row 25 by more than 0.01 at "
            f"{np.mean(sensitive > 0.01):.1%} of the gaps",
        ],
    )


def _hertz(hertz: dict[float, Impulses]) -> Statement:
    modes = {kappa: rigid_rows.relative_mode(found, 10, LAST) for kappa, found in hertz.items()}
    since = {
        f"kappa = {kappa:g}": math.nan if one.equal_from is None else one.equal_from for kappa, one in modes.items()
    }
    return state(
        Measured("row from which on impulses agree within 1%", since, at_most(LAST), "0"),
        published="Beads with gaps and Hertzian contacts (eq. 2) reach equipartition.",
        source="starosvetsky2013, eq. 2, Figs 8 and 9",
        derived=f"{EQUAL} Contacts have a duration, in which the springs act; that equalises the chains.",
        also=[
            *(
                _pair(f"kappa = {kappa:g}, row {row}", found, row)
                for kappa, found in hertz.items()
                for row in (*ROWS, 100)
            ),
            *(
                f"kappa = {kappa:g}: the difference decays by e in {one.rows_per_e:.1f} rows"
                for kappa, one in modes.items()
            ),
        ],
    )


def _limit() -> Statement:
    limit = rigid_rows.rigid_limit()
    worst = {f"kappa = {kappa:g}": float(one.max()) for kappa, one in zip(limit.kappa, limit.difference, strict=True)}
    rates = {f"row {bead}": float(rate) for bead, rate in zip(limit.bead, limit.rate, strict=True)}
    return state(
        Measured(
            f"largest difference of the impulses in rows 2 to {limit.bead[-1]}", worst, at_most(0.01, math.inf), "3"
        ),
        Measured("exponent of the difference in kappa", rates, near(0.5, 0.05), "2"),
        published="The rigid model represents the gapped array.",
        source="starosvetsky2013, section 3",
        derived="A contact lasts 2.44 T and a period of the springs 2 pi T / sqrt(2 kappa): at fixed theta (here 1) "
        "the difference falls as sqrt(kappa).",
        correction="As a limit at fixed theta only: early rows tend to the rigid ones as the square root of kappa. "
        "At the couplings of the figures a contact lasts a considerable part of a period, and the two models differ.",
    )


def _apart(found: Impulses, row: int) -> dict[str, float]:
    return {"rigid beads": float(relative_difference(found.first)[found.row(row)])}


def _pair(label: str, found: Impulses, row: int) -> str:
    one, other = found.first[:, found.row(row)]
    return f"{label}: first impulses {one:.3f}, {other:.3f}"


def pictures(_: Results) -> list[Picture]:
    """Figs 8 and 9, the scan and the relative mode."""
    scan, (hertz, rigid) = _scan(), _both_models()
    found = []
    for kappa, name in FIGURES.items():
        problem = rigid_rows.problem_at(THETA_OF_EQ_5, kappa, 40, every=0.05)
        curves = rigid_rows.curves(problem, ROWS)
        caption = f"Fig. {name[3:]}: first impulses, and velocities of beads 5 and 25; kappa = {kappa:g}, gap of eq. 5."
        found.append(drawn(name, engines_figure(problem, ROWS, curves), caption))
    shown = (5, 25, 30)
    scanned = scan_figure(scan.theta, scan.difference()[:, np.isin(scan.bead, shown)], shown, rigid_rows.AGREE)
    found.append(drawn("scan", scanned, "Rigid beads: difference of the chains over the gap; the line is 1%."))
    labelled = {"rigid": rigid, **{rf"Hertz, $\kappa$ = {kappa:g}": one for kappa, one in hertz.items()}}
    modes = {label: rigid_rows.relative_mode(one, 2, LAST) for label, one in labelled.items()}
    curve = relative_mode_figure([(label, mode.bead, mode.difference) for label, mode in modes.items()])
    caption = (
        "Difference of the chains over the rows, at the gap of eq. 5: it decays for Hertzian beads, not for rigid ones."
    )
    return [*found, drawn("relative-mode", curve, caption)]


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
