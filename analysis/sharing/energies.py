"""Where the energy is: over time, and in the leading waves as they run.

`Flow` has the share of each chain, its centre along the chain, and how far it is spread, for problems in which no
pulse stays together, such as chains on a foundation; it makes sense of any. `EnergyShares` has the energy in each
chain, and inside the waves, at the instants at which the waves pass chosen beads, in a second reading of the run. The
energy of a spring is shared by its two chains there. Inside a wave are the beads within
`analysis.shape.waveforms.reach` of its peak, with the contacts between them. Between frames they are interpolated
(`analysis.between_frames`).

Springs that vary in time: the action of the modes in which rows oscillate, energy over angular frequency, is an
adiabatic invariant. Each mode keeps its action where stiffnesses change slowly, and modes exchange it where their
frequencies come close (Landau and Zener; Novotny 2010). Rows are independent of each other while no contact is loaded.

Plug-ins take this module for the flow of energy between chains: `FlowMeter` gives a `Flow`.

Examples:
    >>> problem = granchain.load("two-chains", {"beads": 20, "duration": 30.0}).problem()
    >>> frames = engine.run(problem)
    >>> flow = energies.FlowMeter(problem).read(frames.blocks())
    >>> flow.share[[0, 150, 300]].round(3)  # [instant, chain], at t = 0, 15 T and 30 T
    array([[1.   , 0.   ],
           [0.267, 0.733],
           [0.58 , 0.42 ]])
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from analysis import motion
from analysis.between_frames import (
    LARGEST_UNCERTAINTY,
    derivatives,
    interpolated,
    moments_of_chains,
    pairs_in,
    steps_from,
)
from analysis.conservation import energy_input
from analysis.meters import Meter, Part
from analysis.quantity import declare, result
from analysis.shape.waveforms import reach
from analysis.sharing.equipartition import Sharing
from analysis.trajectory import Floats, Integers, Trajectory, along_the_way
from lammps_inputs import Problem, System, laws, physics

MOST_INSTANTS = 500

LEAST = 1e-9
"""Share of the energy of all chains below which a chain has no centre."""


NONE = float(np.finfo(np.float64).eps) ** 2
"""Energy, in units of m V**2, up to which there is none: that of velocities which are rounding errors of V."""

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

    share_error: Floats | None = declare(
        "uncertainty of ``share`` and ``action`` by the run (``run_error``): 2 e sqrt(M / E) with its error e of "
        "velocities, mass M and energy E of all chains, [instant]; none by the time between frames",
        undefined="the run was not checked, or no chain has energy",
        default=None,
    )
    centre_error: Floats | None = declare(
        "uncertainty of ``centre`` by the run (``run_error``): 2 e sqrt(M / E) times ``spread``, with mass and "
        "energy of the chain, [instant, chain]",
        "beads",
        f"the run was not checked, or {NO_CENTRE}",
        default=None,
    )
    between_error: Floats | None = declare(
        "uncertainty of ``between`` by the run (``run_error``) alone: 2 e sqrt(M S) + M e^2 over the energy input, "
        "with its error e of velocities, mass M of all chains and energy S in these springs",
        undefined="as ``between``, or the run was not checked",
        default=None,
    )
    spread_error: Floats | None = declare(
        "uncertainty of ``spread`` s by the run (``run_error``), with the distance d of beads from ``centre``: "
        "e sqrt(M / E) times the standard deviation of d^2 over s, with mass M and energy E of the chain",
        "beads",
        "as ``centre_error``, or all of the energy is at one bead",
        default=None,
    )
    fastest_mode_action_error: float | None = declare(
        "uncertainty of ``fastest_mode_action`` by the run, as ``share_error`` at the end",
        undefined="as ``fastest_mode_action``, or the run was not checked",
        default=None,
    )
    energy: Floats | None = None
    """Energy of all chains, [instant] in units of m V**2."""
    supplied: Floats | None = None
    """Energy input until then, [instant] in units of m V**2; NaN where ``between`` is undefined."""
    spread_scatter: Floats | None = None
    """Half the standard deviation of squares of distances from the centre over the spread, [instant, chain]."""

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


@dataclass(frozen=True)
class FlowMeter(Meter[list[tuple[Floats, ...]], Flow]):
    """Energy at some frames of a run of all beads, and at the last.

    Attributes:
        problem: what was run.
    """

    problem: Problem

    def of_part(self, part: Part) -> list[tuple[Floats, ...]]:
        """Time, share, energy between chains, centre, spread, energy of all, energy input, scatter of the spread, and
        shares of modes, each [frame].
        """
        frames = [part.every(-(-(self.problem.frames + 1) // MOST_INSTANTS))]
        if part.is_last:
            frames.append(slice(-1, None))
        return [self._of(part.frames, chosen) for chosen in frames]

    def _of(self, block: Trajectory, chosen: slice) -> tuple[Floats, ...]:
        x, v = block.displacement[chosen], block.velocity[chosen]
        energy = motion.bead_energy(block.system_at(chosen), x, v, block.first)
        of_chain = energy.sum(axis=-1, keepdims=True)
        total = of_chain.sum(axis=-2, keepdims=True)
        share = (of_chain / np.where(total > NONE, total, np.nan))[..., 0]  # a drive may begin with none
        between = np.zeros(len(x))
        for link in block.problem.system.couplings:
            between += np.sum(link.energy(x, block.first), axis=(-2, -1))
        supplied = energy_input(block)[chosen]
        supplied = np.where(supplied > NONE, supplied, np.nan)
        between /= supplied
        with np.errstate(invalid="ignore", divide="ignore"):
            weight = np.where(share > LEAST, 1.0, np.nan)[..., np.newaxis] * energy / of_chain
        centre = np.sum(weight * block.beads, axis=-1)
        square = (block.beads - centre[..., np.newaxis]) ** 2
        spread = np.sqrt(np.sum(weight * square, axis=-1))
        scatter = np.sqrt(np.sum(weight * (square - spread[..., np.newaxis] ** 2) ** 2, axis=-1))
        scatter /= np.where(spread > 0.0, 2.0 * spread, np.nan)
        modes = [shares_of_action(block, chosen)] if has_modes(self.problem.system) else []
        return block.time[chosen], share, between, centre, spread, total[:, 0, 0], supplied, scatter, *modes

    def result(self, pieces: list[list[tuple[Floats, ...]]]) -> Flow:
        """Energy at the frames, [instant]."""
        *samples, last = [of_frames for piece in pieces for of_frames in piece]
        if len(samples[-1][0]) == 0 or samples[-1][0][-1] < last[0][0]:
            samples.append(last)
        columns = (np.concatenate(part) for part in list(zip(*samples, strict=True))[:8])
        time, share, between, centre, spread, energy, supplied, scatter = columns
        flow = Flow(time, share, between, centre, spread, energy=energy, supplied=supplied, spread_scatter=scatter)
        if not has_modes(self.problem.system):
            return flow
        action = np.concatenate([of_frames[-1] for of_frames in samples])
        return replace(flow, action=action, fastest_mode_action=float(last[-1][-1, -1]))


MOST_CHAINS = 30
"""Largest number of chains whose modes are computed at every instant."""

UNLOADED = 1e-9
"""Share of the energy in contacts below which none counts as loaded."""


def has_modes(system: System) -> bool:
    """Whether rows have modes whose action can change: linear springs, the same in all rows, some of which vary."""
    springs = (*system.couplings, *system.ground)
    return (
        1 < system.chains <= MOST_CHAINS
        and physics.varying(system)
        and isinstance(physics.masses(system), float)
        and not physics.loaded(system)
        and all(link.law.linear for link in springs)
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
    loaded = sum(link.energy(displacement).sum(axis=(-2, -1)) for link in (*now.contacts, *now.walls))
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
    for spring in system.ground:
        held = np.broadcast_to(laws.stiffness(spring.law, 0.0), (frames, system.chains, system.beads))
        stiffness[:, chains, chains] += held[..., 0]
    return stiffness


MAX_PLACES = 400


@dataclass(frozen=True)
class EnergyShares:
    """Energies when the chains' waves pass beads; for runs in which every bead is recorded.

    Shares are of the energy input, and NaN where their uncertainty exceeds `LARGEST_UNCERTAINTY`.

    Attributes:
        place: [instant] positions in the `Sharing`, of those at which all arrivals are defined.
        chain: [instant, chain] energy of a chain; NaN where unknown, as in a window.
        wave: [instant, chain] energy inside its leading wave; NaN where unknown, or where another pulse is as
            near. 0 where the chain has none that counts.
        chain_error, wave_error: [instant, chain] uncertainties of both by the time between frames, which also leaves
            the instant uncertain.
    """

    place: Integers
    chain: Floats
    wave: Floats
    chain_error: Floats
    wave_error: Floats


@dataclass(frozen=True, eq=False)
class ShareMeter(Meter[tuple[Integers, Floats], EnergyShares]):
    """Energies when leading waves pass beads.

    Attributes:
        problem: what was run.
        shared: the leading waves.
    """

    problem: Problem
    shared: Sharing

    @cached_property
    def _defined(self) -> Integers:
        """Positions in the `Sharing` at which all arrivals are defined, [place]; none where few beads are recorded."""
        arrival = self.shared.of_tied(self.shared.arrival)
        return np.flatnonzero(np.all(np.isfinite(arrival), axis=1) & (self.problem.rows.neighbours))

    @cached_property
    def place(self) -> Integers:
        """Positions in the `Sharing` at which energies are measured, [instant]: `MAX_PLACES` at most."""
        count = min(len(self._defined), MAX_PLACES)
        return self._defined[np.unique(np.linspace(0, max(len(self._defined) - 1, 0), count).round().astype(np.int64))]

    @cached_property
    def _time(self) -> Floats:
        """Instants, [instant] in units of T: means of the arrivals."""
        return np.asarray(np.mean(self.shared.of_tied(self.shared.arrival)[self.place], axis=1))

    @cached_property
    def _late(self) -> Floats:
        """Uncertainties of the instants, [instant] in units of T."""
        if self.shared.arrival_error is None:
            return np.zeros(len(self.place))
        error = np.nan_to_num(self.shared.of_tied(self.shared.arrival_error)[self.place], posinf=0.0)
        return np.asarray(np.mean(error, axis=1))

    @cached_property
    def _peaks(self) -> Floats:
        """Beads at which the waves are, [set, instant, chain], at the instants, and as much before and after them."""
        return np.array([self._beads_at_peaks(self._time + late) for late in (0.0, -self._late, self._late)])

    def _beads_at_peaks(self, time: Floats) -> Floats:
        """[instant, chain] beads at which the waves are, by their arrivals; NaN without arrivals."""
        if len(time) == 0:
            return np.zeros((0, self.problem.chains))
        beads = along_the_way(self.problem, self.shared.bead[self._defined])
        arrivals = np.maximum.accumulate(self.shared.arrival[self._defined], axis=0)
        return np.array([np.rint(np.interp(time, of_chain, beads)) for of_chain in arrivals.T]).T

    def of_part(self, part: Part) -> tuple[Integers, Floats]:
        """Positions of the instants in a part, and `chain`, `wave` and their errors there, [4, instant, chain]."""
        if not (part.around.forces_known and len(self.place)):
            return np.arange(0), np.zeros((4, 0, self.problem.chains))
        block, entry, before, share_of_time = pairs_in(part, self._time)
        if len(entry) == 0:
            return entry, np.zeros((4, 0, self.problem.chains))
        peaks = self._peaks[:, entry]
        if np.array_equal(peaks[1], peaks[0], equal_nan=True) and np.array_equal(peaks[2], peaks[0], equal_nan=True):
            peaks = peaks[:1]
        frame = np.concatenate([before, before + 1])
        step = np.repeat(steps_from(block), len(entry))
        energy = self._energies(block, frame, step, np.concatenate([peaks, peaks], axis=1))
        of_frames = derivatives(energy, step[:, np.newaxis]).reshape((3, len(energy[0]), 2, len(entry), -1))
        share = np.broadcast_to(share_of_time[:, np.newaxis], (len(energy[0]), len(entry), self.problem.chains))
        at_instants = interpolated(np.moveaxis(of_frames, 2, 0), share, block.spacing)
        chain, wave, *others = at_instants.value / self.shared.energy
        error = at_instants.uncertainty + self._late[entry, np.newaxis] * np.abs(at_instants.rate)
        error = error[:2] / self.shared.energy
        error[1] += sum(np.abs(other - wave) for other in others)
        if self.problem.rows.follow:
            chain = np.full_like(chain, np.nan)
        stated = (error <= LARGEST_UNCERTAINTY) & np.isfinite([chain, wave])
        return entry, np.where(np.concatenate([stated, stated]), np.concatenate([[chain, wave], error]), np.nan)

    def result(self, pieces: list[tuple[Integers, Floats]]) -> EnergyShares:
        """Energies at all instants, [instant, chain]."""
        values = np.full((4, len(self.place), self.problem.chains), np.nan)
        for entry, of_part in pieces:
            values[:, entry] = of_part
        return EnergyShares(self.place, *values)

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
        links = (*system.closing, *system.couplings, *system.ground, *system.walls)
        for link in system.among(links, first, x.shape[-1]):
            link.add_chain_energy(total, link.energy(x, first))
        energies = np.zeros((3, 1 + len(peaks), *total.shape[1:]))
        energies[:, 0] = total
        far = reach(self.problem)
        lowest, highest = np.fmin.reduce(peaks, axis=None), np.fmax.reduce(peaks, axis=None)
        number = np.arange(first, first + x.shape[-1])
        some = np.flatnonzero((number >= lowest - far) & (number <= highest + far))
        if len(some):
            columns = slice(int(some[0]), int(some[-1]) + 1)
            kinetic, contacts = kinetic[..., columns], contacts[..., columns.start : columns.stop - 1]
            for number_of_set, beads_of_peaks in enumerate(peaks, 1):  # none where there is no peak
                inside = np.abs(number[columns] - beads_of_peaks[..., np.newaxis]) <= far
                between = inside[..., :-1] & inside[..., 1:]
                energies[:, number_of_set] += np.sum(np.where(inside, kinetic, 0.0), axis=-1)
                energies[:, number_of_set] += np.sum(np.where(between, contacts, 0.0), axis=-1)
        # a window has left some of their beads, or the bead behind, which pushes the first of them
        energies[:, 1:][:, (peaks - far <= block.first) & (block.first > 1)] = np.nan
        return energies
