"""Random accepted scenes through LAMMPS against an integrator that shares no code with the product.

As a script, from the root of the repository: ``python tests/support/random_scenes.py COUNT [SEED] [FROM]``, half a
second of one core a scene; ``SEED-NUMBER`` in place of COUNT is that scene alone. Wide flights, kicks both ways, gaps,
windows, suzuki4, two ranks, SI, runs that are interrupted and go on; foundations, walls, beads that differ, springs
between any chains and rows, pushes; any exponent, losses, static loads and drives, together. What differs by more than
the run itself states is silently wrong: exit code 1.
"""

import csv
import random
import struct
import sys
import tempfile
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import lammps_here
import numpy as np
from scenes_nature import solution
from scipy.signal import find_peaks

from lammps_inputs import Coupling, InputError, Kick, Material, Output, Scene
from workflow.engines.lammps import mpi
from workflow.errors import RunError
from workflow.runs.resume import resume
from workflow.runs.run import Run, run
from workflow.verdicts.analyse import analyse

FLOOR = 1e-5
"""Of V, and of T: below it nothing counts."""

BATCH = 50
"""Scenes between two reports."""

FINE = 0.02
"""Time in T between the states in which maxima are looked for; a quartic through five is then good to 1e-7 V and T."""

_THROUGH_FIVE = np.linalg.inv(np.vander(np.arange(-2.0, 3.0), increasing=True))

SMALLEST = 2e-3
"""Of V: maxima that a table must have; `analysis.tracking.peaks.THRESHOLD` twice."""


# --- a reader of its own ----------------------------------------------------------------------------------------------


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


# --- one scene --------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Stated:
    """What a run says of itself, dimensionless: bounds on its velocities, peaks and arrivals."""

    velocity: float
    peak: float
    arrival: float


def judge(scene: Scene, directory: Path, *, ranks: int = 1, cut: bool = False) -> tuple[str, str]:
    """What came of a scene: ("right", "told", "unknown", "stopped" or "WRONG", a reason).

    Told is what is off by no more than the run itself states; unknown what the integrator here does not know itself.
    """
    try:
        result = _run(scene, directory, ranks, cut=cut)
    except RunError as error:
        return "stopped", str(error)
    if isinstance(result, str):
        return "WRONG", result
    assert result.check is not None
    scene = result.directory.scene  # with its time step
    sure = result.check.reference
    late = [number for number in (result.check.arrival, sure.arrival) if np.isfinite(number)]
    peak = np.fmax(result.check.velocity, result.check.amplitude)
    stated = Stated(result.check.velocity + sure.velocity, float(peak) + sure.velocity, sum(late))
    analyse(result.directory, figures=False)
    verdict, reason = _compared(scene, directory, stated, 1e-8)
    if verdict == "WRONG":
        verdict, reason = _compared(scene, directory, stated, 1e-13)
    if verdict == "WRONG" and _apart(scene) > FLOOR:
        return "unknown", reason
    return verdict, reason


def _run(scene: Scene, directory: Path, ranks: int, *, cut: bool) -> Run | str:
    """The run, done; or what is wrong with how it went on. One rank in this process; what is cut is begun on one."""
    if not cut:
        return run(scene, directory, ranks=ranks, lammps=lammps_here.run)
    result = run(scene, directory, lammps=lammps_here.interrupted_after(0))
    if result.outcome == "done":
        # the first report comes after 200 steps, and the run is cut at the next, after 600
        return result if result.directory.problem.steps < 700 else "a run that was to be cut was not"
    again = resume(directory, ranks=ranks, lammps=lammps_here.run)
    if again is None or not result.directory.record["resumed"][-1]["from_step"] > 0:
        return "a run that was cut did not go on from where it was"
    return again


def _exact(scene: Scene, rtol: float) -> Any:
    return solution(scene, rtol)


def _apart(scene: Scene) -> float:
    """How far two integrations of this module's own are apart: where chaos reigns, neither is the truth."""
    times = np.linspace(0.0, scene.problem().duration, 500)
    return float(np.max(np.abs(_exact(scene, 1e-13)(times)[:, 1] - _exact(scene, 2e-13)(times)[:, 1])))


