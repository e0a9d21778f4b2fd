"""Pulses that follow each other past a bead."""

import pytest
from small_problems import problem

from analysis.sharing.survey import survey
from analysis.tracking.pulses import train_of
from analysis.trajectory import blocks
from workflow.engines.reference import engine


def test_two_beads_launched_together_give_two_pulses_of_known_heights():
    one = problem(chains=1, beads=310, kicks=((1, 1, 1.0), (1, 2, 1.0)), timestep=0.25, steps_per_frame=1, frames=1700)
    run = engine.run(one)
    found = survey(lambda: blocks(run), one)
    train = train_of(found.pulses, 1, 1, 300)
    assert train.peak_velocity == pytest.approx([0.8535, 0.4463], abs=1e-4)
    assert train.ratio[1] == pytest.approx(0.4463 / 0.8535, abs=2e-4)
    assert train.spacing[0] == pytest.approx(train.arrival[1] - train.arrival[0])
