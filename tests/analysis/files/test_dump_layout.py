"""How far a file of frames has come, from its headers."""

import numpy as np
import pytest
from small_problems import problem

from analysis.files.dump_layout import last_step
from analysis.files.recording import Writer


@pytest.mark.parametrize(("cut", "step"), [(0, 30), (1, 20), (16, 20)])
def test_the_last_whole_frame_counts_of_a_file_that_ends_within_one(cut, step, tmp_path):
    path, still = tmp_path / "chains.dump.bin", np.zeros((2, 8))
    with Writer(path, problem()) as writer:
        for number in (0, 10, 20, 30):
            writer.append(number, still, still)
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) - cut])
    assert last_step(path) == step


def test_where_there_is_no_frame_there_is_no_step(tmp_path):
    (tmp_path / "empty").write_bytes(b"")
    assert last_step(tmp_path / "empty") is None
    assert last_step(tmp_path / "none") is None
