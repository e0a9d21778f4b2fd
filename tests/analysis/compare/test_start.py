"""Frames that do not begin as their scene does: which atoms are named, and in which units."""

from dataclasses import replace

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
