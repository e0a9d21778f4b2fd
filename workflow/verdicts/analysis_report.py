"""What an analysis writes: the columns of ``waves.csv`` and the keys of ``analysis.json``."""

import math
from dataclasses import asdict
from typing import Any

import numpy as np

from analysis.conservation import Conservation
from analysis.gauges.forces import Readings
from analysis.mirror import mirrored_bead
from analysis.sharing.cells import CellEnergy
from analysis.sharing.energy_flow import Flow
from analysis.sharing.equipartition import AGREEMENTS, CLEAR, Estimate
from analysis.sharing.is_solitary import Character, Tolerances
from analysis.sharing.survey import Survey
from analysis.tracking.leading_waves import Waves, to_csv
from analysis.tracking.left_behind import LeftBehind
from analysis.tracking.pulses import Pulse
from analysis.tracking.train import Train, train_of
from analysis.trajectory import Floats
from lammps_inputs import Problem


def waves_csv(found: Survey) -> str:
    """The contents of ``waves.csv``: the leading wave of each chain at each bead, in the scene's units.

    In SI the header names the units: ``arrival (s)``.

    | column        | what                                                                                  |
    |---------------|---------------------------------------------------------------------------------------|
    | chain, bead   | counted from 1                                                                        |
    | arrival       | time at which the bead is fastest, or centre of the impulse; empty if not defined     |
    | peak_velocity | largest velocity; positive along the pulse's way, whichever that is                   |
    | speed         | beads per unit time, from the arrivals on either side                                 |
    | lag           | arrival behind the wave of the chain that was hit                                     |
    | width         | full width at half maximum of the velocity, beads                                     |
    | residual      | largest difference from the exact wave of this peak velocity, in units of it          |
    | chain_energy  | energy of the chain when the waves (on average) pass this bead, half of its springs'  |
    | wave_energy   | energy within 3 beads of the wave's peak at that time                                 |
    | arrival_error, peak_velocity_error | how far these may be off by the time between frames, or noise    |
    """
    scale, waves = found.problem.scale, found.waves
    chain_energy, wave_energy = _energies(found)
    more = {
        scale.heading("lag", "time"): _lag(found) * scale.time,
        "width": found.shape.width,
        "residual": found.shape.residual,
        scale.heading("chain_energy", "energy"): chain_energy * found.shared.energy * scale.energy,
        scale.heading("wave_energy", "energy"): wave_energy * found.shared.energy * scale.energy,
    }
    return to_csv(waves, scale, more)


