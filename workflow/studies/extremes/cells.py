"""The cells of the report: one scene with each number at its extremes, and all that chains may be made of.

Those that need many steps are short: what goes wrong there does so at once.
"""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from lammps_inputs import library
from lammps_inputs.limits.rates import stability_bound
from workflow.engines.lammps.mpi import cores

Plain = dict[str, Any]

BASE: Plain = {
    "name": "extreme",
    "chains": 2,
    "beads": 30,
    "coupling": {"stiffness": 0.1},
    "kick": {"velocity": 1.0},
    "duration": 30.0,
}


@dataclass(frozen=True)
class Cell:
    """One run of the report.

    Attributes:
        axis, value: its name.
        scene: what a scene file would say.
        ranks: MPI ranks; more than one must compute bit for bit what one computes.
        scaling: whether the run must be a scaled copy of that at another V, 1 in reduced units.
        drift: whether the energy must stay as near to the kick's in the second half as in the first.
        force: whether a time step above the stability bound is let pass.
    """

    axis: str
    value: str
    scene: Plain
    ranks: int = 1
    scaling: bool = False
    drift: bool = False
    force: bool = False


def changed(scene: Plain, **changes: Any) -> Plain:
    """A scene with some keys changed, added, or (None) left out."""
    return {key: value for key, value in {**scene, **changes}.items() if value is not None}


def scaled(scene: Plain, factor: float) -> Plain:
    """The same motion with all kicks times a positive factor: the equations have no scale of their own.

    Displacements go as V**0.8, times as V**-0.2, springs as V**0.4. For scenes with a duration and default output.
    """
    kicks = scene["kick"] if isinstance(scene["kick"], list) else [scene["kick"]]
    changes: Plain = {
        "kick": [{**kick, "velocity": kick["velocity"] * factor} for kick in kicks],
        "duration": scene["duration"] * factor**-0.2,
    }
    if "gap" in scene:
        changes["gap"] = scene["gap"] * factor**0.8
    if "coupling" in scene:
        changes["coupling"] = {"stiffness": scene["coupling"]["stiffness"] * factor**0.4}
    return {**scene, **changes}


def springs(stiffness: float) -> Plain | None:
    """The coupling of a scene; none for 0."""
    return {"stiffness": stiffness} if stiffness else None


def decades(first: int, last: int, by: int) -> tuple[float, ...]:
    """Powers of ten, both ends among them."""
    return tuple(float(f"1e{power}") for power in range(first, last + 1, by))


# --- numbers ----------------------------------------------------------------------------------------------------------

STEEL: Plain = {"radius": 4.76e-3, "density": 8000.0, "youngs_modulus": 193e9, "poisson_ratio": 0.3}
JELLY: Plain = {"radius": 1e-6, "density": 1000.0, "youngs_modulus": 100.0, "poisson_ratio": 0.5}
DIAMOND: Plain = {"radius": 100.0, "density": 3500.0, "youngs_modulus": 1.2e12, "poisson_ratio": -0.9}


def axis(name: str, values: Iterable[float], make: Callable[[Any], Plain], form: str = "g") -> list[Cell]:
    """A cell for each value: the scene with what a function makes of the value, named by the value."""
    return [Cell(name, format(value, form), changed(BASE, **make(value))) for value in values]


def numbers() -> list[Cell]:
    """Axis by axis; where a number demands many steps, runs are shorter."""
    return [
        *(Cell("V", f"{v:g}", scaled(BASE, v), scaling=True) for v in decades(-12, 12, 3)),
        *axis(
            "kappa",
            (0.0, *decades(-8, 4, 2), 1e13),
            lambda k: {"coupling": springs(k), "duration": 30.0 if k <= 1e2 else 2.0},
        ),
        *(_step(f) for f in (1e-4, 1e-2, 0.1, 0.5, 0.9, 0.99, 1.01, 3.0)),
        *(_step(f, force=True) for f in (1.01, 1.2, 1.5, 3.0)),
        *axis(
            "accuracy",
            (0.1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8),
            lambda a: {"accuracy": a, "duration": 30.0 if a >= 1e-5 else 10.0},
        ),
        *axis("chains", (1, 2, 3, 10, 100, 1000), lambda n: {"chains": n, "beads": 20, "duration": 20.0}, "d"),
        *axis("beads", (2, 3, 10, 100, 1000, 10_000, 100_000), _beads, ",d"),
        *axis("beads, window", (100, 1000, 3000), _window, ",d"),
        *axis("gap", (0.0, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e9), _gap),
        *(replace(cell, drift=True) for cell in axis("steps", (10**3, 10**4, 10**5, 10**6), _duration, ",d")),
        *(Cell("ranks", str(n), BASE, ranks=n) for n in (0, 1, 2, cores() + 1)),
    ]


