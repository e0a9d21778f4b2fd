"""Frames of a run in one file or several, some of them or all, and how far a file has come."""

import numpy as np
import pytest
from stock_lammps import scene

from analysis.files.dump_layout import last_step
from analysis.files.recording import Writer, blocks
from analysis.trajectory import joined
from lammps_inputs import InputError

PROBLEM = scene(chains=2, beads=3, duration=2.0, every=0.1).problem()


def written(directory, *parts):
    """Files of frames; frame k is displaced by k / 64 and moves at k."""
    paths = []
    for number, frames in enumerate(parts, 1):
        paths.append(directory / f"{number}.bin")
        with Writer(paths[-1], PROBLEM) as writer:
            for frame in frames:
                writer.append(frame * PROBLEM.steps_per_frame, np.full((2, 3), frame / 64), np.full((2, 3), frame))
    return paths


@pytest.mark.parametrize("stride", [1, 3, 7])
@pytest.mark.parametrize(
    "parts",
    [
        [range(21)],
        [range(10), range(10, 21)],
        [range(11), range(11, 21)],
        [range(12), range(9, 21)],  # computed again, and read from the first
        [range(4), range(4, 5), range(5, 21)],
    ],
    ids=["one file", "two of ten", "two of eleven", "overlapping", "three"],
)
def test_every_stride_th_frame_of_the_run_is_read_wherever_files_end(parts, stride, tmp_path):
    found = joined(blocks(written(tmp_path, *parts), PROBLEM, stride))
    wanted = np.arange(0, 21, stride)
    np.testing.assert_array_equal(found.velocity[:, 1, 2], wanted)
    np.testing.assert_array_equal(found.displacement[:, 0, 0], wanted / 64)
    np.testing.assert_allclose(found.time, 0.1 * wanted, rtol=1e-14)


@pytest.mark.parametrize(("cut", "step"), [(0, 30), (1, 20), (16, 20)])
def test_the_last_whole_frame_counts_of_a_file_that_ends_within_one(cut, step, tmp_path):
    path, still = tmp_path / "chains.dump.bin", np.zeros((2, 3))
    with Writer(path, PROBLEM) as writer:
        for number in (0, 10, 20, 30):
            writer.append(number, still, still)
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) - cut])
    assert last_step(path) == step
    assert last_step(tmp_path / "none") is None


def test_steps_that_go_back_and_arrays_of_another_shape_are_refused(tmp_path):
    (path,) = written(tmp_path, range(3))
    path.write_bytes(path.read_bytes() * 2)
    with pytest.raises(InputError, match=r"1\.bin: its steps go back, so it is not one run"):
        joined(blocks([path], PROBLEM))
    with (
        Writer(tmp_path / "2.bin", PROBLEM) as writer,
        pytest.raises(ValueError, match=r"array of shape \(3, 2\); \[chain, recorded bead\] is \(2, 3\)"),
    ):
        writer.append(0, np.zeros((3, 2)), np.zeros((2, 3)))
