"""Claims about decks that start away from rest, move beads along given paths, or relax before the kick."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from chain_decks import chain_deck

from lammps_inputs import library
from lammps_inputs.decks import scene_files
from workflow.plugins.adopt.adopt import Adopted, adopt
from workflow.plugins.adopt.motions import GivenMotion

WALL = "fix w all wall/gran hertz/history 2000 0 0 0 0 0 xplane"

SHAKER = """variable t equal step*dt
variable x equal 0.05*(sin(3*v_t)+sin(7*v_t)/2)
variable v equal 0.05*(3*cos(3*v_t)+3.5*cos(7*v_t))
fix p first move variable v_x NULL NULL v_v NULL NULL"""

STOPS = """variable t equal step*dt
variable v equal 0.05*(v_t>=0.5)*(v_t<2)
fix p first move variable NULL NULL NULL v_v NULL NULL"""


pytestmark = pytest.mark.usefixtures("here")


def read(folder: Path, lines: str, spacing: float = 1.0) -> Adopted:
    lines = f"timestep 1e-3\ngroup first id 1\ngroup others subtract all first\n{lines}"
    deck = chain_deck(folder / "in.chain", [0.5 + spacing * bead for bead in range(8)], lines)
    return adopt(deck, None, [], 100.0)


MOVED: dict[str, tuple[str, dict[str, Any]]] = {
    "a piston": ("fix 1 others nve\nfix p first move linear 0.05 0 0\nrun 3000", {"velocity": 0.05}),
    "a piston by its velocity from a later step on": (
        "reset_timestep 700\nfix 1 all nve\nfix 2 first setforce 0 0 0\nvelocity first set 0.05 0 0\nrun 3000",
        {"velocity": 0.05},
    ),
    "a piston that stops": (f"fix 1 others nve\n{STOPS}\nrun 3000", {"velocity": 0.05, "from": 0.5, "until": 2.0}),
    "a harmonic motion": (
        "fix 1 others nve\nfix p first move wiggle 0.05 0 0 2.5\nrun 3000",
        {"displacement": 0.05, "frequency": 0.4},
    ),
    "two tones": (f"fix 1 others nve\n{SHAKER}\nrun 3000", {"quantity": "displacement"}),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", MOVED)
def test_beads_that_the_deck_moves_have_a_drive(name: str, tmp_path: Path) -> None:
    lines, keys = MOVED[name]
    adopted = read(tmp_path, lines)
    drive = adopted.scene.plain()["drive"]
    numbers = {key: value for key, value in keys.items() if key != "quantity"}
    assert {key: drive[key] for key in numbers} == pytest.approx(numbers, abs=1.5e-3)  # LAMMPS moves in time steps
    assert drive.get("quantity") == keys.get("quantity")
    assert not {"kick", "initial", "walls"} & adopted.scene.plain().keys()
    assert adopted.difference < (1e-5 if "quantity" in keys else 1e-9)


STARTS: dict[str, tuple[str, float, dict[str, Any]]] = {
    "a fall": (
        f"fix 1 all nve\nfix g all gravity 1 vector -1 0 0\n{WALL} -0.25 NULL\nrun 3000",
        1.25,
        {"gap": 0.25, "gravity": {"acceleration": 1.0, "settled": False}, "walls": {"right": "flat"}},
    ),
    "overlapping beads that fly apart": ("fix 1 all nve\nrun 3000", 0.99, {}),
    "a loaded chain with a bead out of place": (
        f"{WALL} 0 7.93\nfix 1 all nve\nset atom 3 x 2.47\nrun 3000",
        0.99,
        {"walls": {"left": "flat", "right": "flat"}},
    ),
    "walls elsewhere": (
        f"{WALL} -1 9.5\nfix 1 all nve\nvelocity first set -1 0 0\nrun 9000",
        1.1,
        {"walls": {"left": "flat", "right": "flat"}},
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", STARTS)
def test_a_start_away_from_rest_is_read(name: str, tmp_path: Path) -> None:
    lines, spacing, keys = STARTS[name]
    adopted = read(tmp_path, lines, spacing)
    plain = adopted.scene.plain()
    assert {key: plain[key] for key in keys} == keys
    assert ("initial" in plain) == (name != "a fall")
    assert adopted.difference < 1e-8


@pytest.mark.slow
@pytest.mark.parametrize("load", ["precompression", "gravity"])
def test_a_chain_that_relaxes_and_is_then_kicked_is_a_kick_of_a_loaded_chain(load: str, tmp_path: Path) -> None:
    """The two runs are one scene, whose load follows from the walls, or from the weight of the beads."""
    gravity = load == "gravity"
    force = "fix g all gravity 1 vector -1 0 0" if gravity else ""
    lines = (
        f"{WALL} 0 {'NULL' if gravity else '7.9'}\n{force}\nfix 1 all nve\nfix v all viscous 2\nrun 30000\nunfix v\n"
        f"group kicked id {8 if gravity else 1}\nvelocity kicked set {-0.05 if gravity else 0.05} 0 0\nrun 1000 upto\n"
        "run 33000 upto"
    )
    adopted = read(tmp_path, lines, 1.02 if gravity else 0.99)
    plain = adopted.scene.plain()
    assert plain["kick"] == {"chain": 1, "bead": 1, "velocity": 0.05}
    assert "initial" not in plain
    assert adopted.scene.duration == pytest.approx(3.0)
    assert adopted.scene.adopted is not None
    assert adopted.scene.adopted.first_step == 30000
    if gravity:
        assert plain["gravity"] == pytest.approx(1.0, rel=1e-7)
    else:  # seven contacts of 1000 overlap^1.5 and two walls of 2000/sqrt(2) overlap^1.5 share 0.1
        overlap = 0.1 / (7.0 + 2.0 ** (1.0 - 1.0 / 3.0))
        assert plain["precompression"]["force"] == pytest.approx(1000.0 * overlap**1.5, rel=1e-6)
    assert adopted.difference < 1e-5
    assert [note for note in adopted.notes if "begins with run 2" in note]


DISPLACED: dict[str, dict[str, Any]] = {
    "held and loaded": {
        "precompression": {"force": 0.5},
        "walls": {"left": "bead", "right": "flat"},
        "initial": {"bead": 3, "displacement": 0.2},
        "drive": {"bead": 6, "velocity": -0.4, "until": 3},
    },
    "on springs": {
        "chains": 2,
        "foundation": {"stiffness": 0.3, "cubic": 0.1},
        "coupling": {"stiffness": 0.2},
        "initial": [{"bead": 2, "displacement": -0.7}, {"chain": 2, "bead": 5, "displacement": 0.4, "velocity": 0.1}],
    },
    "settled": {"gravity": 0.1, "walls": {"right": "flat"}, "initial": {"bead": 2, "displacement": -0.3}},
}


@pytest.mark.slow
@pytest.mark.parametrize("name", DISPLACED)
def test_displacements_come_back_from_the_deck_of_a_scene(name: str, tmp_path: Path) -> None:
    scene = library.from_plain(
        {"name": "displaced", "beads": 8, "duration": 10, "timestep": 0.01} | DISPLACED[name], "test"
    )
    (tmp_path / "deck").mkdir()
    scene_files.write(scene, tmp_path / "deck")
    adopted = adopt(tmp_path / "deck" / "in.chains", None, [], 100.0)
    assert adopted.difference < 1e-8
    start, again, units = scene.problem().system.start, adopted.scene.problem().system.start, adopted.scene.scale
    assert start is not None
    assert again is not None
    # lengths and velocities of the deck are in the first scene's units
    np.testing.assert_allclose(again.displacement * units.length, start.displacement, atol=1e-6)
    np.testing.assert_allclose(again.velocity * units.velocity, start.velocity, atol=1e-6)


@pytest.mark.parametrize(("begin", "end"), [(0.0, 7.3), (1.25, 9.0), (2.0, 3.0), (9.875, 10.0)])
def test_the_times_of_a_piston_are_exact_between_recorded_places(begin: float, end: float) -> None:
    time = np.linspace(0.0, 10.0, 161)
    keys = GivenMotion(time, -0.3 * (np.clip(time, begin, end) - begin)).keys()
    assert keys.pop("velocity") == pytest.approx(-0.3, rel=1e-9)
    expected = ({"from": begin} if begin else {}) | ({"until": end} if end < 10.0 else {})
    assert keys == pytest.approx(expected, rel=1e-9)
