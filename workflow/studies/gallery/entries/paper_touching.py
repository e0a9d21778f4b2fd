"""Section 2 of the paper: coupled uncompressed chains, Figs 1 to 6, and what is said of them."""

import numpy as np

from analysis.figures.spacetime import SpaceTime, spacetime_figure
from analysis.figures.waves import BeadHistory, response_figure
from analysis.sharing.equipartition import Estimate, sharing
from workflow.studies.gallery.entry import NAMES, Entry, Ran, Results, Runs, Statement
from workflow.studies.map.study import run_case
from workflow.studies.page import Picture, drawn

CASES = (("two-chains", 55, "1", "2"), ("two-chains-strong", 55, "3", "4"), ("three-chains", 90, "5", "6"))
"""Scene, the bead of the paper's figure, and the numbers of its figures in space and time and of that bead."""


def statements(runs: Results) -> list[Statement]:
    """What the runs say, and couplings and numbers of chains beyond them."""
    weaker = [run_case(2, kappa) for kappa in (0.01, 0.003)]
    more = [run_case(chains, 0.1) for chains in range(2, 9)]
    two, strong, three = (runs[name] for name, *_ in CASES)
    final = {name: _final(runs[name]["reference"]).value for name, *_ in CASES}
    spread = float(_mismatch_at(two["reference"], 55))
    one_percent = {name: _agrees(runs[name]["reference"], 0.01) for name, *_ in CASES}
    change = abs(final["two-chains"] / final["two-chains-strong"] - 1.0)
    return [
        Statement(
            "N = 2, kappa = 0.1: the amplitude settles near 40% of V, a reduction of some 60%.",
            [*_peaks_at(two, 55), *_final_lines(two)],
            "holds with a correction" if abs(final["two-chains"] - 0.4) < 0.05 else "does not hold",
            f"It settles at {final['two-chains']:.4f} V, a reduction of {_percent(1.0 - final['two-chains'])}.",
        ),
        _reduction("N = 2, kappa = 0.5: the reduction is 65%.", 0.65, strong, final["two-chains-strong"]),
        _reduction("N = 3, kappa = 0.1: the reduction is 75%.", 0.75, three, final["three-chains"]),
        Statement(
            "The waves in the chains are identical.",
            [
                f"kappa = 0.1, bead 55: peaks differ by {_percent(spread)}",
                *(f"{name}: {_within('1%', bead)}" for name, bead in one_percent.items()),
            ],
            "holds" if spread < 0.01 else "holds with a correction",
            ""
            if spread < 0.01
            else f"At kappa = 0.1 they become so: at bead 55 they still differ by {_percent(spread)}.",
        ),
        Statement(
            "The waves are synchronised.",
            [line for name, bead, _, _ in CASES for line in _lag_lines(name, runs[name], bead)],
            "holds"
            if all(_lag(runs[name]["reference"], bead) < 0.1 for name, bead, _, _ in CASES)
            else "does not hold",
        ),
        Statement(
            "The final waves hardly depend on the coupling.",
            [
                f"kappa = 0.5: {final['two-chains-strong']:.4f} V, kappa = 0.1: {final['two-chains']:.4f} V "
                f"({_percent(change)} apart)",
                *(f"kappa = {case.kappa:g}: {case.amplitude:.4f} V, {_within('1%', case.one)}" for case in weaker),
            ],
            "holds with a correction" if weaker[-1].amplitude < 0.5 * final["two-chains"] else "holds",
            "It holds between 0.1 and 0.5. With weaker coupling the distance grows as 1/kappa and the final waves "
            "become much weaker: each row that the pulse leaves keeps energy in its spring.",
        ),
        Statement(
            "Equipartition is robust in the number of chains.",
            [
                f"N = {case.chains}: {case.amplitude:.4f} V, {_within('10%', case.ten)}, {_within('1%', case.one)}"
                for case in more
            ],
            "holds" if all(case.one is not None for case in more) else "does not hold",
        ),
    ]


def _reduction(says: str, claimed: float, runs: Runs, final: float) -> Statement:
    close = abs(1.0 - final - claimed) < 0.015
    return Statement(
        says,
        _final_lines(runs),
        "holds" if close else "does not hold",
        f"{_percent(1.0 - final)}, to be exact.",
    )


def _final_lines(runs: Runs) -> list[str]:
    return [
        f"{NAMES[engine]}: final amplitude {_final(run).value:.5f} V, computed to ± {run.errors[0]:.0e} V, "
        f"still varying by {_final(run).uncertainty:.0e} V"
        for engine, run in runs.items()
    ]


def _peaks_at(runs: Runs, bead: int) -> list[str]:
    lines = []
    for engine, run in runs.items():
        peaks = ", ".join(f"{value:.5f}" for value in run.waves.at(bead).peak_velocity)
        lines.append(f"{NAMES[engine]}: peaks of bead {bead} {peaks} (± {run.errors[0]:.0e}) V")
    return lines


def _lag_lines(name: str, runs: Runs, bead: int) -> list[str]:
    return [
        f"{name}, bead {bead}, {NAMES[engine]}: arrivals {_lag(run, bead):.4f} ± {run.errors[1]:.0e} T apart"
        for engine, run in runs.items()
    ]


def _lag(run: Ran, bead: int) -> float:
    return float(np.ptp(run.waves.at(bead).arrival))


def _final(run: Ran) -> Estimate:
    """Amplitude over the last half beat, and how far it still varies."""
    found = sharing(run.waves, run.problem).final
    assert found is not None, "the paper's scenes run far enough"
    return found


def _mismatch_at(run: Ran, bead: int) -> float:
    shared = sharing(run.waves, run.problem)
    return float(shared.mismatch[shared.bead == bead][0])


def _agrees(run: Ran, tolerance: float) -> int | None:
    return sharing(run.waves, run.problem).agrees_from(tolerance)


def pictures(runs: Results) -> list[Picture]:
    """The paper's Figs 1 to 6."""
    found = []
    for name, bead, space, time in CASES:
        run = runs[name]["lammps"]
        caption = f"Fig. {space}: velocity in space and time ({name}, LAMMPS)."
        found.append(drawn(f"fig{space}", spacetime_figure(run.read(SpaceTime(run.problem))), caption))
        caption = f"Fig. {time}: velocity of bead {bead} in all chains ({name}, LAMMPS)."
        found.append(drawn(f"fig{time}", response_figure(run.read(BeadHistory(run.problem, (bead,)))), caption))
    return found


def _within(tolerance: str, bead: int | None) -> str:
    if bead is None:
        return f"not within {tolerance} for half a beat before the chains end"
    return f"within {tolerance} from bead {bead} on"


def _percent(share: float) -> str:
    return f"{100.0 * share:.1f}%"


ENTRY = Entry(
    title="Section 2: chains of touching beads (eq. 1, Figs 1 to 6)",
    introduction=(
        "Two or three chains of 120 touching beads; bead 1 of chain 1 starts with V = 1. Each number is measured in a "
        "LAMMPS run and in a run of the reference integrator. Uncertainties are the differences between the two for "
        "LAMMPS, and the reference's own bound on its error."
    ),
    sources={"starosvetsky2013": "section 2"},
    scenes={name: name for name, *_ in CASES},
    statements=statements,
    pictures=pictures,
)
