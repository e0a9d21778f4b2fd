"""Entry of the gallery: scenes, published statements about them, measurements in their runs, and a figure.

`Ran` has the measurements of a run; `workflow.plugins.gallery.criteria` the rule by which a statement is assessed.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from granchain.parts import (
    Floats,
    RunDirectory,
    Survey,
    Trajectory,
    energies,
    engines,
    evaluate,
    forces,
    kept_run,
    leading_waves,
    library,
    page,
    style,
)
from workflow.plugins.gallery.statements import Section, Statement

ENGINES = ("lammps", "reference")
COLOURS = style.CHAIN_COLOURS

# --- runs -------------------------------------------------------------------------------------------------------------


Value = TypeVar("Value")


class Ran(RunDirectory):
    """A run of one scene by one engine."""

    @property
    def errors(self) -> tuple[float, float]:
        """Bounds on the errors of peak velocities (V) and of arrivals (T).

        They are the difference from the reference for LAMMPS, and the uncertainty for the reference.
        """
        errors = engines.engine_called(self.engine).errors(self.job)
        assert errors is not None
        return errors

    @cached_property
    def trajectory(self) -> Trajectory:
        """All frames."""
        return super().trajectory

    @cached_property
    def survey(self) -> Survey:
        """Waves, pulses and energies, each computed when it is first needed."""
        return Survey(self.problem, self.blocks, "maximum")

    @property
    def waves(self) -> leading_waves.Waves:
        """Leading pulse at every bead."""
        return self.survey.passages

    def peak(self, bead: int) -> float:
        """Peak velocity (V) of the leading pulse of chain 1 at a bead."""
        return float(self.waves.of_chain(1).at(bead).peak_velocity[0])

    def arrival(self, bead: int) -> float:
        """Time (T) at which the velocity of the leading pulse of chain 1 at a bead is largest."""
        return float(self.waves.of_chain(1).at(bead).arrival[0])

    def peaks(self, beads: Iterable[float]) -> Floats:
        """Peak velocities (V) of the leading pulse of chain 1 at beads, [bead]."""
        return np.array([self.peak(int(bead)) for bead in beads])

    def passages(self, bead: int) -> Floats:
        """Times (T) of all maxima of the velocity of a bead of chain 1, [passage]."""
        peaks = self.survey.peaks_upwards
        return np.asarray(peaks.time[(peaks.bead == bead) & (peaks.chain == 1)])

    def speed(self, first: int, last: int) -> float:
        """Speed (beads / T) of the leading pulse of chain 1 between two beads."""
        return (last - first) / (self.arrival(last) - self.arrival(first))

    def forces(self, *, contacts: tuple[int, ...] = (), wall: bool = False) -> forces.Readings:
        """Readings of gauges at walls and in contacts (contact n is between bead n and the next)."""
        return forces.read(self.blocks(), self.problem, contacts=contacts, wall=wall)

    @cached_property
    def residual(self) -> float:
        """Share of the energy of the kicked chain's pulse that stays in a cell; NaN where it passed none."""
        residual = evaluate.of_frames(self.problem, self.blocks, self.scene, ("residual_energy",))["residual_energy"]
        return float("nan") if residual is None else residual

    @cached_property
    def flow(self) -> energies.Flow:
        """Energy of the chains over time."""
        return energies.FlowMeter(self.problem).read(self.blocks())

    def width(self, bead: int) -> float:
        """Full width at half maximum of the leading pulse at a bead of chain 1, in beads: duration times speed."""
        run = self.trajectory
        place = int(np.flatnonzero(run.beads == bead)[0])
        velocity, time = run.velocity[:, 0, place], run.time
        half = 0.5 * self.peak(bead)
        above = np.flatnonzero(velocity > half)
        first = int(above[0])
        last = first + int(np.argmin(velocity[first:] > half)) - 1
        rise = np.interp(half, velocity[first - 1 : first + 1], time[first - 1 : first + 1])
        fall = np.interp(-half, -velocity[last : last + 2], time[last : last + 2])
        return float(fall - rise) * self.speed(bead - 5, bead + 5)


Runs = Mapping[str, Ran]
"""Engine -> run of one scene."""

Results = Mapping[str, Runs]
"""Name of a scene of an entry -> its runs."""


def chain(
    beads: int, duration: float, *, timestep: float | None = 0.005, every: float = 0.1, **keys: Any
) -> dict[str, Any]:
    """Plain data of a scene, by default of one chain whose first bead is kicked with V = 1.

    Args:
        beads, duration, timestep: keys of the scene.
        every: time between frames.
        keys: further keys of the scene.
    """
    kick = {} if "striker" in keys else {"kick": {"velocity": 1.0}}
    return {"beads": beads, "duration": duration, "timestep": timestep, "output": {"every": every}, **kick, **keys}


