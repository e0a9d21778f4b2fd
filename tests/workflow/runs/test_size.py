"""The size of a run that is printed before it is that of the run; the scene may set the limit of its frames."""

import pytest

from lammps_inputs import file_names, library
from workflow.runs.engines import engine_called
from workflow.runs.run import run
from workflow.runs.size import size_of

pytestmark = pytest.mark.usefixtures("lammps_here")

SCENE = {"name": "a", "beads": 40, "kick": {"velocity": 1}, "duration": 20, "output": {"beads": [3, 7], "every": 0.1}}


def test_steps_frames_and_bytes_are_those_of_the_run(tmp_path):
    scene = library.from_plain(SCENE, "a")
    found, size = run(scene, tmp_path / "a", check=False).directory, size_of(scene.problem(), engine_called("lammps"))
    assert size.steps == found.job.steps
    assert size.frames == len(found.trajectory.time)
    assert size.bytes == pytest.approx((found.path / file_names.DUMP).stat().st_size, rel=0.01)
