"""Whether a pulse is the exact solitary wave: its shape, its speed and its constancy, each against a tolerance."""

import math

import numpy as np

from analysis.quantity import declare, derived, result
from analysis.shape.exact_wave import has_wave, wave_of
from analysis.shape.waveforms import REACH
from analysis.sharing.equipartition import dissipates
from analysis.tracking.pulses import CONSTANT_OVER, Pulse
from analysis.tracking.undisturbed import CLEAR
from analysis.trajectory import Flags, along_the_way
from lammps_inputs import Problem, laws, physics

UNSEEN = "the passage is not recorded completely"


@result
class Tolerances:
    """Largest relative differences from the exact wave at which a pulse still counts as one."""

    shape: float = declare("tolerance of the velocity over time, over the peak velocity", default=0.01)
    speed: float = declare("tolerance of the speed against the exact law", default=0.01)
    amplitude: float = declare("tolerance of the variation of the peak velocity over ten beads", default=0.01)


@result
class Character:
    """What a pulse is at one of its beads, the last at which all of it was seen clear of the chain's ends."""

    bead: int = declare("bead at which the following was measured, the last clear of the chain's ends")
    arrival: float = declare("time at which that bead is fastest", "time", symbol="t")
    peak_velocity: float = declare(
        "largest velocity of that bead as the pulse passes; where pulses overlap, the bead's whole velocity counts",
        "velocity",
        symbol="v",
    )
    arrival_error: float = declare(
        "bound on the error of the arrival by the time between frames and by the run (``run_error``)",
        "time",
        "the largest velocity is reached on a plateau (a bead that flies freely)",
    )
    peak_velocity_error: float = declare(
        "bound on the error of the peak velocity by the time between frames and by the run (``run_error``)", "velocity"
    )
    speed: float = declare("speed of the pulse at that bead", "speed", "it was seen at one bead only", "c")
    speed_error: float = declare(
        "bound on the error of the speed by those of the arrivals and by the run (``run_error``)",
        "speed",
        "so is the speed, an error of an arrival is, or these errors exceed the time between the arrivals",
    )
    width: float = declare("full width of the velocity at half its maximum", "beads", UNSEEN)
    width_error: float = declare(
        "uncertainty of the width by the time between frames, by that of the speed and by the run (``run_error``)",
        "beads",
        "so is the width or ``speed_error``, or the passage is recorded in fewer than six frames",
    )
    momentum: float = declare(
        "mass times speed times the integral of the velocity over the time in which the pulse travels from four beads "
        "before the bead to four beads behind it",
        "momentum",
        f"{UNSEEN}, beads differ, or its uncertainty exceeds a twentieth of it, as where the pulse has not come to "
        "rest four beads from its peak",
    )
    momentum_error: float = declare(
        "uncertainty of the momentum by the time between frames, by that of the speed, by where the pulse ends (the "
        "momentum of one bead of travel at either end) and by the run (``run_error``)",
        "momentum",
        "as ``momentum``",
    )
    energy: float = declare(
        "energy of the beads near the peak at the arrival",
        "energy",
        f"{UNSEEN}, another pulse is near, or frames are so far apart that its uncertainty exceeds a twentieth of it",
    )
    energy_error: float = declare(
        "uncertainty of the energy by the time between frames and by the run (``run_error``)",
        "energy",
        "as ``energy``; not all beads are recorded",
    )
    residual: float = declare(
        "largest difference of the velocity from the exact wave of this peak velocity, over that",
        undefined=f"{UNSEEN}; a larger pulse overlaps; beads differ or are preloaded",
    )
    residual_error: float = declare(
        "uncertainty of the residual by the time between frames and by the run (``run_error``)",
        undefined="as ``residual``",
    )
    speed_excess: float = declare(
        "relative difference of the speed from the exact law at this peak velocity",
        undefined="beads differ or are preloaded",
    )
    speed_excess_error: float = declare(
        "uncertainty of ``speed_excess`` by those of the speed and of the peak velocity",
        undefined="as ``speed_excess`` or ``speed_error``",
    )
    variation: float = declare(
        f"(largest - smallest) / mean peak velocity of the passages found at the {CONSTANT_OVER} beads up to this one",
        undefined="it ran less",
    )
    variation_error: float = declare(
        "uncertainty of ``variation`` by the largest of those of the peak velocities", undefined="as ``variation``"
    )
    falls: bool
    """Whether the amplitude is less than ten beads before."""

    fails: tuple[str, ...] = declare(
        "which of ``shape``, ``speed``, ``amplitude`` differ by more than the tolerances or were not measured; "
        "``decay`` where contacts or beads dissipate energy"
    )

    @property
    @derived()
    def solitary(self) -> bool:
        """Whether it is the exact wave within the tolerances; where beads differ or are preloaded, whether it is
        steady.
        """
        return not self.fails


