"""Where the energy is: over time, and in the leading waves as they run.

`EnergyFlow` has the share of each chain, its centre along the chain, and how far it is spread, for problems in which no
pulse stays together, such as chains on a foundation; it makes sense of any. `EnergyShares` has the energy in each
chain, and inside the waves, at the instants at which the waves pass chosen beads; they are picked out while the run is
read a second time. The energy of a spring is shared by its two chains there. Inside a wave are the beads within
`analysis.shape.waveforms.reach` of its peak, with the contacts between them. Between frames they are interpolated
(`analysis.between_frames`).

Springs that vary in time: the action of the modes in which rows oscillate, energy over angular frequency, is an
adiabatic invariant. Each mode keeps its action where stiffnesses change slowly, and modes exchange it where their
frequencies come close (Landau and Zener; Novotny 2010). Rows are independent of each other while no contact is loaded.

Plug-ins take this module for the flow of energy between chains: `EnergyFlow` collects a `Flow`.

Examples:
    >>> problem = granchain.load("two-chains", {"beads": 20, "duration": 30.0}).problem()
    >>> frames = engine.run(problem)
    >>> flow = watch(energies.EnergyFlow(problem), frames.blocks()).result()
    >>> flow.share[[0, 150, 300]].round(3)  # [instant, chain], at t = 0, 15 T and 30 T
    array([[1.   , 0.   ],
           [0.267, 0.733],
           [0.58 , 0.42 ]])
"""

from dataclasses import replace

import numpy as np

from analysis import motion
from analysis.between_frames import (
    LARGEST_UNCERTAINTY,
    Instants,
    Pair,
    derivatives,
    interpolated,
    moments_of_chains,
    steps_from,
)
from analysis.conservation import energy_input
from analysis.quantity import declare, result
from analysis.shape.waveforms import reach
from analysis.sharing.equipartition import Sharing
from analysis.trajectory import Floats, Integers, Trajectory
from lammps_inputs import Problem, System, laws, physics
from lammps_inputs.laws.spring import Linear, Varying

MOST_INSTANTS = 500

LEAST = 1e-9
"""Share of the energy of all chains below which a chain has no centre."""


NO_CENTRE = "the chain has no energy"

NO_MODES = "one chain, no foundation that varies in time, or springs that are cubic or differ from row to row"


@result
class Flow:
    """Energy at some instants."""

    time: Floats = declare("time of some frames", "time", symbol="t")
    share: Floats = declare(
        "energy of each chain (kinetic, contacts, foundation) over that of all chains, [instant, chain]",
        undefined="no chain has energy, as at the start of a push",
    )
    between: Floats = declare(
        "energy in the springs between chains over the energy input until then (kicks, work of pushes, "
        "drives and springs that vary)",
        undefined="the input is not positive, or that work is not known",
    )
    centre: Floats = declare("mean bead number of the chain's energy, [instant, chain]", "beads", NO_CENTRE)
    spread: Floats = declare("standard deviation of the bead number of the chain's energy", "beads", NO_CENTRE)
    action: Floats | None = declare(
        "action (energy over angular frequency) of each mode of the rows over that of all modes, slowest mode first, "
        "[instant, mode]",
        undefined=f"{NO_MODES}; at instants at which a contact is loaded",
        default=None,
    )
    fastest_mode_action: float | None = declare(
        "share of the action that the fastest mode of the rows has at the end",
        undefined=f"{NO_MODES}, or a contact is loaded then",
        column="share of the action in the fastest mode at the end",
        default=None,
    )

    def extremes(self, chain: int) -> tuple[tuple[float, float], tuple[float, float]]:
        """Least and largest share of a chain (from 0) after the start, each with its time; the start if alone."""
        later = slice(1, None) if len(self.time) > 1 else slice(None)
        share, time = self.share[later, chain], self.time[later]
        undefined = np.isnan(share)
        smallest, largest = (
            int(np.argmin(np.where(undefined, np.inf, share))),
            int(np.argmax(np.where(undefined, 0.0, share))),
        )
        return (float(share[smallest]), float(time[smallest])), (float(share[largest]), float(time[largest]))


