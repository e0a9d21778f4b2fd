"""From the keys of a scene to its forces (`scenes_nature.Nature`), sharing no code with the product."""

import math
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
from scenes_nature import Floats, Moved, Nature, Push, Units, Wall
from scipy.interpolate import PPoly, make_interp_spline

from lammps_inputs import Scene

FACES = {"bead": 1.0, "flat": 2.0**0.5, "rigid": 2.0**1.5}


_GIVEN: list[Units] = []
"""Units in place of the scene's, while these are looked for."""


def units(scene: Scene) -> Units:
    """V is the fastest of kicks, of free beads that were given a push's impulse, of drives and of initial states.

    Of initial displacements, that of a bead with the energy of the link that stores most.
    """
    if _GIVEN:
        return _GIVEN[-1]
    speeds = _speeds(scene)
    if falls(scene):  # through the gap and the overlap of one bead under its weight
        unit, g, p = _units(scene, 1.0), scene.gravity.acceleration, exponent(scene)
        overlap = (unit.mass * g / unit.force) ** (1.0 / p) * unit.length
        speeds.append(math.sqrt(2.0 * g * (float(np.max(gaps(scene))) + overlap)))
    speeds.append(_released(scene, max(speeds, default=0.0) or 1.0))
    return _units(scene, max(speeds))


def falls(scene: Scene) -> bool:
    return scene.gravity is not None and not scene.gravity.settled


def _released(scene: Scene, velocity: float) -> float:
    if not any(row[2] for row in initial_rows(scene)):
        return 0.0
    _GIVEN.append(_units(scene, velocity))
    try:
        return velocity * math.sqrt(2.0 * nature(scene).most_stored)
    finally:
        _GIVEN.pop()


def initial_rows(scene: Scene) -> list[tuple[int, int, float, float]]:
    """Line and bead, from 1, displacement and velocity."""
    found = []
    for part in scene.initial or ():
        lists = [values for values in (part.displacement, part.velocity) if isinstance(values, tuple)]
        beads = range(1, len(lists[0]) + 1) if lists else [part.bead]
        x, v = (np.broadcast_to(values or 0.0, len(beads)).tolist() for values in (part.displacement, part.velocity))
        found += part.table or [(part.chain, *row) for row in zip(beads, x, v, strict=True)]
    return found


def _units(scene: Scene, velocity: float) -> Units:
    ball, p = scene.material, exponent(scene)
    mass, constant = scene.mass or 1.0, 1.0
    if ball is not None:
        mass = 4.0 / 3.0 * math.pi * ball.radius**3 * ball.density
        constant = ball.youngs_modulus * math.sqrt(2.0 * ball.radius) / (3.0 * (1.0 - ball.poisson_ratio**2))
    constant = _of_contact(scene, "stiffness") or constant
    if (law := formula(scene, "contact")) is not None:
        constant, p = law.first
    return Units(mass, (mass * velocity**2 / constant) ** (1.0 / (p + 1.0)), velocity)


def _speeds(scene: Scene) -> list[float]:
    ball = scene.material
    mass = (scene.mass or 1.0) if ball is None else 4.0 / 3.0 * math.pi * ball.radius**3 * ball.density
    speeds = [abs(velocity) for *_, velocity in [*kicks(scene), *initial_rows(scene)]]
    speeds += [_impulse(push) / mass for push in scene.push or ()]
    for drive in scene.drive or ():
        speeds.append(drive.force / (mass * 2.0 * math.pi * drive.frequency) if drive.force else _fastest(drive))
    return speeds


def exponent(scene: Scene) -> float:
    """By which lengths are measured."""
    given = _of_contact(scene, "exponent")
    return given if isinstance(given, float) else 1.5


def _of_contact(scene: Scene, key: str) -> Any:
    """What the contacts have under a key; None where their law has no such key, or the scene names none."""
    return getattr(scene.contact, key, None)