def report(found: Survey, seen: Conservation, tolerances: Tolerances, left: LeftBehind | None = None) -> dict[str, Any]:
    """The contents of ``analysis.json``. Quantities are in the scene's units unless said otherwise; null is unknown.

    | key             | what                                                                             |
    |-----------------|----------------------------------------------------------------------------------|
    | complete        | whether every frame of the scene is there                                        |
    | frames          | found, and asked for                                                             |
    | front           | foremost bead that moved                                                         |
    | energy_drift    | largest relative deviation of the energy; null if not all beads were recorded    |
    | momentum_drift  | the same of the momentum                                                         |
    | units           | the scene's units: ``SI`` or ``reduced``                                         |
    | scale           | worth of the dimensionless units of mass, length, time, velocity in the scene's  |
    | kappa           | dimensionless coupling at V = 1                                                  |
    | arrival         | what an arrival of a wave is: ``maximum`` or ``impulse``                         |
    | noise           | standard deviation of the recorded velocities, in V; 0 for none                  |
    | window          | rows; largest velocity, in V, of a bead when it was left behind, and which bead; |
    |                 | the lowest leading wave, in V, which that must not exceed; null without a window |
    | waves           | per chain: beads reached, and at the last whole one its arrival, peak velocity, speed |
    | train           | pulses that followed each other in the chain that was hit; see `train_report`    |
    | equipartition   | see `equipartition`                                                              |
    | tolerances      | relative differences within which a pulse is called solitary                     |
    | pulses          | every pulse, the strongest first; see `pulse_entry`                              |

    Where no pulse stays together, `workflow.verdicts.analyse` adds ``energy``, see `energy_report`; where beads differ,
    ``cells``, see `cells_report`. With a material it adds ``contacts``, see `workflow.runs.contacts.Contacts`; where
    the scene has ``output.forces``, ``forces``, see `forces_report`. Where frames hold all beads, ``budget`` says where
    the energy is over time, and what dashpots have taken, see `analysis.budget.Account`.
    """
    problem, scale = found.problem, found.problem.scale
    order = np.argsort([-character.peak_velocity for character in found.characters], kind="stable")
    return {
        "complete": seen.frames == problem.frames + 1,
        "frames": [seen.frames, problem.frames + 1],
        "front": seen.front,
        "energy_drift": _number(seen.energy_drift),
        "momentum_drift": _number(seen.momentum_drift),
        "units": "SI" if scale.si else "reduced",
        "scale": {"mass": scale.mass, "length": scale.length, "time": scale.time, "velocity": scale.velocity},
        "kappa": problem.kappa,
        "arrival": found.arrival,
        "noise": found.noise,
        "window": None if left is None else _window(left, found),
        "waves": [_chain_summary(found.waves, problem, chain) for chain in range(1, problem.chains + 1)],
        "train": train_report(found),
        "equipartition": equipartition(found),
        "tolerances": {name: getattr(tolerances, name) for name in ("shape", "speed", "amplitude")},
        "pulses": [pulse_entry(found, found.pulses[k], found.characters[k]) for k in order],
    }


def train(found: Survey) -> Train | None:
    """The pulses of the chain that was hit, where the leading one was last clear of the ends; None if it never was."""
    chain, beads = found.shared.kicked + 1, found.problem.beads
    own = found.waves.of_chain(chain)
    clear = own.bead[(own.bead > CLEAR) & (own.bead <= beads - CLEAR)]
    if len(clear) == 0:
        return None
    return train_of(found.pulses, chain, found.direction, int(clear.max() if found.direction > 0 else clear.min()))


