"""Section 2 of the paper: coupled uncompressed chains, Figs 1 to 6, and the statements about them."""

import math
from collections.abc import Mapping

import numpy as np

from analysis.figures.spacetime import SpaceTime, spacetime_figure
from analysis.figures.waves import BeadHistory, response_figure
from analysis.sharing.equipartition import Estimate, sharing
from workflow.studies.gallery.criteria import NAMES, Measured, at_least, at_most, near, state
from workflow.studies.gallery.entry import Entry, Ran, Results, Runs, each
from workflow.studies.map.study import run_case
from workflow.studies.page import Picture, Statement, drawn

CASES = (("two-chains", 55, "1", "2"), ("two-chains-strong", 55, "3", "4"), ("three-chains", 90, "5", "6"))
"""Scene, the bead of the paper's figure, and the numbers of its figures in space and time and of that bead."""
PAPER = "starosvetsky2013"
COARSE = "The percentages of the paper are multiples of 5; required within half of that."


def statements(runs: Results) -> list[Statement]:
    """On the paper's scenes, then on couplings and numbers of chains beyond them."""
    two, strong, three = (runs[name] for name, *_ in CASES)
    final = each(two, lambda run: _final(run).value)
    return [
        state(
            Measured("final amplitude", final, near(0.4, 0.025, 0.05), "4 V"),
            published="N = 2, kappa = 0.1: the amplitude settles near 40% of V, a reduction of some 60%.",
            source=f"{PAPER}, Figs 1 and 2",
            derived=COARSE,
            correction=_settles(final),
            also=[*_peaks_at(two, 55), *_final_lines(two)],
        ),
        _reduction("N = 2, kappa = 0.5: the reduction is 65%.", "Figs 3 and 4", 0.65, strong),
        _reduction("N = 3, kappa = 0.1: the reduction is 75%.", "Figs 5 and 6", 0.75, three),
        state(
            Measured(
                "difference of the peaks at bead 55, kappa = 0.1",
                each(two, lambda run: _mismatch_at(run, 55)),
                at_most(0.01, 0.05),
                "4",
            ),
            published="The waves in the chains are identical.",
            source=f"{PAPER}, section 2",
            derived="Identical: the peaks differ by at most 1% of their mean.",
            correction="At kappa = 0.1 they become so: at bead 55 they still differ by "
            f"{_mismatch_at(two['reference'], 55):.1%}.",
            also=[f"{name}: {_within('1%', _agrees(runs[name]['reference'], 0.01))}" for name, *_ in CASES],
        ),
        state(
            *(
                Measured(
                    f"{name}: difference of the arrivals at bead {bead}",
                    each(runs[name], lambda run, bead=bead: _lag(run, bead)),  # type: ignore[misc]
                    at_most(0.1),
                    "4 T",
                )
                for name, bead, _, _ in CASES
            ),
            published="The waves are synchronised.",
            source=f"{PAPER}, section 2",
            derived="Synchronised: arrivals differ by at most 0.1 T.",
            also=[
                f"{name}, {NAMES[engine]}: uncertainty {run.errors[1]:.0e} T"
                for name, *_ in CASES
                for engine, run in runs[name].items()
            ],
        ),
        *_beyond(final, each(strong, lambda run: _final(run).value)),
    ]


def _beyond(two: Mapping[str, float], strong: Mapping[str, float]) -> list[Statement]:
    """On weaker coupling, given the final amplitudes at kappa = 0.1 and 0.5, and on more chains."""
    weaker = [run_case(2, kappa) for kappa in (0.01, 0.003)]
    more = [run_case(chains, 0.1) for chains in range(2, 9)]
    far = {f"kappa = {case.kappa:g}": case.amplitude / two["reference"] for case in weaker}
    ratio = {engine: strong[engine] / amplitude for engine, amplitude in two.items()}
    return [
        state(
            Measured("final amplitude at kappa = 0.5 over that at 0.1", ratio, at_least(0.95), "4"),
            Measured("weaker coupling, over that at 0.1", far, at_least(0.95, -math.inf), "4"),
            published="The final waves hardly depend on the coupling.",
            source=f"{PAPER}, section 2",
            derived="Required: a change of at most 5%; beyond the couplings of the paper a correction is enough.",
            correction="It holds between 0.1 and 0.5. With weaker coupling the distance grows as 1/kappa and the "
            "final waves become much weaker: the spring of each row keeps energy after the pulse has passed.",
            also=[f"kappa = {case.kappa:g}: {case.amplitude:.4f} V, {_within('1%', case.one)}" for case in weaker],
        ),
        state(
            Measured(
                "bead from which on peaks agree within 1%",
                {f"N = {case.chains}": math.nan if case.one is None else float(case.one) for case in more},
                at_least(1.0),
                "0",
            ),
            published="Equipartition is robust in the number of chains.",
            source=f"{PAPER}, section 2",
            derived="kappa = 0.1, N = 2 to 8; required is that there is such a bead.",
            also=[f"N = {case.chains}: {case.amplitude:.4f} V, {_within('10%', case.ten)}" for case in more],
        ),
    ]


def _reduction(says: str, figures: str, claimed: float, runs: Runs) -> Statement:
    reduction = each(runs, lambda run: 1.0 - _final(run).value)
    return state(
        Measured("reduction of the final amplitude", reduction, near(claimed, 0.025), "4"),
        published=says,
        source=f"{PAPER}, {figures}",
        derived=COARSE,
        also=_final_lines(runs),
    )


def _settles(final: Mapping[str, float]) -> str:
    amplitude = final["reference"]
    return f"It settles at {amplitude:.4f} V, a reduction of {1.0 - amplitude:.1%}."


def _final_lines(runs: Runs) -> list[str]:
    return [
        f"{NAMES[engine]}: final amplitude {_final(run).value:.5f} V, uncertainty {run.errors[0]:.0e} V, variation "
        f"over the last half beat {_final(run).uncertainty:.0e} V"
        for engine, run in runs.items()
    ]


def _peaks_at(runs: Runs, bead: int) -> list[str]:
    lines = []
    for engine, run in runs.items():
        peaks = ", ".join(f"{value:.5f}" for value in run.waves.at(bead).peak_velocity)
        lines.append(f"{NAMES[engine]}: peaks of bead {bead} {peaks} (± {run.errors[0]:.0e}) V")
    return lines


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


ENTRY = Entry(
    title="Pulse equipartition, section 2: touching beads (eq. 1, Figs 1 to 6)",
    introduction=(
        "Two or three chains of 120 touching beads; bead 1 of chain 1 starts with V = 1. The uncertainty of LAMMPS "
        "is the difference from the reference, that of the reference the bound on its own error."
    ),
    sources={"starosvetsky2013": "section 2"},
    scenes={name: name for name, *_ in CASES},
    statements=statements,
    pictures=pictures,
)