def _step(share: float, *, force: bool = False) -> Cell:
    """A time step as a share of the largest stable one, with frames about 0.1 apart."""
    step = share * stability_bound(library.from_plain(BASE, "base").system)
    output: Plain = {"every": step * max(1, round(0.1 / step))}
    name = f"{share:g} forced" if force else f"{share:g}"
    return Cell("step / bound", name, changed(BASE, timestep=step, output=output), force=force)


def _beads(beads: int) -> Plain:
    """The pulse runs to the end of up to 1,000 beads; in longer chains it starts 10 beads from the end."""
    if beads <= 1000:
        return {"beads": beads, "duration": 1.2 * beads + 10.0}
    far = {"bead": beads - 10, "velocity": 1.0}
    return {"beads": beads, "kick": far, "duration": 20.0, "output": {"every": 2.0}}


def _window(beads: int) -> Plain:
    """The pulse runs most of the way, and only the rows near it exist."""
    return {"beads": beads, "window": "auto", "duration": 1.15 * beads, "output": {"every": 0.5}}


def _gap(gap: float) -> Plain:
    """Two beads far apart meet once; a pulse crosses four that are near.

    A flight as long as 1e6 needs long steps: at the end, a velocity is off by no more than in the contact.
    """
    every = {"every": gap / 1000.0}
    if gap > 1e3:
        lone: Plain = {"chains": 1, "beads": 2, "coupling": None, "timestep": 0.25, "output": every}
        towards = [{"velocity": 1.0}, {"velocity": -1.0, "bead": 2}]
        return {**lone, "kick": towards, "gap": gap, "duration": 0.51 * gap}
    times: Plain = {"duration": 10.0 + 5.0 * gap, "output": {"every": max(0.1, gap / 1000.0)}}
    return {"beads": 4, "coupling": springs(1e-6), "gap": gap or None, **times}


def _duration(steps: int) -> Plain:
    """A single pulse that is under way all the time; the step is the shorter, the more there are."""
    step = min(0.01, 500.0 / steps)
    duration = steps * step
    length: Plain = {"beads": round(0.85 * duration) + 10, "chains": 1, "coupling": None}
    return {**length, "duration": duration, "timestep": step, "output": {"every": step * max(1, round(0.5 / step))}}


def corners() -> list[Cell]:
    """Several numbers at once."""
    return [
        Cell("corners", name, changed(BASE, **changes), scaling=name in _SCALING, drift=name == "ten rows, 1e6 steps")
        for name, changes in (_MOTION | _COMPUTATION).items()
    ]


_HEAD_ON: list[Plain] = [{"velocity": 1.0}, {"velocity": -1.0, "bead": 30}]
_EVERY_BEAD = [{"velocity": (-1.0) ** (i + j), "chain": j, "bead": i} for i in range(1, 31) for j in (1, 2)]
_STIFF: Plain = {"coupling": springs(1e4), "timestep": 2e-4, "output": {"every": 0.1}}
_SLOW: Plain = {"chains": 1, "coupling": None, "material": JELLY}

_SCALING = ("V 1e12, gap 1e6", "V 1e-30", "V 1e30", "jelly, 1 um", "diamond, 100 m")

