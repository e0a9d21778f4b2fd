"""The table that an analysis writes, ``waves.csv``."""

import numpy as np

from analysis.mirror import mirrored_bead
from analysis.quantity import declare, result, table, to_csv
from analysis.sharing.survey import Survey
from analysis.tracking.leading_waves import Waves
from analysis.trajectory import Floats

WAVES = "waves.csv"


@result
class WavesTable(Waves):
    """The leading wave of each chain at each bead."""

    lag: Floats = declare("arrival behind the wave of the kicked chain", "time", "either arrival is undefined")
    width: Floats = declare(
        "full width of the velocity at half its maximum", "beads", "the passage is not recorded whole"
    )
    residual: Floats = declare(
        "largest difference from the velocity of the exact wave of this peak velocity, over that",
        undefined="the passage is not recorded whole, or there is no exact wave",
    )
    chain_energy: Floats = declare(
        "energy of the chain, with half of its springs', when the waves (on average) pass this bead",
        "energy",
        "not all beads are recorded, or not all waves passed",
    )
    wave_energy: Floats = declare(
        "energy within 3 beads of the wave's peak at that time",
        "energy",
        "not all beads are recorded, not all waves passed, or another pulse is as near",
    )


def waves_csv(found: Survey) -> str:
    """The contents of ``waves.csv``, in the scene's units; errors stand last."""
    chain_energy, wave_energy = (share * found.shared.energy for share in _energies(found))
    shape = found.shape
    made = WavesTable(
        **vars(found.waves),
        lag=_lag(found),
        width=shape.width,
        residual=shape.residual,
        chain_energy=chain_energy,
        wave_energy=wave_energy,
    )
    columns = table(made, found.problem.scale)
    for heading in [heading for heading in columns if heading.startswith(("arrival_error", "peak_velocity_error"))]:
        columns[heading] = columns.pop(heading)
    return to_csv(columns)


def _lag(found: Survey) -> Floats:
    """[wave] arrival behind the wave of the chain that was hit at the same bead; NaN where that was not seen."""
    waves = found.waves
    hit = waves.of_chain(found.shared.kicked + 1)
    arrival = dict(zip(hit.bead.tolist(), hit.arrival.tolist(), strict=True))
    return waves.arrival - np.array([arrival.get(bead, np.nan) for bead in waves.bead.tolist()], dtype=np.float64)


def _energies(found: Survey) -> tuple[Floats, Floats]:
    """[wave] shares of the energy, see `analysis.sharing.energies`; NaN where not measured."""
    waves, problem = found.waves, found.problem
    bead = found.shared.bead[found.energies.place]
    if found.direction < 0:
        bead = mirrored_bead(problem, bead)
    tables = np.full((2, problem.chains, problem.beads + 1), np.nan)
    tables[0][:, bead], tables[1][:, bead] = found.energies.chain.T, found.energies.wave.T
    return tables[0, waves.chain - 1, waves.bead], tables[1, waves.chain - 1, waves.bead]
