"""Text dumps: of an adopted deck with atoms in any order, along any axis, scaled, or beginning late; of own beads."""

import gzip

import numpy as np
import pytest

from analysis.files import table
from analysis.files.dump_layout import MAGIC
from analysis.files.text_dump import is_text_dump, load_dump
from lammps_inputs import InputError
from lammps_inputs.deck_atoms import DeckAtoms

HEAD = "ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ATOMS\n{count}\nITEM: BOX BOUNDS ff ff ff\n-1 1\n-2 2\n{low} {high}\n"


def dump(tmp_path, columns, frames, low=0.0, high=8.0):
    """A dump of frames: step -> rows of text."""
    path = tmp_path / "mine.dump"
    parts = []
    for step, rows in frames.items():
        parts.append(HEAD.format(step=step, count=len(rows), low=low, high=high) + f"ITEM: ATOMS {columns}\n")
        parts += [f"{row}\n" for row in rows]
    path.write_text("".join(parts))
    return path


def deck(**keys):
    return DeckAtoms(**{"deck": "in.mine", "axis": "z", "atoms": ("7,2,5",), "timestep": 0.5, **keys})


FRAMES = {0: ["5 x 4 0", "2 y 3 0.25", "9 w 7 0", "7 x 1 2"], 20: ["9 w 7 0", "7 y 2 1", "5 x 4 0", "2 x 3.5 1"]}


@pytest.mark.parametrize("first", [0, 300])
def test_beads_are_those_of_the_map_and_steps_count_from_the_first_of_the_deck(first, tmp_path):
    frames = {first + step: rows for step, rows in FRAMES.items()}
    found = load_dump(dump(tmp_path, "id element z vz", frames), beads=3, timestep=0.5, deck=deck(first_step=first))
    assert found.time.tolist() == [0.0, 10.0]
    assert found.displacement[1].tolist() == [[1.0, 0.5, 0.0]]
    assert found.velocity[:, 0].tolist() == [[2.0, 0.25, 0.0], [1.0, 1.0, 0.0]]


def test_against_the_axis_displacements_and_velocities_change_their_sign(tmp_path):
    path = dump(tmp_path, "id element z vz", FRAMES)
    along, against = (
        load_dump(path, beads=3, timestep=0.5, deck=deck(axis=axis, atoms=(atoms,)))
        for axis, atoms in (("z", "7,2,5"), ("-z", "5,2,7"))
    )
    assert np.array_equal(against.displacement[..., ::-1], -along.displacement)
    assert np.array_equal(against.velocity[..., ::-1], -along.velocity)


def test_scaled_positions_are_those_in_the_box_of_their_frame(tmp_path):
    rows = {0: ["7 0.25", "2 0.5", "5 0.75"], 4: ["7 0.375", "2 0.5", "5 0.75"]}
    found = load_dump(dump(tmp_path, "id zs", rows, low=-4.0, high=4.0), beads=3, timestep=0.5, deck=deck())
    assert (found.position[0].tolist(), found.position_unit) == ([[0.25, 0.5, 0.75]], 8.0)
    assert found.displacement[1].tolist() == [[1.0, 0.0, 0.0]]
    assert found.velocity is None


def test_a_dump_that_begins_late_has_velocities_alone_and_is_refused_without(tmp_path):
    late = {step + 300: rows for step, rows in FRAMES.items()}
    found = load_dump(dump(tmp_path, "id element z vz", late), 3, 0.5, deck())
    assert found.displacement is None
    assert found.time.tolist() == [150.0, 160.0]
    with pytest.raises(InputError, match="begins at step 300, after the start"):
        load_dump(dump(tmp_path, "id element z fz", late), 3, 0.5, deck())


def test_a_bead_that_the_dump_lacks_is_unknown(tmp_path):
    rows = {0: ["7 1 2", "2 3 0"], 1: ["7 2 1", "2 3 1"]}
    found = load_dump(dump(tmp_path, "id z vz", rows), beads=3, timestep=0.5, deck=deck())
    assert np.isnan(found.velocity[:, 0, 2]).all()
    assert found.velocity[:, 0, :2].tolist() == [[2.0, 0.0], [1.0, 1.0]]


def test_a_compressed_dump_is_read_as_its_text_and_refused_where_it_is_cut(tmp_path):
    path = dump(tmp_path, "id element z vz", FRAMES)
    packed = gzip.compress(path.read_bytes())
    compressed = tmp_path / "mine.dump.gz"
    compressed.write_bytes(packed)
    assert is_text_dump(compressed)
    text, read = (load_dump(file, beads=3, timestep=0.5, deck=deck()) for file in (path, compressed))
    np.testing.assert_array_equal(read.displacement, text.displacement)
    np.testing.assert_array_equal(read.velocity, text.velocity)
    compressed.write_bytes(packed[:-12])
    with pytest.raises(InputError, match="cut or damaged"):
        load_dump(compressed, beads=3, timestep=0.5, deck=deck())


