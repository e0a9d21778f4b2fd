"""Chains under a static load: sound, and solitary waves on top of the load."""

import math

import numpy as np
from matplotlib.axes import Axes

from analysis.loaded_pulse import LoadedPulse, LoadedWave
from analysis.shape.long_waves import speed_over_sound
from workflow.studies.gallery.criteria import Measured, near, state
from workflow.studies.gallery.entry import COLOURS, PUBLISHED, Entry, Ran, Results, chain
from workflow.studies.page import Statement

LOADS = (0.1, 0.01, 0.003)


def _name(load: float) -> str:
    return f"load-{load:g}"


def _wave(run: Ran) -> LoadedWave:
    found = run.read(LoadedPulse(run.problem)).result()
    assert found is not None
    return found


def statements(results: Results) -> list[Statement]:
    """Sound, then the wave's speed over it at three force ratios."""
    waves = {load: {engine: _wave(run) for engine, run in results[_name(load)].items()} for load in LOADS}
    return [
        state(
            Measured(
                "speed of the wave over that of sound",
                {engine: one.over_sound for engine, one in by_engine.items()},
                near(by_engine["reference"].theory, 1e-3, 0.012 * by_engine["reference"].theory),
                "4",
            ),
            published="Long-wave theory: V_s / c_0 = sqrt((4/15) (3 + 2 f^(5/3) - 5 f^(2/3))) / (f^(2/3) - 1), f = "
            "F_m / F_0.",
            source="nesterenko2001",
            derived=f"F_0 = {load:g}, f = {by_engine['reference'].force_ratio:.2f}: "
            f"{by_engine['reference'].theory:.4f} times c_0 = sqrt(3/2) F_0^(1/6) = "
            f"{math.sqrt(1.5) * load ** (1.0 / 6.0):.4f}.",
            correction="The discrete chain is faster than the long-wave theory, the more so the farther it is from "
            "sound.",
        )
        for load, by_engine in waves.items()
    ]


def draw(axis: Axes, results: Results) -> None:
    """Speed over sound, over the force ratio."""
    every = np.geomspace(1.05, 300.0, 100)
    axis.semilogx(every, speed_over_sound(every), label="Nesterenko", **PUBLISHED)
    waves = [_wave(results[_name(load)]["lammps"]) for load in LOADS]
    axis.semilogx([w.force_ratio for w in waves], [w.over_sound for w in waves], "o", color=COLOURS[0], label="LAMMPS")


ENTRY = Entry(
    title="Waves in precompressed chains",
    introduction="A chain under a constant load has a speed of sound; solitary waves are faster.",
    sources={
        "nesterenko2001": "long-wave theory",
        "coste1997": "abstract read: measured at three static forces",
        "daraio2006": "could not be read",
    },
    scenes={_name(load): chain(120, 105, timestep=0.01, precompression={"force": load}) for load in LOADS},
    statements=statements,
    axes=("largest force / static force", "speed / speed of sound"),
    draw=draw,
    caption="Speed of the pulse over that of sound; the line is the long-wave theory.",
)
