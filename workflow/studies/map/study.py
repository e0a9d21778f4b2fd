"""Map equipartition over coupling and number of chains, with the reference integrator.

How far it takes, and what amplitude is left. Each case is kept when it is done, so an interrupted map is resumed. Only
the rows near the front are integrated; every case is run a second time in a window twice as wide, and the two must
agree.
"""

import argparse
import math
from collections.abc import Sequence
from dataclasses import asdict, fields
from typing import Any

import numpy as np

from analysis.quantity import declare, result
from analysis.sharing.equipartition import sharing
from analysis.tracking.leading_waves import Waves
from lammps_inputs import Coupling, InputError, Kick, Problem, Scene
from workflow.engines.reference.engine import passages
from workflow.screen import Answer, one_line
from workflow.studies.options import add_output, listed
from workflow.studies.study import Study, floats, print_records, to_csv
from workflow.workers import evaluate

COUPLINGS = tuple(float(f"{value:.3g}") for value in np.geomspace(1e-3, 2.0, 12))
CHAINS = (2, 3, 4, 5, 6, 7, 8)
MOST_BEADS = 12_000
TABLE = "map.csv"
STUDY = Study("map", f"{TABLE} is the table", tables=(TABLE,), figures=("map",), cache="cases.jsonl")

_WINDOW = 80
_WIDEST = 640
_THRESHOLD = 1e-6
"""A weakly coupled far chain starts with pulses this small, in units of V."""

_SAME = 1e-6
"""Largest difference of peaks, in units of V, between a window and one twice as wide."""


NOT_REACHED = "a chain was not reached"


@result
class Case:
    """One point of the map; dimensionless."""

    chains: int = declare("number of chains", symbol="N", digits="", head="N")
    kappa: float = declare("coupling", digits=".4g")
    beads: int = declare("length of the chains that were integrated", digits="")
    ten: int | None = declare("bead from which leading peaks agree to 10 % for half a beat", digits="", head="10% from")
    one: int | None = declare("bead from which leading peaks agree to 1 % for half a beat", digits="", head="1% from")
    amplitude: float = declare("mean leading peak over the last half beat", undefined=NOT_REACHED, digits=".4f")
    mismatch: float = declare("spread of leading peaks at the end over the mean", undefined=NOT_REACHED, digits=".1e")
    window: int = declare("rows integrated")
    window_error: float = declare("largest difference of a leading peak from a window twice as wide", digits=".0e")


def run_case(chains: int, kappa: float, most_beads: int = MOST_BEADS) -> Case:
    """Find where the leading pulses of equally long chains agree, in chains as long as that takes."""
    slowest = 2.0 - 2.0 * math.cos(math.pi / chains)
    beads = min(most_beads, max(60, math.ceil(16.0 / (kappa * slowest))))
    while True:
        case = _run_length(chains, kappa, beads)
        if case.one is not None or beads >= most_beads:
            return case
        beads = min(most_beads, 2 * beads)


def _run_length(chains: int, kappa: float, beads: int) -> Case:
    coupling, kick = Coupling(stiffness=kappa), (Kick(velocity=1.0),)
    scene = Scene(name="map", chains=chains, beads=beads, coupling=coupling, kick=kick, duration=10.0 * beads)
    problem = scene.problem()
    window, error, waves = _WINDOW, math.inf, _waves(problem, _WINDOW)
    while error > _SAME and window < _WIDEST:
        window *= 2
        narrow, waves = waves, _waves(problem, window)
        error = _difference(narrow, waves)
    shared = sharing(waves, problem)
    return Case(
        chains,
        kappa,
        beads,
        shared.agrees_from(0.1),
        shared.agrees_from(0.01),
        math.nan if shared.final is None else shared.final.value,
        math.nan if len(shared) == 0 else float(shared.mismatch[-1]),
        window,
        error,
    )


def _waves(problem: Problem, window: int) -> Waves:
    """Leading waves; the last rows are left out, which the free end disturbs."""
    window = min(window, problem.beads + 30)
    until = problem.beads - 5
    waves = passages(problem, window=window, until_bead=until, threshold=_THRESHOLD)
    return waves.where(waves.bead <= until - 5)


def _difference(first: Waves, second: Waves) -> float:
    if len(first) != len(second) or not np.array_equal(first.bead, second.bead):
        return math.inf
    return float(np.max(np.abs(first.peak_velocity - second.peak_velocity), initial=0.0))


def plan(couplings: Sequence[float], chains: Sequence[int]) -> list[evaluate.Case]:
    """A case for each number of chains and coupling; the weaker the coupling, the longer the chains.

    Args:
        couplings: kappa, dimensionless.
        chains: their numbers, 2 or more.

    Raises:
        InputError: a coupling or number of chains that makes no case.
    """
    if min(chains) < 2 or min(couplings) <= 0.0 or not np.all(np.isfinite(couplings)):
        raise InputError("map: couplings are positive, and chains are 2 or more")
    return [
        evaluate.case(
            f"{__name__}:computed",
            {"chains": number, "kappa": float(kappa)},
            cost=-float(kappa) / number,
        )
        for number in chains
        for kappa in couplings
    ]


def computed(**request: Any) -> dict[str, Any]:
    """`run_case` for the worker pool."""
    return asdict(run_case(**request))


# --- command ----------------------------------------------------------------------------------------------------------

ANSWERS = "the cases, as in map.csv"
DRAWS = True
EXAMPLES = (
    "map -o map                # some four minutes; the same command resumes",
    "map -o map --quiet",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What to map, and where to."""
    words = ("dimensionless couplings (default 1e-3 to 2)", "numbers of chains (default 2 to 8)")
    parser.add_argument("--couplings", metavar="K,...", type=listed(float), default=COUPLINGS, help=words[0])
    parser.add_argument("--chains", metavar="N,...", type=listed(int), default=CHAINS, help=words[1])
    add_output(parser)


def execute(arguments: argparse.Namespace) -> Answer:
    """Run the cases that the directory does not hold yet, on all cores; write and print the table, draw the figure."""
    cases, directory = plan(arguments.couplings, arguments.chains), arguments.output
    with STUDY.evaluating(directory) as values:
        found = [Case(**value) for value in values(cases)]
        from analysis.figures.studies import map_figure  # matplotlib takes half a second to import

        columns = {field.name: floats([getattr(case, field.name) for case in found]) for field in fields(Case)}
        STUDY.write(directory, {TABLE: to_csv(Case, found)}, {"map": map_figure(columns)})
    print_records("leading pulses: bead from which all chains agree, and what is left at the end (V = 1)", Case, found)
    print(f"{one_line(directory)}: {', '.join(STUDY.files)}")
    return Answer(0, [vars(case) for case in found])
