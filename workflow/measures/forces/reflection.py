"""What a wall reflects: peak velocity of the reflected pulse over that of the incident one, both at the wall.

Next to a wall the two overlap, and the reflected pulse takes some ten beads to form. So either is read at `BEADS`
recorded beads in a row, where its peak velocity changes least, and extrapolated to the wall by a line through its
logarithm.
"""

import numpy as np

from analysis.quantity import declare, result
from analysis.tracking.pulses import Pulse
from analysis.trajectory import Flags, Floats, Integers
from lammps_inputs import Problem, physics
from lammps_inputs.facts import Fact

NEAR = 15
"""Beads from the wall within which an incident pulse must have been seen, and a reflected one first seen."""

FORMED_INCIDENT, FORMED_REFLECTED = 5, 12
"""Beads from the wall from which on either is read."""

FARTHEST = 50
"""Beads from the wall up to which they are read."""

BEADS = 10
"""Recorded beads in a row at which either is read."""

CLEARLY = 0.5
"""Least velocity of an arriving pulse over that of the fastest: slower ones are ripples of another chain's pulse."""

UNCERTAIN = 0.5
"""Share of the decay between the wall and the nearest bead read that counts as uncertainty: a reflected pulse runs
through the motion behind the incident one, and decays otherwise.
"""

LARGEST_UNCERTAINTY = 0.05
"""Uncertainty beyond which a ratio is not given."""


@result
class Reflection:
    """Reflection of the first pulse that meets a wall; beads in the order in which it met them."""

    ratio: float = declare("peak velocity of the reflected over that of the incident pulse, extrapolated to the wall")
    uncertainty: float = declare(
        "uncertainty of the ratio: deviation from the lines, their curvature, half of the correction for the distance, "
        "and the error of the peak velocities"
    )
    incident_beads: tuple[int, int] = declare("first and last bead at which the incident pulse was measured")
    reflected_beads: tuple[int, int] = declare("first and last bead at which the reflected pulse was measured")


def reflections(pulses: tuple[Pulse, ...], problem: Problem, *, right: bool) -> list[Reflection | None]:
    """Reflection of the first pulse that meets a wall, by chain.

    None where no such ratio is defined (under a static load, on a foundation, and between beads that differ no pulse
    keeps its velocity), or it is not known to `LARGEST_UNCERTAINTY`: a pulse or its reflection was not seen at enough
    beads before the reflected one met the next incident one, decays too fast, or changes as chains exchange energy.
    """
    system = problem.system
    plain = physics.alike(system) and not physics.loaded(system) and system.holds(Fact.PULSE)
    by_chain = [_of_chain(pulses, problem, chain, right) if plain else None for chain in range(1, problem.chains + 1)]
    return [
        reflection if reflection is not None and reflection.uncertainty <= LARGEST_UNCERTAINTY else None
        for reflection in by_chain
    ]


def _of_chain(pulses: tuple[Pulse, ...], problem: Problem, chain: int, right: bool) -> Reflection | None:
    towards = 1 if right else -1
    in_chain = [pulse for pulse in pulses if pulse.chain == chain]
    close = [pulse for pulse in in_chain if _distance(pulse, problem, right).min() <= NEAR]
    arriving = _clear([pulse for pulse in close if pulse.direction == towards])
    if not arriving:
        return None
    incident, *later = sorted(arriving, key=lambda pulse: float(pulse.arrival[-1]))
    after, before = incident.arrival[-1], min((pulse.arrival[-1] for pulse in later), default=np.inf)
    back = [pulse for pulse in close if pulse.direction == -towards and _distance(pulse, problem, right)[0] <= NEAR]
    went = _clear([pulse for pulse in back if pulse.arrival[-1] > after and pulse.arrival[0] < before])
    if not went:
        return None
    reflected = min(went, key=lambda pulse: pulse.arrival[0])
    following = [pulse for pulse in in_chain if pulse.direction == towards and pulse.arrival[-1] > after]
    first = _at_wall(incident, _distance(incident, problem, right), FORMED_INCIDENT)
    distance = np.where(_unmet(reflected, following), _distance(reflected, problem, right), -1)
    second = _at_wall(reflected, distance, FORMED_REFLECTED)
    if first is None or second is None:
        return None
    ratio = float(np.exp(second[0] - first[0]))
    errors = [float(np.median(pulse.peak_velocity_error / pulse.peak_velocity)) for pulse in (incident, reflected)]
    return Reflection(ratio, ratio * float(np.linalg.norm([first[1], second[1], *errors])), first[2], second[2])


def _distance(pulse: Pulse, problem: Problem, right: bool) -> Integers:
    return problem.beads - pulse.bead if right else pulse.bead - 1


def _clear(pulses: list[Pulse]) -> list[Pulse]:
    """The pulses that are not mere ripples beside the fastest."""
    fastest = max((pulse.peak_velocity.max() for pulse in pulses), default=0.0)
    return [pulse for pulse in pulses if pulse.peak_velocity.max() >= CLEARLY * fastest]


def _unmet(reflected: Pulse, following: list[Pulse]) -> Flags:
    """[passage] whether a reflected pulse has not yet met any of those that follow the incident one."""
    met = np.zeros(len(reflected), dtype=bool)
    for pulse in following:
        order = np.argsort(pulse.bead)
        passing = np.interp(reflected.bead, pulse.bead[order], pulse.arrival[order], left=np.inf, right=np.inf)
        met |= passing < reflected.arrival
    return ~met


def _at_wall(pulse: Pulse, distance: Integers, nearest: int) -> tuple[float, float, tuple[int, int]] | None:
    """Logarithm of a peak velocity at the wall, its uncertainty, and the beads it is from; None of too few beads."""
    usable = np.flatnonzero((distance >= nearest) & (distance <= FARTHEST))
    best = None
    for start in range(len(usable) - BEADS + 1):
        place = usable[start : start + BEADS]
        value, uncertainty = _extrapolated(distance[place].astype(np.float64), np.log(pulse.peak_velocity[place]))
        if best is None or uncertainty < best[1]:
            best = value, uncertainty, (int(pulse.bead[place[0]]), int(pulse.bead[place[-1]]))
    return best


def _extrapolated(distance: Floats, value: Floats) -> tuple[float, float]:
    """A line through values at distance 0, and its uncertainty."""
    line, curve = (np.linalg.lstsq(np.vander(distance, n), value, rcond=None)[0] for n in (2, 3))
    lever = np.hypot(1.0, distance.mean() / distance.std())
    apart = float(np.max(np.abs(value - np.polyval(line, distance)))) * lever
    return float(line[-1]), float(abs(curve[-1] - line[-1]) + apart + UNCERTAIN * abs(line[0]) * distance.min())
