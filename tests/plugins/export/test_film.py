"""Films have as many pictures as they are asked for, and show beads, springs and the time."""

import numpy as np
import pytest

import granchain
from analysis.figures.spacetime import space_time_meter
from workflow.plugins.export import film
from workflow.plugins.export.request import ExportRequest, Options


@pytest.mark.slow
def test_films_have_the_pictures_and_the_duration_that_are_asked_for(run_of, tmp_path):
    ffmpeg = pytest.importorskip("imageio_ffmpeg", reason="imageio-ffmpeg is not installed (granchain[export])")
    from PIL import Image

    asked = {"seconds": 1.0, "rate": 10, "pixels": 480}
    [film, gif] = granchain.export(run_of("coupled"), "mp4,gif", tmp_path, **asked)
    assert ffmpeg.count_frames_and_secs(str(film)) == (10, pytest.approx(1.0, abs=0.05))
    assert next(ffmpeg.read_frames(str(film)))["size"][0] == 480
    with Image.open(gif) as picture:
        assert (picture.n_frames, picture.size[0], picture.info["duration"]) == (10, 480, 100)


def pictures(run, **options):
    request = ExportRequest(run.directory.path, Options(pixels=480, **options), is_run=True)
    return list(film._pictures(request, "film"))


def test_a_film_of_a_short_run_has_no_picture_twice(run_of):
    run = run_of("short")
    assert len(pictures(run, seconds=100.0, rate=10)) == run.trajectory.frames


@pytest.mark.slow
@pytest.mark.parametrize(("bead", "velocity", "ends"), [(1, 1.0, (0, 40)), (60, -1.0, (20, 60))])
def test_the_beads_in_sight_begin_at_the_kicked_end_and_follow_the_pulse_away_from_it(bead, velocity, ends, tmp_path):
    scene = {"name": "long", "beads": 60, "kick": {"bead": bead, "velocity": velocity}, "duration": 75.0}
    run = granchain.run(scene | {"output": {"every": 1.5}}, tmp_path / "run", engine="reference")
    trajectory, problem = run.trajectory, run.directory.problem
    stage = film._Stage(problem, space_time_meter(problem).read([trajectory]), np.ones((1, 60)), 480)
    sights = [stage._in_sight(trajectory[frame : frame + 1]) for frame in range(trajectory.frames)]
    assert sights[0] == ends
    assert sights[-1] == ((20, 60) if velocity > 0.0 else (0, 40))
