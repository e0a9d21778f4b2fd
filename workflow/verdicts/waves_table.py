"""The table that an analysis writes, ``waves.csv``."""

import numpy as np

from analysis.mirror import mirrored_bead
from analysis.sharing.survey import Survey
from analysis.tracking.leading_waves import to_csv
from analysis.trajectory import Floats


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
    | width         | full width at half maximum of the velocity, beads; empty where speed is not positive  |
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