class Formula:
    """A force of s in the scene's units, evaluated by Python; of contacts of the overlap, 0 where they are cut."""

    def __init__(self, part: Any, contact: bool) -> None:
        self.code = compile(part.force.replace("^", "**"), "formula", "eval")
        self.names = {**vars(np), "abs": np.abs, **part.__pydantic_extra__}
        self.way = 1.0 if not contact or self(1e-6) > self(0.0) else -1.0
        self.cut = contact and self(0.0) == 0.0 and part.tension != "allowed"

    def __call__(self, s: Any) -> Any:
        return eval(self.code, {}, {**self.names, "s": s})

    @property
    def first(self) -> tuple[float, float]:
        """A and p of ``A overlap**p``, as which it begins; p is 1 where it is not cut."""
        if not self.cut:
            return self.way * self(1e-30j).imag / 1e-30, 1.0
        small = 1e-12
        slope, other = (self(self.way * (s + 1e-30j)).imag / 1e-30 for s in (small, 2.0 * small))
        p = 1.0 + round(math.log2(other / slope), 6)
        return slope / (p * small ** (p - 1.0)), p

    def scaled(self, unit: Units) -> Any:
        def force(s: Any) -> Any:
            return self(self.way * unit.length * (np.maximum(s, 0.0) if self.cut else s)) / unit.force

        return force


def formula(scene: Scene, key: str) -> Formula | None:
    part = getattr(scene, key)
    return None if getattr(part, "force", None) is None else Formula(part, key == "contact")


def kicks(scene: Scene) -> list[tuple[int, int, float]]:
    """(chain, bead, velocity) from 1, in the scene's units; the striker's first."""
    first = [] if scene.striker is None else [(scene.striker.chain, 1, scene.striker.velocity)]
    return first + [(kick.chain, kick.bead, kick.velocity) for kick in scene.kick]


def _impulse(push: Any) -> float:
    """Of the size of the force, in the scene's units."""
    if push.table is None:
        return abs(push.peak) * push.duration * (2.0 / math.pi if push.shape == "half-sine" else 1.0)
    total = 0.0
    for (t0, f0), (t1, f1) in pairwise(push.table):
        both = abs(f0) + abs(f1)
        total += 0.5 * (t1 - t0) * (both if f0 * f1 >= 0.0 else (f0**2 + f1**2) / both)
    return total


def _relative(kind: Any, scene: Scene) -> tuple[float, float, float]:
    """Mass, radius and plane modulus in those of the reference bead."""
    ball = scene.material
    if ball is None:
        radius = kind.radius or 1.0
        return kind.mass / (scene.mass or 1.0) if kind.mass else radius**3, radius, kind.stiffness or 1.0
    radius, density = kind.radius or ball.radius, kind.density or ball.density
    mass = kind.mass or 4.0 / 3.0 * math.pi * radius**3 * density
    ratio = ball.poisson_ratio if kind.poisson_ratio is None else kind.poisson_ratio
    modulus = (kind.youngs_modulus or ball.youngs_modulus) / (1.0 - ratio**2)
    own = ball.youngs_modulus / (1.0 - ball.poisson_ratio**2)
    return mass / (4.0 / 3.0 * math.pi * ball.radius**3 * ball.density), radius / ball.radius, modulus / own


def beads_of(scene: Scene) -> tuple[Floats, Floats, Floats]:
    """Mass, radius and plane modulus of every bead, [chain, bead], in those of the reference bead."""
    found = np.ones((3, scene.chains, scene.beads))
    patterns = list(scene.pattern or ())
    for chain in range(scene.chains):
        row = patterns[chain] if patterns and isinstance(patterns[0], tuple) else patterns
        for bead in range(scene.beads if row else 0):
            found[:, chain, bead] = _relative(scene.kinds[row[bead % len(row)]], scene)
    for change in scene.replace or ():
        found[:, change.chain - 1, change.bead - 1] = _relative(scene.kinds[change.kind], scene)
    if scene.taper:
        size = (1.0 - scene.taper) ** np.arange(scene.beads)
        found[0] *= size**3
        found[1] *= size
    if (mess := scene.disorder) is not None:
        mass, radius, modulus = (
            1.0 + getattr(mess, name) * (2.0 * _random(mess.seed, number, scene) - 1.0)
            for number, name in enumerate(("mass", "radius", "stiffness"))
        )
        found *= np.stack([mass * radius**3, radius, modulus])
    if scene.striker is not None:
        found[:, scene.striker.chain - 1, 0] = _relative(scene.striker, scene)
    return found[0], found[1], found[2]


