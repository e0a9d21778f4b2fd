"""Files and commands of studies and plug-ins with which `compare_trees.py` compares two trees.

A story runs in a directory and a process of its tree; its paths are relative, so that texts are the same in both trees.
Each is cheap: small scenes, few points, short runs.
"""

import re
from collections.abc import Iterable, Iterator, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

CHAIN: dict[str, Any] = {"name": "chain", "beads": 12, "kick": {"velocity": 1}, "duration": 12, "timestep": 0.01}
PAIR: dict[str, Any] = CHAIN | {"chains": 2, "coupling": {"stiffness": 0.1}}
STEEL = {"radius": 0.01, "density": 7780, "youngs_modulus": 2e11, "poisson_ratio": 0.3}

HELD = {"precompression": {"force": 0.125}, "walls": {"left": "bead", "right": "bead"}}
DRIVEN = {
    **HELD,
    "name": "driven",
    "beads": 2,
    "damping": {"beads": 0.1},
    "drive": {"force": 0.3, "frequency": 0.3},
    "duration": 100,
}

NATIVE = ("netcdf", "zarr", "parquet", "csv", "ovito", "vmd")
"""Formats of `export` that are no pictures."""


class Story(NamedTuple):
    """Files to write first, and commands: name -> words; a name that begins with ``python`` is a script."""

    name: str
    steps: dict[str, list[str]]
    files: Mapping[str, Any] = MappingProxyType({})


def stories(names: Iterable[str], commands: Iterable[str], manual: str, traces: str) -> Iterator[Story]:
    """All stories, for the names of installed scenes, the names of all commands, the manual and a table of traces."""
    yield from _words(names, commands, manual)
    for name in names:
        yield _decks(name)
    yield from _of_run()
    yield from _adopted()
    yield from _sweeps()
    yield from _thresholds()
    yield from _searches(traces)
    yield from _motions()
    yield from _measured_here()


def _words(names: Iterable[str], commands: Iterable[str], manual: str) -> Iterator[Story]:
    """Help, schemas, completion and lists."""
    yield Story("help-of-commands", {name: [name, "--help"] for name in commands})
    cells = re.findall(r"`([^`\n]+)`|^\| ([^|\n]+) \|", manual, re.MULTILINE)
    terms = sorted({(code or cell).strip().lstrip("-") for code, cell in cells})
    terms = [term for term in terms if re.fullmatch(r"[A-Za-z][\w.@ -]{0,38}", term)]
    yield Story("help-of-terms", {f"term {term}": ["help", *term.split()] for term in terms})
    steps = {f"schema-{kind}": ["schema", kind] for kind in ("design", "scene", "site", "sweep")}
    steps |= {f"completion-{shell}": ["completion", shell] for shell in ("bash", "zsh", "tcsh", "fish", "powershell")}
    steps |= {"scenes": ["scenes"], "scenes-json": ["scenes", "--json"], "gallery": ["gallery", "--list"]}
    yield Story("lists", steps | {"nothing": [], "wrong": ["analize"]})
    steps = {name: ["new", f"{name}.yaml", "--from", name] for name in names}
    yield Story("new", {"commented": ["new", "commented.yaml"], **steps})


def _decks(name: str) -> Story:
    """An installed scene without a run: its text, references and jobs."""
    steps = {
        "show": ["show", name],
        "values": ["show", name, "--values"],
        "json": ["show", name, "--json"],
        "cite": ["cite", name],
        "bibtex": ["cite", name, "--bibtex"],
    }
    for scheduler in ("slurm", "pbs", "sge"):
        options = ["--scheduler", scheduler, "--nodes", "2", "--ranks-per-node", "4", "--time", "02:00:00"]
        steps[scheduler] = ["deck", name, "-o", scheduler, *options]
    return Story(f"scene-{name}", steps)


