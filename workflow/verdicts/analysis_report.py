"""What an analysis writes of every scene: the keys of ``analysis.json``."""

from itertools import accumulate
from typing import Any

import numpy as np

from analysis.conservation import Conservation
from analysis.mirror import along_the_way
from analysis.shape.wave_of import has_wave, wave_of
from analysis.sharing.equipartition import AGREEMENTS, Estimate, dissipates, resolved
from analysis.sharing.is_solitary import Character, Tolerances
from analysis.sharing.survey import Survey
from analysis.tracking.leading_waves import Waves
from analysis.tracking.pulses import Pulse
from analysis.tracking.train import Train, train_of
from analysis.tracking.undisturbed import CLEAR, clear_of_others
from lammps_inputs import Problem, physics
from lammps_inputs.facts import Fact
from lammps_inputs.numbers import known

REPORT = "analysis.json"

STEADY = 0.01
"""Relative change of its amplitude over ten beads up to which a pulse of a train is steady."""


def report(found: Survey, seen: Conservation, tolerances: Tolerances) -> dict[str, Any]:
    """The contents of ``analysis.json``. Quantities are in the scene's units unless said otherwise; null is unknown.

    | key             | what                                                                             |
    |-----------------|----------------------------------------------------------------------------------|
    | complete        | whether every frame of the scene is there                                        |
    | frames          | found, and asked for                                                             |
    | front           | largest number of a recorded bead that was faster than 1e-3 V; null if none was  |
    | energy_drift    | largest relative deviation of the energy; null if not all beads were recorded    |
    | momentum_drift  | the same of the momentum                                                         |
    | units           | the scene's units: ``SI`` or ``reduced``                                         |
    | scale           | worth of the dimensionless units of mass, length, time, velocity in the scene's  |
    | kappa           | dimensionless coupling at V = 1                                                  |
    | arrival         | what an arrival of a wave is: ``maximum`` or ``impulse``                         |
    | noise           | standard deviation of the recorded velocities, in V; 0 for none                  |
    | waves           | per chain: beads reached, and at the last whole one its arrival, peak velocity, speed |
    | train           | pulses that followed each other in the chain that was hit; see `train_report`    |
    | equipartition   | see `equipartition`                                                              |
    | tolerances      | relative differences within which a pulse is called solitary                     |
    | pulses          | every pulse, the strongest first; see `pulse_entry`                              |

    What only some scenes have has keys of its own, see `workflow.verdicts.findings`.
    """
    problem, scale = found.problem, found.problem.scale
    order = np.argsort([-character.peak_velocity for character in found.characters], kind="stable")
    return {
        "complete": seen.frames == problem.frames + 1,
        "frames": [seen.frames, problem.frames + 1],
        "front": seen.front,
        "energy_drift": known(seen.energy_drift),
        "momentum_drift": known(seen.momentum_drift),
        "units": "SI" if scale.si else "reduced",
        "scale": {"mass": scale.mass, "length": scale.length, "time": scale.time, "velocity": scale.velocity},
        "kappa": physics.kappa(problem.system),
        "arrival": found.arrival,
        "noise": found.noise,
        "waves": [_chain_summary(found.waves, problem, chain) for chain in range(1, problem.chains + 1)],
        "train": train_report(found),
        "equipartition": equipartition(found),
        "tolerances": {name: getattr(tolerances, name) for name in ("shape", "speed", "amplitude")},
        "pulses": [pulse_entry(found, found.pulses[k], found.characters[k]) for k in order],
    }


def train(found: Survey) -> Train | None:
    """The first pulses of the kicked chain, as many as are steady somewhere; there, at the last such bead.

    Each is clear of the ends of the chain and of all other pulses, and its amplitude is constant to `STEADY` over the
    ten beads before. Only pulses count that ran over a quarter of the chain. None where not even the first is steady,
    and where no pulse stays together.
    """
    if not found.problem.system.holds(Fact.PULSE):
        return None
    chain, ahead = found.shared.kicked + 1, found.direction
    steady: dict[int, list[tuple[float, bool]]] = {}
    far: list[Pulse] = []
    for pulse, clear in zip(found.pulses, found.clear, strict=True):
        if (pulse.chain, pulse.direction) != (chain, ahead) or 4 * np.ptp(pulse.bead) < found.problem.beads:
            continue
        far.append(pulse)
        alone = clear_of_others(chain, pulse.bead, pulse.arrival, found.pulses, found.problem.every)
        for at, good in enumerate(clear & alone):
            varies = pulse.variation(at)  # not known where few beads are recorded
            unknown = np.isnan(varies) and found.problem.recorded is not None
            constant = unknown or varies <= STEADY * pulse.peak_velocity[at]
            steady.setdefault(int(pulse.bead[at]), []).append((float(pulse.arrival[at]), bool(good) and constant))
    first = {bead: sum(accumulate((good for _, good in sorted(seen)), min)) for bead, seen in steady.items()}
    most = max(first.values(), default=0)
    if most == 0:
        return None
    best = [bead for bead, count in first.items() if count == most]
    seen = train_of(far, chain, ahead, max(best) if ahead > 0 else min(best), wave_of(found.problem.system))
    return seen.until(most)


