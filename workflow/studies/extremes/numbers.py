"""Cells of a plain scene's numbers: along each axis one goes to its extremes; corners combine several."""

import math
from typing import Any

from lammps_inputs import library
from lammps_inputs.limits.timestep import stability_bound
from workflow.engines.lammps.mpi import cores
from workflow.studies.extremes.cells import BASE, Cell, Plain, changed, decades, scaled, springs

STEEL: Plain = {"radius": 4.76e-3, "density": 8000.0, "youngs_modulus": 193e9, "poisson_ratio": 0.3}
JELLY: Plain = {"radius": 1e-6, "density": 1000.0, "youngs_modulus": 100.0, "poisson_ratio": 0.5}
DIAMOND: Plain = {"radius": 100.0, "density": 3500.0, "youngs_modulus": 1.2e12, "poisson_ratio": -0.9}


def numbers() -> list[Cell]:
    """Axis by axis."""
    return [
        *(Cell("V", f"{v:g}", scaled(BASE, v), scaling=True) for v in decades(-12, 12, 3)),
        *(_kappa(k) for k in (0.0, *decades(-8, 4, 2), 1e13)),
        *(_step(f) for f in (1e-4, 1e-2, 0.1, 0.5, 0.9, 0.99, 1.01, 3.0)),
        *(_step(f, force=True) for f in (1.01, 1.2, 1.5, 3.0)),
        *(_accuracy(a) for a in (0.1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8)),
        *(Cell("chains", str(n), changed(BASE, chains=n, beads=20, duration=20.0)) for n in (1, 2, 3, 10, 100, 1000)),
        *(_beads(n) for n in (2, 3, 10, 100, 1000, 10_000, 100_000)),
        *(_window(n) for n in (100, 1000, 3000, 10_000)),
        *(_gap(d) for d in (0.0, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e9)),
        *(Cell("diameter", f"2^{p}", BASE, diameter=2.0**p) for p in (0, 1, 2, 10, 20, 25, 30, 35, 40)),
        *(_duration(n) for n in (10**3, 10**4, 10**5, 10**6)),
        *(Cell("ranks", str(n), BASE, ranks=n) for n in (0, 1, 2, cores() + 1)),
    ]


def _kappa(kappa: float) -> Cell:
    """Stiff springs need many steps: a run of as many swings is shorter."""
    duration = 30.0 if kappa <= 1e2 else 2.0
    return Cell("kappa", f"{kappa:g}", changed(BASE, coupling=springs(kappa), duration=duration))


def _step(share: float, *, force: bool = False) -> Cell:
    """A time step as a share of the largest stable one, with frames about 0.1 apart."""
    step = share * stability_bound(library.from_plain(BASE, "base").system)
    output: Plain = {"every": step * max(1, round(0.1 / step))}
    name = f"{share:g} forced" if force else f"{share:g}"
    return Cell("step / bound", name, changed(BASE, timestep=step, output=output), force=force)


def _accuracy(accuracy: float) -> Cell:
    duration = 30.0 if accuracy >= 1e-5 else 10.0
    return Cell("accuracy", f"{accuracy:g}", changed(BASE, accuracy=accuracy, duration=duration))


def _beads(beads: int) -> Cell:
    """The pulse runs to the end of up to 1,000 beads; in longer chains it starts 10 beads from the end."""
    if beads <= 1000:
        return Cell("beads", f"{beads:,}", changed(BASE, beads=beads, duration=1.2 * beads + 10.0))
    far = {"bead": beads - 10, "velocity": 1.0}
    return Cell("beads", f"{beads:,}", changed(BASE, beads=beads, kick=far, duration=20.0, output={"every": 2.0}))


def _window(beads: int) -> Cell:
    """The pulse runs most of the way, and only the rows near it exist."""
    chains: Plain = {"chains": 1, "coupling": None} if beads > 3000 else {}
    times: Plain = {"duration": 1.15 * beads, "output": {"every": 0.5}}
    return Cell("beads, window", f"{beads:,}", changed(BASE, **chains, beads=beads, window="auto", **times))


def _gap(gap: float) -> Cell:
    """Two beads far apart meet once; a pulse crosses four that are near.

    A flight as long as 1e6 needs long steps: at the end, a velocity is off by no more than in the contact.
    """
    if gap > 1e3:
        lone: Plain = {"chains": 1, "beads": 2, "coupling": None, "timestep": 0.25, "output": {"every": gap / 1000.0}}
        towards = [{"velocity": 1.0}, {"velocity": -1.0, "bead": 2}]
        return Cell("gap", f"{gap:g}", changed(BASE, **lone, kick=towards, gap=gap, duration=0.51 * gap))
    times: Plain = {"duration": 10.0 + 5.0 * gap, "output": {"every": max(0.1, gap / 1000.0)}}
    return Cell("gap", f"{gap:g}", changed(BASE, beads=4, coupling=springs(1e-6), gap=gap or None, **times))


def _duration(steps: int) -> Cell:
    """A single pulse that is under way all the time; the step is the shorter, the more there are."""
    step = min(0.01, 500.0 / steps)
    duration = steps * step
    length: Plain = {"beads": round(0.85 * duration) + 10, "chains": 1, "coupling": None}
    output: Plain = {"every": step * max(1, round(0.5 / step))}
    scene = changed(BASE, **length, duration=duration, timestep=step, output=output)
    return Cell("steps", f"{steps:,}", scene, drift=True)


