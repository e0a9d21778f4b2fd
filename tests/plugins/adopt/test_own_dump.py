"""A run of an adopted scene against the dump of the deck: other order of atoms, axis, held ends, few digits."""

import re
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from chain_decks import chain_deck
from processes import HANGS
from stock_lammps import WHEEL

from workflow.plugins.adopt.adopt import Adopted, RefusedDeckError, adopt
from workflow.runs.run import run
from workflow.verdicts.validate_against import validate_against

pytestmark = pytest.mark.usefixtures("here")

TOUCHING = [0.005 + 0.01 * n for n in range(8)]


def deck(
    path: Path,
    places: Sequence[float] = TOUCHING,
    *,
    axis: str = "x",
    kicked: int = 1,
    speed: float = 0.3,
    held: str = "",
    dump: str = "",
) -> Path:
    """A deck of beads of which one has a velocity."""
    velocity = " ".join(f"{speed}" if letter == axis else "0" for letter in "xyz")
    box = " ".join("-0.2 0.2" if letter == axis else "-0.01 0.01" for letter in "xyz")
    ends = f"group ends id {held}\ngroup moving subtract all ends\nfix ends ends freeze"
    lines = (
        f"{ends if held else 'group moving union all'}\nfix motion moving nve/sphere\ntimestep 5e-7\n"
        f"group kicked id {kicked}\nvelocity kicked set {velocity}\n"
        f"dump mine all {dump or f'custom 40 mine.dump id type {axis} v{axis}'}\nrun 600"
    )
    steel = {"units": "si", "diameter": "0.01", "density": "2500", "pair": "gran/hertz/history 1e9 0 0 0 0 0"}
    return chain_deck(path, places, lines, axis, box=box, **steel)


def adopted(path: Path) -> Adopted:
    return adopt(path, None, [], 100.0)


MANY_COLUMNS = "custom 40 mine.dump type x y z id vx vy vz fx diameter"
MANY_DIGITS = "custom 40 mine.dump id x vx\ndump_modify mine format float %.17g\nreset_timestep 1000"
CASES: dict[str, tuple[dict[str, Any], str, str]] = {
    "scaled positions along y": ({"axis": "y", "dump": "atom 40 mine.dump"}, "y", "1-8"),
    "counted from the other end": ({"places": TOUCHING[::-1], "axis": "z"}, "z", "8-1"),
    "held ends and many columns": ({"held": "1 8", "kicked": 2, "dump": MANY_COLUMNS}, "x", "2-7"),
    "any order": ({"places": [TOUCHING[k] for k in (3, 0, 7, 1, 2, 6, 4, 5)], "kicked": 2}, "x", "2,4-5,1,7-8,6,3"),
    "another first step and many digits": ({"held": "1", "kicked": 2, "dump": MANY_DIGITS}, "x", "2-8"),
}


def run_lammps(path: Path) -> None:
    """Run a deck in its folder."""
    words = [str(WHEEL), "-in", path.name, "-log", "none", "-screen", "none"]
    subprocess.run(words, cwd=path.parent, check=True, timeout=HANGS)


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_the_dump_of_an_adopted_deck_is_the_run(name: str, tmp_path: Path) -> None:
    keys, axis, atoms = CASES[name]
    path = deck(tmp_path / "in.mine", **keys)
    read = adopted(path)
    assert read.scene.adopted is not None
    assert (read.scene.adopted.axis, ",".join(read.scene.adopted.atoms)) == (axis, atoms)
    run_lammps(path)
    directory = run(read.scene, tmp_path / "run", check=False).directory
    found = validate_against(directory, tmp_path / "mine.dump")
    assert found.passed, (found.deviations, found.causes)
    assert "displacement" in found.deviations
    if "velocity" in found.deviations:
        assert found.deviations["velocity"].largest < 1e-4
    assert not found.causes


