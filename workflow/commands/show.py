"""Print a scene with every default, its units and the size of its run, or its values from bead to bead."""

import argparse

from lammps_inputs import InputError, Scene, library, physics, strict_yaml, values
from workflow.prepare.settings import refuse_unanalysable, settle, unstable
from workflow.runs.engines import LAMMPS, REFERENCE
from workflow.runs.size import size_of, too_large
from workflow.screen import CommandResult

ANSWERS = "the scene; with `--values`, each column as a list of chains of beads"
EXAMPLES = (
    "show two-chains",
    "show disordered-chain --values > values.csv",
    "show my/scene.yaml        # times, lengths in the scene's units: reduced, or SI with a material",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the scene."""
    parser.add_argument("scene", metavar="SCENE", help="a YAML file, or the name of an installed scene")
    parser.add_argument(
        "--values",
        action="store_true",
        help="print as CSV what differs from bead to bead instead: exact masses, radii, contact strengths, springs",
    )


def execute(arguments: argparse.Namespace) -> CommandResult:
    """Print YAML that is a scene again, what follows from it in comments; or the table of its values."""
    if arguments.values:
        return _values(library.find(arguments.scene), arguments.scene)
    scene = library.find(arguments.scene)
    refuse_unanalysable(scene, arguments.scene)
    refused = LAMMPS.refusal(scene)
    scene, settings = settle(scene, source=arguments.scene, force=True)
    scene = scene.resolved()
    problem, scale = scene.problem(), scene.scale
    system = problem.system
    print(strict_yaml.dump(scene.plain()), end="")
    size = size_of(problem, REFERENCE if refused else LAMMPS)
    which = "by the reference integrator" if refused else "in LAMMPS on one core"
    print(f"# {problem.chains * problem.beads} beads; a run {which} has {size.sentence()}")
    if refused:
        print(f"# warning: LAMMPS cannot compute it: {refused}")
    if above := too_large(scene, size):
        print(f"# warning: `granchain run` refuses {above}")
    for why in filter(None, [unstable(scene), *scene.unlikely]):
        print(f"# warning: {why}")
    if settings is not None:
        print(f"# {settings.sentence(problem)}")
    print(f"# {scene.units}")
    if scale.si:
        print(f"# the unit of force is m L / T^2 = {scale.short(1.0, 'force')}")
    if physics.gap(system) > 0.0 and physics.coupled(system) and physics.simply_coupled(system):
        from workflow.engines.collisions import modes  # numba takes a third of a second to import

        theta, gap = modes.theta(problem), scale.written(modes.gap_of_eq_5(physics.kappa(system)), "length")
        print(f"# theta = omega D / V = {theta:.6g}, omega = sqrt(2 kappa): all that rigid beads depend on;")
        print(f"#   eq. 5 has theta = {modes.THETA_OF_EQ_5:.6g}, which is a gap of {gap}")
    return CommandResult(0, scene.plain())


def _values(scene: Scene, source: str) -> CommandResult:
    table = values.columns(scene)
    if not table:
        raise InputError(f"{source}: all beads, contacts and springs are alike, so --values has nothing to list")
    for line in values.csv(table):
        print(line)
    return CommandResult(0, values.plain(table))