class EnergyFlow:
    """Collects a `Flow` from a run of all beads that is given block by block."""

    def __init__(self, problem: Problem) -> None:
        self._stride = -(-(problem.frames + 1) // MOST_INSTANTS)
        self._frames = 0
        self._samples: list[tuple[Floats, ...]] = []
        self._action: list[Floats] | None = [] if has_modes(problem.system) else None
        self._last_action = np.full((1, 1), np.nan)
        self._last: tuple[Floats, ...] | None = None  # of the last frame, where it is none of the chosen ones

    def add(self, block: Trajectory) -> None:
        """Take the next frames, from the first of the run on."""
        chosen = slice(-self._frames % self._stride, None, self._stride)
        self._frames += block.frames
        self._samples.append(self._of(block, chosen))
        apart = (self._frames - 1) % self._stride > 0
        self._last = self._of(block, slice(-1, None)) if apart else None
        if self._action is not None:
            self._action.append(shares_of_action(block, chosen))
            self._last_action = shares_of_action(block, slice(-1, None))

    @staticmethod
    def _of(block: Trajectory, chosen: slice) -> tuple[Floats, ...]:
        """Time, share, energy between chains, centre and spread at some frames."""
        x, v = block.displacement[chosen], block.velocity[chosen]
        energy = motion.bead_energy(block.system_at(chosen), x, v, block.first)
        of_chain = energy.sum(axis=-1, keepdims=True)
        total = of_chain.sum(axis=-2, keepdims=True)
        share = (of_chain / np.where(total > 0.0, total, np.nan))[..., 0]  # a drive may begin with none
        between = np.zeros(len(x))
        for link in block.problem.system.couplings:
            between += np.sum(link.energy(x, block.first), axis=(-2, -1))
        supplied = energy_input(block)[chosen]
        between /= np.where(supplied > 0.0, supplied, np.nan)
        with np.errstate(invalid="ignore", divide="ignore"):
            weight = np.where(share > LEAST, 1.0, np.nan)[..., np.newaxis] * energy / of_chain
        centre = np.sum(weight * block.beads, axis=-1)
        spread = np.sqrt(np.sum(weight * (block.beads - centre[..., np.newaxis]) ** 2, axis=-1))
        return block.time[chosen], share, between, centre, spread

    def result(self) -> Flow:
        """Energy at some of the frames so far.

        Raises:
            ValueError: there was none.
        """
        if not self._samples:
            raise ValueError("no frames to measure")
        last = [] if self._last is None else [self._last]
        parts = zip(*self._samples, *last, strict=True)
        time, share, between, centre, spread = (np.concatenate(part) for part in parts)
        flow = Flow(time, share, between, centre, spread)
        if self._action is None:
            return flow
        actions = [*self._action, *([] if self._last is None else [self._last_action])]
        return replace(flow, action=np.concatenate(actions), fastest_mode_action=float(self._last_action[-1, -1]))


MOST_CHAINS = 30
"""Largest number of chains whose modes are computed at every instant."""

UNLOADED = 1e-9
"""Share of the energy in contacts below which none counts as loaded."""


def has_modes(system: System) -> bool:
    """Whether rows have modes whose action can change: linear springs, the same in all rows, some of which vary."""
    springs = (*system.couplings, *physics.ground_springs(system))
    return (
        1 < system.chains <= MOST_CHAINS
        and physics.varying(system)
        and isinstance(physics.masses(system), float)
        and not physics.loaded(system)
        and all(isinstance(link.law, Linear | Varying) for link in springs)
        and all(np.ndim(value) == 0 or np.ptp(value, axis=-1).max() == 0.0 for link in springs for value in link.law)
    )


def shares_of_action(block: Trajectory, frames: slice) -> Floats:
    """Share of the action that each mode has in some frames, slowest first, [frame, mode]; the system `has_modes`.

    NaN where a contact or wall is loaded, a mode has no restoring force, or nothing moves.
    """
    displacement, velocity = block.displacement[frames], block.velocity[frames]
    now = physics.at(block.problem.system, block.time[frames])
    square, shape = np.linalg.eigh(_stiffness(now, len(displacement)) / now.mass)
    x, v = (np.swapaxes(shape, -1, -2) @ part for part in (displacement, velocity))
    omega = np.sqrt(np.where(square[:, 0, None] > 0.0, square, np.nan))
    action = 0.5 * now.mass * np.sum(v * v + (square[..., None] * x) * x, axis=-1) / omega
    total = np.sum(action, axis=-1, keepdims=True)
    energy = motion.energy(now, displacement, velocity)
    loaded = sum(link.energy(displacement).sum(axis=(-2, -1)) for link in (*now.along, *physics.walls(now)))
    defined = (loaded <= UNLOADED * energy)[:, None] & (total > 0.0)
    return np.asarray(np.where(defined, action / np.where(defined, total, 1.0), np.nan))


def _stiffness(system: System, frames: int) -> Floats:
    """Stiffness matrix of the springs of a row, [frame, chain, chain]."""
    stiffness = np.zeros((frames, system.chains, system.chains))
    chains = np.arange(system.chains)
    for link in system.couplings:
        edges = link.of_edges(laws.stiffness(link.law, 0.0)).tolist()
        for (first, second), value in zip(link.edges, edges, strict=True):
            stiffness[:, [first, second], [first, second]] += value
            stiffness[:, [first, second], [second, first]] -= value
    for spring in physics.ground_springs(system):
        held = np.broadcast_to(laws.stiffness(spring.law, 0.0), (frames, system.chains, system.beads))
        stiffness[:, chains, chains] += held[..., 0]
    return stiffness


MAX_PLACES = 400


class EnergyShares:
    """Collects energies when the chains' waves pass beads; for runs in which every bead is recorded.

    Shares are of the energy input, and NaN where their uncertainty exceeds `LARGEST_UNCERTAINTY`.

    Attributes:
        place: [instant] positions in the `Sharing`, of those at which all arrivals are defined.
        chain: [instant, chain] energy of a chain; NaN where unknown, as in a window.
        wave: [instant, chain] energy inside its leading wave; NaN where unknown, or where another pulse is as
            near. 0 where the chain has none that counts.
        chain_error, wave_error: [instant, chain] uncertainties of both by the time between frames, which also leaves
            the instant uncertain.
    """

    def __init__(self, problem: Problem, shared: Sharing) -> None:
        self.problem = problem
        self._shared = shared
        arrival = shared.of_tied(shared.arrival)
        defined = np.flatnonzero(np.all(np.isfinite(arrival), axis=1)) if problem.rows.neighbours else np.arange(0)
        count = min(len(defined), MAX_PLACES)
        self.place = defined[np.unique(np.linspace(0, max(len(defined) - 1, 0), count).round().astype(np.int64))]
        time = np.mean(arrival[self.place], axis=1) if count else np.zeros(0)
        self._late = np.zeros(len(self.place))
        if shared.arrival_error is not None and count:
            self._late = np.mean(np.nan_to_num(shared.of_tied(shared.arrival_error)[self.place], posinf=0.0), axis=1)
        self._instants, self._reach = Instants(time, problem), reach(problem)
        self._peaks = np.array([self._beads_at_peaks(time + late, defined) for late in (0.0, -self._late, self._late)])
        shape = (len(self.place), problem.chains)
        self.chain, self.wave, self.chain_error, self.wave_error = np.full((4, *shape), np.nan)

    def _beads_at_peaks(self, time: Floats, places: Integers) -> Floats:
        """[instant, chain] beads at which the waves are, by their arrivals at places [place]; NaN without arrivals."""
        if len(time) == 0:
            return np.zeros((0, self.problem.chains))
        beads = self._shared.bead[places]
        arrivals = np.maximum.accumulate(self._shared.arrival[places], axis=0)
        return np.array([np.rint(np.interp(time, of_chain, beads)) for of_chain in arrivals.T]).T

    def add(self, block: Trajectory) -> None:
        """Take the next frames, from the first of the run on."""
        if not block.forces_known:
            return
        for pair in self._instants.within(block):
            self._measure(pair)

    def _measure(self, pair: Pair) -> None:
        """Take the energies at the instants between the frames of a pair."""
        block, entry = pair.block, pair.entry
        peaks = self._peaks[:, entry]
        if np.array_equal(peaks[1], peaks[0], equal_nan=True) and np.array_equal(peaks[2], peaks[0], equal_nan=True):
            peaks = peaks[:1]
        frame = np.concatenate([pair.frame, pair.frame + 1])
        step = np.repeat(steps_from(block), len(entry))
        energy = self._energies(block, frame, step, np.concatenate([peaks, peaks], axis=1))
        of_frames = derivatives(energy, step[:, np.newaxis]).reshape((3, len(energy[0]), 2, len(entry), -1))
        share = np.broadcast_to(pair.share[:, np.newaxis], (len(energy[0]), len(entry), self.problem.chains))
        at_instants = interpolated(np.moveaxis(of_frames, 2, 0), share, block.spacing)
        chain, wave, *others = at_instants.value / self._shared.energy
        error = at_instants.uncertainty + self._late[entry, np.newaxis] * np.abs(at_instants.rate)
        error = error[:2] / self._shared.energy
        error[1] += sum(np.abs(other - wave) for other in others)
        if self.problem.rows.follow:
            chain = np.full_like(chain, np.nan)
        stated = (error <= LARGEST_UNCERTAINTY) & np.isfinite([chain, wave])
        self.chain[entry], self.wave[entry] = np.where(stated, [chain, wave], np.nan)
        self.chain_error[entry], self.wave_error[entry] = np.where(stated, error, np.nan)

    def _energies(self, block: Trajectory, frame: Integers, step: Floats, peaks: Floats) -> Floats:
        """Energies of the chains, and of their waves about each set of peaks, at three moments beside chosen frames.

        Args:
            block: frames of all beads.
            frame: [entry] positions of the frames.
            step: [entry] time from one moment to the next.
            peaks: [set, entry, chain] beads at which the waves are.

        Returns:
            [moment, chains or set, entry, chain]
        """
        beads = block.moving_at(frame)
        time, x, v = moments_of_chains(block, frame, step, beads)
        x, v = x[..., : self.problem.chains, :], v[..., : self.problem.chains, :]
        first = block.first + beads.start
        system = block.system_at(frame, time)
        kinetic = motion.kinetic_energy(system, v, first)
        contacts = motion.contact_energy(system, x, first)
        total = np.sum(kinetic, axis=-1) + np.sum(contacts, axis=-1)
        for link in (*system.couplings, *system.ground):
            link.add_chain_energy(total, link.energy(x, first))
        energies = np.zeros((3, 1 + len(peaks), *total.shape[1:]))
        energies[:, 0] = total
        lowest, highest = np.fmin.reduce(peaks, axis=None), np.fmax.reduce(peaks, axis=None)
        number = np.arange(first, first + x.shape[-1])
        some = np.flatnonzero((number >= lowest - self._reach) & (number <= highest + self._reach))
        if len(some):
            columns = slice(int(some[0]), int(some[-1]) + 1)
            kinetic, contacts = kinetic[..., columns], contacts[..., columns.start : columns.stop - 1]
            for number_of_set, beads_of_peaks in enumerate(peaks, 1):  # none where there is no peak
                inside = np.abs(number[columns] - beads_of_peaks[..., np.newaxis]) <= self._reach
                between = inside[..., :-1] & inside[..., 1:]
                energies[:, number_of_set] += np.sum(np.where(inside, kinetic, 0.0), axis=-1)
                energies[:, number_of_set] += np.sum(np.where(between, contacts, 0.0), axis=-1)
        return energies