def shape_of_contacts(scene: Scene) -> tuple[int, int]:
    return scene.chains, scene.beads if scene.periodic else scene.beads - 1


def pairs(values: Floats, scene: Scene) -> tuple[Floats, Floats]:
    """Values of the beads behind and ahead of each contact."""
    ahead = np.concatenate([values[:, 1:], values[:, :1]], axis=1)
    count = shape_of_contacts(scene)[1]
    return values[:, :count], ahead[:, :count]


def along(scene: Scene) -> Floats:
    """Factors on the strengths of the contacts by their place, [chain, contact]."""
    return by_contact(_of_contact(scene, "strength"), 1.0, scene)


def by_contact(given: Any, default: float, scene: Scene) -> Floats:
    """A number, a list or a profile, [chain, contact]; a default where there is none."""
    found = np.ones(shape_of_contacts(scene))
    if given is None or isinstance(given, float | tuple):
        return found * (default if given is None else given)
    keys = given.model_dump(exclude_none=True)
    if "amplitude" not in keys:
        found *= keys.get("mean", 1.0 if "to" in keys else default)
    for i in range(1, 1 + found.shape[1]):
        if "to" in keys:
            first, last = keys["contacts"]
            share = min(max((i - first) / (last - first), 0.0), 1.0)
            found[:, i - 1] *= keys["from"] + share * (keys["to"] - keys["from"])
        if "amplitude" in keys:
            angle = 2.0 * math.pi * keys["wavenumber"] * i + math.radians(keys.get("phase", 0.0))
            found[:, i - 1] *= keys.get("mean", 1.0 if "to" in keys else default) + keys["amplitude"] * math.cos(angle)
    if "spread" in keys:
        spread = keys["spread"]
        found *= np.random.default_rng(keys.get("seed", 1)).uniform(1.0 - spread, 1.0 + spread, found.shape)
    return found


def gaps(scene: Scene) -> Any:
    """Clear distances of neighbours in the scene's units: a number, or [chain, contact]."""
    given, found = scene.gap, np.zeros(shape_of_contacts(scene))
    if isinstance(given, float):
        return given
    if isinstance(given, tuple):
        return found + np.array(given)
    if given.mean is not None:
        spread, seed = given.spread, 1 if given.seed is None else given.seed
        return given.mean * np.random.default_rng(seed).uniform(1.0 - spread, 1.0 + spread, found.shape)
    for contact, gap in given.contacts.items():
        found[:, int(contact) - 1] = gap
    return found


def _random(seed: int, number: int, scene: Scene) -> Floats:
    bits = np.random.PCG64(np.random.SeedSequence([seed, number])).random_raw(scene.chains * scene.beads)
    return ((bits >> np.uint64(11)) * 2.0**-53).reshape(scene.chains, scene.beads)


def edges(scene: Scene) -> list[tuple[int, int, float | None]]:
    """Tied chains, from 0, and a stiffness of their own, in the scene's units."""
    tied, chains = scene.coupling.topology, scene.chains
    if tied in (None, "open", "ring"):
        return [(k, k + 1, None) for k in range(chains - 1)] + [(0, chains - 1, None)] * (tied == "ring" and chains > 2)
    if tied.edges:
        return sorted((min(e[:2]) - 1, max(e[:2]) - 1, e[2] if len(e) > 2 else None) for e in tied.edges)
    _rows, columns = tied.lattice
    found = [(k, k + 1, None) for k in range(chains) if (k + 1) % columns]
    return sorted(found + [(k, k + columns, None) for k in range(chains - columns)])


