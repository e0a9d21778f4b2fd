"""What a page holds of a run: some chains, beads and frames of it as they are, so that every number is the run's.

Also in which units it shows them: those of the run's figures, so that axes need no powers of ten.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from granchain.parts import Fact, Floats, Integers, Problem, Trajectory, motion, physics, spacetime
from workflow.plugins.pages.units import Units, page_unit

MOST_BEADS = 500
"""Of a chain."""

MOST_NUMBERS = 330_000
"""Beads times frames that the run recorded; a page has sixteen bytes for each."""

MOST_HELD = 4_000_000
"""Beads times frames with those around a window, which take a browser's memory, but next to none of the page."""


@dataclass(frozen=True)
class Thinned:
    """Part of a run, dimensionless.

    Attributes:
        chains, beads: which, counted from 1.
        time: [frame].
        displacement: [chain, frame, bead].
        velocity: likewise; of the run's frames that are nearest to this one, the largest in size, so that peaks stay.
        overlap, force: of each bead with the next of its chain, 0 where they are apart, [chain, frame, bead]; NaN where
            that is not known, and of rigid beads.
        density: energy of each bead, [chain, frame, bead]; NaN where not every bead was recorded.
        energy: of each chain's beads, [chain, frame]; likewise.
        others: displacement of lines of atoms that are no beads, [line, frame, bead]; NaN where there is no atom.
        chain_of_other: number of the chain that each of these lines belongs to.
        bead_stride, frame_stride: every how many there are here.
    """

    chains: list[int]
    beads: Integers
    time: Floats
    displacement: Floats
    velocity: Floats
    overlap: Floats
    force: Floats
    density: Floats
    energy: Floats
    others: Floats
    chain_of_other: list[int]
    bead_stride: int
    frame_stride: int

    @property
    def even(self) -> bool:
        """Whether the beads are evenly spaced, or one."""
        return len(np.unique(np.diff(self.beads))) < 2

    @property
    def places(self) -> Floats:
        """[bead] where each is drawn: at its number, or, where they are unevenly spaced, side by side from 0."""
        return np.asarray(self.beads if self.even else np.arange(len(self.beads)), dtype=float)

    @property
    def spacing(self) -> float:
        """Distance between two neighbouring places, in beads or recorded beads."""
        return float(self.places[1] - self.places[0]) if len(self.beads) > 1 else 1.0

    @property
    def every(self) -> float:
        """Time from one frame to the next."""
        return float(self.time[1] - self.time[0]) if len(self.time) > 1 else 1.0

    def measured(self, units: Units) -> "Thinned":
        """Thinned run with its arrays in units of the page, such as ms and mm/s."""
        kinds = {name: name for name in ("time", "velocity", "force", "energy")}
        kinds |= {"displacement": "length", "overlap": "length", "density": "energy", "others": "length"}
        return replace(self, **{name: getattr(self, name) * units[kind].worth for name, kind in kinds.items()})