_MOTION: dict[str, Plain] = {
    "V 1e-12, springs 0.1": {"kick": {"velocity": 1e-12}, "duration": 1e3},
    "V 1e12, springs 0.1": {"kick": {"velocity": 1e12}, "duration": 0.1},
    "V 1e-12, gap 1": {"kick": {"velocity": 1e-12}, "gap": 1.0, "duration": 1e4},
    "V 1e12, gap 1e6": scaled(changed(BASE, gap=1e6 * 1e12**-0.8), 1e12),
    "V 1e-30": scaled(BASE, 1e-30),
    "V 1e30": scaled(BASE, 1e30),
    "kappa 1e4, 1000 chains, long step": {"chains": 1000, "beads": 4, "duration": 2.0, **_STIFF},
    "kappa 1e4, 1000 chains, default step": {"chains": 1000, "beads": 4, "duration": 0.1, "coupling": springs(1e4)},
    "kappa 1e4, bead 10,000, long step": {
        "beads": 10_000,
        "kick": {"bead": 9990, "velocity": 1.0},
        "duration": 0.5,
        **_STIFF,
    },
    "kappa 1e12": {"coupling": springs(1e12), "duration": 1e-3, "output": {"every": 1e-6}},
    "both ends, chain 1": {"kick": _HEAD_ON},
    "both ends, two chains": {"kick": [_HEAD_ON[0], {**_HEAD_ON[1], "chain": 2}]},
    "backwards from bead 1": {"kick": {"velocity": -1.0}},
    "backwards from bead 30": {"kick": {"velocity": -1.0, "bead": 30}},
    "backwards, gap": {"kick": {"velocity": -1.0}, "gap": 1.0},
    "all beads, +1 and -1": {"kick": _EVERY_BEAD},
    "kicks 1 and 1e-12": {"kick": [{"velocity": 1.0}, {"velocity": 1e-12, "bead": 20, "chain": 2}]},
    "one recorded bead": {"output": {"beads": [17]}},
    "frames 10 T apart": {"beads": 100, "duration": 100.0, "output": {"every": 10.0}},
    "one step": {"duration": 1e-3, "timestep": 1e-3, "output": {"every": 1e-3}},
    "far, short steps, gap": {
        "coupling": springs(1.0),
        "gap": 1e6,
        "kick": {"velocity": 1.0, "bead": 25},
        "timestep": 1e-5,
        "duration": 2.0,
    },
}
"""Kicks, springs and gaps."""

_COMPUTATION: dict[str, Plain] = {
    "suzuki4": {"scheme": "suzuki4"},
    "suzuki4, kappa 100": {"scheme": "suzuki4", "coupling": springs(100.0)},
    "suzuki4, step 0.15": {"scheme": "suzuki4", "timestep": 0.15, "output": {"every": 0.75}},
    "window, past the end": {"beads": 500, "coupling": springs(0.01), "window": 64, "duration": 1300.0},
    "window, kappa 0.001": {"beads": 500, "coupling": springs(1e-3), "window": "auto", "duration": 600.0},
    "window, accuracy 1e-5": {"beads": 200, "window": "auto", "accuracy": 1e-5, "duration": 200.0},
    "accuracy, kappa 1e4": {"coupling": springs(1e4), "accuracy": 1e-3, "duration": 2.0},
    "accuracy, 5 frames a period": {  # frames 0.05 apart would all show one phase of the springs' oscillation
        "coupling": springs(0.5 * (2.0 * math.pi / 0.05) ** 2),
        "accuracy": 1e-3,
        "duration": 1.0,
        "output": {"every": 0.01},
    },
    "accuracy, gap": {"gap": 10.0, "beads": 6, "accuracy": 1e-4, "duration": 200.0},
    "until bead 25": {"duration": None, "until_bead": 25},
    "until bead 25, uncoupled": {"coupling": springs(1e-8), "duration": None, "until_bead": 25},
    "two rows, 1e6 steps": {"beads": 2, "duration": 1e4, "output": {"every": 1.0}},
    "ten rows, 1e6 steps": {"beads": 10, "duration": 1e4, "output": {"every": 1.0}},
    "steel, 1 nm/s": {"material": STEEL, "kick": {"velocity": 1e-9}, "coupling": springs(6e2), "duration": 0.024},
    "jelly, 1 um": {**_SLOW, "kick": {"velocity": 1e-3}, "duration": 1e-2},
    "diamond, 100 m": {**_SLOW, "material": DIAMOND, "kick": {"velocity": 1e-6}, "duration": 60.0},
    "units overflow": {**_SLOW, "material": {**STEEL, "density": 1e30, "radius": 1e30}},
}
"""Schemes, windows, accuracies and units."""


# --- loads, losses, masses, exponents and drives ----------------------------------------------------------------------


def loads() -> list[Cell]:
    """Static loads, in units of the forces of the kick; at large ones sound is fast and runs are short."""
    column: Plain = {"gravity": 1.0, "walls": {"right": "bead"}, "duration": 10.0}
    return [
        *axis(
            "load",
            (*decades(-9, 3, 3), 1e6, 1e7),
            lambda f: {"precompression": {"force": f}, "duration": 30.0 if f <= 1.0 else 10.0},
        ),
        *axis(
            "gravity", (1e-9, 1e-3, 1.0, 1e3), lambda g: {"gravity": g, "walls": {"right": "flat"}, "duration": 10.0}
        ),
        *axis(
            "load, exponent",
            (1.0, 3.0),
            lambda p: {"precompression": {"force": 1.0}, "contact": {"exponent": p}, "duration": 10.0},
        ),
        *axis("gravity, exponent", (1.0, 3.0), lambda p: {**column, "contact": {"exponent": p}}),
    ]