def train_report(found: Survey) -> dict[str, Any] | None:
    """What ``analysis.json`` says under ``train``, in the scene's units; null if no pulse was tracked as far.

    | key            | what                                                            |
    |----------------|-----------------------------------------------------------------|
    | chain, bead    | where                                                           |
    | pulses         | number of pulses that passed it                                 |
    | arrival        | of each                                                         |
    | peak_velocity  | of each, positive along its way                                 |
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
        "ratio": seen.ratio.tolist(),
        "spacing": (seen.spacing * scale.time).tolist(),
    }


def energy_report(problem: Problem, flow: Flow) -> dict[str, Any]:
    """What ``analysis.json`` says under ``energy``, where no pulse stays together; time in the scene's units.

    | key     | what                                                                                              |
    |---------|---------------------------------------------------------------------------------------------------|
    | time    | of some frames                                                                                    |
    | share   | energy of each chain, but for springs to others, in that of all chains, [instant][chain]           |
    | between | energy in the springs between chains, in that of the kicks                                        |
    | centre  | mean number of the bead that has it; null where the chain has none                                |
    | spread  | its standard deviation                                                                            |
    """
    return {
        "time": (flow.time * problem.scale.time).tolist(),
        "between": flow.between.tolist(),
        **{
            name: [[_number(value) for value in row] for row in getattr(flow, name).tolist()]
            for name in ("share", "centre", "spread")
        },
    }


def cells_report(problem: Problem, cells: CellEnergy) -> dict[str, Any]:
    """What ``analysis.json`` says under ``cells``, where beads differ; energies in that of the kicks.

    | key         | what                                                                                          |
    |-------------|-----------------------------------------------------------------------------------------------|
    | beads       | of a cell: what the pattern repeats                                                           |
    | left_behind | energy that the pulse of the chain that was hit hardest leaves in every cell                  |
    | chains      | per chain: that, between which beads, and what the pulse carries at the last; null: none ran  |
    | replaced    | per replaced bead: energy of its chain before, at and beyond it at the end                    |
    """
    found = [cells.left(chain) for chain in range(1, problem.chains + 1)]
    hit = found[max(problem.kicks, key=lambda kick: abs(kick[2]))[0] - 1]
    return {
        "beads": cells.period,
        "left_behind": None if hit is None else _number(hit.per_cell),
        "chains": [None if left is None else {**asdict(left), "per_cell": _number(left.per_cell)} for left in found],
        "replaced": [asdict(split) for split in cells.splits()],
    }


def forces_report(problem: Problem, readings: Readings, restitution: dict[str, Floats]) -> list[dict[str, Any]]:
    """What ``analysis.json`` says under ``forces``: an entry for each gauge and chain, in the scene's units.

    | key           | what                                                                                        |
    |---------------|---------------------------------------------------------------------------------------------|
    | kind, name    | wall, contact or sensor; name of the column in ``forces.csv``                               |
    | chain, bead   | at a wall the bead that touches it; the first bead of a contact; the bead with the sensor   |
    | largest, at   | largest force, between frames too, and when; null where there was none                      |
    | impulse       | integral of the force over time; what a wall takes of the momentum                          |
    | dwell         | how long the contact lasted in which the force was largest                                  |
    | contacts      | how many contacts there were                                                                |
    | restitution   | walls only: peak velocity of the first pulse thrown back over that of the one that came, at |
    |               | one bead (`analysis.gauges.restitution`); null where one of them was not seen               |
    """
    scale, entries = problem.scale, []
    for place, gauge in enumerate(readings.gauges):
        for chain in range(problem.chains):
            entry: dict[str, Any] = {
                "kind": gauge.kind,
                "name": gauge.name,
                "chain": chain + 1,
                "bead": gauge.bead,
                "largest": float(readings.largest[chain, place] * scale.force),
                "at": _number(float(readings.largest_at[chain, place] * scale.time)),
                "impulse": float(readings.impulse[chain, place] * scale.momentum),
                "dwell": float(readings.dwell[chain, place] * scale.time),
                "contacts": int(readings.contacts[chain, place]),
            }
            if gauge.kind == "wall":
                side = "left" if gauge.bead == 1 else "right"
                entry["restitution"] = _number(float(restitution[side][chain]))
            entries.append(entry)
    return entries


def _window(left: LeftBehind, found: Survey) -> dict[str, Any]:
    return {
        "rows": found.problem.window,
        "left_behind": left.velocity,
        "bead": left.bead,
        "slowest_wave": _number(left.slowest_wave(found.waves)),
        "sentence": left.sentence(found.waves),
    }


def equipartition(found: Survey) -> dict[str, Any]:
    """How the chains share the leading pulse. Beads count from the end that was hit towards the pulse's direction.

    | key            | what                                                                                      |
    |----------------|-------------------------------------------------------------------------------------------|
    | verdict        | in words; ``state`` in one, ``since`` the bead from which on chains are equal and in step  |
    | expected       | bead of 1% agreement where it was not reached, and its uncertainty                        |
    | amplitudes     | bead from which on the mismatch, (largest - smallest) / mean, stays below 0.1, 0.01, 0.001 |
    | arrivals       | the same for the spread of arrivals over the time in which the wave passes (half height)   |
    | final          | amplitude over the last half beat in V, its uncertainty, and the reduction against V       |
    | energy_share   | of the waves at the last clear bead: exact waves of these amplitudes; measured                |
    | beat_length    | beads from one excess of a chain to the next, and its scatter                              |
    | decay_law      | v = v0 (1 - n / n_star)**2.5 fitted where neighbours are weak: v0 in V, n_star, its error, |
    |                | what theory expects, first and last bead, largest relative deviation; null if nowhere      |
    """
    shared, decay, verdict = found.shared, found.decay, found.verdict
    final = shared.final
    measured = np.sum(found.energies.wave, axis=1)
    return {
        "verdict": verdict.sentence,
        "state": verdict.state.value,
        "since": verdict.since,
        "expected": _estimate(verdict.expected),
        "amplitudes": {str(tolerance): shared.agrees_from(tolerance) for tolerance in AGREEMENTS},
        "arrivals": {str(tolerance): shared.in_step_from(tolerance) for tolerance in AGREEMENTS},
        "final": None if final is None else {**_known(final), "reduction": 1.0 - final.value},
        "energy_share": {
            "exact": _number(float(np.sum(shared.wave_share[-1]))) if len(shared) and found.problem.alike else None,
            "measured": _number(float(measured[-1])) if len(measured) else None,
        },
        "beat_length": _estimate(shared.beat_length),
        "decay_law": None
        if decay is None
        else {
            "v0": decay.v0,
            "n_star": decay.n_star,
            "n_star_error": decay.n_star_error,
            "n_star_expected": decay.expected,
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
    | solitary, fails      | whether it is the exact wave within the tolerances, and which fail            |
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
        "speed": _number(character.speed / scale.time),
        "width": _number(character.width),
        "momentum": _number(character.momentum * scale.momentum),
        "energy": _number(character.energy * scale.energy),
        "residual": _number(character.residual),
        "speed_excess": _number(character.speed_excess),
        "variation": _number(character.variation),
        "solitary": character.solitary,
        "fails": list(character.fails),
    }


def last_clear_bead(waves: Waves, problem: Problem) -> int:
    """Position of the last bead that the pulse passed undisturbed by the free end, five beads before it."""
    clear = np.flatnonzero(waves.bead <= max(problem.beads - 5, 1))
    return int(clear[-1]) if len(clear) else 0


def _chain_summary(waves: Waves, problem: Problem, chain: int) -> dict[str, Any]:
    own, scale = waves.of_chain(chain), problem.scale
    if len(own) == 0:
        return {"chain": chain, "beads_reached": 0}
    last = last_clear_bead(own, problem)
    return {
        "chain": chain,
        "beads_reached": len(own),
        "bead": int(own.bead[last]),
        "arrival": _number(float(own.arrival[last] * scale.time)),
        "peak_velocity": float(own.peak_velocity[last] * scale.velocity),
        "speed": _number(float(own.speed[last] / scale.time)),
        "peak_velocity_reduced": float(own.peak_velocity[last]),
        "arrival_reduced": _number(float(own.arrival[last])),
        "peak_velocity_error": _number(float(own.velocity_error[last] * scale.velocity)),
        "arrival_error": _number(float(own.arrival_error[last] * scale.time)),
    }


def _lag(found: Survey) -> Floats:
    """[wave] arrival behind the wave of the chain that was hit at the same bead; NaN where that was not seen."""
    waves = found.waves
    hit = waves.of_chain(found.shared.kicked + 1)
    arrival = dict(zip(hit.bead.tolist(), hit.arrival.tolist(), strict=True))
    return waves.arrival - np.array([arrival.get(bead, np.nan) for bead in waves.bead.tolist()], dtype=np.float64)


def _energies(found: Survey) -> tuple[Floats, Floats]:
    """[wave] shares of the energy, see `analysis.sharing.energy_shares`; NaN where not measured."""
    waves, problem = found.waves, found.problem
    bead = found.shared.bead[found.energies.place]
    if found.direction < 0:
        bead = mirrored_bead(problem, bead)
    tables = np.full((2, problem.chains, problem.beads + 1), np.nan)
    tables[0][:, bead], tables[1][:, bead] = found.energies.chain.T, found.energies.wave.T
    return tables[0, waves.chain - 1, waves.bead], tables[1, waves.chain - 1, waves.bead]


def _estimate(estimate: Estimate | None) -> dict[str, float] | None:
    return None if estimate is None else _known(estimate)


def _known(estimate: Estimate) -> dict[str, float]:
    return {"value": estimate.value, "uncertainty": estimate.uncertainty}


def _number(value: float) -> float | None:
    return value if math.isfinite(value) else None
