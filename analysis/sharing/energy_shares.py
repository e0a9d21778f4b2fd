"""Where the energy is as the waves run: in each chain, and inside the waves, from the states at a few instants.

The instants are those at which the waves pass chosen beads; they are picked out while the run is read a second time.
The energy of a spring is shared by its two chains. Inside a wave are the beads within
`analysis.shape.waveforms.reach` of its peak, with the contacts between them.
"""

import numpy as np
from numpy.typing import NDArray

from analysis import motion
from analysis.shape.waveforms import reach
from analysis.sharing.equipartition import Sharing
from analysis.trajectory import Floats, Trajectory
from lammps_inputs import Problem

MAX_PLACES = 400


class EnergyShares:
    """Collects energies when the chains' waves pass beads; for runs in which every bead is recorded.

    Attributes:
        place: [instant] positions in the `Sharing`, of those at which all arrivals are defined.
        chain: [instant, chain] energy of a chain, in that put in; NaN where not seen, as in a window.
        wave: [instant, chain] energy inside its leading wave, in that put in; likewise, and NaN where another pulse is
            as near. 0 where the chain has none that counts.
    """

    def __init__(self, problem: Problem, shared: Sharing) -> None:
        self.problem = problem
        self._shared = shared
        arrival = shared.of_tied(shared.arrival)
        known = np.flatnonzero(np.all(np.isfinite(arrival), axis=1)) if problem.recorded is None else np.arange(0)
        count = min(len(known), MAX_PLACES)
        self.place = known[np.unique(np.linspace(0, max(len(known) - 1, 0), count).round().astype(np.int64))]
        self._known = known
        instant = np.mean(arrival[self.place], axis=1) if count else np.zeros(0)
        self._frame = np.round(instant / problem.every).astype(np.int64)
        self.chain = np.full((len(self.place), problem.chains), np.nan)
        self.wave = np.full((len(self.place), problem.chains), np.nan)
        self._seen, self._reach = 0, reach(problem)

    def add(self, block: Trajectory) -> None:
        """Take the next frames, from the first of the run on."""
        start, self._seen = self._seen, self._seen + block.frames
        for row in np.flatnonzero((self._frame >= start) & (self._frame < self._seen)):
            frame = self._frame[row] - start
            self.chain[row], self.wave[row] = self._energies(block, int(frame))

    def forget(self, waves: NDArray[np.bool_]) -> None:
        """Leave out the energies of some waves, [instant, chain]."""
        self.wave[waves] = np.nan

    def _energies(self, block: Trajectory, frame: int) -> tuple[Floats, Floats]:
        x, v = block.displacement[frame], block.velocity[frame]
        kinetic = motion.kinetic_energy(self.problem.system, v, block.first)
        contacts = motion.contact_energy(self.problem.system, x, block.first)
        total = np.sum(kinetic, axis=1) + np.sum(contacts, axis=1)
        for link in (*self.problem.system.across, *self.problem.system.ground):
            link.add_chain_energy(total, link.energy(x, block.first))
        inside = np.empty_like(total)
        for chain in range(self.problem.chains):
            arrivals = np.maximum.accumulate(self._shared.arrival[self._known, chain])
            peak = np.interp(block.time[frame], arrivals, self._shared.bead[self._known])
            near = np.abs(block.beads - np.rint(peak)) <= self._reach  # nowhere in a chain whose arrivals are NaN
            between = near[:-1] & near[1:]
            inside[chain] = np.sum(kinetic[chain, near]) + np.sum(contacts[chain, between])
        if self.problem.window is not None:
            total[:] = np.nan
        return total / self._shared.energy, inside / self._shared.energy