def _five_frames_a_swing() -> Plain:
    """Frames 0.05 apart all show one phase of the springs' swing."""
    kappa = 0.5 * (2.0 * math.pi / 0.05) ** 2
    return {"coupling": springs(kappa), "accuracy": 1e-3, "duration": 1.0, "output": {"every": 0.01}}


def corners() -> list[Cell]:
    """Several numbers at once."""

    def corner(value: str, *, like: Plain = BASE, scaling: bool = False, drift: bool = False, **changes: Any) -> Cell:
        return Cell("corners", value, changed(like, **changes), scaling=scaling, drift=drift)

    touching = changed(BASE, coupling=springs(1.0))
    head_on = [{"velocity": 1.0}, {"velocity": -1.0, "bead": 30}]
    every_bead = [{"velocity": (-1.0) ** (i + j), "chain": j, "bead": i} for i in range(1, 31) for j in (1, 2)]
    stiff: Plain = {"coupling": springs(1e4), "timestep": 2e-4, "output": {"every": 0.1}}
    slow: Plain = {"chains": 1, "coupling": None, "material": JELLY}
    return [
        corner("V 1e-12, springs 0.1", kick={"velocity": 1e-12}, duration=1e3),
        corner("V 1e12, springs 0.1", kick={"velocity": 1e12}, duration=0.1),
        corner("V 1e-12, gap 1", kick={"velocity": 1e-12}, gap=1.0, duration=1e4),
        corner("V 1e12, gap 1e6", like=scaled(changed(BASE, gap=1e6 * 1e12**-0.8), 1e12), scaling=True),
        corner("V 1e-30", like=scaled(BASE, 1e-30), scaling=True),
        corner("V 1e30", like=scaled(BASE, 1e30), scaling=True),
        corner("kappa 1e4, 1000 chains, long step", chains=1000, beads=4, duration=2.0, **stiff),
        corner("kappa 1e4, 1000 chains, default step", chains=1000, beads=4, duration=0.1, coupling=springs(1e4)),
        corner(
            "kappa 1e4, bead 10,000, long step",
            beads=10_000,
            kick={"bead": 9990, "velocity": 1.0},
            duration=0.5,
            **stiff,
        ),
        corner("kappa 1e12", coupling=springs(1e12), duration=1e-3, output={"every": 1e-6}),
        corner("both ends, chain 1", kick=head_on),
        corner("both ends, two chains", kick=[head_on[0], {**head_on[1], "chain": 2}]),
        corner("backwards from bead 1", kick={"velocity": -1.0}),
        corner("backwards from bead 30", kick={"velocity": -1.0, "bead": 30}),
        corner("backwards, gap", kick={"velocity": -1.0}, gap=1.0),
        corner("all beads, +1 and -1", kick=every_bead),
        corner("kicks 1 and 1e-12", kick=[{"velocity": 1.0}, {"velocity": 1e-12, "bead": 20, "chain": 2}]),
        corner("one recorded bead", output={"beads": [17]}),
        corner("frames 10 T apart", beads=100, duration=100.0, output={"every": 10.0}),
        corner("one step", duration=1e-3, timestep=1e-3, output={"every": 1e-3}),
        corner(
            "far, short steps, gap",
            like=touching,
            gap=1e6,
            kick={"velocity": 1.0, "bead": 25},
            timestep=1e-5,
            duration=2.0,
        ),
        corner("suzuki4", scheme="suzuki4"),
        corner("suzuki4, kappa 100", scheme="suzuki4", coupling=springs(100.0)),
        corner("suzuki4, step 0.15", scheme="suzuki4", timestep=0.15, output={"every": 0.75}),
        corner("window, past the end", beads=500, coupling=springs(0.01), window=64, duration=1300.0),
        corner("window, kappa 0.001", beads=500, coupling=springs(1e-3), window="auto", duration=600.0),
        corner("window, accuracy 1e-5", beads=200, window="auto", accuracy=1e-5, duration=200.0),
        corner("accuracy, kappa 1e4", coupling=springs(1e4), accuracy=1e-3, duration=2.0),
        corner("accuracy, a swing each 5 frames", **_five_frames_a_swing()),
        corner("accuracy, gap", gap=10.0, beads=6, accuracy=1e-4, duration=200.0),
        corner("until bead 25", duration=None, until_bead=25),
        corner("until bead 25, uncoupled", coupling=springs(1e-8), duration=None, until_bead=25),
        corner("two rows, 1e6 steps", beads=2, duration=1e4, output={"every": 1.0}),
        corner("ten rows, 1e6 steps", beads=10, duration=1e4, output={"every": 1.0}, drift=True),
        corner("steel, 1 nm/s", material=STEEL, kick={"velocity": 1e-9}, coupling=springs(6e2), duration=0.024),
        corner("jelly, 1 um", **slow, kick={"velocity": 1e-3}, duration=1e-2, scaling=True),
        corner("diamond, 100 m", **{**slow, "material": DIAMOND}, kick={"velocity": 1e-6}, duration=60.0, scaling=True),
        corner("units overflow", **{**slow, "material": {**STEEL, "density": 1e30, "radius": 1e30}}),
    ]