def springs(scene: Scene) -> list[tuple[int, int, Floats, Floats]]:
    """(chain, other, stiffness and cubic stiffness of each row), dimensionless."""
    unit, tied, rows = units(scene), scene.coupling, np.arange(1, scene.beads + 1)
    if tied is None:
        return []
    there = _within(tied.rows, scene)
    if tied.force is not None:
        return [(a, b, there, 0.0 * there) for a, b, _ in edges(scene)]
    shared: Any = tied.stiffness or 0.0
    if not isinstance(shared, float | int):
        shared = np.interp(rows, shared.rows, [getattr(shared, "from"), shared.to])
    cubic = (tied.cubic or 0.0) * unit.length**2 / unit.stiffness * there
    found = [(a, b, (shared if own is None else own) / unit.stiffness * there, cubic) for a, b, own in edges(scene)]
    return [one for one in found if np.any(one[2]) or np.any(one[3])]


def _within(ends: Any, scene: Scene) -> Floats:
    rows = np.arange(1, scene.beads + 1)
    return np.ones(scene.beads) if ends is None else ((rows >= ends[0]) & (rows <= ends[1])) * 1.0


def loads(scene: Scene, mass: Floats) -> Floats:
    """Force at rest, from before the first bead to behind the last, [chain, bead + 1]."""
    unit, found = units(scene), np.zeros((scene.chains, scene.beads + 1))
    if scene.precompression is not None:
        pressed = scene.precompression
        strength = float(along(scene)[0, 0]) if pressed.force is None else 0.0
        force = strength * ((pressed.overlap or 0.0) / unit.length) ** exponent(scene)
        found += force if pressed.force is None else pressed.force / unit.force
    if scene.gravity is not None and scene.gravity.settled:
        found[:, 1:] += np.cumsum(mass, axis=1) * scene.gravity.acceleration * unit.time**2 / unit.length
    return found


def _losses(scene: Scene, mass: Floats, strength: Floats) -> tuple[Any, float]:
    """Coefficient, and the exponent of the overlap."""
    unit, damping, p = units(scene), scene.damping, exponent(scene)
    if damping is None or not damping.contact:
        return 0.0, 0.0
    if damping.law == "viscoelastic":
        return damping.contact / (unit.force / unit.velocity) * unit.length**0.5, 0.5
    if damping.law == "restitution":
        behind, ahead = pairs(mass, scene)
        reduced = 1.0 / (1.0 / ahead + 1.0 / behind)
        return _alpha(damping.contact, p) * np.sqrt(reduced * strength), 0.5 * (p - 1.0)
    return damping.contact / (unit.force / unit.velocity), 0.0


def _alpha(restitution: float, p: float) -> float:
    """Antypov & Elliott 2011; for other exponents as theirs follows from that of a linear spring."""
    log = math.log(restitution)
    return -log * math.sqrt(2.0 * (p + 1.0)) / math.hypot(log, math.pi)


def _walls(scene: Scene, mass: Floats, load: Floats, loss: tuple[Any, float]) -> list[Wall]:
    unit, p, (_, radius, modulus) = units(scene), exponent(scene), beads_of(scene)
    found = []
    for bead, side, name in ((0, -1.0, "left"), (scene.beads - 1, 1.0, "right")):
        face = getattr(scene.walls, name) if scene.walls is not None else None
        if face is None or face == "matched" or getattr(face, "damping", None):
            continue
        if isinstance(face, str):
            strength = FACES[face] * modulus[:, bead] * np.sqrt(radius[:, bead])
        else:
            strength = np.full(scene.chains, face.stiffness / (unit.force / unit.length**p))
        rest = (load[:, bead + (side > 0.0)] / strength) ** (1.0 / p)
        lost = np.zeros(scene.chains)
        if np.any(loss[0]):
            law = scene.damping.law
            lost = lost + (loss[0] if law in (None, "linear") else 0.0)
            lost = lost + (loss[0] * strength if law == "viscoelastic" else 0.0)
            if law == "restitution":
                lost = _alpha(scene.damping.contact, p) * np.sqrt(mass[:, bead] * strength)
        found.append(Wall(bead, side, strength, rest, lost))
    return found


