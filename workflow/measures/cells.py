"""What chains of unlike beads do to a pulse: the energy that it carries, loses from cell to cell, and splits at a bead.

The energy of a pulse is that of the beads near its peak (`analysis.shape.waveforms.reach`), as it passes a bead. A cell
is the least piece of a pattern that repeats, one bead without one.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Self

import numpy as np

from analysis import motion
from analysis.meters import Meter, Part
from analysis.quantity import declare, result
from analysis.shape.long_waves import period_of, repeats_between
from analysis.shape.waveforms import reach
from analysis.sharing.equipartition import dissipates
from analysis.sharing.survey import Survey
from analysis.tracking.pulses import Pulse
from analysis.tracking.undisturbed import CLEAR
from analysis.trajectory import Floats, Integers, along_the_way
from lammps_inputs import Problem, physics
from lammps_inputs.facts import Fact
from workflow.measures.measurement import MOST_CHAINS, Measurement, Recorded

SMALLEST_LOSS = 1e-8
"""Smallest share of the energy per cell that is printed; below it frames and time steps decide."""

AT_REST = 0.01
"""Share of the incident energy in a bead up to which a pulse has left it."""


INPUT = "energy input"
"""Unit of shares."""

BY_FRAMES = "by the time between frames and by the run (``run_error``)"

UNLIKE_CELLS = "cells there are unlike, energy also goes to other chains or is dissipated, or the pulse ran no cell"


@result
class Left:
    """What one chain's leading pulse carries, and loses from cell to cell."""

    first: int = declare("first bead at which the pulse was compared")
    last: int = declare("last bead at which the pulse was compared, whole cells from the first")
    carried: float = declare(
        "energy of the leading pulse at the last bead (of the beads within three cells of its peak)", INPUT
    )
    per_cell: float = declare("residual energy: lost from one cell to the next between them", INPUT, UNLIKE_CELLS)
    rate: float = declare(
        "share of its own energy that the pulse loses in a cell, by the exponential law fitted between them",
        undefined=f"{UNLIKE_CELLS}; fewer than three cells",
    )
    deviation: float = declare("largest relative difference of the energy from that law", undefined="as ``rate``")
    carried_error: float = declare(f"uncertainty of ``carried`` {BY_FRAMES}", INPUT)
    per_cell_error: float = declare(
        "uncertainty of ``per_cell`` by those of the energies at both ends", INPUT, "as ``per_cell``"
    )
    rate_error: float = declare("uncertainty of ``rate`` by those of the energies", undefined="as ``rate``")


@result
class Split:
    """Where the energy of a chain is at the end, seen from one of its beads."""

    chain: int = declare("number of the chain")
    bead: int = declare("number of the replaced bead")
    before: float = declare(
        "energy of the chain in beads of lower numbers at the end; half of a contact is each bead's", INPUT
    )
    at: float = declare("energy of that bead at the end", INPUT)
    beyond: float = declare("energy of the chain in beads of higher numbers at the end", INPUT)
    incident: float = declare("energy of the leading pulse before the bead", INPUT, "it was not seen there")
    reflected: float = declare(
        "part of the incident energy that is on its side at the end",
        INPUT,
        "chains are coupled or lose energy; anything but that pulse has crossed the bead or is about to; or the bead "
        "still has part of it",
    )
    incident_error: float = declare(f"uncertainty of ``incident`` {BY_FRAMES}", INPUT, "as ``incident``")


@result
class CellEnergies:
    """What the leading pulses carry through unlike beads, and leave."""

    beads: int = declare("beads of a cell, what the pattern repeats", "beads")
    residual_energy: float = declare(
        "residual energy per cell: lost by the pulse of the kicked chain from one cell to the next",
        INPUT,
        UNLIKE_CELLS,
        column="residual energy per cell",
    )
    residual_energy_error: float = declare(
        f"uncertainty of ``residual_energy`` {BY_FRAMES}", INPUT, "as ``residual_energy``"
    )
    chains: tuple[Left | None, ...] = declare("of each chain", undefined="no pulse ran there")
    last_bead: tuple[float | None, ...] = declare(
        "largest kinetic energy of the last bead of each chain", INPUT, "no pulse came there, or the chains are rings"
    )
    replaced: tuple[Split, ...] = declare("of each replaced bead")


