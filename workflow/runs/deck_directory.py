"""The directory of a deck: LAMMPS input for any ``lmp``, and the scene with all defaults."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from lammps_inputs import InputError, Scene
from lammps_inputs.decks import deck, scene_files
from workflow.prepare.settings import refuse_unanalysable, settle
from workflow.prepare.step_choice import ChosenStep
from workflow.runs.files import LAMMPS_FILES
from workflow.runs.output_directory import prepared, refuse_to_overwrite

FurtherFiles = Callable[[Scene], Mapping[str, str | None]]
"""Files beside a deck, by the scene with nothing left open: name -> text; None of one that is written later."""


@dataclass(frozen=True)
class WrittenDeck:
    """A deck that was written.

    Attributes:
        scene: with the duration, window and time step that it left open.
        step: how the time step was chosen; None where the scene names it.
        files: names of the files.
    """

    scene: Scene
    step: ChosenStep | None
    files: tuple[str, ...]


def write_deck(
    scene: Scene,
    directory: Path,
    *,
    source: str,
    overwrite: bool = False,
    force: bool = False,
    further: FurtherFiles | None = None,
) -> WrittenDeck:
    """Write the deck of a scene, and files beside it, after determining what the scene leaves open.

    Args:
        scene: what to compute.
        directory: new or empty, or an earlier run's with ``overwrite``.
        source: name of the scene in messages.
        overwrite: whether an earlier run's files may be replaced.
        force: whether the time step may be above the stability bound.
        further: files beside the deck; None for none.

    Returns:
        What was written.

    Raises:
        InputError: LAMMPS cannot compute the scene, or the directory cannot be used.
    """
    if why := deck.refusal(scene.system):
        raise InputError(f"{source}: {why}")
    refuse_unanalysable(scene, source)
    settled, step = settle(scene, source=source, force=force)
    beside = {} if further is None else further(settled)
    files = scene_files.render(settled) | {name: text for name, text in beside.items() if text is not None}
    refuse_to_overwrite(source, directory)
    names = (*LAMMPS_FILES, *beside)
    with prepared(directory, files, names, overwrite=overwrite):
        return WrittenDeck(settled, step, tuple(files))
