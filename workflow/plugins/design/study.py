"""Find the scene that minimises or maximises a quantity within bounds, such as the force on a wall.

The steps: search, the best designs in LAMMPS, manufacturing errors, and the files of the study.

| file               | contents                                                                        |
|--------------------|---------------------------------------------------------------------------------|
| evaluations.jsonl  | the cache: every design that was computed, as it was done                        |
| designs.csv        | the same as a table, the best first                                              |
| best.yaml          | scene of the best                                                                |
| design.json        | the result                                                                       |
| best-1/, beside/   | run directories of LAMMPS: the best few, and the scene to set them against       |
| index.html         | the report                                                                       |
"""

import argparse
import functools
import json
import math
import textwrap
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from granchain import InputError
from granchain.parts import (
    Study,
    checked,
    evaluate,
    fields,
    inputs,
    kept_run,
    library,
    options,
    quantity,
    screen,
    strict_yaml,
)
from workflow.plugins.derivatives.derivative import HEAD, Derivative
from workflow.plugins.derivatives.gradient import gradient as derivatives
from workflow.plugins.derivatives.gradient import why_no_derivative
from workflow.plugins.design import file
from workflow.plugins.design.file import Design
from workflow.plugins.design.polish import polished, refuse_no_gradient, smooth
from workflow.plugins.design.result import DesignResult, Verified, sensitivity
from workflow.plugins.design.search import RULED_OUT, Compute, DesignRecord, computed, search, worth

REPORT, TABLE, BEST, PAGE, BESIDE = "design.json", "designs.csv", "best.yaml", "index.html", "beside"
STUDY = Study("design", f"{PAGE} is the report", tables=(REPORT, TABLE, BEST, PAGE), cache="evaluations.jsonl")


@checked
def design(
    definition: inputs.AnyDefinition,
    directory: Path | str,
    *,
    jobs: inputs.Processes | None = None,
    gradient: bool = False,
) -> DesignResult:
    """Find the scene that minimises or maximises a quantity within bounds, on all cores; resumes an interrupted call.

    Args:
        definition: a design file, or its content as a mapping, in which scenes may be `Scene` objects.
        directory: new, or resumed.
        jobs: designs at a time; as many as there are cores by default.
        gradient: whether steps with derivatives follow the search, and the best design is given with its derivatives.

    Returns:
        All designs of the search, and the best ones in LAMMPS.

    Raises:
        InputError: the file is invalid, or no design is within its limits.
        RunError: LAMMPS failed.

    Examples:
        >>> scene = {"name": "short", "beads": 12, "kick": {"velocity": 1.0}, "duration": 8.0}
        >>> wanted = {"scene": scene, "vary": {"beads": {"from": 8, "to": 12}}, "minimize": "mass", "verify": 1}
        >>> granchain.design(wanted, "designed", jobs=1).best.values
        {'beads': 8}
    """
    wanted = (
        file.from_plain(dict(definition), Path("design"))
        if isinstance(definition, Mapping)
        else file.load(Path(definition))
    )
    return carry_out(wanted, Path(directory), jobs, gradient=gradient)


def carry_out(design: Design, directory: Path, jobs: int | None = None, *, gradient: bool = False) -> DesignResult:
    """Search, verify and write; designs and runs of an earlier start are used again.

    Args:
        design: the design file.
        directory: made if need be.
        jobs: designs at a time; None for all cores.
        gradient: whether steps with derivatives follow the search.

    Returns:
        The result, which is also written.

    Raises:
        InputError: the directory or a scene cannot be used, or no design is within the limits.
        RunError: LAMMPS failed.
    """
    if gradient:
        refuse_no_gradient(design)
    best_runs = [f"best-{place}" for place in range(1, design.request.verify + 1)]
    study = replace(STUDY, others=(BESIDE, *best_runs))
    with study.evaluating(directory, jobs) as evaluated:
        compute = functools.partial(computed, design, evaluated=evaluated)
        records = search(design, _shown(design, compute))
        good = _within_limits(design, records)
        if gradient and good:
            records += compute([polished(design, good[0], evaluated)])
            good = _within_limits(design, records)
        study.write(directory, {TABLE: _table(design, records)})
        if not good:
            raise InputError(_why_nothing(design, records))
        small = sensitivity(design, functools.partial(compute, limited=False), good[0].values)
        best_scene = library.from_plain(fields.put_all(design.scene, good[0].values), design.source)
        study.write(directory, {BEST: strict_yaml.dump(best_scene.plain())})
        verified = [
            _in_lammps(design, fields.put_all(design.scene, best.values), directory / name, best)
            for name, best in zip(best_runs, good, strict=False)
        ]
        beside = None
        if design.beside is not None:
            quantities = evaluate.of_scene(design.beside, design.names, f"{design.source}: beside")
            beside = _in_lammps(design, design.beside, directory / BESIDE, DesignRecord({}, quantities, "", 0.0))
        slopes = gradient_at(best_scene.plain(), design) if gradient else []
        timed = [record.seconds for record in records if design.objective in record.quantities]
        result = DesignResult(design, records, verified, beside, small, sum(timed) / len(timed), slopes)
        study.write(directory, {REPORT: result.plain()})
        from workflow.plugins.design.report import render  # matplotlib takes half a second to import

        study.write(directory, {PAGE: render(result)})
    return result


