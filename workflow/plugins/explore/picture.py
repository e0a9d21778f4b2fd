"""Plots of a computed scene: maps, the velocity of a bead, peak velocities, energies; renewed in place."""

from typing import Any

import numpy as np
from bokeh.events import Tap
from bokeh.layouts import column, row
from bokeh.models import ColumnDataSource, HoverTool, Range1d, Span

from granchain.parts import Fact, Floats, analyse, panels, spacetime
from workflow.plugins.explore.compute import ComputedScene
from workflow.plugins.pages import run_page
from workflow.plugins.pages.downsample import Thinned, units_of
from workflow.plugins.pages.plots import (
    add_legend,
    chain_name,
    choice,
    ends,
    graph,
    image_source,
    look,
    maps_of,
    root_colours,
)
from workflow.plugins.pages.units import axis_of
from workflow.plugins.pages.write import themed

NARROWEST = 330
"""Pixels of a plot of lines; two stand side by side where there is room."""

BRIGHTER, DARKER = 1.25, 0.5
"""Velocities that new ones may have over those that the colours are for, before these are chosen anew."""


class Picture:
    """Plots of one tab.

    Args:
        result: what they show first.
        bead: bead whose velocity over time is shown, if it is there; by default the middle one of a figure.

    Attributes:
        root: layout of all plots.
    """

    def __init__(self, result: ComputedScene, bead: int | None = None) -> None:
        problem = result.problem
        self._units = units_of(problem, result.part)
        part = self._part = result.part.measured(self._units)
        self._images = [_image(part, place) for place in range(len(part.chains))]
        self._limit = spacetime.RootScale.of(problem, part.beads, part.velocity).limit
        self._symbols = _symbols(result)
        self._time_range = Range1d(*ends(part.time, part.every), bounds=ends(part.time, part.every))
        places = ends(part.places, part.spacing)
        place_range = Range1d(*places, bounds=places)
        ranges = (place_range, self._time_range)
        maps = maps_of(problem, part, self._images, root_colours(self._limit), self._units, ranges)
        self._maps = [plot for line in maps for plot in line]
        self._trace, self._select, traces = self._traces(bead or _middle_bead(result))
        graphs = [traces]
        self._peaks: Any = None
        if _has_pulse(result):
            title = "peak velocity of the leading pulse"
            beads = ends(problem.rows.numbers.astype(np.float64), 1.0)
            bead_range = place_range if part.even else Range1d(*beads, bounds=beads)
            self._peaks = graph(title, "peaks", panels.BEAD, axis_of("velocity", self._units), bead_range)
            self._draw(self._peaks, _peaks(result, part, self._units["velocity"].worth))
            graphs.append(self._peaks)
        self._energy = run_page.energy(part, self._time_range, self._units) if problem.rows.complete else None
        graphs += [] if self._energy is None else [self._energy]
        for plot in graphs:
            plot.styles = {"flex": f"1 1 {NARROWEST}px"}
        wrapped = row(*graphs, styles={"flex-wrap": "wrap"}, sizing_mode="stretch_width")
        self.root = column(*map(_side_by_side, maps), wrapped, sizing_mode="stretch_width")
        plots = [*self._maps, self._trace, *(plot for plot in (self._peaks, self._energy) if plot is not None)]
        for plot in plots:
            plot.center = [drawn for drawn in plot.center if not isinstance(drawn, Span)]  # of the page of a run
        theme = themed(self.root, problem.name)
        for plot in plots:
            plot.js_on_change("inner_width", theme)  # once, when it is laid out

    @property
    def bead(self) -> int:
        """Bead whose velocity over time is shown."""
        return int(self._select.value)

    def renew(self, result: ComputedScene) -> bool:
        """Show another result in the same plots; false where it needs others."""
        problem, units = result.problem, units_of(result.problem, result.part)
        part = result.part.measured(units)
        limit = spacetime.RootScale.of(problem, part.beads, part.velocity).limit
        same = (part.chains, part.beads.tolist(), _symbols(result), problem.rows.complete, _has_pulse(result)) == (
            self._part.chains,
            self._part.beads.tolist(),
            self._symbols,
            self._energy is not None,
            self._peaks is not None,
        )
        if not same or not DARKER * self._limit <= limit <= BRIGHTER * self._limit:
            return False
        before, self._part = self._part, part
        for place, image in enumerate(self._images):
            image.data = dict(_image(part, place).data)
        if not np.array_equal(before.time, part.time):
            self._renew_times()
        self._renew(self._trace, self._velocities())
        if self._peaks is not None:
            self._renew(self._peaks, _peaks(result, part, units["velocity"].worth))
        if self._energy is not None:
            self._renew(self._energy, [(part.time, energy) for energy in part.energy])
        return True

    def _renew_times(self) -> None:
        """Give axes and cursors the times of other frames."""
        start, end = ends(self._part.time, self._part.every)
        self._time_range.update(start=start, end=end, bounds=(start, end))
        for plot in self._maps:
            formatter = next(tool for tool in plot.tools if isinstance(tool, HoverTool)).formatters["$y"]
            formatter.args = {**formatter.args, "time": self._part.time.tolist()}

    def _traces(self, bead: int) -> tuple[Any, Any, Any]:
        """Plot of a bead's velocity, the choice of the bead, and both in a column; a click on a map chooses, too."""
        beads = self._part.beads
        axes = axis_of("time", self._units), axis_of("velocity", self._units)
        plot = graph("velocity over time", "velocity", *axes, self._time_range)
        nearest = str(beads[int(np.argmin(np.abs(beads - bead)))])
        select = choice("bead (or click a map)", nearest, [str(number) for number in beads], "bead")
        self._select = select
        self._draw(plot, self._velocities())
        select.on_change("value", lambda _attribute, _before, _now: self._renew(plot, self._velocities()))
        for chain in self._maps:
            chain.on_event(Tap, self._choose)
        return plot, select, column(plot, select, sizing_mode="stretch_width")

    def _choose(self, event: Any) -> None:
        """Choose the bead at the place of a click."""
        self._select.value = str(self._part.beads[int(np.argmin(np.abs(self._part.places - event.x)))])

    def _velocities(self) -> list[tuple[Floats, Floats]]:
        """Times and velocities of the chosen bead, for each chain that is shown."""
        place = self._part.beads.tolist().index(self.bead)
        return [(self._part.time, velocity[:, place]) for velocity in self._part.velocity]

    def _draw(self, plot: Any, lines: list[tuple[Floats, Floats]]) -> None:
        """Draw a line for each chain that is shown, with a legend."""
        items = []
        for place, (chain, (x, y)) in enumerate(zip(self._part.chains, lines, strict=True)):
            source = ColumnDataSource({"x": x, "y": y})
            items.append(
                (chain_name(chain), [plot.line("x", "y", source=source, name=chain_name(chain), **look(place))])
            )
        add_legend(plot, items)

    def _renew(self, plot: Any, lines: list[tuple[Floats, Floats]]) -> None:
        """Draw other lines in place of those of `_draw`."""
        for line, (x, y) in zip(plot.renderers, lines, strict=True):
            line.data_source.data = {line.glyph.x: x, line.glyph.y: y}


