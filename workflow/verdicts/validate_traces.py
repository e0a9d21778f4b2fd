"""Is a run right? Compared with measured traces, channel by channel."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from analysis.against.difference import Deviation, Place
from analysis.files import traces
from analysis.files.traces import Channel
from analysis.gauges.channels import beads_of, read_at
from analysis.trajectory import Floats, joined
from lammps_inputs import InputError, Problem
from workflow.formats import figure_files
from workflow.runs.own_files import claim
from workflow.runs.run_directory import RunDirectory
from workflow.runs.whole_files import write_figure, write_json
from workflow.verdicts.given_table import check_channels
from workflow.verdicts.validate import FIGURE, REPORT, TOLERANCES, Validation


def validate_traces(
    directory: RunDirectory, path: Path, *, dimensionless: bool = False, tolerances: dict[str, float] | None = None
) -> Validation:
    """Compare a run with traces in a file (see `analysis.files.traces`); writes ``validation.json`` and a figure.

    Args:
        directory: the run.
        path: the table, whose times are those of the run; zero before its start.
        dimensionless: whether the table is in units of V = 1; else it is in the scene's own units.
        tolerances: quantity -> largest difference let pass, in place of the one in `TOLERANCES`, dimensionless.

    Raises:
        InputError: the table cannot be read, or is of chains, beads, walls or times that the run has not.
    """
    limits = {**TOLERANCES, **(tolerances or {})}
    problem, given = directory.problem, traces.load(path)
    if given.units and (dimensionless or not problem.scale.si):
        raise InputError(f"{path}: names units, but is to be in others (the scene has no material, or --units)")
    check_channels(path, given.channels, problem)
    beads = beads_of(given.channels, problem)
    missing = sorted(set(beads) - set(problem.recorded_beads.tolist()))
    if problem.window is not None or missing:
        raise InputError(f"{path}: needs the motion of bead {(missing or beads)[0]}, which the run did not record")
    worth = np.array([getattr(problem.scale, channel.quantity) for channel in given.channels])
    if dimensionless:
        given = replace(given, time=given.time * problem.scale.time, values=given.values * worth)
    whole = joined(directory.blocks())[: problem.frames + 1]
    columns = np.searchsorted(problem.recorded_beads, beads)
    run = replace(
        whole,
        problem=replace(problem, recorded=beads),
        displacement=whole.displacement[:, :, columns],
        velocity=whole.velocity[:, :, columns],
    )
    try:
        found = read_at(run, given.channels, given.time)
    except InputError as error:
        raise InputError(f"{path}: {error}; if the table is in other units, see --units") from None
    apart = (found - given.values) / worth
    times = given.time / problem.scale.time
    kinds = {"length": "displacement"}
    own = {channel.name: limits[kinds.get(channel.quantity, channel.quantity)] for channel in given.channels}
    result = Validation(
        problem=problem,
        against=str(path),
        deviations={
            channel.name: _deviation(channel, column, times, own[channel.name], problem)
            for channel, column in zip(given.channels, apart.T, strict=True)
        },
        tolerances=own,
        causes=(),
        remarks=(),
        certificate=None,
        interpolation=None,
        frames=whole.frames,
        compared=len(given.time),
    )
    from analysis.figures.traces import residual_figure  # matplotlib takes half a second to import

    claim(directory.path, (REPORT, *figure_files(FIGURE)))
    write_json(directory.path / REPORT, result.plain())
    allowed = np.array(list(own.values())) * worth
    write_figure(directory.path, FIGURE, residual_figure(problem, given, found, allowed, "tolerance"))
    return result


def _deviation(channel: Channel, apart: Floats, times: Floats, tolerance: float, problem: Problem) -> Deviation:
    size = np.abs(apart[np.isfinite(apart)])
    when = times[np.isfinite(apart)]
    bead = channel.bead or (problem.beads if channel.right else 1)
    exceeding = np.flatnonzero(~(size <= tolerance))
    return Deviation(
        float(size.max()),
        float(np.sqrt(np.mean(size**2))),
        Place(channel.chain, bead, float(when[np.argmax(size)])),
        Place(channel.chain, bead, float(when[exceeding[0]])) if len(exceeding) else None,
    )
