"""The settings that a scene has, what is run for them, and how errors are told."""

import math
from dataclasses import replace

import numpy as np
import pytest
from processes import HANGS
from small_problems import problem, written_down

from analysis import trajectory
from analysis.files import recording
from lammps_inputs import InputError, library
from lammps_inputs.limits.rates import stability_bound
from workflow.engines.lammps import mpi
from workflow.engines.reference import engine
from workflow.errors import RunError
from workflow.studies.trade import settings as choices
from workflow.studies.trade.study import intervals
from workflow.studies.trade.truth import deviation, make_truth


@pytest.fixture(scope="module")
def truth(tmp_path_factory):
    return make_truth(problem(beads=100, frames=1000), tmp_path_factory.mktemp("truth"), seconds=HANGS)


def curve(settings, name):
    return [setting for setting in settings if setting.curve == name]


@pytest.mark.parametrize("every", [0.01, 0.1, 0.4, 3.0])
@pytest.mark.parametrize("kappa", [0.1, 100.0])
def test_steps_are_stable_and_frames_and_ends_are_the_scenes(every, kappa):
    own = problem(kappa=kappa, timestep=every / 300, steps_per_frame=300, frames=400)
    longest = choices.COARSEST * stability_bound(own.system)
    settings = choices.settings(own)
    for name in ("LAMMPS verlet", "LAMMPS suzuki4", "reference blanes-moan"):
        several = curve(settings, name)
        assert len(several) >= 3
        for setting in several:
            each = setting.what.problem
            cycle = 5 if "suzuki" in name else 1
            assert each.steps_per_frame % cycle == 0
            assert each.timestep * cycle <= longest * (1.0 + 1e-9)
            stride = each.every / own.every
            assert stride == pytest.approx(round(stride))
            assert each.duration <= own.duration * (1.0 + 1e-9)
            assert each.duration > own.duration - each.every
        effort = [setting.effort for setting in several]
        assert effort == sorted(effort)


def test_the_scenes_own_step_is_among_those_of_lammps():
    own = problem(timestep=0.1 / 7, steps_per_frame=7)
    assert own.timestep in [setting.value for setting in curve(choices.settings(own), "LAMMPS verlet")]


def test_rigid_beads_are_measured_where_there_is_a_gap():
    assert curve(choices.settings(problem(gap=0.5)), choices.RIGID)
    assert not curve(choices.settings(problem()), choices.RIGID)


@pytest.mark.parametrize(
    ("changes", "there"),
    [
        ({"beads": 100}, True),
        ({"beads": 60}, False),
        ({"beads": 100, "recorded": (1, 5)}, False),
        ({"beads": 100, "kicks": ((1, 70, 1.0),)}, False),
        ({"beads": 100, "kicks": ((1, 2, -1.0),)}, False),
    ],
)
def test_windows_of_lammps_are_measured_where_a_scene_may_have_one(changes, there):
    assert bool(curve(choices.settings(problem(**changes)), "LAMMPS window")) is there


OTHERS = {
    "plain": {},
    "dashpots": {"damping": {"contact": 0.01}},
    "drag": {"damping": {"beads": 0.01}},
    "load": {"precompression": {"force": 1.0}},
    "foundation": {"foundation": {"stiffness": 0.1}},
    "wall": {"walls": {"right": "flat"}},
    "push": {"push": {"peak": 1.0, "duration": 1.0, "shape": "half-sine"}},
    "exponent": {"contact": {"exponent": 1.25}},
    "masses": {"kinds": {"a": {}, "b": {"mass": 0.5}}, "pattern": ["a", "b"]},
}


@pytest.mark.parametrize("name", OTHERS)
def test_schemes_and_windows_are_measured_where_a_scene_may_have_them(name):
    plain = {"name": "a", "beads": 100, "kick": {"velocity": 1.0}, "duration": 10.0, **OTHERS[name]}
    settings = choices.settings(library.from_plain(plain, "a").problem())
    for curve_name, choice in (("LAMMPS suzuki4", {"scheme": "suzuki4"}), ("LAMMPS window", {"window": 64})):
        try:
            library.from_plain({**plain, **choice}, "a")
        except InputError:
            assert not curve(settings, curve_name)
        else:
            assert curve(settings, curve_name)