def measured_at(pulse: Pulse, problem: Problem, last_time: float, clear: Flags) -> int:
    """Position in a pulse of the last passage that was recorded completely and that no end had disturbed.

    Where there is none, the last that was recorded completely before the end that the pulse runs to; else the last.

    Args:
        pulse: the pulse.
        problem: what was run.
        last_time: time of the last frame, in units of T.
        clear: [passage] whether it is clear of the ends (`analysis.tracking.undisturbed`).
    """
    position = along_the_way(problem, pulse.bead, pulse.direction)
    with np.errstate(divide="ignore", invalid="ignore"):
        watched = np.ceil(REACH / wave_of(problem.system).speed_at(pulse.peak_velocity) / problem.every) + 1.0
        over = pulse.arrival + watched * problem.every
    good = (position <= problem.beads - CLEAR) & (over < last_time)
    if np.any(good & clear):
        good &= clear
    return int(np.flatnonzero(good)[-1]) if np.any(good) else len(pulse) - 1


def characterise(
    pulse: Pulse, at: int, shape: dict[str, float], tolerances: Tolerances | None = None, *, problem: Problem
) -> Character:
    """Assess a pulse at one of its passages.

    Where beads differ, or are loaded, there is no exact wave to compare with: constancy alone counts, over beads of
    the same mass.

    Args:
        pulse: the pulse.
        at: position of the passage.
        shape: width, momentum, energy and residual of that passage, and their uncertainties.
        tolerances: what counts as equal.
        problem: what was run.
    """
    system = problem.system
    allowed = tolerances or Tolerances()
    names = "arrival", "peak_velocity", "arrival_error", "peak_velocity_error", "speed", "speed_error"
    measured = {name: float(getattr(pulse, name)[at]) for name in names}
    wave = wave_of(system)
    excess = measured["speed"] / float(wave.speed_at(measured["peak_velocity"])) - 1.0
    relative = measured["speed_error"] / measured["speed"], measured["peak_velocity_error"] / measured["peak_velocity"]
    near = pulse.recent(at)
    exact = _as_reference_beads(problem, pulse.chain - 1, int(pulse.bead[at]) - 1)
    if not exact:
        mass = physics.mass_of(system, pulse.chain - 1, pulse.bead[near] - 1)
        near = near[np.broadcast_to(mass == physics.mass_of(system, pulse.chain - 1, pulse.bead[at] - 1), near.shape)]
        shape, excess = {**shape, "residual": np.nan, "residual_error": np.nan}, np.nan
    recent = pulse.peak_velocity[near]
    distance = np.abs(pulse.bead[near[0]] - pulse.bead[at])
    variation = (
        float(np.ptp(recent) / np.mean(recent)) if len(recent) > 1 and distance > 0.5 * CONSTANT_OVER else np.nan
    )
    error, mean = float(np.max(pulse.peak_velocity_error[near])), float(np.mean(recent))
    differences = {"shape": shape["residual"], "speed": abs(excess)} if exact else {"amplitude": variation}
    if np.isfinite(variation):  # else too few beads are recorded
        differences["amplitude"] = variation
    return Character(
        bead=int(pulse.bead[at]),
        **measured,
        **shape,
        speed_excess=excess,
        speed_excess_error=(1.0 + excess) * (relative[0] + (wave.exponent - 1.0) / (wave.exponent + 1.0) * relative[1]),
        variation=variation,
        variation_error=(2.0 + variation) * error / (mean - error) if error < mean else np.nan,
        falls=bool(recent[-1] < recent[0]),
        fails=(
            *(name for name, value in differences.items() if not value <= getattr(allowed, name)),
            *(("decay",) if dissipates(problem.system) else ()),
        ),
    )


def _as_reference_beads(problem: Problem, chain: int, bead: int) -> bool:
    """Whether a bead, from 0, and those within the length of the exact wave are of mass 1, with contacts of A = 1.

    Not where there is no exact wave.
    """
    system = problem.system
    if not has_wave(system):
        return False
    near = slice(max(0, bead - math.ceil(REACH)), bead + math.ceil(REACH) + 1)
    strengths = (laws.strength(laws.at(link.law, chain, near)) for link in system.along)
    return physics.alike(system) or bool(
        np.all(physics.mass_of(system, chain, near) == 1.0) and all(np.all(np.equal(a, 1.0)) for a in strengths)
    )
