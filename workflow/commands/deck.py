"""Write the LAMMPS deck of a scene, for any lmp, and a job for it."""

import argparse
from pathlib import Path

from lammps_inputs import file_names, library
from workflow import cost_model
from workflow.runs import contacts
from workflow.runs.deck_directory import write_deck
from workflow.runs.engines import engine_called
from workflow.runs.size import size_of, too_large
from workflow.screen import one_line, print_files, print_heading

EXAMPLES = (
    "deck two-chains -o deck                                  # then, there: lmp -in in.chains",
    "deck my/scene.yaml -o job --slurm --nodes 2 --time 12:00:00   # then, there: sbatch job.sbatch",
    "deck my/scene.yaml -o job --scheduler pbs --partition long   # then, there: qsub job.pbs",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the scene, the directory and the options of a job."""
    parser.add_argument("scene", metavar="SCENE", help="a YAML file, or the name of an installed scene")
    parser.add_argument("-o", "--output", metavar="DIR", type=Path, required=True, help="directory to make")
    parser.add_argument("--overwrite", action="store_true", help="replace an earlier run's files in DIR")
    parser.add_argument("--force", action="store_true", help="even with a time step above the stability bound")
    cost_model.add_job_arguments(parser)


def execute(arguments: argparse.Namespace) -> int:
    """Write deck, data and scene, and the job."""
    options, directory = cost_model.job_options(arguments), one_line(arguments.output)
    written = write_deck(
        library.find(arguments.scene),
        arguments.output,
        source=arguments.scene,
        overwrite=arguments.overwrite,
        force=arguments.force,
        options=options,
    )
    scene = written.scene
    print_heading(scene.name, scene.units)
    size = size_of(scene.problem(), engine_called("lammps"))
    for why in filter(None, [*scene.unlikely, too_large(scene, size)]):
        print(f"warning: {why}")
    if written.step is not None:
        print(written.step.sentence(scene.problem()))
    overlaps = contacts.at_most(scene)
    if overlaps is not None:
        print("\n".join(overlaps.lines()))
    if written.options is not None:
        ranks = written.options.ranks
        print(cost_model.cost(scene.problem(), ranks).sentence())
        slower = cost_model.too_many(scene.problem(), ranks)
        if slower:
            print(slower)
        print_files(arguments.output, written.files)
        submission = written.options.of_scheduler.by_hand
        print(f"`{submission}` there submits the job; `granchain status {directory}` shows its state")
        return 0
    print(f"a run on one core has {size.sentence()}")
    print_files(arguments.output, written.files)
    print(f"`lmp -in {file_names.DECK}` there runs the deck; then `granchain analyze {directory}` analyses it")
    return 0