def _within_limits(design: Design, records: list[DesignRecord]) -> list[DesignRecord]:
    """Designs that are scenes, within the limits and with an objective, the best first."""
    return sorted((r for r in records if worth(design, r) < RULED_OUT), key=lambda r: worth(design, r))


def gradient_at(plain: dict[str, Any], design: Design) -> list[Derivative]:
    """Derivatives of the quantities of a scene that have any by the varied fields."""
    names = [name for name in design.names if not why_no_derivative(name)]
    return derivatives(plain, names, [variable.field for variable in smooth(design)], design.source)


def _shown(design: Design, compute: Callable[..., list[DesignRecord]]) -> Compute:
    """A computation with a progress bar that shows the number of designs and the best objective so far."""
    best = math.inf
    total = design.count if design.exhaustive and design.count else design.request.search.evaluations

    def shown(designs: Sequence[dict[str, Any]]) -> list[DesignRecord]:
        nonlocal best
        words = "" if best >= RULED_OUT else f"{design.objective} {design.sign * best:.4g}"
        records = compute(designs, of=total, words=words)
        best = min(best, *(worth(design, record) for record in records))
        return records

    return shown


def _why_nothing(design: Design, records: list[DesignRecord]) -> str:
    refused = [record.refused for record in records if record.refused]
    if len(refused) == len(records):
        return f"{design.source}: none of {len(records)} designs is a scene; the first: {refused[0]}"
    return f"{design.source}: where: none of {len(records)} designs keeps the limits and has a {design.objective}"


def _in_lammps(design: Design, plain: dict[str, Any], path: Path, record: DesignRecord) -> Verified:
    """A scene in LAMMPS, run now or by an earlier start, beside its record by the reference."""
    scene = evaluate.scene_to_run(plain, design.names, design.source)
    directory = kept_run(scene, "lammps", path)
    check = directory.job.check
    lammps = evaluate.of_frames(directory.problem, directory.blocks, scene, design.names)
    error = math.nan if check is None or check.velocity is None else check.velocity
    return Verified(directory, record.values, record.quantities, lammps, error)


def _table(design: Design, records: list[DesignRecord]) -> str:
    """All designs as CSV, the best first."""
    rows = [
        {
            **{
                design.heading(variable.field): _written(record.values[variable.field]) for variable in design.variables
            },
            **{design.heading(name): record.quantities.get(name) for name in design.names},
            "fits": "yes" if worth(design, record) < RULED_OUT else "no",
            "refused": record.refused,
        }
        for record in sorted(records, key=lambda record: worth(design, record))
    ]
    return quantity.csv_of_rows(rows)


def _written(value: Any) -> str:
    return json.dumps(value) if isinstance(value, list | dict) else str(value)


# --- command ----------------------------------------------------------------------------------------------------------

ANSWERS = "what design.json holds"
FILE = f"DESIGN.yaml:\n{textwrap.indent(options.example_file(file), '  ')}"
EXAMPLES = ("design design.yaml -o designed          # the same command resumes",)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("design", metavar="DESIGN.yaml", type=Path, help="a scene, bounds of its fields, an objective")
    options.add_output(parser)
    options.add_jobs(parser, "designs at a time (default all cores; of a job cores_per_node, or 1)")
    parser.add_argument(
        "--gradient", action="store_true", help="after the search, step on from the best design along derivatives"
    )


def execute(arguments: argparse.Namespace) -> screen.CommandResult:
    """Search, verify, print the best; exit code 130 when interrupted, with all that was computed kept."""
    design = file.load(arguments.design)
    try:
        result = carry_out(design, arguments.output, arguments.jobs, gradient=arguments.gradient)
    except KeyboardInterrupt:
        return options.interrupted()
    _print(result, arguments)
    return screen.CommandResult(0, result.plain())


def words(arguments: argparse.Namespace) -> list[str]:
    """Words of the same command in its directory.

    Args:
        arguments: arguments of the command.

    Returns:
        Words after ``granchain``.

    Raises:
        InputError: the file is no design.
    """
    file.load(arguments.design)
    path, jobs = str(arguments.design.absolute()), [] if arguments.jobs is None else ["--jobs", str(arguments.jobs)]
    return ["design", path, "-o", ".", *jobs, *(["--gradient"] if arguments.gradient else [])]


def _print(result: DesignResult, arguments: argparse.Namespace) -> None:
    design = result.design
    how = "all there are" if design.exhaustive else "by evolution"
    screen.print_table(f"{screen.one_line(arguments.design)}: {len(result.records)} designs, {how}", *result.table())
    if result.undefined:
        print(
            f"{result.undefined} designs do not count: {design.objective} or a quantity with a limit is undefined "
            "there (for one at the far end: its largest value is not reached within the duration)"
        )
    for warning in result.warnings:
        print(f"warning: {screen.one_line(warning)}")
    print(result.tolerance)
    if result.derivatives:
        screen.print_table("derivatives at the best design", HEAD, [line.cells() for line in result.derivatives])
    print(f"each design took {result.seconds * 1e3:.3g} ms of processor time")
    screen.print_files(arguments.output, (PAGE, BEST, TABLE))
