"""SIGKILLs at random moments of runs, which are then resumed, and the frames that a run has in all of its files."""

import contextlib
import json
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
from processes import HANGS, wait_until, working_in
from stock_lammps import scene

from analysis.files.binary_dump import BinaryDump
from lammps_inputs import Scene, library, strict_yaml

GRANCHAIN = str(Path(sys.executable).with_name("granchain"))

LOSSY = {
    "name": "lossy",
    "chains": 2,
    "beads": 20,
    "coupling": {"stiffness": 0.1},
    "kick": {"velocity": 1.0},
    "damping": {"contact": 0.002, "tension": "cut", "beads": 1e-4, "coupling": 0.01},
    "duration": 1000.0,
    "timestep": 0.01,
    "output": {"every": 0.5},
}

SCENES = {
    "some": (scene(name="some", chains=1, beads=80, duration=4000.0, every=0.1, recorded=(3, 40)), 1),
    "lossy": (library.from_plain(LOSSY, "lossy"), 2),
}
"""Scene and ranks; each runs for two to three seconds."""

AIMS = ("all", "command", "worker")
"""Who is killed: everything, as by a loss of power; the command alone; one of the processes that compute."""


def command(*words: object, restart_every: float = 0.0) -> "subprocess.Popen[str]":
    """``granchain run`` in a session of its own."""
    return subprocess.Popen(
        [GRANCHAIN, "run", *(str(word) for word in words), "--no-check", "--restart-every", str(restart_every)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def end(process: "subprocess.Popen[str]", directory: Path) -> None:
    """End what a command may have left behind, and the command."""
    for pid in [process.pid, *working_in(directory)]:
        kill(pid)
    process.communicate()


def kill(pid: int) -> None:
    """Kill one process, if it is still there."""
    with contextlib.suppress(ProcessLookupError):
        os.kill(pid, signal.SIGKILL)


def struck(process: "subprocess.Popen[str]", directory: Path, aim: str, chance: random.Random) -> bool:
    """Kill who is aimed at; whether anybody was there."""
    if process.poll() is not None:
        return False
    workers = working_in(directory)
    if aim == "worker" and workers:
        kill(chance.choice(workers))
    else:
        kill(process.pid)
        for pid in workers if aim == "all" else []:
            kill(pid)
    process.wait(HANGS)
    return True


def next_words(directory: Path, scene_file: Path, ranks: int) -> tuple[str, list[object]]:
    """What a directory says of its run, and the words that bring it to its end, as the README tells them."""
    fresh: list[object] = [scene_file, "-o", directory, "--ranks", ranks]
    if not directory.is_dir() or not (directory / "scene.yaml").exists():
        return "not begun", fresh
    if not (directory / "run.json").exists():
        return "not begun", [*fresh, "--overwrite"]
    return str(json.loads((directory / "run.json").read_text())["outcome"]), ["--resume", directory]


def frames(directory: Path, pattern: str = "chains.dump*.bin") -> "np.ndarray":
    """All frames of a run, those of the first file first, none twice."""
    found: dict[int, np.ndarray] = {}
    for path in sorted(directory.glob(pattern), key=lambda path: (len(path.name), path.name)):
        dump = BinaryDump(path)
        for step, values in zip(dump.steps.tolist(), dump.read(), strict=True):
            found.setdefault(step, values)
    return np.array([found[step] for step in sorted(found)])


def size(directory: Path) -> int:
    """Bytes of all frames."""
    return sum(path.stat().st_size for path in directory.glob("chains.dump*.bin"))


def computes(process: "subprocess.Popen[str]", directory: Path, share: float, one: Scene) -> None:
    """Wait until a command has added a share of all frames, or has ended."""
    problem = one.problem()
    some = 24.0 * problem.chains * len(problem.rows.numbers) * problem.frames * share
    before = size(directory)
    wait_until(lambda: size(directory) > before + some, process)


def until_done(directory: Path, one: Scene, ranks: int, chance: random.Random, *, kills: int) -> set[str]:
    """Run a scene to its end, and kill it on the way; returns what its directory has said of it."""
    scene_file = directory.with_suffix(".yaml")
    scene_file.write_text(strict_yaml.dump(one.plain()))
    states = set()
    while True:
        state, words = next_words(directory, scene_file, ranks)
        states.add(state)
        if state == "done":
            return states
        process = command(*words)
        try:
            if kills:
                if chance.random() < 0.75:
                    computes(process, directory, chance.random(), one)
                else:  # it may hit the command while it still sets up
                    time.sleep(chance.uniform(0.0, 0.5))
                kills -= struck(process, directory, chance.choice(AIMS), chance)
                # a command that was killed alone leaves processes that see it, and end by themselves
                assert wait_until(lambda: not working_in(directory))
                process.communicate()
            else:
                _, err = process.communicate(timeout=HANGS)
                assert process.returncode == 0, err
        finally:
            end(process, directory)
