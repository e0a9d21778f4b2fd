"""Random accepted scenes through LAMMPS against an integrator that shares no code with the product.

As a script, from the root of the repository: ``python tests/support/random_scenes.py COUNT SEED``; a second or two a
scene. Wide flights, kicks both ways, gaps, windows, suzuki4, two ranks, SI, runs that are interrupted and go on. What
differs by more than the run itself states is silently wrong: exit code 1.
"""

import csv
import os
import random
import signal
import struct
import sys
import tempfile
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from analysis.tracking.leading_waves import usual_arrival
from lammps_inputs import Coupling, InputError, Kick, Material, Output, Scene
from workflow.engines.lammps import mpi
from workflow.errors import RunError
from workflow.runs.resume import resume
from workflow.runs.run import run
from workflow.verdicts.analyse import analyse

STATED = 3.0
"""Times what the run states (its error and the reference's own) that count as said: it looks at some frames only."""

FLOOR = 1e-5
"""Of V: below it nothing counts."""

FINE = 0.02
"""Time in T in which no velocity changes by more than 1e-3 V near its maximum."""


# --- an integrator and a reader of its own ----------------------------------------------------------------------------


def solution(chains: int, beads: int, kappa: float, gap: float, kicks: list, end: float) -> Any:
    """Displacements and velocities of eq. 1 or 2 of the paper at any time until the end, by DOP853."""

    def rates(_: float, state: np.ndarray) -> np.ndarray:
        x, v = state.reshape(2, chains, beads)
        push = np.maximum(x[:, :-1] - x[:, 1:] - gap, 0.0) ** 1.5
        force = np.zeros_like(x)
        force[:, 1:] += push
        force[:, :-1] -= push
        pull = kappa * (x[1:] - x[:-1])
        force[:-1] += pull
        force[1:] -= pull
        return np.concatenate([v.ravel(), force.ravel()])

    start = np.zeros((2, chains, beads))
    for chain, bead, velocity in kicks:
        start[1, chain - 1, bead - 1] = velocity
    found = solve_ivp(
        rates, (0.0, end), start.ravel(), "DOP853", rtol=1e-10, atol=1e-12, max_step=0.2, dense_output=True
    )
    return lambda time: found.sol(time).reshape(2, chains, beads)


def frames(path: Path) -> list[tuple[int, np.ndarray]]:
    """(step, rows of numbers) of each frame of a LAMMPS binary dump, straight from its documented layout."""
    raw, at, found = path.read_bytes(), 0, []
    while at < len(raw):
        step, _, triclinic = struct.unpack_from("<2qi", raw, at + 26)
        assert triclinic == 0
        at += 26 + 16 + 4 + 24 + 48
        columns, units = struct.unpack_from("<2i", raw, at)
        at += 8 + units
        at += 1 + 8 * raw[at]
        (names,) = struct.unpack_from("<i", raw, at)
        at += 4 + names
        (chunks,) = struct.unpack_from("<i", raw, at)
        at += 4
        rows = []
        for _ in range(chunks):
            (count,) = struct.unpack_from("<i", raw, at)
            rows.append(np.frombuffer(raw, "<f8", count, at + 4))
            at += 4 + 8 * count
        found.append((step, np.concatenate(rows).reshape(-1, columns)))
    return found


# --- scenes -----------------------------------------------------------------------------------------------------------


def draw(chance: random.Random, number: int) -> Scene:
    """A scene; not every one is accepted.

    Raises:
        ValueError: this one is not.
    """
    windowed = chance.random() < 0.15
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
    duration = chance.uniform(90.0, 140.0) if windowed else chance.uniform(20.0, 120.0)
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


# --- one scene --------------------------------------------------------------------------------------------------------


