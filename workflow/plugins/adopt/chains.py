"""Chains of beads in LAMMPS: how their atoms are arranged, and what is known of the forces on them."""

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from workflow.plugins.adopt.motions import GivenMotion
from workflow.plugins.adopt.wall_laws import WallLaw

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


class NotMeasuredError(Exception):
    """The beads are no chains, or a force is none that a scene has.

    Attributes:
        commands: names of the commands (of fixes with their style) that determine it.
    """

    def __init__(self, message: str, *commands: str) -> None:
        super().__init__(message, *commands)
        self.message, self.commands = message, commands


TIME = "time"
"""In place of the name of a command: variables that depend on the time."""

PLACES = ("create_atoms", "read_data", "displace_atoms", "delete_atoms", "replicate", "lattice")
"""Commands that determine where atoms are."""


@dataclass
class Inner:
    """Atoms inside the beads of one chain, each on a spring at its bead.

    Attributes:
        chain: chain, from 0.
        atoms: atom of each bead, [bead], -1 where there is none.
        mass: masses, [bead]; 0 where there is none.
        stiffness: stiffness of the springs, [bead].
        damping: coefficient of the dashpots, [bead].
    """

    chain: int
    atoms: Integers
    mass: Floats
    stiffness: Floats = field(default_factory=lambda: np.zeros(0))
    damping: Floats = field(default_factory=lambda: np.zeros(0))

    def taken(self, beads: slice) -> "Inner":
        """The atoms inside some beads."""
        numbers = (self.mass[beads], self.stiffness[beads], self.damping[beads])
        return Inner(self.chain, self.atoms[beads], *numbers)


@dataclass(frozen=True)
class ForceProbe:
    """Forces at displacements and velocities in which forces of one kind act.

    Attributes:
        pattern: "pairs" of beads that are pressed together, "chain" that is moved, or "left" or "right" wall.
        displacement: [chain, bead].
        velocity: [chain, bead].
        force: forces beyond those without displacement, [chain, bead].
    """

    pattern: str
    displacement: Floats
    velocity: Floats
    force: Floats

    def taken(self, beads: slice, sign: float = 1.0) -> "ForceProbe":
        """Forces on some beads, in another order with the other sign."""
        return ForceProbe(
            self.pattern, *(sign * array[:, beads] for array in (self.displacement, self.velocity, self.force))
        )

    def place(self, measured: "Measured", chain: int, bead: int) -> str:
        """Words for the contact or wall that acts on a bead, and how it moves."""
        if self.pattern == "chain":
            return "springs between chains, or to the ground, of one chain that is moved"
        sign = 1.0 if self.displacement[chain, bead] > 0.0 else -1.0
        rate = sign * self.velocity[chain, bead]
        moving = f"while it {'closes' if rate > 0.0 else 'opens'} with {abs(rate):.3g}" if rate else "at rest"
        other = bead + int(sign)
        if self.pattern != "pairs" or not 0 <= other < measured.ids.shape[1]:
            return f"the wall beside atom {measured.ids[chain, bead]}, or a spring to the ground, {moving}"
        first, second = sorted((measured.ids[chain, bead], measured.ids[chain, other]))
        return f"the contact of atoms {first} and {second}, {moving}"


