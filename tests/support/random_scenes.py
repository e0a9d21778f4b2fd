"""Random scenes of all ingredients, alone and together; not every one is accepted."""

import random
from typing import Any

from lammps_inputs import Kick, Material, Output, Scene
from lammps_inputs.formulas import expression
from lammps_inputs.ingredients.coupling import Coupling


def draw(chance: random.Random, number: int | str) -> Scene:
    """A scene; not every one is accepted.

    Raises:
        ValueError: this one is not.
    """
    which = chance.random()
    if which < 0.4:
        return _draw_more(chance, number) if which < 0.25 else _draw_lossy(chance, number)
    if 0.5 < which < 0.9:
        return draw_of_springs(chance, number) if which < 0.8 else draw_at_start(chance, number)
    windowed = chance.random() < 0.1
    chains = chance.choice([1, 2, 2, 3])
    beads = chance.randint(90, 130) if windowed else chance.randint(2, 12)
    signs = [1.0] if windowed else [1.0, 1.0, -1.0]
    places = {(chance.randint(1, chains), chance.randint(1, min(beads, 20))) for _ in range(chance.randint(1, 4))}
    kicks = [(c, b, chance.choice(signs) * chance.choice([1.0, 0.5, 0.2, chance.random() + 0.01])) for c, b in places]
    material, speed = None, chance.choice([1.0, 1.0, 1e-3, 40.0])
    if chance.random() < 0.2:
        material = Material(radius=4.76e-3, density=8000.0, youngs_modulus=193e9, poisson_ratio=0.3)
    hit = tuple(Kick(chain=c, bead=b, velocity=speed * v) for c, b, v in kicks)
    unit = Scene(name="unit", chains=chains, beads=beads, kick=hit, material=material, until_bead=1).scale
    kappa = chance.choice([0.0, 10.0 ** chance.uniform(-3.0, 0.3)]) if chains > 1 else 0.0
    gap = chance.choice([0.0, 0.0, chance.uniform(0.1, 3.0), chance.uniform(3.0, 15.0)])
    gap = min(gap, 1.0) if windowed else gap
    duration = chance.uniform(90.0, 140.0) if windowed else chance.uniform(15.0, 80.0)
    every = 0.5
    some = not windowed and chance.random() < 0.3
    output = Output(
        every=every * unit.time,
        beads=tuple(sorted(chance.sample(range(1, beads + 1), min(2, beads)))) if some else "all",
    )
    return Scene(
        name=f"scene-{number}",
        chains=chains,
        beads=beads,
        gap=gap * unit.length,
        coupling=Coupling(stiffness=kappa * unit.stiffness) if kappa else None,
        kick=hit,
        material=material,
        duration=duration * unit.time,
        scheme=chance.choice([None, "suzuki4"]),
        window=64 if windowed else None,
        output=output,
    )


def _draw_more(chance: random.Random, number: int | str) -> Scene:
    """A scene with one ingredient more, in reduced units, kicked one way with V = 1."""
    chains, beads = chance.choice([1, 2, 3]), chance.randint(3, 12)
    more: dict[str, Any] = {}
    which = chance.choice(["foundation", "walls", "unequal", "coupling", "push"])
    if which == "coupling":
        chains = 3
        more["coupling"] = {"stiffness": 10.0 ** chance.uniform(-3.0, 0.3), "topology": "ring"}
        first = chance.randint(1, beads)
        more["coupling"] |= chance.choice([{}, {"rows": [first, chance.randint(first, beads)]}, {"cubic": 0.1}])
    elif chains > 1:
        more["coupling"] = {"stiffness": 10.0 ** chance.uniform(-3.0, 0.3)}
    if which == "foundation":
        more["foundation"] = {"stiffness": 10.0 ** chance.uniform(-2.0, 0.3)} | chance.choice([{}, {"cubic": 0.1}])
        more["foundation"] |= chance.choice([{}, {"rows": [2, beads]}])
    if which == "walls":
        faces = ["bead", "flat", "rigid"]
        more["walls"] = {"left": chance.choice(faces), "right": chance.choice(faces)}
    if which == "unequal":
        more["kinds"] = {name: {"mass": chance.uniform(0.3, 3.0), "radius": chance.uniform(0.5, 1.5)} for name in "ab"}
        more["pattern"] = chance.choice([["a", "b"], ["a", "a", "b"]])
        more["pattern"] = _Along(number).repeated(more["pattern"])
        more |= chance.choice([{}, {"taper": 0.03}])
    if which == "push":
        place = {"chain": chance.randint(1, chains), "bead": chance.randint(1, beads)}
        shape = chance.choice(["half-sine", "rectangular"])
        more["push"] = {**place, "peak": chance.uniform(0.1, 1.0), "duration": chance.uniform(0.5, 5.0), "shape": shape}
    places = {(chance.randint(1, chains), chance.randint(1, beads)) for _ in range(chance.randint(1, 3))}
    kicks = [{"chain": c, "bead": b, "velocity": 1.0 if k == 0 else 0.4} for k, (c, b) in enumerate(sorted(places))]
    output: dict[str, Any] = {"every": 0.5}
    if chance.random() < 0.3:
        output |= {"beads": sorted(chance.sample(range(1, beads + 1), 2))}
    more |= {"gap": chance.choice([0.0, 0.0, chance.uniform(0.1, 3.0)]), "duration": chance.uniform(15.0, 60.0)}
    along = _Along(number)  # leaves all else as it was drawn
    more |= {"gap": along.gaps(beads)} if more["gap"] and along.random() < 0.4 else {}
    if "walls" in more and along.random() < 0.3:
        more["walls"]["right"] = {"damping": 10.0 ** along.uniform(-1.0, 0.5)}
    more |= {"scheme": chance.choice([None, None, "suzuki4"]), "output": output, "kick": kicks}
    return _scene(number, chains, beads, more)


