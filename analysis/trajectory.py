"""A trajectory: what every engine returns and every analysis reads, dimensionless and in float64.

Examples in this package analyse a short run of the reference integrator.

Examples:
    >>> engine.run(granchain.load("one-chain", {"beads": 20, "duration": 30.0}).problem())
    <trajectory of one-chain: 301 frames of 1 x 20 beads, to t = 30 T, in units of T, L and V>
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from lammps_inputs import Problem, System, laws, physics
from lammps_inputs.links import Links

Floats = NDArray[np.float64]
"""Array of float64; the docstring of a function or field has its shape and unit.

Examples:
    >>> def kinetic_energy(velocity: Floats) -> Floats:
    ...     "Kinetic energy of beads of mass m, [bead] in units of m V**2, at velocities [bead] in units of V."
    ...     return 0.5 * velocity**2
    >>> kinetic_energy(np.array([1.0, 0.5]))
    array([0.5  , 0.125])
"""

Integers = NDArray[np.int64]
"""Array of int64, such as numbers of beads, counted from 1, or positions along an axis, counted from 0.

Examples:
    >>> beads: Integers = np.array([10, 20])  # numbers
    >>> beads - 1  # their positions
    array([ 9, 19])
"""

Flags = NDArray[np.bool_]
"""Array of true and false, such as a mask of beads or frames.

Examples:
    >>> moving: Flags = np.array([0.7, 1e-6, 0.0]) > 1e-3  # [bead]
    >>> moving
    array([ True, False, False])