def judge(scene: Scene, directory: Path, *, ranks: int = 1, cut: bool = False) -> tuple[str, str]:
    """What came of a scene: ("right", "told", "stopped" or "WRONG", a reason)."""

    def progress(step: int, _: int) -> None:
        if cut and not sent:
            sent.append(step)
            os.kill(os.getpid(), signal.SIGINT)

    sent: list[int] = []
    try:
        result = run(scene, directory, ranks=ranks, progress=progress, restart_every=1e9)
        if result.outcome == "interrupted":
            again = resume(directory)
            assert again is not None
            result = again
    except RunError as error:
        return "stopped", str(error)
    assert result.check is not None
    said = STATED * (result.check.velocity + result.check.reference.velocity)
    problem = scene.problem()
    exact = solution(scene.chains, scene.beads, problem.kappa, problem.gap, list(problem.kicks), problem.duration)
    errors = {"velocities": velocities(scene, directory, exact, "dump")}
    if scene.output.snapshots is not None:
        errors["snapshots"] = velocities(scene, directory, exact, "snapshots")
    tables = ["waves.csv"] if not scene.window else []
    analyse(result.directory, figures=False, arrival="maximum")
    tables += ["peaks.csv"] if scene.output.peaks else []
    for table in tables:
        fastest = table == "waves.csv" or usual_arrival(problem) == "maximum"
        errors[table] = waves(scene, directory / table, exact, problem.duration, fastest=fastest)
    worst = max(errors, key=lambda name: errors[name])
    size = f"{worst} off by {errors[worst]:.1e} V; the run states {said / STATED:.1e}"
    if errors[worst] <= FLOOR:
        return "right", size
    allowed = {name: max(FLOOR, said, 1e-3 if name.endswith(".csv") else 0.0) for name in errors}
    wrong = [f"{name} off by {errors[name]:.1e} V" for name in errors if not errors[name] <= allowed[name]]
    return ("WRONG", f"{', '.join(wrong)}; {size}") if wrong else ("told", size)


def velocities(scene: Scene, directory: Path, exact: Any, kind: str) -> float:
    """Largest error of the velocities in the files of frames; in a window, in its half near the head."""
    problem = scene.problem()
    paths = sorted(directory.glob(f"chains.{kind}*.bin"), key=lambda path: (len(path.name), path.name))
    seen, worst = set(), 0.0
    for step, rows in (frame for path in paths for frame in frames(path)):
        if step in seen:
            continue
        seen.add(step)
        expected = exact(step * problem.timestep)[1]
        chain = (rows[:, 0].astype(int) - 1) // problem.rows
        bead = rows[:, 1].astype(int) if scene.window else (rows[:, 0].astype(int) - 1) % problem.rows + 1
        tail = bead.min() if scene.window else 1
        near = bead >= tail + problem.rows // 2 if tail > 1 else bead > 0
        worst = max(worst, float(np.max(np.abs(rows[near, -1] - expected[chain[near], bead[near] - 1]))))
    every = problem.steps_per_frame * (1 if kind == "dump" else problem.frames_per_snapshot or 1)
    return worst if seen == set(range(0, problem.steps + 1, every)) else np.inf


def waves(scene: Scene, path: Path, exact: Any, end: float, *, fastest: bool) -> float:
    """Largest difference of a wave's peak velocity from that of its bead at its arrival, where it must be largest.

    Where an arrival is not when the bead is fastest, or not defined, from the nearest that its bead ever has.
    """
    unit, worst = scene.scale, 0.0
    ever = np.abs([exact(t)[1] for t in np.arange(0.0, end, FINE)])
    for row in csv.DictReader(path.read_text().splitlines()):
        chain, bead = int(row["chain"]) - 1, int(row["bead"]) - 1
        # a pulse towards bead 1 has a positive peak_velocity
        peak = abs(float(row[unit.heading("peak_velocity", "velocity")])) / unit.velocity
        arrival = row[unit.heading("arrival", "time")]
        if peak < 0.01:
            continue
        if fastest and arrival:
            time = float(arrival) / unit.time
            near = [abs(exact(t)[1, chain, bead]) for t in (max(0.0, time - 0.3), time, min(end, time + 0.3))]
            worst = max(worst, abs(near[1] - peak), abs(max(near) - peak))
        else:
            worst = max(worst, float(np.min(np.abs(ever[:, chain, bead] - peak))))
    return float(worst)


def several(count: int, seed: int) -> Counter[str]:
    """So many accepted scenes, each judged; prints what is not right."""
    tally: Counter[str] = Counter()
    chance, number = random.Random(seed), 0
    while sum(tally.values()) < count:
        number += 1
        try:
            scene = draw(chance, number)
        except ValueError:
            continue
        ranks, cut = chance.choice([1, 1, 1, min(2, mpi.cores())]), chance.random() < 0.25
        with tempfile.TemporaryDirectory() as place:
            try:
                verdict, reason = judge(scene, Path(place) / "run", ranks=ranks, cut=cut)
            except InputError as error:
                verdict, reason = "refused", str(error)
        tally[verdict] += 1
        if verdict in ("WRONG", "stopped"):
            print(f"{verdict}: {scene.name} on {ranks}{', cut' * cut}: {reason}\n{scene.plain()}", flush=True)
        if sum(tally.values()) % 10 == 0:
            print(dict(tally), flush=True)
    return tally


if __name__ == "__main__":
    found = several(int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 1)
    print(", ".join(f"{number} {verdict}" for verdict, number in sorted(found.items())))
    sys.exit(1 if found["WRONG"] or found["stopped"] else 0)
