"""What a step of LAMMPS costs with ingredients against without, and with a window against whole chains."""

import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from analysis.against.common_times import near_the_front
from analysis.files import recording
from lammps_inputs import Coupling, Kick, Output, Scene, file_names, library
from lammps_inputs.decks import deck
from workflow.engines.lammps import engine
from workflow.studies.bench.alternatives import lammps_seconds, without_frames
from workflow.studies.bench.study import Ratio, make_ratio, ratio_of

# --- ingredients ------------------------------------------------------------------------------------------------------

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
        yield ratio_of(label, pairs, most, below=True)


def _text(scene: Scene, folder: Path) -> str:
    """The deck without its frames; its data file in a folder."""
    folder.mkdir(parents=True)
    deck.write(scene, folder)
    return without_frames((folder / file_names.DECK).read_text())


# --- window -----------------------------------------------------------------------------------------------------------

BEADS = (1_000, 3_000, 10_000, 30_000)
ROWS = 64
LONGEST_WHOLE = 1_000
"""Whole chains are run to their end up to here; of longer ones a stretch in the middle of the run gives the rate."""

LESS, GROWTH = 50.0, 1.3


def scene(beads: int, window: int | None) -> Scene:
    """Two chains, kappa = 0.1, until the pulse has run through them."""
    return Scene(
        name="window",
        chains=2,
        beads=beads,
        coupling=Coupling(stiffness=0.1),
        kick=(Kick(velocity=1.0),),
        duration=1.36 * beads,
        output=Output(every=2.0),
        window=window,
    )


def window_ratios(root: Path) -> Iterator[Ratio]:
    """Time and work of window and whole chains, and whether their front is the same; some three minutes."""
    seconds = {beads: _run(scene(beads, ROWS), root / f"window-{beads}") for beads in BEADS}
    each = {beads: 1e3 * took / beads for beads, took in seconds.items()}
    growth = max(each.values()) / each[BEADS[0]]
    detail = ", ".join(f"{beads:,}: {seconds[beads]:.3g} s" for beads in BEADS)
    name = f"window, time a bead of chains of up to {BEADS[-1]:,} / of {BEADS[0]:,}"
    yield make_ratio(name, growth, GROWTH, detail, below=True)
    for beads in BEADS[:3]:
        whole = _whole_seconds(beads, root / f"whole-{beads}")
        how = "run to its end" if beads <= LONGEST_WHOLE else "from its rate over 2,000 steps"
        yield make_ratio(
            f"whole chains / window of {ROWS} rows, 2 x {beads:,}",
            whole / seconds[beads],
            LESS if beads == 10_000 else 0.0,
            f"{whole:.4g} s ({how}), {seconds[beads]:.3g} s; work {beads // ROWS} times",
        )
    different = _different(root / f"whole-{LONGEST_WHOLE}", root / f"window-{LONGEST_WHOLE}")
    name = f"numbers near the front that differ, 2 x {LONGEST_WHOLE:,}"
    yield make_ratio(name, different, 0, "bitwise", below=True)


def _run(case: Scene, directory: Path) -> float:
    directory.mkdir(parents=True)
    deck.write(case, directory)
    return engine.run(directory).seconds


def _whole_seconds(beads: int, directory: Path) -> float:
    case = scene(beads, None)
    if beads <= LONGEST_WHOLE:
        return _run(case, directory)
    directory.mkdir(parents=True)
    deck.write(case, directory)
    before, _ = (directory / file_names.DECK).read_text().rstrip().rsplit("\n", 1)
    return lammps_seconds(directory, f"{before}\nrun 2000") / 2000 * case.problem().steps


def _different(whole: Path, window: Path) -> int:
    """Numbers that differ in the half of the window that is nearer to its head, while it moves on."""
    problem = scene(LONGEST_WHOLE, None).problem()
    expected = list(recording.blocks([whole / file_names.DUMP], problem))
    x = np.concatenate([block.displacement for block in expected])
    seen = count = 0
    for block in recording.blocks([window / file_names.DUMP], scene(LONGEST_WHOLE, ROWS).problem()):
        if block.beads[-1] == problem.beads:
            break
        part = near_the_front(block)
        count += int(np.sum(part.displacement != x[seen : seen + part.frames][..., part.beads - 1]))
        seen += part.frames
    return count
