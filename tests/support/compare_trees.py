"""Compare what two trees of this project compute: decks, frames, numbers, texts and exit codes, through their commands.

From the root of the new tree: ``python tests/support/compare_trees.py OLD_TREE [--random 200]``. Every installed scene
and random ones go through ``show``, ``deck``, ``run`` with both engines, ``analyze`` and ``validate`` in both trees;
one in ten also on two ranks, and one in ten is killed and resumed. Exit code 1 if anything differs. What a tree has
computed is kept in ``--work`` under the hash of its sources and of the commands, and not computed again. Each tree is
installed for its process, with the entry points of its own ``pyproject.toml``; of its modules this script names that of
its command alone.

| what                           | compared                                                             |
|--------------------------------|----------------------------------------------------------------------|
| ``in.*``, ``data.chains``      | text without comments and white space at the ends of lines           |
| frames                         | bytes                                                                |
| ``*.csv``                      | cells, numbers by their values                                       |
| ``*.json`` but ``run.json``    | values, without times of the clock; a key that is missing is null    |
| standard output and error      | text, without what `NOISE` names                                     |
| exit codes                     | of every command                                                     |
"""

import argparse
import contextlib
import csv
import fnmatch
import hashlib
import importlib
import io
import json
import math
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

sys.path.append(str(Path(__file__).resolve().parent))
from tree_metadata import write_metadata

HERE = Path(__file__).resolve().parents[2]

PACKAGES = ("lammps_inputs", "analysis", "workflow")

CLOCK = {"date", "created", "started", "finished", "host", "machine", "versions", "version", "command", "history"}
"""Keys of JSON that say when and where; those with `seconds` say how long."""

NOISE = (
    r"/\S*/(?=(lammps_inputs|analysis|workflow)/)",  # root of a tree
    r"\d[\d.]* s of processor time",
    r"\b(in|took) \d[\d.,]* (ms|s|min)\b",
    r"/\S*/computed/\w+/",
    r"granchain \d[\d.]*( \(commit \w+\))?",
    r"\d{4}-\d\d-\d\d[T ]\d\d:\d\d[\d:.+Z]*",
    r"compiling the [^\n]*\n",
)
"""Patterns of text that depend on the clock, the machine or the version."""

SHOWN = 10
"""Differing files of a scene that are printed at most."""

INTERRUPTED = 130
"""Exit code of a command that Ctrl-C or SIGTERM ended."""

EVERY_TENTH = 10

STEP = 0.01
"""Of LAMMPS at most, in T, where a scene does not say otherwise."""


def commands(scene: Path, number: int) -> Iterator[tuple[str, list[str]]]:
    """(name, words) of what is done with a scene."""
    yield "show", ["show", str(scene)]
    yield "deck", ["deck", str(scene), "-o", "deck"]
    yield "run", ["run", str(scene), "-o", "run"]
    yield "reference", ["run", str(scene), "-o", "reference", "--engine", "reference"]
    yield "analyze", ["analyze", "run", "--no-figures"]
    yield "analyze-reference", ["analyze", "reference", "--no-figures"]
    if number % EVERY_TENTH == 0:
        yield "validate", ["validate", "run"]
        yield "ranks", ["run", str(scene), "-o", "ranks", "--ranks", "2", "--no-check"]
    if number % EVERY_TENTH == 1:
        yield "killed", ["run", str(scene), "-o", "killed", "--no-check", "--restart-every", "0"]
        yield "resumed", ["run", "--resume", "killed", "--no-check"]
        yield "analyze-killed", ["analyze", "killed", "--no-figures"]


# --- one tree, in a process of its own --------------------------------------------------------------------------------


def compute(tasks: Path, results: Path) -> None:
    """Carry out what a file of tasks holds; what they leave, and their exit codes, stand below ``results``."""
    main = importlib.import_module(os.environ["COMMAND_OF_TREE"]).main
    for name, task in json.loads(tasks.read_text()).items():
        final = results / name
        if final.exists() and json.loads((final / "codes.json").read_text())["digest"] == task["digest"]:
            continue
        shutil.rmtree(final, ignore_errors=True)
        begun = time.monotonic()
        with tempfile.TemporaryDirectory(dir=results) as scratch:
            place = Path(scratch) / name
            place.mkdir()
            with contextlib.chdir(place):
                codes = {step: carried_out(main, step, words, place) for step, words in task["steps"].items()}
            if INTERRUPTED in codes.values():
                sys.exit(INTERRUPTED)
            seconds = time.monotonic() - begun
            (place / "codes.json").write_text(
                json.dumps({"digest": task["digest"], "codes": codes, "seconds": seconds})
            )
            place.rename(final)
        failed = {step: code for step, code in codes.items() if code}
        print(f"{name}: {len(codes)} commands in {seconds:.1f} s; exit codes {failed}", flush=True)


def carried_out(main: Any, step: str, words: list[str], place: Path) -> int:
    """Exit code of one command, whose output stands in a text file of its name."""
    if step == "killed":
        return _killed(words, place / "killed")
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = main(words)
    text = (out.getvalue() + err.getvalue()).replace(str(place), "DIR")
    (place / f"{step.replace('/', '-')}.txt").write_text(text)
    return code


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
    sys.path.insert(0, str(HERE))
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


