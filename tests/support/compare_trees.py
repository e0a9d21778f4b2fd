"""Compare what two trees of this project compute: decks, frames, numbers and exit codes, through their commands alone.

From the root of the new tree: ``python tests/support/compare_trees.py OLD_TREE [--random 200] [--seed 1]``.
Every installed scene and random ones go through ``show``, ``deck``, ``run`` with both engines, ``analyze`` and
``validate`` in both trees; one in ten also on two ranks, and one in ten is killed and resumed. Exit code 1 if anything
differs. What a tree has computed for a scene is kept in ``DIR`` under the hash of its sources and not computed again.

| what                           | compared                                                             |
|--------------------------------|----------------------------------------------------------------------|
| ``in.*``, ``data.chains``      | text without comments and white space at the ends of lines           |
| frames, snapshots              | bytes                                                                |
| ``*.csv``                      | cells, numbers by their values                                       |
| ``*.json`` but ``run.json``    | values, without times of the clock; a key that is missing is null    |
| standard output                | values of ``--json``                                                 |
| exit codes                     | of every command                                                     |
"""

import argparse
import contextlib
import hashlib
import io
import json
import math
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parents[2]

PACKAGES = ("lammps_inputs", "analysis", "workflow")

CLOCK = {
    "seconds",
    "engine_seconds",
    "date",
    "created",
    "finished",
    "host",
    "machine",
    "versions",
    "version",
    "command",
}
"""Keys of JSON that say when, where and how long."""

EVERY_TENTH = 10

STEP = 0.01
"""Of LAMMPS at most, in T, where a scene does not say otherwise."""


def commands(scene: Path, place: Path, number: int) -> Iterator[tuple[str, list[str]]]:
    """(name, words) of what is done with a scene."""
    yield "show", ["show", str(scene)]
    yield "deck", ["deck", str(scene), "-o", str(place / "deck")]
    yield "run", ["run", str(scene), "-o", str(place / "run")]
    yield "reference", ["run", str(scene), "-o", str(place / "reference"), "--engine", "reference"]
    yield "analyze", ["analyze", str(place / "run"), "--no-figures"]
    yield "analyze-reference", ["analyze", str(place / "reference"), "--no-figures"]
    if number % EVERY_TENTH == 0:
        yield "validate", ["validate", str(place / "run")]
        yield "ranks", ["run", str(scene), "-o", str(place / "ranks"), "--ranks", "2", "--no-check"]
    if number % EVERY_TENTH == 1:
        yield "killed", ["run", str(scene), "-o", str(place / "killed"), "--no-check", "--restart-every", "0"]
        yield "resumed", ["run", "--resume", str(place / "killed"), "--no-check"]
        yield "analyze-killed", ["analyze", str(place / "killed"), "--no-figures"]


# --- one tree, in a process of its own --------------------------------------------------------------------------------


def compute(scenes: list[Path], results: Path) -> None:
    """Run all commands of all scenes; what they leave, and their exit codes, stand below ``results``."""
    from workflow.cli import main

    for number, scene in enumerate(scenes):
        final = results / scene.stem
        if final.exists():
            continue
        with tempfile.TemporaryDirectory(dir=results) as scratch:
            place = Path(scratch) / scene.stem
            place.mkdir()
            codes: dict[str, int] = {}
            for name, words in commands(scene, place, number):
                out, err = io.StringIO(), io.StringIO()
                if name == "killed":
                    codes[name] = _killed(words, place / "killed")
                    continue
                with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
                    codes[name] = main(words)
                (place / f"{name}.txt").write_text((out.getvalue() + err.getvalue()).replace(str(place), "DIR"))
            (place / "codes.json").write_text(json.dumps(codes))
            place.rename(final)
        print(scene.stem, codes, flush=True)


def _killed(words: list[str], directory: Path) -> int:
    """Kill a run as soon as it has a restart, or let it end."""
    process = subprocess.Popen([sys.executable, "-m", "workflow", *words, "-q"], start_new_session=True)
    while process.poll() is None and not (directory / "chains.restart").exists():
        time.sleep(0.005)
    for entry in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            if (entry / "cwd").readlink() == directory.resolve():
                os.kill(int(entry.name), signal.SIGKILL)
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    return 0


# --- both -------------------------------------------------------------------------------------------------------------


