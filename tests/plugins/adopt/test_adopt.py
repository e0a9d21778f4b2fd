"""Claims about scenes that are read from LAMMPS decks."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from chain_decks import chain_deck

from lammps_inputs import InputError, Scene, library
from lammps_inputs.decks import scene_files
from lammps_inputs.installed_scenes import installed
from workflow import cli
from workflow.errors import RunError
from workflow.plugins.adopt import adopt as module
from workflow.plugins.adopt.adopt import Adopted, RefusedDeckError, adopt

DECKS = Path(__file__).parent / "decks"

ROUNDING = 1e-9
"""Difference of velocities in V that rounding of measured forces leaves in some thousand steps."""

COLUMN = """
units si
atom_style sphere
boundary p p f
newton off
comm_modify vel yes
variable n equal 8
region box block -0.05 0.05 -0.05 0.05 -0.02 0.3
create_box 2 box
variable i loop ${n}
label next_bead
variable z equal 2*0.005*(${i}-1)
create_atoms 1 single 0 0 ${z}
next i
jump SELF next_bead
set group all diameter 0.01
set group all density 7800
pair_style gran/hertz/history 5e9 NULL 40.0 NULL 0.5 1
pair_coeff * *
group floor id 1
group moving subtract all floor
fix hold floor freeze
fix move moving nve/sphere
set atom ${n} vz -0.5
shell touch precious
dump frames all custom 100 ${file} id z vz
write_data end.data
timestep 1e-7
run ${steps}
"""


def adopted(path: Path, *variables: tuple[str, str], data: Path | None = None) -> Adopted:
    return adopt(path, data, list(variables), 100.0)


def of_scene(scene: Scene, folder: Path) -> Adopted:
    """What is read of the deck of a scene."""
    folder.mkdir()
    scene_files.write(scene, folder)
    return adopted(folder / "in.chains")


def keys(scene: Scene) -> dict[str, Any]:
    """Plain data of a scene without what its deck does not state."""
    absent = ("name", "description", "output", "timestep", "accuracy")
    return {key: value for key, value in scene.plain().items() if key not in absent}


SCENES: dict[str, dict[str, Any]] = {
    "springs": {
        "chains": 3,
        "beads": 12,
        "kinds": {"light": {"mass": 0.5}},
        "replace": {"bead": 5, "kind": "light"},
        "coupling": {"cubic": 0.2, "topology": {"edges": [[1, 2, 0.1], [1, 3, 0.3]]}},
        "foundation": {"stiffness": [0.2, 0.3, 0.2], "rows": [3, 12]},
        "resonators": {"mass": 0.1, "stiffness": 1, "rows": [4, 6]},
        "walls": {"right": "flat"},
        "kick": [{"velocity": 1}, {"chain": 2, "bead": 3, "velocity": -0.5}],
    },
    "ramp": {
        "chains": 2,
        "beads": 12,
        "coupling": {"stiffness": {"from": 0.1, "to": 0.4, "rows": [3, 9]}},
        "kick": {"velocity": 1},
    },
    "loaded": {
        "beads": 10,
        "contact": {"strength": [1, 1, 1, 2, 1, 3, 1, 1, 1]},
        "precompression": {"force": 0.3},
        "damping": {"contact": 0.05, "tension": "allowed"},
        "walls": {"left": "bead", "right": {"stiffness": 3}},
        "kick": {"velocity": 1},
    },
    "ring": {
        "chains": 2,
        "beads": 7,
        "periodic": True,
        "gap": [0.3, 0.1, 0.0, 0.5, 0.2, 0.0, 0.4],
        "kinds": {"heavy": {"mass": 2.0}},
        "replace": {"bead": 5, "kind": "heavy"},
        "coupling": {"stiffness": 0.2},
        "kick": {"bead": 3, "velocity": 1},
    },
}


@pytest.mark.slow
@pytest.mark.usefixtures("here")
@pytest.mark.parametrize("name", SCENES)
def test_a_scene_comes_back_from_its_deck(name: str, tmp_path: Path) -> None:
    scene = library.from_plain({"name": name, "duration": 25, "timestep": 0.01, **SCENES[name]}, "test")
    read = of_scene(scene, tmp_path / "deck")
    assert read.difference < ROUNDING
    problem, again = scene.problem(), read.scene.problem()
    np.testing.assert_allclose(again.timestep, problem.timestep, rtol=1e-9)
    np.testing.assert_allclose(again.system.mass, problem.system.mass, rtol=1e-9)
    for link, other in zip(problem.system.links, again.system.links, strict=True):
        assert type(link.law) is type(other.law)
        np.testing.assert_allclose(other.gap, link.gap, rtol=1e-7, atol=1e-9)
        for value, other_value in zip(link.law, other.law, strict=True):
            expected, actual = np.broadcast_arrays(np.asarray(value, float), np.asarray(other_value, float))
            np.testing.assert_allclose(actual, expected, rtol=1e-7, atol=1e-9)


@pytest.fixture(scope="module")
def column(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Adopted]:
    """A column of steel beads along z in SI units that hits a frozen bead, its folder and its scene."""
    folder = tmp_path_factory.mktemp("column")
    (folder / "in.column").write_text(COLUMN)
    return folder, adopted(folder / "in.column", ("steps", "1500"), ("file", "frames.txt"))


@pytest.mark.slow
def test_a_frozen_bead_is_a_wall_and_gran_hertz_history_a_material(column: tuple[Path, Adopted]) -> None:
    _, read = column
    plain = keys(read.scene)
    assert (read.axis, plain["beads"], plain["walls"]) == ("z", 7, {"left": "bead"})
    # Kn sqrt(R/2) = E sqrt(2 R) / (3 (1 - nu^2)), here with nu = 0
    assert plain["material"] == {"radius": 0.005, "density": 7800.0, "youngs_modulus": 7.5e9, "poisson_ratio": 0.0}
    # gamma_n m_eff sqrt(R_eff)
    mass = 7800.0 * 4.0 / 3.0 * np.pi * 0.005**3
    assert plain["damping"]["law"] == "viscoelastic"
    assert plain["damping"]["contact"] == pytest.approx(40.0 * mass / 2.0 * np.sqrt(0.0025), rel=1e-9)
    assert plain["kick"] == {"chain": 1, "bead": 7, "velocity": -0.5}
    assert read.scene.output.every == pytest.approx(1e-5)
    assert read.scene.duration == pytest.approx(1.5e-4)


@pytest.mark.slow
def test_both_decks_move_alike_and_nothing_is_written_beside_the_deck(column: tuple[Path, Adopted]) -> None:
    folder, read = column
    assert read.difference < ROUNDING
    assert read.steps == 1500 - 1500 % 7
    assert [file.name for file in folder.iterdir()] == ["in.column"]
    assert [note for note in read.notes if "shell touch precious: not executed" in note]


@pytest.mark.usefixtures("here")
@pytest.mark.parametrize(
    ("name", "lines"),
    [
        ("in.three-grains", {8: "not on straight lines", 9: "not on straight lines", 10: "not on straight lines"}),
        ("in.pour", {11: "jkr", 17: "no such fix"}),
    ],
)
def test_what_is_no_chain_is_refused_line_by_line(name: str, lines: dict[int, str]) -> None:
    with pytest.raises(RefusedDeckError) as caught:
        adopted(DECKS / name)
    messages = {int(line.removeprefix(f"{DECKS / name}:").split(":")[0]): line for line in caught.value.lines}
    assert messages.keys() == lines.keys()
    for number, text in lines.items():
        assert text in messages[number]


WALL = "fix w all wall/gran granular hertz 100 0 tangential linear_history 0 0 0 damping velocity xplane NULL 3"


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ("", "has no `run`"),
        ("group one id 1\nfix push one addforce 1 0 0\nrun 10", "no equilibrium was found near it"),
        ("fix weight all gravity 1 vector 0 0 -1\nrun 10", "a force across the chain"),
        ("set atom 1 vx 0\nrun 10", "no bead moves"),
        (f"fix s all spring/self 1e-3\n{WALL}.05\nrun 9000", "springs determine where the beads are at rest"),
        ("variable f equal sin(step)\nfix push all addforce v_f 0 0\nrun 10", "depends on the time"),
        ("group one id 1\nfix p one move linear 0.1 0.1 0\nrun 10", "moved across its chain"),
        ("fix p all move rotate 0 0 0 0 0 1 5\nrun 10", "supported: move linear, move wiggle, move variable"),
        (f"{WALL}.05 wiggle x 0.1 10\nrun 10", "moves a wall, which is not read"),
        ("read_data absent.data add append\nrun 10", "absent.data"),
        ("timestep\nrun 10", "in.chain:18: timestep: Illegal timestep command"),
    ],
)
@pytest.mark.slow
@pytest.mark.usefixtures("here")
def test_other_motions_are_refused_with_their_lines(lines: str, message: str, tmp_path: Path) -> None:
    text = f"fix move all nve\nset atom 1 vx 0.1\ntimestep 0.001\n{lines}"
    pair = "gran/hertz/history 100 0 0 0 0 0"
    deck = chain_deck(tmp_path / "in.chain", [0, 1, 2], text, box="-2 12 -2 2 -2 2", density="1", pair=pair)
    with pytest.raises(InputError) as caught:
        adopted(deck)
    assert message in str(caught.value)


@pytest.mark.slow
def test_a_deck_without_an_end_is_ended(tmp_path: Path) -> None:
    (tmp_path / "in.chain").write_text("label again\njump SELF again\n")
    with pytest.raises(InputError, match=r"in.chain:2: jump SELF again: (did not end within 2 s|.*SIGXFSZ)"):
        adopt(tmp_path / "in.chain", None, [], 2.0)


@pytest.mark.usefixtures("here")
def test_a_scene_that_moves_otherwise_is_not_written(monkeypatch: pytest.MonkeyPatch) -> None:
    """The run beside the deck finds what was overlooked, here dashpots that are left out."""
    monkeypatch.setattr("workflow.plugins.adopt.scene_of.SceneKeys._damping", lambda _: {})
    with pytest.raises(RunError, match="moves otherwise"):
        adopted(DECKS / "in.two-grains")


def test_the_command_writes_the_scene_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Two grains that collide with a restitution; E and nu are those of `hertz/material`."""
    target = tmp_path / "grains.yaml"
    assert cli.main(["adopt", str(DECKS / "in.two-grains"), "-o", str(target)]) == 0
    assert "differ by at most" in capsys.readouterr().out
    plain = keys(library.load(target))
    assert plain["gap"] == pytest.approx(1e-4)
    assert plain["damping"] == {"contact": 0.7, "law": "restitution"}
    assert plain["material"]["youngs_modulus"] == pytest.approx(2e6)
    assert plain["material"]["poisson_ratio"] == 0.3
    assert cli.main(["adopt", str(DECKS / "in.two-grains"), "-o", str(target)]) == 2
    assert "exists already" in capsys.readouterr().err


