"""What arrives at the far end, against what is known of it."""

import numpy as np
import pytest
from small_problems import problem, written_down

from analysis.figures.searched import front
from analysis.gauges.far_end import FarEnd, _top
from lammps_inputs import library


def test_the_top_of_samples_lies_between_them():
    time = np.arange(0.0, 3.0, 0.1)
    when, most = _top(time, 5.0 - (time - 1.234) ** 2)
    assert when == pytest.approx(1.234, abs=1e-12)
    assert most == pytest.approx(5.0, abs=1e-12)


@pytest.mark.parametrize(("hit", "velocity", "last"), [(1, 1.0, 20), (20, -1.0, 1)])
def test_energy_that_passes_the_last_tenth_is_counted_and_timed(hit, velocity, last):
    """The last bead of 20 moves at 1 - (t - 5)**2 / 100, the third from there faster; the kick has the energy 1/2."""
    small = problem(beads=20, chains=1, kicks=((1, hit, velocity),))

    def motion(time):
        velocity = np.zeros((time.shape[0], 1, 20))
        velocity[:, :, last - 1] = 1.0 - (time[..., 0] - 5.0) ** 2 / 100.0
        velocity[:, :, 17 if last == 20 else 2] = 3.0
        return np.zeros_like(velocity), velocity

    end = FarEnd(small)
    trajectory = written_down(small, motion)
    for part in (trajectory[:37], trajectory[37:]):
        end.add(part)
    found = end.result()
    assert found["transmitted_energy"] == pytest.approx(1.0, abs=1e-9)
    assert found["delay"] == pytest.approx(5.0, abs=1e-9)
    assert "wall_force" not in found


@pytest.mark.parametrize(("side", "velocity", "bead"), [("right", 1.0, 20), ("left", -1.0, 1)])
def test_the_far_wall_is_the_one_that_the_blow_goes_to_and_feels_all_chains(side, velocity, bead):
    """Chain 1 presses on a wall of strength 1 by (1 - (t - 5)**2 / 50) ** (2 / 3), chain 2 an eighth as hard."""
    plain = {"name": "test", "chains": 2, "beads": 20, "walls": {side: "bead"}, "duration": 10.0}
    kick = {"bead": 21 - bead, "velocity": velocity}
    small = library.from_plain({**plain, "kick": kick}, "test").problem()
    strength = float(np.max(small.walls[0].law.strength))

    def motion(time):
        pressed = np.zeros((time.shape[0], 2, 20))
        force = np.maximum(1.0 - (time[..., 0] - 5.0) ** 2 / 50.0, 0.0)
        pressed[:, :, bead - 1] = (force * np.array([1.0, 0.125])) ** (2.0 / 3.0)
        return velocity * pressed, np.zeros_like(pressed)

    end = FarEnd(small)
    end.add(written_down(small, motion))
    found = end.result()
    assert found["wall_force"] == pytest.approx(1.125 * strength, rel=1e-9)
    assert found["wall_force_chain"] == pytest.approx(strength, rel=1e-9)
    assert found["delay"] == pytest.approx(5.0, abs=1e-9)


def test_a_front_is_what_nothing_else_betters_in_both():
    one, other = np.array([1.0, 2.0, 2.0, 3.0, 4.0]), np.array([5.0, 6.0, 3.0, 3.0, 1.0])
    assert front(one, other).tolist() == [0, 2, 4]
