"""The page of a sweep: its table, sortable, and any column over any other, of all cases or of some."""

import math
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
from bokeh.layouts import column, row
from bokeh.models import (
    BooleanFilter,
    CategoricalColorMapper,
    CDSView,
    ColorBar,
    ColumnDataSource,
    CustomJS,
    CustomJSTicker,
    CustomJSTickFormatter,
    DataTable,
    Div,
    FixedTicker,
    HoverTool,
    HTMLTemplateFormatter,
    LinearColorMapper,
    LogColorMapper,
    Select,
    TableColumn,
    TapTool,
)
from bokeh.palettes import Viridis256
from bokeh.plotting import figure

from analysis.figures.studies import logarithmic
from analysis.figures.style import AxisUnit
from workflow.sweep.collect import SHOWN, UNCERTAINTIES, SweepTable
from workflow.view.plots import CHAIN_COLOURS, TICK, TOOLS, choice, label, number

_LINK = '<% if (link) { %><a href="<%= link %>"><%- value %></a><% } else { %><%- value %><% } %>'

_NUMBER = '<%= value === null ? "" : typeof value === "number" ? +value.toPrecision(6) : _.escape(value) %>'

_WITH_UNCERTAINTY = (
    """
<% if (value !== null && {error} > 5e-7 * Math.abs(value)) {
  const digits = Math.max(0, 1 - Math.floor(Math.log10({error}))); %>
<%= value.toFixed(digits) %> &plusmn; <%= {error}.toPrecision(2) %>
<% } else { %>"""
    + _NUMBER
    + "<% } %>"
)
"""A number to two digits of its uncertainty, which is in another column."""

_DARK_TABLE = """
@media (prefers-color-scheme: dark) {
  .slick-row, .slick-row .slick-cell, .bk-cell-index { background: #1b1d21 !important; color: #ddd !important; }
  .slick-row.odd, .slick-row.odd .slick-cell { background: #26292f !important; }
  .slick-row .slick-cell a { color: #8ab4f8; }
}
"""

_CHOOSE = """
const {value: x} = drawn[over.value], {value: y, low, high, error, solid} = drawn[what.value];
Object.assign(source.data, {x, y, low, high, error, solid});
source.change.emit();
const plot = plots[kinds[over.value]];
const kept = source.data.case.map((_, k) => only.every(({value}, n) => value == "all" || texts[n][k] == value));
filter.booleans = kept;
const shown = y.map((value, k) => [x[k] + value, solid[k], error[k]]).filter((_, k) => kept[k]);
const unknown = shown.filter(([value]) => isNaN(value)).length;
const open = shown.some(([value, full]) => !isNaN(value) && !full);
const bars = shown.some(([value, _, size]) => !isNaN(value) && size > 0);
plot.title.text = [
  ...unknown ? [`${unknown} of ${shown.length} cases have no number here`] : [], ...open ? ["hollow: not settled"] : [],
  ...bars ? ["bars: uncertainty"] : []
].join("; ") || " ";
plot.below[0].axis_label = labels[over.value]; plot.left[0].axis_label = labels[what.value];
for (const [axis, name] of [[plot.below[0], over.value], [plot.left[0], what.value]])
  if ("min_interval" in axis.ticker) axis.ticker.min_interval = integers.includes(name) ? 1 : 0;
plot.toolbar.tools.find(tool => tool.type == "SaveTool").filename = `${name}-${what.value}-over-${over.value}`;
if (top.children[0] != plot) top.children = [plot, top.children[1]];
"""

_TICKS = """
const {start, end} = cb_data.range, low = Math.min(start, end), high = Math.max(start, end);
const decades = Math.log10(high / low), found = [];
if (decades < 0.5) {
  const step = 10 ** Math.floor(Math.log10(high - low));
  for (let k = Math.ceil(low / step); k * step <= high; k++) found.push(k * step);
} else {
  const every = Math.ceil(decades / 10);
  for (let power = Math.floor(Math.log10(low) / every) * every; 10 ** power <= high; power += every)
    for (const digit of decades < 3 ? [1, 2, 5] : [1]) found.push(digit * 10 ** power);
}
return found.filter(tick => low <= tick && tick <= high && (!integers.includes(over.value) || Number.isInteger(tick)));
"""
"""On a logarithmic axis: 1, 2 and 5 of each decade where few are shown, evenly spaced ones within one; of whole numbers
whole ones."""

_OPEN = """
const link = source.data.link[cb_data.source.selected.indices[0]];
if (link) window.open(link);
"""

_FEW = 8
"""Values of a field that are ticks themselves."""

_WIDEST, _LETTER = 600, 8
"""Largest width of a column, and that of a letter in it, in pixels."""

