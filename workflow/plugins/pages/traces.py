"""Velocity of some beads over time: a click into a map, or a choice by the keyboard, adds a bead."""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from bokeh.events import Tap
from bokeh.layouts import row
from bokeh.models import ColumnDataSource, CustomJS, DataRange1d, Legend, Range1d, Select

from granchain.parts import panels
from granchain.parts import units as labels
from workflow.plugins.pages.downsample import Thinned
from workflow.plugins.pages.plots import (
    MARKS,
    add_legend,
    chain_name,
    choice,
    graph,
    label_of,
    largest,
    lists,
    look,
    mark,
)
from workflow.plugins.pages.units import Units, axis_of

MOST_TRACES = len(MARKS)
"""Lines that are drawn at most; those of one bead where there are more chains."""

FIRST_BEADS = 3
"""Beads that are shown at first, at most."""

ALL = "all"
"""Choice of all chains."""

_TRACE = """
const chosen = maps.indexOf(cb_obj.origin);
if (chosen >= 0) {  // a click chooses what is under it
  const distance = places.map(place => Math.abs(place - cb_obj.x));
  const clicked = String(beads[distance.indexOf(Math.min(...distance))]);
  if (chain && chain.value != all) chain.value = String(chains[chosen]);
  if (bead.value != clicked) { bead.value = clicked; return; }
}
const i = beads.indexOf(Number(bead.value)), data = {...traces.data};
const [shown, next] = traces.tags, is_new = !shown.includes(beads[i]);
const slot = is_new ? next : shown.indexOf(beads[i]);
shown[slot] = beads[i];
if (is_new) traces.tags = [shown, (next + 1) % shown.length];
for (let c = 0; c < chains.length; c++) {
  const line = slot * chains.length + c, wanted = !chain || [all, String(chains[c])].includes(chain.value);
  if (!wanted && !is_new) continue;
  let top = 0;
  for (const [kind, names] of Object.entries(columns)) {
    const numbers = images[c].data[kind][0], values = new Float32Array(time.length).fill(NaN);
    for (let k = 0; wanted && k < time.length; k++) {
      values[k] = numbers[k * beads.length + i];
      if (kind == 'velocity' && Math.abs(values[k]) > (Math.abs(values[top]) || 0)) top = k;
    }
    data[names[line]] = values;
  }
  const highest = wanted ? [[time[top]], [data[columns.velocity[line]][top]]] : [[], []];
  if (marks.length) marks[line].data = {x: highest[0], y: highest[1]};
  for (const items of legends.map(legend => legend.items)) {
    items[line].label = {value: wanted ? `bead ${beads[i]}, chain ${chains[c]}` : ''};
    items[line].visible = wanted;
  }
}
traces.data = data;
"""


class TracePlot:
    """Velocities of chosen beads over time and, of runs in which beads oscillate, over their displacements.

    Colour and dashes of a line are the chain's, its mark is the bead's; those of the bead where there is one chain. Of
    too many beads the oldest is replaced.

    Attributes:
        plots: of the lines.
        bead, chain: choices of what is added; the latter is None where there is one chain.
        choices: both, side by side.
    """

    def __init__(self, part: Thinned, beads: Sequence[int], time_range: Range1d, units: Units, *, phase: bool) -> None:
        """Draw some beads.

        Args:
            part: of a run's frames, in units of the page.
            beads: shown at first.
            time_range: of the axis.
            units: of the page.
            phase: whether to draw velocities over displacements, too.
        """
        self._part = part
        several = len(part.chains) > 1
        number_of_beads = max(1, MOST_TRACES // len(part.chains))
        at_first = list(beads[: min(FIRST_BEADS, number_of_beads)])
        self._shown = [*at_first, *[0] * (number_of_beads - len(at_first))]
        self._source = ColumnDataSource(name="traces", tags=[self._shown, len(at_first) % number_of_beads])
        self._source.data = {"time": part.time.astype(np.float32)}
        self._marks: list[ColumnDataSource] = []
        self._columns = {"velocity": self._filled("velocity")}
        over_time = graph(
            "velocity over time", "velocity", axis_of("time", units), axis_of("velocity", units), time_range
        )
        self._legends = [self._drawn(over_time, ["time"] * len(self._columns["velocity"]))]
        self.plots = [over_time]
        if phase:
            self._columns["displacement"] = self._filled("displacement")
            self.plots.append(self._phase_portrait(units))
        self.bead = choice("add a bead (or click a map)", str(at_first[0]), [str(bead) for bead in part.beads], "bead")
        self.chain: Select | None = None
        if several:
            chains = [(ALL, ALL), *((str(chain), str(chain)) for chain in part.chains)]
            self.chain = choice("of chain", ALL, chains, "chain")
        self.choices = row(*filter(None, (self.bead, self.chain)), styles={"flex-wrap": "wrap"})

    def follow(self, maps: Iterable[Any], images: list[ColumnDataSource]) -> None:
        """Add the bead that is clicked in a map or chosen.

        Args:
            maps: plots of the chains.
            images: what they show.
        """
        plots = list(maps)
        arguments = {
            **lists(self._part),
            "maps": plots,
            "images": images,
            "traces": self._source,
            "columns": self._columns,
            "marks": self._marks,
            "legends": self._legends,
            "bead": self.bead,
            "chain": self.chain,
            "all": ALL,
        }
        add = CustomJS(args=arguments, code=_TRACE)
        for plot in plots:
            plot.js_on_event(Tap, add)
        for select in filter(None, (self.bead, self.chain)):
            select.js_on_change("value", add)

    def _filled(self, kind: str) -> list[str]:
        """Names of columns of velocities or displacements, a column for each bead and chain, filled for those shown."""
        part, names = self._part, []
        for bead_number, bead in enumerate(self._shown):
            for place in range(len(part.chains)):
                values = np.full(len(part.time), np.nan)
                if bead:
                    values = getattr(part, kind)[place, :, int(np.argmin(np.abs(part.beads - bead)))]
                names.append(f"{kind} {bead_number} {place}")
                self._source.data[names[-1]] = values.astype(np.float32)
        return names

    def _drawn(self, plot: Any, x: Sequence[str], *, marked: bool = True) -> Legend:
        """Draw velocities over columns of the source, a line for each bead and chain; the legend."""
        part, several = self._part, len(self._part.chains) > 1
        items = []
        for line, (over, column) in enumerate(zip(x, self._columns["velocity"], strict=True)):
            bead_number, place = divmod(line, len(part.chains))
            chain, bead = part.chains[place], self._shown[bead_number]
            style = look(place if several else bead_number)
            drawn = [plot.line(over, column, source=self._source, name=chain_name(chain), **style)]
            if several and marked:
                self._marks.append(ColumnDataSource(data=largest(part.time, self._source.data[column])))
                drawn.append(mark(plot, self._marks[-1], place, bead_number))
                drawn[-1].name = chain_name(chain)
            items.append((f"bead {bead}, {chain_name(chain)}" if bead else "", drawn))
        return add_legend(plot, items)

    def _phase_portrait(self, units: Units) -> Any:
        """Velocities over displacements."""
        x = panels.Axis(labels.Label(label_of("displacement", units)))
        plot = graph("phase portrait", "phase", x, axis_of("velocity", units), DataRange1d())
        self._legends.append(self._drawn(plot, self._columns["displacement"], marked=False))
        return plot
