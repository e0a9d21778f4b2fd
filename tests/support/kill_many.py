"""SIGKILLs at random moments of runs, which are then resumed: is every result bit for bit the uninterrupted one?

As a script, from the root of the repository: ``python tests/support/kill_many.py 200 [SEED [NAME...]]``, the names
being those of `SCENES` and `MORE`; some four minutes.
"""

import contextlib
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from processes import HANGS, wait_until, working_in
from stock_lammps import scene

from analysis.files.binary_dump import BinaryDump
from lammps_inputs import Scene, library, strict_yaml
from lammps_inputs.ingredients.damping import Damping
from workflow.engines.lammps import mpi

GRANCHAIN = str(Path(sys.executable).with_name("granchain"))

SCENES = {
    "pair": (scene(name="pair", chains=2, beads=50, kappa=0.1, duration=4000.0, every=0.5), 1),
    "ranks": (scene(name="ranks", chains=3, beads=16, kappa=1e-3, gap=1.5, duration=2000.0, every=0.5), 2),
    "damped": (
        scene(
            name="damped",
            chains=2,
            beads=20,
            kappa=0.1,
            duration=1500.0,
            every=0.5,
            timestep=0.01,
            damping=Damping(contact=0.002, beads=1e-4),
        ),
        1,
    ),
    "some": (scene(name="some", chains=1, beads=80, duration=4000.0, every=0.1, recorded=(3, 40)), 1),
}
"""Scene and ranks; each runs for two to three seconds."""

_SHORT = {
    "chains": 2,
    "beads": 20,
    "coupling": {"stiffness": 0.1},
    "duration": 1000.0,
    "timestep": 0.01,
    "output": {"every": 0.5},
}
_LOSSY = {"contact": 0.002, "tension": "cut", "beads": 1e-4, "coupling": 0.01}
_LOADED = {"precompression": {"force": 0.5}, "walls": {"right": "flat"}}


def _more(name: str, ranks: int, **parts: Any) -> tuple[Scene, int]:
    return library.from_plain({"name": name, **_SHORT, **parts}, name), ranks


MORE = {
    "lossy": _more("lossy", 2, kick={"velocity": 1.0}, damping=_LOSSY),
    "viscous": _more("viscous", 2, kick={"velocity": 1.0}, damping={"contact": 0.01, "law": "viscoelastic"}),
    "bounced": _more("bounced", 1, kick={"velocity": 1.0}, damping={"contact": 0.99, "law": "restitution"}),
    "driven": _more(
        "driven",
        2,
        drive={"displacement": 0.5, "frequency": 0.1, "phase": -90},
        foundation={"stiffness": 0.2},
        damping={"contact": 0.05, "beads": 0.01},
    ),
    "loaded": _more("loaded", 2, **_LOADED, push={"peak": 1.0, "duration": 3.0, "shape": "half-sine"}),
    "shaken": _more("shaken", 1, **_LOADED, drive={"force": 0.1, "frequency": 0.2}),
}
"""Losses, drives and loads: likewise."""

AIMS = ("all", "command", "worker")
"""Who is killed: everything, as by a loss of power; the command alone; one of the processes that compute."""


@dataclass
class Tally:
    """What happened: how many were killed, and what their directories said."""

    kills: int = 0
    runs: int = 0
    states: Counter[str] = field(default_factory=Counter)


def command(*words: object) -> "subprocess.Popen[str]":
    """``granchain run`` in a session of its own."""
    return subprocess.Popen(
        [GRANCHAIN, "run", *(str(word) for word in words), "--no-check", "--restart-every", "0"],
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
    some = 24.0 * problem.chains * len(problem.recorded_beads) * problem.frames * share
    before = size(directory)
    wait_until(lambda: size(directory) > before + some, process)


def until_done(directory: Path, one: Scene, ranks: int, tally: Tally, chance: random.Random, *, kills: int) -> None:
    """Run a scene to its end, and kill it on the way."""
    scene_file = directory.with_suffix(".yaml")
    scene_file.write_text(strict_yaml.dump(one.plain()))
    left = kills
    while True:
        state, words = next_words(directory, scene_file, ranks)
        tally.states[state] += 1
        if state == "done":
            break
        process = command(*words)
        try:
            if left:
                if chance.random() < 0.75:
                    computes(process, directory, chance.random(), one)
                else:  # it may hit the command while it still sets up
                    time.sleep(chance.uniform(0.0, 0.5))
                hit = struck(process, directory, chance.choice(AIMS), chance)
                tally.kills += hit
                left -= hit
                # a command that was killed alone leaves processes that see it, and end by themselves
                assert wait_until(lambda: not working_in(directory))
                process.communicate()
            else:
                _, err = process.communicate(timeout=HANGS)
                assert process.returncode == 0, err
        finally:
            end(process, directory)
    tally.runs += 1


def main(kills: int, seed: int, chosen: list[str]) -> int:
    """Kill as often as asked; exit code 1 if any result differs."""
    tally, chance, wrong = Tally(), random.Random(seed), 0
    scenes = {name: (SCENES | MORE)[name] for name in chosen or SCENES}
    with tempfile.TemporaryDirectory() as work:
        whole = {}
        for name, (one, ranks) in scenes.items():
            until_done(Path(work) / name, one, ranks, Tally(), chance, kills=0)
            whole[name] = frames(Path(work) / name)
        names = [name for name in scenes if scenes[name][1] <= mpi.cores()]
        while tally.kills < kills:
            name = names[tally.runs % len(names)]
            directory = Path(work) / f"{tally.runs}"
            few = min(chance.randint(1, 8), kills - tally.kills)
            until_done(directory, *scenes[name], tally, chance, kills=few)
            same = np.array_equal(frames(directory), whole[name])
            wrong += not same
            again = json.loads((directory / "run.json").read_text()).get("resumed", [])
            steps = ", ".join(str(one["from_step"]) for one in again)
            verdict = "same" if same else "DIFFERS"
            print(f"{tally.kills:4d} kills  {name:7s} {verdict}  resumed from step {steps or '-'}", flush=True)
    print(f"{tally.kills} SIGKILLs over {tally.runs} runs: {tally.runs - wrong} bit for bit the same, {wrong} not")
    print(f"states found: {dict(tally.states)}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 1, sys.argv[3:]))