_HIGHEST, _ROW = 430, 25
"""Largest height of the table, and that of a row, in pixels."""


def layout(table: SweepTable, files: dict[str, list[str]], name: str) -> tuple[Any, CustomJS]:
    """A table and a plot, with points coloured by the second field; a choice for each varied field filters both.

    Returns:
        Both, and what draws the columns that are chosen, to be run when the page is ready.

    Args:
        table: of the sweep.
        files: case -> its page and figures, as far as there are any; a click opens the first.
        name: that names of saved images begin with.
    """
    data: dict[str, list[Any]] = {key: [_plain(row[key]) for row in table.rows] for key in table.columns}
    data["link"] = [next((f"{case}/{file}" for file in files[case]), "") for case in data["case"]]
    data["files"] = [" ".join(_anchor(case, file) for file in files[case]) for case in data["case"]]
    numbers = [key for key in table.columns if any(isinstance(value, float | int) for value in data[key])]
    over = table.fields[0] if table.fields and table.fields[0] in numbers else numbers[0]
    quantity = next((key for key in ("amplitude", "peak_velocity", *numbers) if key in numbers and key != over), over)
    drawn = {key: points(table, key) for key in numbers}
    x, y = drawn[over]["value"], drawn[quantity]["value"]
    source = ColumnDataSource(name="cases", data={**data, **drawn[quantity], "x": x, "y": y})
    labels = {key: table.label(key).plain for key in table.columns}
    chosen = BooleanFilter(name="filter", booleans=[True] * len(table.rows))
    view = CDSView(filter=chosen)
    columns = [(key, labels[key]) for key in numbers]
    choose_x, choose_y = choice("over", over, columns, "over"), choice("quantity", quantity, columns, "column")
    texts = {key: [_shown(value) for value in data[key]] for key in table.fields}
    only = [choice(labels[key], "all", ["all", *dict.fromkeys(texts[key])], f"only {key}") for key in table.fields]
    integers = [key for key in numbers if all(isinstance(value, int | None) for value in data[key])]
    kinds = {key: "log" if logarithmic(_drawn(data[key])) else "linear" for key in numbers}
    drawing = _Drawing(source, view, _colour(table, data), choose_x, integers)
    plots = {kind: _plot(drawing, kind) for kind in sorted(set(kinds.values()))}
    choices = column(choose_y, choose_x, Div(text="Cases with:"), *only)
    top = row(plots[kinds[over]], choices, name="top", styles={"flex-wrap": "wrap"}, sizing_mode="stretch_width")
    arguments = {"source": source, "over": choose_x, "what": choose_y, "plots": plots, "kinds": kinds, "only": only}
    arguments |= {
        "labels": labels,
        "texts": list(texts.values()),
        "filter": chosen,
        "integers": integers,
        "name": name,
        "top": top,
    }
    arguments["drawn"] = drawn
    choose = CustomJS(args=arguments, code=_CHOOSE)
    for chooser in (choose_x, choose_y, *only):
        chooser.js_on_change("value", choose)
    grid = DataTable(
        source=source,
        view=view,
        columns=_columns(table, data),
        height=min(_HIGHEST, _ROW * (len(table.rows) + 2)),
        sizing_mode="stretch_width",
        autosize_mode="none",
        reorderable=False,
        index_position=None,
        stylesheets=[_DARK_TABLE],
    )
    return column(top, grid, sizing_mode="stretch_width"), choose


def points(table: SweepTable, key: str) -> dict[str, list[float]]:
    """A column of a table as points: value, its uncertainty, ends of the bar of that, and 0 for a hollow mark."""
    value = table.numbers(key)
    error = table.numbers(UNCERTAINTIES[key]) if key in UNCERTAINTIES else np.full(len(value), np.nan)
    half = np.where(np.isfinite(error), error, 0.0)
    solid = 1.0 - table.unsettled(key)
    columns = {"value": value, "low": value - half, "high": value + half, "error": error, "solid": solid}
    return {name: column.tolist() for name, column in columns.items()}


def _anchor(case: str, file: str) -> str:
    """A link to a file of a case, in HTML."""
    return f'<a href="{escape(f"{case}/{file}")}">{escape(Path(file).stem)}</a>'