def thinned(
    problem: Problem,
    blocks: Iterable[Trajectory],
    chains: list[int],
    *,
    most_numbers: int = MOST_NUMBERS,
    deforms: bool = True,
    energies: bool = True,
) -> Thinned:
    """Every n-th bead and m-th frame of some chains.

    Args:
        problem: what was run.
        blocks: all of its frames.
        chains: which to keep, counted from 0.
        most_numbers: numbers that are kept of each kind, about.
        deforms: whether overlaps and forces are shown, where beads have some.
        energies: whether energies are shown, of frames of all beads.
    """
    recorded = problem.rows.numbers
    beads = slice(None, None, max(1, -(-len(recorded) // MOST_BEADS)))
    numbers = (problem.frames + 1) * len(chains)
    recorded_numbers = numbers * problem.rows.count // beads.step
    stride = max(1, -(-recorded_numbers // most_numbers), -(-numbers * len(recorded[beads]) // MOST_HELD))
    lines = np.flatnonzero(np.isin(problem.system.chain_of_line, chains))
    lines = lines[lines >= problem.chains]
    parts: list[tuple[Floats, ...]] = []
    nearest: list[Integers] = []  # number of the kept frame that each of some velocities is nearest to
    fastest: list[Floats] = []
    frames_read = 0
    for block in blocks:
        frames = _whole(block[-frames_read % stride :: stride])
        density = _energy(frames, energies)
        of_beads = (values[:, chains, beads] for values in (*_of(frames, deforms), density))
        parts.append((frames.time, density.sum(axis=-1)[:, chains], _others(frames, lines)[..., beads], *of_beads))
        near = (np.arange(frames_read, frames_read + block.frames) + stride // 2) // stride
        near, first = np.unique(near, return_index=True)
        largest = replace(block, displacement=block.displacement[first], velocity=_largest(block.velocity, first))
        nearest.append(near)
        fastest.append(_whole(largest).velocity[:, chains, beads])
        frames_read += block.frames
    time, energy, others, *values = (np.concatenate(kind) for kind in zip(*parts, strict=True))
    near = np.minimum(np.concatenate(nearest), len(time) - 1)  # the last frames are nearer to one that would follow
    values.append(_largest(np.concatenate(fastest), np.unique(near, return_index=True)[1]))
    x, overlap, force, density, v = (np.ascontiguousarray(kind.transpose(1, 0, 2)) for kind in values)
    return Thinned(
        chains=[chain + 1 for chain in chains],
        beads=recorded[beads],
        time=time,
        displacement=x,
        velocity=v,
        overlap=overlap,
        force=force,
        density=density,
        energy=energy.T,
        others=np.ascontiguousarray(others.transpose(1, 0, 2)),
        chain_of_other=(problem.system.chain_of_line[lines] + 1).tolist()[: others.shape[1]],
        bead_stride=beads.step,
        frame_stride=stride,
    )


def _whole(frames: Trajectory) -> Trajectory:
    """Frames of all rows, also where a window follows the pulse; NaN where it has left."""
    return frames.on(1, frames.problem.beads, behind=np.nan) if frames.problem.rows.follow else frames


def _largest(values: Floats, first: NDArray[np.intp]) -> Floats:
    """Value of the largest size among the frames from each first one to the next; NaN where all are NaN."""
    highest, lowest = np.fmax.reduceat(values, first, axis=0), np.fmin.reduceat(values, first, axis=0)
    return np.asarray(np.where(highest >= -lowest, highest, lowest))


def _of(frames: Trajectory, deforms: bool) -> tuple[Floats, Floats, Floats]:
    """Displacement, and overlap and force of each bead with the next, all [frame, chain, bead]."""
    problem, x = frames.problem, frames.displacement
    overlap, force = np.full_like(x, np.nan), np.full_like(x, np.nan)
    if problem.rows.neighbours and deforms and problem.system.holds(Fact.OVERLAPS):
        of_contacts = motion.overlaps(problem.system, x)
        contacts = slice(of_contacts.shape[-1])
        overlap[..., contacts] = np.maximum(of_contacts, 0.0)
        force[..., contacts] = motion.contact_force(frames.system, of_contacts)
    return x, overlap, force


def _energy(frames: Trajectory, energies: bool) -> Floats:
    """Energy of each bead, [frame, chain, bead]; NaN where it is not shown or not all beads are recorded."""
    if not (energies and frames.problem.rows.complete):
        return np.full(frames.velocity.shape, np.nan)
    return motion.bead_energy(frames.system, frames.displacement, frames.velocity)


def _others(frames: Trajectory, lines: Integers) -> Floats:
    """Displacement of other atoms, [frame, line, bead]; NaN where there is no atom, no line where not recorded."""
    if not (len(lines) and frames.all_lines):
        return np.zeros((frames.frames, 0, frames.displacement.shape[-1]))
    mass = np.asarray(physics.masses(frames.problem.system))
    return np.where(mass[lines] > 0.0, frames.atoms[0][:, lines], np.nan)


# --- units ------------------------------------------------------------------------------------------------------------


def units_of(problem: Problem, part: Thinned) -> Units:
    """Units of time, velocity, length, force and energy; reduced ones as they are, without a symbol.

    Args:
        problem: what was run.
        part: of its frames, dimensionless.
    """
    largest = {
        "time": float(part.time[-1]),
        "velocity": spacetime.RootScale.of(problem, part.beads, part.velocity).limit,
        "length": _size(part.displacement),
        "force": _size(part.force),
        "energy": _size(part.energy),
    }
    return {name: page_unit(problem, name, size) for name, size in largest.items()}


def _size(values: np.ndarray) -> float:
    return float(np.nanmax(np.abs(values), initial=0.0))
