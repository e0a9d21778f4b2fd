"""The energy that pulses carry where beads differ."""

import math
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any

from analysis.shape.pattern import period_of
from analysis.sharing.cells import FinalEnergy, Left, Split, left
from analysis.sharing.survey import Survey
from lammps_inputs.facts import Fact
from lammps_inputs.numbers import known
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.findings.finding import MOST_CHAINS, Finding, Measure

SMALLEST_LOSS = 1e-8
"""Share of the energy per cell that is told; what frames and time steps blur is less."""


@dataclass(frozen=True)
class Cells(Finding):
    """Energy of the pulses, what stays in cells, and what a replaced bead reflects.

    Attributes:
        beads: of a cell.
        left: per chain.
        ends: per chain: largest kinetic energy of its last bead.
        splits: per replaced bead.
    """

    key = "cells"

    beads: int
    left: tuple[Left | None, ...]
    ends: tuple[float | None, ...]
    splits: tuple[Split, ...]

    def plain(self) -> dict[str, Any]:
        """Energies in shares of the energy input.

        | key         | what                                                                                      |
        |-------------|-------------------------------------------------------------------------------------------|
        | beads       | of a cell: what the pattern repeats                                                       |
        | left_behind | residual energy per cell: lost by the pulse of the kicked chain from one cell to the next |
        |             | between the beads below; null where cells there are not all alike, and where energy also  |
        |             | goes to other chains or is dissipated                                                     |
        | chains      | per chain: ``first``, ``last``: the beads, ``carried``: energy of its leading pulse at    |
        |             | the last (of the beads within three cells of its peak), ``per_cell``: residual energy;    |
        |             | ``rate``: share of its own energy that it loses in a cell, by the exponential law fitted  |
        |             | there, ``deviation``: the law's largest relative one; null: no pulse ran there            |
        | last_bead   | per chain: largest kinetic energy of the bead at its end; null where no pulse came there  |
        | replaced    | per replaced bead: energy of its chain in beads of lower numbers (``before``), ``at`` it, |
        |             | and in beads of higher numbers (``beyond``) at the end; ``incident``: of the leading      |
        |             | pulse before it; ``reflected``: of that, what is on its side at the end; null where that  |
        |             | is not all that came of this pulse alone                                                  |
        """
        kicked = self.left[self.problem.hardest_blow[0] - 1]
        return {
            "beads": self.beads,
            "left_behind": None if kicked is None else known(kicked.per_cell),
            "chains": [None if one is None else _known(asdict(one)) for one in self.left],
            "last_bead": list(self.ends),
            "replaced": [_known(asdict(split)) for split in self.splits],
        }

    def said(self) -> Iterator[str]:
        """The energy of the pulse of each chain, and where the energy is as seen from a replaced bead."""
        cell = "bead" if self.beads == 1 else f"cell of {self.beads} beads"
        for chain, (one, end) in enumerate(zip(self.left[:MOST_CHAINS], self.ends, strict=False), 1):
            if one is not None:
                line = f"chain {chain}: the leading pulse has {one.carried:.2%} of the energy input at bead {one.last}"
                if math.isfinite(one.per_cell):
                    small = one.per_cell <= SMALLEST_LOSS
                    lost = f"less than {SMALLEST_LOSS:.0e}" if small else f"{one.per_cell:.1e}"
                    line += f"; from bead {one.first} on {lost} of the energy input stays in each {cell}"
                yield line
            if end is not None:
                yield f"chain {chain}: largest kinetic energy of its last bead {end:.2%} of the energy input"
        for split in self.splits[:MOST_CHAINS]:
            yield (
                f"bead {split.bead} of chain {split.chain}: at the end its chain has {split.before:.2%} of the energy "
                f"input in beads before it, {split.at:.2%} in it, {split.beyond:.2%} in beads beyond"
            )
            if math.isfinite(split.reflected):
                yield f"  it reflects {split.reflected:.2%} of the energy input; {split.incident:.2%} is incident"


def measure(directory: RunDirectory) -> Measure | None:
    """Of all beads, where a pulse stays together and no sound runs."""
    problem, scene = directory.problem, directory.scene
    if not problem.whole or problem.alike or not (problem.holds(Fact.PULSE) and problem.holds(Fact.SONIC_VACUUM)):
        return None
    final = FinalEnergy(problem)

    def finish(found: Survey) -> Cells:
        chains, beads = range(1, problem.chains + 1), period_of(problem)
        return Cells(
            problem,
            beads,
            tuple(left(found, chain, beads) for chain in chains),
            tuple(final.end(found, chain) for chain in chains),
            tuple(final.split(found, one.chain, one.bead) for one in scene.replace or ()),
        )

    return Measure(finish, final.add)


def _known(data: dict[str, Any]) -> dict[str, Any]:
    return {key: known(value) if isinstance(value, float) else value for key, value in data.items()}