def _of_run() -> Iterator[Story]:
    """Runs of small scenes with most measures, and all that follows a run."""
    recorded = {"forces": {"contacts": [3, 6], "sensors": [4], "wall": True}, "spectra": {"beads": [3, 6]}}
    scenes = {
        "pair": PAIR | {"walls": {"right": "rigid"}, "output": {"every": 0.25} | recorded},
        "steel": PAIR | {"material": STEEL, "coupling": {"stiffness": 2e7}, "duration": 4e-4, "timestep": 4e-7},
        "loaded": {**CHAIN, **HELD, "kick": {"velocity": 0.3}, "damping": {"contact": 0.05}},
        "resonators": PAIR | {"resonators": {"mass": 3, "stiffness": 0.3, "rows": [3, 9]}},
    }
    by = {"pair": "coupling.stiffness", "steel": "material.radius", "loaded": "precompression.force"}
    for name, scene in scenes.items():
        steps = {"run": ["run", "scene.yaml", "-o", "run"], "status": ["status", "run", "--json"]}
        steps["reference"] = ["run", "scene.yaml", "-o", "reference", "--engine", "reference"]
        steps["analyze"] = ["analyze", "run", "--no-figures", "--json"]
        if name in by:
            gradient = ["--gradient", "peak_velocity@6,arrival@6", "--by", by[name]]
            steps["gradient"] = ["analyze", "reference", "--no-figures", *gradient]
        steps["validate"] = ["validate", "run", "--page"]
        steps["against"] = ["validate", "run", "--against", "reference"]
        steps["export"] = ["export", "run", "--to", ",".join(NATIVE), "-o", "exported"]
        steps["view"] = ["view", "run", "--no-open"]
        steps["view-against"] = ["view", "run", "--against", "reference", "--no-open"]
        yield Story(f"run-{name}", steps, {"scene.yaml": scene})
    steps = {
        "run": ["run", "scene.yaml", "-o", "run", "--engine", "collisions"],
        "analyze": ["analyze", "run", "--no-figures"],
        "view": ["view", "run", "--no-open"],
        "export": ["export", "run", "--to", "csv", "-o", "exported"],
    }
    yield Story("run-rigid", steps, {"scene.yaml": CHAIN | {"gap": 0.5}})


def _adopted() -> Iterator[Story]:
    """Decks that the trees wrote, as decks of a user's own."""
    for name, scene in {"chain": CHAIN, "pair": PAIR, "loaded": {**CHAIN, **HELD}}.items():
        steps = {"deck": ["deck", "scene.yaml", "-o", "deck"]}
        steps["adopt"] = ["adopt", "deck/in.chains", "-o", "adopted.yaml"]
        yield Story(f"adopt-{name}", steps, {"scene.yaml": scene})


def _sweeps() -> Iterator[Story]:
    """Sweeps with both engines, their tables, pages and files."""
    vary = {"coupling.stiffness": [0.05, 0.1], "kick.velocity": {"from": 0.5, "to": 1, "count": 2}}
    for engine in ("lammps", "reference"):
        steps = {"sweep": ["sweep", "sweep.yaml", "-o", "swept", "--jobs", "1"]}
        steps["collect"] = ["collect", "swept"]
        steps["collect-again"] = ["collect", "swept", "--json"]
        steps["view"] = ["view", "swept", "--no-open"]
        steps["export"] = ["export", "swept", "--to", "csv,parquet", "-o", "exported"]
        steps["status"] = ["status", "swept"]
        yield Story(f"sweep-{engine}", steps, {"sweep.yaml": {"scene": PAIR, "vary": vary, "engine": engine}})
    words = ["--slurm", "--time", "01:00:00"]
    steps = {"job": ["sweep", "sweep.yaml", "-o", "swept", *words]}
    yield Story("sweep-job", steps, {"sweep.yaml": {"scene": PAIR, "vary": vary}})


def _thresholds() -> Iterator[Story]:
    """Thresholds of quantities that are read in two ways, and of what needs no motion."""
    rows = PAIR | {"beads": 24, "duration": 40, "resonators": {"mass": 3, "stiffness": 0.3, "rows": [10, 20]}}
    plain = PAIR | {"kinds": {"a": {"mass": 1.5}, "b": {"mass": 1}}, "pattern": ["a", "b"]}
    own = {"rows": rows, "mass": plain, "arrival": rows, "share": PAIR | {"beads": 60, "duration": 80}}
    searches = {
        "beats": ("beats-on-a-foundation", "beat_length=2.6", "kick.velocity=0.9:1.1"),
        "resonators": ("resonators", "amplitude=0.457", "kick.velocity=0.9:1.1"),
        "rows": ("scene.yaml", "beat_length=15", "kick.velocity=0.9:1.1"),
        "mass": ("scene.yaml", "mass=60", "kinds.a.mass=1:4"),
        "arrival": ("scene.yaml", "arrival@20=27", "kick.velocity=0.9:2"),
        "share": ("scene.yaml", "agree_1=50", "coupling.stiffness=0.05:0.5"),
    }
    for name, (scene, where, vary) in searches.items():
        options = ["--points", "3", "--tolerance", "0.05", "--jobs", "1"]
        words = ["threshold", scene, "--where", where, "--vary", vary, *options, "-o", "found"]
        yield Story(f"threshold-{name}", {"threshold": words}, {"scene.yaml": own[name]} if name in own else {})


