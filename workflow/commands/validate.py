"""Compare a run with the reference integrator, with another run, or with a trajectory of your own."""

import argparse
import json
from pathlib import Path

from analysis.files.traces import TraceFile
from lammps_inputs import InputError, library
from workflow.formats import figure_files
from workflow.runs import run as running
from workflow.runs.run_directory import RunDirectory
from workflow.screen import CommandResult, one_line, print_files, print_heading, print_table, progress_bar
from workflow.study_kit import options
from workflow.verdicts import validate as validation
from workflow.verdicts import validation_tables as tables
from workflow.verdicts.validate_against import run_or_file, validate_against
from workflow.verdicts.validate_run import refuse_another_scene

ANSWERS = "what validation.json, or validation-against.json, holds"
DRAWS = True
EXAMPLES = (
    "validate demo",
    "validate again --against demo   # another run of the same scene",
    "validate demo --against mine.csv --units dimensionless --tolerance velocity=1e-4   # in V",
    'validate demo --against scope.csv --columns "time=TIME,force_wall_right (V)=CH1" --gain CH1=20.5 --offset=-120e-6',
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what to validate, and against what."""
    parser.add_argument("what", metavar="DIR|SCENE", help="a run directory, or a scene to run first (needs -o)")
    parser.add_argument("-o", "--output", metavar="DIR", type=Path, help="run directory to make for a scene")
    parser.add_argument(
        "--against",
        metavar="DIR|FILE",
        type=Path,
        help="another run of the same scene; or your own trajectory (npz, CSV, blanks, or a text dump of LAMMPS), or "
        "traces: time, force_wall_right, force_contact_10, velocity_1_55 (chain, bead)",
    )
    parser.add_argument(
        "--units",
        choices=("scene", "dimensionless"),
        default="scene",
        help="units of FILE: the scene's own (default), or those in which V = 1",
    )
    options.add_traces(parser, free=False)
    parser.add_argument(
        "--offset", metavar="TIME", type=float, help="by how much times of traces are later than the run's (default 0)"
    )
    parser.add_argument(
        "--tolerance",
        metavar="QUANTITY=VALUE",
        action="append",
        default=[],
        help=f"largest error let pass, dimensionless; of {', '.join(validation.TOLERANCES)}",
    )
    parser.set_defaults(write_beside=_write_nothing)


def _write_nothing(_directory: RunDirectory, _comparison: validation.Validation, _against: RunDirectory | None) -> str:
    """Write nothing beside the report and its figure; options of plug-ins may set another function."""
    return ""


def execute(arguments: argparse.Namespace) -> CommandResult:
    """Print a table; exit code 1 when a tolerance is exceeded or something seems wrong."""
    tolerances = _tolerances(arguments.tolerance)
    against = _against(arguments)
    directory = _directory(arguments, against)
    if against is None:
        comparison = validation.validate(directory, tolerances)
    else:
        dimensionless = arguments.units == "dimensionless"
        comparison = validate_against(
            directory, against, dimensionless=dimensionless, tolerances=tolerances, offset=arguments.offset
        )
    if arguments.output is None:  # else it was printed before the scene was run
        print_heading(comparison.problem.name, directory.scene.units)
    _print(comparison)
    files = (comparison.report, *figure_files(comparison.stem))
    beside = arguments.write_beside(directory, comparison, against if isinstance(against, RunDirectory) else None)
    print_files(directory.path, [*files, *filter(None, [beside])])
    data = json.loads((directory.path / comparison.report).read_text(encoding="utf-8"))
    return CommandResult(0 if comparison.passed else 1, data)


def _against(arguments: argparse.Namespace) -> RunDirectory | TraceFile | Path | None:
    """What to validate against; None for the reference.

    Raises:
        InputError: options of traces are given for something else.
    """
    against = None if arguments.against is None else run_or_file(arguments.against)
    words = options.trace_words(arguments) + ["--offset"] * (arguments.offset is not None)
    if words and not isinstance(against, Path):
        raise InputError(f"{words[0].partition('=')[0]}: is for a file of traces (--against FILE)")
    file = options.trace_file(arguments, free=False)
    return file if file.described else against


def _directory(arguments: argparse.Namespace, against: RunDirectory | TraceFile | Path | None) -> RunDirectory:
    """The run directory that was named, or that of the scene, which is run."""
    if Path(arguments.what).is_dir():
        if arguments.output is not None:
            raise InputError("-o: is for a scene; a run directory gets its report inside")
        return RunDirectory(Path(arguments.what))
    scene = library.find(arguments.what)
    if arguments.output is None:
        raise InputError(f"-o: {arguments.what} is a scene, so a directory for its run is needed")
    if isinstance(against, RunDirectory):
        refuse_another_scene(scene, arguments.what, against)  # before it is run
    ready = running.prepare_run(scene, arguments.output, source=arguments.what)
    print_heading(ready.scene.name, ready.scene.units)
    if ready.step is not None:
        print(ready.step.sentence(ready.problem), flush=True)
    with progress_bar(scene.name, ready.problem) as progress:
        return running.run_prepared(ready, check=False, progress=progress).directory


def _tolerances(texts: list[str]) -> dict[str, float]:
    result = {}
    for text in texts:
        name, _, value = text.partition("=")
        if name not in validation.TOLERANCES:
            raise InputError(f"--tolerance: {name!r} given; one of {', '.join(validation.TOLERANCES)}")
        try:
            result[name] = float(value)
        except ValueError:
            result[name] = float("nan")
        if not result[name] >= 0.0:
            raise InputError(f"--tolerance: {text!r} given; a number such as {name}=1e-4")
    return result


def _print(comparison: validation.Validation) -> None:
    runs, against = comparison.runs, one_line(comparison.against)
    if runs is not None:
        print(tables.bitwise_line(comparison))
    if runs is None or not runs.identical:
        _print_quantities(comparison)
        if (of_chains := tables.chain_table(comparison)) is not None:
            print_table(*of_chains)
    if runs is not None and (changes := tables.change_table(runs.changes, against)) is not None:
        print_table(*changes)
    if not comparison.complete:
        print(f"the run is incomplete: {comparison.frames} of {comparison.problem.frames + 1} frames")
    for remark in comparison.remarks:
        print(f"note: {remark}")
    for cause in comparison.causes:
        print(f"likely cause: {cause}")
    print("the validation passed" if comparison.passed else "the validation has NOT passed")


def _print_quantities(comparison: validation.Validation) -> None:
    print_table(*tables.deviation_table(comparison))
    for line in tables.uncertainty_lines(comparison):
        print(line)
    firsts = [
        (deviation.first.time, name, deviation.first)
        for name, deviation in comparison.deviations.items()
        if deviation.first is not None and deviation.first.time is not None
    ]
    if firsts:
        time, name, place = min(firsts, key=lambda first: first[0])
        when = comparison.problem.scale.written(time, "time")
        print(f"a tolerance is first exceeded by the {name} of {place.words}, at t = {when}")