"""

BLOCK_BYTES = 1 << 22
LEAST_FRAMES = 8

EXCHANGES = ("along", "across", "ground", "walls", "energy_input")
"""Energy dissipated by the dashpots of each kind of link and of walls; work of outer forces and prescribed motions."""


def frames_per_block(problem: Problem) -> int:
    """Frames in one piece of a long trajectory: about 4 MB, or at least 8; by 1 MB an analysis takes a fifth longer.

    Args:
        problem: problem whose frames are read or made piece by piece.

    Returns:
        Number of frames.

    Examples:
        >>> [frames_per_block(granchain.load(name).problem()) for name in ("one-chain", "two-chains")]
        [2184, 1092]
    """
    return max(LEAST_FRAMES, BLOCK_BYTES // (16 * problem.chains * problem.rows.count))


class FramesInUnits(NamedTuple):
    """Frames in the units of a scene: SI, or reduced ones. MDAnalysis has one frame in each: a number, and [atom]."""

    time: Floats
    """[frame]"""
    displacement: Floats
    """[frame, chain, bead]"""
    velocity: Floats
    """[frame, chain, bead]"""

    def __repr__(self) -> str:
        size = _size(self.velocity) if self.velocity.ndim == 3 else f"one frame of {len(self.velocity)} beads"
        return f"<{size}: time, displacement, velocity in the scene's units>"


def _size(frames: Floats) -> str:
    count, chains, beads = frames.shape
    return f"{count} frames of {chains} x {beads} beads"


@dataclass(frozen=True, repr=False)
class Trajectory:
    """Consecutive frames of a run, or all of them.

    Attributes:
        problem: what was computed; ``problem.scale`` turns the numbers below into the scene's units.
        time: [frame], in units of T.
        displacement: [frame, chain, bead] along the chain, in units of L; 0 at the start.
        velocity: [frame, chain, bead], in units of V.
        first: bead that the last axis begins with; more than 1 in a window that has followed the pulse.
        exchange: [frame, `EXCHANGES`] energy that was exchanged until each frame, in units of m V**2; None where it was
            not counted, or nothing is exchanged.
        contact_state: [frame, chain, bead + 1] state of each contact whose force depends on one: of the wall before the
            first bead, of the contact behind each other bead, of the wall behind the last; None where no force does, or
            a file holds not all beads.
        further_lines: [frame, 2, line, bead] displacement and velocity of lines of atoms that are no beads, 0 where
            there is none; None where they were not recorded.

    Examples:
        >>> frames = engine.run(granchain.load("one-chain", {"beads": 20, "duration": 30.0}).problem())
        >>> frames.velocity.shape  # [frame, chain, bead]
        (301, 1, 20)
        >>> frames[-2:].time, frames.velocity[-2:, 0, frames.bead(20)].round(3)  # in units of T and V
        (array([29.9, 30. ]), array([0.986, 0.986]))
        >>> frames.problem.chains, frames.problem.every  # with all that was computed
        (1, 0.1)
    """

    problem: Problem
    time: Floats
    displacement: Floats
    velocity: Floats
    first: int = 1
    exchange: Floats | None = None
    contact_state: Floats | None = None
    further_lines: Floats | None = None

    def __repr__(self) -> str:
        until = f"to t = {self.time[-1]:.6g} T" if len(self.time) else "none yet"
        return f"<trajectory of {self.problem.name}: {_size(self.velocity)}, {until}, in units of T, L and V>"

    @classmethod
    def of_atoms(
        cls,
        problem: Problem,
        time: Floats,
        displacement: Floats,
        velocity: Floats,
        first: int = 1,
        exchange: Floats | None = None,
        contact_state: Floats | None = None,
    ) -> "Trajectory":
        """Frames of arrays of all atoms, the chains' first and further lines after them, if at all.

        Args:
            problem: what was computed.
            time: [frame] in units of T.
            displacement: [frame, line, bead] in units of L.
            velocity: [frame, line, bead] in units of V.
            first: bead that the last axis begins with.
            exchange: [frame, `EXCHANGES`] in units of m V**2.
            contact_state: [frame, chain, bead + 1], as of `Trajectory`.

        Returns:
            The frames.
        """
        chains = problem.chains
        further = np.stack([displacement, velocity], axis=1)[:, :, chains:] if displacement.shape[1] > chains else None
        return cls(
            problem, time, displacement[:, :chains], velocity[:, :chains], first, exchange, contact_state, further
        )

    @classmethod
    def of_columns(cls, problem: Problem, time: Floats, columns: Floats) -> "Trajectory":
        """Frames of columns as files hold them, of displacements, velocities, and `Problem.state_columns`.

        Args:
            problem: what was computed.
            time: [frame] in units of T.
            columns: [frame, column, chain, recorded bead].

        Returns:
            The frames.
        """
        states, behind = None, columns[:, 2:]
        if behind.shape[1]:
            walls = behind[:, 1, :, -1:] if behind.shape[1] > 1 else np.zeros_like(behind[:, 0, :, -1:])
            states = np.concatenate([behind[:, 0], walls], axis=-1)
        return cls(problem, time, columns[:, 0], columns[:, 1], contact_state=states)

    def blocks(self) -> Iterator["Trajectory"]:
        """Consecutive parts of bounded size, like those of a trajectory that is read from a file."""
        size = frames_per_block(self.problem)
        for start in range(0, self.frames, size):
            yield self[start : start + size]

    @property
    def beads(self) -> Integers:
        """Numbers of the beads along the last axis, [bead] counted from 1.

        Returns:
            The numbers, counted from 1.

        Examples:
            >>> frames = granchain.run("one-chain", "run-beads", engine="reference").trajectory
            >>> frames.beads[:3]
            array([1, 2, 3])
        """
        if self.problem.rows.follow:
            return np.arange(self.first, self.first + self.velocity.shape[2])
        return self.problem.rows.numbers

    @property
    def frames(self) -> int:
        """Number of frames.

        Returns:
            The number.

        Examples:
            >>> frames = granchain.run("one-chain", "run-frames", engine="reference").trajectory
            >>> frames.frames == len(frames.time)
            True
        """
        return len(self.time)

    @property
    def atoms(self) -> tuple[Floats, Floats]:
        """Displacement and velocity, [frame, line, bead] in units of L and V, of chains and then further lines."""
        x, v = self.displacement, self.velocity
        if self.further_lines is None:
            return x, v
        further_x, further_v = self.further_lines[:, 0], self.further_lines[:, 1]
        return np.concatenate([x, further_x], axis=1), np.concatenate([v, further_v], axis=1)

    @property
    def all_lines(self) -> bool:
        """Whether every frame holds all lines of atoms that the system has."""
        return self.further_lines is not None or physics.lines(self.problem.system) == self.problem.chains

    @property
    def spacing(self) -> float:
        """Time between two frames, in units of T: a multiple of the problem's to the last bit."""
        every = self.problem.every
        return every * max(1, round(float(self.time[1] - self.time[0]) / every))

    def measured(self) -> FramesInUnits:
        """Time, displacement and velocity of these frames in the scene's units.

        Returns:
            The frames, in SI or reduced units.

        Examples:
            >>> frames = granchain.run("one-chain", "run-measured", engine="reference").trajectory
            >>> frames.measured().velocity.shape == frames.velocity.shape
            True
        """
        scale = self.problem.scale
        return FramesInUnits(self.time * scale.time, self.displacement * scale.length, self.velocity * scale.velocity)

    def _each(self, change: Callable[[Floats], Floats]) -> "Trajectory":
        """Trajectory with all its arrays changed; their first axis is that of frames."""
        attributes = vars(self).items()
        arrays: dict[str, Any] = {name: change(values) for name, values in attributes if isinstance(values, np.ndarray)}
        return replace(self, **arrays)

    def __getitem__(self, frames: slice | Integers) -> "Trajectory":
        """Some frames of this trajectory."""
        return self._each(lambda values: values[frames])

    @property
    def system(self) -> System:
        """The system at the times of these frames; laws whose force depends on a state of each contact have it."""
        return self.system_at(slice(None))

    @property
    def forces_known(self) -> bool:
        """Whether every frame determines the forces on its beads, with the states of contacts."""
        return self.problem.forces_known or (self.contact_state is not None and self.problem.rows.neighbours)

    def states(self) -> Iterator[tuple[Floats, ...]]:
        """Columns of each frame as files hold them: displacements, velocities, and `Problem.state_columns`.

        Yields:
            Displacements and velocities of all atoms, [line, bead] in units of L and V; each other [chain, bead].
        """
        names, states = self.problem.state_columns, self.contact_state
        columns = [] if states is None else [states[..., k : states.shape[-1] + k - 1] for k in range(len(names))]
        yield from zip(*self.atoms, *columns, strict=True)

    def system_at(self, frames: slice | int | Integers, time: Floats | None = None) -> System:
        """The system at the times of some frames, or of one, or at other times, with the states of contacts of frames.

        Args:
            frames: chosen frames, [entry], or one.
            time: [..., entry] times in units of T; by default those of the frames.

        Returns:
            The system, whose laws that vary in time or have a state hold arrays [entry, ...].
        """
        system = physics.at(self.problem.system, self.time[frames] if time is None else time)
        return system if self.contact_state is None else physics.at_contact_state(system, self.contact_state[frames])

    def law(self, link: Links, frame: Integers, chain: Integers, place: Integers) -> Any:
        """Law of chosen links along chains or to the ground, in the state of their contacts at frames.

        Args:
            link: links of the system.
            frame: [...] positions of the frames.
            chain: [...] positions of the chains, from 0.
            place: [...] positions of the links along the last axis of their arrays, from 0.

        Returns:
            The law, whose parameters that differ are arrays [...].
        """
        law = laws.at(link.law, chain, place)
        if self.contact_state is None or not laws.has_state(law):
            return law
        return laws.at_state(law, self.contact_state[frame, chain, place + link.between.start])

    def states_of_contacts(self, places: int | Integers) -> Floats | None:
        """States of some contacts of each chain, dimensionless; None where no force depends on one.

        Args:
            places: position of one contact in `contact_state`, from 0, or [place] positions.

        Returns:
            The states, [frame, chain] of one contact or [frame, chain, place], or None.
        """
        return None if self.contact_state is None else self.contact_state[:, :, places]

    def with_motion(self, time: Floats, displacement: Floats, velocity: Floats) -> "Trajectory":
        """Frames of the same beads at other times, in the states of contacts of these.

        Args:
            time: [frame] in units of T.
            displacement: [frame, line, bead] in units of L, further lines of atoms after the chains.
            velocity: [frame, line, bead] in units of V.

        Returns:
            The new frames.
        """
        moved = Trajectory.of_atoms(self.problem, time, displacement, velocity, self.first)
        return replace(moved, contact_state=self.contact_state)

    def last(self, frames: int = 1) -> "Trajectory":
        """The last frame or frames, copied, so that they keep no others."""
        return self[-frames:]._each(np.copy)

    @cached_property
    def moving(self) -> slice:
        """The beads that any of these frames shows displaced or moving, and one at rest on either side.

        Nothing runs ahead of a pulse, so most of a long chain has nothing to compute for most of a run.
        """
        return self.moving_at(slice(None))

    def moving_at(self, frames: slice | Integers) -> slice:
        """Beads that some frames show displaced or moving, and one on either side.

        Args:
            frames: [frame] positions of the frames, or a slice of them.

        Returns:
            Range of positions along the last axis.
        """
        if self.problem.system.closing:  # the first bead is beside the last
            return slice(0, self.velocity.shape[2])
        moved = np.any(self.velocity[frames], axis=(0, 1)) | np.any(self.displacement[frames], axis=(0, 1))
        places = np.flatnonzero(moved)
        if len(places) == 0:
            return slice(0, 1)
        return slice(max(0, int(places[0]) - 1), int(places[-1]) + 2)

    def on(self, first: int, last: int, *, behind: float = 0.0) -> "Trajectory":
        """These frames at other consecutive beads, some of which a window does not hold.

        Args:
            first: number of the first bead.
            last: number of the last bead.
            behind: displacement and velocity of beads that the window has left; those ahead of it have 0.

        Returns:
            The frames.
        """
        count = self.velocity.shape[2]
        if (first, last) == (self.first, self.first + count - 1):
            return self
        common = slice(max(first, self.first) - self.first, max(0, last - self.first + 1))
        lost = min(max(0, self.first - first), last - first + 1)
        ahead = min(max(0, last - (self.first + count - 1)), last - first + 1)

        def moved(values: Floats) -> Floats:
            """Values, [frame, chain, bead], at the other beads."""
            sides = ((0, 0), (0, 0), (lost, ahead))
            return np.pad(values[..., common], sides, constant_values=((0, 0), (0, 0), (behind, 0)))

        return replace(self, displacement=moved(self.displacement), velocity=moved(self.velocity), first=first)

    def recorded_in(self, problem: Problem, columns: Integers) -> "Trajectory":
        """These frames of a problem that records some of their beads, without atoms that are no beads.

        Args:
            problem: what records these beads.
            columns: [bead] positions of the beads along the last axis.

        Returns:
            The frames of these beads.
        """
        x, v = self.displacement[..., columns], self.velocity[..., columns]
        return replace(self, problem=problem, displacement=x, velocity=v, further_lines=None)

    def positions(self, beads: Any) -> Integers:
        """Positions of recorded beads along the last axis; outside it where a window does not hold a bead.

        Args:
            beads: numbers of the beads, from 1.

        Returns:
            The positions, from 0, in the shape of ``beads``.

        Examples:
            >>> frames = granchain.run("one-chain", "run-positions", engine="reference").trajectory
            >>> frames.positions([10, 20])
            array([ 9, 19])
        """
        return self.problem.rows.positions(beads, self.first)

    def bead(self, number: int) -> int:
        """Position of a bead (counted from 1) along the last axis.

        Args:
            number: number of the bead.

        Returns:
            The position, from 0.

        Raises:
            ValueError: the bead was not recorded.

        Examples:
            >>> frames = granchain.run("one-chain", "run-bead", engine="reference").trajectory
            >>> frames.bead(10)
            9
        """
        positions = np.flatnonzero(self.beads == number)
        if len(positions) == 0:
            raise ValueError(f"bead {number} was not recorded")
        return int(positions[0])