def _draw_lossy(chance: random.Random, number: int | str) -> Scene:
    """A scene of contacts of any exponent, losses, static loads and drives, each as likely as not."""
    chains, beads = chance.choice([1, 1, 2]), chance.randint(3, 12)
    more: dict[str, Any] = {"duration": chance.uniform(10.0, 40.0), "output": {"every": 0.5}}
    exponent = chance.choice([1.5, 1.5, 1.0, 1.25, 2.0, 3.0])
    if exponent != 1.5:
        more["contact"] = {"exponent": exponent}
    if chains > 1:
        more["coupling"] = {"stiffness": 10.0 ** chance.uniform(-3.0, 0.3)}
    if chance.random() < 0.3:
        more["foundation"] = {"stiffness": 10.0 ** chance.uniform(-2.0, 0.0)}
    if chance.random() < 0.4:
        faces = ["flat", "rigid"] if exponent == 1.5 else ["bead"]
        more["walls"] = {"left": chance.choice(["bead", None]), "right": chance.choice(faces)}
    if chance.random() < 0.3:  # beads that differ in mass alone, as contacts of any exponent allow
        more["kinds"] = {name: {"mass": chance.uniform(0.3, 3.0), "radius": 1.0} for name in "ab"}
        more["pattern"] = ["a", "b"]
    if chance.random() < 0.5:
        laws = ["linear", "viscoelastic", "restitution"]
        damping = {"contact": 10.0 ** chance.uniform(-3.0, 0.0), "law": chance.choice(laws)}
        if damping["law"] == "restitution":
            damping["contact"] = chance.uniform(0.2, 0.99)
        more["damping"] = damping
    if chance.random() < 0.4:
        more.setdefault("damping", {})["beads"] = 10.0 ** chance.uniform(-3.0, 0.0)
    if chains > 1 and chance.random() < 0.3:
        more.setdefault("damping", {})["coupling"] = 10.0 ** chance.uniform(-3.0, 0.0)
    if chance.random() < 0.4:
        size = 10.0 ** chance.uniform(-3.0, 1.0)
        more |= (
            {"gravity": 0.1 * size}
            if "walls" in more and chance.random() < 0.5
            else {"precompression": {"force": size}}
        )
    places = [(chain, bead) for chain in range(1, chains + 1) for bead in range(1, beads + 1)]
    (chain, bead), other = chance.sample(places, 2)
    if chance.random() < 0.4:
        how = (
            {"displacement": chance.uniform(0.1, 1.0)} if chance.random() < 0.5 else {"force": chance.uniform(0.1, 1.0)}
        )
        frequency, phase = chance.uniform(0.02, 0.3), chance.choice([0.0, 90.0, -90.0, 37.0])
        more["drive"] = {"chain": chain, "bead": bead, **how, "frequency": frequency, "phase": phase}
    elif chance.random() < 0.4:
        of_bead = [{"chain": chain, "bead": bead, **_prescribed(chance)} for _ in range(chance.randint(1, 3))]
        more["drive"] = of_bead
    if "drive" not in more or chance.random() < 0.5:
        more["kick"] = {"chain": other[0], "bead": other[1], "velocity": chance.choice([1.0, -1.0, 0.3])}
    along = _Along(number)  # leaves all else as it was drawn
    if "contact" not in more and along.random() < 0.5:
        one = (
            more.keys() & {"walls", "gravity", "precompression"}
            or more.get("damping", {}).get("law", "linear") != "linear"
        )
        more["contact"] = {"strength" if one else "exponent": along.profile()}
    if along.random() < 0.3:
        more["initial"] = _initial(along, chains, beads)
    if "precompression" in more and "exponent" not in more.get("contact", {}) and along.random() < 0.3:
        more["walls"] = {**more.get("walls", {}), "left": "matched"}
        more.pop("foundation", None)
    brief = _Along(f"brief {number}")
    if brief.random() < 0.5 and "kinds" not in more and "strength" not in more.get("contact", {}):
        more |= {"precompression": {"overlap": more["precompression"]["force"]}} if "precompression" in more else {}
    if brief.random() < 0.25 and isinstance(more.get("contact", {}).get("exponent", 1.5), float):
        more["mass"] = brief.uniform(0.5, 2.0)
        more["contact"] = {**more.get("contact", {}), "stiffness": brief.uniform(0.5, 2.0)}
    return _scene(number, chains, beads, more)


