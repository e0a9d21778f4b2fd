"""What a wall gives back of a pulse: the reflected pulse's peak velocity over the incident one's, at one bead."""

import numpy as np

from analysis.tracking.pulses import Pulse
from analysis.trajectory import Floats
from lammps_inputs import Problem

NEAR = 15
"""Beads from the wall within which an incident pulse must have been seen, and a reflected one first seen."""

CLEAR = 25
"""Beads from the wall where they are compared, as near as can be: the reflected one has its shape there."""

CLEARLY = 0.5
"""Of the fastest that came: what is slower, ahead of it, is a ripple of another chain's pulse, not the one meant."""


def restitution(pulses: tuple[Pulse, ...], problem: Problem, *, right: bool) -> Floats:
    """Of the first pulse that comes to a wall, [chain]; NaN where it or its reflection was not seen."""
    towards = 1 if right else -1
    found = np.full(problem.chains, np.nan)

    def distance(pulse: Pulse) -> "np.ndarray[tuple[int], np.dtype[np.int64]]":
        return problem.beads - pulse.bead if right else pulse.bead - 1

    for chain in range(1, problem.chains + 1):
        own = [pulse for pulse in pulses if pulse.chain == chain and distance(pulse).min() <= NEAR]
        came = _clear([pulse for pulse in own if pulse.direction == towards])
        if not came:
            continue
        incident, *later = sorted(came, key=lambda pulse: float(pulse.arrival[-1]))
        after, before = incident.arrival[-1], min((pulse.arrival[-1] for pulse in later), default=np.inf)
        back = [pulse for pulse in own if pulse.direction == -towards and distance(pulse)[0] <= NEAR]
        went = _clear([pulse for pulse in back if pulse.arrival[-1] > after and pulse.arrival[0] < before])
        if not went:
            continue
        reflected = min(went, key=lambda pulse: pulse.arrival[0])
        common, there, again = np.intersect1d(incident.bead, reflected.bead, return_indices=True)
        if len(common):
            away = problem.beads - common if right else common - 1
            best = int(np.argmin(np.abs(away - CLEAR)))
            found[chain - 1] = reflected.peak_velocity[again[best]] / incident.peak_velocity[there[best]]
    return found


def _clear(pulses: list[Pulse]) -> list[Pulse]:
    """Those that are not mere ripples beside the fastest."""
    most = max((pulse.peak_velocity.max() for pulse in pulses), default=0.0)
    return [pulse for pulse in pulses if pulse.peak_velocity.max() >= CLEARLY * most]
