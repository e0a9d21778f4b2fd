"""Long tables of a force in LAMMPS: the impulse over each step is that of the table, at any distances of the points."""

import re

import numpy as np
import pytest
from plain_scene import scene

from lammps_inputs import file_names
from lammps_inputs.decks import scene_files
from lammps_inputs.laws import in_time, table_lines
from workflow.engines.reference import engine
from workflow.engines.reference.schemes import VERLET
from workflow.runs.run import run

RNG = np.random.default_rng(7)
TIMES = {
    "equal": np.linspace(0.0, 3.0, 101),
    "equal to five digits": np.round(np.linspace(0.0, 3.0, 1001), 5),
    "later than the start": np.linspace(0.7, 3.0, 60),
    "random": np.sort(RNG.uniform(0.0, 3.0, 300)),
    "jumps": np.sort(np.concatenate([np.linspace(0.0, 3.0, 60), np.linspace(0.0, 3.0, 60)[1:-1] + 1e-9])),
    "decades": np.geomspace(1e-6, 3.0, 500),
}


def table(times):
    value = RNG.uniform(-1.0, 1.0, len(times))
    value[[0, -1]] = 0.0
    return in_time.of_force(times, value)


@pytest.mark.parametrize("times", TIMES.values(), ids=TIMES)
def test_the_search_ends_at_the_last_point_before_any_time(times):
    width, before, stages = table_lines._cells(times)
    asked = np.concatenate([times, np.nextafter(times[1:], 0.0), RNG.uniform(times[0], times[-1], 10_000)])
    padded = np.concatenate([times, np.full(2**stages, np.inf)])
    point = before[np.floor((asked - times[0]) / width + 0.5).astype(int)]
    for stage in range(1, stages + 1):
        half = 2 ** (stages - stage)
        point = point + half * (asked >= padded[point + half])
    np.testing.assert_array_equal(point, np.searchsorted(times, asked, side="right") - 1)


@pytest.mark.slow
@pytest.mark.usefixtures("lammps_here")
@pytest.mark.parametrize("times", TIMES.values(), ids=TIMES)
def test_lammps_moves_beads_as_its_scheme_does_with_the_impulse_of_the_table(times, tmp_path):
    points = np.stack([times, table(times).value], axis=1).tolist()
    case = scene(chains=1, coupling=None, kick=None, push={"table": points}, beads=4, timestep=0.01, duration=4.0)
    problem = case.problem()
    done = run(case, tmp_path / "run", check=False)
    exact = engine.run(problem, scheme=VERLET, steps_per_frame=problem.steps_per_frame)
    np.testing.assert_allclose(done.trajectory.velocity, exact.velocity, rtol=0.0, atol=1e-12)
    assert (done.directory.path / file_names.TABLES).is_file()


def test_the_deck_of_a_long_table_is_as_long_as_that_of_any_other():
    decks = []
    for count in (100, 10_000):
        points = [[0.01 * k, float(0 < k < count - 1)] for k in range(count)]
        files = scene_files.render(scene(chains=1, coupling=None, kick=None, push={"table": points}, timestep=0.01))
        decks.append(re.sub(r"[0-9.e+-]+", "0", files[file_names.DECK]))
    assert decks[0] == decks[1]