def _quiet_ends(scene: Scene, mass: Floats, stiffness: Floats) -> Floats:
    """Coefficients of dashpots at the ends, [chain, bead], from the stiffness of contacts at rest, [chain, contact]."""
    drag, unit = np.zeros_like(mass), units(scene)
    for bead, name in ((0, "left"), (-1, "right")):
        end = getattr(scene.walls, name) if scene.walls is not None else None
        if end == "matched":
            drag[:, bead] = np.sqrt(stiffness[:, bead] * mass[:, bead])
        elif getattr(end, "damping", None):
            drag[:, bead] = end.damping / (unit.force / unit.velocity)
    return drag


def _pushes(scene: Scene, unit: Units) -> list[Push]:
    found = []
    for push in scene.push or ():
        if push.table is not None:
            points = np.array(push.table) / [unit.time, unit.force]
            of_time = lambda t, p=points: np.interp(t, *p.T, left=0.0, right=0.0)  # noqa: E731
            found.append(Push(push.chain - 1, push.bead - 1, points[-1, 0], of_time, tuple(points[:, 0].tolist())))
            continue
        peak, lasts = push.peak / unit.force, push.duration / unit.time
        shapes = {
            "half-sine": lambda t, a=peak, b=lasts: a * np.sin(math.pi * t / b),
            "rectangular": lambda t, a=peak: a + 0.0 * np.asarray(t),
        }
        found.append(Push(push.chain - 1, push.bead - 1, lasts, shapes[push.shape], (lasts,)))
    for drive in scene.drive or ():
        if drive.force is not None:
            size, omega, phase = drive.force / unit.force, *_turn(drive, unit)
            wave = lambda t, a=size, w=omega, p=phase: a * np.sin(w * np.asarray(t) + p)  # noqa: E731
            found.append(Push(drive.chain - 1, drive.bead - 1, math.inf, wave, ()))
    return found


def _fastest(drive: Any) -> float:
    """Largest size of the velocity of a given motion, in the scene's units."""
    if drive.displacement is not None:
        return drive.displacement * 2.0 * math.pi * drive.frequency
    if drive.velocity is not None:
        return abs(drive.velocity)
    time, second = np.array(drive.table).T
    if drive.quantity == "velocity":
        return float(np.max(np.abs(second)))
    slope = _spline(time, second).derivative()
    turns = slope.derivative().roots() if len(time) > 3 else np.zeros(0)
    within = turns[(time[0] < turns) & (turns < time[-1])]
    return float(np.max(np.abs(slope(np.concatenate([time, within])))))


def _spline(time: Floats, value: Floats) -> Any:
    """The cubic spline through points, or the line or parabola through fewer than four."""
    return PPoly.from_spline(make_interp_spline(time, value, k=min(3, len(time) - 1)))


def _moved(scene: Scene, unit: Units) -> list[Moved]:
    """Beads whose motion is given, each with the sum of its drives."""
    places: dict[tuple[int, int], list[Moved]] = {}
    for drive in scene.drive or ():
        if drive.force is None:
            place = drive.chain - 1, drive.bead - 1
            places.setdefault(place, []).append(Moved(*place, *_motion(drive, unit)))
    return [
        Moved(
            *place,
            lambda t, parts=parts: sum(part.displacement(t) for part in parts),
            lambda t, parts=parts: sum(part.velocity(t) for part in parts),
            tuple(kink for part in parts for kink in part.kinks),
        )
        for place, parts in places.items()
    ]


