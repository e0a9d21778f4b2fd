"""How well a run conserves energy and momentum, and its energy budget, from its trajectory.

LAMMPS reports neither for these chains. The budget is the energy input, where it is, and what dashpots dissipated, by
source: in units of m V**2, from frames of all beads. The energy exchanged between frames is in their ``exchange``.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from analysis import motion
from analysis.quantity import declare, derived, result
from analysis.trajectory import EXCHANGES, Floats, Trajectory
from lammps_inputs import Problem, System, physics
from lammps_inputs.facts import Fact
from lammps_inputs.units import Scale

MOST_INSTANTS = 500


def energy_input(block: Trajectory) -> Floats:
    """Energy input until each frame, [frame] in units of m V**2: by kicks, pushes, drives and springs that vary.

    NaN where the work of pushes, drives and springs is unknown: the frames have no ``exchange``.
    """
    problem = block.problem
    if not physics.acted_on(problem.system):
        return np.full(block.frames, physics.energy(problem.system))
    if block.exchange is None:
        return np.full(block.frames, np.nan)
    return np.asarray(kinetic_energy_at_start(problem) + block.exchange[:, -1])


def kinetic_energy_at_start(problem: Problem) -> float:
    """Kinetic energy of the kicked beads and of those of prescribed motion at the start, in units of m V**2."""
    return 0.5 * float(np.sum(problem.system.mass * physics.initial_velocity(problem.system) ** 2))


_SHOWN = 5e-5
"""Share of the energy input from which on a part is printed; it is negative where a static load has done work."""

_LITTLE = 1e-3
"""Share of the largest energy input, at the end, above which shares of it are printed."""


@result
class Account:
    """Energy over time, each [instant]."""

    time: Floats = declare("time of some frames", "time", symbol="t")
    energy_input: Floats = declare("energy input until then, by kicks and by forces from outside", "energy")
    kinetic: Floats = declare("kinetic energy", "energy")
    contacts: Floats = declare("energy of the contacts", "energy")
    springs: Floats = declare("energy of the springs between chains", "energy")
    ground: Floats = declare("energy of the foundation, and of weights", "energy")
    walls: Floats = declare("energy of the contacts with walls", "energy")
    resonators: Floats = declare("energy of the resonators: kinetic, and of their springs", "energy")
    dissipated: dict[str, Floats] = declare("energy dissipated until then, by the name of the dashpots", "energy")

    @property
    @derived("energy")
    def missing(self) -> Floats:
        """Energy input until then, less the energy stored then and dissipated until then, [instant]."""
        return np.asarray(self.energy_input - sum(self.stored.values()) - sum(self.dissipated.values()))

    @property
    @derived(
        undefined="there are no resonators, or the energy input is not positive",
        column="energy of the resonators at the end / energy input",
    )
    def in_resonators(self) -> float:
        """Energy of the resonators at the last instant over the energy input until then."""
        defined = np.any(self.resonators) and self.energy_input[-1] > 0.0
        return float(self.resonators[-1] / self.energy_input[-1]) if defined else float("nan")

    def sentence(self, scale: Scale) -> str:
        """Where the energy is at the last instant, largest part first."""
        total = float(self.energy_input[-1])
        parts = {name: float(part[-1]) for name, part in (*self.stored.items(), *self.losses.items())}
        named = sorted(((part, name) for name, part in parts.items() if abs(part) >= _SHOWN * total), reverse=True)
        supplied = (
            f"the energy input until t = {scale.written(self.time[-1], 'time')} is {scale.written(total, 'energy')}"
        )
        if not total > _LITTLE * self.most:  # a drive may have taken back what it gave
            return f"{supplied}; before, it was at most {scale.written(self.most, 'energy')}"
        return f"{supplied}: {', '.join(f'{part / total:.2%} {_PLACES.get(name, name)}' for part, name in named)}"

    @property
    def stored(self) -> dict[str, Floats]:
        """Energy of each kind in `STORED`, by name, each [instant]."""
        return {name: getattr(self, name) for name in STORED}

    @property
    def losses(self) -> dict[str, Floats]:
        """Energy dissipated until then, each [instant], by names such as ``dissipated in contact damping``."""
        return {f"dissipated in {name.replace('_', ' ')}": part for name, part in self.dissipated.items()}

    @property
    def most(self) -> float:
        """Largest energy input until any instant."""
        return float(np.max(np.abs(self.energy_input)))


class EnergyBudget:
    """Adds up a run of all beads that is given block by block, with its exchange, from its first frame on."""

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        self._kicked = kinetic_energy_at_start(problem)
        self._stride = -(-(problem.frames + 1) // MOST_INSTANTS)
        self._frames = 0
        self._samples: list[tuple[Floats, ...]] = []
        self._last: tuple[Floats, ...] = ()

    def add(self, block: Trajectory) -> tuple[Floats, Floats]:
        """Take the next frames; energy input, and energy lost, until each of them, [frame]."""
        exchange = block.exchange
        assert exchange is not None
        yielded = np.broadcast_to(physics.dissipated_by_contacts(block.system), block.frames)
        energy_input, lost = self._kicked + exchange[:, -1], np.column_stack([exchange[:, :-1], yielded])

        def at(frames: slice) -> tuple[Floats, ...]:
            """Time, energy input, and energies stored and dissipated at some frames, each [frame]."""
            stored = _stored(block.system_at(frames), *(values[frames] for values in block.atoms))
            return block.time[frames], energy_input[frames], *stored.values(), *lost[frames].T

        self._samples.append(at(slice(-self._frames % self._stride, None, self._stride)))
        self._last = at(slice(-1, None))
        self._frames += block.frames
        return energy_input, np.sum(lost, axis=1)

    def result(self) -> Account:
        """Energy budget of the frames so far, at some of them and at the last."""
        time, energy_input, *parts = (np.concatenate(part) for part in zip(*self._samples, strict=True))
        if time[-1] < self._last[0][0]:
            time, energy_input, *parts = map(np.append, (time, energy_input, *parts), self._last)
        stored, lost = parts[: len(STORED)], parts[len(STORED) :]
        names = physics.dissipation_names(self._problem.system)
        by_name = {name: part for name, part in zip(names, lost, strict=True) if name is not None}
        return Account(time, energy_input, **dict(zip(STORED, stored, strict=True)), dissipated=by_name)


STORED = ("kinetic", "contacts", "springs", "ground", "walls", "resonators")
"""Kinds of stored energy: fields of an `Account`."""

_PLACES = {
    "contacts": "in contacts",
    "springs": "in springs between chains",
    "ground": "in springs to the ground and weights",
    "walls": "in contacts with walls",
    "resonators": "in resonators",
}
"""Kind of stored energy -> its place in words."""


def _stored(system: System, x: Floats, v: Floats) -> dict[str, Floats]:
    resonators = np.broadcast_to(motion.further_energy(system, x, v), len(x))
    x, v = x[:, : system.chains], v[:, : system.chains]
    kinetic = motion.kinetic_energy(system, v).sum(axis=(-2, -1))
    kinds = (system.along, system.couplings, physics.ground_springs(system), physics.walls(system))
    stored = [sum((link.energy(x).sum(axis=(-2, -1)) for link in links), np.zeros(len(x))) for links in kinds]
    return dict(zip(STORED, [kinetic, *stored, resonators], strict=True))


class FrameAccountant(ABC):
    """Gives blocks of frames, from the first of a run on, the energy that they have exchanged.

    Attributes:
        uncertainty: of that energy, in units of m V**2, over the frames so far.
    """

    uncertainty: float

    @abstractmethod
    def of(self, block: Trajectory) -> Trajectory:
        """The next frames, with their exchange."""


class Conservation:
    """Largest deviation of energy and momentum from their input, over the frames seen so far.

    That is the kicks', and what forces from outside have added until then.

    Attributes:
        energy_drift: relative to the largest energy input; what dashpots have dissipated is added. NaN where
            not all beads are recorded, as in a window, and where the energy exchanged is unknown.
        momentum_drift: relative to the sum of the absolute momenta of kicks and forces from outside, from when these
            are over; NaN where not all beads are recorded.
        frames: number of frames seen.
        last_time: time of the last of them, in units of T.
        budget: where the energy is; None where that is not known, and where none is exchanged.
        front: largest number of a bead seen moving faster than 1e-3 of V; None if none was.
        participation: of the beads' energies in the last frame (`analysis.motion`); NaN where not all are recorded.
    """

    def __init__(self, counted: Callable[[Trajectory], Trajectory] | None = None) -> None:
        """Begin; ``counted`` gives frames their exchange where they were computed without."""
        self._counted = counted
        self.energy_drift = 0.0
        self.momentum_drift = 0.0
        self.frames = 0
        self.last_time = 0.0
        self.front: int | None = None
        self.budget: EnergyBudget | None = None
        self.participation = float("nan")
        self._energy_input = self._missing = 0.0

    def add(self, block: Trajectory) -> None:
        """Take more frames into account."""
        problem = block.problem
        system = problem.system
        self.frames += block.frames
        self.last_time = float(block.time[-1])
        velocity = block.velocity
        passed = np.flatnonzero(np.any(np.abs(velocity) > 1e-3, axis=(0, 1)))
        if len(passed):
            self.front = max(self.front or 0, int(block.beads[passed[-1]]))
        if not problem.rows.complete:
            self.energy_drift = self.momentum_drift = float("nan")
            return
        # all beads, for the order in which a sum is taken must not depend on which of them move in this block
        atoms = block.atoms
        energy = motion.energy(block.system, *atoms)
        momentum = motion.momentum(system, atoms[1])
        self.participation = motion.participation(
            motion.bead_energy(block.system_at(-1), block.displacement[-1], velocity[-1])
        )
        if not system.dampers and not system.holds(Fact.ENERGY) and system.holds(Fact.FRAMES):
            energy[:] = np.nan
        further = physics.lines(system) > system.chains
        balanced = physics.exchanges(system) or not system.holds(Fact.FRAMES) or further
        if balanced:
            self._balanced(block, energy)
        if not system.holds(Fact.MOMENTUM):
            momentum[:] = np.nan
        if physics.acted_on(system):
            self._pushed(block, momentum)
            return
        # np.maximum, unlike max(), lets NaN through
        if not balanced:
            change = np.max(np.abs(energy / physics.energy(system) - 1.0))
            self.energy_drift = float(np.maximum(self.energy_drift, change))
        change = np.max(np.abs(momentum - physics.momentum(system))) / physics.kick_momenta(system)
        self.momentum_drift = float(np.maximum(self.momentum_drift, change))

    def _balanced(self, block: Trajectory, energy: Floats) -> None:
        """Compare the energy with the input less the dissipated energy, where forces from outside or dashpots act."""
        if block.exchange is None and not physics.exchanges(block.problem.system):
            block = replace(block, exchange=np.zeros((block.frames, len(EXCHANGES))))
        if block.exchange is None and self._counted is not None:
            block = self._counted(block)
        if block.exchange is None:
            self.energy_drift = float("nan")
            return
        self.budget = self.budget or EnergyBudget(block.problem)
        energy_input, lost = self.budget.add(block)
        self._energy_input = max(self._energy_input, float(np.max(np.abs(energy_input))))
        self._missing = float(np.maximum(self._missing, np.max(np.abs(energy + lost - energy_input))))
        if self._missing == 0.0:
            self.energy_drift = 0.0
        else:  # beads may be displaced before anything has pushed them
            self.energy_drift = self._missing / self._energy_input if self._energy_input else np.inf

    def _pushed(self, block: Trajectory, momentum: Floats) -> None:
        """Compare the momentum with that of the kicks and the impulse of forces from outside, where these act."""
        problem = block.problem
        system = problem.system
        if not system.holds(Fact.MOMENTUM):
            self.momentum_drift = float("nan")
            return
        size = physics.kick_momenta(system) + sum(load.law.total for load in system.loads)
        # in the velocity of a bead that is pushed LAMMPS has half a step of the mean of the force
        half = 0.5 * problem.timestep
        over = block.time > max(load.end for load in system.loads) + half * (1.0 + 1e-6)
        missing = np.abs(momentum - physics.momentum(system) - _impulse(problem, block.time))
        if physics.driven(system):
            halfway = 0.5 * (_impulse(problem, block.time - half) + _impulse(problem, block.time + half))
            missing = np.minimum(missing, np.abs(momentum - physics.momentum(system) - halfway))
            over = block.time > 0.0
        largest = float(np.max(missing[over], initial=0.0))
        self.momentum_drift = float(np.maximum(self.momentum_drift, largest / size))


def _impulse(problem: Problem, time: Floats) -> Floats:
    """Impulse by all forces from outside until a time."""
    return np.asarray(sum(load.impulse(time) for load in problem.system.loads))
