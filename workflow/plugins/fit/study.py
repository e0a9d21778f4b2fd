"""Estimate fields of a scene from measured forces or velocities, with confidence intervals.

The input is a scene and a table of traces; the output is the fitted fields, a run of LAMMPS with them, and a report.

| file           | contents                                                                     |
|----------------|------------------------------------------------------------------------------|
| fit.json       | the result, see `Fit.plain`                                                  |
| fitted.yaml    | the scene with the fitted fields; its first line says where these do not fit |
| residuals.png  | traces, and their residuals                                                  |
| lammps/        | run directory of the fitted scene, over the time of the data                 |
"""

import argparse
import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import qmc

from granchain import InputError, load
from granchain.parts import (
    Floats,
    Study,
    channels,
    checked,
    formats,
    inputs,
    installed_scenes,
    library,
    options,
    run,
    screen,
    strict_yaml,
)
from workflow.plugins.fit.estimate import FitResult, estimate
from workflow.plugins.fit.model import NO_SCENE, Model, aligned, squares
from workflow.plugins.fit.result import Fit, InLammps, judged

if TYPE_CHECKING:
    from matplotlib.figure import Figure

REPORT, FITTED, FIGURE, LAMMPS = "fit.json", "fitted.yaml", "residuals", "lammps"
STUDY = Study(
    "fit",
    f"{REPORT} holds what was found",
    tables=(REPORT, FITTED),
    figures=(FIGURE,),
    others=(LAMMPS,),
    resume="the same command fits again",
)

STARTS = 32
"""Number of points around the start, of which the best begin searches, too."""

SPREAD = math.log(1.5)
"""Largest distance of these points from the start, in logarithms of the fields."""

BEGUN = 3
"""Number of searches from the best of these points."""


@checked
def fit(
    scene: inputs.AnyScene,
    against: inputs.AnyTraces,
    free: Sequence[str],
    directory: Path | str,
    *,
    offset: float | None = None,
    lammps: bool = True,
    gradient: bool = False,
) -> Fit:
    """Estimate fields of a scene from measured traces, with confidence intervals where a test of fit is passed.

    Writes the same files as ``granchain fit``.

    Args:
        scene: a name, a file, plain data or a `Scene`; its values are the start of the search.
        against: table of traces in the scene's units, or what ``trace_file`` returns, also with gains and baselines
            that are ``"free"``.
        free: fields to estimate, such as ``["coupling.stiffness", "kick.velocity"]``.
        directory: created if it does not exist.
        offset: by how much the table's times are later than the scene's; None to estimate it, too.
        lammps: whether to run the fitted scene in LAMMPS.
        gradient: whether derivatives are those of the tangent flow, not differences of runs.

    Returns:
        Estimates with intervals, in the scene's units, the test of fit, and the residuals of each channel.

    Raises:
        InputError: the scene, the table or a field cannot be used.
        RunError: LAMMPS failed.

    Examples:
        >>> import numpy as np
        >>> scene = {"name": "short", "beads": 12, "kick": {"velocity": 1.0}, "duration": 8.0}
        >>> frames = granchain.run(scene, "measured", engine="reference").trajectory
        >>> rows = np.column_stack([frames.time, frames.velocity[:, 0, 3]])
        >>> np.savetxt("traces.csv", rows, delimiter=",", header="time,velocity_1_4", comments="")
        >>> start = granchain.load(scene, {"kick.velocity": 1.05})
        >>> fitted = granchain.fit(start, "traces.csv", ["kick.velocity"], "fitted", offset=0.0, lammps=False)
        >>> round(fitted.free["kick.velocity"].value, 4)
        1.0
    """
    file = Path(against) if isinstance(against, str) else against
    model = Model(load(scene).plain(), inputs.source_of(scene), list(free), file, offset, gradient=gradient)
    return carry_out(model, Path(directory), lammps=lammps)


