"""What a page states of two runs: settings that differ, the verdict, differences, and the quantities of both."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from analysis.compare.common_times import paired
from analysis.trajectory import Trajectory
from lammps_inputs import InputError
from workflow.engines.reference import engine
from workflow.engines.reference.step_halving import compared_rows
from workflow.quantities.columns import QUANTITIES, UNCERTAINTIES
from workflow.runs.engines import engine_called
from workflow.runs.run_directory import RunDirectory
from workflow.screen import PrintedTable
from workflow.sweep.collect import SweepTable, quantities
from workflow.sweep.run_sweep import is_analysed, read_json
from workflow.verdicts.analyse import analyse
from workflow.verdicts.analysis_report import REPORT
from workflow.verdicts.validate import Validation, blocks
from workflow.verdicts.validate_run import recorded_by_both, scene_changes, where_both_hold
from workflow.verdicts.validation_tables import (
    bitwise_line,
    chain_table,
    change_table,
    deviation_table,
    uncertainty_lines,
)

# --- frames -----------------------------------------------------------------------------------------------------------

Pairs = Iterator[tuple[Trajectory, Trajectory]]


def pairs_of_runs(runs: tuple[RunDirectory, RunDirectory]) -> Pairs:
    """Blocks of two runs at the rows and times that are compared."""
    return (where_both_hold(*pair) for pair in recorded_by_both(runs).pairs(runs))


def pairs_of_reference(directory: RunDirectory, comparison: Validation) -> Pairs:
    """Blocks of a run and of the reference that it was validated against."""
    steps = None if comparison.uncertainty is None else comparison.uncertainty.steps_per_frame
    problem = directory.problem
    reference = engine.blocks(problem, steps_per_frame=steps, window=compared_rows(problem))
    return paired(blocks(directory), reference)


# --- sentences --------------------------------------------------------------------------------------------------------


def compared_lines(runs: tuple[RunDirectory, ...], comparison: Validation) -> list[str]:
    """Sentences on what was compared, and whether it agrees."""
    letters = [
        f"{letter} is {run.path} ({engine_called(run.engine).title})" for letter, run in zip("AB", runs, strict=False)
    ]
    if len(runs) == 1:
        letters.append("B is the reference integrator")
    lines = [
        *dict.fromkeys(run.scene.units for run in runs),
        ", ".join(letters),
        bitwise_line(comparison),
        "" if _of_other_scenes(runs) else f"the validation {'passed' if comparison.passed else 'has NOT passed'}",
        *uncertainty_lines(comparison),
        *comparison.remarks,
        *(f"likely cause: {cause}" for cause in comparison.causes),
    ]
    if not comparison.complete:
        lines.append(f"frames at {comparison.frames} of {comparison.problem.frames + 1} times are in both")
    return [f"{line[0].upper()}{line[1:]}." for line in lines if line]


def _of_other_scenes(runs: tuple[RunDirectory, ...]) -> bool:
    return len(runs) == 2 and bool(scene_changes(runs[0].scene, runs[1].scene))


# --- tables -----------------------------------------------------------------------------------------------------------


def setting_table(runs: tuple[RunDirectory, ...], comparison: Validation) -> PrintedTable | None:
    """Fields of the scenes, settings and versions that differ between two runs; None where nothing does."""
    if comparison.runs is None:
        return None
    return change_table({**scene_changes(runs[0].scene, runs[1].scene), **comparison.runs.changes}, comparison.against)


def compared_tables(runs: tuple[RunDirectory, ...], comparison: Validation) -> list[PrintedTable]:
    """Tables of the differences of the motion, and of the quantities of both runs."""
    tables = [
        deviation_table(comparison, judged=not _of_other_scenes(runs)),
        chain_table(comparison),
        quantity_table(runs[0], runs[1]) if len(runs) == 2 else None,
    ]
    return [table for table in tables if table is not None]


def quantity_table(first: RunDirectory, second: RunDirectory) -> PrintedTable | None:
    """Quantities of two runs as `granchain collect` gathers them, with their uncertainties, and the differences.

    The uncertainty of a difference is the sum of both. None where neither run could be analysed.
    """
    rows = [_quantities(run) for run in (first, second)]
    table = SweepTable([], rows, si=first.problem.scale.si)
    lines = []
    for name, quantity in QUANTITIES.items():
        values = table.numbers(name).tolist()
        if not quantity.label or name in UNCERTAINTIES.values() or all(map(math.isnan, values)):
            continue
        errors = table.numbers(UNCERTAINTIES[name]).tolist() if name in UNCERTAINTIES else [math.nan] * 2
        open_ends = table.unsettled(name) & np.isfinite(values)
        cells = [
            written(value, error) + (" (not settled)" if is_open else "")
            for value, error, is_open in zip(values, errors, open_ends, strict=True)
        ]
        difference = written(values[0] - values[1], sum(errors), digits=4)
        lines.append([table.label(name).plain, *cells, difference])
    lines += [["state", *(str(row["state"] or "-") for row in rows), ""]]
    return PrintedTable("quantities of both runs", ["quantity", "A", "B", "A minus B"], lines)


def _quantities(run: RunDirectory) -> dict[str, Any]:
    """Quantities of a run by column of `granchain collect`; it is analysed first where it was not."""
    if not is_analysed(run.path):
        try:
            analyse(run, figures=False)
        except InputError:
            return quantities({}, run.account.plain(), run.scene.plain())
    return quantities(read_json(run.path / REPORT), run.account.plain(), run.scene.plain())


def written(value: float, uncertainty: float, digits: int = 7) -> str:
    """A number to two digits of its uncertainty, with that; to some digits where none is known, or it is as small."""
    if math.isnan(value):
        return "-"
    if value.is_integer() and not uncertainty > 0.0:
        return f"{value:.0f}"
    if not 5e-7 * abs(value) < uncertainty < math.inf:
        return f"{value:.{digits}g}"
    decades = math.floor(math.log10(abs(value) or uncertainty)) - math.floor(math.log10(uncertainty))
    return f"{_digits(value, decades + 2)} \u00b1 {_digits(uncertainty, 2)}"


def _digits(value: float, digits: int) -> str:
    """A number to at least one significant digit, with zeros at its end, but no point there."""
    return f"{value:#.{max(1, digits)}g}".replace(".e", "e").rstrip(".")