def _compared(scene: Scene, directory: Path, stated: Stated, rtol: float) -> tuple[str, str]:
    exact = _exact(scene, rtol)
    errors = {"velocities": velocities(scene, directory, exact, "dump")}
    if scene.output.snapshots is not None:
        errors["snapshots"] = velocities(scene, directory, exact, "snapshots")
    wrong = [
        f"{name} off by {error:.1e} V where {stated.velocity:.1e} is stated"
        for name, error in errors.items()
        if not error <= max(FLOOR, stated.velocity)
    ]
    if not (scene.drive or scene.precompression or scene.gravity):  # else no pulse leads, or sound does
        true = Truth(scene, exact)
        for table in ("waves.csv", *(["peaks.csv"] if scene.output.peaks else [])):
            wrong += [f"{table}: {fault}" for fault in faults(scene, directory / table, true, stated)[:4]]
    if wrong:
        return "WRONG", "; ".join(wrong)
    worst = max(errors.values())
    return "right" if worst <= FLOOR else "told", f"off by {worst:.1e} V, stated {stated.velocity:.1e}"


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


# --- tables -----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Maximum:
    """A maximum of a bead's velocity along the way of the hardest kick, dimensionless.

    Attributes:
        time: at which it is; ``since`` and ``until`` bound the time in which the velocity is nearly that.
        velocity: the maximum.
        prominence: by how much it stands above what is around it.
        centre: ``time`` less displacement over velocity.
        pressed: overlap with a neighbour.
    """

    time: float
    since: float
    until: float
    velocity: float
    prominence: float
    centre: float
    pressed: float


class Truth:
    """The maxima of all beads in the integrator's own trajectory."""

    def __init__(self, scene: Scene, exact: Any) -> None:
        problem = scene.problem()
        self.end, self.every = problem.duration, problem.every
        self.way = 1.0 if max(problem.kicks, key=lambda kick: abs(kick[2]))[2] > 0.0 else -1.0
        self.opposed = any(self.way * velocity < 0.0 for _, _, velocity in problem.kicks)
        self.times = np.linspace(0.0, self.end, round(self.end / FINE) + 1)
        states = self.way * exact(self.times)
        self._x, self.v = states[:, 0], states[:, 1]
        self._found: dict[tuple[int, int], list[Maximum]] = {}
        push = self.way * -np.diff(self._x, axis=2) - problem.gap
        self._overlap = np.maximum(
            np.pad(push, ((0, 0), (0, 0), (0, 1)), constant_values=-1.0),
            np.pad(push, ((0, 0), (0, 0), (1, 0)), constant_values=-1.0),
        )

    def maxima(self, chain: int, bead: int) -> list[Maximum]:
        """Of one bead, counted from 1, in the order of time."""
        if (chain, bead) not in self._found:
            self._found[chain, bead] = self._maxima(chain, bead)
        return self._found[chain, bead]

    def _maxima(self, chain: int, bead: int) -> list[Maximum]:
        v, x = self.v[:, chain - 1, bead - 1], self._x[:, chain - 1, bead - 1]
        step = self.times[1]
        places, more = find_peaks(np.concatenate([[-2.0], v, [-2.0]]), prominence=1e-7)
        found = []
        for place, prominence in zip(places - 1, more["prominences"], strict=True):
            shift, top = 0.0, v[place]
            if 1 < place < len(v) - 2:
                a, b, c, d, e = (_THROUGH_FIVE @ v[place - 2 : place + 3]).tolist()
                for _ in range(5):
                    bend = 2.0 * c + shift * (6.0 * d + shift * 12.0 * e)
                    slope = b + shift * (2.0 * c + shift * (3.0 * d + shift * 4.0 * e))
                    shift = min(1.0, max(-1.0, shift - slope / bend)) if bend < 0.0 else 0.0
                top = max(top, a + shift * (b + shift * (c + shift * (d + shift * e))))
            near = v >= top - FLOOR
            below = np.flatnonzero(~near)
            since = below[below < place].max(initial=-1) + 1
            until = below[below > place].min(initial=len(v)) - 1
            time = self.times[place] + shift * step
            way = x[place] + shift * step * top
            found.append(
                Maximum(
                    time,
                    min(time, self.times[since]),
                    max(time, self.times[until]),
                    top,
                    prominence,
                    time - way / top if top else 0.0,
                    self._overlap[place, chain - 1, bead - 1],
                )
            )
        return found

    def levels(self, chain: int, bead: int) -> list[Maximum]:
        """Where a bead flies freely for a while before it is pushed on: no maximum, but it was passed by a pulse."""
        v, x = self.v[:, chain - 1, bead - 1], self._x[:, chain - 1, bead - 1]
        flat = np.concatenate([[False], np.abs(np.diff(v)) < 1e-9, [False]])
        edges = np.flatnonzero(np.diff(flat.astype(int)))
        return [
            Maximum(self.times[a], self.times[a], self.times[b - 1], v[a], 0.0, self.times[a] - x[a] / v[a], -1.0)
            for a, b in zip(edges[::2], edges[1::2], strict=True)
            if v[a] > SMALLEST / 2
        ]

    def front(self, time: float) -> int:
        """The foremost bead that moves."""
        moving = np.abs(self.v[round(time / self.times[1])]).max(axis=0) > SMALLEST
        return int(np.flatnonzero(moving)[-1]) + 1

    def shown(self, one: Maximum, chain: int, bead: int) -> bool:
        """Whether the frames alone show that there is a maximum near it."""
        frames = np.interp(np.arange(0.0, self.end + 1e-9, self.every), self.times, self.v[:, chain - 1, bead - 1])
        k = int(one.time / self.every)
        return any(
            0 < j < len(frames) - 1 and frames[j] > SMALLEST / 2 and frames[j - 1] < frames[j] >= frames[j + 1]
            for j in (k, k + 1)
        ) or (one.time == 0.0 and frames[0] >= frames[1])