@dataclass
class Measured:
    """Chains and forces of a deck, in its units.

    Attributes:
        axis: axis along which the chains lie, 0 to 2.
        ids: numbers of the atoms, [chain, bead].
        place: positions from which displacements are counted, [chain, bead].
        displacement: displacements from there at the start, [chain, bead].
        velocity: velocities at the start, [chain, bead].
        mass: masses, [chain, bead].
        radius: radii, [chain, bead].
        held: whether a bead never moves, [chain, bead].
        driven: whether LAMMPS moves a bead whatever acts on it, [chain, bead].
        overlap: overlaps of the contacts at `place`, negative where beads are apart, [chain, contact].
        strength: constants A of the contacts, [chain, contact].
        exponent: exponent p of all contacts.
        dashpot: ratio of dashpot force and approach velocity at the overlaps `dashpot_overlap`, [2, chain, contact].
        dashpot_overlap: [2, chain, contact].
        cut: whether the force of contacts is never tensile.
        foundation: linear and cubic stiffness of springs to the ground, [2, chain, bead].
        drag: drag coefficient, [chain, bead].
        coupling: pair of chains -> linear and cubic stiffness, and dashpot coefficient, [3, bead].
        walls: "left" or "right" -> constant of the wall, [chain].
        wall_dashpot: "left" or "right" -> ratio of dashpot force and velocity, [2, chain], at `dashpot_overlap`.
        other_walls: walls that stand elsewhere than the next bead would, or have another law than the contacts.
        inner: atoms inside the beads.
        acceleration: acceleration of all beads at `place`, that of their fall.
        timestep: time step.
        probes: forces by which a scene is compared with the deck.
        first_step: number of the step at the start.
        relaxed: whether earlier runs, or a minimisation, left the beads as they are at the start.
        direction: 1 where beads are counted along the axis, -1 where against it.
        around: overlap of the last with the first bead of rings, [chain]; None of chains with ends.
        wall_atoms: "left" or "right" -> numbers of the held atoms that are the wall, [chain].
        motions: chain and bead, from 0 -> motion of a driven bead.
        clearance: "left" or "right" -> distance of the last beads from a wall that stands elsewhere than the next bead
            would, [chain].
    """

    axis: int
    ids: Integers
    place: Floats
    displacement: Floats
    velocity: Floats
    mass: Floats
    radius: Floats
    held: NDArray[np.bool_]
    driven: NDArray[np.bool_]
    overlap: Floats
    strength: Floats
    exponent: float
    dashpot: Floats
    dashpot_overlap: Floats
    cut: bool
    foundation: Floats
    drag: Floats
    coupling: dict[tuple[int, int], Floats]
    walls: dict[str, Floats]
    wall_dashpot: dict[str, Floats]
    other_walls: list[WallLaw]
    inner: list[Inner]
    acceleration: float
    timestep: float
    probes: list[ForceProbe] = field(default_factory=list)
    first_step: int = 0
    relaxed: bool = False
    direction: float = 1.0
    around: Floats | None = None
    wall_atoms: dict[str, Integers] = field(default_factory=dict)
    motions: dict[tuple[int, int], GivenMotion] = field(default_factory=dict)
    clearance: dict[str, Floats] = field(default_factory=dict)

    @property
    def rounding(self) -> float:
        """Error of overlaps by rounded positions."""
        return 8.0 * float(np.finfo(float).eps * np.max(np.abs(self.place)))

    @property
    def overlaps(self) -> Floats:
        """Overlaps of the contacts, those through which rings close included, [chain, contact]."""
        return self.overlap if self.around is None else np.column_stack([self.overlap, self.around])

    @property
    def load(self) -> Floats:
        """Forces of the contacts at `place`, [chain, contact]."""
        return np.asarray(self.strength * np.maximum(self.overlap, 0.0) ** self.exponent)

    def reversed(self) -> "Measured":
        """Chains whose beads are counted from the other end, velocities being positive towards higher numbers."""
        other = {"left": "right", "right": "left"}
        walls = {other[side]: values for side, values in self.walls.items()}
        wall_atoms = {other[side]: atoms for side, atoms in self.wall_atoms.items()}
        wall_dashpot = {other[side]: values for side, values in self.wall_dashpot.items()}
        other_walls = [replace(wall, side=other[wall.side]) for wall in self.other_walls]
        inner = [part.taken(slice(None, None, -1)) for part in self.inner]
        coupling = {chains: table[:, ::-1] for chains, table in self.coupling.items()}
        along = {name: getattr(self, name)[..., ::-1] for name in (*_OF_BEADS, *_OF_CONTACTS, "overlap")}
        along |= {name: -along[name] for name in ("place", "displacement", "velocity")}
        parts: dict[str, Any] = {"walls": walls, "wall_atoms": wall_atoms, "inner": inner, "coupling": coupling}
        parts["clearance"] = {other[side]: values for side, values in self.clearance.items()}
        last = self.mass.shape[1] - 1
        parts["motions"] = {(c, last - bead): motion.reversed() for (c, bead), motion in self.motions.items()}
        parts["acceleration"] = -self.acceleration
        parts |= {"wall_dashpot": wall_dashpot, "other_walls": other_walls}
        parts["probes"] = [probe.taken(slice(None, None, -1), -1.0) for probe in self.probes]
        return replace(self, **along, **parts, direction=-self.direction)

    def without_held(self) -> "Measured":
        """Chains without the beads at their ends that never move, which are walls.

        Raises:
            NotMeasuredError: held beads are elsewhere, or the chains differ in them.
        """
        if not np.any(self.held):
            return self
        free = np.flatnonzero(~self.held[0])
        first, last = (int(free[0]), int(free[-1]) + 1) if len(free) else (0, 0)
        if np.any(self.held != self.held[0]) or np.any(self.held[:, first:last]) or last - first < 2:
            raise NotMeasuredError(
                "beads that never move are not at the ends of all chains; supported: walls of held beads there",
                "fix nve",
                "fix freeze",
                "fix setforce",
            )
        walls, wall_atoms = dict(self.walls), dict(self.wall_atoms)
        if first > 0:
            walls["left"], wall_atoms["left"] = self.strength[:, first - 1], self.ids[:, first - 1]
        if last < self.held.shape[1]:
            walls["right"], wall_atoms["right"] = self.strength[:, last - 1], self.ids[:, last]
        beads, contacts = slice(first, last), slice(first, last - 1)
        of_beads = {name: getattr(self, name)[..., beads] for name in _OF_BEADS}
        of_contacts = {name: getattr(self, name)[..., contacts] for name in _OF_CONTACTS}
        inner = [part.taken(beads) for part in self.inner]
        coupling = {chains: table[:, beads] for chains, table in self.coupling.items()}
        overlap = self.overlap[:, contacts]
        parts: dict[str, Any] = {"walls": walls, "wall_atoms": wall_atoms, "inner": inner, "coupling": coupling}
        parts["probes"] = [probe.taken(beads) for probe in self.probes]
        parts["other_walls"] = [wall for wall in self.other_walls if wall.side not in wall_atoms]
        parts["motions"] = {(c, b - first): motion for (c, b), motion in self.motions.items() if first <= b < last}
        parts["wall_dashpot"], parts["clearance"] = dict(self.wall_dashpot), dict(self.clearance)
        for side, contact in (("left", first - 1), ("right", last - 1)):
            if side in wall_atoms:
                parts["wall_dashpot"][side] = self.dashpot[:, :, contact]
                parts["clearance"][side] = -self.overlap[:, contact]
        return replace(self, **of_beads, **of_contacts, overlap=overlap, **parts)


