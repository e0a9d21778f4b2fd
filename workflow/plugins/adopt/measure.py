"""Forces of a user's deck on its beads, measured in LAMMPS: whatever its commands are, these numbers are its equations.

Beads are displaced, or given velocities, by a few patterns in which only forces of one kind act, and LAMMPS computes
the forces without a step (`run 0`):

- all beads by the same distance: foundation, and the walls at the ends;
- rows by turns to and fro: every other contact is closed and the others are open;
- one chain, or the inner atoms of all beads: springs to other chains, or inside beads.

All quantities are in the deck's units; positions and forces are those along the chains.
"""

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from workflow.plugins.adopt import reference_places
from workflow.plugins.adopt.chains import (
    PLACES,
    TIME,
    Floats,
    ForceProbe,
    Inner,
    Integers,
    Measured,
    NotMeasuredError,
    arrange,
)
from workflow.plugins.adopt.wall_laws import MOST_DISTANCES, Reach, WallLaw, wall_dashpot, wall_law

LEVELS = (1.0, 2.0, 4.0)
"""Overlaps or displacements of a pattern, in units of the first."""

SMALL = 0.01
"""First displacement of a pattern, relative to the smallest radius."""

AGREE = 1e-6
"""Relative deviation from a law below which forces are that law's; rounding leaves some 1e-10."""

ROUNDED = 1e-10
"""Force below which there is none, relative to the largest force at the same places."""

UNBALANCED = 1e-6
"""Force on a bead at rest that is none, relative to static loads, or to the force of an impact m V^2 / L."""

LARGEST_EXPONENT = 3.5


_CONTACTS = ("pair_coeff", "pair_style", "special_bonds", "pair_modify")
_SPRINGS = ("bond_coeff", "bond_style")
_FORCES = ("fix addforce", "fix gravity", "fix setforce", "fix wall/gran", "fix spring/self")


class Atoms:
    """The atoms of an instance of LAMMPS in ascending order of their numbers."""

    def __init__(self, lmp: Any) -> None:
        self._lmp = lmp
        if lmp.extract_setting("radius_flag") != 1:
            raise NotMeasuredError(
                "atoms are no spheres; supported: atom_style sphere, hybrid sphere bond", "atom_style"
            )
        if lmp.get_natoms() < 2:
            count = "is one sphere" if lmp.get_natoms() == 1 else "are no atoms"
            raise NotMeasuredError(f"there {count} at the first run; supported: chains of at least 2 beads", *PLACES)
        lmp.command("run 0 post no")
        self.ids = np.sort(self._now("id"))
        self.place, self.velocity, self.radius, self.mass = (
            self._sorted(name) for name in ("x", "v", "radius", "rmass")
        )
        self.start = self.place.copy()
        self._image = self._sorted("image")

    def forces(self, axis: int, displacement: Any = 0.0, velocity: Any = 0.0) -> Floats:
        """Forces along an axis on the atoms, [atom], displaced from `place` and with these velocities.

        Raises:
            NotMeasuredError: a force acts across the axis.
        """
        place, speed = self.place.copy(), np.zeros_like(self.place)
        place[:, axis] += displacement
        speed[:, axis] += velocity
        self._put(place, speed)
        self._lmp.command("run 0 post no")
        force = self._sorted("f")
        if not np.all(np.isfinite(force)):
            atom = self.ids[int(np.argmax(~np.all(np.isfinite(force), axis=1)))]
            raise NotMeasuredError(
                f"the force on atom {atom} is not a number where beads touch; in `fix wall/gran` of hooke and hertz "
                "styles LAMMPS divides by gamma_n: write one above 0, such as 1e-20, or the style `granular`",
                "fix wall/gran",
            )
        across = np.delete(np.abs(force), axis, axis=1)
        if np.max(across) > ROUNDED * np.max(np.abs(force)) and np.max(across) > 0.0:
            atom = self.ids[int(np.argmax(np.max(across, axis=1)))]
            raise NotMeasuredError(
                f"a force across the chain acts on atom {atom}, and nothing holds it on its line; supported: motion "
                "along one axis, such as by `fix lineforce` or `fix setforce`",
                *_FORCES,
            )
        return np.ascontiguousarray(force[:, axis])

    def moved_by_a_step(self, axis: int) -> NDArray[np.bool_]:
        """Whether the integrators move an atom, [atom]."""
        moved = np.zeros(len(self.ids), dtype=bool)
        for share in (1e-6, -3e-6):  # a force may just undo one of them
            speed = np.zeros_like(self.place)
            speed[:, axis] = share * np.min(self.radius) / self._lmp.extract_global("dt")
            self._put(self.place, speed)
            self._lmp.command("run 1 post no")
            moved |= self._sorted("x")[:, axis] != self.place[:, axis]
        return moved

    def members(self, groups: list[str]) -> NDArray[np.bool_]:
        """Whether an atom belongs to one of some groups, [atom]."""
        members = np.zeros(len(self.ids), dtype=bool)
        for group in groups:
            self._lmp.command(f"variable granchain_member atom gmask({group})")
            inside = np.array(self._lmp.extract_variable("granchain_member", "all", 1)[: len(self.ids)])
            members |= inside[np.argsort(self._now("id"))] != 0.0
        return members

    def box(self, axis: int) -> tuple[float, float, bool]:
        """Lower and upper face of the box along an axis, and whether it is periodic."""
        low, high, *_, periodic, _ = self._lmp.extract_box()
        return float(low[axis]), float(high[axis]), bool(periodic[axis])

    def at_another_time(self) -> None:
        """Continue at a later step, for forces that depend on the time."""
        self._lmp.command(f"reset_timestep {int(self._lmp.extract_global('ntimestep')) + 7919}")

    def _now(self, name: str) -> Any:
        count = self._lmp.extract_setting("nlocal")
        return np.array(self._lmp.numpy.extract_atom(name)[:count])

    def _sorted(self, name: str) -> Any:
        return self._now(name)[np.argsort(self._now("id"))]

    def _put(self, place: Floats, velocity: Floats) -> None:
        count = self._lmp.extract_setting("nlocal")
        of_atom = np.searchsorted(self.ids, self._now("id"))
        for name, values in (("x", place), ("v", velocity), ("image", self._image)):
            self._lmp.numpy.extract_atom(name)[:count] = values[of_atom]