def carry_out(model: Model, directory: Path, *, lammps: bool = True) -> Fit:
    """Estimate fields of a scene from measured traces, and write the result.

    Args:
        model: traces of the scene by its fields, and the measured ones.
        directory: made if need be.
        lammps: whether to run the fitted scene in LAMMPS.

    Returns:
        The result, which is also written.

    Raises:
        InputError: the table or the directory cannot be used.
        RunError: LAMMPS failed.
    """
    with STUDY.opened(directory):
        size = _sizes(model)
        estimated = _best(model, size)
        result = judged(model, estimated, size)
        comment = _comment(result)
        fitted = library.from_plain(model.scene_at(estimated.parameters), model.source).plain()
        STUDY.write(directory, {FITTED: comment + strict_yaml.dump(fitted)})
        if lammps:
            result = replace(result, lammps=_in_lammps(model, estimated, directory / LAMMPS))
        STUDY.write(
            directory,
            {REPORT: result.plain()},
            {FIGURE: _figure(model, estimated, rejected=result.fits is False)},
        )
    return result


def _comment(result: Fit) -> str:
    """Lines above the fitted scene; empty where its fields are those of a model that fits."""
    lines = [result.verdict] if result.fits is False else []
    undetermined = [name for name, entry in result.free.items() if entry.value is None]
    if undetermined:
        lines.append(f"undetermined, one of many values that fit as well: {', '.join(undetermined)}")
    return "".join(f"# {line}\n" for line in lines)


def _sizes(model: Model) -> Floats:
    """Largest value of the data, of a signal from its middle, [channel], in the channel's unit.

    Raises:
        InputError: there are too few values, or all values of a channel are zero.
    """
    measured, path = model.measured, model.path
    if int(np.isfinite(measured.values).sum()) <= len(model.names) + len(model.sensors.free) + model.finds_offset:
        raise InputError(f"{path}: has fewer values than there are unknowns")
    size = model.sensors.size
    for channel, largest in zip(measured.channels, size, strict=True):
        if not largest > 0.0:
            raise InputError(f"{path}: {channel.name}: holds nothing but one value; leave it out")
    return size


def _best(model: Model, size: Floats) -> FitResult:
    """Best estimate of searches from the start and from points around it."""
    count = len(model.names)
    around = SPREAD * (2.0 * qmc.Sobol(count, seed=1).random(STARTS) - 1.0) if count else []
    points = [aligned(model, point, size) for point in (np.zeros(count), *around)]
    ranked = sorted((point for point in points if point is not None), key=lambda point: point[0])
    if not ranked:
        raise InputError(f"{model.source}: {NO_SCENE}")
    chosen = [point[1] for point in ranked[:BEGUN]]
    if points[0] is not None and not any(point is points[0][1] for point in chosen):
        chosen.append(points[0][1])
    tried = [estimate(model.residuals, model.slopes, start, size) for start in chosen]
    return min(tried, key=lambda fitted: squares(model.residuals(fitted.parameters) / size))


def _in_lammps(model: Model, estimated: FitResult, directory: Path) -> InLammps:
    """Run the fitted scene in LAMMPS over the time of the data, and compare its traces with those of the reference."""
    offset = model.offset(estimated.parameters)
    until = max(float(model.measured.time[-1]) - offset, 0.0) + 8.0 * model.every
    fitted = model.scene_at(estimated.parameters)
    plain = {key: value for key, value in fitted.items() if key not in ("until_bead", "output")}
    scene = library.from_plain({**plain, "duration": until}, model.source)
    done = run(scene, directory, overwrite=directory.exists())
    values = channels.read_at(done.trajectory, model.measured.channels, model.measured.time - offset)
    theirs = model.sensors.signals(values, model.of_sensors(estimated.parameters))
    traces = model.traces(estimated.parameters)
    assert traces is not None
    error = None if done.check is None else done.check.velocity
    difference = np.where(estimated.jumps, 0.0, np.abs(theirs - traces)) / estimated.noise
    return InLammps(error, float(np.max(difference)))


