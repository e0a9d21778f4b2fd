"""Initial states: exact motions, units, energy and tables; the motion of all forms is in `test_every_ingredient`."""

import math

import numpy as np
import pytest
from plain_scene import one_chain

from lammps_inputs import InputError, library, physics
from lammps_inputs.facts import Fact
from workflow.engines.reference import engine
from workflow.runs.run import run
from workflow.verdicts.analysis_files import analyse

pytestmark = pytest.mark.usefixtures("lammps_here")

PAIR = {"beads": 2, "initial": {"bead": 1, "displacement": 0.6}}


def scene(keys, **more):
    return one_chain(**{"beads": 2, "kick": None, "duration": 10.0, "output": None, **keys, **more})


def test_two_beads_released_from_an_overlap_share_its_energy_exactly(tmp_path):
    case = scene(PAIR)
    speed = math.sqrt(0.4 * 0.6**2.5)  # of either bead, of mass 1
    done = run(case, tmp_path / "run")
    for frames in (done.trajectory, engine.run(case.problem())):
        velocity = frames.velocity[-1, 0] * case.scale.velocity
        assert velocity == pytest.approx([-speed, speed], rel=1e-4)
        assert np.sum(frames.velocity, axis=(1, 2)) == pytest.approx(0.0, abs=1e-13)
    report = analyse(done.directory, figures=False)
    assert report.conservation.energy_drift < 2e-4
    assert report.conservation.momentum_drift < 1e-12


def test_v_is_the_velocity_of_a_bead_with_the_energy_of_the_link_that_stores_most():
    case = scene(PAIR)
    assert case.scale.velocity == pytest.approx(math.sqrt(2.0 * 0.4 * 0.6**2.5), rel=1e-14)
    assert physics.energy(case.system) == pytest.approx(0.5, rel=1e-12)
    assert physics.largest_excitation(case.system) == (1, 1, pytest.approx(-1.0, rel=1e-12))
    faster = scene(PAIR, kick={"velocity": 3.0})
    assert faster.scale.velocity == 3.0


def test_velocities_alone_are_kicks_which_add_to_those_of_the_same_bead():
    kicked = scene({"beads": 20, "kick": {"velocity": 1.0}})
    parts = {"beads": 20, "initial": {"bead": 1, "velocity": 0.25}, "kick": {"velocity": 0.75}}
    state = scene(parts, timestep=0.0075)
    problem = state.model_copy(update={"kick": ()}).problem()
    assert problem.system.start.velocity[0, 0] == 1.0
    np.testing.assert_allclose(
        physics.initial_velocity(state.system) * state.scale.velocity,
        physics.initial_velocity(kicked.system),
        rtol=1e-15,
    )
    assert state.system.holds(Fact.PULSE)


def test_a_table_of_a_file_may_leave_columns_and_cells_out_and_is_part_of_the_scene(tmp_path):
    (tmp_path / "start.csv").write_text("bead;displacement;velocity\n2;;0.5\n\n3;-0.25;\n")
    (tmp_path / "a.yaml").write_text("name: a\nbeads: 9\nduration: 5\ninitial: {table: start.csv}\n")
    case = library.load(tmp_path / "a.yaml")
    assert case.initial[0].table == ((1, 2, 0.0, 0.5), (1, 3, -0.25, 0.0))
    assert library.from_plain(case.plain(), "x") == case
    long = scene({"beads": 50}, initial={"table": [[1, i, 0.1 / i, -1.0 / 3.0] for i in range(1, 51)]})
    assert long.plain()["initial"]["table"].startswith("chain,bead,displacement,velocity\n1,1,0.1,-0.333")
    assert library.from_plain(long.plain(), "x") == long
    with pytest.raises(InputError, match="a file's name may stand in a scene's file only"):
        scene({}, initial={"table": "start.csv"})
