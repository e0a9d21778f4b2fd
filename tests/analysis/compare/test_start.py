"""Frames that do not begin as their scene does: which atoms are named, and in which units."""

from dataclasses import replace

import numpy as np
from synthetic_waves import of_keys, reference

from analysis.compare import start
from lammps_inputs import Kick, find
from workflow.engines.reference import engine


def test_the_beads_that_differ_most_are_named_first():
    run = reference(1, 0.0, 8, 1.0, kicks=[Kick(velocity=1.0), Kick(bead=5, velocity=0.5)])
    assert start.differences(run) == []
    velocity = run.velocity.copy()
    velocity[0, 0, [0, 4]] = 0.9, 0.1
    assert start.differences(replace(run, velocity=velocity)) == [
        "bead 5 of chain 1 starts with velocity 0.1 instead of 0.5",
        "bead 1 of chain 1 starts with velocity 0.9 instead of 1",
    ]


def test_beads_of_a_subset_are_named_by_their_numbers_and_in_the_units_of_the_scene():
    problem = find("two-chains-steel").model_copy(update={"beads": 20, "duration": 1e-5}).problem()
    run = engine.run(replace(problem, rows=problem.rows.only((1, 12))))
    velocity = run.velocity.copy()
    velocity[0, 1, 1] = 0.25
    (text,) = start.differences(replace(run, velocity=velocity))
    assert text == "bead 12 of chain 2 starts with velocity 0.25 m/s instead of 0 m/s"


def test_a_resonator_that_moves_at_the_start_is_named():
    keys = {"beads": 4, "kick": {"velocity": 1.0}, "duration": 1.0, "resonators": {"mass": 0.3, "stiffness": 0.2}}
    run = engine.run(of_keys(**keys))
    assert start.differences(run) == []
    further = np.array(run.further_lines)
    further[0, 1, 0, 2] = 0.5
    (text,) = start.differences(replace(run, further_lines=further))
    assert text == "the resonator at bead 3 of chain 1 starts with velocity 0.5 instead of 0"