def train_report(found: Survey) -> dict[str, Any] | None:
    """What ``analysis.json`` says under ``train``, in the scene's units; null if no pulse was tracked as far.

    | key            | what                                                            |
    |----------------|-----------------------------------------------------------------|
    | chain, bead    | where                                                           |
    | pulses         | number of pulses, from the first on, that are steady there:     |
    |                | clear of the ends of the chain and of other pulses, and of an   |
    |                | amplitude that is constant to 1% over the ten beads before      |
    | arrival        | of each                                                         |
    | peak_velocity  | of each, positive along its way                                 |
    | uncertainty    | of each of these: largest difference from it over the ten beads |
    |                | before; null where none of them was recorded                    |
    | ratio          | that over the first one's                                       |
    | spacing        | time from each to the next                                      |
    """
    seen, scale = train(found), found.problem.scale
    if seen is None or len(seen) == 0:
        return None
    return {
        "chain": seen.chain,
        "bead": seen.bead,
        "pulses": len(seen),
        "arrival": (seen.arrival * scale.time).tolist(),
        "peak_velocity": (seen.peak_velocity * scale.velocity).tolist(),
        "uncertainty": [known(one * scale.velocity) for one in seen.uncertainty.tolist()],
        "ratio": seen.ratio.tolist(),
        "spacing": (seen.spacing * scale.time).tolist(),
    }


def equipartition(found: Survey) -> dict[str, Any]:
    """How the chains share the leading pulse. Beads count from the end that was hit towards the pulse's direction.

    | key            | what                                                                                      |
    |----------------|-------------------------------------------------------------------------------------------|
    | verdict        | in words; ``state`` in one, ``since`` the bead from which on chains are equal and in step  |
    | expected       | bead of 1% agreement where it was not reached, and its uncertainty                        |
    | amplitudes     | bead from which on the mismatch, (largest - smallest) / mean, stays below 0.1, 0.01, 0.001 |
    | arrivals       | the same for the spread of arrivals over the time in which the wave passes (half height)   |
    | final          | asymptotic amplitude in V: mean over chains and the last half beat, its uncertainty, and   |
    |                | the reduction against V; null where amplitudes have no limit, or do not approach one       |
    | range          | least and largest amplitude in V from bead ``first`` on, which is half-way, to ``last``    |
    | energy_share   | of the energy input, in the leading waves at the last clear bead: ``measured``, within     |
    |                | three beads of their peaks; ``exact``: of exact waves of these amplitudes; null where      |
    |                | there are none, or another pulse is as near                                                |
    | beat_length    | beads from one excess of a chain to the next, and its scatter                              |
    | decay_law      | v = v0 (1 - n / n_star)**2.5 fitted where neighbours are weak: v0 in V, n_star, its error, |
    |                | what theory expects of a kick of the first bead, first and last bead, largest relative     |
    |                | deviation; null if nowhere                                                                 |

    All but the verdict is null where no pulse stays together; agreement and beats, where recorded beads are too far
    apart to show beats.
    """
    shared, decay, verdict, system = found.shared, found.decay, found.verdict, found.problem.system
    pulse = system.holds(Fact.PULSE)
    seen = pulse and resolved(shared, system)
    final, span = shared.final, shared.span if pulse else None
    measured = np.sum(found.energies.wave, axis=1)
    exact = has_wave(system) and physics.alike(system) and not physics.gap(system) and not dissipates(system)
    return {
        "verdict": verdict.sentence,
        "state": verdict.state.value,
        "since": verdict.since,
        "expected": _estimate(verdict.expected),
        "amplitudes": {str(one): shared.agrees_from(one) if seen else None for one in AGREEMENTS},
        "arrivals": {str(one): shared.in_step_from(one) if seen else None for one in AGREEMENTS},
        "final": None if final is None else {**_with_uncertainty(final), "reduction": 1.0 - final.value},
        "range": None
        if span is None
        else {"first": span[0], "last": int(shared.bead[-1]), "least": span[1], "largest": span[2]},
        "energy_share": {
            "exact": known(float(np.sum(shared.wave_share[-1]))) if len(shared) and exact else None,
            "measured": known(float(measured[-1])) if len(measured) and pulse else None,
        },
        "beat_length": _estimate(shared.beat_length) if seen else None,
        "decay_law": None
        if decay is None
        else {
            "v0": decay.v0,
            "n_star": decay.n_star,
            "n_star_error": decay.n_star_error,
            "n_star_expected": known(decay.expected),
            "first": decay.first,
            "last": decay.last,
            "deviation": decay.deviation,
        },
    }


