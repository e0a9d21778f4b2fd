"""What a page states of two runs: settings that differ, the verdict, differences, and the quantities of both."""

import math

import numpy as np

from granchain.parts import RunDirectory, engines, screen, table_of, validate, validate_run, validation_tables

# --- sentences --------------------------------------------------------------------------------------------------------


def compared_lines(runs: tuple[RunDirectory, ...], comparison: validate.Validation) -> list[str]:
    """Sentences on what was compared, and whether it agrees."""
    letters = [
        f"{letter} is {run.path} ({engines.engine_called(run.engine).title})"
        for letter, run in zip("AB", runs, strict=False)
    ]
    if len(runs) == 1:
        letters.append("B is the reference integrator")
    lines = [
        *dict.fromkeys(run.scene.units for run in runs),
        ", ".join(letters),
        validation_tables.bitwise_line(comparison),
        "" if _of_other_scenes(runs) else f"the validation {'passed' if comparison.passed else 'has NOT passed'}",
        *validation_tables.uncertainty_lines(comparison),
        *comparison.remarks,
        *(f"likely cause: {cause}" for cause in comparison.causes),
    ]
    if not comparison.complete:
        lines.append(f"frames at {comparison.frames} of {comparison.problem.frames + 1} times are in both")
    return [f"{line[0].upper()}{line[1:]}." for line in lines if line]


def _of_other_scenes(runs: tuple[RunDirectory, ...]) -> bool:
    return len(runs) == 2 and bool(validate_run.scene_changes(runs[0].scene, runs[1].scene))


# --- tables -----------------------------------------------------------------------------------------------------------


def setting_table(runs: tuple[RunDirectory, ...], comparison: validate.Validation) -> screen.PrintedTable | None:
    """Fields of the scenes, settings and versions that differ between two runs; None where nothing does."""
    if comparison.runs is None:
        return None
    return validation_tables.change_table(
        {**validate_run.scene_changes(runs[0].scene, runs[1].scene), **comparison.runs.changes}, comparison.against
    )


def compared_tables(runs: tuple[RunDirectory, ...], comparison: validate.Validation) -> list[screen.PrintedTable]:
    """Tables of the differences of the motion, and of the quantities of both runs."""
    tables = [
        validation_tables.deviation_table(comparison, judged=not _of_other_scenes(runs)),
        validation_tables.chain_table(comparison),
        quantity_table(runs[0], runs[1]) if len(runs) == 2 else None,
    ]
    return [table for table in tables if table is not None]


def quantity_table(first: RunDirectory, second: RunDirectory) -> screen.PrintedTable | None:
    """Quantities of two runs as `granchain collect` gathers them, with their uncertainties, and the differences.

    The uncertainty of a difference is the sum of both. None where neither run could be analysed.
    """
    table = table_of((first, second))
    uncertainties = {name: table.uncertainty(name) for name in table.columns}
    lines = []
    for name, uncertainty in uncertainties.items():
        values = table.numbers(name).tolist()
        if name in uncertainties.values() or all(map(math.isnan, values)):
            continue
        errors = table.numbers(uncertainty).tolist() if uncertainty else [math.nan] * 2
        open_ends = table.unsettled(name) & np.isfinite(values)
        cells = [
            written(value, error) + (" (not settled)" if is_open else "")
            for value, error, is_open in zip(values, errors, open_ends, strict=True)
        ]
        difference = written(values[0] - values[1], sum(errors), digits=4)
        lines.append([table.label(name).plain, *cells, difference])
    lines += [["state", *(str(row["state"] or "-") for row in table.rows), ""]]
    return screen.PrintedTable("quantities of both runs", ["quantity", "A", "B", "A minus B"], lines)


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
