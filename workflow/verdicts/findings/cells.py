"""What the pulse leaves behind where beads differ."""

import math
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from analysis.sharing.cells import CellEnergy
from lammps_inputs.facts import Fact
from lammps_inputs.ingredients.unequal import period
from lammps_inputs.numbers import known
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.findings.finding import MOST_CHAINS, Finding, Measure

SMALLEST_LOSS = 1e-8
"""Share of the energy per cell that is told; what frames and time steps blur is less."""

MOSTLY = 0.9
"""Share of the beads from which on a chain is one of equal beads but for a few."""


@dataclass(frozen=True)
class Cells(Finding):
    """Energy that stays in cells, and what a replaced bead sends back."""

    key = "cells"

    cells: CellEnergy

    def plain(self) -> dict[str, Any]:
        """Energies in shares of what was put in.

        | key         | what                                                                                      |
        |-------------|-------------------------------------------------------------------------------------------|
        | beads       | of a cell: what the pattern repeats                                                       |
        | left_behind | energy that the pulse of the chain that was hit hardest leaves in every cell              |
        | chains      | per chain: that, between which beads, and what the pulse carries at the last; null: none  |
        |             | ran; rate: share of its own energy that it loses in a cell, by the exponential law fitted |
        |             | there, and the law's largest relative deviation                                           |
        | last_bead   | per chain: largest kinetic energy of the bead at its end; null where no pulse came there  |
        | replaced    | per replaced bead: energy of its chain before, at and beyond it at the end; incident: of  |
        |             | the pulse as it came near; reflected: of that, what is on its side at the end             |
        """
        cells, chains = self.cells, range(1, self.problem.chains + 1)
        found = [cells.left(chain) for chain in chains]
        hit = found[self.problem.hardest_blow[0] - 1]
        return {
            "beads": cells.period,
            "left_behind": None if hit is None else known(hit.per_cell),
            "chains": [None if left is None else _known(asdict(left)) for left in found],
            "last_bead": [cells.end(chain) for chain in chains],
            "replaced": [_known(asdict(split)) for split in cells.splits()],
        }

    def said(self) -> Iterator[str]:
        """What the pulse of each chain leaves behind, and where the energy is as seen from a replaced bead."""
        cells, mass = self.cells, np.asarray(self.problem.mass)
        alike = cells.period == 1 and np.mean(mass == np.median(mass)) > MOSTLY
        cell = "bead" if cells.period == 1 else f"cell of {cells.period} beads"
        for chain in range(1, min(self.problem.chains, MOST_CHAINS) + 1):
            left = cells.left(chain)
            if left is not None and math.isfinite(left.per_cell):
                lost = f"{left.per_cell:.1e}" if left.per_cell > SMALLEST_LOSS else f"less than {SMALLEST_LOSS:.0e}"
                # where single beads differ, nothing is left in cell after cell
                more = "" if alike else f"; from bead {left.first} on it has left {lost} of it in every {cell}"
                yield f"chain {chain}: the pulse carries {left.carried:.2%} of the energy at bead {left.last}{more}"
            final = cells.end(chain)
            if final is not None:
                yield f"chain {chain}: its last bead has had up to {final:.2%} of the energy, as motion"
        for split in cells.splits()[:MOST_CHAINS]:
            yield (
                f"bead {split.bead} of chain {split.chain}: at the end {split.before:.2%} of the energy is before it, "
                f"{split.at:.2%} in it, {split.beyond:.2%} beyond"
            )
            if math.isfinite(split.reflected):
                yield f"  of {split.incident:.2%} that the pulse brought it has sent {split.reflected:.2%} back"


def measure(directory: RunDirectory) -> Measure | None:
    """Of all beads, where a pulse stays together and no sound runs."""
    problem, scene = directory.problem, directory.scene
    if not problem.whole or problem.alike or not (problem.holds(Fact.PULSE) and problem.holds(Fact.SONIC_VACUUM)):
        return None
    cells = CellEnergy(problem, period(scene), tuple((one.chain, one.bead) for one in scene.replace or ()))
    return Measure(lambda _: Cells(problem, cells), cells.add)


def _known(data: dict[str, Any]) -> dict[str, Any]:
    return {key: known(value) if isinstance(value, float) else value for key, value in data.items()}