def _searches(traces: str) -> Iterator[Story]:
    """Designs and fits, also as jobs."""
    design = {
        "scene": PAIR | {"walls": {"right": "rigid"}, "duration": 30},
        "vary": {"coupling.stiffness": [0.02, 0.1, 0.5], "beads": {"from": 8, "to": 10}},
        "minimize": "wall_force",
        "where": {"mass": {"from": 17}},
        "also": ["delay"],
        "manufacture": {"members": 4},
        "verify": 1,
    }
    steps = {"design": ["design", "design.yaml", "-o", "d", "--jobs", "1", "--json"]}
    steps["job"] = ["design", "design.yaml", "-o", "job", "--slurm", "--jobs", "4", "--time", "01:00:00"]
    yield Story("design", steps, {"design.yaml": design})
    search = {"evaluations": 20, "population": 8, "seed": 1}
    evolved = {"search": search, "vary": {"coupling.stiffness": {"from": 0.02, "to": 2, "spacing": "log"}}, "where": {}}
    words = ["design", "design.yaml", "-o", "d", "--jobs", "1", "--gradient"]
    yield Story("design-gradient", {"design": words}, {"design.yaml": {**design, **evolved}})
    steel = {
        "name": "steel",
        "chains": 2,
        "beads": 20,
        "coupling": {"stiffness": 2.2e6},
        "walls": {"right": "rigid"},
        "kick": {"velocity": 0.95},
        "material": {"radius": 4.76e-3, "density": 8000, "youngs_modulus": 193e9, "poisson_ratio": 0.3},
        "duration": 6e-4,
    }
    words = ["fit", "scene.yaml", "--against", "data.csv", "--free", "coupling.stiffness,kick.velocity"]
    words += ["--offset=37.3e-6", "--no-lammps", "--json"]
    steps = {"fit": [*words, "-o", "out"], "gradient": [*words, "--gradient", "-o", "by-gradient"]}
    yield Story("fit", steps, {"scene.yaml": steel, "data.csv": traces})


def _motions() -> Iterator[Story]:
    """Exponents, modes and responses."""
    kicked = {**CHAIN, **HELD, "kick": {"bead": 4, "velocity": 1}}
    words = ["lyapunov", "scene.yaml", "--exponents", "2", "--duration", "1100", "-o", "out", "--json"]
    yield Story("lyapunov", {"lyapunov": words}, {"scene.yaml": kicked})
    four = {**CHAIN, **HELD, "chains": 2, "beads": 2, "foundation": {"stiffness": 1}, "coupling": {"stiffness": 0.05}}
    options = ["--mode", "3", "--energy", "1e-2", "--points", "4"]
    steps = {"linear": ["modes", "scene.yaml", "--linear", "-o", "linear"]}
    steps["branch"] = ["modes", "scene.yaml", *options, "-o", "branch", "--json"]
    yield Story("modes", steps, {"scene.yaml": four})
    options = ["--frequencies", "0.28,0.3", "--points", "20", "--sweep", "3", "--no-lammps"]
    yield Story("responses", {"modes": ["modes", "scene.yaml", *options, "-o", "out"]}, {"scene.yaml": DRIVEN})


def _measured_here() -> Iterator[Story]:
    """Studies that measure this machine, or check every number; and functions of the module `granchain`."""
    yield Story("trade", {"trade": ["trade", "scene.yaml", "-o", "out", "--budget", "5"]}, {"scene.yaml": CHAIN})
    yield Story("extremes", {"extremes": ["extremes", "exponents", "--quick", "-o", "out"]})
    yield Story("gallery", {"gallery": ["gallery", "kicked-chain", "tapered", "-o", "out", "--json"]})
    yield Story("functions", {"python": [FUNCTIONS]}, {"scene.yaml": PAIR})


FUNCTIONS = """
import inspect, granchain
for name in dir(granchain):
    function = getattr(granchain, name)
    if inspect.isfunction(function):
        values = inspect.signature(function).parameters.values()
        print(name, [(value.name, str(value.default), value.kind.name) for value in values])
run = granchain.run("scene.yaml", "run")
results = {
    "run": run,
    "analyze": granchain.analyze(run),
    "validate": granchain.validate(run),
    "threshold": granchain.threshold("scene.yaml", {"arrival@9": 8.0}, {"kick.velocity": (0.8, 2)}, "found", points=3),
    "modes": granchain.modes("precompressed", "modes", linear=True),
    "export": granchain.export(run, ["csv"], "exported"),
    "sweep": granchain.sweep({"scene": "scene.yaml", "vary": {"kick.velocity": [0.5, 1]}}, "swept", jobs=1),
    "collect": granchain.collect("swept"),
}
for name, result in results.items():
    print(name, repr(result), [word for word in dir(result) if not word.startswith("_")])
"""