# --- statements -------------------------------------------------------------------------------------------------------

Statements = Iterable[Statement]


def exponent(quantity: Floats, over: Floats) -> float:
    """Exponent of a power law of a quantity, [value], over another one, [value], by least squares of logarithms."""
    return float(np.polyfit(np.log(over), np.log(quantity), 1)[0])


def each(measure: Callable[..., Value], *runs: Runs) -> dict[str, Value]:
    """A quantity by engine, measured in that engine's runs of one scene or of several."""
    return {engine: measure(*(scene_runs[engine] for scene_runs in runs)) for engine in runs[0]}


# --- figures ----------------------------------------------------------------------------------------------------------

PUBLISHED: dict[str, Any] = {"color": "0.45", "linewidth": 1.0, "linestyle": (0, (4, 2))}
"""Style of lines of published or derived values."""


Draw = Callable[[Axes, Results], None]
"""Fills one panel."""


def line(place: int) -> dict[str, Any]:
    """Colour and dashes of one of several curves in a panel, distinct in greyscale, too."""
    return {"color": COLOURS[place], "linestyle": style.CHAIN_DASHES[place]}


@style.styled
def panel(labels: tuple[str, str], draw: Draw, results: Results) -> Figure:
    """A figure of one panel with labelled axes and a legend."""
    figure = style.new_figure(3.4, 6.4)
    axis = figure.subplots()
    draw(axis, results)
    axis.set_xlabel(labels[0])
    axis.set_ylabel(labels[1])
    for setting in (axis.xaxis, axis.yaxis):
        if setting.get_scale() == "log":
            style.label_log_axis(setting)
    if axis.get_legend_handles_labels()[1]:
        axis.legend()
    return figure


# --- entries ----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Entry:
    """One canonical result.

    Attributes:
        title, introduction: head of its section.
        scenes: name -> scene without its name, or the name of an installed one; run by LAMMPS and by the reference.
        statements: runs -> statements with published and measured values.
        axes, draw, caption: labels, contents and caption of a figure of one panel.
        pictures: runs -> figures instead of that one.
        swept: name -> scene that is run by the reference only.
        tables: runs -> files of numbers, name -> text.
        sources: key of the bibliography -> what could be read of the publication.
    """

    title: str
    introduction: str
    scenes: Mapping[str, Mapping[str, Any] | str]
    statements: Callable[[Results], Statements]
    axes: tuple[str, str] = ("", "")
    draw: Draw | None = None
    caption: str = ""
    pictures: Callable[[Results], Sequence[page.PageFigure]] = lambda _: ()
    swept: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    tables: Callable[[Results], Mapping[str, str]] = lambda _: {}
    sources: Mapping[str, str] = field(default_factory=dict)

    def build(self, folder: Path) -> Section:
        """Run the scenes that no earlier start has run, and measure all runs.

        Args:
            folder: directory of the run directories.

        Raises:
            RunError: a run failed.
        """
        results: dict[str, Runs] = {}
        for name, plain in {**self.scenes, **self.swept}.items():
            scene = library.find(plain) if isinstance(plain, str) else library.from_plain({"name": name, **plain}, name)
            results[name] = {
                engine: Ran(kept_run(scene, engine, folder / f"{scene.name}-{engine}").path)
                for engine in (ENGINES if name in self.scenes else ENGINES[1:])
            }
        notes = [_own_errors(results)] if results else []
        pictures = [*self.pictures(results)]
        if self.draw is not None:
            pictures.append(page.drawn("figure", panel(self.axes, self.draw, results), self.caption))
        statements, tables = list(self.statements(results)), self.tables(results)
        return Section(self.title, self.introduction, statements, pictures, notes, self.sources, tables)


LARGE = 1e-3
AMPLIFIED = (
    " In these chains light beads behind the pulse amplify any error of their velocities; the statements are about "
    "the leading pulse."
)


def _own_errors(results: Results) -> str:
    """Sentence on the measured errors of the scenes that both engines ran."""
    both = [runs for runs in results.values() if set(runs) == set(ENGINES)]
    # fmax: two beads have no leading pulse, so that its errors are NaN
    lammps, reference = (np.fmax.reduce([runs[engine].errors for runs in both]) for engine in ENGINES)
    if np.isnan(lammps[0]):
        return f"Measured error of these runs: any velocity of the reference is within {reference[0]:.1e} V."
    return (
        "Measured error of these runs: the peaks of LAMMPS's leading pulse are off by at most "
        f"{lammps[0]:.1e} V at any bead, its arrivals by {lammps[1]:.1e} T; any velocity of the reference, also behind "
        f"the pulse, is within {reference[0]:.1e} V, its arrivals within {reference[1]:.1e} T."
        + AMPLIFIED
        * bool(reference[0] > LARGE)
    )
