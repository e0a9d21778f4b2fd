"""The dimensionless problem at V = 1 that a scene stands for: what every engine and every analysis computes with.

| paper              | here                    | unit                      |
|--------------------|-------------------------|---------------------------|
| N                  | ``chains``              | -                         |
| epsilon * alpha    | ``kappa``               | m / T**2                  |
| D                  | ``gap``                 | L                         |
| V                  | largest of ``struck``   | L / T; 1 by construction  |
"""

import math
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from lammps_inputs import laws
from lammps_inputs.facts import Fact
from lammps_inputs.laws.dashpot import ContactLoss
from lammps_inputs.laws.linear import Linear
from lammps_inputs.laws.wall_dashpot import WallDashpot
from lammps_inputs.links import Across, Along, Ground, Link, Wall, WallDamper
from lammps_inputs.loads import Load, Motion
from lammps_inputs.numbers import power_of_two_at_least, text
from lammps_inputs.scheme import SchemeName
from lammps_inputs.units import Scale

PLACES = "places"
"""Fix of LAMMPS that has noted where beads rest, where that is no formula of their numbers."""

_FASTER = 4.0
"""Velocity that beads beside a driven one are taken to reach at most, in the drive's own."""


@dataclass(frozen=True, kw_only=True, eq=False)
class System:
    """Beads, the links between them, and how they are hit, so that the fastest starts at 1."""

    chains: int
    beads: int
    kicks: tuple[tuple[int, int, float], ...]
    """(chain, bead, velocity), counted from 1; the largest |velocity| is 1."""
    links: tuple[Link, ...]
    """All forces there are; contacts first."""
    mass: float | NDArray[np.float64] = 1.0
    """1 where all beads have the reference bead's, else [chain, bead]."""
    lacks: frozenset[Fact] = frozenset()
    """What does not hold."""
    loads: tuple[Load, ...] = ()
    """Forces on beads from outside, over time."""
    motions: tuple[Motion, ...] = ()
    """Beads whose motion is given."""
    dampers: tuple[Link, ...] = ()
    """Forces against velocities: links with laws of damping."""

    def __eq__(self, other: object) -> bool:
        """Whether all is the same, to the last number of every array."""
        if type(self) is not type(other):
            return False
        pairs = ((getattr(self, field.name), getattr(other, field.name)) for field in fields(self))
        return all(np.array_equal(a, b) if isinstance(a, np.ndarray) else _same(a, b) for a, b in pairs)

    def __hash__(self) -> int:
        return hash((type(self), self.chains, self.beads, self.kicks, self.links))

    def mass_of(self, *index: Any) -> Any:
        """Mass of chosen beads, an index of [chain, bead] from 0; the number where all have the same."""
        return self.mass if isinstance(self.mass, float) else self.mass[index]

    def mass_from(self, first: int, array: NDArray[np.float64]) -> Any:
        """Mass of the beads of an array [..., chain, bead] that begins with bead ``first``."""
        return self.mass_of(Ellipsis, slice(first - 1, first - 1 + array.shape[-1]))

    @cached_property
    def alike(self) -> bool:
        """Whether all beads, and all their contacts, are the same."""
        return isinstance(self.mass, float) and not any(laws.differs(link.law) for link in self.along)

    @cached_property
    def one_kind(self) -> bool:
        """Whether all beads are the same, and all contacts but for the load that they bear."""
        return isinstance(self.mass, float) and not any(np.ndim(laws.strength(link.law)) for link in self.along)

    def holds(self, fact: Fact) -> bool:
        """Whether a fact is true of this system."""
        return fact not in self.lacks

    @property
    def energy(self) -> float:
        """Energy of the kicks; with loads the most that they and the kicks can put in: that of free beads.

        What never ends puts in without end; then it is what one contact is taken to hold, that of beads some times
        faster than the drive. Runs are checked for overlaps that LAMMPS could not hold.
        """
        kicked = 0.5 * sum(self._kicked_mass(kick) * kick[2] ** 2 for kick in self.kicks)
        if not self.driven and not self.loads:
            return kicked
        # a force F puts in F v at most F sqrt(2 E / m), so that sqrt(2 E) grows by no more than its impulse / sqrt(m)
        given = sum(
            load.law.total
            * (0.5 * _FASTER if load.endless else 1.0)
            / math.sqrt(self.mass_of(load.chain - 1, load.bead - 1))
            for load in self.loads
        )
        given += _FASTER * math.sqrt(np.max(self.mass)) * sum(motion.speed for motion in self.motions)
        return 0.5 * (math.sqrt(2.0 * kicked) + given) ** 2

    @property
    def acted_on(self) -> bool:
        """Whether anything but the kicks comes from outside."""
        return bool(self.loads) or bool(self.motions)

    @property
    def exchanges(self) -> bool:
        """Whether energy is put in after the start, or lost."""
        return self.acted_on or bool(self.dampers)

    @property
    def driven(self) -> bool:
        """Whether anything outside moves or pushes beads for ever."""
        return bool(self.motions) or any(load.endless for load in self.loads)

    @property
    def momentum(self) -> float:
        """Momentum of the kicks."""
        return sum(self._kicked_mass(kick) * kick[2] for kick in self.kicks)

    @property
    def pushed(self) -> float:
        """Sum of the sizes of the kicks' momenta."""
        return sum(self._kicked_mass(kick) * abs(kick[2]) for kick in self.kicks)

    def _kicked_mass(self, kick: tuple[int, int, float]) -> float:
        return float(self.mass_of(kick[0] - 1, kick[1] - 1))

    @property
    def struck(self) -> tuple[tuple[int, int, float], ...]:
        """(chain, bead, impulse), counted from 1, of every kick and load: what sets the beads in motion."""
        loads = ((load.chain, load.bead, load.blow) for load in self.loads)
        motions = ((motion.chain, motion.bead, motion.amplitude * motion.omega) for motion in self.motions)
        return (*self.kicks, *loads, *motions)

    @property
    def hardest_blow(self) -> tuple[int, int, float]:
        """(chain, bead, impulse), counted from 1, of what sets most in motion: where the leading pulse starts."""
        return max(self.struck, key=lambda blow: abs(blow[2]))

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

    @cached_property
    def held(self) -> tuple[Ground, ...]:
        """The springs to the ground."""
        return tuple(link for link in self.ground if not isinstance(link, Wall))

    @property
    def sinks(self) -> tuple[str | None, ...]:
        """Names of the dashpots along, across, to the ground and of walls; None where there are none."""

        def names(kind: type[Link]) -> list[str]:
            walls = kind is WallDamper
            return [x.name for x in self.dampers if isinstance(x, kind) and isinstance(x, WallDamper) == walls]

        return tuple(" and ".join(dict.fromkeys(names(kind))) or None for kind in (Along, Across, Ground, WallDamper))

    @property
    def contact_loss(self) -> ContactLoss | None:
        """The law of damping of the contacts; None where they lose nothing."""
        return next((cast(ContactLoss, link.law) for link in self.dampers if isinstance(link, Along)), None)

    def wall_at(self, side: float) -> Wall:
        """The walls on a side."""
        return next(wall for wall in self.walls if wall.law.side == side)

    def wall_loss(self, side: float) -> WallDashpot | None:
        """The law of damping of the walls on a side; None where they lose nothing."""
        found = (link.law for link in self.dampers if isinstance(link, WallDamper))
        return next((law for law in found if law.side == side), None)

    @property
    def centred(self) -> bool:
        """Whether LAMMPS's step is of order 2 by masses that are larger (`lammps_inputs.laws.dashpot.Dashpot`)."""
        return bool(self.dampers) and self.holds(Fact.SECOND_ORDER)

    @property
    def coupled(self) -> bool:
        """Whether any spring between chains exists."""
        return bool(self.across)

    @property
    def kappa(self) -> float:
        """Stiffness at rest of the springs between chains, the largest if they differ; 0 where there are none."""
        return max((float(np.max(laws.stiffness(link.law, 0.0))) for link in self.across), default=0.0)

    @property
    def exponent(self) -> float | None:
        """Of the overlap in the force of a contact; None where that is no power of it."""
        return getattr(self.along[0].law, "exponent", None) if len(self.along) == 1 else None

    @property
    def gap(self) -> float:
        """Clear distance between neighbouring beads; 0 where they touch."""
        return self.along[0].gap

    @cached_property
    def loaded(self) -> bool:
        """Whether contacts bear a load at rest, so that there is sound."""
        return any(np.any(laws.load(link.law)) for link in self.along)

    @property
    def uniform(self) -> bool:
        """Whether no law differs from link to link, so that the beads might be more."""
        return isinstance(self.mass, float) and not any(laws.differs(link.law) for link in self.links)

    @property
    def open_row(self) -> bool:
        """Whether the chains stand in a row, each tied to the next by equal linear springs; or none to another."""
        return all(
            isinstance(link.law, Linear)
            and not laws.differs(link.law)
            and link.open_row
            and len(link.edges) == self.chains - 1
            for link in self.across
        )

    @property
    def simply_coupled(self) -> bool:
        """Whether every row swings by the known modes of equal linear springs in an open row of chains, or freely.

        Its beads have the mass 1.
        """
        free = isinstance(self.mass, float) and not self.ground
        return free and self.open_row and not self.acted_on and not self.dampers

    @cached_property
    def groups(self) -> tuple[frozenset[int], ...]:
        """Chains, counted from 0, that are tied to each other, directly or by others; each in one group."""
        group = {chain: {chain} for chain in range(self.chains)}
        for one, other in (edge for link in self.across for edge in link.edges):
            small, large = sorted((group[one], group[other]), key=len)
            if small is not large:
                large |= small
                group.update(dict.fromkeys(small, large))
        return tuple(map(frozenset, {id(members): members for members in group.values()}.values()))

    def tied_to(self, chain: int) -> list[int]:
        """Chains, counted from 0, of the group that one is in, ascending."""
        return sorted(next(group for group in self.groups if chain in group))

    @cached_property
    def diameter(self) -> float:
        """Bead diameter in LAMMPS: a power of two, so that touching is exact, and never small enough for second
        neighbours to meet or for one overlap to reach half of it. The dynamics do not depend on it.
        """
        law, rest = self.along[0].law, float(np.max(laws.rest(self.along[0].law)))
        alone, shared = (rest + laws.reach(law, energy) for energy in (self.energy, self.energy / 2.0))
        walls = (2.0 * float(np.max(link.law.overlap(self.energy))) for link in self.walls)
        # a row's dashpots know each other by their distance
        rows = (rest + 2.0 * laws.reach(link.law, self.energy) for link in self.across if self._damped_across)
        return power_of_two_at_least(max(4.0, 2.0 * alone, 2.0 * shared, *walls, *rows))

    @property
    def _damped_across(self) -> bool:
        return any(isinstance(link, Across) for link in self.dampers)

    @property
    def spacing(self) -> float:
        """Distance between the centres of neighbouring beads at rest, in LAMMPS; without load if that differs."""
        return self.diameter + self.gap - (float(laws.rest(self.along[0].law)) if self.even else 0.0)

    @property
    def even(self) -> bool:
        """Whether all neighbouring beads are equally far apart at rest."""
        return not any(np.ndim(laws.rest(link.law)) for link in self.along)

    @property
    def places(self) -> NDArray[np.float64]:
        """[chain, bead] where LAMMPS has the beads at rest, to the last bit."""
        if self.even:
            row = np.arange(1, self.beads + 1) * self.spacing
            return np.broadcast_to(row, (self.chains, self.beads))
        places = np.full((self.chains, self.beads), self.spacing)
        places[:, 1:] -= laws.rest(self.along[0].law)
        return np.asarray(np.cumsum(places, axis=1))

    @property
    def place_formula(self) -> str:
        """The same as a formula of LAMMPS; where it is none of the number of an atom, a fix has noted it."""
        return f"((id-1)%{self.rows}+1)*{text(self.spacing)}" if self.even else f"f_{PLACES}"

    @property
    def rows(self) -> int:
        """Rows of beads that exist in LAMMPS."""
        return self.beads

    def initial_velocity(self) -> NDArray[np.float64]:
        """Velocities at the start, [chain, bead]; displacements are zero."""
        velocity = np.zeros((self.chains, self.beads))
        for chain, bead, value in self.kicks:
            velocity[chain - 1, bead - 1] = value
        for motion in self.motions:
            velocity[motion.chain - 1, motion.bead - 1] = motion.velocity(0.0)
        return velocity


def _same(one: object, other: object) -> bool:
    return not isinstance(other, np.ndarray) and one == other


@dataclass(frozen=True, kw_only=True, eq=False)
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
