"""The scene whose equations are those that were measured of a deck.

Lengths, times and velocities are the deck's. In reduced units a scene has beads of mass 1, so that masses, stiffnesses
and forces are those of the deck over the mass of the most frequent bead; in SI units they are the deck's.
"""

import math
from collections import Counter
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from granchain.parts import dashpot, output, units, walls
from workflow.plugins.adopt.chains import Inner, Measured, NotMeasuredError
from workflow.plugins.adopt.digits import SAME, tidy
from workflow.plugins.adopt.walls_at_gap import fitted

Floats = NDArray[np.float64]

NEGLIGIBLE = 1e-6
"""Distances in units of L, and forces in units of m V / T, that are none."""

SETTLED = 1e-5
"""Velocities in units of V, and displacements of as much energy, that a relaxation leaves and that do not matter."""

MOST_ENTRIES = 5
"""Beads with displacements that are entries of `initial`; more are a table."""

FRAMES = 0.1
"""Time between frames in units of T where the deck has no dump."""


def single_value(values: Any, message: str, *commands: str) -> float:
    """The number that all values are.

    Raises:
        NotMeasuredError: they differ.
    """
    array = np.asarray(values, dtype=np.float64)
    if not _alike(array):
        raise NotMeasuredError(message, *commands)
    return tidy(float(np.mean(array)))


def _alike(values: Floats) -> bool:
    """Whether all values are one number."""
    return bool(np.ptp(values) <= SAME * np.max(np.abs(values)))


