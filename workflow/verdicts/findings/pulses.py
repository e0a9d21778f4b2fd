"""What pulses leave: energy in unlike beads, and motion behind a window."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

from analysis.shape.long_waves import period_of
from analysis.sharing.cells import CellEnergies, FinalEnergy, left
from analysis.sharing.survey import Survey
from analysis.tracking.undisturbed import BehindWindow, Residual
from lammps_inputs import physics
from lammps_inputs.facts import Fact
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.findings.finding import MOST_CHAINS, Finding, Measure

SMALLEST_LOSS = 1e-8
"""Smallest share of the energy per cell that is printed; below it frames and time steps decide."""


@dataclass(frozen=True)
class Cells(Finding):
    """Energy of the pulses, what stays in cells, and what a replaced bead reflects."""

    key, kind = "cells", CellEnergies

    found: CellEnergies

    def said(self) -> Iterator[str]:
        """The energy of the pulse of each chain, and where the energy is as seen from a replaced bead."""
        found = self.found
        cell = "bead" if found.beads == 1 else f"cell of {found.beads} beads"
        for chain, (one, end) in enumerate(zip(found.chains[:MOST_CHAINS], found.last_bead, strict=False), 1):
            if one is not None:
                line = f"chain {chain}: the leading pulse has {one.carried:.2%} of the energy input at bead {one.last}"
                if math.isfinite(one.per_cell):
                    small = one.per_cell <= SMALLEST_LOSS
                    lost = f"less than {SMALLEST_LOSS:.0e}" if small else f"{one.per_cell:.1e}"
                    line += f"; from bead {one.first} on {lost} of the energy input remains in each {cell}"
                yield line
            if end is not None:
                yield f"chain {chain}: largest kinetic energy of its last bead {end:.2%} of the energy input"
        for split in found.replaced[:MOST_CHAINS]:
            yield (
                f"bead {split.bead} of chain {split.chain}: at the end its chain has {split.before:.2%} of the energy "
                f"input in beads before it, {split.at:.2%} in it, {split.beyond:.2%} in beads beyond"
            )
            if math.isfinite(split.reflected):
                yield f"  it reflects {split.reflected:.2%} of the energy input; {split.incident:.2%} is incident"

    @classmethod
    def measure(cls, directory: RunDirectory) -> Measure | None:
        """Of all beads, where a pulse stays together and no sound runs."""
        problem, scene = directory.problem, directory.scene
        system = problem.system
        if (
            not problem.whole
            or physics.alike(system)
            or not (system.holds(Fact.PULSE) and system.holds(Fact.SONIC_VACUUM))
        ):
            return None
        final = FinalEnergy(problem)

        def finish(found: Survey) -> Cells:
            chains, beads = range(1, problem.chains + 1), period_of(system)
            each = tuple(left(found, chain, beads) for chain in chains)
            kicked = each[physics.largest_excitation(system)[0] - 1]
            energies = CellEnergies(
                beads=beads,
                residual_energy=math.nan if kicked is None else kicked.per_cell,
                chains=each,
                last_bead=tuple(final.end(found, chain) for chain in chains),
                replaced=tuple(final.split(found, one.chain, one.bead) for one in scene.replace or ()),
            )
            return cls(problem, energies)

        return Measure(finish, final.add)


@dataclass(frozen=True)
class Window(Finding):
    """Whether it could catch up."""

    key, kind = "window", Residual

    found: Residual

    def said(self) -> Iterator[str]:
        """The sentence."""
        yield self.found.sentence

    @classmethod
    def measure(cls, directory: RunDirectory) -> Measure | None:
        """Where there is a window."""
        problem = directory.problem
        if problem.window is None:
            return None
        behind = BehindWindow()
        return Measure(lambda found: cls(problem, behind.result(found.waves)), behind.add)