def installed(tree: Path, directory: Path) -> dict[str, str]:
    """Environment in which the packages and entry points of a tree come before those of any installation."""
    directory.mkdir(parents=True, exist_ok=True)
    project = write_metadata(tree / "pyproject.toml", directory)
    paths = [directory, tree, tree / "workflow" / "python"]
    command = project["scripts"]["granchain"].partition(":")[0]
    return {**os.environ, "PYTHONPATH": os.pathsep.join(map(str, paths)), "COMMAND_OF_TREE": command}


def plain(value: Any) -> Any:
    """JSON without what depends on the clock or the machine."""
    if isinstance(value, dict):
        return {key: plain(one) for key, one in value.items() if key not in CLOCK and "seconds" not in key}
    return [plain(one) for one in value] if isinstance(value, list) else value


UNCOMPARED = {".lammps", ".restart", ".sha256"}


def content(path: Path) -> Any:
    """What is compared of a file; None for what is not."""
    if path.name in {"run.json", "codes.json", "analysis.lock"} or path.suffix in UNCOMPARED:
        return None
    if path.suffix == ".json":
        return plain(json.loads(path.read_text()))
    try:
        text = path.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        return hashlib.sha256(path.read_bytes()).hexdigest()
    if path.name.startswith("in.") or path.name == "data.chains":
        lines = (line.partition("#")[0].rstrip() for line in text.splitlines())
        return [line for line in lines if line]
    if path.suffix == ".csv":
        heads, *rows = list(csv.reader(text.splitlines())) or [[]]
        timed = [k for k, head in enumerate(heads) if "second" in head]
        return [[_cell(cell) for k, cell in enumerate(row) if k not in timed] for row in (heads, *rows)]
    for pattern in NOISE:
        text = re.sub(pattern, "", text)
    return text.splitlines()


def _cell(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text


def files(place: Path) -> dict[str, Any]:
    """Name -> what is compared, of all that a task left; of other files that they exist."""
    found = {str(path.relative_to(place)): content(path) for path in sorted(place.rglob("*")) if path.is_file()}
    for name in [name for name in found if name.startswith("killed/") and name.endswith(".bin")]:
        del found[name]  # cut where the kill happened to come; the analysis reads all of them
    found = {name: "present" if value is None else value for name, value in found.items()}
    return found | {"exit codes": json.loads((place / "codes.json").read_text())["codes"]}


def differences(old: Any, new: Any, where: str = "") -> Iterator[tuple[str, str]]:
    """Places where two values differ, and both."""
    if isinstance(old, dict) and isinstance(new, dict):
        for key in dict.fromkeys([*old, *new]):
            yield from differences(old.get(key), new.get(key), f"{where}.{key}")
    elif isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        for k, (one, other) in enumerate(zip(old, new, strict=True)):
            yield from differences(one, other, f"{where}[{k}]")
    elif isinstance(old, str) and isinstance(new, str) and old != new:
        same = next((k for k, pair in enumerate(zip(old, new, strict=False)) if len(set(pair)) > 1), 0)
        first = max(0, same - 20)
        yield where, f"{old[first:]!r:.80} | {new[first:]!r:.80}"
    elif old != new and not (old != old and new != new):  # nan
        yield where, f"{old!r:.80} | {new!r:.80}"


def main() -> int:
    """Compare, and say what differs."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("old", type=Path)
    parser.add_argument("--new", type=Path, default=HERE)
    parser.add_argument("--tasks", metavar="PATTERN", default="*", help="scenes of such names")
    parser.add_argument("--random", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--work", type=Path, default=Path(tempfile.gettempdir()) / "compared-trees")
    parser.add_argument("--compute", nargs=2, type=Path, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.compute:
        compute(*arguments.compute)
        return 0
    trees = (arguments.old.resolve(), arguments.new.resolve())
    places = [arguments.work / f"{sources(tree)}-{arguments.seed}" for tree in trees]
    environments = [installed(tree, place / "installed") for tree, place in zip(trees, places, strict=True)]
    scenes = written_scenes(arguments.work / f"scenes-{arguments.seed}", trees[0], arguments.random, arguments.seed)
    tasks = {scene.stem: {"steps": dict(commands(scene, number))} for number, scene in enumerate(scenes)}
    tasks = {name: task for name, task in tasks.items() if fnmatch.fnmatch(name, arguments.tasks)}
    for task in tasks.values():
        task["digest"] = hashlib.sha256(json.dumps(task).encode()).hexdigest()[:16]
    for place, environment in zip(places, environments, strict=True):
        begun = time.monotonic()
        (place / "tasks.json").write_text(json.dumps(tasks))
        words = [sys.executable, "-P", __file__, "old", "--compute", place / "tasks.json", place / "computed"]
        (place / "computed").mkdir(exist_ok=True)
        subprocess.run(words, check=True, env=environment, cwd=place)
        print(f"{place}: {time.monotonic() - begun:.0f} s", flush=True)
    return compared(tasks, [place / "computed" for place in places])


def compared(tasks: dict[str, Any], places: list[Path]) -> int:
    """Print the first difference of every file; exit code."""
    kinds: Counter[str] = Counter()
    for name in tasks:
        old, new = (files(place / name) for place in places)
        found = {file: next(differences(old.get(file), new.get(file)), None) for file in sorted({*old, *new})}
        differing = {file: first for file, first in found.items() if first is not None}
        kinds.update(differing.keys())
        for file, (where, both) in list(differing.items())[:SHOWN]:
            print(f"{name}: {file}{where}: {both}")
    print(f"{len(tasks)} scenes: {kinds.total()} files differ; {dict(kinds.most_common(20))}")
    return 1 if kinds else 0


if __name__ == "__main__":
    sys.exit(main())
