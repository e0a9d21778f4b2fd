"""Chains pressed together: sound, and solitary waves on top of the load."""

import math

import numpy as np
from matplotlib.axes import Axes

from analysis.shape.loaded_wave import speed_over_sound
from analysis.sound.loaded_pulse import LoadedPulse, LoadedWave
from workflow.studies.gallery.entry import COLOURS, PUBLISHED, Entry, Ran, Results, Statement, chain, number

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
    found = []
    for load, by_engine in waves.items():
        wave = by_engine["reference"]
        found.append(
            number(
                f"At F_m / F_0 = {wave.force_ratio:.2f} the wave is {wave.theory:.4f} times as fast as sound, "
                f"c_0 = sqrt(3/2) F_0^(1/6) = {math.sqrt(1.5) * load ** (1.0 / 6.0):.4f}.",
                wave.theory,
                {engine: one.over_sound for engine, one in by_engine.items()},
                within=1e-3,
                roughly=0.012 * wave.theory,
                form="4",
                correction="The discrete chain is faster than the long-wave theory, the more so the farther it is "
                "from sound.",
            )
        )
    return found


def draw(axis: Axes, results: Results) -> None:
    """Speed over sound, over the force ratio."""
    every = np.geomspace(1.05, 300.0, 100)
    axis.semilogx(every, speed_over_sound(every), label="Nesterenko", **PUBLISHED)
    waves = [_wave(results[_name(load)]["lammps"]) for load in LOADS]
    axis.semilogx([w.force_ratio for w in waves], [w.over_sound for w in waves], "o", color=COLOURS[0], label="LAMMPS")


ENTRY = Entry(
    title="Waves in precompressed chains",
    introduction="A chain under a constant load has a speed of sound; solitary waves run ahead of it.",
    sources={
        "nesterenko2001": "long-wave theory",
        "coste1997": "abstract read: measured at three static forces",
        "daraio2006": "could not be read",
    },
    scenes={_name(load): chain(120, 105, timestep=0.01, precompression={"force": load}) for load in LOADS},
    statements=statements,
    axes=("largest force over that at rest", "speed over that of sound"),
    draw=draw,
    caption="Speed of the pulse over that of sound; the line is the long-wave theory.",
)
