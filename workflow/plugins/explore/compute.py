"""A scene computed in memory by the reference integrator: its frames, the waves in them, and how accurate they are."""

from dataclasses import dataclass

from granchain import InputError, Scene
from granchain.parts import (
    Problem,
    StepHalving,
    Survey,
    engines,
    leading_waves,
    numbers,
    output,
    panels,
    physics,
    settle,
)
from workflow.plugins.pages.downsample import Thinned, thinned

MOST_SECONDS = 2.0
"""Estimated time above which a scene is not computed while its numbers are changed."""

HALVED = 1.5
"""Time of the run and of the one in half as many steps, over that of the run."""

SECONDS_A_NUMBER = 5e-7
"""Time for a velocity of a frame to be surveyed and thinned; measured."""

SLOW_PULSE = 2.0
"""Time in which a slow pulse passes a bead, in T in contacts of strength 1: by it the cost of a scene without duration
is estimated."""


@dataclass(frozen=True)
class ComputedScene:
    """Run of the reference integrator, dimensionless.

    Attributes:
        problem: what was run.
        part: of its frames, for plots.
        survey: waves, pulses and the verdict.
        uncertainty: bound on the error of velocities, in units of V.
    """

    problem: Problem
    part: Thinned
    survey: Survey
    uncertainty: float


def computed(scene: Scene) -> ComputedScene:
    """Compute a scene; an ``accuracy`` that it names is not aimed at, as that may take many runs.

    Raises:
        InputError: the reference cannot compute it, it takes too long, or its frames are too far apart.
        RunError: its velocities grow beyond all bounds.
    """
    if refusal := engines.engine_called("reference").refusal(scene):
        raise InputError(refusal)
    scene = scene.model_copy(update={"accuracy": None})
    if scene.until_bead is not None:
        duration = SLOW_PULSE * physics.pulse_time(scene.system) * scene.until_bead * scene.scale.time
        _refuse_slow(scene.model_copy(update={"until_bead": None, "duration": duration}).problem())
    settled, _ = settle(scene, source=scene.name, own_step=False)
    problem = settled.resolved().problem()
    if why := output.too_far_apart(problem.every, problem.scale, physics.pulse_time(problem.system)):
        raise InputError(f"output.every: {why}")
    _refuse_slow(problem)
    halving = StepHalving(problem, velocity_only=True)
    blocks = list(halving.blocks())
    waves = Survey(problem, lambda: iter(blocks), leading_waves.usual_arrival(problem)).completed()
    part = thinned(problem, blocks, panels.shown_chains(problem), deforms=False)
    return ComputedScene(problem, part, waves, halving.uncertainty.velocity)


def estimated_seconds(problem: Problem) -> float:
    """Estimated time of `computed`, by the model of the reference's cost and the numbers of its frames, in s."""
    recorded = problem.frames * problem.chains * problem.rows.count
    return HALVED * (engines.engine_called("reference").seconds(problem, 1) or 0.0) + SECONDS_A_NUMBER * recorded


def _refuse_slow(problem: Problem) -> None:
    seconds = estimated_seconds(problem)
    if seconds > MOST_SECONDS:
        raise InputError(
            f"this scene takes about {numbers.time_text(seconds)}, more than the {MOST_SECONDS:g} s up to which this "
            "page computes; take a shorter duration or fewer beads, or save the scene and use `granchain run`"
        )