def faults(scene: Scene, path: Path, true: Truth, stated: Stated) -> list[str]:
    """What a table of waves has wrong, and what it lacks."""
    unit, found = scene.scale, []
    everywhere = scene.output.beads == "all" or scene.output.peaks  # whose table `analyse` takes over
    recorded = range(1, scene.beads + 1) if everywhere else scene.output.beads
    rows = {(int(row["chain"]), int(row["bead"])): row for row in csv.DictReader(path.read_text().splitlines())}
    needed = pulses(true, scene) if true.opposed else None
    for chain in range(1, scene.chains + 1):
        for bead in recorded:
            maxima = [one for one in true.maxima(chain, bead) if one.velocity > SMALLEST / 2 - stated.peak]
            row = rows.pop((chain, bead), None)
            if row is None:
                due = [
                    one
                    for one in maxima
                    if one.velocity > SMALLEST + stated.peak
                    and one.since < true.end - 2.0 * true.every
                    and one.prominence > FLOOR + stated.peak
                    and true.shown(one, chain, bead)
                ]
                if scene.window:  # what is far behind the front may be gone
                    due = [one for one in due if bead >= true.front(one.time) - 8]
                if scene.walls and true.way * bead < min(true.way * kick.bead for kick in scene.kick):
                    continue  # comes from the wall behind
                if due and (needed is None or (chain, bead) in needed):
                    found.append(f"lacks bead {bead} of chain {chain}: {due[0].velocity:.3g} V at {due[0].time:.4g}")
                continue
            peak = float(row[unit.heading("peak_velocity", "velocity")]) / unit.velocity
            off = float(row[unit.heading("peak_velocity_error", "velocity")] or "inf") / unit.velocity
            arrival = float(row[unit.heading("arrival", "time")] or "nan") / unit.time
            late = float(row[unit.heading("arrival_error", "time")] or "inf") / unit.time
            # the run's own check leaves out the bead that the pulse ends at
            end = 3.0 if bead in (1, scene.beads) else 1.0
            allowed = max(FLOOR, stated.peak) * end + off
            first = true.levels(chain, bead) + [
                one
                for k, one in enumerate(maxima)
                if true.opposed
                or all(
                    before.prominence < 2.0 * allowed
                    or before.velocity < SMALLEST
                    or not true.shown(before, chain, bead)
                    for before in maxima[:k]
                )
            ]
            late += max(FLOOR, stated.arrival) * end
            if not any(_fits(one, peak, arrival, allowed, late, gap=scene.gap > 0.0) for one in first):
                near = ", ".join(f"{one.velocity:.6g} at {one.time:.5g} ({one.centre:.5g})" for one in first[:3])
                said = f"{peak:.6g} (to {allowed:.1e}) at {arrival:.5g} (to {late:.1e})"
                found.append(f"bead {bead} of chain {chain}: {said}, where {near} is true")
    return found + [f"has bead {bead} of chain {chain}, which there is not" for chain, bead in rows]


def _fits(one: Maximum, peak: float, arrival: float, allowed: float, late: float, *, gap: bool) -> bool:
    """Whether a row may be this maximum."""
    if not abs(one.velocity - peak) <= allowed:
        return False
    if np.isnan(arrival):
        return True
    if gap:
        # an error of velocity adds up to one of displacement
        more = allowed * (one.time + abs(one.time - one.centre)) / peak
        return abs(one.centre - arrival) <= late + more
    return one.since - late <= arrival <= one.until + late


