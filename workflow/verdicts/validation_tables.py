"""Tables of a validation, as `granchain validate` prints them and pages of comparisons show them.

Plug-ins take this module for pages that compare runs: `deviation_table`, `chain_table` and `change_table` are tables,
`uncertainty_lines` and `bitwise_line` sentences.

Examples:
    >>> scene = granchain.load("one-chain", {"beads": 20, "duration": 30.0})
    >>> done = granchain.run(scene, tmp / "run", engine="reference")
    >>> comparison, _ = validate_run.compare_runs((done.directory, done.directory))
    >>> validation_tables.deviation_table(comparison).rows[0]
    ['velocity', '0.00e+00', '0.0e+00', '5.0e-04', 'ok', '']
    >>> validation_tables.bitwise_line(comparison).partition(" as ")[0]
    'the run is bitwise the same'
"""

from collections.abc import Mapping

import numpy as np

from analysis.compare.difference import Deviation
from workflow.screen import PrintedTable, one_line
from workflow.verdicts.validate import Validation

_DRIFTS = ("energy", "momentum")
"""Quantities that say of the run alone how well it conserves them."""


def deviation_table(comparison: Validation, *, judged: bool = True) -> PrintedTable:
    """Largest and root-mean-square difference of each quantity, and where it is largest.

    Args:
        comparison: comparison whose deviations are shown, in V, T and L.
        judged: whether tolerances, verdicts, and the drifts of the run are shown.
    """
    rows = []
    for name, deviation in comparison.deviations.items():
        if name in _DRIFTS and not judged:
            continue
        rms = f"{deviation.rms:.1e}" if np.isfinite(deviation.rms) else ""
        tolerance = comparison.tolerances[name]
        limit = f"{tolerance:.1e}" if np.isfinite(tolerance) else "none"
        verdict = [limit, comparison.verdict(name)] if judged else []
        rows.append([name, f"{deviation.largest:.2e}", rms, *verdict, _place(comparison, deviation)])
    word = "errors" if judged else "differences"
    return PrintedTable(
        f"{word} against {comparison.against} at {comparison.compared} instants, in V, T and L",
        ["quantity", "largest", "rms", *(["tolerance", ""] if judged else []), "largest at"],
        rows,
    )


def _place(comparison: Validation, deviation: Deviation) -> str:
    """Where a quantity differs most, in words; empty where it belongs to no bead."""
    if deviation.where is None:
        return ""
    if deviation.where.time is None:
        return deviation.where.words
    return f"{deviation.where.words}, t = {comparison.problem.scale.written(deviation.where.time, 'time', '.5g')}"


def uncertainty_lines(comparison: Validation) -> list[str]:
    """Sentences on the uncertainty of what a run was compared with."""
    lines = []
    if comparison.uncertainty is not None:
        uncertainty = comparison.uncertainty
        lines.append(
            f"the uncertainty of the reference integrator is {uncertainty.velocity:.1e} V in velocities and "
            f"{uncertainty.arrival:.1e} T in arrivals"
        )
    if comparison.interpolation is not None:
        x, v = comparison.interpolation
        lines.append(
            f"interpolation between frames adds at most {x:.1e} L to displacements and {v:.1e} V to velocities"
        )
    return lines


def bitwise_line(comparison: Validation) -> str:
    """Sentence on whether two runs are bitwise the same; empty where a run was not compared with another one."""
    runs, against = comparison.runs, one_line(comparison.against)
    if runs is None:
        return ""
    if runs.identical:
        return (
            f"the run is bitwise the same as {against} ({comparison.compared} frames, sha256 {runs.sha256[0][:12]}...)"
        )
    since = "" if runs.since is None else f", from t = {comparison.problem.scale.written(runs.since, 'time', '.5g')} on"
    return f"the run is not bitwise the same as {against}{since}"


def chain_table(comparison: Validation) -> PrintedTable | None:
    """Impulses and energy of each chain, where one of two runs has rigid beads; else None."""
    if comparison.runs is None or not comparison.runs.chains:
        return None
    rows = []
    for difference in comparison.runs.chains:
        sizes = (difference.impulse.largest, difference.impulse.rms, difference.share.largest, difference.share.rms)
        impulse, impulse_rms, share, share_rms = (f"{size:.2g}" if np.isfinite(size) else "-" for size in sizes)
        until = "none" if difference.agrees_until is None else str(difference.agrees_until)
        rows.append([str(difference.chain), impulse, impulse_rms, until, share, share_rms])
    within = f"within {comparison.tolerances['impulse']:.0%} to bead"
    return PrintedTable(
        "differences of first impulses, over the largest of the row, and of shares of energy",
        ["chain", "first impulse: largest", "rms", within, "share of energy: largest", "rms"],
        rows,
    )


def change_table(changes: Mapping[str, tuple[str, str]], against: str) -> PrintedTable | None:
    """Settings, versions and fields that differ between two runs; None where nothing does.

    Args:
        changes: name -> (of the run, of the other one).
        against: name of the other run.
    """
    rows = [[name, *map(one_line, values)] for name, values in changes.items()]
    return PrintedTable("settings and versions that differ", ["", "this run", against], rows) if rows else None