@pytest.mark.usefixtures("here")
def test_a_data_file_elsewhere_is_read(tmp_path: Path) -> None:
    (tmp_path / "data").mkdir()
    data = tmp_path / "data" / "chain.data"
    atoms = "".join(f"{n} 1 {d} 2.0 {x} 0 0\n" for n, d, x in ((1, 1.0, 0.0), (2, 1.5, 1.25), (3, 1.0, 2.5)))
    data.write_text(
        f"chain\n\n3 atoms\n1 atom types\n\n-5 9 xlo xhi\n-2 2 ylo yhi\n-2 2 zlo zhi\n\nAtoms # sphere\n\n{atoms}"
    )
    (tmp_path / "in.chain").write_text(
        "units lj\natom_style sphere\nboundary f f f\nread_data chain.data\npair_style granular\ncomm_modify vel yes\n"
        "pair_coeff * * hertz/material 1000 0.3 0.25 tangential mindlin NULL 0.5 0.4 damping velocity\n"
        "fix 1 all nve/sphere\nvelocity all set 0 0 0\nset atom 1 vx 0.3\ntimestep 0.001\nrun 400\n"
    )
    read = adopted(tmp_path / "in.chain", data=data)
    assert read.difference < ROUNDING
    mass, larger = np.pi / 3.0, np.pi / 3.0 * 1.5**3
    kinds = keys(read.scene)["kinds"]
    assert [kind for kind in kinds.values() if kind] == [{"mass": pytest.approx(larger / mass), "radius": 1.5}]


