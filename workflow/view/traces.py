"""Velocity of some beads over time: a click into a map, or a choice by the keyboard, adds a bead."""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from bokeh.events import Tap
from bokeh.layouts import column
from bokeh.models import ColumnDataSource, CustomJS, Range1d

from workflow.view.downsample import Thinned, Units
from workflow.view.plots import MARKS, add_legend, chain_name, choice, graph, largest, lists, look, mark

MOST_TRACES = len(MARKS)
"""Lines that are drawn at most; those of one bead where there are more chains."""

FIRST_BEADS = 3
"""Beads that are shown at first, at most."""

_TRACE = """
const distance = places.map(place => Math.abs(place - cb_obj.x));
const i = cb_obj.x === undefined ? beads.indexOf(Number(cb_obj.value)) : distance.indexOf(Math.min(...distance));
const [shown, next] = traces.tags, data = {...traces.data};
if (shown.includes(beads[i])) return;
shown[next] = beads[i];
traces.tags = [shown, (next + 1) % shown.length];
for (let c = 0; c < chains.length; c++) {
  const slot = next * chains.length + c, velocity = images[c].data.velocity[0], values = new Float32Array(time.length);
  let top = 0;
  for (let k = 0; k < time.length; k++) {
    values[k] = velocity[k * beads.length + i];
    if (Math.abs(values[k]) > (Math.abs(values[top]) || 0)) top = k;
  }
  data[columns[slot]] = values;
  if (marks.length) marks[slot].data = {x: [time[top]], y: [values[top]]};
  items[slot].label = {value: `bead ${beads[i]}, chain ${chains[c]}`};
  items[slot].visible = true;
}
traces.data = data;
"""


def traces_of(
    part: Thinned,
    maps: Iterable[Any],
    images: list[ColumnDataSource],
    beads: Sequence[int],
    time_range: Range1d,
    units: Units,
) -> tuple[Any, Any]:
    """A plot, and the same above a choice of beads. Of too many beads the oldest is replaced.

    Colour and dashes of a line are the chain's, its mark is the bead's; those of the bead where there is one chain.

    Args:
        part: of a run's frames, in units of the page.
        maps: plots in which a click adds a bead.
        images: what they show.
        beads: shown at first.
        time_range: of the axis.
        units: of the page.
    """
    chains, several = part.chains, len(part.chains) > 1
    number_of_beads = max(1, MOST_TRACES // len(chains))
    at_first = list(beads[: min(FIRST_BEADS, number_of_beads)])
    shown = [*at_first, *[0] * (number_of_beads - len(at_first))]
    plot = graph("velocity over time", "velocity", units, "velocity", time_range)
    source = ColumnDataSource(name="traces", tags=[shown, len(at_first) % number_of_beads])
    source.data = {"time": part.time.astype(np.float32)}
    columns, marks, items = [], [], []
    for bead_number, bead in enumerate(shown):
        for place, chain in enumerate(chains):
            values = np.full(len(part.time), np.nan)
            if bead:
                values = part.velocity[place, :, int(np.argmin(np.abs(part.beads - bead)))]
            columns.append(f"velocity {bead_number} {place}")
            source.data[columns[-1]] = values.astype(np.float32)
            style = look(place if several else bead_number)
            drawn = [plot.line("time", columns[-1], source=source, name=chain_name(chain), **style)]
            if several:
                marks.append(ColumnDataSource(data=largest(part.time, values)))
                drawn.append(mark(plot, marks[-1], place, bead_number))
                drawn[-1].name = chain_name(chain)
            items.append((f"bead {bead}, {chain_name(chain)}" if bead else "", drawn))
    legend = add_legend(plot, items)
    arguments = {
        **lists(part),
        "images": images,
        "traces": source,
        "columns": columns,
        "marks": marks,
        "items": legend.items,
    }
    add = CustomJS(args=arguments, code=_TRACE)
    for plot_of_chain in maps:
        plot_of_chain.js_on_event(Tap, add)
    options = [str(bead) for bead in part.beads]
    select = choice("add a bead (or click a map)", str(at_first[0]), options, "bead")
    select.js_on_change("value", add)
    return plot, column(plot, select, sizing_mode="stretch_width")