def test_a_binary_dump_is_no_table_and_is_named(tmp_path):
    (tmp_path / "dump.bin").write_bytes(MAGIC + bytes(100))
    assert not is_text_dump(tmp_path / "dump.bin")
    with pytest.raises(InputError, match=r"is a binary dump of LAMMPS; write it as text"):
        table.load(tmp_path / "dump.bin")


@pytest.mark.parametrize(
    ("columns", "atoms", "says"),
    [
        ("id element x vx", "7,2,5", "id, and z or vz, are needed"),
        ("id element z vz", "70-72", "has none of the atoms of in.mine that are beads"),
    ],
)
def test_a_dump_of_another_axis_or_other_atoms_is_refused(columns, atoms, says, tmp_path):
    with pytest.raises(InputError, match=says):
        load_dump(dump(tmp_path, columns, FRAMES), 3, 0.5, deck(atoms=(atoms,)))


def test_atoms_that_cross_a_periodic_boundary_go_on(tmp_path):
    rows = {step: [f"7 {z:g}", "2 4", "5 6"] for step, z in enumerate([1.0, 7.5, 5.0, 2.5, 0.5, 7.0])}
    path = dump(tmp_path, "id z", rows)
    path.write_text(path.read_text().replace("ff ff ff", "ff ff pp"))
    found = load_dump(path, beads=3, timestep=0.5, deck=deck())
    assert found.displacement[:, 0, 0].tolist() == [0.0, -1.5, -4.0, -6.5, -8.5, -10.0]
    assert not np.any(found.displacement[:, 0, 1:])


# --- of beads as our decks number them --------------------------------------------------------------------------------

COLUMNS = "id type x vx"
ROWS = ["3 1 4.5 0", "1 1 4 1", "2 1 8.25 -2", "4 1 8 0.125"]
MOVED = ["3 1 4.25 0", "1 1 4 1", "2 1 8.75 -2", "4 1 8 0.125"]
OTHER = [*ROWS[:3], "5 1 8 0.125"]


def test_beads_are_placed_by_their_numbers_and_displaced_from_the_first_frame(tmp_path):
    found = load_dump(dump(tmp_path, COLUMNS, {0: ROWS, 20: MOVED}), beads=2, timestep=0.5)
    assert found.time.tolist() == [0.0, 10.0]
    assert (found.chains.tolist(), found.beads.tolist()) == ([1, 2], [1, 2])
    assert found.displacement[1].tolist() == [[0.0, 0.5], [-0.25, 0.0]]
    assert found.velocity[0].tolist() == [[1.0, -2.0], [0.0, 0.125]]


def test_the_time_that_a_frame_tells_counts(tmp_path):
    path = dump(tmp_path, COLUMNS, {0: ROWS, 7: ROWS})
    text = path.read_text().replace("ITEM: TIMESTEP\n7", "ITEM: TIME\n2.5\nITEM: TIMESTEP\n7")
    path.write_text("ITEM: UNITS\nlj\nITEM: TIME\n0.0\n" + text)
    assert load_dump(path, beads=2, timestep=9.0).time.tolist() == [0.0, 2.5]


@pytest.mark.parametrize("left", range(1, 12))
def test_a_frame_that_is_cut_off_is_left_out(tmp_path, left):
    path = dump(tmp_path, COLUMNS, dict.fromkeys(range(3), ROWS))
    path.write_text(path.read_text()[:-left])
    assert load_dump(path, beads=2, timestep=1.0).time.tolist() == [0.0, 1.0]


@pytest.mark.parametrize(
    ("columns", "frames", "says"),
    [
        (COLUMNS, {0: ROWS}, "holds 1 complete frames"),
        ("type x vx fx", {0: ROWS, 1: ROWS}, "its columns are type x vx fx"),
        (COLUMNS, {0: ROWS, 1: OTHER}, "not the same atoms"),
        (COLUMNS, {0: OTHER, 1: OTHER}, "are not the same beads of chains of 2"),
        (COLUMNS, {1: ROWS, 0: ROWS}, "times are not ascending"),
        (COLUMNS, {0: ROWS, 1: [*ROWS[:3], "4 1 nan 0.125"]}, "what is not a finite number"),
        (COLUMNS, {0: ROWS, 1: [*ROWS[:3], "4 1 many 0.125"]}, "is no text dump"),
    ],
)
def test_what_is_no_dump_of_the_beads_is_one_line(columns, frames, says, tmp_path):
    with pytest.raises(InputError, match=says) as raised:
        load_dump(dump(tmp_path, columns, frames), beads=2, timestep=1.0)
    assert "\n" not in str(raised.value)