_OF_BEADS = (
    *("ids", "place", "displacement", "velocity", "mass", "radius", "held", "driven"),
    *("foundation", "drag"),
)
"""Attributes of `Measured` with the axes [..., bead]."""

_OF_CONTACTS = ("strength", "dashpot", "dashpot_overlap")
"""Attributes of `Measured` with the axes [..., contact]."""


def arrange(place: Floats, radius: Floats, mass: Floats, bonds: Integers) -> tuple[int, Integers, list[Inner]]:
    """Axis of the chains, their atoms, [chain, bead], and the atoms inside their beads.

    Args:
        place: [atom, axis].
        radius: [atom].
        mass: [atom].
        bonds: pairs of atoms, [bond, 2].

    Raises:
        NotMeasuredError: the atoms are not on lines parallel to an axis, with equally many on each.
    """
    count = np.bincount(bonds.reshape(-1), minlength=len(place))
    inside = (radius < 0.5 * np.max(radius)) & (count == 1)
    beads = np.flatnonzero(~inside)
    width = 1e-6 * np.max(radius)
    springs = np.searchsorted(beads, bonds[~np.any(inside[bonds], axis=1)])
    lines, costs = [], []
    for axis in range(3):
        across = np.round(np.delete(place[beads], axis, axis=1) / width)
        _, line = np.unique(across, axis=0, return_inverse=True)
        lines.append(line.reshape(-1))
        of_springs = lines[axis][springs]  # they tie chains, so that none lies along the beads of a chain
        costs.append((np.count_nonzero(of_springs[:, 0] == of_springs[:, 1]), int(np.max(line))))
    axis = min(range(3), key=costs.__getitem__)
    of_line = [beads[lines[axis] == number] for number in range(int(np.max(lines[axis])) + 1)]
    sizes = {len(line) for line in of_line}
    if len(sizes) > 1 or min(sizes) < 2:
        raise NotMeasuredError(
            f"the {len(place)} atoms are not on straight lines parallel to an axis with equally many, at least 2, on "
            "each; supported: chains of beads along x, y or z",
            *PLACES,
        )
    ordered = [line[np.argsort(place[line, axis])] for line in sorted(of_line, key=lambda line: int(np.min(line)))]
    chains = np.array(ordered)
    return axis, chains, _inside(chains, np.flatnonzero(inside), mass, bonds)


def _inside(chains: Integers, atoms: Integers, mass: Floats, bonds: Integers) -> list[Inner]:
    """Atoms inside beads, in as many sets for each chain as a bead has at most."""
    partner = {int(a): int(b) for pair in bonds for a, b in (pair, pair[::-1])}
    row_of = {int(atom): (chain, bead) for (chain, bead), atom in np.ndenumerate(chains)}
    sets: list[Inner] = []
    for atom in atoms.tolist():
        chain, bead = row_of[partner[atom]]
        free = (inner for inner in sets if inner.chain == chain and inner.atoms[bead] < 0)
        inner = next(free, None)
        if inner is None:
            inner = Inner(chain, np.full(chains.shape[1], -1), np.zeros(chains.shape[1]))
            sets.append(inner)
        inner.atoms[bead], inner.mass[bead] = atom, mass[atom]
    for link in bonds:
        rows = [row_of.get(int(atom)) for atom in link]
        if None not in rows and rows[0][1] != rows[1][1]:  # type: ignore[index]
            raise NotMeasuredError(
                "a bond joins beads of different rows; supported: springs between beads of one number in two chains",
                "create_bonds",
                "read_data",
            )
    return sets