START = "granchain_start"
"""Variable of LAMMPS: whether beads come from a relaxation (0 or 1), then name and group of each `fix move`."""


def measure(lmp: Any) -> Measured:
    """Measure the forces of a deck that has come to the run with which a scene begins.

    Raises:
        NotMeasuredError: the beads are no chains, or a force is none that a scene has.
    """
    first_step = int(lmp.extract_global("ntimestep"))
    atoms = Atoms(lmp)
    axis, chains, inner = arrange(atoms.place, atoms.radius, atoms.mass, _bonds(lmp, atoms.ids))
    relaxed, *names = str(lmp.extract_variable(START)).split()
    moves = {
        name: group for name, group in zip(names[::2], names[1::2], strict=True) if name in lmp.available_ids("fix")
    }
    driven = atoms.members(list(moves.values()))
    for name in moves:  # beside them the number of the step may not be changed
        lmp.command(f"unfix {name}")
    timestep = float(lmp.extract_global("dt"))
    mobility = Mobility(driven, atoms.moved_by_a_step(axis), _pushed(atoms, axis, chains))

    def bench(unbalanced: float) -> Measured:
        parts = [replace(part) for part in inner]
        return _Bench(atoms, axis, chains, parts, mobility).measured(timestep, unbalanced)

    try:
        measured = bench(0.0 if relaxed == "1" else UNBALANCED)
    except NotMeasuredError:
        place = _reference(atoms, axis, chains, inner, mobility.free)
        if place is None or np.array_equal(place, atoms.place[:, axis]):
            raise
        atoms.place[:, axis] = place
        measured = bench(UNBALANCED)
    around = _around(lmp, atoms, axis, chains)
    return replace(measured, first_step=first_step, relaxed=relaxed == "1", around=around)


def _pushed(atoms: Atoms, axis: int, chains: Integers) -> NDArray[np.bool_]:
    """Whether any force acts on an atom while neighbours are pressed together, [atom]."""
    place, radius = atoms.place[chains, axis], atoms.radius[chains]
    overlap = radius[:, :-1] + radius[:, 1:] - np.diff(place, axis=1)
    distance = np.maximum(-overlap, 0.0) + SMALL * float(np.min(radius))
    pushed = np.ones(len(atoms.ids), dtype=bool)
    pushed[chains] = False
    for parity in (0, 1):
        closed = np.where(np.arange(overlap.shape[1]) % 2 == parity, distance, 0.0)
        displacement = np.zeros(len(atoms.ids))
        displacement[chains[:, :-1]] += 0.5 * closed
        displacement[chains[:, 1:]] -= 0.5 * closed
        pushed |= atoms.forces(axis, displacement) != 0.0
    return pushed


def _reference(atoms: Atoms, axis: int, chains: Integers, inner: list[Inner], free: NDArray[np.bool_]) -> Floats | None:
    """Places along the axis from which displacements are counted, [atom], of a start away from rest; None without."""
    margin = 1e-6 * float(np.min(atoms.radius))
    atoms.forces(axis)
    low, high, periodic = atoms.box(axis)
    atoms.forces(axis, margin)
    open_ended = periodic or atoms.box(axis)[:2] != (low, high)  # a box that follows the atoms
    lines = reference_places.Lines(
        forces=lambda displacement: atoms.forces(axis, displacement),
        start=atoms.start[:, axis].copy(),
        mass=atoms.mass,
        lines=np.array([*chains, *(part.atoms for part in inner)]),
        radius=atoms.radius[chains],
        free=free,
        limits=(-math.inf, math.inf) if open_ended else (low + margin, high - margin),
    )
    try:
        return reference_places.reference(lines)
    except NotMeasuredError:  # the search went to places where forces are none of a chain
        return None


