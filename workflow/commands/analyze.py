"""Find the pulses in a run, measure them and draw them."""

import argparse
import json
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from analysis.tracking.leading_waves import ARRIVALS
from analysis.tracking.undisturbed import CLEAR
from analysis.trajectory import along_the_way
from lammps_inputs import InputError, physics
from lammps_inputs.facts import Fact
from workflow.engines.lammps.worker import ENERGY_TOLERANCE
from workflow.runs.run_directory import RunDirectory
from workflow.screen import CommandResult, print_files, print_heading, print_table
from workflow.verdicts.analyse import Analysis, analyse
from workflow.verdicts.analysis_report import REPORT
from workflow.verdicts.pulse_sentences import change_sentences, pulse_sentences
from workflow.verdicts.pulse_table import pulse_table

DOCUMENTED = 1e-4
"""Error of a peak velocity, in V, above which it is printed."""

FAR = 1.4
"""Time between frames, in T, from which on small maxima beside larger ones were seen to be missed."""


ANSWERS = "what analysis.json holds"
DRAWS = True
EXAMPLES = (
    "analyze demo",
    "analyze demo --beads 10,55,90 --formats pdf --width 3.4",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the directory and what to draw."""
    parser.add_argument("directory", metavar="DIR", type=Path, help="a run directory, also from a cluster")
    parser.add_argument("--beads", metavar="N,N,...", help="beads whose velocity over time is drawn")
    parser.add_argument(
        "--arrival",
        choices=ARRIVALS,
        help="a wave arrives when the bead is fastest, or at the centre of the impulse that made it so; by default "
        "the latter where beads have gaps",
    )
    parser.add_argument("--no-figures", action="store_true", help="write the tables only")


def execute(arguments: argparse.Namespace) -> CommandResult:
    """Print a short table; write waves.csv, analysis.json and figures."""
    analysis = analyse(
        RunDirectory(arguments.directory),
        beads=_beads(arguments.beads),
        figures=not arguments.no_figures,
        arrival=arguments.arrival,
    )
    print_heading(analysis.problem.name, RunDirectory(arguments.directory).scene.units)
    _print(analysis)
    names = [*analysis.tables, REPORT, *(path.name for path in analysis.figures)]
    print_files(arguments.directory, names)
    return CommandResult(0, json.loads((arguments.directory / REPORT).read_text(encoding="utf-8")))


def _beads(text: str | None) -> tuple[int, ...] | None:
    if text is None:
        return None
    try:
        return tuple(int(part) for part in text.split(","))
    except ValueError:
        raise InputError(f"--beads: {text!r} given; bead numbers with commas between, such as 10,55,90") from None


def _print(analysis: Analysis) -> None:
    problem, conservation = analysis.problem, analysis.conservation
    if not analysis.complete:
        print(
            f"the run is incomplete: {conservation.frames} of {problem.frames + 1} frames, to t = "
            f"{problem.scale.written(conservation.last_time, 'time')}; the existing frames were analysed"
        )
    if analysis.altered:
        print("the checksum of the frames is not that in run.json: a file was damaged or modified")
    _print_doubt(analysis)
    if problem.system.holds(Fact.PULSE):
        if (table := pulse_table(analysis.survey)) is not None:
            print_table(*table)
        _print_lines(change_sentences(analysis.survey))
        _print_accuracy(analysis)
    _print_lines(pulse_sentences(analysis.survey))
    for measurement in analysis.measurements.values():
        for line in measurement.lines():
            if isinstance(line, str):
                print(line)
            else:
                print_table(*line)
    _print_drifts(analysis)


def _print_lines(lines: Iterable[str]) -> None:
    for line in lines:
        print(line)


def _print_drifts(analysis: Analysis) -> None:
    """Print the drift of the energy, unless its budget has been printed, and of the momentum."""
    exchanges = physics.exchanges(analysis.problem.system)
    shown = [
        f"{drift:.1e} of the {name} input"
        for name, drift in _drifts(analysis).items()
        if name != "energy" or not exchanges
    ]
    if shown:
        print(f"largest drift: {' and '.join(shown)}")


def _print_doubt(analysis: Analysis) -> None:
    """Print why the frames cannot be right where energy or momentum is not conserved."""
    drifts = _drifts(analysis)
    if max(drifts.values(), default=0.0) > ENERGY_TOLERANCE:
        name = max(drifts, key=lambda name: drifts[name])
        changes = f"the {name} changes by {drifts[name]:.2g} of the {name} input"
        cause = "these are not frames of this scene, or the time step is too large (see `granchain validate`)"
        print(analysis.failure or f"{changes}: {cause}")


def _drifts(analysis: Analysis) -> dict[str, float]:
    """Relative drifts of energy and momentum, by name, as far as they are known."""
    conservation = analysis.conservation
    drifts = {"energy": conservation.energy_drift, "momentum": conservation.momentum_drift}
    return {name: drift for name, drift in drifts.items() if np.isfinite(drift)}


def _print_accuracy(analysis: Analysis) -> None:
    """Print what arrivals are, if not maxima, and the uncertainty of the table, if more than `DOCUMENTED`."""
    problem, waves = analysis.problem, analysis.survey.waves
    scale, clear = problem.scale, problem.beads - CLEAR
    if analysis.survey.arrival == "impulse":
        print("the arrival of a wave is the centre of the impulse until the bead is fastest")
    elif free := int(np.count_nonzero(np.isnan(waves.arrival[along_the_way(problem, waves.bead) <= clear]))):
        where = f"{free} beads that fly" if free > 1 else "a bead that flies"
        print(
            f"arrivals at the maximum of the velocity are undefined at {where} freely (empty in waves.csv); "
            "`--arrival impulse` defines them"
        )
    if len(waves) and waves.peak_velocity_error.max() > DOCUMENTED:
        worst = int(np.argmax(waves.peak_velocity_error))
        late = waves.arrival_error[np.isfinite(waves.arrival_error)].max(initial=0.0)
        apart = scale.written(problem.every, "time", ".3g")
        arrivals = f", that of arrivals up to {scale.written(late, 'time', '.1e')}" if late > 0.0 else ""
        print(
            f"with frames {apart} apart the uncertainty of peak velocities is up to "
            f"{waves.peak_velocity_error[worst]:.1e} V (bead {waves.bead[worst]} of chain {waves.chain[worst]})"
            f"{arrivals}; waves.csv has each"
        )
    if problem.every > FAR:
        far = scale.written(FAR, "time", ".3g")
        print(f"frames are more than {far} apart, so that small pulses between them may be missed")