def _scene(number: int | str, chains: int, beads: int, more: dict[str, Any]) -> Scene:
    """The scene, of chains with ends or, of some that need none, of rings."""
    around = _Along(f"around {number}")  # leaves all else as it was drawn
    ends = more.keys() & {"walls", "precompression", "gravity"} or isinstance(more.get("gap"), list)
    if beads > 2 and not ends and around.random() < 0.3:
        more["periodic"] = True
        if more.get("gap") and around.random() < 0.5:
            more["gap"] = {"contacts": {str(beads): around.uniform(0.1, 1.0)}}
    return Scene.model_validate({"name": f"scene-{number}", "chains": chains, "beads": beads, **more})


class _Along(random.Random):
    """Random values along the chains, with numbers of their own for each scene."""

    def __init__(self, number: int | str) -> None:
        super().__init__(f"along {number}")

    def repeated(self, pattern: list[str]) -> list[str]:
        """A pattern, or one with counts."""
        return [f"{self.randint(1, 3)}*{name}" for name in pattern] if self.random() < 0.3 else pattern

    def gaps(self, beads: int) -> Any:
        """Gaps that differ: a list, or by numbers of contacts."""
        listed = [self.choice([0.0, self.uniform(0.1, 2.0)]) for _ in range(beads - 1)]
        named = {"contacts": {str(self.randint(1, beads - 1)): 0.5}}
        return self.choice([listed, named, {"mean": self.uniform(0.1, 2.0), "spread": 0.5}])

    def profile(self) -> dict[str, Any]:
        """Random factors on strengths or exponents."""
        return {"spread": self.uniform(0.01, 0.3), "seed": self.randint(0, 9)}


def _prescribed(chance: random.Random) -> dict[str, Any]:
    """A motion of a bead: harmonic, of constant velocity, or from a table."""
    kind = chance.choice(["harmonic", "piston", "displacement", "velocity"])
    if kind == "harmonic":
        return {"displacement": chance.uniform(0.02, 0.3), "frequency": chance.uniform(0.02, 0.3)}
    if kind == "piston":
        begin = chance.choice([None, chance.uniform(0.1, 5.0)])
        end = chance.choice([None, chance.uniform(6.0, 9.0)])
        return {"velocity": chance.choice([-1.0, 1.0]) * chance.uniform(0.05, 0.5), "from": begin, "until": end}
    times = sorted(chance.uniform(0.0, 12.0) for _ in range(chance.randint(2, 6)))
    first = 0.0 if kind == "displacement" else chance.uniform(-0.3, 0.3)
    table = [[time, chance.uniform(-0.3, 0.3) if k else first] for k, time in enumerate(times)]
    return {"quantity": kind, "table": table}


