"""What every engine and every analysis computes with: a system, over how long it is followed, and what is recorded."""

from dataclasses import dataclass, replace
from functools import cached_property

from lammps_inputs import physics
from lammps_inputs.deck_lines import BeadLayout
from lammps_inputs.facts import Fact
from lammps_inputs.layout import layout_of
from lammps_inputs.limits import rates
from lammps_inputs.rows import Rows
from lammps_inputs.scheme import SchemeName, cycle
from lammps_inputs.system import System
from lammps_inputs.units import Scale

LOOK = 2.0
"""Time between two looks at the front that rows follow, in units of T, in which a pulse passes two beads at most."""


@dataclass(frozen=True, kw_only=True)
class Problem:
    """A system, over how long it is followed, and what is recorded.

    Examples:
        >>> problem = granchain.load("two-chains").problem()
        >>> problem.chains, problem.beads, problem.frames
        (2, 120, 1920)
        >>> problem.every == problem.steps_per_frame * problem.timestep  # in units of T
        True
    """

    system: System
    name: str
    timestep: float
    steps_per_frame: int
    frames: int
    """Recorded instants after the start; the start itself is frame 0."""
    rows: Rows
    """Beads of every chain that exist in LAMMPS, and those that frames hold."""
    scale: Scale
    scheme: SchemeName = "verlet"
    """Integration scheme of LAMMPS; ``timestep`` and ``steps`` are those of its Verlet steps, averaged over a cycle."""

    def __post_init__(self) -> None:
        if self.rows.beads != self.system.beads:
            raise ValueError(f"rows of {self.rows.beads} beads, but the chains have {self.system.beads}")

    @property
    def chains(self) -> int:
        """Number of chains."""
        return self.system.chains

    @property
    def lines(self) -> int:
        """Lines of atoms in a frame: the chains, and further lines after them where all beads are recorded."""
        return physics.lines(self.system) if self.rows.neighbours else self.system.chains

    @property
    def beads(self) -> int:
        """Number of beads of each chain."""
        return self.system.beads

    @cached_property
    def layout(self) -> BeadLayout:
        """Diameter and places of the beads in LAMMPS."""
        layout = layout_of(self.system)
        return replace(layout, rows=self.rows.existing) if self.rows.follow else layout

    @property
    def cycle(self) -> int:
        """Verlet steps in a cycle of the scheme."""
        return cycle(self.scheme)

    @cached_property
    def steps_between_stops(self) -> int:
        """Steps between which a run may stop: a cycle of the scheme; where rows follow the front, those between two
        looks at it.
        """
        cycle = self.cycle
        if not self.rows.follow:
            return cycle
        return max(1, int(LOOK / (rates.front_speed(self.system) * self.timestep)) // cycle) * cycle

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
    def forces_known(self) -> bool:
        """Whether every frame determines the forces on its beads, but for those at the ends of rows that follow."""
        return self.rows.neighbours and self.system.holds(Fact.FRAMES)

    @property
    def direction(self) -> int:
        """Direction of the largest excitation, and so of the leading pulse: 1 towards the last bead, else -1."""
        _, _, excitation = physics.largest_excitation(self.system)
        return 1 if excitation > 0.0 else -1

    @property
    def columns(self) -> tuple[str, ...]:
        """Columns of a dump after the atoms' numbers."""
        return ("mol", "x", "vx") if self.rows.follow else ("x", "vx", *self.state_columns)

    @property
    def state_columns(self) -> tuple[str, ...]:
        """Columns of a dump with the state of the contact behind each bead, and of that ahead where a wall is behind
        the last bead; none where no force depends on one, or not all beads are recorded.
        """
        return physics.state_headings(self.system) if self.rows.neighbours else ()

    def coarser(self, stride: int) -> "Problem":
        """Problem with only every stride-th frame."""
        return replace(self, steps_per_frame=self.steps_per_frame * stride, frames=self.frames // stride)
