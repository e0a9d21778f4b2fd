"""Keys of ``analysis.json`` that only some scenes have: of the energy, of unequal beads, of gauges, of sound."""

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from analysis.budget import Account
from analysis.gauges.far_end import FarEnd
from analysis.gauges.readings import Readings
from analysis.gauges.spectra import Spectra, drives
from analysis.shape.loaded_wave import sound_speed
from analysis.sharing.cells import CellEnergy
from analysis.sharing.energy_flow import Flow
from analysis.sound.dispersion import Map, NoDispersionError, cell_of
from analysis.sound.loaded_pulse import LoadedWave
from analysis.tracking.pulses import Pulse
from analysis.trajectory import Floats
from lammps_inputs import Problem, laws
from lammps_inputs.limits import rates
from lammps_inputs.numbers import known
from lammps_inputs.units import Scale


@dataclass(frozen=True)
class ClosedBudget:
    """The energy of a run over time, and how well it is known.

    Attributes:
        account: where it is, what was lost, and what was put in.
        missing: largest of it that is nowhere, in shares of the most that was put in.
        unsure: how well it is known what was lost and put in between frames, likewise.
        stated: error of the velocities that the run states, in units of V; None where it states none.
    """

    account: Account
    missing: float
    unsure: float
    stated: float | None

    @property
    def sentence(self) -> str:
        """How well it is closed, in one line."""
        own = "" if self.stated is None else f"; the run is right to {self.stated:.1e} V"
        return (
            f"budget closed to {self.missing:.1e} of what was put in; what happened between frames is known to "
            f"{self.unsure:.1e} of it{own}"
        )


def budget_report(problem: Problem, budget: ClosedBudget) -> dict[str, Any]:
    """What ``analysis.json`` says under ``budget``, where energy is lost or put in; in the scene's units.

    | key       | what                                                                                            |
    |-----------|-------------------------------------------------------------------------------------------------|
    | time      | of some frames                                                                                  |
    | put_in    | until then, by kicks and by forces from outside                                                 |
    | kinetic, contacts, springs, ground | where it is                                                            |
    | lost      | until then, in each kind of dashpots                                                            |
    | missing   | what was put in and is nowhere                                                                  |
    | closed    | largest of that in any frame, in the most that was put in                                       |
    | between_frames | how well it is known what was exchanged between frames, likewise                           |
    | stated    | error of the velocities that the run states, in V; null where it states none                    |
    """
    return {
        **budget.account.plain(problem.scale),
        "closed": known(budget.missing),
        "between_frames": known(budget.unsure),
        "stated": budget.stated,
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
    hit = found[problem.hardest_blow[0] - 1]
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
    | static        | only under a static load: force at rest, which ``largest`` includes                         |
    | dynamic       | likewise: ``largest`` without it                                                            |
    | impulse       | integral of the force, but for that at rest, over time; what a wall takes of the momentum   |
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
                **_above_rest(readings, chain, place, scale),
                "impulse": float(readings.impulse[chain, place] * scale.momentum),
                "dwell": float(readings.dwell[chain, place] * scale.time),
                "contacts": int(readings.contacts[chain, place]),
            }
            if gauge.kind == "wall":
                entry["restitution"] = known(float(restitution[gauge.side][chain]))
            entries.append(entry)
    return entries


def _above_rest(readings: Readings, chain: int, place: int, scale: Scale) -> dict[str, float]:
    if not np.any(readings.static):
        return {}
    static, largest = readings.static[chain, place], readings.largest[chain, place]
    return {"static": float(static * scale.force), "dynamic": float((largest - static) * scale.force)}


def sound_report(
    problem: Problem, wave: LoadedWave | None, crests: tuple[Pulse, ...], metres: float | None
) -> dict[str, Any]:
    """What ``analysis.json`` says under ``sound``, of chains under a static load, in the scene's units.

    | key       | what                                                                                            |
    |-----------|-------------------------------------------------------------------------------------------------|
    | load      | least and largest force of a contact at rest                                                    |
    | overlap   | at rest, of those                                                                               |
    | speed     | of sound of long waves, beads per unit time, least and largest along the chains; null where     |
    |           | springs to the ground hold beads, which long waves then do not move                             |
    | metres    | the same in m/s where all beads are of one material and size; else null                         |
    | cutoff    | highest angular frequency of small motions; where beads or loads do not repeat along the chains |
    |           | it is at most this, but for springs                                                             |
    | crest     | largest velocity of crests of sound, which are no pulses (analysis/README.md); null without any   |
    | pulse     | the leading pulse of the chain that was hit hardest, between the contacts ``first`` and ``last``: |
    |           | ``force_ratio`` f of the largest force to that at rest, ``speed``, ``over_sound``, ``theory``:  |
    |           | that of the long-wave theory (Nesterenko), and ``over_theory``: the quotient; null: too short   |
    """
    scale, law = problem.scale, problem.along[0].law
    load, rest = (np.asarray(find(law)) for find in (laws.load, laws.rest))
    speed, held = sound_speed(problem), bool(problem.held)
    range_of = [float(find(speed)) for find in (np.min, np.max)]
    return {
        "load": [float(find(load) * scale.force) for find in (np.min, np.max)],
        "overlap": [float(find(rest) * scale.length) for find in (np.min, np.max)],
        "speed": None if held else [value / scale.time for value in range_of],
        "metres": None if held or metres is None else [value * metres / scale.time for value in range_of],
        "cutoff": _cutoff(problem) / scale.time,
        "crest": max((float(crest.peak_velocity.max()) * scale.velocity for crest in crests), default=None),
        "pulse": None
        if wave is None
        else {
            **asdict(wave),
            "speed": wave.speed / scale.time,
            "sound": wave.sound / scale.time,
            "theory": known(wave.theory),
            "over_sound": wave.over_sound,
            "over_theory": known(wave.over_theory),
        },
    }