def _columns(table: SweepTable, data: dict[str, list[Any]]) -> list[TableColumn]:
    """Columns that hold anything, those of the printed table first, as wide as their texts.

    Uncertainties stand behind their numbers.
    """
    columns = []
    first = ["case", *table.fields, "outcome", *SHOWN]
    for key in sorted(table.columns, key=lambda key: first.index(key) if key in first else len(first)):
        if all(value in (None, "") for value in data[key]) or key in UNCERTAINTIES.values():
            continue
        heading = table.heading(key)
        error, template = UNCERTAINTIES.get(key), _LINK if key == "case" else _NUMBER
        letters = max(map(len, [heading, *map(_shown, data[key])]))
        if error is not None:
            template, letters = _WITH_UNCERTAINTY.replace("{error}", error), letters + len(" +- 0.00012")
        width = min(_WIDEST, 30 + _LETTER * letters)
        formatter = HTMLTemplateFormatter(template=template)
        columns.append(TableColumn(field=key, title=heading, width=width, formatter=formatter))
    if any(data["files"]):
        columns.append(
            TableColumn(
                field="files", title="files", width=300, formatter=HTMLTemplateFormatter(template="<%= value %>")
            )
        )
    return columns


@dataclass(frozen=True)
class _Drawing:
    """What the plots of a page share.

    Attributes:
        source, view: cases, and those that are shown.
        colour: of the points, and its bar.
        over: choice of the horizontal axis.
        integers: columns of whole numbers.
    """

    source: ColumnDataSource
    view: CDSView
    colour: tuple[Any, Any]
    over: Select
    integers: list[str]


def _colour(table: SweepTable, data: dict[str, list[Any]]) -> tuple[Any, Any]:
    """Colour of the points, by the second varied field, and its bar; one colour and no bar without such a field."""
    name = table.fields[1] if len(table.fields) > 1 else ""
    texts = list(dict.fromkeys(map(str, data[name]))) if name else []
    if len(texts) < 2:
        return "#0072B2", None
    bar = ColorBar(title=table.label(name).plain, width=12)
    values = _drawn(data[name])
    if any(map(math.isnan, values)):
        colours = [CHAIN_COLOURS[k % len(CHAIN_COLOURS)] for k in range(len(texts))]
        bar.color_mapper = CategoricalColorMapper(factors=texts, palette=colours)
    else:
        kind = LogColorMapper if logarithmic(values) else LinearColorMapper
        bar.color_mapper = kind(palette=Viridis256[70:230], low=min(values), high=max(values))
        bar.formatter = CustomJSTickFormatter(code=TICK)
        if len(texts) <= _FEW:
            bar.ticker = FixedTicker(ticks=sorted(set(values)))
    return {"field": name, "transform": bar.color_mapper}, bar


def _plot(drawing: _Drawing, kind: str) -> Any:
    """The column that is chosen over another, on a linear or a logarithmic axis; a click opens the case."""
    source, view, (fill, bar) = drawing.source, drawing.view, drawing.colour
    plot = figure(
        tools=TOOLS,
        toolbar_location="above",
        toolbar_sticky=False,
        title=" ",  # room for the text that follows the choice
        height=400,
        sizing_mode="stretch_width",
        styles={"flex": "1 1 400px"},
        x_axis_type=kind,
        x_axis_label=" ",
        y_axis_label=" ",
        name=f"plot {kind}",
    )
    plot.toolbar.logo = None
    label(plot)
    if kind == "log":
        plot.xaxis.ticker = CustomJSTicker(major_code=_TICKS, args={"over": drawing.over, "integers": drawing.integers})
        plot.xgrid.ticker = plot.xaxis[0].ticker
    plot.segment("x", "low", "x", "high", source=source, view=view, line_color=fill, line_width=1.5, name="errors")
    drawn = plot.scatter(
        "x",
        "y",
        size=10,
        source=source,
        view=view,
        fill_color=fill,
        fill_alpha="solid",
        line_color=fill,
        line_width=1.5,
        name="points",
    )
    if bar is not None:
        plot.add_layout(bar.clone(), "right")
    tips = [("case", "@case"), ("over", "@x{custom}"), ("quantity", "@y{custom}"), ("uncertainty", "@error{custom}")]
    formatters = {f"@{key}": number(AxisUnit(1.0, "")) for key in ("x", "y", "error")}
    plot.add_tools(HoverTool(renderers=[drawn], tooltips=tips, formatters=formatters))
    plot.add_tools(TapTool(renderers=[drawn], callback=CustomJS(args={"source": source}, code=_OPEN)))
    return plot


def _drawn(values: list[Any]) -> list[float]:
    """A column for an axis, which would show None at 0."""
    return [value if isinstance(value, float | int) else math.nan for value in values]


def _shown(value: Any) -> str:
    """Text of a value, about as long as `_NUMBER` writes it."""
    return f"{value:.6g}" if isinstance(value, float) else "" if value is None else str(value)


def _plain(value: Any) -> Any:
    if value is None or (isinstance(value, float) and not math.isfinite(value)):
        return None
    return value if isinstance(value, int | float | str) else str(value)