def _figure(model: Model, estimated: FitResult, *, rejected: bool) -> "Figure":
    from granchain.parts import residual_figure  # matplotlib takes half a second to import

    values, run = model.values(estimated.parameters), model.trajectory(estimated.parameters)
    assert values is not None
    assert run is not None
    mark = "; fit rejected" if rejected else ""
    of_sensors = model.of_sensors(estimated.parameters)
    measured = replace(model.measured, values=model.sensors.values(model.measured.values, of_sensors))
    noise = estimated.noise / np.abs(model.sensors.lines(of_sensors)[0])
    return residual_figure(run.problem, measured, values, noise, mark=mark)


# --- command ----------------------------------------------------------------------------------------------------------

ANSWERS = "what fit.json holds"
DRAWS = True
EXAMPLES = (
    "fit scene.yaml --against data.csv --free coupling.stiffness,kick.velocity -o fitted",
    "fit scene.yaml --against data.csv --free material.youngs_modulus --offset 0 -o fitted   # times as the scene's",
    'fit scene.yaml --against scope.csv --columns "time=TIME,force_wall_right (V)=CH1" --gain CH1=free '
    "--free material.youngs_modulus -o fitted",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("scene", metavar="SCENE", help="its fields are where the search starts")
    parser.add_argument(
        "--against",
        metavar="FILE",
        type=Path,
        required=True,
        help="table of traces in the scene's units: time, force_wall_right, force_contact_10, force_sensor_20, "
        "velocity_1_55 (chain, bead)",
    )
    parser.add_argument(
        "--free", metavar="FIELD,...", default="", help="fields to find, such as coupling.stiffness,kick.velocity"
    )
    options.add_traces(parser, free=True)
    parser.add_argument(
        "--offset",
        metavar="TIME",
        type=float,
        help="by how much times of FILE are later than the scene's, such as --offset=-1e-5 (default: found, too)",
    )
    options.add_output(parser)
    parser.add_argument(
        "--gradient", action="store_true", help="take derivatives from the tangent flow, not from differences of runs"
    )
    parser.add_argument("--no-lammps", action="store_true", help="do not run the fitted scene in LAMMPS")


def execute(arguments: argparse.Namespace) -> screen.CommandResult:
    """Fit and print the result; exit code 1 when the search did not converge or the test of fit rejects the model."""
    model = Model(
        library.find(arguments.scene).plain(),
        arguments.scene,
        [name.strip() for name in arguments.free.split(",") if name.strip()],
        options.trace_file(arguments, free=True),
        arguments.offset,
        gradient=arguments.gradient,
    )
    result = carry_out(model, arguments.output, lammps=not arguments.no_lammps)
    _print(result, arguments)
    return screen.CommandResult(0 if result.converged and result.fits is not False else 1, result.plain())


def words(arguments: argparse.Namespace) -> list[str]:
    """Words of the same command in its directory.

    Args:
        arguments: arguments of the command.

    Returns:
        Words after ``granchain``.

    Raises:
        InputError: the scene cannot be used.
    """
    scene = arguments.scene
    path = scene if scene in installed_scenes.installed() else str(Path(scene).absolute())
    library.find(scene)
    words = ["fit", path, "--against", str(arguments.against.absolute()), "--free", arguments.free, "-o", "."]
    words += [] if arguments.offset is None else [f"--offset={arguments.offset!r}"]
    words += [*options.trace_words(arguments), *formats.words()]
    words += ["--gradient"] if arguments.gradient else []
    return [*words, *(["--no-lammps"] if arguments.no_lammps else [])]


def _print(result: Fit, arguments: argparse.Namespace) -> None:
    print(result.verdict)
    for note in result.notes():
        print(note)
    for title, head, rows in result.tables():
        fitted = (
            f"{screen.one_line(arguments.scene)} fitted to {screen.one_line(arguments.against)}: {result.rows} values"
        )
        screen.print_table(fitted if title == "fields" else title, head, rows)
    lammps = result.lammps
    if lammps.difference is not None:
        velocity = lammps.error_velocity
        error = "" if velocity is None else f", with an error of velocities of {velocity:.1e} V"
        print(f"traces of LAMMPS differ from the fitted ones by at most {lammps.difference:.2g} sigma{error}")
    files = (FITTED, REPORT, *STUDY.figure_files)
    screen.print_files(arguments.output, files)
