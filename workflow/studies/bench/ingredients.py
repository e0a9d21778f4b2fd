"""What ingredients cost a step of LAMMPS, against the same chains without them."""

import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from lammps_inputs import Scene, file_names, library
from lammps_inputs.decks import deck
from workflow.studies.bench.against_usual_ways import lammps_seconds, without_frames
from workflow.studies.bench.ratio import Ratio, make_ratio

REPEATS = 5

INGREDIENTS: dict[str, tuple[dict[str, Any], float]] = {
    "unequal masses": ({"kinds": {"heavy": {}, "light": {"mass": 0.5}}, "pattern": ["heavy", "light"]}, 1.2),
    "unequal strengths": ({"taper": 1e-4}, 2.0),
    "walls": ({"walls": {"left": "bead", "right": "flat"}}, 1.2),
}
"""Name -> keys of a scene, and the most that they should cost."""


def _scene(**keys: Any) -> Scene:
    plain = {
        "name": "bench",
        "chains": 100,
        "beads": 200,
        "coupling": {"stiffness": 0.1},
        "kick": {"velocity": 1.0},
        "timestep": 0.005,
        "duration": 4.0,
        "output": {"every": 0.1},
    }
    return library.from_plain({**plain, **keys}, "bench")


def ingredient_ratios(root: Path) -> Iterator[Ratio]:
    """Steps of the deck without frames, with each ingredient and without, in turn; in time of the processor."""
    plain = _text(_scene(), root / "plain")
    for name, (keys, most) in INGREDIENTS.items():
        folder = root / name.replace(" ", "-")
        text = _text(_scene(**keys), folder)
        decks = ((root / "plain", plain), (folder, text))
        pairs = []
        for _ in range(REPEATS):
            without, with_it = (lammps_seconds(*each, time.process_time) for each in decks)
            pairs.append((without, with_it))
        label = f"step with {name} / without, 100 x 200"
        yield make_ratio(label, [b / a for a, b in pairs], most, below=True, times=pairs)


def _text(scene: Scene, folder: Path) -> str:
    """The deck without its frames; its data file in a folder."""
    folder.mkdir(parents=True)
    deck.write(scene, folder)
    return without_frames((folder / file_names.DECK).read_text())