def joined(blocks: Iterable[Trajectory]) -> Trajectory:
    """One trajectory of consecutive blocks.

    Args:
        blocks: consecutive frames.

    Returns:
        All frames in one trajectory.

    Raises:
        ValueError: there is no block.

    Examples:
        >>> frames = engine.run(granchain.load("one-chain", {"beads": 20, "duration": 30.0}).problem())
        >>> joined([frames[:100], frames[100:]]).frames
        301
    """
    parts = list(blocks)
    if not parts:
        raise ValueError("no frame to join")
    if len(parts) == 1:
        return parts[0]
    if parts[0].problem.rows.follow:
        first, last = min(part.beads[0] for part in parts), max(part.beads[-1] for part in parts)
        parts = [part.on(int(first), int(last), behind=np.nan) for part in parts]
    arrays: dict[str, Any] = dict.fromkeys(("exchange", "contact_state", "further_lines"))
    for field in fields(Trajectory):
        values = [getattr(part, field.name) for part in parts]
        if all(isinstance(array, np.ndarray) for array in values):
            arrays[field.name] = np.concatenate(values)
    return replace(parts[0], **arrays)


Number = TypeVar("Number", int, Integers)


def along_the_way(problem: Problem, bead: Number, direction: int | None = None) -> Number:
    """Number of a bead counted along the way of a pulse, from the end that it comes from; twice is the bead itself.

    Args:
        problem: what was run.
        bead: number of the bead, or [...] numbers.
        direction: of the pulse: 1 towards higher bead numbers, -1 towards lower ones; by default of the leading pulse.

    Returns:
        The number, of the shape of ``bead``.
    """
    return bead if (direction or problem.direction) > 0 else problem.beads + 1 - bead