def left(survey: Survey, chain: int, period: int) -> Left | None:
    """Energy that the leading pulse of a chain, from 1, loses in the second half of its path; None without any."""
    problem = survey.problem
    position, share, error, pulse = _along(survey, chain)
    clear = position <= problem.beads - CLEAR
    position, share, error, pulse = position[clear], share[clear], error[clear], pulse[clear]
    if len(position) == 0:
        return None
    last = int(position[-1])
    like = ((last - position) % period == 0) & (pulse == pulse[-1])
    position, share, error = position[like], share[like], error[like]
    start = int(np.argmin(np.abs(position - last / 2.0)))
    position, share, error = position[start:], share[start:], error[start:]
    cells = (last - int(position[0])) // period
    ends = along_the_way(problem, int(position[0])), along_the_way(problem, last)
    low, high = min(ends) - reach(problem), max(ends) + reach(problem)
    alone = len(physics.tied_to(problem.system, chain - 1)) == 1 and not dissipates(problem.system)
    if not (cells and alone and repeats_between(problem.system, chain - 1, low, high, period)):
        unknown = math.nan
        return Left(*ends, float(share[-1]), unknown, unknown, unknown, float(error[-1]), unknown, unknown)
    rate, deviation, rate_error = _law((position - position[0]) / period, share, error)
    lost, lost_error = float(share[0] - share[-1]) / cells, float(error[0] + error[-1]) / cells
    return Left(*ends, float(share[-1]), lost, rate, deviation, float(error[-1]), lost_error, rate_error)


def _along(survey: Survey, chain: int) -> tuple[Integers, Floats, Floats, Integers]:
    """Beads that leading pulses pass clear of the kicked ones, along their way.

    Also their share of the energy input there, its uncertainty, and the number of the pulse; each [bead].
    """
    problem, in_chain = survey.problem, survey.waves.chain == chain
    position, pulse = along_the_way(problem, survey.waves.bead[in_chain]), survey.waves.pulse[in_chain]
    share, error = (
        values[in_chain] / survey.shared.energy for values in (survey.shape.energy, survey.shape.energy_error)
    )
    order = np.argsort(position)
    position, share, error, pulse = position[order], share[order], error[order], pulse[order]
    kicked = [
        along_the_way(problem, bead)
        for _, bead, excitation in physics.excitations(problem.system)
        if excitation * survey.direction > 0.0
    ]
    defined = np.isfinite(share) & (position > max(kicked) + reach(problem))  # none of the energy of kicked beads
    return position[defined], share[defined], error[defined], pulse[defined]


def _law(cell: Floats, share: Floats, error: Floats) -> tuple[float, float, float]:
    """Rate of the exponential law of the energy at beads that are whole cells apart, deviation from it, rate's error.

    The slope of the fitted line is a sum of logarithms with weights, whose errors are those of the energies over them.
    """
    if len(cell) < 3 or not np.all(share > 0.0):
        return math.nan, math.nan, math.nan
    slope, start = np.polyfit(cell, np.log(share), 1)
    offset = cell - np.mean(cell)
    of_slope = float(np.sum(np.abs(offset) * error / share) / np.sum(offset**2))
    deviation = float(np.max(np.abs(share / np.exp(start + slope * cell) - 1.0)))
    return float(-np.expm1(slope)), deviation, float(np.exp(slope)) * of_slope


@dataclass(frozen=True)
class FinalEnergies:
    """What the frames of a run show of the energy of beads, in units of m V**2.

    Attributes:
        beads: [chain, bead] energy of each bead in the last frame.
        last_bead: [chain] largest kinetic energy of the last bead on the way of the leading waves.
    """

    beads: Floats
    last_bead: Floats

    def at_end(self, survey: Survey, chain: int) -> float | None:
        """Largest kinetic energy of the last bead on the pulse's path over the energy input; None without a pulse or
        an end.
        """
        if survey.problem.system.closing:
            return None
        position = along_the_way(survey.problem, survey.waves.bead[survey.waves.chain == chain])
        arrived = survey.problem.beads in position and survey.shared.energy > 0.0
        return float(self.last_bead[chain - 1] / survey.shared.energy) if arrived else None

    def split(self, survey: Survey, chain: int, bead: int) -> Split:
        """Energy of a chain at the end before a bead, in it and beyond it."""
        share = self.beads[chain - 1] / survey.shared.energy
        before, at, beyond = float(share[: bead - 1].sum()), float(share[bead - 1]), float(share[bead:].sum())
        place, (position, carried, error, _) = along_the_way(survey.problem, bead), _along(survey, chain)
        come = np.flatnonzero(position < place - reach(survey.problem))
        incident, off = (float(carried[come[-1]]), float(error[come[-1]])) if len(come) else (math.nan, math.nan)
        gone = beyond if survey.direction > 0 else before
        reflected = incident - at - gone if _only_once(survey, chain, bead) and at < AT_REST * incident else math.nan
        return Split(chain, bead, before, at, beyond, incident, reflected, off)