def pulses(true: Truth, scene: Scene) -> set[tuple[int, int]]:
    """Beads (chain, bead) that a pulse passes which nobody could miss, though there are kicks both ways.

    At six beads in a row or more, pressed against a neighbour, at nearly the speed of the exact wave, which hardly
    changes.
    """
    found: set[tuple[int, int]] = set()
    order = range(1, scene.beads + 1) if true.way > 0.0 else range(scene.beads, 0, -1)
    for chain in range(1, scene.chains + 1):
        run: list[tuple[int, Maximum]] = []
        for bead in [*order, 0]:
            best = max(
                (
                    one
                    for one in (true.maxima(chain, bead) if bead else [])
                    if one.pressed > 0.4 * max(one.velocity, 0.0) ** 0.8
                ),
                key=lambda one: one.velocity,
                default=None,
            )
            if best is not None and run:
                before = run[-1][1]
                delay = (
                    (best.time - before.time) * 0.907 * (best.velocity * before.velocity) ** 0.1
                    if best.velocity > 0.2
                    else 0.0
                )
                steady = 0.8 < delay < 1.25 and 0.8 < best.velocity / before.velocity < 1.25
            else:
                steady = best is not None and best.velocity > 0.2
            if not steady:
                if len(run) >= 6:
                    found |= {(chain, number) for number, _ in run}
                run = []
            if best is not None and best.velocity > 0.2:
                run.append((bead, best))
    return found


# --- many -------------------------------------------------------------------------------------------------------------


def one(name: str) -> tuple[str, str, str]:
    """What came of the scene of that name, SEED-NUMBER: (verdict, kinds that it is of, text to print)."""
    chance, scene = random.Random(name), None
    while scene is None:
        try:
            scene = draw(chance, name)
        except ValueError:
            continue
    ranks, cut = chance.choice([1, 1, 1, min(2, mpi.cores(), scene.beads)]), chance.random() < 0.25
    with tempfile.TemporaryDirectory() as place:
        try:
            verdict, reason = judge(scene, Path(place) / "run", ranks=ranks, cut=cut)
        except InputError as error:
            verdict, reason = "refused", str(error)
    how = f"{scene.name} on {ranks}{', cut' * cut}"
    kinds = {
        "two ranks": ranks > 1,
        "cut": cut,
        "window": scene.window,
        "suzuki4": scene.scheme == "suzuki4",
        "gap": scene.gap,
        "SI": scene.material,
        "snapshots": scene.output.snapshots,
        "peaks": scene.output.peaks,
        "both ways": len({kick.velocity > 0.0 for kick in scene.kick}) > 1,
        "several kicks": len(scene.kick) > 1,
        "foundation": scene.foundation,
        "walls": scene.walls,
        "unequal": scene.pattern,
        "graph": scene.coupling and (scene.coupling.topology or scene.coupling.cubic or scene.coupling.rows),
        "push": scene.push,
        "exponent": scene.contact,
        "lossy": scene.damping,
        "loaded": scene.precompression or scene.gravity,
        "driven": scene.drive,
    }
    return verdict, ",".join(kind for kind in kinds if kinds[kind]), f"{verdict}: {how}: {reason}\n{scene.plain()}"


def several(names: list[str]) -> Counter[str]:
    """These scenes, each judged, on all cores; prints what is not right."""
    tally: Counter[str] = Counter()
    kinds: Counter[str] = Counter()
    # a pool that makes its workers anew by itself (max_tasks_per_child) can wait forever in Python 3.11
    for begin in range(0, len(names), BATCH):
        batch = names[begin : begin + BATCH]
        with ProcessPoolExecutor(min(mpi.cores(), len(batch)), get_context("spawn")) as pool:
            for verdict, which, text in pool.map(one, batch):
                tally[verdict] += 1
                kinds.update(which.split(",") if which else [])
                if verdict in ("WRONG", "stopped", "unknown", "refused"):
                    print(text, flush=True)
        print(dict(tally), dict(kinds), flush=True)
    return tally


if __name__ == "__main__":
    number, seed, begin, *_ = [*sys.argv[1:], *["1", "1"][len(sys.argv) - 2 :]]
    chosen = [number] if "-" in number else [f"{seed}-{k}" for k in range(int(begin), int(begin) + int(number))]
    found = several(chosen)
    print(", ".join(f"{count} {verdict}" for verdict, count in sorted(found.items())))
    sys.exit(1 if found["WRONG"] or found["stopped"] else 0)
