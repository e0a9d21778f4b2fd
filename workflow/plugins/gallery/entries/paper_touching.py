"""Section 2 of the paper: coupled uncompressed chains, Figs 1 to 6, and the statements about them."""

import functools
import math
from collections.abc import Mapping

import numpy as np

from granchain.parts import analyse, drawing, page
from workflow.plugins.gallery.criteria import NAMES, MeasuredQuantity, at_least, at_most, by_engine, near, state
from workflow.plugins.gallery.entry import Entry, Ran, Results, Statements, each
from workflow.plugins.gallery.equipartition_distance import distance_map, equipartition_distance

CASES = (("two-chains", 55, "1", "2"), ("two-chains-strong", 55, "3", "4"), ("three-chains", 90, "5", "6"))
"""Scene, the bead of the paper's figure, and the numbers of its figures in space and time and of that bead."""
PAPER = "starosvetsky2013"
MAP_CHAINS, MAP_COUPLINGS = (2, 3, 4, 5), (0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0)
"""Numbers of chains and couplings of the map of the distance to equipartition."""
COARSE = "The percentages of the paper are multiples of 5; required within half of that."


def statements(results: Results) -> Statements:
    """Statements on the paper's scenes, then on couplings and numbers of chains beyond them."""
    runs = {name: results[name] for name, *_ in CASES}
    two, strong, three = runs.values()
    final = each(lambda run: _final(run)[0], two)
    settled, apart = final["reference"], each(lambda run: _mismatch(run, 55), two)
    yield state(
        MeasuredQuantity("final amplitude", final, near(0.4, 0.025, 0.05), "4 V"),
        published="N = 2, kappa = 0.1: the amplitude settles near 40% of V, a reduction of some 60%.",
        source=f"{PAPER}, Figs 1 and 2",
        derived=COARSE,
        correction=f"It settles at {settled:.4f} V, a reduction of {1.0 - settled:.1%}.",
        also=[*by_engine(two, _peaks_at_55), *by_engine(two, _final_line)],
    )
    for says, figures, claimed, those in (
        ("N = 2, kappa = 0.5: the reduction is 65%.", "Figs 3 and 4", 0.65, strong),
        ("N = 3, kappa = 0.1: the reduction is 75%.", "Figs 5 and 6", 0.75, three),
    ):
        reduction = each(lambda run: 1.0 - _final(run)[0], those)
        yield state(
            MeasuredQuantity("reduction of the final amplitude", reduction, near(claimed, 0.025), "4"),
            published=says,
            source=f"{PAPER}, {figures}",
            derived=COARSE,
            also=by_engine(those, _final_line),
        )
    yield state(
        MeasuredQuantity("difference of the peaks at bead 55, kappa = 0.1", apart, at_most(0.01, 0.05), "4"),
        published="The waves in the chains are identical.",
        source=f"{PAPER}, section 2",
        derived="Identical: the peaks differ by at most 1% of their mean.",
        correction=f"At kappa = 0.1 they become so: at bead 55 they still differ by {apart['reference']:.1%}.",
        also=[
            f"{name}: {_within('1%', scene_runs['reference'].survey.shared.agrees_from(0.01))}"
            for name, scene_runs in runs.items()
        ],
    )
    lags = {
        f"{name}: difference of the arrivals at bead {bead}": each(functools.partial(_lag, bead), runs[name])
        for name, bead, _, _ in CASES
    }
    yield state(
        *(MeasuredQuantity(name, lag, at_most(0.1), "4 T") for name, lag in lags.items()),
        published="The waves are synchronised.",
        source=f"{PAPER}, section 2",
        derived="Synchronised: arrivals differ by at most 0.1 T.",
        also=[
            f"{name}, {NAMES[engine]}: uncertainty {run.errors[1]:.0e} T"
            for name, scene_runs in runs.items()
            for engine, run in scene_runs.items()
        ],
    )
    yield from _beyond(final, each(lambda run: _final(run)[0], strong))


