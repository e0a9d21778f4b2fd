"""The duration of a scene that ends at a bead: found by the reference integrator before anything else runs."""

import math

import numpy as np

from lammps_inputs import InputError, Scene
from lammps_inputs.limits import rates
from lammps_inputs.limits.closing import slowest_swing
from workflow.engines.reference import engine

_AFTER = 6.0
"""Time from the last chain's peak to the end, in units of T: the wave's velocity falls to nothing within it."""

_SLOWEST = 10.0
"""Give up when the pulse takes this many times as long as one that keeps the kick's full speed."""


_WINDOW = 512
"""Rows that are integrated for a scene whose window is still to be found."""


def with_duration(scene: Scene) -> Scene:
    """The same scene with its duration written out.

    ``until_bead: n`` ends shortly after the first pulse in every chain that moves has passed bead n: its velocity there
    has risen above 1e-3 of V and fallen to less than half of its largest value. The last bead flies off with what it
    got: its velocity has risen above 1e-3 of V and rises no more. Where the beads have a gap, the chains of a row are
    struck one after another as their springs swing: the run then goes on for a period of the slowest swing, or for as
    long again if that is shorter.

    Raises:
        InputError: the pulse does not arrive within ten times the time that an undamped one takes.
    """
    if scene.until_bead is None:
        return scene
    # the reference integrates with the scene's own cadence, but records the one bead that matters
    gap, system = scene.gap / scene.scale.length, scene.system
    pushed = max((load.end for load in system.loads if not load.endless), default=0.0)
    cadence = 0.1 / rates.pace(system) if system.loaded else 0.1  # sound may be faster
    limit = (_SLOWEST * (scene.until_bead + 10) * (1.0 + gap) + pushed) * scene.scale.time
    trial = scene.model_copy(
        update={
            "until_bead": None,
            "duration": limit,
            "timestep": None,
            "accuracy": None,
            "window": None,
            "output": scene.output.model_copy(
                update={"every": cadence * scene.scale.time, "beads": (scene.until_bead,)}
            ),
        }
    )
    problem = trial.problem()
    reached = np.ones(problem.chains, dtype=bool)
    for chain, _, _ in problem.struck:
        reached[problem.tied_to(chain - 1)] = False
    share = 1.0 if scene.until_bead == scene.beads else 0.5
    largest = np.zeros(problem.chains)
    rows = None if scene.window is None else min(scene.beads, _WINDOW if scene.window == "auto" else 2 * scene.window)
    for block in engine.blocks(problem, window=rows):
        for time, velocity in zip(block.time, np.abs(block.velocity[:, :, 0]), strict=True):
            reached |= (largest > 1e-3) & (velocity <= share * largest)
            largest = np.maximum(largest, velocity)
            if reached.all():
                every = scene.resolved().output.every or 0.0
                after = _AFTER
                if gap > 0.0 and problem.coupled:
                    slowest = slowest_swing(problem.chains, problem.kappa) if problem.open_row else 0.0
                    after += min(float(time), 2.0 * math.pi / slowest) if slowest else float(time)
                duration = math.ceil((float(time) + after) * scene.scale.time / every) * every
                return scene.model_copy(update={"until_bead": None, "duration": duration})
    raise InputError(
        f"until_bead: bead {scene.until_bead} is not passed in every chain by "
        f"t = {scene.scale.written(limit / scene.scale.time, 'time', '.4g')} "
        "(weakly coupled pulses decay); give a duration"
    )
