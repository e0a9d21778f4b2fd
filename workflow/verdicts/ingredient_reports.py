"""Keys of ``analysis.json`` that only some scenes have: of the energy, of unequal beads, of gauges."""

from dataclasses import asdict
from typing import Any

from analysis.gauges.far_end import FarEnd
from analysis.gauges.readings import Readings
from analysis.sharing.cells import CellEnergy
from analysis.sharing.energy_flow import Flow
from analysis.trajectory import Floats
from lammps_inputs import Problem
from lammps_inputs.numbers import known


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
            name: [[known(value) for value in row] for row in getattr(flow, name).tolist()]
            for name in ("share", "centre", "spread")
        },
    }


def cells_report(problem: Problem, cells: CellEnergy) -> dict[str, Any]:
    """What ``analysis.json`` says under ``cells``, where beads differ; energies in shares of what was put in.

    | key         | what                                                                                          |
    |-------------|-----------------------------------------------------------------------------------------------|
    | beads       | of a cell: what the pattern repeats                                                           |
    | left_behind | energy that the pulse of the chain that was hit hardest leaves in every cell                  |
    | chains      | per chain: that, between which beads, and what the pulse carries at the last; null: none ran; |
    |             | rate: share of its own energy that it loses in a cell, by the exponential law fitted there,   |
    |             | and the law's largest relative deviation                                                      |
    | last_bead   | per chain: largest kinetic energy of the bead at its end; null where no pulse came there      |
    | replaced    | per replaced bead: energy of its chain before, at and beyond it at the end; incident: of the  |
    |             | pulse as it came near; reflected: of that, what is on its side at the end                     |
    """
    found = [cells.left(chain) for chain in range(1, problem.chains + 1)]
    hit = found[max(problem.struck, key=lambda blow: abs(blow[2]))[0] - 1]
    return {
        "beads": cells.period,
        "left_behind": None if hit is None else known(hit.per_cell),
        "chains": [None if left is None else _known(asdict(left)) for left in found],
        "last_bead": [cells.end(chain) for chain in range(1, problem.chains + 1)],
        "replaced": [_known(asdict(split)) for split in cells.splits()],
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
                "at": known(float(readings.largest_at[chain, place] * scale.time)),
                "impulse": float(readings.impulse[chain, place] * scale.momentum),
                "dwell": float(readings.dwell[chain, place] * scale.time),
                "contacts": int(readings.contacts[chain, place]),
            }
            if gauge.kind == "wall":
                entry["restitution"] = known(float(restitution[gauge.side][chain]))
            entries.append(entry)
    return entries


def far_end_report(problem: Problem, end: FarEnd) -> dict[str, Any]:
    """What ``analysis.json`` says under ``far_end``, see `analysis.gauges.far_end`, in the scene's units."""
    scale = problem.scale
    worth = {"wall_force": scale.force, "wall_force_chain": scale.force, "delay": scale.time}
    return {name: known(value * worth.get(name, 1.0)) for name, value in end.result().items()}


def _known(data: dict[str, Any]) -> dict[str, Any]:
    return {key: known(value) if isinstance(value, float) else value for key, value in data.items()}
