"""Long tables of a force in LAMMPS: the impulse over each step is that of the table, at any distances of the points."""

import numpy as np
import pytest
from plain_scene import one_chain

from lammps_inputs import file_names
from lammps_inputs.laws import in_time
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


@pytest.mark.usefixtures("lammps_here")
@pytest.mark.parametrize(
    "name", ["decades", *(pytest.param(name, marks=pytest.mark.slow) for name in list(TIMES)[:-1])]
)
def test_lammps_moves_beads_as_its_scheme_does_with_the_impulse_of_the_table(name, tmp_path):
    points = np.stack([TIMES[name], table(TIMES[name]).value], axis=1).tolist()
    case = one_chain(kick=None, push={"table": points}, beads=4, timestep=0.01, duration=4.0)
    problem = case.problem()
    done = run(case, tmp_path / "run", check=False)
    exact = engine.run(problem, scheme=VERLET, steps_per_frame=problem.steps_per_frame)
    np.testing.assert_allclose(done.trajectory.velocity, exact.velocity, rtol=0.0, atol=1e-12)
    assert (done.directory.path / file_names.TABLES).is_file()
