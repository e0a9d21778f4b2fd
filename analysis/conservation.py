"""How well a run conserves energy and momentum, and its energy budget, from its trajectory.

LAMMPS reports neither for these chains. The budget is the energy input, where it is, and what dashpots dissipated, by
source: in units of m V**2, from frames of all beads. The energy exchanged between frames is in their ``exchange``.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from analysis import motion
from analysis.meters import Meter, Part
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
    if problem.system.weights and not physics.acted_on(problem.system):
        return physics.energy_at_start(problem.system) + _work_of_weights(block)
    if not physics.acted_on(problem.system):
        return np.full(block.frames, physics.energy(problem.system))
    if block.exchange is None:
        return np.full(block.frames, np.nan)
    return np.asarray(physics.energy_at_start(problem.system) + block.exchange[:, -1] + _work_of_weights(block))


def _work_of_weights(block: Trajectory) -> Floats:
    """Work of the weights since the start, [frame] in units of m V**2; 0 where none fall."""
    at_start = physics.initial_state(block.problem.system)[0]
    work = physics.weight_energy(block.problem.system, block.displacement)
    return np.broadcast_to(work - physics.weight_energy(block.problem.system, at_start), block.frames)


_SHOWN = 5e-5
"""Share of the energy input from which on a part is printed; it is negative where a static load has done work."""

_LITTLE = 1e-3
"""Share of the largest energy input, at the end, above which shares of it are printed."""


@result
class Account:
    """Energy over time, each [instant]."""

    time: Floats = declare("time of some frames", "time", symbol="t")
    energy_input: Floats = declare("energy input until then: at the start, and by forces from outside", "energy")
    kinetic: Floats = declare("kinetic energy", "energy")
    contacts: Floats = declare("energy of the contacts", "energy")
    springs: Floats = declare("energy of the springs between chains", "energy")
    ground: Floats = declare("energy of the foundation", "energy")
    walls: Floats = declare("energy of the contacts with walls", "energy")
    resonators: Floats = declare("energy of the resonators: kinetic, and of their springs", "energy")
    dissipated: dict[str, Floats] = declare("energy dissipated until then, by the name of the dashpots", "energy")
    other_atoms: dict[str, Floats] | None = declare(
        "energy of other atoms beside the beads, by their name: kinetic, and of their springs",
        "energy",
        "there are none",
    )
    in_resonators_error: float | None = declare(
        "uncertainty of ``in_resonators``: by the error e of velocities in the run (``run_error``), 2 e sqrt(M E) + "
        "M e^2 over the energy input, with their mass M and energy E; and that of the energy input",
        undefined="so is ``in_resonators``, or the run was not checked",
    )

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
        return f"{supplied}: {', '.join(f'{part / total:.2%} {self._place(name)}' for part, name in named)}"

    def _place(self, name: str) -> str:
        """Place of a part of the energy in words."""
        return f"in {name}" if name in (self.other_atoms or {}) else _PLACES.get(name, name)

    @property
    def stored(self) -> dict[str, Floats]:
        """Energy of each kind in `STORED` and of other atoms beside the beads, by name, each [instant]."""
        return {name: getattr(self, name) for name in STORED} | (self.other_atoms or {})

    @property
    def losses(self) -> dict[str, Floats]:
        """Energy dissipated until then, each [instant], by names such as ``dissipated in contact damping``."""
        return {f"dissipated in {name.replace('_', ' ')}": part for name, part in self.dissipated.items()}

    @property
    def most(self) -> float:
        """Largest energy input until any instant."""
        return float(np.max(np.abs(self.energy_input)))


@dataclass(frozen=True)
class AccountMeter(Meter[tuple[tuple[Floats, ...], tuple[Floats, ...]], Account]):
    """Energy budget at some frames of a run of all beads, with its exchange, and at the last.

    Attributes:
        problem: what was run.
    """

    problem: Problem

    def of_part(self, part: Part) -> tuple[tuple[Floats, ...], tuple[Floats, ...]]:
        """Time, energy input, and energies stored and dissipated at some frames, and at the last, each [frame]."""
        chosen = part.every(-(-(self.problem.frames + 1) // MOST_INSTANTS))
        return _sampled(part.frames, chosen), _sampled(part.frames, slice(-1, None))

    def result(self, pieces: list[tuple[tuple[Floats, ...], tuple[Floats, ...]]]) -> Account:
        """The budget at these frames, each array [instant], in units of m V**2 and T."""
        samples, (*_, last) = zip(*pieces, strict=True)
        time, energy_input, *parts = (np.concatenate(part) for part in zip(*samples, strict=True))
        if time[-1] < last[0][0]:
            time, energy_input, *parts = map(np.append, (time, energy_input, *parts), last)
        places, names = _places_of(self.problem.system), physics.dissipation_names(self.problem.system)
        stored = dict(zip(places, parts, strict=False))
        of_kinds = {name: stored.pop(name, np.zeros(len(time))) for name in STORED}
        lost = zip(names, parts[len(places) :], strict=True)
        by_name = {name: part for name, part in lost if name is not None}
        return Account(
            time, energy_input, **of_kinds, dissipated=by_name, other_atoms=stored or None, in_resonators_error=None
        )


def _sampled(block: Trajectory, frames: slice) -> tuple[Floats, ...]:
    """Time, energy input, and energies stored and dissipated at some frames, each [frame]."""
    energy_input, lost = _exchanged(block)
    stored = _stored(block.system_at(frames), *(values[frames] for values in block.atoms))
    return block.time[frames], energy_input[frames], *stored, *lost[frames].T


def _exchanged(block: Trajectory) -> tuple[Floats, Floats]:
    """Energy input [frame], and energy dissipated [frame, dashpots], until each frame, in units of m V**2.

    Both follow from the frames' exchange, which is 0 where nothing is exchanged.
    """
    exchange = np.zeros((block.frames, len(EXCHANGES))) if block.exchange is None else block.exchange
    yielded = np.broadcast_to(physics.dissipated_by_contacts(block.system), block.frames)
    supplied = physics.energy_at_start(block.problem.system) + exchange[:, -1] + _work_of_weights(block)
    return supplied, np.column_stack([exchange[:, :-1], yielded])


_OF_BEADS = ("kinetic", "contacts", "springs", "ground", "walls")

STORED = (*_OF_BEADS, "resonators")
"""Kinds of stored energy: fields of an `Account`."""

_PLACES = {
    "contacts": "in contacts",
    "springs": "in springs between chains",
    "ground": "in springs to the ground",
    "walls": "in contacts with walls",
    "resonators": "in resonators",
}
"""Kind of stored energy -> its place in words."""


def _places_of(system: System) -> list[str]:
    """Names of the kinds of energy that a system stores: those of beads, and the nouns of other atoms."""
    return [*_OF_BEADS, *(noun.plural for noun in system.lines_by_noun)]


def _stored(system: System, x: Floats, v: Floats) -> list[Floats]:
    """Energies of the kinds in `_places_of`, each [frame], at displacements and velocities [frame, line, bead]."""
    at_beads, none = x[:, : system.chains], np.zeros(len(x))
    kinetic = motion.kinetic_energy(system, v[:, : system.chains]).sum(axis=(-2, -1))
    kinds = (system.contacts, system.couplings, system.ground, system.walls)
    stored = [sum((link.energy(at_beads).sum(axis=(-2, -1)) for link in links), none) for links in kinds]
    return [kinetic, *stored, *_of_others(system, x, v)]


def _of_others(system: System, x: Floats, v: Floats) -> list[Floats]:
    """Energies of atoms that are no beads, by noun, with those of their ties, each [frame]; NaN if not recorded."""
    if v.shape[1] < physics.lines(system):
        return [np.full(len(x), np.nan) for _ in system.lines_by_noun]
    kinetic = motion.kinetic_energy(system, v).sum(axis=-1)
    tied = [(link.edges[0][1], link.energy(x).sum(axis=(-2, -1))) for link in system.ties]
    return [
        kinetic[:, lines].sum(axis=-1) + sum(energy for line, energy in tied if line in lines)
        for lines in system.lines_by_noun.values()
    ]


def with_error(
    account: Account, system: System, of_energy: Callable[[Floats, float], Floats], of_input: float
) -> Account:
    """The account with the uncertainty of its share of energy in resonators, where that share is defined.

    Args:
        account: energies of a run.
        system: what was run.
        of_energy: uncertainties of energies of atoms, [...] in units of m V**2, from the energies and the mass in all.
        of_input: uncertainty of the energy input, in units of m V**2.
    """
    if np.isnan(account.in_resonators):
        return account
    mass = sum(float(np.sum(line.mass)) for line in system.further_lines if line.noun.plural == "resonators")
    error = float(of_energy(account.resonators[-1:], mass)[0]) + account.in_resonators * of_input
    return replace(account, in_resonators_error=error / float(account.energy_input[-1]))


class FrameAccountant(ABC):
    """Gives frames the energy that they have exchanged.

    Attributes:
        uncertainty: of that energy, in units of m V**2, over the frames so far.
    """

    uncertainty: float

    @abstractmethod
    def counted(self, blocks: Iterable[Trajectory]) -> Iterator[Trajectory]:
        """Consecutive frames of a run, from its first on, with their exchange, where they have any."""


@dataclass(frozen=True)
class Conservation:
    """Largest deviation of energy and momentum from their input, over the frames of a run.

    That is the kicks', and what forces from outside have added until then.

    Attributes:
        energy_drift: relative to the largest energy input; what dashpots have dissipated is added. NaN where
            not all beads are recorded, as in a window, and where the energy exchanged is unknown.
        momentum_drift: relative to the sum of the absolute momenta of kicks and forces from outside, from when these
            are over; NaN where not all beads are recorded.
        frames: number of frames.
        last_time: time of the last of them, in units of T.
        front: largest number of a bead that moves faster than 1e-3 of V in any frame; None if none does.
        participation: of the beads' energies in the last frame (`analysis.motion`); NaN where not all are recorded.
        budget: where the energy is; None where that is not known, and where none is exchanged.
    """

    energy_drift: float
    momentum_drift: float
    frames: int
    last_time: float
    front: int | None
    participation: float
    budget: Account | None


class _Drifts(NamedTuple):
    """Largest deviations in a part of a run, and what a `Conservation` has beside.

    Attributes:
        energy: deviation of the energy, in units of m V**2 where there is a budget, else relative.
        energy_input: largest energy input, in units of m V**2.
        momentum: relative deviation of the momentum.
        budget: what the energy budget takes from the part; None where there is none.
    """

    energy: float
    energy_input: float
    momentum: float
    frames: int
    last_time: float
    front: int
    participation: float
    budget: tuple[tuple[Floats, ...], tuple[Floats, ...]] | None


@dataclass(frozen=True)
class ConservationMeter(Meter[_Drifts, Conservation]):
    """Conservation of energy and momentum in frames that have their exchange, where energy is exchanged.

    Attributes:
        problem: what was run.
    """

    problem: Problem

    @cached_property
    def _balanced(self) -> bool:
        """Whether the energy is compared with the input less the dissipated energy, by an energy budget."""
        system = self.problem.system
        further = physics.lines(system) > system.chains
        return physics.exchanges(system) or not system.holds(Fact.FRAMES) or further or bool(system.weights)

    def _accounted(self, block: Trajectory) -> bool:
        """Whether frames have an energy budget: the energy that is exchanged is known, and that may be none."""
        return self._balanced and (block.exchange is not None or not physics.exchanges(self.problem.system))

    def of_part(self, part: Part) -> _Drifts:
        """Deviations in the frames of a part."""
        block = part.frames
        passed = block.beads[np.any(np.abs(block.velocity) > 1e-3, axis=(0, 1))]
        drifts = _Drifts(
            energy=np.nan,
            energy_input=np.nan,
            momentum=np.nan,
            frames=block.frames,
            last_time=float(block.time[-1]),
            front=int(passed.max(initial=0)),
            participation=np.nan,
            budget=None,
        )
        if not self.problem.rows.complete:
            return drifts
        # all beads, for the order in which a sum is taken must not depend on which of them move in this part
        atoms = block.atoms
        energy, energy_input = self._energy(block, motion.energy(block.system, *atoms))
        bead_energy = motion.bead_energy(block.system_at(-1), block.displacement[-1], block.velocity[-1])
        return drifts._replace(
            energy=energy,
            energy_input=energy_input,
            momentum=self._momentum(block, motion.momentum(self.problem.system, atoms[1])),
            participation=motion.participation(bead_energy),
            budget=AccountMeter(self.problem).of_part(part) if self._accounted(block) else None,
        )

    def result(self, pieces: list[_Drifts]) -> Conservation:
        """Deviations in all frames."""
        # np.max, unlike max(), lets NaN through
        energy, energy_input, momentum = np.max([piece[:3] for piece in pieces], axis=0).tolist()
        if self._balanced and energy != 0.0:
            # beads may be displaced before anything has pushed them
            energy = energy / energy_input if energy_input else np.inf
        budgets = [piece.budget for piece in pieces if piece.budget is not None]
        return Conservation(
            energy_drift=energy,
            momentum_drift=momentum,
            frames=sum(piece.frames for piece in pieces),
            last_time=pieces[-1].last_time,
            front=max(piece.front for piece in pieces) or None,
            participation=pieces[-1].participation,
            budget=AccountMeter(self.problem).result(budgets) if budgets else None,
        )

    def _energy(self, block: Trajectory, energy: Floats) -> tuple[float, float]:
        """Largest deviation of the energy [frame], and largest energy input."""
        system = self.problem.system
        if not system.dampers and not system.holds(Fact.ENERGY) and system.holds(Fact.FRAMES):
            energy = np.full_like(energy, np.nan)
        if not self._balanced:
            return float(np.max(np.abs(energy / physics.energy(system) - 1.0))), np.nan
        if not self._accounted(block):
            return np.nan, np.nan
        energy_input, lost = _exchanged(block)
        missing = energy + physics.weight_energy(system, block.displacement) + np.sum(lost, axis=1) - energy_input
        return float(np.max(np.abs(missing))), float(np.max(np.abs(energy_input)))

    def _momentum(self, block: Trajectory, momentum: Floats) -> float:
        """Largest deviation of the momentum [frame] from that of the kicks and the impulse of forces from outside."""
        system = self.problem.system
        if not system.holds(Fact.MOMENTUM):
            return np.nan
        missing = np.abs(momentum - physics.momentum(system))
        if not physics.acted_on(system):
            return float(np.max(missing) / physics.kick_momenta(system))
        size = physics.kick_momenta(system) + sum(load.law.total for load in system.loads)
        # in the velocity of a bead that is pushed LAMMPS has half a step of the mean of the force
        half = 0.5 * self.problem.timestep
        over = block.time > max(load.end for load in system.loads) + half * (1.0 + 1e-6)
        missing = np.abs(momentum - physics.momentum(system) - self._impulse(block.time))
        if physics.driven(system):
            halfway = 0.5 * (self._impulse(block.time - half) + self._impulse(block.time + half))
            missing = np.minimum(missing, np.abs(momentum - physics.momentum(system) - halfway))
            over = block.time > 0.0
        return float(np.max(missing[over], initial=0.0) / size)

    def _impulse(self, time: Floats) -> Floats:
        """Impulse by all forces from outside until a time."""
        return np.asarray(sum(load.impulse(time) for load in self.problem.system.loads))