class CellMeter(Meter[FinalEnergies, FinalEnergies]):
    """Energy of the beads in the last frame, and the largest kinetic energy of those at the far end.

    The run has all beads recorded.
    """

    def of_part(self, part: Part) -> FinalEnergies:
        """Those of a part; the energy of each bead of the last part alone."""
        block = part.frames
        last = -1 if block.problem.direction > 0 else 0
        mass = physics.mass_of(block.problem.system, slice(None), last)
        largest = np.max(0.5 * mass * block.velocity[..., last] ** 2, axis=0)
        beads = np.empty((0, 0))
        if part.is_last:
            beads = motion.bead_energy(block.system_at(-1), block.displacement[-1], block.velocity[-1])
        return FinalEnergies(beads, largest)

    def result(self, pieces: list[FinalEnergies]) -> FinalEnergies:
        """Those of the run."""
        return FinalEnergies(pieces[-1].beads, np.max([piece.last_bead for piece in pieces], axis=0))


def _only_once(survey: Survey, chain: int, bead: int) -> bool:
    """Whether the leading pulse, and nothing else, has come to a bead and passed on, and no energy is lost."""
    problem, place = survey.problem, along_the_way(survey.problem, bead)
    alone = len(physics.tied_to(problem.system, chain - 1)) == 1 and not dissipates(problem.system)
    kicked = all(
        along_the_way(problem, kicked_bead) < place
        for at, kicked_bead, _ in physics.excitations(problem.system)
        if at == chain
    )
    position, *_ = _along(survey, chain)
    passed = bool(np.any(position > place + CLEAR))
    others = [pulse for pulse in survey.pulses if pulse.chain == chain and not survey.leads(pulse)]
    return alone and kicked and passed and not any(_crosses(pulse, problem, place) for pulse in others)


def _crosses(pulse: Pulse, problem: Problem, place: int) -> bool:
    """Whether a pulse runs past a bead, or is about to; numbers along the leading pulse's way."""
    first, last = (along_the_way(problem, int(bead)) for bead in pulse.bead[[0, -1]])
    ahead = CLEAR if last > first else -CLEAR
    return min(first, last + ahead) < place - 2 and max(first, last + ahead) > place + 2


@dataclass(frozen=True, repr=False)
class CellMeasurement(Measurement):
    """Energy of the pulses, what stays in cells, and what a replaced bead reflects."""

    key, kind = "cells", CellEnergies

    values: CellEnergies

    def lines(self) -> Iterator[str]:
        """The energy of the pulse of each chain, and where the energy is as seen from a replaced bead."""
        energies = self.values
        cell = "bead" if energies.beads == 1 else f"cell of {energies.beads} beads"
        for chain, (pulse, end) in enumerate(zip(energies.chains[:MOST_CHAINS], energies.last_bead, strict=False), 1):
            if pulse is not None:
                line = f"in chain {chain} the leading pulse carries {pulse.carried:.2%} of the energy input at bead "
                line += str(pulse.last)
                if math.isfinite(pulse.per_cell):
                    small = pulse.per_cell <= SMALLEST_LOSS
                    lost = f"less than {SMALLEST_LOSS:.0e}" if small else f"{pulse.per_cell:.1e}"
                    line += f"; from bead {pulse.first} on {lost} of the energy input remains in each {cell}"
                yield line
            if end is not None:
                yield f"in chain {chain} the kinetic energy of the last bead reaches {end:.2%} of the energy input"
        for split in energies.replaced[:MOST_CHAINS]:
            yield (
                f"at the end chain {split.chain} has {split.before:.2%} of the energy input in beads before bead "
                f"{split.bead}, {split.at:.2%} in it, {split.beyond:.2%} in beads beyond it"
            )
            if math.isfinite(split.reflected):
                yield (
                    f"bead {split.bead} of chain {split.chain} reflects {split.reflected:.2%} of the energy input, of "
                    f"{split.incident:.2%} that is incident"
                )

    @classmethod
    def meter(cls, run: Recorded) -> CellMeter | None:
        """Energies of runs of all beads in which a pulse stays together and no sound runs."""
        problem = run.problem
        pulses = problem.system.holds(Fact.PULSE) and problem.system.holds(Fact.SONIC_VACUUM)
        if not (problem.rows.complete and pulses) or physics.alike(problem.system):
            return None
        return CellMeter()

    @classmethod
    def of_run(cls, run: Recorded, survey: Survey, measured: FinalEnergies | None) -> Self | None:
        """What the leading pulses carry through unlike beads, and leave."""
        if measured is None:
            return None
        system = run.problem.system
        chains, beads = range(1, run.problem.chains + 1), period_of(system)
        each = tuple(left(survey, chain, beads) for chain in chains)
        kicked = each[physics.largest_excitation(system)[0] - 1]
        energies = CellEnergies(
            beads=beads,
            residual_energy=math.nan if kicked is None else kicked.per_cell,
            residual_energy_error=math.nan if kicked is None else kicked.per_cell_error,
            chains=each,
            last_bead=tuple(measured.at_end(survey, chain) for chain in chains),
            replaced=tuple(
                measured.split(survey, replacement.chain, replacement.bead) for replacement in run.scene.replace or ()
            ),
        )
        return cls(run.problem, energies)