def test_more_ranks_than_cores_are_not_tried():
    ranks = [setting.value for setting in curve(choices.settings(problem()), "LAMMPS ranks")]
    assert all(1 <= count <= mpi.cores() for count in ranks)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["LAMMPS window", "reference window"])
def test_a_window_has_the_errors_of_all_rows_near_the_front(name, truth, tmp_path):
    several = curve(choices.settings(truth.problem), name)
    found = [truth.errors(choices.run(setting.what, tmp_path).blocks()) for setting in several]
    assert len(found) >= 2
    # bit for bit at this coupling; the arrivals of beads that had left the window before are not among the first
    for each in found[:-1]:
        assert each["amplitude"] == pytest.approx(found[-1]["amplitude"], abs=1e-9)
        assert each["velocity"] <= found[-1]["velocity"] * (1.0 + 1e-9)


def test_a_reference_window_too_narrow_is_left_out_with_its_reason(truth, tmp_path):
    job = curve(choices.settings(truth.problem), "reference window")[0].what
    with pytest.raises(RunError, match="too narrow"):
        choices.run(replace(job, window=3), tmp_path)


@pytest.mark.slow
def test_rigid_beads_are_far_from_hertz_beads(tmp_path):
    own = problem(gap=2.874, beads=30, frames=800)
    truth = make_truth(own, tmp_path, seconds=HANGS)
    done = choices.run(curve(choices.settings(own), choices.RIGID)[0].what, tmp_path)
    assert truth.errors(done.blocks())["velocity"] > 0.1
    assert math.isnan(done.costs["forces"])


def test_the_reference_is_refined_until_its_uncertainty_is_small_or_the_time_is_up(tmp_path):
    fine = make_truth(problem(), tmp_path, seconds=HANGS).uncertainty
    assert fine.velocity <= 1e-10
    coarse = make_truth(problem(), tmp_path, seconds=0.0).uncertainty
    assert coarse.velocity > fine.velocity
    assert coarse.steps_per_frame < fine.steps_per_frame


# --- errors -----------------------------------------------------------------------------------------------------------


def passing(own, height=1.0, late=0.0, missing=None):
    """A pulse of a made-up shape that passes each bead at the time of its number."""

    def motion(time):
        bead = own.recorded_beads[np.newaxis, np.newaxis, :]
        s = time - bead - late
        v = height * np.exp(-(s**2))
        v[:, :, [] if missing is None else [missing - 1]] *= 1e-9
        return np.cumsum(v, axis=0) * own.every, v

    return written_down(own, motion)


def test_the_same_frames_have_no_error():
    own = problem(chains=1, kappa=0.0, frames=120)
    assert deviation([passing(own)], [passing(own)]) == {"velocity": 0.0, "amplitude": 0.0, "arrival": 0.0}


def test_a_passage_that_is_not_there_is_an_error():
    own = problem(chains=1, kappa=0.0, frames=120)
    error = deviation([passing(own, missing=4)], [passing(own)])
    assert error["arrival"] == math.inf
    assert error["amplitude"] == pytest.approx(1.0, abs=0.05)


def test_numbers_that_are_none_are_an_infinite_error():
    own = problem(chains=1, kappa=0.0, frames=120)
    bad = passing(own)
    bad.velocity[50:, 0, 3] = np.nan
    assert set(deviation([bad], [passing(own)]).values()) == {math.inf}


# --- frames -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("steps", [1, 7, 10])
def test_the_longer_the_time_between_frames_the_less_is_read_from_them(steps, tmp_path):
    own = problem(timestep=0.1 / steps, steps_per_frame=steps, beads=4)
    found = intervals(own, tmp_path)
    every = [one.every for one in found]
    assert every == sorted(every, reverse=True)
    assert pytest.approx(own.every) in every
    assert found[0].arrival_error > found[-1].arrival_error
    # 24 bytes a bead and frame
    assert [one.bytes * one.every for one in found] == pytest.approx([24.0 * 8 * own.duration] * len(found), rel=0.2)


def test_frames_of_the_reference_are_written_and_read_without_a_change(tmp_path):
    own = problem()
    done = choices.run(curve(choices.settings(own), "reference blanes-moan")[2].what, tmp_path)
    again = trajectory.joined(engine.blocks(done.job.problem, steps_per_frame=done.job.problem.steps_per_frame))
    np.testing.assert_array_equal(
        trajectory.joined(recording.blocks([done.dump], done.job.problem)).velocity, again.velocity
    )