@pytest.mark.slow
def test_the_dump_of_another_kick_does_not_pass_and_is_named(tmp_path: Path) -> None:
    read = adopted(deck(tmp_path / "in.mine"))
    other = deck(tmp_path / "in.other", speed=0.31)
    run_lammps(other)
    found = validate_against(run(read.scene, tmp_path / "run", check=False).directory, tmp_path / "mine.dump")
    assert not found.passed
    assert [re.sub(r".*dump: ", "", cause) for cause in found.causes] == [
        "bead 1 of chain 1 starts with velocity 0.31 m/s instead of 0.3 m/s"
    ]


@pytest.mark.slow
@pytest.mark.parametrize("shift", [0.0, 0.005, 0.37 / 3.0])
def test_contacts_that_overlap_by_rounding_have_no_load_and_keep_their_order(shift: float, tmp_path: Path) -> None:
    read = adopted(deck(tmp_path / "in.mine", [shift - 0.1 + 0.01 * n for n in range(4)]))
    kick = read.scene.plain()["kick"]
    assert (kick["bead"], kick["velocity"]) == (1, 0.3)
    assert not {"gravity", "precompression", "gap"} & read.scene.plain().keys()


@pytest.mark.slow
def test_a_scene_has_frames_in_which_waves_are_seen_however_seldom_the_deck_writes_them(tmp_path: Path) -> None:
    read = adopted(deck(tmp_path / "in.mine", TOUCHING[:4], dump="custom 10000 mine.dump id x vx"))
    # the run of 600 steps is 4 T long, and 12 is the largest divisor of that within 0.1 T
    assert read.scene.plain()["output"]["every"] == pytest.approx(12 * 5e-7)
    assert any("`output.every` is 12 of the 600 steps" in note for note in read.notes)
    assert read.scene.problem().frames == 50


def walled(
    path: Path,
    *,
    pair: str = "hooke 2000 12.0",
    wall: str = "hooke 2000 12.0",
    damping: str = "velocity",
    width: float = 3.5,
    steps: int = 6000,
) -> Path:
    """A deck of two beads between walls."""
    more = f"tangential linear_history 0 0 0 damping {damping}"
    lines = (
        f"fix w all wall/gran granular {wall} {more} xplane 0 {width}\ntimestep 1e-3\nfix 1 all nve/sphere\n"
        f"set atom 1 vx 0.97\nrun {steps}\nclear\nprint done"  # the last two move nothing
    )
    box = f"0 {width} -2 2 -2 2"
    return chain_deck(path, [1.0, 2.5], lines, box=box, pair="granular", coefficients=f"{pair} {more}")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"damping": "mass_velocity"}, ["the dashpot of the left wall is 12 ", "the dashpot of the right wall is 12 "]),
        ({"wall": "hooke 2000 0"}, ["the dashpot of the left wall is 0 ", "the dashpot of the right wall is 0 "]),
        (
            {"wall": "hertz 2000 12.0"},
            ["the force of the left wall grows as overlap^1.5, that of the contacts as overlap^1"],
        ),
    ],
)
def test_the_wall_and_the_law_that_differ_are_named(changes: dict[str, Any], says: list[str], tmp_path: Path) -> None:
    with pytest.raises(RefusedDeckError) as caught:
        adopted(walled(tmp_path / "in.walls", **changes))
    for text in says:
        assert any(text in line and "fix w all wall/gran" in line for line in caught.value.lines), caught.value.lines


@pytest.mark.slow
@pytest.mark.parametrize(("width", "steps", "walls"), [(3.5, 3000, {"left", "right"}), (30.0, 800, {"left"})])
def test_walls_as_far_as_the_next_bead_are_read_and_those_that_are_not_reached_are_noted(
    width: float, steps: int, walls: set[str], tmp_path: Path
) -> None:
    read = adopted(walled(tmp_path / "in.walls", width=width, steps=steps))
    assert set(read.scene.plain()["walls"]) == walls
    assert bool([note for note in read.notes if "is left out: no bead reaches it" in note]) == (len(walls) == 1)
