"""Tools that save the numbers behind a plot as CSV, with the units of its axes in the head."""

import base64
from collections.abc import Mapping, Sequence
from typing import Any

from bokeh.models import ColumnDataSource, CustomAction, CustomJS, Select

_DRAWN = (
    "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 24 24' fill='none' stroke='#808080' stroke-width='1.5'>"
    "<path d='M4 5h16v14H4zM4 10h16M4 14.5h16M10 5v14'/></svg>"
)
_ICON = f"data:image/svg+xml;base64,{base64.b64encode(_DRAWN.encode()).decode()}"
"""A table, in a grey that is seen in both themes."""

_SAVE = """
const shortest = value => {  // as many digits as the page holds
  for (let digits = 6; digits < 9; digits++)
    if (Math.fround(+value.toPrecision(digits)) == value) return String(+value.toPrecision(digits));
  return String(+value.toPrecision(9));
};
const text = (values, k) => {
  const value = values[k];
  if (typeof value == 'string') return '"' + value.replaceAll('"', '""') + '"';
  return !Number.isFinite(value) ? '' : values instanceof Float32Array ? shortest(value) : String(value);
};
const save = (name, head, rows) => {
  const lines = [head.map(word => /[",]/.test(word) ? text([word], 0) : word), ...rows].map(row => row.join(','));
  const link = document.createElement('a');
  link.href = URL.createObjectURL(new Blob([lines.join('\\n') + '\\n'], {type: 'text/csv'}));
  link.download = name + '.csv';
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
};
"""

_CURVES = """
const label = axes => axes.find(part => part.axis_label !== undefined).axis_label.replaceAll('\\n', ' ');
const rows = [];
for (const item of legend.items) {
  const lines = item.visible ? item.renderers.filter(({visible, glyph}) => visible && glyph.type == 'Line') : [];
  for (const {glyph, data_source: {data}} of lines) {
    const [x, y] = [data[glyph.x.field], data[glyph.y.field]];
    for (let k = 0; k < x.length; k++)
      if (Number.isFinite(y[k])) rows.push([text([item.label.value], 0), text(x, k), text(y, k)]);
  }
}
save(file, ['curve', label(plot.below), label(plot.left)], rows);
"""

_MAPS = """
const rows = [], n = beads.length;
images.forEach((image, c) => {
  const values = image.data[quantity.value][0];
  for (let k = 0; k < time.length; k++)
    for (let i = 0; i < n; i++) rows.push([text(time, k), chains[c], beads[i], text(values, k * n + i)]);
});
save(file.replace(/[a-z]+$/, quantity.value), [labels.time, 'chain', 'bead', labels[quantity.value]], rows);
"""

_IMAGE = """
const {x: [left], y: [bottom], dw: [width], dh: [height], [name]: [values]} = source.data, rows = [];
const [up, across] = values.shape;
for (let k = 0; k < up; k++)
  for (let i = 0; i < across; i++)
    rows.push([left + (i + 0.5) * width / across, bottom + (k + 0.5) * height / up, text(values, k * across + i)]);
save(file, heads, rows);
"""

_COLUMNS = """
const values = Object.values(columns).map(name => source.data[name]);
save(file, Object.keys(columns), Array.from(values[0], (_, k) => values.map(column => text(column, k))));
"""


def _tool(file: str, code: str, **arguments: Any) -> CustomAction:
    """A tool that saves rows of numbers under the name of a file, without its suffix."""
    callback = CustomJS(args={"file": file, **arguments}, code=_SAVE + code)
    return CustomAction(description="Data as CSV", icon=_ICON, callback=callback)


def add_tool_of_curves(plot: Any, scene: str) -> None:
    """Let a plot of lines save those that its legend shows: a row for each point, with the name of the line."""
    plot.add_tools(_tool(f"{scene}-{plot.name}", _CURVES, plot=plot, legend=plot.legend[0]))


def add_tool_of_columns(plot: Any, scene: str, source: ColumnDataSource, columns: Mapping[str, str]) -> None:
    """Let a plot save columns of a source, by their heads."""
    plot.add_tools(_tool(f"{scene}-{plot.name}", _COLUMNS, source=source, columns=dict(columns)))


def add_tool_of_image(plot: Any, scene: str, source: ColumnDataSource, name: str, heads: Sequence[str]) -> None:
    """Let a plot save the image of a name in a source, a row for each pixel: its middle, and its value."""
    plot.add_tools(_tool(f"{scene}-{plot.name}", _IMAGE, source=source, name=name, heads=list(heads)))


def tool_of_maps(
    file: str, images: list[ColumnDataSource], numbers: Mapping[str, Any], quantity: Select, labels: Mapping[str, str]
) -> CustomAction:
    """A tool that saves the quantity that maps show: a row for each bead of each chain at each time.

    Args:
        file: its name, which ends in ``map-QUANTITY``.
        images: sources of the maps.
        numbers: ``beads``, ``chains`` and ``time`` of the maps.
        quantity: choice of what they show.
        labels: of the time, and of each quantity, with their units.
    """
    arguments = {name: numbers[name] for name in ("beads", "chains", "time")}
    return _tool(file, _MAPS, images=images, quantity=quantity, labels=dict(labels), **arguments)
