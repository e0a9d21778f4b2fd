"""Files of a scene: its deck, and the scene itself with every default written out.

Examples:
    >>> scene_files.write(granchain.load("one-chain"), tmp)
    >>> sorted(path.name for path in tmp.iterdir())
    ['data.chains', 'in.chains', 'scene.yaml']
"""

from pathlib import Path

from lammps_inputs import file_names
from lammps_inputs.decks import deck
from lammps_inputs.library import render_scene
from lammps_inputs.problem import Problem
from lammps_inputs.scene import Scene


def render(scene: Scene, problem: Problem | None = None) -> dict[str, str]:
    """File name -> text of everything LAMMPS needs, and the scene itself; the problem is the scene's.

    Raises:
        ValueError: the scene ends at a bead, not at a time (see `Scene.problem`).
    """
    problem = scene.problem() if problem is None else problem
    return {file_names.SCENE: render_scene(scene), **deck.files_of(problem)}


def write(scene: Scene, directory: Path) -> None:
    """Write the deck of a scene into an existing directory."""
    for name, content in render(scene).items():
        (directory / name).write_text(content, encoding="utf-8", newline="\n")