def _motion(drive: Any, unit: Units) -> tuple[Any, Any, tuple[float, ...]]:
    """Displacement and velocity over time, and times of their kinks."""
    if drive.displacement is not None:
        size, (omega, phase) = drive.displacement / unit.length, _turn(drive, unit)
        return (
            lambda t: size * (np.sin(omega * np.asarray(t) + phase) - math.sin(phase)),
            lambda t: size * omega * np.cos(omega * np.asarray(t) + phase),
            (),
        )
    if drive.velocity is not None:
        begin = (getattr(drive, "from") or 0.0) / unit.time
        end = math.inf if drive.until is None else drive.until / unit.time
        speed, late = drive.velocity / unit.velocity, 1e-9  # a velocity has jumped where that is due
        return (
            lambda t: speed * (np.clip(t, begin, end) - begin),
            lambda t: speed * ((np.asarray(t) >= begin - late) & (np.asarray(t) < end - late)),
            tuple(time for time in (begin, end) if 0.0 < time < math.inf),
        )
    time, second = np.array(drive.table).T
    time = time / unit.time
    kinks = tuple(time[time > 0.0].tolist())
    if drive.quantity == "velocity":
        second = second / unit.velocity
        gone = np.concatenate([[0.0], np.cumsum(np.diff(time) * (second[1:] + second[:-1]) / 2.0)])

        def displacement(t: Any) -> Any:
            k = np.maximum(np.searchsorted(time, t, side="right") - 1, 0)
            s = np.maximum(t - time[k], 0.0)
            return gone[k] + s * 0.5 * (second[k] * (np.asarray(t) >= time[0]) + np.interp(t, time, second))

        return displacement, lambda t: np.interp(t, time, second, left=0.0), kinks
    path = _spline(time, second / unit.length)
    slope = path.derivative()
    there = lambda t: (np.asarray(t) >= time[0]) & (np.asarray(t) < time[-1] - 1e-9)  # noqa: E731
    return lambda t: path(np.clip(t, time[0], time[-1])), lambda t: np.where(there(t), slope(t), 0.0), kinks


def _turn(drive: Any, unit: Units) -> tuple[float, float]:
    return 2.0 * math.pi * drive.frequency * unit.time, math.radians(drive.phase)


def nature(scene: Scene) -> Nature:
    """Of any scene with a duration."""
    unit, p = units(scene), exponent(scene)
    laws = {key: formula(scene, key) for key in ("contact", "coupling", "foundation")}
    mass, radius, modulus = beads_of(scene)
    (behind, ahead), (soft, softer) = pairs(radius, scene), pairs(modulus, scene)
    size = 2.0 * ahead * behind / (ahead + behind)
    strength = 2.0 / (1.0 / softer + 1.0 / soft) * np.sqrt(size) * along(scene)
    powers: float | Floats = p
    if not isinstance(_of_contact(scene, "exponent"), float | None):
        powers = by_contact(scene.contact.exponent, 1.5, scene)
        strength = strength * unit.length ** (powers - p)
    load = loads(scene, mass + sum(kind[0] for kind in _resonators(scene)))
    loss = _losses(scene, mass, strength)
    walls = _walls(scene, mass, load, loss)
    hold = np.diff(np.pad(load[:, 1:-1], ((0, 0), (1, 1))), axis=1)
    for wall in walls:
        hold[:, wall.bead] += wall.side * load[:, wall.bead + (wall.side > 0.0)]
    moved = _moved(scene, unit)
    if falls(scene):
        hold = hold + mass * scene.gravity.acceleration * unit.time**2 / unit.length
    start = np.zeros((scene.chains, scene.beads))
    for chain, bead, velocity in kicks(scene):
        start[chain - 1, bead - 1] = velocity / unit.velocity
    for one in moved:
        start[one.chain, one.bead] = one.velocity(0.0)
    ground, soft = (np.zeros_like(mass), np.zeros_like(mass)), scene.foundation
    stiffness, bends = None, ()
    if soft is not None:
        there, c = _within(soft.rows, scene), np.reshape(np.broadcast_to(soft.cubic, scene.chains), (-1, 1))
        k, stiffness, bends = _bedded(scene, there / unit.stiffness)
        ground = (k, c * unit.length**2 / unit.stiffness * there)
    damping, dashpot = scene.damping, unit.force / unit.velocity
    rest = 0.0 * strength if scene.periodic else (load[:, 1:-1] / strength) ** (1.0 / powers)
    quiet = _quiet_ends(scene, mass, powers * strength * rest ** (powers - 1.0))
    own = Nature(
        exponent=powers,
        gap=gaps(scene) / unit.length,
        wall_gap=scene.gap / unit.length if isinstance(scene.gap, float) else 0.0,
        mass=mass,
        strength=strength,
        rest=rest,
        hold=hold,
        springs=springs(scene),
        ground=ground,
        walls=walls,
        loss=loss,
        cut=damping is not None and damping.tension == "cut",
        drag=quiet + ((damping.beads or 0.0) / dashpot if damping is not None else 0.0),
        drag_across=(damping.coupling or 0.0) / dashpot if damping is not None else 0.0,
        pushes=_pushes(scene, unit),
        moved=moved,
        start=start,
        bed=1.0 if soft is None else _within(soft.rows, scene) + np.zeros_like(mass),
        stiffness=stiffness,
        bends=bends,
        closed=bool(scene.periodic),
        formulas={key: law.scaled(unit) for key, law in laws.items() if law is not None},
    )
    own = own if scene.resonators is None else _with_resonators(scene, own)
    state = np.zeros((2, *own.mass.shape))
    for line, bead, x, v in initial_rows(scene):
        state[:, line - 1, bead - 1] = x / unit.length, v / unit.velocity
    return replace(own, displaced=state[0], start=own.start + state[1])