class SceneKeys:
    """Keys of a scene from a measurement.

    Attributes:
        measured: chains with walls at their ends, gravity towards higher numbers.
        mass: mass of the reference bead, in the deck's unit.
        notes: what a user should know.
    """

    def __init__(self, measured: Measured, *, si: bool, poisson_ratio: float = 0.0) -> None:
        self.si, self.poisson_ratio = si, poisson_ratio
        self.notes: list[str] = []
        self._take(fitted(measured.without_held()))
        if self._pressed_backwards:
            self._take(self.measured.reversed())

    def _take(self, measured: Measured) -> None:
        """Take chains in one order of their beads, and determine what units follow from."""
        self.measured = measured
        masses, radii = (map(tidy, np.ravel(values)) for values in (self.measured.mass, self.measured.radius))
        kinds = Counter(zip(masses, radii, strict=True))
        (self.mass, self.radius), _ = kinds.most_common(1)[0]
        self._kinds = list(kinds)
        self.unit = 1.0 if self.si else self.mass
        self.reference = self._reference_strength()
        self.scale = units.make_scale(self.mass, self.reference, self._speed(), si=self.si, exponent=measured.exponent)

    def _speed(self) -> float:
        """Largest velocity of a bead at the start, of a motion, of a fall, or of a bead with the energy of a link."""
        measured = self.measured
        power = measured.exponent
        speeds = [float(np.max(np.abs(measured.velocity))), *(motion.speed for motion in measured.motions.values())]
        if measured.acceleration:
            rest = (self.mass * abs(measured.acceleration) / self.reference) ** (1.0 / power)
            speeds.append(math.sqrt(2.0 * abs(measured.acceleration) * (max(0.0, -np.min(measured.overlap)) + rest)))
        x = measured.displacement
        if np.any(x):
            overlap = np.maximum(measured.overlap - np.diff(x, axis=1), 0.0)
            more = np.abs(overlap ** (power + 1.0) - np.maximum(measured.overlap, 0.0) ** (power + 1.0))
            energies = [measured.strength * more / (power + 1.0)]
            energies += [measured.foundation[0] * x**2 / 2.0 + measured.foundation[1] * x**4 / 4.0]
            energies += [table[0] * (x[a] - x[b]) ** 2 / 2.0 for (a, b), table in measured.coupling.items()]
            speeds.append(math.sqrt(2.0 * max(float(np.max(energy)) for energy in energies) / self.mass))
        return max(speeds)

    @property
    def _forces_at_rest(self) -> Floats:
        """Static loads of the contacts, [chain, contact], without those of the size of rounding."""
        load = self.measured.load
        return load if np.max(load) > NEGLIGIBLE * self.scale.force else np.zeros_like(load)

    @property
    def _even_load(self) -> float:
        """Largest difference of loads that is rounding."""
        measured = self.measured
        slope = measured.exponent * measured.strength * np.maximum(measured.overlap, 0.0) ** (measured.exponent - 1.0)
        return max(1e-7 * float(np.max(self._forces_at_rest)), 2.0 * float(np.max(slope)) * measured.rounding)

    @property
    def _pressed_backwards(self) -> bool:
        """Whether gravity acts towards the first beads, where scenes have it towards the last."""
        if self.measured.acceleration:
            return self.measured.acceleration < 0.0
        return float(np.min(self._forces_at_rest[:, -1] - self._forces_at_rest[:, 0])) < -self._even_load

    def _reference_strength(self) -> float:
        """Contact constant of two reference beads, in the deck's units."""
        measured = self.measured
        both = np.isclose(measured.mass, self.mass, rtol=SAME) & np.isclose(measured.radius, self.radius, rtol=SAME)
        pairs = both[:, :-1] & both[:, 1:] & (measured.strength > 0.0)
        values = measured.strength[pairs] if np.any(pairs) else self._scaled_to_reference()
        counted = Counter(map(tidy, values.tolist()))
        return counted.most_common(1)[0][0]

    def _scaled_to_reference(self) -> Floats:
        """Contact constants that two reference beads of the same material would have, from all contacts."""
        measured = self.measured
        size = (
            2.0 * measured.radius[:, :-1] * measured.radius[:, 1:] / (measured.radius[:, :-1] + measured.radius[:, 1:])
        )
        return np.ravel(measured.strength / np.sqrt(size / self.radius))

    def keys(self, name: str, deck: str, every: int | None, steps: int) -> dict[str, Any]:
        """All keys, as plain data of a scene.

        Args:
            name: name of the scene.
            deck: name of the deck.
            every: steps between frames; some tenth of T if None.
            steps: steps of the run.
        """
        measured = self.measured
        keys: dict[str, Any] = {"name": name}
        keys |= {"chains": measured.mass.shape[0], "beads": measured.mass.shape[1]}
        for part in (
            *(
                self._periodic,
                self._gap,
                self._material,
                self._contacts_and_beads,
                self._coupling,
                self._foundation,
                self._resonators,
            ),
            *(self._walls, self._damping, self._load, self._start, self._drives),
        ):
            keys |= part()
        step = measured.timestep
        if every is None:
            every = max(1, math.floor(FRAMES * self.scale.time / step))
        every = self._near_enough(min(every, steps), step)
        keys |= {"duration": tidy(steps * step), "timestep": step, "output": {"every": tidy(every * step)}}
        return keys | self._adopted(deck)

    def _near_enough(self, every: int, step: float) -> int:
        """Steps between frames: those of the deck, or a divisor of them where waves would be lost in between."""
        reason = output.too_far_apart(every * step / self.scale.time, self.scale)
        if not reason:
            return every
        largest = max(1, math.floor(FRAMES * self.scale.time / step))
        divisor = next(number for number in range(min(largest, every), 0, -1) if every % number == 0)
        self.notes.append(f"{reason}: `output.every` is {divisor} of the {every} steps between them")
        return divisor

    def _adopted(self, deck: str) -> dict[str, Any]:
        """Key `adopted`: which atom of the deck is which bead, and what its walls are."""
        measured = self.measured
        axis = "-" * (measured.direction < 0.0) + "xyz"[measured.axis]
        keys: dict[str, Any] = {"deck": deck, "axis": axis, "atoms": [atoms_text(ids) for ids in measured.ids]}
        keys |= {"timestep": measured.timestep} | ({"first_step": measured.first_step} if measured.first_step else {})
        for side in measured.walls:
            held = measured.wall_atoms.get(side)
            keys[f"{side}_wall"] = "fix wall/gran" if held is None else f"held atom {', '.join(map(str, held))}"[:200]
        return {"adopted": keys}

    # --- chains -------------------------------------------------------------------------------------------------------

    def _periodic(self) -> dict[str, Any]:
        measured = self.measured
        if measured.around is None:
            return {}
        if np.max(measured.overlaps) > NEGLIGIBLE * self.scale.length:
            raise NotMeasuredError(
                "the beads of a ring press each other at rest; supported: rings of beads that touch, or with gaps",
                "boundary",
            )
        return {"periodic": True}

    def _gap(self) -> dict[str, Any]:
        overlap, least = self.measured.overlaps, NEGLIGIBLE * self.scale.length
        if np.max(np.abs(overlap)) < least or np.max(overlap) > least:
            return {}
        if not np.ptp(overlap) > least:
            return {"gap": tidy(-float(np.mean(overlap)))}
        gaps = [[tidy(-value) if -value > least else 0.0 for value in row] for row in overlap.tolist()]
        return {"gap": gaps[0] if all(row == gaps[0] for row in gaps) else gaps}

    def _material(self) -> dict[str, Any]:
        if not self.si:
            return {}
        density = self.mass / units.sphere_mass(self.radius, 1.0)
        modulus = 3.0 * (1.0 - self.poisson_ratio**2) * self.reference / math.sqrt(2.0 * self.radius)
        constants = {"radius": self.radius, "density": tidy(density), "youngs_modulus": tidy(modulus)}
        return {"material": constants | {"poisson_ratio": self.poisson_ratio}}

    def _contacts_and_beads(self) -> dict[str, Any]:
        """Keys `contact`, `kinds`, `pattern` and `replace`."""
        measured = self.measured
        contact: dict[str, Any] = {}
        keys: dict[str, Any] = {}
        if np.any(measured.strength <= 0.0):
            raise NotMeasuredError(
                "two neighbouring beads do not touch; supported: contacts between all neighbours of a chain",
                "pair_coeff",
                "special_bonds",
            )
        if measured.exponent != 1.5:
            contact["exponent"] = measured.exponent
        if (measured.exponent != 1.5 or not self.si) and (constant := tidy(self.reference / self.unit)) != 1.0:
            contact["stiffness"] = constant
        by_size = np.allclose(self._scaled_to_reference(), self.reference, rtol=SAME) and measured.exponent == 1.5
        kinds = [kind if by_size else (kind[0], self.radius) for kind in self._kinds]
        kinds = list(dict.fromkeys(kinds))
        if not by_size and not np.allclose(measured.strength, self.reference, rtol=SAME):
            if measured.around is not None:
                raise NotMeasuredError(
                    "the contacts of a ring differ otherwise than by the sizes of its beads; supported: rings of "
                    "alike contacts",
                    "boundary",
                )
            strength = [[tidy(value / self.reference) for value in row] for row in measured.strength.tolist()]
            contact["strength"] = strength[0] if all(row == strength[0] for row in strength) else strength
        if contact:
            keys["contact"] = contact
        return keys | (self._kinds_of_beads(kinds, by_size) if len(kinds) > 1 else {})

    def _kinds_of_beads(self, kinds: list[tuple[float, float]], by_size: bool) -> dict[str, Any]:
        reference = (self.mass, self.radius)
        ordered = [reference, *(kind for kind in kinds if kind != reference)]
        names = {kind: f"kind{number}" for number, kind in enumerate(ordered, 1)}
        named: dict[str, dict[str, float]] = {}
        for kind, name in names.items():
            mass, radius = kind
            keys = {"mass": tidy(mass / self.unit)} if mass != self.mass else {}
            if by_size and radius != self.radius:
                keys = {"mass": tidy(mass / self.unit), "radius": radius if self.si else tidy(radius / self.radius)}
            named[name] = keys
        rows = []
        for masses, radii in zip(self.measured.mass.tolist(), self.measured.radius.tolist(), strict=True):
            beads = zip(map(tidy, masses), map(tidy, radii), strict=True)
            rows.append([names[mass, radius if by_size else self.radius] for mass, radius in beads])
        others = [(chain, bead) for chain, row in enumerate(rows) for bead, name in enumerate(row) if name != "kind1"]
        if 10 * len(others) <= self.measured.mass.size:
            places = [{"chain": chain + 1, "bead": bead + 1, "kind": rows[chain][bead]} for chain, bead in others]
            return {"kinds": {name: keys for name, keys in named.items() if name != "kind1"}, "replace": places}
        patterns = [_period(row) for row in rows]
        same = all(pattern == patterns[0] for pattern in patterns)
        return {"kinds": named, "pattern": patterns[0] if same else patterns}

    # --- springs ------------------------------------------------------------------------------------------------------

    def _coupling(self) -> dict[str, Any]:
        springs = {edge: table for edge, table in self.measured.coupling.items() if np.any(table[:2])}
        if not springs:
            return {}
        commands = ("bond_coeff", "create_bonds", "read_data")
        tables = np.array(list(springs.values())) / self.unit
        if np.any(tables[:, :2] < 0.0):
            raise NotMeasuredError("a spring between chains has a negative stiffness; supported: 0 or more", *commands)
        rows = np.flatnonzero(np.any(tables[:, :2] > 0.0, axis=(0, 1)))
        first, last, beads = int(rows[0]), int(rows[-1]), tables.shape[2]
        keys: dict[str, Any] = {}
        inside = tables[:, :, first : last + 1]
        edges = sorted(springs)
        constant = np.all(np.ptp(inside[:, 0], axis=1) <= SAME * np.max(inside[:, 0]))
        if constant:
            each: list[Any] = [tidy(float(row[0])) for row in inside[:, 0]]
        else:
            profile = inside[0, 0]
            if len(edges) > 1 and np.any(np.abs(inside[:, 0] - profile) > SAME * np.max(profile)):
                raise NotMeasuredError("springs between chains differ both by row and by pair of chains", *commands)
            each = [_ramp(tables[0, 0])]
            first, last = 0, beads - 1
        if (first, last) != (0, beads - 1):
            keys["rows"] = [first + 1, last + 1]
        cubic = single_value(
            inside[:, 1], "cubic springs between chains differ; supported: one `cubic` of all", *commands
        )
        keys |= {"cubic": cubic} if cubic else {}
        neighbours = [(chain, chain + 1) for chain in range(self.measured.mass.shape[0] - 1)]
        if all(value == each[0] for value in each):
            keys = {"stiffness": each[0]} | keys
            if edges != neighbours:
                keys["topology"] = {"edges": [[a + 1, b + 1] for a, b in edges]}
        else:
            keys["topology"] = {"edges": [[a + 1, b + 1, k] for (a, b), k in zip(edges, each, strict=True)]}
        return {"coupling": keys}

    def _foundation(self) -> dict[str, Any]:
        linear, cubic = self.measured.foundation / self.unit
        if not np.any(linear) and not np.any(cubic):
            return {}
        if np.any(linear < 0.0) or np.any(cubic < 0.0):
            raise NotMeasuredError("a spring to the ground has a negative stiffness", "fix spring/self", "fix addforce")
        message = "springs to the ground differ along a chain; supported: one stiffness for each chain, in some rows"
        rows = np.flatnonzero(np.any((linear != 0.0) | (cubic != 0.0), axis=0))
        first, last = int(rows[0]), int(rows[-1])
        keys: dict[str, Any] = {}
        for name, values in (("stiffness", linear), ("cubic", cubic)):
            each = [single_value(row[first : last + 1], message, "fix spring/self", "fix addforce") for row in values]
            if any(each):
                keys[name] = each[0] if all(value == each[0] for value in each) else each
        if (first, last) != (0, linear.shape[1] - 1):
            keys["rows"] = [first + 1, last + 1]
        return {"foundation": keys}

    def _resonators(self) -> dict[str, Any]:
        parts = [self._resonator(part) for part in self.measured.inner]
        if not parts:
            return {}
        chains = self.measured.mass.shape[0]
        alike: dict[str, list[tuple[int, dict[str, Any]]]] = {}
        for part, keys in zip(self.measured.inner, parts, strict=True):
            alike.setdefault(str(keys), []).append((part.chain, keys))
        entries = []
        for members in alike.values():
            keys, present = members[0][1], Counter(chain for chain, _ in members)
            for layer in range(max(present.values())):
                of_chain = [present[chain] > layer for chain in range(chains)]
                both = {} if all(of_chain) else {n: [keys[n] * has for has in of_chain] for n in ("mass", "stiffness")}
                entries.append(keys | both)
        return {"resonators": entries[0] if len(entries) == 1 else entries}

    def _resonator(self, part: Inner) -> dict[str, Any]:
        present = np.flatnonzero(part.atoms >= 0)
        message = "atoms inside the beads of a chain differ; supported: one mass and one stiffness in a range of rows"
        if len(present) != present[-1] - present[0] + 1:
            raise NotMeasuredError(message, "set", "read_data")
        values = {
            name: single_value(getattr(part, name)[present] / self.unit, message, "bond_coeff", "set", "read_data")
            for name in ("mass", "stiffness", "damping")
        }
        keys: dict[str, Any] = {name: value for name, value in values.items() if value or name != "damping"}
        if len(present) < len(part.atoms):
            keys["rows"] = [int(present[0]) + 1, int(present[-1]) + 1]
        return keys

    # --- walls, dashpots, loads ---------------------------------------------------------------------------------------

    def _walls(self) -> dict[str, Any]:
        keys: dict[str, Any] = {}
        for side, strengths in self.measured.walls.items():
            end = 0 if side == "left" else -1
            of_like = self.reference * np.sqrt(self.measured.radius[:, end] / self.radius)
            kinds = walls.STRENGTHS if self.measured.exponent == 1.5 else {"bead": 1.0}
            name = next((n for n, share in kinds.items() if np.allclose(strengths / of_like, share, rtol=SAME)), None)
            message = "the walls of the chains differ; supported: one wall at each end"
            keys[side] = name or {"stiffness": single_value(strengths / self.unit, message, "fix wall/gran")}
        return {"walls": keys} if keys else {}

    def _damping(self) -> dict[str, Any]:
        measured = self.measured
        keys: dict[str, Any] = {}
        if np.any(measured.dashpot):
            keys |= self._dashpots_of_contacts()
        message = "the drag of beads differs; supported: one `damping.beads` of all"
        drag = single_value(measured.drag / self.unit, message, "fix viscous")
        keys |= {"beads": drag} if drag else {}
        between = [table[2] for table in measured.coupling.values()]
        if np.any(between):
            message = "dashpots between chains differ; supported: one coefficient for all springs"
            keys["coupling"] = single_value(np.array(between) / self.unit, message, "pair_coeff")
        return {"damping": keys} if keys else {}

    def _restores(self, power: float) -> bool:
        """Whether dashpots that grow with a power of the overlap are those of a restitution."""
        return abs(power - (self.measured.exponent - 1.0) / 2.0) < 1e-5

    def _dashpots_of_contacts(self) -> dict[str, Any]:
        measured = self.measured
        (low, high), (near, far) = measured.dashpot, measured.dashpot_overlap
        power = float(np.mean(np.log(high / low) / np.log(far / near)))
        message = "the dashpots of contacts differ; supported: one law and coefficient of all contacts"
        commands = ("pair_coeff", "pair_style")
        tension = {"tension": "cut"} if measured.cut else {}
        linear, viscoelastic = low / self.unit, low / np.sqrt(near) / self.unit
        pair = measured.mass[:, :-1] * measured.mass[:, 1:] / (measured.mass[:, :-1] + measured.mass[:, 1:])
        ratio = low / near**power / np.sqrt(pair * measured.strength)
        # laws of one power of the overlap differ in what is the same in all contacts
        if abs(power) < 1e-5 and (not self._restores(power) or _alike(linear)):
            return {"contact": single_value(linear, message, *commands)} | tension
        if abs(power - 0.5) < 1e-5 and (not self._restores(power) or _alike(viscoelastic)):
            return {"contact": single_value(viscoelastic, message, *commands), "law": "viscoelastic"} | tension
        if self._restores(power):
            value = single_value(ratio, message, *commands)
            share = brentq(lambda e: dashpot.alpha(e, measured.exponent) - value, 1e-6, 1.0, xtol=1e-15)
            return {"contact": tidy(float(share)), "law": "restitution"}
        raise NotMeasuredError(
            f"the dashpots of contacts grow as overlap^{power:.4g}; supported: powers 0 (`damping velocity`), 0.5 "
            "(`viscoelastic`) and 0.25 (`coeff_restitution`)",
            *commands,
        )

    def _load(self) -> dict[str, Any]:
        """Static loads: forces of the contacts at rest are F0 + g (m_1 + ... + m_n)."""
        measured, load = self.measured, self._forces_at_rest
        if measured.acceleration:
            return {"gravity": {"acceleration": tidy(measured.acceleration), "settled": False}}
        if not np.any(load):
            return {}
        weight = np.cumsum(measured.mass, axis=1)[:, :-1]
        if np.ptp(load) <= self._even_load:
            acceleration, force = 0.0, float(np.mean(load))
        else:
            matrix = np.stack([np.ravel(weight), np.ones(load.size)], axis=1)
            (acceleration, force), *_ = np.linalg.lstsq(matrix, np.ravel(load), rcond=None)
            if np.any(np.abs(matrix @ [acceleration, force] - np.ravel(load)) > 1e-6 * np.max(load)):
                raise NotMeasuredError(
                    "the forces of the contacts at the start are those of no static load; supported: the same in all "
                    "(`precompression`), or growing by the weight of each bead (`gravity`)",
                    "create_atoms",
                    "read_data",
                    "fix addforce",
                    "fix gravity",
                )
        keys: dict[str, Any] = {"gravity": tidy(float(acceleration))} if acceleration else {}
        if abs(force) > 1e-6 * np.max(load):
            keys["precompression"] = {"force": tidy(float(force) / self.unit)}
        return keys

    def _start(self) -> dict[str, Any]:
        """Velocities and displacements at the start: key `initial` if there are displacements, else `kick`."""
        x, velocity = self._displacement, self.measured.velocity
        if self.measured.relaxed:
            x, velocity = self._without_rest(x, velocity)
        if not np.any(x):
            kicks = [
                {"chain": int(chain) + 1, "bead": int(bead) + 1, "velocity": tidy(float(velocity[chain, bead]))}
                for chain, bead in np.argwhere(velocity != 0.0)
            ]
            return {"kick": kicks} if kicks else {}
        rows = [
            [int(chain) + 1, int(bead) + 1, tidy(float(x[chain, bead])), tidy(float(velocity[chain, bead]))]
            for chain, bead in np.argwhere((x != 0.0) | (velocity != 0.0))
        ]
        if len(rows) > MOST_ENTRIES:
            return {"initial": {"table": rows}}
        names = ("chain", "bead", "displacement", "velocity")
        entries = [{name: value for name, value in zip(names, row, strict=True) if value} for row in rows]
        return {"initial": entries[0] if len(entries) == 1 else entries}

    @property
    def _displacement(self) -> Floats:
        """Displacements at the start; where nothing holds the beads in their places, such that most beads have none."""
        measured, x = self.measured, self.measured.displacement
        if not (np.any(measured.foundation) or measured.walls or measured.motions or measured.inner):
            middle = np.sort(np.ravel(x))[x.size // 2]
            if np.count_nonzero(np.abs(x - middle) <= measured.rounding) > x.size // 2:
                x = x - middle
        return np.where(np.abs(x) <= measured.rounding, 0.0, x)

    def _without_rest(self, x: Floats, velocity: Floats) -> tuple[Floats, Floats]:
        """Displacements and velocities without those that a relaxation has left, too small to matter."""
        measured, fastest = self.measured, self._speed()
        rest = np.maximum(measured.overlap, 0.0)
        stiffest = float(np.max(measured.exponent * measured.strength * rest ** (measured.exponent - 1.0)))
        farthest = min(self.scale.length, fastest * math.sqrt(self.mass / stiffest) if stiffest else math.inf)
        slow, near = np.abs(velocity) <= SETTLED * fastest, np.abs(x) <= SETTLED * farthest
        small = slow & near
        if np.any(small & ((x != 0.0) | (velocity != 0.0))):
            self.notes.append(
                f"what the relaxation leaves of {np.count_nonzero(small)} beads, at most "
                f"{np.max(np.abs(velocity[small])):.1e} of velocity and {np.max(np.abs(x[small])):.1e} of "
                "displacement, is left out"
            )
        return np.where(near, 0.0, x), np.where(small, 0.0, velocity)

    def _drives(self) -> dict[str, Any]:
        """Motions of beads that are given."""
        drives = [
            {"chain": chain + 1, "bead": bead + 1} | motion.keys()
            for (chain, bead), motion in sorted(self.measured.motions.items())
        ]
        return {"drive": drives[0] if len(drives) == 1 else drives} if drives else {}


def _period(row: list[str]) -> list[str]:
    """The shortest pattern that gives a row when it is repeated."""
    lengths = (n for n in range(1, len(row) + 1) if all(row[i] == row[i % n] for i in range(n, len(row))))
    return row[: next(lengths)]


def _ramp(profile: Floats) -> dict[str, Any]:
    """A ramp whose stiffness is this, [row].

    Raises:
        NotMeasuredError: it is none.
    """
    bends = np.flatnonzero(np.abs(np.diff(profile, 2)) > SAME * np.max(profile)) + 1
    changes = np.flatnonzero(np.abs(np.diff(profile)) > SAME * np.max(profile))
    first, last = int(changes[0]), int(changes[-1]) + 1
    ramp = np.interp(np.arange(len(profile)), [first, last], profile[[first, last]])
    if len(bends) > 2 or np.any(np.abs(ramp - profile) > SAME * np.max(profile)):
        raise NotMeasuredError("springs between chains differ from row to row; supported: one ramp", "bond_coeff")
    return {"from": tidy(float(profile[first])), "to": tidy(float(profile[last])), "rows": [first + 1, last + 1]}


def atoms_text(atoms: NDArray[np.int64]) -> str:
    """Shortest text of ranges that names the atoms, [bead], of one chain in their order."""
    parts, start = [], 0
    while start < len(atoms):
        end = start + 1
        if end < len(atoms):
            step = int(atoms[end] - atoms[start])
            while end < len(atoms) and atoms[end] - atoms[end - 1] == step:
                end += 1
            if end - start < 3 and abs(step) != 1:  # two far apart are no range
                end, step = start + 1, 1
        first, last = int(atoms[start]), int(atoms[end - 1])
        every = f":{abs(step)}" if end - start > 1 and abs(step) != 1 else ""
        parts.append(f"{first}" if end - start == 1 else f"{first}-{last}{every}")
        start = end
    return ",".join(parts)
