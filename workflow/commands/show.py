"""Print a scene with every default, its units and the size of its run, or its values from bead to bead."""

import argparse
from dataclasses import replace

from lammps_inputs import InputError, Problem, Scene, library, physics, strict_yaml, values
from lammps_inputs.limits import closing
from workflow.prepare.settings import found_beforehand, refuse_too_large, refuse_unanalysable, settle, unstable
from workflow.processor_time import BEFORE_RUN
from workflow.runs.engines import engine_called
from workflow.runs.size import Size, least_problem, size_beforehand, size_of, too_large
from workflow.screen import CommandResult

PRINTS = True
ANSWERS = "the scene; with `--values`, each column as a list of chains of beads"
EXAMPLES = (
    "show two-chains",
    "show disordered-chain --values > values.csv",
    "show my/scene.yaml        # times, lengths in the scene's units: reduced, or SI with a material",
    "show two-chains --pilot   # with the time step that a pilot run chooses",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the scene."""
    parser.add_argument("scene", metavar="SCENE", help="a YAML file, or the name of an installed scene")
    parser.add_argument(
        "--values",
        action="store_true",
        help="print as CSV what differs from bead to bead instead: exact masses, radii, contact strengths, springs",
    )
    parser.add_argument(
        "--pilot",
        action="store_true",
        help="make the trials of `run` first, which find the duration of `until_bead`, a window that is `auto` and the "
        f"time step, and print those; up to {BEFORE_RUN:.0f} s of processor time",
    )


def execute(arguments: argparse.Namespace) -> CommandResult:
    """Print YAML that is a scene again, what follows from it in comments; or the table of its values."""
    scene = library.find(arguments.scene)
    if arguments.values:
        return _values(scene, arguments.scene)
    refuse_unanalysable(scene, arguments.scene)
    refused = engine_called("lammps").refusal(scene)
    return (_with_trials if arguments.pilot else _as_it_is)(scene, arguments.scene, refused)


def _with_trials(scene: Scene, source: str, refused: str) -> CommandResult:
    """Print a scene with what trials find of it; ``refused`` is why LAMMPS cannot compute it."""
    scene, settings = settle(scene, source=source, force=True)
    scene = scene.resolved()
    problem = scene.problem()
    size = size_of(problem, engine_called("reference" if refused else "lammps"))
    step = "" if settings is None else settings.sentence(problem)
    _print(scene, problem, _in_words(size, refused), _warnings(scene, refused, too_large(scene, size)), step)
    return CommandResult(0, scene.plain())


def _as_it_is(scene: Scene, source: str, refused: str) -> CommandResult:
    """Print a scene without trials: what these would find is left open, as it is in the scene."""
    refuse_too_large(scene, source)
    problem = least_problem(scene)
    size = size_beforehand(scene, problem, engine_called("reference" if refused else "lammps"))
    above = too_large(scene, replace(size, seconds=None) if size.rough else size)
    shown = scene.model_copy(update={"output": scene.resolved().output})
    sought = found_beforehand(scene)
    names = [*(key for key in ("duration", "window") if key in sought), *["time step"] * size.rough]
    step = f"; a rule gives a step of about {scene.scale.written(problem.timestep, 'time', '.3g')}" * size.rough
    trials = f"`run`, `deck` and `show --pilot` find by trials: {', '.join(names)}{step}" if names else ""
    _print(shown, problem, _in_words(size, refused), _warnings(scene, refused, above), trials)
    return CommandResult(0, shown.plain())


def _warnings(scene: Scene, refused: str, above: str) -> list[str]:
    """What a user should know of a scene before it runs."""
    engine = f"LAMMPS cannot compute it: {refused}" if refused else ""
    size = f"`granchain run` refuses {above}" if above else ""
    return [*filter(None, [engine, size, unstable(scene)]), *scene.unlikely]


def _in_words(size: Size, refused: str) -> str:
    return f"a run {'by the reference integrator' if refused else 'in LAMMPS on one core'} has {size.sentence()}"


def _print(scene: Scene, problem: Problem, size: str, warnings: list[str], step: str) -> None:
    """Print a scene and what follows from it: its size, warnings, how its time step is found, its units."""
    scale, system = scene.scale, problem.system
    print(strict_yaml.dump(scene.plain()), end="")
    print(f"# {problem.chains * problem.beads} beads; {size}")
    for why in warnings:
        print(f"# warning: {why}")
    if step:
        print(f"# {step}")
    print(f"# {scene.units}")
    if scale.si:
        print(f"# the unit of force is m L / T^2 = {scale.short(1.0, 'force')}")
    gapped = physics.gap(system) > 0.0 and physics.one_gap(system)
    if gapped and physics.coupled(system) and physics.simply_coupled(system):
        kappa = physics.kappa(system)
        theta, gap = closing.theta(kappa, physics.gap(system)), scale.written(closing.gap_of_eq_5(kappa), "length")
        print(f"# theta = omega D / V = {theta:.6g}, omega = sqrt(2 kappa): all that rigid beads depend on;")
        print(f"#   eq. 5 has theta = {closing.THETA_OF_EQ_5:.6g}, which is a gap of {gap}")


def _values(scene: Scene, source: str) -> CommandResult:
    table = values.columns(scene)
    if not table:
        raise InputError(f"{source}: all beads, contacts and springs are alike, so --values has nothing to list")
    for line in values.csv(table):
        print(line)
    return CommandResult(0, values.plain(table))
