"""Random scenes of all ingredients, alone and together; not every one is accepted."""

import random
from typing import Any

from lammps_inputs import Coupling, Kick, Material, Output, Scene


def draw(chance: random.Random, number: int | str) -> Scene:
    """A scene; not every one is accepted.

    Raises:
        ValueError: this one is not.
    """
    if (which := chance.random()) < 0.4:
        return _draw_more(chance, number) if which < 0.25 else _draw_lossy(chance, number)
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
        snapshots=10.0 * unit.time if some else None,
        peaks=True if not windowed and chance.random() < 0.4 else None,
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
        more |= chance.choice([{}, {"taper": 0.03}])
    if which == "push":
        place = {"chain": chance.randint(1, chains), "bead": chance.randint(1, beads)}
        shape = chance.choice(["half-sine", "rectangular"])
        more["push"] = {**place, "peak": chance.uniform(0.1, 1.0), "duration": chance.uniform(0.5, 5.0), "shape": shape}
    places = {(chance.randint(1, chains), chance.randint(1, beads)) for _ in range(chance.randint(1, 3))}
    kicks = [{"chain": c, "bead": b, "velocity": 1.0 if k == 0 else 0.4} for k, (c, b) in enumerate(sorted(places))]
    output: dict[str, Any] = {"every": 0.5}
    if chance.random() < 0.3:
        output |= {"beads": sorted(chance.sample(range(1, beads + 1), 2)), "peaks": True, "snapshots": 10.0}
    more |= {"gap": chance.choice([0.0, 0.0, chance.uniform(0.1, 3.0)]), "duration": chance.uniform(15.0, 60.0)}
    more |= {"scheme": chance.choice([None, None, "suzuki4"]), "output": output, "kick": kicks}
    return Scene.model_validate({"name": f"scene-{number}", "chains": chains, "beads": beads, **more})


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
        laws = ["linear", "viscoelastic"] + ["restitution"] * (exponent == 1.5)
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
    if "drive" not in more or chance.random() < 0.5:
        more["kick"] = {"chain": other[0], "bead": other[1], "velocity": chance.choice([1.0, -1.0, 0.3])}
    return Scene.model_validate({"name": f"scene-{number}", "chains": chains, "beads": beads, **more})


# --- chains in which pulses come about --------------------------------------------------------------------------------


def draw_any(chance: random.Random, number: int | str) -> Scene:
    """A scene of any kind; not every one is accepted.

    Raises:
        ValueError: this one is not.
    """
    return draw(chance, number) if chance.random() < 0.5 else draw_long(chance, number)


STEEL = {"radius": 4.76e-3, "density": 8000.0, "youngs_modulus": 193e9, "poisson_ratio": 0.3}


