"""Text dumps of LAMMPS: read as they are, and refused in one line where they are not the beads of a scene."""

import numpy as np
import pytest

from analysis.files import table
from lammps_inputs import InputError

FRAME = "ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ATOMS\n4\nITEM: BOX BOUNDS ff ff ff\n0 1\n0 1\n0 1\n{head}\n{rows}"
HEAD = "ITEM: ATOMS id type x vx"
ROWS = "3 1 4.5 0\n1 1 4 1\n2 1 8.25 -2\n4 1 8 0.125\n"


def dump(tmp_path, *frames):
    path = tmp_path / "mine.lammpstrj"
    path.write_text("".join(frames))
    return path


def frame(step, head=HEAD, rows=ROWS):
    return FRAME.format(step=step, head=head, rows=rows)


def moved(rows=ROWS):
    return rows.replace("8.25", "8.75").replace("4.5", "4.25")


def test_beads_are_placed_by_their_numbers_and_displaced_from_the_first_frame(tmp_path):
    found = table.load_dump(dump(tmp_path, frame(0), frame(20, rows=moved())), beads=2, timestep=0.5)
    assert found.time.tolist() == [0.0, 10.0]
    assert (found.chains.tolist(), found.beads.tolist()) == ([1, 2], [1, 2])
    assert found.displacement[1].tolist() == [[0.0, 0.5], [-0.25, 0.0]]
    assert found.velocity[0].tolist() == [[1.0, -2.0], [0.0, 0.125]]


def test_the_time_that_a_frame_tells_counts(tmp_path):
    timed = [f"ITEM: UNITS\nlj\nITEM: TIME\n{time}\n{frame(step)}" for step, time in ((0, 0.0), (7, 2.5))]
    assert table.load_dump(dump(tmp_path, *timed), beads=2, timestep=9.0).time.tolist() == [0.0, 2.5]


@pytest.mark.parametrize("left", range(1, 12))
def test_a_frame_that_is_cut_off_is_left_out(tmp_path, left):
    text = frame(0) + frame(1) + frame(2)
    found = table.load_dump(dump(tmp_path, text[:-left]), beads=2, timestep=1.0)
    assert found.time.tolist() == [0.0, 1.0]


@pytest.mark.parametrize(
    ("frames", "says"),
    [
        ([frame(0)], "holds 1 complete frames"),
        ([frame(0), frame(1, head="ITEM: ATOMS type x vx fx")], "its columns are type x vx fx"),
        ([frame(0), frame(1, rows=ROWS.replace("4 1 8 ", "5 1 8 "))], "not the same atoms"),
        ([frame(0, rows=ROWS.replace("4 1 8 ", "5 1 8 "))] * 2, "are not the same beads of chains of 2"),
        ([frame(1), frame(0)], "times are not ascending"),
        ([frame(0), frame(1, rows=ROWS.replace("8.25", "nan"))], "what is not a finite number"),
        ([frame(0), frame(1, rows=ROWS.replace("8.25", "many"))], "is no text dump"),
    ],
)
def test_what_is_no_dump_of_the_beads_is_one_line(frames, says, tmp_path):
    with pytest.raises(InputError, match=says) as raised:
        table.load_dump(dump(tmp_path, *frames), beads=2, timestep=1.0)
    assert "\n" not in str(raised.value)


def test_only_what_begins_like_one_is_taken_for_one(tmp_path):
    assert table.is_text_dump(dump(tmp_path, frame(0)))
    assert not table.is_text_dump(dump(tmp_path, "time,chain,bead\n"))
    assert np.all([not table.is_text_dump(path) for path in (tmp_path, tmp_path / "nothing")])
