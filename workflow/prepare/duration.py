"""The duration of a scene that ends at a bead.

It is found by a trial with the reference integrator before anything else runs, within a limit on its processor time.
"""

import math

import numpy as np

from analysis.gauges.gauge import PULSE, Gauge, at_frames, far_wall
from lammps_inputs import InputError, Output, Scene, physics
from lammps_inputs.limits import rates
from lammps_inputs.limits.closing import lowest_modal_frequency
from workflow import screen
from workflow.engines.registry import load_engine
from workflow.processor_time import LimitReachedError, check, limited

SECONDS = 4.0
"""Processor time, in s, that the trial may take; the rest is for the window and the time step."""

_RISEN = 1e-3
"""Velocity in units of V, and force in its unit at V = 1, from which a pulse has arrived."""

_AFTER = 6.0
"""Time from the last chain's peak to the end, in units of T in contacts of strength 1: the wave's velocity falls to
nothing within it."""

_SLOWEST = 10.0
"""Give up when the pulse takes this many times as long as one that keeps the kick's full speed."""


_USUAL = 2.0
"""Units of T that a pulse may take a bead of strength 1 where no trial is affordable: at that speed it has 0.05 V."""

_PARTS = 200
"""Blocks of frames in the longest trial, of which most need a tenth."""

_WINDOW = 512
"""Rows that are integrated for a scene whose window is still to be found."""


def with_duration(scene: Scene, *, wall: bool = False) -> Scene:
    """A scene with its duration written out.

    ``until_bead: n`` ends shortly after the first pulse in every chain that moves has passed bead n: its velocity there
    has risen above 1e-3 of V and fallen to less than half of its largest value. The last bead flies off with what it
    got: its velocity has risen above 1e-3 of V and rises no more. Where the beads have a gap, the chains of a row are
    reached one after another as their springs oscillate: the run then continues for a period of the slowest mode,
    or for as long again if that is shorter. Where the trial reaches the limit on processor time, the duration is that
    of a pulse that passes a bead in 2 T, and a hint says so.

    Where the force on walls is read, it also waits for the pulse at the wall that the largest excitation goes towards:
    the force there, above the static one, has risen above 1e-3 of its unit and fallen to `PULSE` of its largest value.

    Args:
        scene: any; one with a duration is returned as it is.
        wall: whether the force on the far wall is wanted, also where the scene does not name it.

    Raises:
        InputError: the pulse does not arrive within ten times the time that an undamped one takes.
    """
    if scene.until_bead is None:
        return scene
    try:
        with limited(SECONDS):
            return _with_duration(scene, wall)
    except LimitReachedError:
        every, usual = scene.resolved().output.every or 0.0, _limit(scene, wall, _USUAL)
        duration = math.ceil(usual * scene.scale.time / every) * every
        written = scene.scale.written(duration / scene.scale.time, "time", ".4g")
        screen.hint(
            f"until_bead: a duration of {written} is given by a rule, as a trial takes more than {SECONDS:g} s of "
            "processor time; `duration` in place of `until_bead` avoids it"
        )
        return scene.model_copy(update={"until_bead": None, "duration": duration})


def _far(scene: Scene, wall: bool) -> Gauge | None:
    """The far wall where its force is read; else None."""
    return far_wall(scene.system) if wall or (scene.output.forces is not None and scene.output.forces.wall) else None


def _limit(scene: Scene, wall: bool, slowness: float) -> float:
    """Time, in units of T, in which a pulse passes the last bead that matters; slowness: T a bead of strength 1."""
    assert scene.until_bead is not None
    last = scene.until_bead if _far(scene, wall) is None else max(scene.until_bead, scene.beads)
    ends = [*(load.end for load in scene.system.loads), *(motion.end for motion in scene.system.motions)]
    pushed = max(filter(math.isfinite, ends), default=0.0)
    return slowness * physics.pulse_time(scene.system) * (last + 10) * (1.0 + physics.gap(scene.system)) + pushed


def _with_duration(scene: Scene, wall: bool) -> Scene:
    """The scene with the duration that a trial finds."""
    assert scene.until_bead is not None
    # the reference integrates with the scene's own cadence, but records the few beads that matter
    system = scene.system
    gap = physics.gap(system)
    far = _far(scene, wall)
    pulse_time = physics.pulse_time(system)
    cadence = 0.1 / rates.front_speed(system) if physics.loaded(system) else 0.1 * pulse_time  # sound may be faster
    limit = _limit(scene, wall, _SLOWEST) * scene.scale.time
    beads = {scene.until_bead} if far is None else {scene.until_bead, far.bead}
    trial = _trial(scene, limit, cadence, tuple(sorted(beads)))
    problem = trial.problem()
    still = np.ones(problem.chains, dtype=bool)
    for chain, _, _ in physics.excitations(problem.system):
        still[physics.tied_to(problem.system, chain - 1)] = False
    reached, released = still.copy(), still | (far is None)
    share = 1.0 if scene.until_bead == scene.beads else 0.5
    largest, largest_force = np.zeros(problem.chains), np.zeros(problem.chains)
    rows = None if scene.window is None else min(scene.beads, _WINDOW if scene.window == "auto" else 2 * scene.window)
    most_frames = math.ceil(problem.frames / _PARTS)
    for block in load_engine("reference").blocks(problem, rows=rows, most_frames=most_frames):
        speed = np.abs(block.velocity[:, :, int(problem.rows.positions(scene.until_bead))])
        force = np.zeros_like(speed) if far is None else at_frames(block, (far,))[..., 0] - far.static
        for time, velocity, pressing in zip(block.time, speed, force, strict=True):
            check()
            reached |= (largest > _RISEN) & (velocity <= share * largest)
            largest = np.maximum(largest, velocity)
            released |= (largest_force > _RISEN) & (pressing <= PULSE * largest_force)
            largest_force = np.maximum(largest_force, pressing)
            if reached.all() and released.all():
                every = scene.resolved().output.every or 0.0
                after = _AFTER * pulse_time
                if gap > 0.0 and physics.coupled(problem.system):
                    slowest = (
                        lowest_modal_frequency(problem.chains, physics.kappa(problem.system))
                        if physics.open_row(problem.system)
                        else 0.0
                    )
                    after += min(float(time), 2.0 * math.pi / slowest) if slowest else float(time)
                duration = math.ceil((float(time) + after) * scene.scale.time / every) * every
                return scene.model_copy(update={"until_bead": None, "duration": duration})
    raise _not_ended(scene, limit, None if not reached.all() else far.name if far else "wall")


def _not_ended(scene: Scene, limit: float, wall: str | None) -> InputError:
    """Says that a bead is not passed in time, or that the pulse at a wall has not ended."""
    until = f"in every chain by t = {scene.scale.written(limit / scene.scale.time, 'time', '.4g')}"
    cause = scene.uncoupled() or "weakly coupled pulses decay"
    message = f"bead {scene.until_bead} is not passed {until} ({cause})"
    if wall is not None:
        message = f"the pulse at the {wall}, whose force is read, has not ended {until}"
    return InputError(f"until_bead: {message}; give a duration")


def _trial(scene: Scene, duration: float, cadence: float, beads: tuple[int, ...]) -> Scene:
    """The scene over a duration, with few beads recorded that often in units of T, and no time step of its own."""
    return scene.model_copy(
        update={
            "until_bead": None,
            "duration": duration,
            "timestep": None,
            "accuracy": None,
            "window": None,
            "output": Output(every=cadence * scene.scale.time, beads=beads),
        }
    )