def draw_long(chance: random.Random, number: int | str) -> Scene:
    """A scene of enough beads for pulses, in which a few ingredients meet, with gauges and spectra."""
    chains, beads = chance.choice([1, 1, 2, 2, 3, 4]), chance.randint(25, 110)
    beads = min(beads, 220 // chains)
    more: dict[str, Any] = {}
    for add in chance.sample(_PARTS, chance.choice([0, 1, 1, 2, 2, 3])):
        more |= add(chance, chains, beads, more)
    if chains > 1 and "coupling" not in more and chance.random() < 0.9:
        more["coupling"] = {"stiffness": 10.0 ** chance.uniform(-2.5, 0.0)}
    if not {"drive", "striker", "push"} & more.keys() or chance.random() < 0.2:
        more["kick"] = _kicks(chance, chains, beads)
    more["duration"] = chance.uniform(0.7, 1.8) * 1.3 * beads
    more["output"] = _output(chance, beads, more)
    if chance.random() < 0.1:
        more["scheme"] = "suzuki4"
    scene = {"name": f"scene-{number}", "chains": chains, "beads": beads, **more}
    return Scene.model_validate(_in_si(scene) if chance.random() < 0.2 else scene)


def _kicks(chance: random.Random, chains: int, beads: int) -> list[dict[str, Any]]:
    kind = chance.random()
    if kind < 0.6:
        return [{"chain": chance.randint(1, chains), "bead": 1, "velocity": 1.0}]
    if kind < 0.7:  # towards lower numbers
        return [{"chain": chance.randint(1, chains), "bead": beads, "velocity": -1.0}]
    if kind < 0.85:  # a train
        return [{"chain": 1, "bead": bead, "velocity": 1.0} for bead in range(1, chance.randint(2, 4) + 1)]
    places = {(chance.randint(1, chains), chance.randint(1, beads)) for _ in range(2)}
    return [{"chain": c, "bead": b, "velocity": chance.choice([1.0, -1.0, 0.4])} for c, b in sorted(places)]


def _output(chance: random.Random, beads: int, more: dict[str, Any]) -> dict[str, Any]:
    output: dict[str, Any] = {"every": chance.choice([0.1, 0.1, 0.2, 0.25, 0.5])}
    if chance.random() < 0.6:
        inner = sorted(chance.sample(range(2, beads), 2))
        output["forces"] = {"contacts": inner} | ({"wall": True} if "walls" in more else {})
        output["forces"] |= {"sensors": inner[:1]} if chance.random() < 0.5 else {}
    if "drive" in more or chance.random() < 0.2:
        output["spectra"] = {"beads": sorted({1, *chance.sample(range(2, beads + 1), 2)})}
    elif "forces" not in output and chance.random() < 0.25:
        output |= {"beads": sorted(chance.sample(range(1, beads + 1), beads // 3)), "snapshots": 10 * output["every"]}
        output |= chance.choice([{}, {"peaks": True}])
    return output


def _coupling(chance: random.Random, chains: int, beads: int, _: Any) -> dict[str, Any]:
    stiffness = 10.0 ** chance.uniform(-2.0, 0.0)
    first = chance.randint(1, beads // 2)
    kinds: list[dict[str, Any]] = [
        {"stiffness": stiffness, "topology": "ring"},
        {"stiffness": stiffness, "rows": [first, beads]},
        {"stiffness": {"from": 0.0, "to": stiffness, "rows": [first, beads]}},
        {"stiffness": stiffness, "cubic": 0.1},
        {"topology": {"edges": [[1, chains, stiffness]]}},
    ]
    if chains == 4:
        kinds.append({"stiffness": stiffness, "topology": {"lattice": [2, 2]}})
    return {"coupling": chance.choice(kinds)} if chains > 1 else {}


def _walls(chance: random.Random, *_: Any) -> dict[str, Any]:
    faces = ["bead", "flat", "rigid", {"stiffness": chance.uniform(0.2, 20.0)}]
    return {"walls": {"right": chance.choice(faces)} | chance.choice([{}, {"left": chance.choice(faces)}])}


def _beads(chance: random.Random, chains: int, beads: int, _: Any) -> dict[str, Any]:
    kinds = {name: {"mass": chance.uniform(0.3, 3.0), "radius": chance.uniform(0.6, 1.5)} for name in "ab"}
    one = {"kinds": {"a": kinds["a"]}, "replace": {"chain": 1, "bead": beads // 2, "kind": "a"}}
    ways: list[dict[str, Any]] = [
        {"kinds": kinds, "pattern": ["a", "b"]},
        {"kinds": {"a": {"mass": 1.0}, "b": {"mass": chance.uniform(0.2, 0.6)}}, "pattern": ["a", "b"]},
        one,
        {"taper": chance.uniform(0.0, 0.02)},
        {"disorder": {"mass": chance.uniform(0.0, 0.2), "seed": chance.randint(1, 99)}},
        {"disorder": {"radius": 0.05, "stiffness": 0.1, "seed": chance.randint(1, 99)}},
    ]
    if chains == 2:
        ways.append({"kinds": {"a": {"mass": 1.0}, "b": {"mass": 1.3}}, "pattern": [["a"], ["b"]]})
    return chance.choice(ways)


def _striker(chance: random.Random, *_: Any) -> dict[str, Any]:
    return {"striker": {"mass": chance.uniform(0.3, 5.0), "velocity": 1.0}}


def _push(chance: random.Random, chains: int, *_: Any) -> dict[str, Any]:
    peak, lasts = chance.uniform(0.2, 1.5), chance.uniform(0.5, 8.0)
    table = [[0.0, 0.0], [0.3 * lasts, peak], [0.6 * lasts, 0.4 * peak], [lasts, 0.0]]
    shapes = [{"peak": peak, "duration": lasts, "shape": shape} for shape in ("half-sine", "rectangular")]
    return {"push": {"chain": chance.randint(1, chains), "bead": 1} | chance.choice([*shapes, {"table": table}])}


def _drive(chance: random.Random, chains: int, *_: Any) -> dict[str, Any]:
    how = chance.choice([{"displacement": chance.uniform(0.1, 1.0)}, {"force": chance.uniform(0.1, 1.0)}])
    more = {"frequency": chance.uniform(0.03, 0.3), "phase": chance.choice([0.0, -90.0, 37.0])}
    return {"drive": {"chain": chance.randint(1, chains), "bead": 1, **how, **more}}


def _foundation(chance: random.Random, chains: int, beads: int, _: Any) -> dict[str, Any]:
    stiffness: Any = 10.0 ** chance.uniform(-2.0, 0.3)
    several = [stiffness] * (chains - 1) + [0.5 * stiffness]
    ways = [
        {"stiffness": stiffness},
        {"stiffness": several},
        {"cubic": 0.1, "stiffness": stiffness, "rows": [5, beads]},
    ]
    return {"foundation": chance.choice(ways)}


def _damping(chance: random.Random, chains: int, *_: Any) -> dict[str, Any]:
    size = 10.0 ** chance.uniform(-3.0, -0.5)
    ways: list[dict[str, Any]] = [
        {"contact": size},
        {"contact": size, "tension": "cut"},
        {"contact": size, "law": "viscoelastic"},
        {"contact": chance.uniform(0.5, 0.99), "law": "restitution"},
        {"beads": 0.1 * size},
    ]
    if chains > 1:
        ways.append({"coupling": size})
    return {"damping": chance.choice(ways)}


def _load(chance: random.Random, chains: int, beads: int, more: Any) -> dict[str, Any]:  # noqa: ARG001
    if chance.random() < 0.7:
        return {"precompression": {"force": 10.0 ** chance.uniform(-2.0, 1.0)}}
    return {"gravity": 10.0 ** chance.uniform(-3.0, -1.0), **({} if "walls" in more else {"walls": {"right": "flat"}})}


def _contact(chance: random.Random, _chains: int, beads: int, _: Any) -> dict[str, Any]:
    ways: list[dict[str, Any]] = [{"exponent": p} for p in (1.0, 1.25, 2.0, 3.0)]
    ways += [
        {"strength": {"from": 1.0, "to": 3.0, "contacts": [2, beads - 1]}},
        {"strength": {"amplitude": 0.3, "wavenumber": 0.618, "phase": 70.0}},
        {"strength": {"spread": 0.2, "seed": 5}},
        {"exponent": 1.0, "strength": {"from": 1.0, "to": 0.5, "contacts": [1, 6], "spread": 0.1}},
    ]
    return {"contact": chance.choice(ways)}


def _gap(chance: random.Random, *_: Any) -> dict[str, Any]:
    return {"gap": chance.uniform(0.1, 2.0)}


_PARTS = [_coupling, _walls, _beads, _striker, _push, _drive, _foundation, _damping, _load, _contact, _gap]


def _in_si(scene: dict[str, Any]) -> dict[str, Any]:
    """The same of steel balls, kicked at 1 m/s; what has other units is left out."""
    mass, time, length, force = 0.003614, 1.2233e-5, 1.2233e-5, 295.4
    if scene.keys() & {"striker", "push", "drive", "contact", "damping", "taper", "disorder", "kinds"}:
        raise ValueError("only in reduced units")
    found = {**scene, "material": STEEL, "duration": scene["duration"] * time}
    found["output"] = {**scene["output"], "every": scene["output"]["every"] * time}
    if "snapshots" in scene["output"]:
        found["output"]["snapshots"] = 10 * found["output"]["every"]
    if "gap" in scene:
        found["gap"] = scene["gap"] * length
    if "precompression" in scene:
        found["precompression"] = {"force": scene["precompression"]["force"] * force}
    if "gravity" in scene:
        found["gravity"] = scene["gravity"] * length / time**2
    stiff = mass / time**2
    for key in scene.keys() & {"coupling", "foundation"}:
        if scene[key].keys() - {"stiffness", "rows"} or not isinstance(scene[key]["stiffness"], float):
            raise ValueError("only in reduced units")
        found[key] = {**scene[key], "stiffness": scene[key]["stiffness"] * stiff}
    if any(isinstance(face, dict) for face in scene.get("walls", {}).values()):
        raise ValueError("only in reduced units")
    return found
