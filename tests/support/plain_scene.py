"""A small coupled scene that tests of ingredients change, and what every ingredient must do in a run that is cut."""

from pathlib import Path
from typing import Any

import lammps_here
import numpy as np
from kill_many import frames

from lammps_inputs import Scene, library
from workflow.runs.resume import resume
from workflow.runs.run import run
from workflow.runs.run_directory import RunDirectory

BEADS = 12


def scene(**changes: Any) -> Scene:
    """Two chains, kappa = 0.1, bead 1 of chain 1 hit, frames of 0.5; with other keys, and without those of None."""
    plain = {
        "name": "test",
        "chains": 2,
        "beads": BEADS,
        "coupling": {"stiffness": 0.1},
        "kick": {"velocity": 1.0},
        "duration": 20.0,
        "output": {"every": 0.5},
    }
    return library.from_plain({key: value for key, value in {**plain, **changes}.items() if value is not None}, "test")


def one_chain(**changes: Any) -> Scene:
    """One chain alone, otherwise as above."""
    return scene(**{"chains": 1, "coupling": None, **changes})


def goes_on_bit_for_bit(case: Scene, folder: Path, *, after: int = 2000) -> None:
    """Assert that a run that is interrupted after some steps ends with the frames of one that is not."""
    run(case, folder / "whole", check=False)
    run(case, folder / "cut", check=False, lammps=lammps_here.interrupted_after(after))
    assert RunDirectory(folder / "cut").job.outcome == "interrupted"
    assert resume(folder / "cut", check=False).outcome == "done"
    assert RunDirectory(folder / "cut").job.resumed[0].from_step > 0
    np.testing.assert_array_equal(frames(folder / "cut"), frames(folder / "whole"))