def _bonds(lmp: Any, ids: Integers) -> Integers:
    """Pairs of bonded atoms, by their places in `ids`, [bond, 2]."""
    if lmp.extract_setting("molecule_flag") == 0 or lmp.extract_global("nbonds") == 0:
        return np.zeros((0, 2), dtype=np.int64)
    _, flat = lmp.gather_bonds()
    pairs = np.array(flat, dtype=np.int64).reshape(-1, 3)[:, 1:]
    return np.searchsorted(ids, pairs)


def _around(lmp: Any, atoms: Atoms, axis: int, chains: Integers) -> Floats | None:
    """Overlap of the last with the first bead of rings, through a periodic boundary, [chain]; None of open chains."""
    low, high, *_, periodic, _ = lmp.extract_box()
    place, radius = atoms.place[chains, axis], atoms.radius[chains]
    gap = high[axis] - low[axis] - (place[:, -1] - place[:, 0]) - radius[:, 0] - radius[:, -1]
    return -gap if periodic[axis] and np.min(gap) < 0.5 * np.min(radius) else None


@dataclass(frozen=True)
class Mobility:
    """What moves atoms, each [atom].

    Attributes:
        driven: whether LAMMPS moves an atom along a given path.
        integrated: whether its velocity moves it.
        pushed: whether forces change its velocity.
    """

    driven: NDArray[np.bool_]
    integrated: NDArray[np.bool_]
    pushed: NDArray[np.bool_]

    @property
    def free(self) -> NDArray[np.bool_]:
        """Whether forces move an atom, [atom]."""
        return self.integrated & self.pushed & ~self.driven


def _refuse_rest(measured: Measured) -> None:
    """Refuse a deck in which nothing moves."""
    moved = measured.driven, measured.velocity, measured.displacement
    if not (measured.acceleration or any(map(np.any, moved))):
        raise NotMeasuredError(
            "no bead moves at the start; supported: velocities by `velocity` or `set` before the run (key `kick`), "
            "displacements (`initial`), falls (`gravity`), motions by `fix move` (`drive`)",
            "run",
        )