def pulse_entry(found: Survey, pulse: Pulse, character: Character) -> dict[str, Any]:
    """A pulse: its way, and what it is at the last bead where it was seen whole.

    | key                  | what                                                                          |
    |----------------------|-------------------------------------------------------------------------------|
    | chain, direction     | chain from 1; 1 towards higher bead numbers, -1 towards lower                 |
    | leading              | whether it is the first pulse of its chain                                    |
    | beads, first, last   | recorded beads at which it was seen, the first and the last of them           |
    | bead ... residual    | at that bead: arrival, peak velocity, speed (beads per unit time), width      |
    |                      | (full, at half maximum, beads), momentum, energy, residual against the exact  |
    |                      | wave of this peak velocity, in units of it                                    |
    | speed_excess         | relative to the exact law at this peak velocity                               |
    | variation            | (largest - smallest) / mean peak velocity over the last ten beads             |
    | solitary, fails      | whether it is the exact wave within the tolerances, or where beads differ or  |
    |                      | bear a load steady within them; and which fail: ``shape``, ``speed``,         |
    |                      | ``amplitude``, or ``decay`` where contacts or beads dissipate energy          |
    """
    scale = found.problem.scale
    return {
        "chain": pulse.chain,
        "direction": pulse.direction,
        "leading": found.leads(pulse),
        "beads": len(pulse),
        "first": int(pulse.bead[0]),
        "last": int(pulse.bead[-1]),
        "bead": character.bead,
        "arrival": character.arrival * scale.time,
        "peak_velocity": character.peak_velocity * scale.velocity,
        "speed": known(character.speed / scale.time),
        "width": known(character.width),
        "momentum": known(character.momentum * scale.momentum),
        "energy": known(character.energy * scale.energy),
        "residual": known(character.residual),
        "speed_excess": known(character.speed_excess),
        "variation": known(character.variation),
        "solitary": character.solitary,
        "fails": list(character.fails),
    }


def last_clear_bead(waves: Waves, problem: Problem) -> int:
    """Position of the last bead that the pulse passed undisturbed by the end that it runs to, five beads before it.

    That of the first bead passed, where it passed none so far from that end.
    """
    way = along_the_way(problem, waves.bead)
    clear = np.where(way <= max(problem.beads - CLEAR, 1), way, 0)
    return int(np.argmax(clear)) if clear.any() else int(np.argmin(way))


def _chain_summary(waves: Waves, problem: Problem, chain: int) -> dict[str, Any]:
    own, scale = waves.of_chain(chain), problem.scale
    if len(own) == 0:
        return {"chain": chain, "beads_reached": 0}
    last = last_clear_bead(own, problem)
    return {
        "chain": chain,
        "beads_reached": len(own),
        "bead": int(own.bead[last]),
        "arrival": known(float(own.arrival[last] * scale.time)),
        "peak_velocity": float(own.peak_velocity[last] * scale.velocity),
        "speed": known(float(own.speed[last] / scale.time)),
        "peak_velocity_reduced": float(own.peak_velocity[last]),
        "arrival_reduced": known(float(own.arrival[last])),
        "peak_velocity_error": known(float(own.peak_velocity_error[last] * scale.velocity)),
        "arrival_error": known(float(own.arrival_error[last] * scale.time)),
    }


def _estimate(estimate: Estimate | None) -> dict[str, float] | None:
    return None if estimate is None else _with_uncertainty(estimate)


def _with_uncertainty(estimate: Estimate) -> dict[str, float]:
    return {"value": estimate.value, "uncertainty": estimate.uncertainty}
