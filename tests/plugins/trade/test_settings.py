"""The settings that a scene has, what is run for them, and how errors are told."""

import math
from itertools import pairwise

import numpy as np
import pytest
from processes import HANGS
from small_problems import problem, written_down

from analysis.tracking.peaks import find_peaks
from lammps_inputs import InputError, library
from lammps_inputs.limits.rates import stability_bound
from workflow.engines.lammps import mpi
from workflow.plugins.trade import settings as choices
from workflow.plugins.trade.settings import QUANTITIES, Truth, _interval, intervals, make_truth
from workflow.runs.frames import write_frames

pytestmark = pytest.mark.usefixtures("lammps_here")


def of_method(settings, name):
    return [setting for setting in settings if setting.method == name]


@pytest.mark.parametrize(("every", "kappa"), [(0.01, 0.1), (0.4, 100.0), (3.0, 0.1)])
def test_steps_are_stable_and_frames_and_ends_are_the_scenes(every, kappa):
    own = problem(kappa=kappa, timestep=every / 300, steps_per_frame=300, frames=400)
    longest = choices.COARSEST * stability_bound(own.system)
    settings = choices.settings(own)
    for name in ("LAMMPS verlet", "LAMMPS suzuki4", "reference blanes-moan"):
        several = of_method(settings, name)
        assert len(several) >= 3
        for setting in several:
            each = setting.problem
            cycle = 5 if "suzuki" in name else 1
            assert each.steps_per_frame % cycle == 0
            assert each.timestep * cycle <= longest * (1.0 + 1e-9)
            stride = each.every / own.every
            assert stride == pytest.approx(round(stride))
            assert each.duration <= own.duration * (1.0 + 1e-9)
            assert each.duration > own.duration - each.every
        effort = [setting.effort for setting in several]
        assert effort == sorted(effort)


def test_the_step_of_the_scene_is_among_those_of_lammps_and_no_more_ranks_than_cores():
    own = problem(timestep=0.1 / 7, steps_per_frame=7)
    assert own.timestep in [setting.value for setting in of_method(choices.settings(own), "LAMMPS verlet")]
    ranks = [setting.value for setting in of_method(choices.settings(problem()), "LAMMPS ranks")]
    assert all(1 <= count <= mpi.cores() for count in ranks)


OTHERS = {
    "plain": {},
    "dashpots": {"damping": {"contact": 0.01}},
    "foundation": {"foundation": {"stiffness": 0.1}},
    "push": {"push": {"peak": 1.0, "duration": 1.0, "shape": "half-sine"}},
    "masses": {"kinds": {"a": {}, "b": {"mass": 0.5}}, "pattern": ["a", "b"]},
}


@pytest.mark.parametrize("name", OTHERS)
def test_schemes_and_windows_are_measured_where_a_scene_may_have_them(name):
    plain = {"name": "a", "beads": 100, "kick": {"velocity": 1.0}, "duration": 10.0, **OTHERS[name]}
    settings = choices.settings(library.from_plain(plain, "a").problem())
    for method, choice in (("LAMMPS suzuki4", {"scheme": "suzuki4"}), ("LAMMPS window", {"window": 64})):
        try:
            library.from_plain({**plain, **choice}, "a")
        except InputError:
            assert not of_method(settings, method)
        else:
            assert of_method(settings, method)


def test_what_lammps_cannot_express_is_measured_by_the_reference_alone():
    contact = {"yield": {"law": "walton-braun", "restitution": 0.8}}
    plain = {"name": "a", "beads": 9, "contact": contact, "kick": {"velocity": 0.1}, "duration": 1.0}
    assert {one.method for one in choices.settings(library.from_plain(plain, "a").problem())} == {choices.REFERENCE}


def test_the_reference_is_refined_until_its_uncertainty_is_small_or_the_time_is_up(tmp_path):
    fine = make_truth(problem(), tmp_path, seconds=HANGS).uncertainty
    assert fine.velocity <= 1e-10
    coarse = make_truth(problem(), tmp_path, seconds=0.0).uncertainty
    assert coarse.velocity > fine.velocity
    assert coarse.steps_per_frame < fine.steps_per_frame


# --- errors -----------------------------------------------------------------------------------------------------------


def passing(own):
    """A pulse of a made-up shape that passes each bead at the time of its number."""

    def motion(time):
        bead = own.rows.numbers[np.newaxis, np.newaxis, :]
        v = np.exp(-((time - bead) ** 2))
        return np.cumsum(v, axis=0) * own.every, v

    return written_down(own, motion)


def test_the_same_frames_have_no_error_and_numbers_that_are_none_an_infinite_one(tmp_path):
    own = problem(chains=1, kappa=0.0, frames=120)
    write_frames(tmp_path / "reference.bin", own, [passing(own)])
    truth = Truth(own, tmp_path / "reference.bin", None, 0.0)
    assert truth.errors([passing(own)]) == pytest.approx(dict.fromkeys(QUANTITIES, 0.0), abs=1e-12)
    bad = passing(own)
    bad.velocity[50:, 0, 3] = np.nan
    assert truth.errors([bad])["velocity"] == math.inf


# --- frames -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("every", [0.02, 0.1, 0.7])
def test_the_longer_the_time_between_frames_the_less_is_read_from_them(every):
    own = problem(timestep=every, steps_per_frame=1, beads=4, frames=round(40.0 / every))
    found = intervals(own)
    assert all(one.every == pytest.approx(2.0 * other.every) for one, other in pairwise(found))
    assert pytest.approx(own.every) in [one.every for one in found]
    assert found[0].arrival_error > found[-1].arrival_error
    # 24 bytes a bead and frame
    size = 24e-6 * 8 * own.duration
    assert [one.megabytes * one.every for one in found] == pytest.approx([size] * len(found), rel=0.2)


def test_a_passage_that_is_not_there_is_an_infinite_error():
    own = problem(chains=1, kappa=0.0, frames=120)
    exact = find_peaks([passing(own)])
    found = _interval(own, exact.where(exact.bead != 4), exact)
    assert (found.amplitude_error, found.arrival_error) == (math.inf, math.inf)