def losses() -> list[Cell]:
    """Dashpots of every law, from none to where beads stick."""

    def lossy(name: str, values: Iterable[float], key: str, **more: str) -> list[Cell]:
        return axis(name, values, lambda c: {"damping": {key: c, **more}, "duration": 10.0 if c <= 10.0 else 1.0})

    return [
        *lossy("dashpots", (0.0, 1e-9, 0.1, 1.0, 10.0, 1e3, 1e4), "contact"),
        *lossy("dashpots, cut", (0.1, 10.0, 1e3), "contact", tension="cut"),
        *lossy("viscoelastic", (1e-3, 1.0, 1e3), "contact", law="viscoelastic"),
        *lossy("restitution", (1e-30, 0.5, 0.999999, 1.0), "contact", law="restitution"),
        *lossy("drag", (1e-9, 0.1, 1.0, 10.0, 1e3, 1e4), "beads"),
        *lossy("drag, rows", (0.1, 10.0, 1e3), "coupling"),
        *(
            Cell("losses, corners", name, changed(BASE, **{"duration": 10.0, **changes}), ranks=1 + ("ranks" in name))
            for name, changes in _LOSSY.items()
        ),
    ]


_DASHPOTS: Plain = {"damping": {"contact": 0.1}}

_LOSSY: dict[str, Plain] = {
    "dashpots, V 1e-12": {**scaled(BASE, 1e-12), "damping": {"contact": 1e-4}, "duration": 3e3},
    "dashpots, gap": {**_DASHPOTS, "gap": 1.0},
    "dashpots, accuracy 1e-4": {**_DASHPOTS, "accuracy": 1e-4},
    "stuck, accuracy 1e-4": {"damping": {"contact": 10.0}, "accuracy": 1e-4, "duration": 1.0},
    "drag 100, accuracy 1e-4": {"damping": {"beads": 100.0}, "accuracy": 1e-4, "duration": 1.0},
    "dashpots, two ranks": _DASHPOTS,
    "dashpots, walls": {**_DASHPOTS, "walls": {"left": "bead", "right": "rigid"}},
    "dashpots, hard wall": {**_DASHPOTS, "walls": {"left": {"stiffness": 1e4}, "right": "flat"}},
    "dashpots, load": {**_DASHPOTS, "precompression": {"force": 1.0}},
    "drag, load": {"damping": {"beads": 0.1}, "precompression": {"force": 1.0}},
}
"""Losses with other ingredients."""


def masses() -> list[Cell]:
    """Light beads and heavy ones."""
    tapers = {"1e-9": 1e-9, "to 0.001": 0.0764, "to 1e-9": 0.3}
    return [
        *axis(
            "dimer",
            (1e-3, 1e-2, 0.1, 10.0, 1e3, 1e7),
            lambda m: {"kinds": {"one": {}, "other": {"mass": m}}, "pattern": ["one", "other"], "duration": 15.0},
        ),
        *axis(
            "impurity",
            (1e-3, 1e3),
            lambda m: {"kinds": {"other": {"mass": m}}, "replace": {"bead": 10, "kind": "other"}, "duration": 20.0},
        ),
        *(Cell("taper", name, changed(BASE, taper=share, duration=20.0)) for name, share in tapers.items()),
    ]


def exponents() -> list[Cell]:
    """Contacts from springs to walls."""
    return axis("exponent", (1.0, 1.05, 1.25, 2.0, 3.0), lambda p: {"contact": {"exponent": p}, "duration": 20.0})


def drives() -> list[Cell]:
    """From slower than the chain to faster than anything in it; a bead that is moved oscillates by 1."""

    def driven(frequency: float, **drive: float) -> Plain:
        cycles = 1.0 if frequency < 0.01 else 3.0 if frequency < 1.0 else 30.0
        return {"kick": None, "drive": {**drive, "frequency": frequency}, "duration": cycles / frequency}

    return [
        *axis("drive", (1e-3, 0.1, 1.0, 1e3), lambda f: driven(f, displacement=1.0, phase=-90.0)),
        *axis("drive, force", (0.1, 1e3), lambda f: driven(f, force=1.0)),
    ]


# --- all --------------------------------------------------------------------------------------------------------------

PARTS: dict[str, Callable[[], list[Cell]]] = {
    "numbers": numbers,
    "loads": loads,
    "losses": losses,
    "masses": masses,
    "exponents": exponents,
    "drives": drives,
    "corners": corners,
}


def grid(parts: Sequence[str] = ()) -> list[Cell]:
    """Cells of these parts, or of all, axis by axis."""
    return [cell for name, cells in PARTS.items() if not parts or name in parts for cell in cells()]
