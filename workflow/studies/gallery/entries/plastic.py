"""Contacts that yield: restitution of two beads, a wave that decays along a chain, and two chains that share it."""

import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from analysis.contacts import YieldMeter
from lammps_inputs.laws.plastic import restitution_of
from workflow.studies.gallery.criteria import Measured, at_least, at_most, near, state
from workflow.studies.gallery.entry import COLOURS, PUBLISHED, Entry, Ran, Results, chain, each
from workflow.studies.page import Statement

RATIOS = {f"pair-{number}": ratio for number, ratio in enumerate((0.5, 5.0, 50.0, 500.0, 5000.0), 1)}
"""Velocity of approach over that at which two beads yield."""

YIELD = {"yield": {"overlap": 0.1}}
TWO: dict[str, Any] = {"chains": 2, "coupling": {"stiffness": 0.1}}


def _onset(ratio: float) -> float:
    """Overlap at yield of beads that meet with V: ``v_y^2 = 0.8 A d_y^2.5 / m*`` with m* = 1/2."""
    return float((ratio**-2 / 1.6) ** 0.4)


def _restitution(run: Ran) -> float:
    first, second = run.trajectory.velocity[-1, 0]
    return float(second - first)


def _off(name: str, run: Ran) -> float:
    return abs(_restitution(run) - float(restitution_of(RATIOS[name], 1.0)))


def _decay(first: int, last: int, run: Ran) -> float:
    """Exponent of the largest force over the number of the contact."""
    found = run.read(YieldMeter()).result()
    assert found is not None
    number = np.arange(first, last)
    return float(np.polyfit(np.log(number), np.log(found[1].force[number - 1]), 1)[0])


def _pulses(run: Ran) -> float:
    return float(run.train(40).pulses)


def _agree(run: Ran) -> float:
    """Bead from which on the amplitudes of both chains agree to 1 % up to bead 100."""
    waves = (run.waves.of_chain(number) for number in (1, 2))
    one, other = (wave.peak_velocity[(wave.bead >= 4) & (wave.bead <= 100)] for wave in waves)
    apart = np.flatnonzero(np.abs(one - other) > 0.005 * (one + other))
    return float(apart[-1] + 5)


def statements(results: Results) -> list[Statement]:
    """Restitution, decay, trains, and equipartition."""
    pairs = {name: results[name] for name in RATIOS}
    worst = {engine: max(_off(name, runs[engine]) for name, runs in pairs.items()) for engine in results["pair-1"]}
    slope = {
        engine: math.log(_restitution(results["pair-5"][engine]) / _restitution(results["pair-4"][engine]))
        / math.log(10.0)
        for engine in worst
    }
    single, plastic, elastic = results["chain"], results["two-plastic"], results["two-elastic"]
    return [
        state(
            Measured("largest deviation from Thornton's closed form", worst, at_most(1e-3), "1e"),
            derived="The restitution of two beads follows from their velocity over that at yield, over four decades.",
        ),
        state(
            Measured("exponent between 500 and 5000 times the velocity at yield", slope, near(-0.25, 2e-3), "4"),
            derived="Far beyond yield the restitution falls as v^(-1/4).",
        ),
        state(
            Measured("pulses that pass bead 40", each(single, _pulses), at_least(2.0), "0"),
            published="In elasto-plastic chains energy dissipation leads to the formation of wave trains.",
            source="pal2013, abstract",
        ),
        state(
            Measured("exponent, contacts 5 to 20", each(single, lambda run: _decay(5, 20, run)), at_most(-0.6), "3"),
            Measured("contacts 60 to 80", each(single, lambda run: _decay(60, 80, run)), at_least(-0.5), "3"),
            derived="The largest force falls along the chain, and the more slowly the nearer its overlap comes to that "
            "at yield, below which no energy is lost: there is no one power law.",
        ),
        state(
            Measured("bead from which on amplitudes agree to 1 %", each(plastic, _agree), near(33.0, 1.0), "0"),
            Measured("of elastic chains", each(elastic, _agree), near(62.0, 1.0), "0"),
            derived="Two coupled plastic chains reach equipartition, and earlier than elastic ones: the larger wave "
            "loses more.",
            also=[
                Measured(
                    "amplitude at bead 100", each(plastic, lambda run: run.peak(100)), near(0.0641, 5e-4), "4 V"
                ).line()
            ],
        ),
    ]


def draw(axis: Axes, results: Results) -> None:
    """Restitution over velocity."""
    every = np.geomspace(0.3, 1e4, 200)
    axis.loglog(every, restitution_of(every, 1.0), label="Thornton, closed form", **PUBLISHED)
    for engine, colour, label in (("lammps", COLOURS[0], "LAMMPS"), ("reference", COLOURS[1], "reference")):
        found = [_restitution(results[name][engine]) for name in RATIOS]
        axis.loglog(list(RATIOS.values()), found, "o+"[engine == "reference"], color=colour, label=label)


ENTRY = Entry(
    title="Contacts that yield",
    introduction="Elastic, perfectly plastic spheres: two that collide, a kicked chain whose wave decays, and two "
    "coupled chains (kappa = 0.1), of which one is kicked; overlap at yield 0.1 L.",
    sources={
        "thornton1997": "title read; the restitution is derived here from the law",
        "pal2013": "abstract read: formation and merging of wave trains, scaling laws",
    },
    scenes={
        **{
            name: chain(2, 12, contact={"yield": {"overlap": _onset(ratio)}}, every=0.1)
            for name, ratio in RATIOS.items()
        },
        "chain": chain(100, 175, timestep=0.02, contact=YIELD),
        "two-plastic": chain(112, 195, timestep=0.02, contact=YIELD, **TWO),
    },
    swept={"two-elastic": chain(130, 170, timestep=0.02, **TWO)},
    statements=statements,
    axes=("velocity of approach / velocity at yield", "restitution"),
    draw=draw,
    caption="Restitution of two equal beads over four decades of velocity.",
)
