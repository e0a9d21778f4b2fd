"""Frames that do not begin as their scene does: which atoms are named, and in which units."""

from dataclasses import replace

import numpy as np
from synthetic_waves import of_keys

from analysis.compare import start
from lammps_inputs import find
from workflow.engines.reference import engine


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