def draw_at_start(chance: random.Random, number: int | str) -> Scene:
    """A scene whose beads are displaced at the start, fall, or both."""
    chains, beads = chance.choice([1, 1, 2]), chance.randint(2, 10)
    more: dict[str, Any] = {"duration": chance.uniform(10.0, 30.0), "output": {"every": 0.5}}
    more["gap"] = chance.choice([0.0, 0.0, chance.uniform(0.05, 2.0)])
    if chains > 1:
        more["coupling"] = {"stiffness": 10.0 ** chance.uniform(-2.0, 0.0)}
    if chance.random() < 0.6:
        more["walls"] = {"left": chance.choice(["bead", None]), "right": chance.choice(["flat", "rigid"])}
    if chance.random() < 0.3:
        more["kinds"] = {name: {"mass": chance.uniform(0.3, 3.0), "radius": 1.0} for name in "ab"}
        more["pattern"] = ["a", "b"]
    falls = chance.random() < 0.5
    if falls:
        more["gravity"] = {"acceleration": 10.0 ** chance.uniform(-3.0, -0.5), "settled": False}
    elif chance.random() < 0.5:
        more["foundation"] = {"stiffness": 10.0 ** chance.uniform(-2.0, 0.0)}
    if not falls or chance.random() < 0.4:
        more["initial"] = _initial(chance, chains, beads)
    if chance.random() < 0.3:
        place = {"chain": chance.randint(1, chains), "bead": chance.randint(1, beads)}
        more["kick"] = {**place, "velocity": chance.choice([1.0, -1.0, 0.3])}
    if chance.random() < 0.3:
        more["damping"] = {"contact": 10.0 ** chance.uniform(-3.0, -0.5), "law": "viscoelastic"}
    if chance.random() < 0.3:
        more.setdefault("damping", {})["beads"] = 10.0 ** chance.uniform(-3.0, -0.5)
    return _scene(number, chains, beads, more)


def _initial(chance: random.Random, chains: int, beads: int) -> Any:
    """Displacements and velocities of a few beads, in a list or a table."""
    places = [(chain, bead) for chain in range(1, chains + 1) for bead in range(1, beads + 1)]
    rows = [
        [*place, chance.choice([0.0, chance.uniform(-0.5, 0.5)]), chance.choice([0.0, chance.uniform(-1.0, 1.0)])]
        for place in chance.sample(places, chance.randint(1, min(4, len(places))))
    ]
    if chance.random() < 0.5:
        return {"table": rows}
    keys = ("chain", "bead", "displacement", "velocity")
    return [dict(zip(keys, row, strict=True)) for row in rows if row[2] or row[3]] or None


FORMULAS_OF_SPRINGS = ("k*s/sqrt(1+(s/d)^2)", "k*s+c*s^3", "k*s*exp(-(s/d)^2)", "k*d*tanh(s/d)", "k*d*sinh(s/d)", "k*s")
"""Odd forces, as springs between chains have."""

FORMULAS_OF_FOUNDATIONS = (*FORMULAS_OF_SPRINGS, "k*d*sin(s/d)", "k*d*(exp(s/d)-1)", "k*s/(1-(s/d)^2)", "k*s+c*s^3+f")
"""Forces to the ground; the last is 0 at rest where f is."""

FORMULAS_OF_CONTACTS = (
    "A*s^p",
    "A*s^1.5*(1+b*s)",
    "A*(s^1.5+b*s^2.5)",
    "A*(exp(b*s)-1)",
    "A/(d+s)^p",
    "A/(d-s)^2-A/d^2",
)
"""Forces of contacts that touch, and of magnets."""


def draw_of_springs(chance: random.Random, number: int | str) -> Scene:
    """A scene of resonators, foundations in space and time, and forces by formula, each as likely as not."""
    chains, beads = chance.choice([1, 2, 2, 3]), chance.randint(2, 10)
    more: dict[str, Any] = {"duration": chance.uniform(4.0, 16.0), "output": {"every": 0.5}}
    if chance.random() < 0.5:
        more["resonators"] = _resonators(chance, chains, beads)
    if chance.random() < 0.6:
        more["foundation"] = _foundation(chance, chains, beads, more["duration"])
    if chains > 1:
        springs = {"stiffness": 10.0 ** chance.uniform(-3.0, 0.3)}
        more["coupling"] = _by_formula(chance, FORMULAS_OF_SPRINGS) if chance.random() < 0.3 else springs
    if chance.random() < 0.3:
        more["contact"] = _by_formula(chance, FORMULAS_OF_CONTACTS)
    if chance.random() < 0.4 or "/" in more.get("contact", {}).get("force", ""):
        more["walls"] = {"left": "bead", "right": "bead"}
    if chance.random() < 0.2:
        more["damping"] = {"contact": 10.0 ** chance.uniform(-3.0, -0.5)}
    if chance.random() < 0.2:
        more.setdefault("damping", {})["beads"] = 10.0 ** chance.uniform(-3.0, -0.5)
    more |= chance.choice([{}, {}, {"gap": chance.uniform(0.05, 1.0)}, {"precompression": {"force": 0.3}}])
    place = {"chain": chance.randint(1, chains), "bead": chance.randint(1, beads)}
    if chance.random() < 0.2:
        drive = {"displacement": chance.uniform(0.1, 1.0)}
        more["drive"] = {**place, **drive, "frequency": chance.uniform(0.02, 0.3), "phase": -90.0}
    else:
        more["kick"] = {**place, "velocity": chance.choice([1.0, -1.0, 0.3, 3.0])}
    return _scene(number, chains, beads, more)


