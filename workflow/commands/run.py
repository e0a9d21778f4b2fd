"""Run a scene with LAMMPS, the reference integrator, or the model of rigid beads."""

import argparse
import math
from collections.abc import Iterator
from pathlib import Path

from lammps_inputs import InputError, Problem, Scene, library
from workflow.engines.lammps.engine import RESTART_EVERY
from workflow.engines.registry import engine_names
from workflow.prepare.pilot import better_timestep
from workflow.prepare.step_choice import ChosenStep
from workflow.runs import run as running
from workflow.runs.completed_run import Check, CompletedRun
from workflow.runs.contacts import LargestContactForce
from workflow.runs.engines import engine_called
from workflow.runs.job import onwards
from workflow.runs.output_directory import refuse_to_overwrite
from workflow.runs.resume import begun, resume, settings_of
from workflow.runs.size import size_of
from workflow.screen import CommandResult, one_line, print_heading, progress_bar
from workflow.verdicts.validate import TOLERANCES

ANSWERS = "the record of the run, as in run.json"
EXAMPLES = (
    "run two-chains -o demo",
    "run my/scene.yaml -o out --ranks 2 --restart-every 60   # seconds",
    "run --resume demo",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the scene, the directory, and how to run."""
    parser.add_argument("scene", metavar="SCENE", nargs="?", help="a YAML file, or the name of an installed scene")
    parser.add_argument("-o", "--output", metavar="DIR", type=Path, help="run directory to make")
    parser.add_argument("--resume", metavar="DIR", type=Path, help="resume an interrupted run; without SCENE")
    parser.add_argument("--engine", choices=engine_names(), help="what computes (default lammps)")
    parser.add_argument("--ranks", metavar="N", type=int, help="MPI ranks of LAMMPS (default 1, or as before)")
    parser.add_argument("--overwrite", action="store_true", help="replace an earlier run's files in DIR")
    parser.add_argument("--force", action="store_true", help="run even with a time step above the stability bound")
    parser.add_argument(
        "--restart-every",
        metavar="SECONDS",
        type=_seconds,
        default=RESTART_EVERY,
        help="work that a kill may cost (default %(default)g)",
    )
    parser.add_argument("--no-check", action="store_true", help="do not measure the error against the reference")


def execute(arguments: argparse.Namespace) -> CommandResult:
    """Run, with a progress bar on a terminal; exit code 130 when interrupted."""
    if arguments.resume is not None:
        return _resume(arguments)
    if arguments.scene is None or arguments.output is None:
        raise InputError("run: needs a SCENE and -o DIR, or --resume DIR; `granchain run --help` lists the options")
    refuse_to_overwrite(arguments.scene, arguments.output)
    engine = arguments.engine or "lammps"
    ready = running.prepare_run(
        library.find(arguments.scene),
        arguments.output,
        engine=engine,
        ranks=1 if arguments.ranks is None else arguments.ranks,
        overwrite=arguments.overwrite,
        force=arguments.force,
        source=arguments.scene,
    )
    scene, problem = ready.scene, ready.problem
    print_heading(scene.name, scene.units)
    if ready.step is not None:
        print(ready.step.sentence(problem), flush=True)
    for why in scene.unlikely:
        print(f"warning: {why}")
    size = size_of(problem, engine_called(engine), ready.ranks)
    if size.large:
        print(f"the run has {size.sentence()}", flush=True)
    with progress_bar(scene.name, problem) as progress:
        result = running.run_prepared(
            ready, check=not arguments.no_check, progress=progress, restart_every=arguments.restart_every
        )
    return CommandResult(_tell(result, ready.step), result.directory.job.plain())


def _resume(arguments: argparse.Namespace) -> CommandResult:
    refused = {
        "SCENE": arguments.scene,
        "-o": arguments.output,
        "--engine": arguments.engine,
        "--overwrite": arguments.overwrite or None,
        "--force": arguments.force or None,
    }
    for name, value in refused.items():
        if value is not None:
            raise InputError(f"--resume: continues with the settings of the run; leave out {name}")
    directory = begun(arguments.resume)
    with progress_bar(directory.scene.name, directory.problem) as progress:
        result = resume(
            arguments.resume,
            ranks=arguments.ranks,
            check=not arguments.no_check,
            progress=progress,
            restart_every=arguments.restart_every,
        )
    if result is None:
        print(f"{one_line(arguments.resume)}: the run is done already")
        return CommandResult(0, directory.job.plain())
    print_heading(directory.scene.name, directory.scene.units)
    return CommandResult(_tell(result, settings_of(directory.job)), result.directory.job.plain())


def _tell(result: CompletedRun, settings: ChosenStep | None) -> int:
    """Say how a run ended; exit code 130 if it was interrupted, 1 if impossible or not as accurate as asked."""
    job = result.directory.job
    if result.outcome == "interrupted":
        reached = f" at step {job.steps_done} of {job.steps}; its frames remain" if job.steps_done else ""
        print(f"the run was interrupted{reached}; {onwards(result.directory.path, job)}")
        return 130
    print(engine_called(result.directory.engine).sentence(job))
    overlaps = None if job.contacts is None else LargestContactForce(**job.contacts)
    if overlaps is not None:
        print("\n".join(overlaps.lines()))
    code = max(_tell_error(result, settings), 0 if overlaps is None or overlaps.possible else 1)
    print(f"written to {one_line(result.directory.path)}")
    return code


def _tell_error(result: CompletedRun, settings: ChosenStep | None) -> int:
    """Say how exact a run is; exit code 1 if not as accurate as asked."""
    problem, uncertainty = result.directory.problem, result.directory.job.uncertainty
    if result.check is not None:
        for line in _checked(result.check, problem):
            print(line)
        return _exit_code(result.check, result.directory.scene, settings)
    if settings is not None and uncertainty is not None and uncertainty.velocity is not None:
        return 0 if uncertainty.velocity <= settings.accuracy else 1
    return 0


def _exit_code(check: Check, scene: Scene, settings: ChosenStep | None) -> int:
    """Say so if a run is less accurate than it should be; exit code 1 if an accuracy was asked for."""
    limit, uncertainty = TOLERANCES["velocity"] if settings is None else settings.accuracy, check.reference.velocity
    if check.velocity <= limit and uncertainty <= limit:
        return 0
    if not check.velocity - uncertainty > limit:
        finer = "`granchain validate` takes a finer one" if settings is None else "errors grow in so long a run"
        print(
            "the check is inconclusive: the uncertainty of the reference integrator is too large to compare the error "
            f"with {limit:g} V; {finer}"
        )
    elif settings is None:
        print(f"the error of velocities is more than {limit:g} V; {better_timestep(scene)}")
    elif settings.measured == 0.0:
        print(
            f"the error of velocities is more than {limit:g} V: the time step was given by a rule, not measured; "
            "take a shorter one"
        )
    else:
        print(
            f"the error of velocities is more than {limit:g} V, although the pilot run had less; take a smaller "
            "`accuracy`"
        )
    return 1 if settings is not None and settings.asked else 0


def _seconds(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not value >= 0.0:
        raise argparse.ArgumentTypeError(f"{text!r} given; a number of seconds")
    return value


def _checked(check: Check, problem: Problem) -> Iterator[str]:
    """Lines with the run's error and its uncertainty, in units of V and T, in which errors of scenes are comparable."""
    near = ", in the front half of the window" if problem.rows.follow else ""
    where = ""
    if check.where is not None and check.where.time is not None:
        time = problem.scale.written(check.where.time, "time", ".5g")
        where = f" ({check.where.words}, t = {time})"
    errors = [f"velocities {check.velocity:.1e} V{where}"]
    errors += [f"peak velocities {check.amplitude:.1e} V"] if math.isfinite(check.amplitude) else []
    uncertainty = f"{check.reference.velocity:.1e} V in velocities"
    if math.isfinite(check.arrival):
        errors.append(f"arrivals {check.arrival:.1e} T")
        uncertainty += f" and {check.reference.arrival:.1e} T in arrivals"
    yield f"largest errors against the reference integrator{near}: {', '.join(errors)}"
    yield f"the uncertainty of the reference integrator is {uncertainty}"
