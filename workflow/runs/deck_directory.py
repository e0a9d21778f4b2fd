"""The directory of a deck: LAMMPS input for any ``lmp``, the scene with all defaults, and a job if asked for."""

from dataclasses import dataclass
from pathlib import Path

from lammps_inputs import InputError, Scene, file_names
from lammps_inputs.decks import deck
from workflow import cost_model
from workflow.plugins.jobs import job
from workflow.plugins.jobs.site import JobOptions
from workflow.prepare.settings import refuse_unanalysable, settle
from workflow.prepare.step_choice import ChosenStep
from workflow.runs.files import LAMMPS_FILES
from workflow.runs.output_directory import prepared, refuse_to_overwrite


@dataclass(frozen=True)
class WrittenDeck:
    """A deck that was written.

    Attributes:
        scene: with the duration, window and time step that it left open.
        step: how the time step was chosen; None where the scene names it.
        options: options of the job, with its number of ranks; None where there is no job.
        files: names of the files.
    """

    scene: Scene
    step: ChosenStep | None
    options: JobOptions | None
    files: tuple[str, ...]


def write_deck(
    scene: Scene,
    directory: Path,
    *,
    source: str,
    overwrite: bool = False,
    force: bool = False,
    options: JobOptions | None = None,
) -> WrittenDeck:
    """Write the deck of a scene, and a job for it, after determining what the scene leaves open.

    Args:
        scene: what to compute.
        directory: new or empty, or an earlier run's with ``overwrite``.
        source: name of the scene in messages.
        overwrite: whether an earlier run's files may be replaced.
        force: whether the time step may be above the stability bound.
        options: options of a job; None for no job.

    Returns:
        What was written.

    Raises:
        InputError: LAMMPS cannot compute the scene, or the directory cannot be used.
    """
    if why := deck.refusal(scene.system):
        raise InputError(f"{source}: {why}")
    refuse_unanalysable(scene, source)
    settled, step = settle(scene, source=source, force=force)
    files = deck.render(settled)
    if options is not None:
        options = cost_model.with_ranks(options, settled.problem())
        files |= job.render_job(options, settled.problem(), directory)
    refuse_to_overwrite(source, directory)
    names = (*LAMMPS_FILES, *(file_names.JOB_FILES if options is not None else ()))
    with prepared(directory, files, names, overwrite=overwrite):
        return WrittenDeck(settled, step, options, tuple(files))