class _Bench:
    """The patterns of displacements and velocities, and what follows from the forces."""

    def __init__(self, atoms: Atoms, axis: int, chains: Integers, inner: list[Inner], mobility: Mobility) -> None:
        self.atoms, self.axis, self.chains, self.inner, self.mobility = atoms, axis, chains, inner, mobility
        self.rows = np.full(len(atoms.ids), -1)
        self.chain_of = np.full(len(atoms.ids), -1)
        for number, line in enumerate(chains):
            self.rows[line], self.chain_of[line] = np.arange(chains.shape[1]), number
        for part in inner:
            present = part.atoms >= 0
            self.rows[part.atoms[present]] = np.flatnonzero(present)
            self.chain_of[part.atoms[present]] = part.chain
        self.small = SMALL * float(np.min(atoms.radius[chains]))
        place, radius = atoms.place[chains, axis], atoms.radius[chains]
        self.overlap = radius[:, :-1] + radius[:, 1:] - np.diff(place, axis=1)
        farthest = max(float(np.max(np.abs(places))) for places in (atoms.place, atoms.start))
        self.touching = 8.0 * float(np.finfo(float).eps) * farthest
        self.speed = float(np.max(np.abs(atoms.velocity[~mobility.driven]), initial=0.0))

    def measured(self, timestep: float, unbalanced: float) -> Measured:
        """All forces, each of which must be one that a scene has.

        Args:
            timestep: time step.
            unbalanced: force on a bead at rest that is none, relative to static loads, or to the force of an impact.
        """
        atoms, chains, axis = self.atoms, self.chains, self.axis
        self._refuse_velocities_across()
        self._refuse_time()
        self.rest = atoms.forces(axis)
        self._measure_foundation()
        strength, exponent = self._measure_contacts()
        acceleration = self._acceleration(strength, exponent, unbalanced)
        if self.speed == 0.0:  # dashpots are measured at some velocity
            self.speed = math.sqrt(float(np.max(strength)) * self.small ** (exponent + 1.0) / float(np.max(atoms.mass)))
        drag = self._measure_drag()
        walls, wall_dashpots, other_walls = self._measure_walls(exponent)
        clear = np.full(len(chains), max(0.0, -float(np.min(self.overlap))))
        result = Measured(
            axis=axis,
            ids=atoms.ids[chains],
            place=atoms.place[chains, axis],
            displacement=(atoms.start - atoms.place)[chains, axis],
            velocity=atoms.velocity[chains, axis],
            mass=atoms.mass[chains],
            radius=atoms.radius[chains],
            held=np.zeros(chains.shape, dtype=bool),
            driven=np.zeros(chains.shape, dtype=bool),
            overlap=self.overlap,
            strength=strength,
            exponent=exponent,
            dashpot=np.zeros((2, *strength.shape)),
            dashpot_overlap=np.ones((2, *strength.shape)),
            cut=False,
            foundation=np.stack([self.linear[chains], self.cubic[chains]]),
            drag=drag,
            coupling=self._measure_coupling(),
            walls=walls,
            wall_dashpot=wall_dashpots,
            other_walls=other_walls,
            inner=self.inner,
            acceleration=acceleration,
            timestep=timestep,
            clearance=dict.fromkeys(walls, clear),
        )
        self._measure_inner()
        self._measure_dashpots(result)
        result.held, result.driven = self._held()
        result.velocity[result.driven] = 0.0
        self._forget_forces_on_driven(result)
        _refuse_rest(result)
        result.probes = list(self._probes(result.held))
        return result

    def _probes(self, held: NDArray[np.bool_]) -> Iterator[ForceProbe]:
        """Forces in all patterns, at rest, closing and opening, by which a scene is compared with the deck."""
        free = np.ones(len(self.rows))
        free[self.chains[held]] = 0.0
        gap = max(0.0, -float(np.min(self.overlap)))
        patterns = [("pairs", self._closed(parity, level)) for parity in (0, 1) for level in (LEVELS[0], LEVELS[2])]
        for sign, side in ((-1.0, "left"), (1.0, "right")):
            distance = min(gap + self.small, self._way_to_face(side))
            patterns.append(("walls", np.full(len(self.rows), sign * distance)))
        patterns += [("chain", self.small * (self.chain_of == chain)) for chain in range(len(self.chains))]
        for name, displacement in patterns:
            for rate in (0.0, self.speed, -self.speed):
                x, v = displacement * free, rate * np.sign(displacement) * free
                force = self._moved(x, v) - self.rest
                yield ForceProbe(name, x[self.chains], v[self.chains], force[self.chains])

    # --- springs to the ground ----------------------------------------------------------------------------------------

    def _measure_foundation(self) -> None:
        """Springs to the ground from a displacement of all beads, of the ends away from their walls."""
        forces = {}
        for level in LEVELS:
            forward, backward = (self._moved(sign * level * self.small) - self.rest for sign in (1.0, -1.0))
            last = np.zeros(len(self.rows), dtype=bool)
            last[self.chains[:, -1]] = True
            forces[level] = np.where(last, backward, -forward) / (level * self.small)
        weak, medium, strong = (forces[level] for level in LEVELS)
        square = self.small**2
        self.cubic = (medium - weak) / (3.0 * square)
        self.linear = weak - self.cubic * square
        deviation = np.abs(self.linear + 16.0 * self.cubic * square - strong)
        if np.max(self.overlap) > 0.0:  # walls are pressed, and beads at the ends may not leave them
            for end, beside in ((0, 1), (-1, -2)):
                for values in (self.linear, self.cubic, deviation, strong):
                    values[self.chains[:, end]] = values[self.chains[:, beside]]
        self.foundation_scale = np.max(np.abs(strong))
        self._foundation_deviation = deviation

    def _settle_foundation(self) -> None:
        """Drop stiffnesses that are rounding, and refuse forces that are neither linear nor cubic."""
        least = self.noise / self.small
        self._refuse_position(max(AGREE * self.foundation_scale, least))
        square = self.small**2
        self.linear[np.abs(self.linear) < least] = 0.0
        self.cubic[np.abs(self.cubic) * square < max(least, ROUNDED * self.foundation_scale)] = 0.0

    def _refuse_position(self, limit: float) -> None:
        if np.max(self._foundation_deviation) > limit:
            raise NotMeasuredError(
                "a force that depends on the position is neither linear nor cubic in the displacement; supported: "
                "`fix spring/self`, and walls beyond the ends of a chain",
                *_FORCES,
            )

    def _moved(self, displacement: Any, velocity: Any = 0.0) -> Floats:
        return self.atoms.forces(self.axis, displacement, velocity)

    def _ground(self, displacement: Floats) -> Floats:
        """Force of the springs to the ground, [atom]."""
        return -(self.linear + self.cubic * displacement**2) * displacement

    # --- contacts -----------------------------------------------------------------------------------------------------

    def _pattern(self, parity: int, distance: float) -> Floats:
        """Displacements that close every other contact by a distance and open the others by as much, [atom]."""
        return np.where(self.rows % 2 == parity, 0.5, -0.5) * distance

    def _closed(self, parity: int, level: float) -> Floats:
        """Displacements that close every other contact until it overlaps by a level more than at rest, [atom]."""
        gaps = np.where(np.arange(self.overlap.shape[1]) % 2 == parity, self._gaps, 0.0)
        rows = 0.5 * (np.append(gaps, 0.0) - np.append(0.0, gaps))
        return self._pattern(parity, self._base + level * self.small) + np.where(self.rows < 0, 0.0, rows[self.rows])

    @property
    def _base(self) -> float:
        return max(0.0, float(np.max(self.overlap)))

    @property
    def _gaps(self) -> Floats:
        """Largest gap of a contact in any chain, [contact]."""
        return np.asarray(np.max(np.maximum(-self.overlap, 0.0), axis=0))

    def _overlaps(self, level: float) -> Floats:
        """Overlaps of closed contacts, [chain, contact]."""
        return np.asarray(self.overlap + self._gaps + self._base + level * self.small)

    def _alternating(self, level: float, rate: float = 0.0) -> tuple[Floats, Floats]:
        """Forces of all contacts on the lower and the upper bead of each, [chain, contact], closed by a level.

        External forces are still in them, those of the foundation are not.
        """
        lower, upper = np.zeros(self.overlap.shape), np.zeros(self.overlap.shape)
        for parity in (0, 1):
            displacement = self._closed(parity, level)
            velocity = self._pattern(parity, rate)
            force = self._moved(displacement, velocity) - self._ground(displacement)
            force = force[self.chains]
            lower[:, parity::2], upper[:, parity::2] = force[:, :-1][:, parity::2], force[:, 1:][:, parity::2]
        return -lower, upper

    def _of_contacts(self, forces: tuple[Floats, Floats]) -> Floats:
        """Forces on beads that nothing else can touch, of those on lower and upper beads, [chain, contact]."""
        lower, upper = forces
        chosen = upper.copy()
        chosen[:, -1] = lower[:, -1] if upper.shape[1] > 1 else upper[:, -1]
        other = np.where(chosen == upper, lower, upper)
        return np.where(chosen == 0.0, other, chosen)

    def _measure_contacts(self) -> tuple[Floats, float]:
        """Constants of the contacts, [chain, contact], and their exponent."""
        weak, medium, strong = (self._alternating(level) for level in LEVELS)
        first = self._of_contacts((medium[0] - weak[0], medium[1] - weak[1]))
        second = self._of_contacts((strong[0] - medium[0], strong[1] - medium[1]))
        overlaps = [self._overlaps(level) for level in LEVELS]
        largest = float(np.max(np.abs(first)))
        if not largest > 0.0:
            raise NotMeasuredError("neighbouring beads do not push each other where they overlap", *_CONTACTS)
        self._refuse_position(max(1e-3 * self.foundation_scale, AGREE * largest / self.small))
        exponent = _exponent(first, second, overlaps)
        change = [high**exponent - low**exponent for low, high in itertools.pairwise(overlaps)]
        strength = first / change[0]
        wrong = np.abs(second / change[1] - strength) > AGREE * np.max(strength)
        if np.any(wrong) or np.any(strength < 0.0):
            raise NotMeasuredError(
                f"the force of a contact is no power A overlap^{exponent:g} of the overlap with one exponent; "
                "supported: hertz, hertz/material, hooke",
                *_CONTACTS,
            )
        strength[strength < ROUNDED * np.max(strength)] = 0.0
        self.contact_force = largest
        self.noise = self._noise(float(np.max(strength)), exponent)
        self._settle_foundation()
        self._refuse_at_a_distance(strength, exponent, weak, overlaps[0])
        return strength, exponent

    def _noise(self, strength: float, exponent: float) -> float:
        """Force that rounded positions make in contacts as they are at the start."""
        pressed = max(0.0, float(np.max(self.overlap)))
        touching = strength * self.touching**exponent
        return 100.0 * float(touching + exponent * strength * pressed ** (exponent - 1.0) * self.touching)

    def _refuse_at_a_distance(
        self, strength: Floats, exponent: float, forces: tuple[Floats, Floats], overlap: Floats
    ) -> None:
        """Refuse forces between beads that are apart: beyond those of closed contacts only constant forces are left."""
        lower, upper = forces
        rest = np.stack([-lower + strength * overlap**exponent, upper - strength * overlap**exponent])
        between = rest[0][:, 1:] - rest[1][:, :-1]  # on one bead, from either pattern
        held = (np.abs(lower[:, 1:]) == 0.0) | (np.abs(upper[:, :-1]) == 0.0)
        if np.any(~held & (np.abs(between) > 100.0 * AGREE * self.contact_force)):
            raise NotMeasuredError("beads that are apart act on each other; supported: contacts that touch", *_CONTACTS)

    def _acceleration(self, strength: Floats, exponent: float, unbalanced: float) -> float:
        """Acceleration of all beads, which fall; 0 in equilibrium.

        Raises:
            NotMeasuredError: forces on beads at rest are neither those of an equilibrium nor weights alone.
        """
        force = np.where(self.mobility.free, self.rest, 0.0)
        load = float(np.max(strength * np.maximum(self.overlap, 0.0) ** exponent))
        energy = float(np.median(self.atoms.mass)) * self.speed**2
        impact = energy ** (exponent / (exponent + 1.0)) * float(np.max(strength)) ** (1.0 / (exponent + 1.0))
        least = self.noise + unbalanced * max(load, impact)
        if np.max(np.abs(force)) <= least:
            return 0.0
        falls = reference_places.acceleration(force, self.atoms.mass, self.mobility.free, self.noise)
        if falls is None or np.max(self.overlap) > self.touching or np.any(self.linear) or np.any(self.cubic):
            raise NotMeasuredError(f"beads are not in equilibrium at the start ({self._why})", *PLACES, *_FORCES)
        return falls

    @property
    def _why(self) -> str:
        """Largest force on a bead at rest, and what a scene has for it."""
        place = int(np.argmax(np.abs(np.where(self.mobility.free, self.rest, 0.0))))
        return (
            f"force {self.rest[place]:.6g} on atom {self.atoms.ids[place]}, and no equilibrium was found near it; "
            "supported: an equilibrium, displacements from one (`initial`), beads apart that fall alike "
            "(`gravity: {acceleration: ..., settled: false}`); forces on single beads are `push` of a scene of your own"
        )

    # --- dashpots -----------------------------------------------------------------------------------------------------

    def _measure_drag(self) -> Floats:
        """Drag coefficients from one velocity of all beads, those of the ends away from their walls."""

        def force(speed: float) -> Floats:
            """Forces on all atoms, [atom], moved with one velocity; those of the ends away from their walls."""
            forward, backward = (self._moved(place, speed) - self._moved(place) for place in (self.small, -self.small))
            values = forward
            values[self.chains[:, -1]] = backward[self.chains[:, -1]]
            if np.max(self.overlap) > 0.0:  # pressed walls have dashpots of their own
                for end, beside in ((0, 1), (-1, -2)):
                    values[self.chains[:, end]] = values[self.chains[:, beside]]
            return values

        once, twice = force(self.speed), force(2.0 * self.speed)
        least = self.noise + ROUNDED * float(np.max(np.abs(once)))
        if np.any(np.abs(twice - 2.0 * once) > least + AGREE * np.abs(once)):
            raise NotMeasuredError(
                "a drag is not proportional to the velocity; supported: `fix viscous`", "fix viscous"
            )
        self._drag = np.where(np.abs(once) <= least, 0.0, -once / self.speed)
        return self._drag[self.chains]

    def _measure_dashpots(self, result: Measured) -> None:
        """Dashpots of the contacts at two overlaps, and whether they cut tension."""

        def resistance(level: float, rate: float) -> Floats:
            """Dashpot forces over the rate at which the contacts close, [chain, contact], at an overlap."""
            still, moving = self._alternating(level), self._alternating(level, rate)
            drag = 0.5 * rate * self._drag[self.chains]
            lower, upper = moving[0] - still[0] - drag[:, :-1], moving[1] - still[1] - drag[:, 1:]
            return self._of_contacts((lower, upper)) / rate

        weak, strong = (resistance(level, self.speed) for level in (LEVELS[0], LEVELS[2]))
        if np.max(np.abs(strong)) * self.speed < ROUNDED * self.contact_force:
            return
        again = resistance(LEVELS[2], 2.0 * self.speed)
        if np.any(np.abs(again - strong) > 1e-5 * np.max(strong)) or np.any(strong < 0.0):
            raise NotMeasuredError("the damping of a contact is not proportional to its velocity", *_CONTACTS)
        result.dashpot = np.stack([weak, strong])
        result.dashpot_overlap = np.stack([self._overlaps(level) for level in (1.0, 4.0)])
        elastic = result.strength * result.dashpot_overlap[0] ** result.exponent
        fast = 4.0 * float(np.max(elastic / np.where(weak > 0.0, weak, np.inf)))
        result.cut = bool(np.all(np.abs(resistance(LEVELS[0], -fast) * fast) <= elastic * (1.0 + 1e-5)))

    # --- springs between chains and inside beads ----------------------------------------------------------------------

    def _measure_coupling(self) -> dict[tuple[int, int], Floats]:
        """Springs and dashpots between chains, from the displacement or velocity of one chain."""
        coupling: dict[tuple[int, int], Floats] = {}
        least = self.noise / self.small
        for chain in range(len(self.chains) - 1):
            chosen = (self.chain_of == chain).astype(np.float64)
            each = [self._moved(level * self.small * chosen) - self.rest for level in LEVELS]
            each = [force[self.chains] / (level * self.small) for force, level in zip(each, LEVELS, strict=True)]
            dashpot = (self._moved(0.0, self.speed * chosen) - self.rest)[self.chains] / self.speed
            for other in range(chain + 1, len(self.chains)):
                cubic = (each[1][other] - each[0][other]) / (3.0 * self.small**2)
                linear = each[0][other] - cubic * self.small**2
                deviation = np.max(np.abs(linear + 16.0 * cubic * self.small**2 - each[2][other]))
                largest = np.max(np.abs(each[2][other]))
                if deviation > max(AGREE * largest, least):
                    raise NotMeasuredError(
                        "a spring between chains is neither linear nor cubic in the displacement along the chains; "
                        "supported: `bond_coeff N K 0`, whose rest length is 0",
                        *_SPRINGS,
                    )
                table = np.stack([linear, cubic, dashpot[other]])
                table[0][np.abs(linear) < least] = 0.0
                table[1][np.abs(cubic) * self.small**2 < max(least, ROUNDED * largest)] = 0.0
                table[2][np.abs(table[2]) * self.speed <= self.noise] = 0.0
                if np.any(table):
                    coupling[chain, other] = table
        return coupling

    def _measure_inner(self) -> None:
        for part in self.inner:
            present = part.atoms >= 0
            chosen = np.zeros(len(self.rows))
            chosen[part.atoms[present]] = 1.0
            beads = self.chains[part.chain]
            weak, medium = ((self._moved(d * chosen) - self.rest)[beads] / d for d in (self.small, 2.0 * self.small))
            if np.any(np.abs(medium - weak) > AGREE * np.max(np.abs(medium))):
                raise NotMeasuredError(
                    "the spring of an atom inside a bead is not linear; supported: `bond_coeff N K 0`", *_SPRINGS
                )
            part.stiffness = weak
            part.damping = (self._moved(0.0, self.speed * chosen) - self.rest)[beads] / self.speed
            part.damping[np.abs(part.damping) * self.speed <= self.noise] = 0.0

    # --- walls --------------------------------------------------------------------------------------------------------

    def _measure_walls(self, exponent: float) -> tuple[dict[str, Floats], dict[str, Floats], list[WallLaw]]:
        """Constants of the walls, [chain], their dashpots, [2, chain], and walls of other laws or other distances."""
        walls, dashpots, others = {}, {}, []
        gap, pressed = max(0.0, -float(np.min(self.overlap))), float(np.max(self.overlap)) > self.touching
        steps = [gap + level * self.small for level in LEVELS]
        for side in ("left", "right"):
            if np.all(self.mobility.driven[self.chains[:, 0 if side == "left" else -1]]):
                continue

            def push(distance: float, speed: float, side: str = side) -> Floats:
                """Force of the wall on the bead before it, [chain]."""
                return self._push_of_wall(side, distance, speed)

            inside = steps[-1] < self._way_to_face(side)
            forces = np.array([push(step, 0.0) for step in steps]) if inside else np.zeros((1, 1))
            try:
                if np.max(forces) > self._noise_at(steps[-1]):
                    constants = np.array([_wall(values, steps, gap, exponent) for values in forces.T.tolist()])
                    # increases of a linear force do not show where it begins
                    if pressed or np.allclose(forces[0], constants * self.small**exponent, rtol=100.0 * AGREE):
                        walls[side] = constants
                        dashpots[side] = wall_dashpot(push, np.array([steps[0], steps[2]]), self.speed)
                        continue
            except NotMeasuredError:
                if pressed:
                    raise
            if not pressed:
                reach = Reach(self.small, float(np.min(self.atoms.radius[self.chains])), self._way_to_face(side))
                other = wall_law(side, push, reach, self._noise_at, exponent, self.speed)
                others += [] if other is None else [other]
        return walls, dashpots, others

    def _push_of_wall(self, side: str, distance: float, speed: float) -> Floats:
        """Force on the beads at an end, [chain], away from it, all beads moved towards it, less that at the start."""
        sign, bead = (-1.0, 0) if side == "left" else (1.0, -1)
        displacement = np.full(len(self.rows), sign * distance)
        force = self._moved(displacement, sign * speed) - self._ground(displacement) - self.rest
        return -sign * (force + self._drag * sign * speed)[self.chains[:, bead]]

    def _noise_at(self, distance: float) -> float:
        """Force of the size of rounding on beads that are all moved by a distance."""
        return self.noise + 100.0 * ROUNDED * float(np.max(np.abs(self._ground(np.full(len(self.rows), distance)))))

    def _way_to_face(self, side: str) -> float:
        """Distance by which all atoms can be moved towards an end without one leaving the box."""
        place = self.atoms.place[:, self.axis]
        self._moved(0.0)
        low, high, _ = self.atoms.box(self.axis)
        distance = float(np.min(place) - low) if side == "left" else float(high - np.max(place))
        self._moved(-self.small if side == "left" else self.small)
        if self.atoms.box(self.axis)[:2] != (low, high):  # the box follows the atoms
            return MOST_DISTANCES * float(np.min(self.atoms.radius[self.chains]))
        return distance * (1.0 - 1e-9)

    # --- what moves, and when -----------------------------------------------------------------------------------------

    def _refuse_velocities_across(self) -> None:
        """Refuse beads that leave their chain."""
        if np.any(np.delete(self.atoms.velocity, self.axis, axis=1)):
            raise NotMeasuredError(
                "beads have velocities across their chain; supported: velocities along it",
                "velocity",
                "set",
                "read_data",
            )

    def _refuse_time(self) -> None:
        """Refuse forces that depend on the time."""
        before = self._moved(self.small)
        for _ in range(2):
            self.atoms.at_another_time()
            force = self._moved(self.small)
            if np.any(np.abs(force - before) > ROUNDED * np.max(np.abs(before))):
                raise NotMeasuredError(
                    "a force depends on the time, which is not read; write `push`, `drive` (a wall that moves is a "
                    "bead at the end with one) or `foundation` into a scene of your own",
                    TIME,
                )

    def _held(self) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Whether a bead never moves, [chain, bead], and whether its motion is given, whatever acts on it."""
        mobility, velocity = self.mobility, self.atoms.velocity[self.chains, self.axis]
        driven, moved = mobility.driven[self.chains], mobility.integrated[self.chains]
        if np.any(velocity[~moved & ~driven]):
            raise NotMeasuredError(
                "a bead that no `fix nve` moves has a velocity; supported: beads that are held, or moved by `fix move`",
                "velocity",
            )
        constant = moved & ~mobility.pushed[self.chains]
        driven = driven | (constant & (velocity != 0.0))
        if np.all(driven | ~moved | constant):
            raise NotMeasuredError(
                "no bead moves freely; supported: chains of at least 2 beads that forces move", "fix move", "fix freeze"
            )
        return (~moved | constant) & ~driven, driven

    def _forget_forces_on_driven(self, result: Measured) -> None:
        """Give driven beads the springs and drag of the next free one: forces on them have no effect."""
        for chain, bead in np.argwhere(result.driven).tolist():
            free = np.flatnonzero(~result.driven[chain] & ~result.held[chain])
            if not len(free):
                continue
            like = int(free[np.argmin(np.abs(free - bead))])
            result.foundation[:, chain, bead] = result.foundation[:, chain, like]
            result.drag[chain, bead] = result.drag[chain, like]
            for (first, second), table in result.coupling.items():
                if chain in (first, second):
                    table[:, bead] = table[:, like]


def _exponent(first: Floats, second: Floats, overlaps: list[Floats]) -> float:
    """Exponent of the power of the overlap whose increases these are, by the contact that pushes hardest."""
    place = np.unravel_index(int(np.argmax(first)), first.shape)
    low, middle, high = (float(overlap[place]) for overlap in overlaps)
    ratio = float(second[place] / first[place])

    def deviation(exponent: float) -> float:
        return float((high**exponent - middle**exponent) / (middle**exponent - low**exponent) - ratio)

    for exponent in (1.5, 1.0, 2.0):
        if abs(deviation(exponent)) < 1e-7 * ratio:
            return exponent
    if deviation(0.5) > 0.0 or deviation(LARGEST_EXPONENT) < 0.0:
        raise NotMeasuredError("the force of a contact is no power of the overlap; supported: hertz, hooke", *_CONTACTS)
    return round(float(brentq(deviation, 0.5, LARGEST_EXPONENT, xtol=1e-12)), 6)


def _wall(forces: list[float], steps: list[float], gap: float, exponent: float) -> float:
    """Constant of a wall from its forces, less that at the start, at three displacements towards it.

    Raises:
        NotMeasuredError: the wall is not where a bead would be.
    """
    first, second = forces[1] - forces[0], forces[2] - forces[1]

    def strength(overlap: float) -> tuple[float, float]:
        weak, medium, strong = ((step + overlap) ** exponent for step in steps)
        return first / (medium - weak), second / (strong - medium)

    def deviation(overlap: float) -> float:
        weak, medium = strength(overlap)
        return medium / weak - 1.0

    overlap = -gap
    if first > 0.0 and abs(deviation(-gap)) > AGREE and gap == 0.0:
        ends = [deviation(0.0), deviation(1e3 * steps[0])]
        overlap = float(brentq(deviation, 0.0, 1e3 * steps[0], xtol=1e-16)) if ends[0] * ends[1] < 0.0 else math.nan
    if not first > 0.0 or not abs(deviation(overlap)) < 100.0 * AGREE:
        raise NotMeasuredError(
            "a wall does not have the law of the contacts, or is not as far from the last bead as the beads are from "
            "each other; supported: `fix wall/gran` where the next bead would touch",
            "fix wall/gran",
            "fix addforce",
        )
    return float(strength(overlap)[0])
