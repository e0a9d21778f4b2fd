"""The dimensionless problem at V = 1 that a scene stands for: what every engine and every analysis computes with.

| paper              | here                    | unit                      |
|--------------------|-------------------------|---------------------------|
| N                  | ``chains``              | -                         |
| epsilon * alpha    | ``kappa``               | m / T**2                  |
| D                  | ``gap``                 | L                         |
| V                  | largest of ``kicks``    | L / T; 1 by construction  |
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from lammps_inputs import contact
from lammps_inputs.scheme import SchemeName
from lammps_inputs.units import Scale


@dataclass(frozen=True)
class Problem:
    """Chains of beads of mass 1 and contact force ``overlap**1.5``, hit so that the fastest bead starts at 1."""

    name: str
    chains: int
    beads: int
    kicks: tuple[tuple[int, int, float], ...]
    """(chain, bead, velocity), counted from 1; the largest |velocity| is 1."""
    kappa: float
    """Stiffness of the springs between neighbouring chains; 0 where there are none."""
    gap: float
    """Clear distance between neighbouring beads; 0 where they touch."""
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
    def energy(self) -> float:
        """Energy of the kicks, conserved by the equations."""
        return 0.5 * sum(velocity**2 for _, _, velocity in self.kicks)

    @property
    def momentum(self) -> float:
        """Momentum of the kicks, conserved by the equations."""
        return sum(velocity for _, _, velocity in self.kicks)

    @property
    def coupled(self) -> bool:
        """Whether any spring exists."""
        return self.kappa > 0.0 and self.chains > 1

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

    @property
    def diameter(self) -> float:
        """Bead diameter in LAMMPS; the dynamics do not depend on it."""
        return contact.bead_diameter(self.energy)

    @property
    def spacing(self) -> float:
        """Distance between the centres of neighbouring beads at rest, in LAMMPS."""
        return self.diameter + self.gap

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

    def initial_velocity(self) -> NDArray[np.float64]:
        """Velocities at the start, [chain, bead]; displacements are zero."""
        velocity = np.zeros((self.chains, self.beads))
        for chain, bead, value in self.kicks:
            velocity[chain - 1, bead - 1] = value
        return velocity