def _cutoff(problem: Problem) -> float:
    try:
        return float(cell_of(problem).bands().max())
    except NoDispersionError:
        return rates.sound_frequency(problem)


def dispersion_report(problem: Problem, found: Map | str) -> dict[str, Any]:
    """What ``analysis.json`` says under ``dispersion``, of chains under a static load, in the scene's units.

    | key      | what                                                                                    |
    |----------|-----------------------------------------------------------------------------------------|
    | why      | why there is no map; else null, and:                                                    |
    | beads    | of a cell, what repeats along the chains                                                |
    | bands    | lowest and highest angular frequency of every branch, exact                             |
    | measured | the same as the run shows them; null where it does not                                  |
    | bin      | of frequency: as sure as those are                                                      |
    """
    if isinstance(found, str):
        return {"why": found}
    unit = problem.scale.time
    measured = (found.measured_bands() / unit).tolist()
    return {
        "why": None,
        "beads": found.cell.beads,
        "bands": (found.cell.bands() / unit).tolist(),
        "measured": [[known(edge) for edge in band] for band in measured],
        "bin": found.bin / unit,
    }


def spectra_report(problem: Problem, spectra: Spectra) -> dict[str, Any]:
    """What ``analysis.json`` says under ``spectra``, in the scene's units; all spectra are in ``spectra.csv``.

    | key              | what                                                                                      |
    |------------------|-------------------------------------------------------------------------------------------|
    | after            | time from which on frames were taken                                                      |
    | resolution       | distance of two lines; swings nearer than two of it are not told apart                    |
    | beads            | entries: chain, bead, frequency and amplitude of the highest line of the velocity, and of |
    |                  | each drive ``at_drive``: frequency, amplitude, transmissibility (over that of the chain's |
    |                  | first bead; null where that does not move)                                                |
    | transmissibility | of the last bead named, in the chain of the first drive, at its frequency                 |
    | bands            | lowest and highest frequency of every branch of small waves, exact; null where the chains |
    |                  | pass on no sound, or nothing repeats along them                                           |
    """
    scale, entries = problem.scale, []
    passed_on = spectra.transmissibility
    for chain in range(problem.chains):
        for place, bead in enumerate(spectra.beads):
            top = int(np.argmax(spectra.amplitude[:, chain, place]))
            entries.append(
                {
                    "chain": chain + 1,
                    "bead": bead,
                    "frequency": float(spectra.frequency[top] / scale.time),
                    "amplitude": float(spectra.amplitude[top, chain, place] * scale.velocity),
                    "at_drive": [
                        {
                            "frequency": float(frequency / scale.time),
                            "amplitude": known(float(spectra.at_drive[k, chain, place] * scale.velocity)),
                            "transmissibility": known(float(passed_on[k, chain, place])),
                        }
                        for k, frequency in enumerate(spectra.drive)
                    ],
                }
            )
    found = None
    for chain, _, frequency in drives(problem)[:1]:
        found = known(float(passed_on[np.searchsorted(spectra.drive, frequency), chain - 1, -1]))
    return {
        "after": spectra.after * scale.time,
        "resolution": float((spectra.frequency[1] - spectra.frequency[0]) / scale.time),
        "transmissibility": found,
        "bands": _bands(problem),
        "beads": entries,
    }


def _bands(problem: Problem) -> list[list[float]] | None:
    try:
        bands = cell_of(problem).bands() / (2.0 * np.pi * problem.scale.time)
    except NoDispersionError:
        return None
    return [[float(edge) for edge in band] for band in bands]


def far_end_report(problem: Problem, end: FarEnd) -> dict[str, Any]:
    """What ``analysis.json`` says under ``far_end``, see `analysis.gauges.far_end`, in the scene's units."""
    scale = problem.scale
    worth = {"wall_force": scale.force, "wall_force_chain": scale.force, "delay": scale.time}
    return {name: known(value * worth.get(name, 1.0)) for name, value in end.result().items()}


def _known(data: dict[str, Any]) -> dict[str, Any]:
    return {key: known(value) if isinstance(value, float) else value for key, value in data.items()}
