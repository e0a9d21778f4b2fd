"""The energy budget of random damped scenes, of the reference and of LAMMPS.

As a script, from the root of the repository: ``python tests/support/damped_scenes.py COUNT [SEED]``, half a second of
one core a scene, and minutes for the first ones where their laws are not compiled yet. Every law of damping, tension
cut or not; beads, springs and walls too; pushes and drives; gaps, kicks both ways, frames up to 2 T apart. A budget of
the reference that misses more than 1e-9 of what was put in, or one of LAMMPS that misses more than the error which the
run states amounts to, is printed: exit code 1.
"""

import math
import random
import sys
import tempfile
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import lammps_here
import numpy as np

from analysis.conservation import Conservation
from lammps_inputs import Scene
from workflow.runs.check import accountant
from workflow.runs.run import Run, run

CLOSED = 1e-9

KEPT = 0.5 * math.e
"""Of an error: what is lost keeps what a velocity forgets. Where drag c makes v fall off and is wrong by a share k, v
is off by k t v, at most k v / (c e) of the first, and the energy lost by k v**2 / (2 c)."""

KINDS: dict[str, dict[str, Any]] = {
    "linear": {"contact": 1.0},
    "linear, cut": {"contact": 1.0, "tension": "cut"},
    "viscoelastic": {"contact": 1.0, "law": "viscoelastic"},
    "viscoelastic, cut": {"contact": 1.0, "law": "viscoelastic", "tension": "cut"},
    "restitution": {"contact": 1.0, "law": "restitution"},
    "beads": {"beads": 1.0},
    "springs": {"coupling": 1.0},
    "all": {"contact": 1.0, "beads": 1.0, "coupling": 1.0},
    "all, pushed": {"contact": 1.0, "beads": 1.0, "coupling": 1.0},
    "all, cut, moved": {"contact": 1.0, "tension": "cut", "beads": 1.0, "coupling": 1.0},
    "linear, driven": {"contact": 1.0},
    "linear, walls": {"contact": 1.0},
    "viscoelastic, walls": {"contact": 1.0, "law": "viscoelastic"},
    "restitution, walls": {"contact": 1.0, "law": "restitution"},
}
"""Which coefficients a kind has."""


FACES = ("bead", "flat", "rigid")


def draw(chance: random.Random, kind: str, number: int) -> Scene:
    """A scene of a kind; those of one kind differ in numbers only, for each new mixture of laws has to be compiled."""
    keys = KINDS[kind]
    damping = {key: 10.0 ** chance.uniform(-3.0, 0.0) if value == 1.0 else value for key, value in keys.items()}
    if keys.get("law") == "restitution":
        damping["contact"] = chance.uniform(0.2, 0.99)
    tied = "coupling" in keys
    chains, beads = 2 if tied else chance.choice([1, 2]), chance.randint(2, 12)
    plain: dict[str, Any] = {"chains": chains, "beads": beads, "damping": damping}
    if tied:
        plain["coupling"] = {"stiffness": 10.0 ** chance.uniform(-2.0, 0.0)}
    place = {"chain": 1, "bead": chance.randint(1, beads)}
    if kind.endswith("pushed"):
        plain["push"] = {**place, "peak": chance.uniform(0.1, 1.0), "duration": chance.uniform(0.5, 5.0)}
        plain["push"]["shape"] = "half-sine"
    if kind.endswith(("moved", "driven")):
        what = (
            {"displacement": chance.uniform(0.1, 1.0)}
            if kind.endswith("moved")
            else {"force": chance.uniform(0.1, 1.0)}
        )
        plain["drive"] = {**place, **what, "frequency": chance.uniform(0.05, 0.4), "phase": chance.choice([0.0, -90.0])}
    else:
        hit = {(chance.randint(1, chains), chance.randint(1, beads)) for _ in range(chance.randint(1, 3))}
        speeds = [1.0, *(chance.choice([-1.0, 1.0]) * chance.uniform(0.1, 1.0) for _ in hit)]
        plain["kick"] = [{"chain": c, "bead": b, "velocity": v} for (c, b), v in zip(sorted(hit), speeds, strict=False)]
    if kind.endswith("walls"):
        plain["walls"] = {"left": chance.choice(FACES), "right": {"stiffness": 10.0 ** chance.uniform(-1.0, 1.5)}}
    plain["gap"] = chance.choice([0.0, 0.0, chance.uniform(0.1, 2.0)])
    plain["output"] = {"every": chance.choice([0.05, 0.1, 0.5, 1.0, 2.0])}
    plain["duration"] = chance.uniform(8.0, 20.0)
    return Scene.model_validate({"name": f"damped-{number}", **plain})


@dataclass(frozen=True)
class Closed:
    """Of one run, in shares of what was put in.

    Attributes:
        missing: what its budget misses.
        unsure: how well that is known.
        stated: error of velocities that the run states, in V.
        allowed: what the energy of its beads is off by if every velocity is off by that, where they move most.
    """

    missing: float
    unsure: float
    stated: float
    allowed: float

    @property
    def in_the_error(self) -> float:
        """What is missing over what is allowed."""
        return self.missing / self.allowed if self.missing > CLOSED else 0.0


def closed(found: Run, stated: float) -> Closed:
    """Of a run whose velocities are off by so much at most."""
    keeper = accountant(found.directory, found.directory.problem)
    seen, moving = Conservation(keeper.of), 0.0
    for block in found.directory.blocks():
        seen.add(block)
        moving = max(moving, float(np.max(np.sum(np.abs(block.velocity), axis=(1, 2)))))
    assert seen.budget is not None
    most = seen.budget.result().most
    return Closed(seen.energy_drift, keeper.unsure / most, stated, stated * moving / most)


def both(scene: Scene) -> tuple[Closed, Closed]:
    """The budget of the reference, and of LAMMPS."""
    with tempfile.TemporaryDirectory() as place:
        own = run(scene, Path(place) / "reference", engine="reference")
        reference = closed(own, own.directory.job.certificate.velocity)
        lammps = run(scene, Path(place) / "lammps", lammps=lammps_here.run)
        assert lammps.check is not None
        return reference, closed(lammps, lammps.check.velocity + lammps.check.reference.velocity)


def several(count: int, seed: str) -> int:
    """Judge so many scenes; how many are not closed."""
    worst: dict[str, list[float]] = defaultdict(lambda: [0.0] * 6)
    wrong = 0
    for number in range(count):
        kind = list(KINDS)[number % len(KINDS)]
        chance = random.Random(f"{seed}-{number}")
        scene = draw(chance, kind, number)
        reference, lammps = both(scene)
        numbers = [reference.missing, lammps.missing, lammps.stated, lammps.in_the_error, lammps.unsure, 1.0]
        worst[kind] = [*map(max, worst[kind][:-1], numbers[:-1]), worst[kind][-1] + 1.0]
        if not (reference.missing <= CLOSED and lammps.in_the_error <= KEPT):
            wrong += 1
            print(f"{kind}: reference {reference}, lammps {lammps}\n{scene.plain()}", flush=True)
    print(f"{'worst of':20} {'number':>6} {'reference':>10} {'LAMMPS':>10} {'stated V':>10} {'in it':>6} {'unsure':>8}")
    for kind, (own, theirs, stated, ratio, unsure, number) in worst.items():
        print(f"{kind:20} {number:6.0f} {own:10.1e} {theirs:10.1e} {stated:10.1e} {ratio:6.2f} {unsure:8.1e}")
    return wrong


if __name__ == "__main__":
    asked, seed, *_ = [*sys.argv[1:], "1"]
    sys.exit(1 if several(int(asked), seed) else 0)