def written_scenes(directory: Path, old: Path, count: int, seed: int) -> list[Path]:
    """YAML files of the old tree's installed scenes and of random ones, each with a time step of its own."""
    sys.path[:0] = [str(HERE), str(HERE / "tests" / "support")]
    from random_scenes import draw

    from lammps_inputs import library, strict_yaml
    from lammps_inputs.scene import DEFAULT_EVERY

    directory.mkdir(parents=True, exist_ok=True)
    found = {}
    for path in sorted((old / "lammps_inputs" / "scenes").glob("*.yaml")):
        found[path.stem] = library.find(str(path))
    for number in range(count):
        name = f"{seed}-{number}"
        chance = random.Random(name)
        while f"random-{name}" not in found:
            with contextlib.suppress(ValueError):
                found[f"random-{name}"] = draw(chance, name)
    for name, scene in found.items():
        every = scene.output.every or DEFAULT_EVERY * scene.scale.time
        step = every / math.ceil(every / scene.scale.time / STEP)
        given = {} if scene.timestep or scene.accuracy else {"timestep": step}
        (directory / f"{name}.yaml").write_text(strict_yaml.dump({**scene.plain(), **given}))
    return [directory / f"{name}.yaml" for name in found]


def sources(tree: Path) -> str:
    """Hash of a tree's packages."""
    files = sorted(path for package in PACKAGES for path in (tree / package).rglob("*") if path.is_file())
    digest = hashlib.sha256()
    for path in files:
        if "__pycache__" not in path.parts:
            digest.update(str(path.relative_to(tree)).encode() + path.read_bytes())
    return digest.hexdigest()[:16]


def plain(value: Any) -> Any:
    """JSON without what depends on the clock or the machine."""
    if isinstance(value, dict):
        return {key: plain(one) for key, one in value.items() if key not in CLOCK}
    return [plain(one) for one in value] if isinstance(value, list) else value


def content(path: Path) -> Any:
    """What is compared of a file; None for what is not."""
    if path.name == "run.json" or path.suffix in {".yaml", ".lammps", ".npz", ".restart", ".sha256", ".html"}:
        return None
    if path.suffix == ".bin":
        return hashlib.sha256(path.read_bytes()).hexdigest()
    if path.suffix == ".json":
        return plain(json.loads(path.read_text()))
    if path.name.startswith("in.") or path.name == "data.chains":
        lines = (line.partition("#")[0].rstrip() for line in path.read_text().splitlines())
        return [line for line in lines if line]
    return (
        [list(map(_cell, line.split(","))) for line in path.read_text().splitlines()] if path.suffix == ".csv" else None
    )


def _cell(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text


def files(place: Path) -> dict[str, Any]:
    """Name -> what is compared, of all that a scene left."""
    found = {str(path.relative_to(place)): content(path) for path in sorted(place.rglob("*")) if path.is_file()}
    for name in [name for name in found if name.startswith("killed/") and name.endswith(".bin")]:
        del found[name]  # cut where the kill happened to come; the analysis reads all of them
    return {name: value for name, value in found.items() if value is not None}


def difference(old: Any, new: Any, where: str = "") -> str:
    """The first place where two values differ; empty where they do not."""
    if isinstance(old, dict) and isinstance(new, dict):
        for key in [*old, *(key for key in new if key not in old)]:
            if found := difference(old.get(key), new.get(key), f"{where}.{key}"):
                return found
        return ""
    if isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        return next((found for k in range(len(old)) if (found := difference(old[k], new[k], f"{where}[{k}]"))), "")
    if old == new:
        return ""
    if isinstance(old, str) and isinstance(new, str) and "\n" in old:
        return difference(old.splitlines(), new.splitlines(), where)
    return f"{where}: {old!r:.80} | {new!r:.80}"


def main() -> int:
    """Compare, and say what differs."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("old", type=Path)
    parser.add_argument("--new", type=Path, default=HERE)
    parser.add_argument("--random", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--work", type=Path, default=Path(tempfile.gettempdir()) / "compared-trees")
    parser.add_argument("--compute", nargs="+", type=Path, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.compute:
        compute(arguments.compute[1:], arguments.compute[0])
        return 0
    place = arguments.work / f"scenes-{arguments.seed}"
    scenes = written_scenes(place, arguments.old.resolve(), arguments.random, arguments.seed)
    results = []
    for tree in (arguments.old.resolve(), arguments.new.resolve()):
        results.append(arguments.work / f"{sources(tree)}-{arguments.seed}")
        results[-1].mkdir(parents=True, exist_ok=True)
        command = [sys.executable, "-P", __file__, "old", "--compute", results[-1], *scenes]
        subprocess.run(command, check=True, env={**os.environ, "PYTHONPATH": str(tree)}, cwd=results[-1])
    kinds: Counter[str] = Counter()
    for scene in scenes:
        old, new = (files(place / scene.stem) for place in results)
        for name in sorted({*old, *new}):
            if found := difference(old.get(name), new.get(name)):
                kinds[name] += 1
                print(f"{scene.stem}: {name}{found}")
    print(f"{len(scenes)} scenes: {sum(kinds.values())} files differ; {dict(kinds)}")
    return 1 if kinds else 0


if __name__ == "__main__":
    sys.exit(main())