def _side_by_side(maps: list[Any]) -> Any:
    """Maps of one line, whose areas are equally wide; a `GridPlot` that is added to a page later has no size."""
    for plot in maps:
        beside = run_page.TIME_AXIS * (plot is maps[0]) + run_page.BAR * (plot is maps[-1])
        plot.styles = {"flex": f"1 1 {beside}px", "min-width": "0"}
        if plot is maps[-1] and not plot.right:
            plot.min_border_right = run_page.BAR
        plot.toolbar_location = "above"
        plot.toolbar.update(logo=None, autohide=True)
    return row(*maps, sizing_mode="stretch_width")


def _image(part: Thinned, place: int) -> ColumnDataSource:
    """A chain's map of velocities alone."""
    source = image_source(part, place)
    source.data = {name: values for name, values in source.data.items() if name not in ("overlap", "force")}
    return source


def _symbols(result: ComputedScene) -> list[str]:
    """Symbols of the units that the plots show."""
    return [unit.symbol for unit in units_of(result.problem, result.part).values()]


def _has_pulse(result: ComputedScene) -> bool:
    return result.problem.system.holds(Fact.PULSE)


def _middle_bead(result: ComputedScene) -> int:
    beads = analyse.default_beads(result.problem)
    return beads[len(beads) // 2]


def _peaks(result: ComputedScene, part: Thinned, worth: float) -> list[tuple[Floats, Floats]]:
    """Recorded beads and peak velocities of the leading wave there, NaN where there is none, for each chain shown."""
    beads = result.problem.rows.numbers
    lines = []
    for chain in part.chains:
        waves = result.survey.waves.of_chain(chain)
        peaks = np.full(len(beads), np.nan)
        peaks[np.searchsorted(beads, waves.bead)] = waves.peak_velocity * worth
        lines.append((beads.astype(np.float64), peaks))
    return lines
