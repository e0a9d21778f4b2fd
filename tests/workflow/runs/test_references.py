"""How many steps references take, with uncertainties made up, and those whose exchange a run's frames get."""

from types import SimpleNamespace

import pytest
from small_problems import problem

from workflow.engines.reference import engine
from workflow.prepare.settings import Settings
from workflow.runs import check
from workflow.runs.check import accountant
from workflow.runs.job import Job, Uncertainty

ASKED = Settings(1e-4, 0.01, 10, 0.025, 5e-5, 5e-5, 1.0, limited=False, seconds=0.1)


@pytest.mark.parametrize(
    ("fall", "steps"),
    [
        (0.02, [4, 8]),  # sure to a third of what was asked for
        (0.4, [4, 8, 16, 32]),
        (0.6, [4, 8]),  # hardly surer
    ],
)
def test_steps_are_doubled_until_the_reference_is_sure_or_hardly_gets_surer(fall, steps, monkeypatch):
    """From 1e-3 at four steps a frame the uncertainty falls by a factor with each doubling."""

    class Falling:
        def __init__(self, _, *, steps_per_frame=None):
            self.steps = steps_per_frame
            self.uncertainty = SimpleNamespace(velocity=1e-3 * fall ** [4, 8, 16, 32].index(steps_per_frame))

    monkeypatch.setattr(check, "StepHalving", Falling)
    assert [one.steps for one in check.references_of(problem(), ASKED)] == steps


@pytest.mark.parametrize(
    ("taken", "steps"),
    [(6, 6), (None, None), (10**12, 2**12 * engine.default_steps_per_frame(problem()))],
)
def test_frames_of_the_reference_are_followed_with_its_own_steps_as_far_as_it_would_take_them(taken, steps):
    """A run of another engine has no uncertainty."""
    uncertainty = None if taken is None else Uncertainty(steps_per_frame=taken, velocity=None, arrival=None)
    directory = SimpleNamespace(account=Job(uncertainty=uncertainty))
    assert accountant(directory, problem()).steps_per_frame == steps
