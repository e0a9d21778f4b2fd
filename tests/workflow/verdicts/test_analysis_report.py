"""What analysis.json says of trains, the decay law and the final amplitude, and waves.csv: hand-made numbers."""

import numpy as np
import pytest
from small_problems import problem

from analysis.sharing.survey import Survey, survey
from analysis.tracking.leading_waves import with_speeds
from workflow.engines.reference import engine
from workflow.verdicts import analysis_report
from workflow.verdicts.analysis_report import LeadingWave


def summary(waves, problem, chain, succession=()):
    """Leading wave of a chain, by waves and changes alone."""
    of_waves = Survey(problem, tuple, "maximum").replaced(passages=waves, waves=waves, succession=succession)
    return LeadingWave(of_waves, chain)


@pytest.mark.parametrize(("first", "bead"), [(4, 6), (7, 7), (2, 6)])
def test_a_wave_towards_bead_1_is_reported_at_the_last_bead_clear_of_that_end(first, bead):
    number = np.arange(first, 20)
    waves = with_speeds(np.ones(len(number), int), number, 20.0 - number, np.full(len(number), 0.5), direction=-1)
    back = problem(chains=1, beads=20, kicks=((1, 20, -1.0),))
    assert summary(waves, back, 1).bead == bead


@pytest.fixture(scope="module")
def three():
    """What is found of a chain of 90 beads, three of which were kicked at once."""
    kicks = ((1, 1, 1.0), (1, 2, 1.0), (1, 3, 1.0))
    one = problem(chains=1, beads=90, kicks=kicks, timestep=0.1, steps_per_frame=1, frames=1400)
    run = engine.run(one)
    return survey(run.blocks, one)


def test_amplitudes_of_a_train_are_those_that_its_pulses_have_far_from_the_ends(three):
    """Those of 330 beads; the last pulse has 0.41 five beads before the end, from which the first has come back."""
    seen = analysis_report.train(three)
    assert seen.peak_velocity == pytest.approx([0.92391, 0.65773, 0.32287], abs=1e-5)
    assert np.all(seen.uncertainty < 1e-5)
