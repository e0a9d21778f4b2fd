"""The dimensionless problem at V = 1 that a scene stands for: what every engine and every analysis computes with.

| paper              | here                    | unit                      |
|--------------------|-------------------------|---------------------------|
| N                  | ``chains``              | -                         |
| epsilon * alpha    | ``kappa``               | m / T**2                  |
| D                  | ``gap``                 | L                         |
| V                  | largest of ``kicks``    | L / T; 1 by construction  |
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from lammps_inputs import laws
from lammps_inputs.facts import Fact
from lammps_inputs.laws.linear import Linear
from lammps_inputs.links import Across, Along, Ground, Link, Wall, largest_eigenvalue
from lammps_inputs.numbers import power_of_two_at_least
from lammps_inputs.scheme import SchemeName
from lammps_inputs.units import Scale


@dataclass(frozen=True, kw_only=True)
class System:
    """Beads of mass 1, the links between them, and how they are hit, so that the fastest starts at 1."""

    chains: int
    beads: int
    kicks: tuple[tuple[int, int, float], ...]
    """(chain, bead, velocity), counted from 1; the largest |velocity| is 1."""
    links: tuple[Link, ...]
    """All forces there are; contacts first."""
    lacks: frozenset[Fact] = frozenset()
    """What does not hold."""

    def holds(self, fact: Fact) -> bool:
        """Whether a fact is true of this system."""
        return fact not in self.lacks

    @property
    def energy(self) -> float:
        """Energy of the kicks."""
        return 0.5 * sum(velocity**2 for _, _, velocity in self.kicks)

    @property
    def momentum(self) -> float:
        """Momentum of the kicks."""
        return sum(velocity for _, _, velocity in self.kicks)

    @cached_property
    def along(self) -> tuple[Along, ...]:
        """The links along the chains."""
        return tuple(link for link in self.links if isinstance(link, Along))

    @cached_property
    def across(self) -> tuple[Across, ...]:
        """The links across the chains."""
        return tuple(link for link in self.links if isinstance(link, Across))

    @cached_property
    def ground(self) -> tuple[Ground, ...]:
        """The links to the ground."""
        return tuple(link for link in self.links if isinstance(link, Ground))

    @cached_property
    def walls(self) -> tuple[Wall, ...]:
        """The links to the ground that only push."""
        return tuple(link for link in self.ground if isinstance(link, Wall))

    @property
    def coupled(self) -> bool:
        """Whether any spring between chains exists."""
        return bool(self.across)

    @property
    def kappa(self) -> float:
        """Stiffness at rest of the springs between chains, the largest if they differ; 0 where there are none."""
        return max((float(np.max(laws.stiffness(link.law, 0.0))) for link in self.across), default=0.0)

    @property
    def gap(self) -> float:
        """Clear distance between neighbouring beads; 0 where they touch."""
        return self.along[0].gap

    @property
    def swing(self) -> float:
        """Angular frequency, at most, of a bead on its springs, those across and those to the ground."""
        return float(np.sqrt(self._springs()))

    @property
    def stiffest_spring(self) -> float:
        """Largest stiffness of any spring, those across and those to the ground; 0 where there are none."""
        return max((laws.stiffest(link.law, self.energy) for link in (*self.across, *self._holding)), default=0.0)

    @property
    def fastest(self) -> float:
        """Angular frequency, at most, of any motion (Gershgorin); energy bounds how stiff a contact can get."""
        contacts = sum(4.0 * laws.stiffest(link.law, self.energy) for link in self.along)
        if self.walls:  # a bead at the end has one contact, and a wall
            contacts = max(contacts, 0.5 * contacts + max(laws.stiffest(link.law, self.energy) for link in self.walls))
        return float(np.sqrt(contacts + self._springs()))

    def _springs(self) -> float:
        across = (laws.stiffest(link.law, self.energy) * largest_eigenvalue(link, self.chains) for link in self.across)
        return sum((*across, *(laws.stiffest(link.law, self.energy) for link in self._holding)), 0.0)

    @property
    def _holding(self) -> tuple[Ground, ...]:
        """The springs to the ground."""
        return tuple(link for link in self.ground if not isinstance(link, Wall))

    @property
    def simply_coupled(self) -> bool:
        """Whether every row swings by the known modes of equal linear springs in an open row of chains, or freely."""
        plain = all(isinstance(link.law, Linear) and not laws.differs(link.law) for link in self.across)
        return plain and all(link.open_row for link in self.across) and not self.ground

    @property
    def diameter(self) -> float:
        """Bead diameter in LAMMPS: a power of two, so that touching is exact, and never small enough for second
        neighbours to meet or for one overlap to reach half of it. The dynamics do not depend on it.
        """
        alone, shared = (laws.reach(self.along[0].law, energy) for energy in (self.energy, self.energy / 2.0))
        walls = (2.0 * float(np.max(link.law.overlap(self.energy))) for link in self.walls)
        return power_of_two_at_least(max(4.0, 2.0 * alone, 2.0 * shared, *walls))

    @property
    def spacing(self) -> float:
        """Distance between the centres of neighbouring beads at rest, in LAMMPS."""
        return self.diameter + self.gap

    def initial_velocity(self) -> NDArray[np.float64]:
        """Velocities at the start, [chain, bead]; displacements are zero."""
        velocity = np.zeros((self.chains, self.beads))
        for chain, bead, value in self.kicks:
            velocity[chain - 1, bead - 1] = value
        return velocity


@dataclass(frozen=True, kw_only=True)
class Problem(System):
    """A system, over how long it is followed, and what is recorded."""

    name: str
    timestep: float
    steps_per_frame: int
    frames: int
    """Recorded instants after the start; the start itself is frame 0."""
    recorded: tuple[int, ...] | None
    """Beads of every chain that are recorded, ascending; None for all."""
    scale: Scale
    peaks: bool = False
    """Whether the leading pulse is found at every bead while LAMMPS runs, whichever beads are recorded."""
    frames_per_snapshot: int | None = None
    """Frames from one snapshot of all beads to the next; None where there are none."""
    scheme: SchemeName = "verlet"
    """Of LAMMPS; ``timestep`` and ``steps`` are those of its Verlet steps, on average over a cycle."""
    window: int | None = None
    """Rows that exist, near the front; None for all."""

    @property
    def steps(self) -> int:
        """Time steps from start to end."""
        return self.frames * self.steps_per_frame

    @property
    def every(self) -> float:
        """Time between two frames."""
        return self.timestep * self.steps_per_frame

    @property
    def duration(self) -> float:
        """Time of the last frame."""
        return self.frames * self.every

    @property
    def rows(self) -> int:
        """Rows of beads that exist in LAMMPS."""
        return self.window or self.beads

    @property
    def rows_a_frame(self) -> int:
        """Rows of beads that a frame holds."""
        return self.rows if self.recorded is None else len(self.recorded)

    @property
    def whole(self) -> bool:
        """Whether every frame holds every bead, so that the states obey the conservation laws."""
        return self.recorded is None and self.window is None

    @property
    def recorded_beads(self) -> NDArray[np.int64]:
        """Numbers of the recorded beads, counted from 1."""
        if self.recorded is None:
            return np.arange(1, self.beads + 1)
        return np.array(self.recorded, dtype=np.int64)

    def coarser(self, stride: int) -> "Problem":
        """The same problem with only every stride-th frame."""
        return replace(self, steps_per_frame=self.steps_per_frame * stride, frames=self.frames // stride)

    def snapshots(self) -> "Problem":
        """The same problem with its snapshots of all beads as frames.

        Raises:
            ValueError: it has none.
        """
        if self.frames_per_snapshot is None:
            raise ValueError("this problem has no snapshots")
        return replace(self.coarser(self.frames_per_snapshot), recorded=None, peaks=False, frames_per_snapshot=None)