REFUSED = {"hammer-from-a-file", "landau-zener", "magnets", "plastic-contacts"}
"""Scenes with forces in time, or with other contacts."""

ALIKE = {"one-chain", "other-exponent", "three-chains", "two-chains-strong", "two-chains-gapped-strong"}
ALIKE |= {"two-chains-steel", "coupled-from-row-41", "coupling-ramp", "heavy-impurity", "dimer", "graded-contacts"}
ALIKE |= {"wall-reflection", "precompressed", "ring-of-three", "half-sine-push", "resonators", "cubic-coupling"}
ALIKE |= {"drive-above-the-cut-off"}
"""Scenes with nothing that another, or one of the three above, has not."""


@pytest.mark.slow
@pytest.mark.usefixtures("here")
@pytest.mark.parametrize("name", sorted(installed().keys() - ALIKE))
def test_installed_scenes_come_back_from_their_decks(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "BEAD_STEPS", 100_000 if name == "column-of-rings" else 500_000)  # formulas are slow
    scene = library.load(installed()[name])
    if name in REFUSED:
        with pytest.raises(RefusedDeckError):
            of_scene(scene, tmp_path / "deck")
        return
    read = of_scene(scene, tmp_path / "deck")
    # drag: the masses in the deck are larger by half a step of it
    assert read.difference < (1e-3 if name == "two-chains-in-oil" else ROUNDING)
    assert (read.scene.chains, read.scene.beads) == (scene.chains, scene.beads)