def _rows(chance: random.Random, beads: int) -> list[int]:
    first = chance.randint(1, beads)
    return [first, chance.randint(first, beads)]


def _for_chains(chance: random.Random, chains: int, draw_one: Any) -> Any:
    """One value, or a list with one for each chain."""
    return draw_one() if chains == 1 or chance.random() < 0.6 else [draw_one() for _ in range(chains)]


def _resonators(chance: random.Random, chains: int, beads: int) -> Any:
    kinds = []
    for _ in range(chance.choice([1, 1, 1, 2, 3])):
        keys = {
            "mass": _for_chains(chance, chains, lambda: 10.0 ** chance.uniform(-1.5, 0.5)),
            "stiffness": _for_chains(chance, chains, lambda: 10.0 ** chance.uniform(-1.5, 0.5)),
        }
        keys |= {"damping": 10.0 ** chance.uniform(-3.0, -0.5)} if chance.random() < 0.3 else {}
        kinds.append(keys | ({"rows": _rows(chance, beads)} if chance.random() < 0.4 else {}))
    return kinds[0] if len(kinds) == 1 else kinds


def _foundation(chance: random.Random, chains: int, beads: int, duration: float) -> dict[str, Any]:
    if chance.random() < 0.3:
        keys = _by_formula(chance, FORMULAS_OF_FOUNDATIONS)
        return keys | ({"rows": _rows(chance, beads)} if chance.random() < 0.3 else {})

    def level() -> float:
        return chance.choice([0.0, 1e-9, round(chance.uniform(0.01, 1.0), 2)])

    def stiffness() -> Any:
        ramp = {"from": level(), "to": level()}
        begin = chance.choice([0.0, -2.0, round(chance.uniform(0.0, 0.6 * duration), 1)])
        times = [begin, begin + chance.choice([0.01, 3.0, round(chance.uniform(0.1, duration), 1)])]
        rows = sorted(chance.sample(range(1, beads + 1), 2))
        return chance.choice([level(), {**ramp, "rows": rows}, {**ramp, "times": times}, {**ramp, "times": times}])

    keys: dict[str, Any] = {"stiffness": _for_chains(chance, chains, stiffness)}
    if chance.random() < 0.3:
        wave = {"depth": chance.choice([1.0, -1.0, 0.5]), "frequency": round(chance.uniform(0.02, 0.5), 3)}
        keys["modulation"] = wave | {"phase": chance.choice([0.0, 90.0, -37.0])}
    keys |= {"cubic": 0.1} if chance.random() < 0.2 else {}
    return keys | ({"rows": _rows(chance, beads)} if chance.random() < 0.3 else {})


def _by_formula(chance: random.Random, formulas: tuple[str, ...]) -> dict[str, Any]:
    """A formula with numbers for its parameters; few different ones, for each is compiled."""
    force = chance.choice(formulas)
    numbers = {
        "k": chance.choice([0.05, 0.3, 1.0]),
        "c": chance.choice([0.0, 0.1, 2.0]),
        "d": chance.choice([0.5, 1.0, 4.0]),
        "f": chance.choice([0.0, 0.0, 1e-6, 0.2]),
        "A": chance.choice([0.5, 1.0, 3.0]),
        "b": chance.choice([-0.1, 0.2, 1.0]),
        "p": chance.choice([1.0, 1.3, 1.5, 2.0, 4.0]),
    }
    return {"force": force} | {name: value for name, value in numbers.items() if name in expression.names(force)}