def _resonators(scene: Scene) -> list[tuple[Floats, Floats, Floats]]:
    """Mass, stiffness and dashpot of each kind, [chain, bead]; 0 where there is none."""
    unit, found = units(scene), []
    for kind in scene.resonators or ():
        numbers = kind.mass, kind.stiffness, kind.damping
        mass, k, c = (np.reshape(np.broadcast_to(value, scene.chains), (-1, 1)) for value in numbers)
        there = (mass > 0.0) * _within(kind.rows, scene)
        found.append((mass / unit.mass * there, k / unit.stiffness * there, c * unit.velocity / unit.force * there))
    return found


def _with_resonators(scene: Scene, own: Nature) -> Nature:
    """Lines of masses after the chains, as many for each kind of resonator as there are chains."""
    chains = scene.chains
    masses, inner = [own.mass], []
    for number, (mass, spring, dashpot) in enumerate(_resonators(scene), 1):
        masses.append(np.where(mass > 0.0, mass, 1.0))
        inner += [(j, number * chains + j, spring[j], dashpot[j]) for j in range(chains)]
    more = [[0, chains * len(scene.resonators)], [0, 0]]
    wide = {name: np.pad(getattr(own, name), more) for name in ("strength", "rest", "hold", "start")}
    if np.ndim(own.gap):
        wide["gap"] = np.pad(own.gap, more)
    coefficient, power = own.loss
    over_time = own.stiffness and (lambda time: np.pad(own.stiffness(time), more))
    return replace(
        own,
        mass=np.concatenate(masses),
        **wide,
        bed=np.pad(own.bed, more) if np.ndim(own.bed) else own.bed,
        stiffness=over_time,
        ground=tuple(np.pad(part, more) for part in own.ground),
        walls=[
            replace(wall, **{n: np.pad(getattr(wall, n), more[0]) for n in ("strength", "rest", "loss")})
            for wall in own.walls
        ],
        loss=(np.pad(np.broadcast_to(coefficient, own.strength.shape), more), power),
        drag=np.pad(np.full_like(own.mass, own.drag), more),
        inner=tuple(inner),
    )


def _bedded(scene: Scene, there: Floats) -> tuple[Floats, Any, tuple[float, ...]]:
    """Stiffness of the foundation at the start; over time, where it depends on it; and when it does so abruptly."""
    soft, second, row = scene.foundation, units(scene).time, np.arange(1, scene.beads + 1)
    chains = soft.stiffness if isinstance(soft.stiffness, tuple) else (soft.stiffness,) * scene.chains
    ramps = [one for one in chains if getattr(one, "times", None)]

    def at(time: float) -> Any:
        found, wave = np.zeros((scene.chains, scene.beads)), soft.modulation
        for chain, one in enumerate(chains):
            if isinstance(one, float):
                found[chain] = one
                continue
            first, last = one.rows or (end / second for end in one.times)
            share = np.clip(((row if one.rows else time) - first) / (last - first), 0.0, 1.0)
            found[chain] = getattr(one, "from") + (one.to - getattr(one, "from")) * share
        if wave is not None:
            angle = 2.0 * math.pi * wave.frequency * second * time + math.radians(wave.phase)
            found *= 1.0 + wave.depth * math.sin(angle)
        return found * there

    bends = tuple(end / second for one in ramps for end in one.times)
    return at(0.0), at if ramps or soft.modulation else None, bends
