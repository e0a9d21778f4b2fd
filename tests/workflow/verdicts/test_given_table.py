"""What is to be said of a user's table beside a run, by times made by hand."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from small_problems import problem, written_down

from workflow.verdicts import validate_table

OWN = written_down(problem(), lambda t: (0.0 * t, 0.0 * t))  # 101 frames 0.1 apart


def at(*times):
    return replace(OWN[: len(times)], time=np.array(times))


@pytest.mark.parametrize(
    ("times", "frames"),
    [((0.0, 0.3, 10.0), True), ((0.0, 0.3 + 1e-11), True), ((0.0, 0.3001), False), ((10.1,), False)],
)
def test_times_are_those_of_frames_to_rounding(times, frames):
    assert validate_table.are_frames(at(*times), OWN) is frames


@pytest.mark.parametrize(("last", "said"), [(0.11, False), (0.09, True)])
def test_a_table_that_ends_within_a_hundredth_of_the_run_is_asked_about(last, said):
    found = list(validate_table.remarks(Path("t.csv"), at(0.0, last), OWN))
    assert found == (["t.csv ends at 0.009 of the run: is it in other units? (see --units)"] if said else [])
