"""What chains of unlike beads do to a pulse: the energy that it carries, loses from cell to cell, and splits at a bead.

The energy of a pulse is that of the beads near its peak (`analysis.shape.waveforms.reach`), as it passes a bead. A cell
is the least piece of a pattern that repeats, one bead without one.
"""

import math

import numpy as np

from analysis import motion
from analysis.quantity import declare, result
from analysis.shape.long_waves import repeats_between
from analysis.shape.waveforms import reach
from analysis.sharing.equipartition import dissipates
from analysis.sharing.survey import Survey
from analysis.tracking.pulses import Pulse
from analysis.tracking.undisturbed import CLEAR
from analysis.trajectory import Floats, Integers, Trajectory, along_the_way, direction_of
from lammps_inputs import Problem, physics

AT_REST = 0.01
"""Share of the incident energy up to which a bead has let go of a pulse."""


INPUT = "energy input"
"""Unit of shares."""

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
    chains: tuple[Left | None, ...] = declare("of each chain", undefined="no pulse ran there")
    last_bead: tuple[float | None, ...] = declare(
        "largest kinetic energy of the last bead of each chain", INPUT, "no pulse came there"
    )
    replaced: tuple[Split, ...] = declare("of each replaced bead")


def left(found: Survey, chain: int, period: int) -> Left | None:
    """What the leading pulse of a chain, from 1, lost on the second half of its way; None if it ran nowhere."""
    problem = found.problem
    way, share, pulse = _along(found, chain)
    clear = way <= problem.beads - CLEAR
    way, share, pulse = way[clear], share[clear], pulse[clear]
    if len(way) == 0:
        return None
    last = int(way[-1])
    like = ((last - way) % period == 0) & (pulse == pulse[-1])
    way, share = way[like], share[like]
    start = int(np.argmin(np.abs(way - last / 2.0)))
    way, share = way[start:], share[start:]
    cells = (last - int(way[0])) // period
    ends = along_the_way(problem, int(way[0])), along_the_way(problem, last)
    low, high = min(ends) - reach(problem), max(ends) + reach(problem)
    alone = len(physics.tied_to(problem.system, chain - 1)) == 1 and not dissipates(problem.system)
    if not (cells and alone and repeats_between(problem.system, chain - 1, low, high, period)):
        return Left(*ends, float(share[-1]), math.nan, math.nan, math.nan)
    return Left(*ends, float(share[-1]), float(share[0] - share[-1]) / cells, *_law((way - way[0]) / period, share))


def _along(found: Survey, chain: int) -> tuple[Integers, Floats, Integers]:
    """Beads that leading pulses pass clear of the kicked ones, along their way.

    Also their share of the energy input there, and the number of the pulse; each [bead].
    """
    problem, in_chain = found.problem, found.waves.chain == chain
    way, pulse = along_the_way(problem, found.waves.bead[in_chain]), found.waves.pulse[in_chain]
    share = found.shape.energy[in_chain] / found.shared.energy
    order = np.argsort(way)
    way, share, pulse = way[order], share[order], pulse[order]
    kicked = [
        along_the_way(problem, bead)
        for _, bead, excitation in physics.excitations(problem.system)
        if excitation * found.direction > 0.0
    ]
    known = np.isfinite(share) & (way > max(kicked) + reach(problem))  # none of the energy of kicked beads
    return way[known], share[known], pulse[known]


def _law(cell: Floats, share: Floats) -> tuple[float, float]:
    """Rate of the exponential that the energy follows at beads that are whole cells apart, and how closely."""
    if len(cell) < 3 or not np.all(share > 0.0):
        return math.nan, math.nan
    slope, start = np.polyfit(cell, np.log(share), 1)
    return float(-np.expm1(slope)), float(np.max(np.abs(share / np.exp(start + slope * cell) - 1.0)))


class FinalEnergy:
    """Energy of the beads in the last frame, and the largest kinetic energy of those at the far end.

    Of a run of all beads that is given block by block.
    """

    def __init__(self, problem: Problem) -> None:
        self._last = -1 if direction_of(problem) > 0 else 0
        self.beads: Floats | None = None
        self._end = np.zeros(problem.chains)

    def add(self, block: Trajectory) -> None:
        """Take the next frames, from the first of the run on."""
        self.beads = motion.bead_energy(block.system_at(-1), block.displacement[-1], block.velocity[-1])
        mass = physics.mass_of(block.problem.system, slice(None), self._last)
        self._end = np.maximum(self._end, np.max(0.5 * mass * block.velocity[..., self._last] ** 2, axis=0))

    def end(self, found: Survey, chain: int) -> float | None:
        """Of the last bead on the pulse's way, in that of the energy input; None if no pulse came there."""
        way = along_the_way(found.problem, found.waves.bead[found.waves.chain == chain])
        arrived = found.problem.beads in way and found.shared.energy > 0.0
        return float(self._end[chain - 1] / found.shared.energy) if arrived else None

    def split(self, found: Survey, chain: int, bead: int) -> Split:
        """Where the energy is at the end, seen from a bead."""
        assert self.beads is not None
        share = self.beads[chain - 1] / found.shared.energy
        before, at, beyond = float(share[: bead - 1].sum()), float(share[bead - 1]), float(share[bead:].sum())
        here, (way, carried, _) = along_the_way(found.problem, bead), _along(found, chain)
        come = np.flatnonzero(way < here - reach(found.problem))
        incident = float(carried[come[-1]]) if len(come) else math.nan
        gone = beyond if found.direction > 0 else before
        reflected = incident - at - gone if _only_once(found, chain, bead) and at < AT_REST * incident else math.nan
        return Split(chain, bead, before, at, beyond, incident, reflected)


def _only_once(found: Survey, chain: int, bead: int) -> bool:
    """Whether the leading pulse, and nothing else, has come to a bead and passed on, and no energy is lost."""
    problem, here = found.problem, along_the_way(found.problem, bead)
    alone = len(physics.tied_to(problem.system, chain - 1)) == 1 and not dissipates(problem.system)
    kicked = all(
        along_the_way(problem, kicked_bead) < here
        for at, kicked_bead, _ in physics.excitations(problem.system)
        if at == chain
    )
    way, *_ = _along(found, chain)
    passed = bool(np.any(way > here + CLEAR))
    others = [pulse for pulse in found.pulses if pulse.chain == chain and not found.leads(pulse)]
    return alone and kicked and passed and not any(_crosses(pulse, problem, here) for pulse in others)


def _crosses(pulse: Pulse, problem: Problem, here: int) -> bool:
    """Whether a pulse runs past a bead, or is about to; numbers along the leading pulse's way."""
    first, last = (along_the_way(problem, int(bead)) for bead in pulse.bead[[0, -1]])
    ahead = CLEAR if last > first else -CLEAR
    return min(first, last + ahead) < here - 2 and max(first, last + ahead) > here + 2