def _beyond(two: Mapping[str, float], strong: Mapping[str, float]) -> Statements:
    """Statements on weaker coupling, from the final amplitudes at kappa = 0.1 and 0.5, and on more chains."""
    weaker = [equipartition_distance(2, kappa) for kappa in (0.01, 0.003)]
    more = [equipartition_distance(chains, 0.1) for chains in range(2, 9)]
    far = {f"kappa = {case.kappa:g}": case.amplitude / two["reference"] for case in weaker}
    ratio = {engine: strong[engine] / amplitude for engine, amplitude in two.items()}
    since = {f"N = {case.chains}": math.nan if case.within_1 is None else case.within_1 for case in more}
    yield state(
        MeasuredQuantity("final amplitude at kappa = 0.5 over that at 0.1", ratio, at_least(0.95), "4"),
        MeasuredQuantity("weaker coupling, over that at 0.1", far, at_least(0.95, -math.inf), "4"),
        published="The final waves hardly depend on the coupling.",
        source=f"{PAPER}, section 2",
        derived="Required: a change of at most 5%; beyond the couplings of the paper a correction is enough.",
        correction="It holds between 0.1 and 0.5. With weaker coupling the distance grows as 1/kappa and the "
        "final waves become much weaker: the spring of each row keeps energy after the pulse has passed.",
        also=[f"kappa = {case.kappa:g}: {case.amplitude:.4f} V, {_within('1%', case.within_1)}" for case in weaker],
    )
    yield state(
        MeasuredQuantity("bead from which on peaks agree within 1%", since, at_least(1.0), "0"),
        published="Equipartition is robust in the number of chains.",
        source=f"{PAPER}, section 2",
        derived="kappa = 0.1, N = 2 to 8; required is that there is such a bead.",
        also=[f"N = {case.chains}: {case.amplitude:.4f} V, {_within('10%', case.within_10)}" for case in more],
    )


def _final(run: Ran) -> tuple[float, float]:
    """Amplitude over the last half beat, and its variation (V)."""
    final = run.survey.shared.final
    assert final is not None, "the paper's scenes run far enough"
    return final.value, final.uncertainty


def _final_line(run: Ran) -> str:
    amplitude, variation = _final(run)
    return (
        f"final amplitude {amplitude:.5f} V, uncertainty {run.errors[0]:.0e} V, variation over the last half "
        f"beat {variation:.0e} V"
    )


def _peaks_at_55(run: Ran) -> str:
    peaks = ", ".join(f"{value:.5f}" for value in run.waves.at(55).peak_velocity)
    return f"peaks of bead 55 {peaks} (± {run.errors[0]:.0e}) V"


def _mismatch(run: Ran, bead: int) -> float:
    shared = run.survey.shared
    return float(shared.mismatch[shared.bead == bead][0])


def _lag(bead: int, run: Ran) -> float:
    return float(np.ptp(run.waves.at(bead).arrival))


def _within(tolerance: str, bead: int | None) -> str:
    if bead is None:
        return f"not within {tolerance} for half a beat before the chains end"
    return f"within {tolerance} from bead {bead} on"


def pictures(runs: Results) -> list[page.PageFigure]:
    """The paper's Figs 1 to 6, and the map of the distance to equipartition."""
    figures = []
    for name, bead, space, time in CASES:
        run = runs[name]["lammps"]
        sheets = analyse.measure(run, beads=(bead,)).figures
        caption = f"Fig. {space}: velocity in space and time ({name}, LAMMPS)."
        figures.append(page.drawn(f"fig{space}", drawing.draw(sheets["spacetime"]()), caption))
        caption = f"Fig. {time}: velocity of bead {bead} in all chains ({name}, LAMMPS)."
        figures.append(page.drawn(f"fig{time}", drawing.draw(sheets["response"]()), caption))
    cases = [equipartition_distance(chains, kappa) for chains in MAP_CHAINS for kappa in MAP_COUPLINGS]
    caption = "Distance to equipartition and final amplitude over coupling and number of chains (reference integrator)."
    figures.append(page.drawn("map", distance_map(cases), caption))
    return figures


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
