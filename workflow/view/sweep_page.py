"""The page of a sweep: its table, sortable, and any column over any other, of all cases or of some."""

import math
from typing import Any

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
    OpenURL,
    Select,
    TableColumn,
    TapTool,
)
from bokeh.palettes import Viridis256
from bokeh.plotting import figure

from analysis.figures.studies import logarithmic
from workflow.sweep.collect import Table
from workflow.view.plots import CHAIN_COLOURS, TICK, TOOLS

_LINK = '<a href="<%= link %>"><%- value %></a>'

_NUMBER = '<%= value === null ? "" : typeof value === "number" ? +value.toPrecision(6) : _.escape(value) %>'

_DARK_TABLE = """
@media (prefers-color-scheme: dark) {
  .slick-row, .slick-row .slick-cell, .bk-cell-index { background: #1b1d21 !important; color: #ddd !important; }
  .slick-row.odd, .slick-row.odd .slick-cell { background: #26292f !important; }
  .slick-row .slick-cell a { color: #8ab4f8; }
}
"""

_DARK_CHOICE = """
@media (prefers-color-scheme: dark) { .bk-input { background-color: #26292f; color: #ddd; } }
"""

_CHOOSE = """
const numbers = name => Array.from(source.data[name], value => typeof value === "number" ? value : NaN);
source.data.x = numbers(over.value); source.data.y = numbers(what.value); source.change.emit();
const plot = plots[kinds[over.value]];
const kept = source.data.case.map((_, k) => only.every(one => one.value == "all" || texts[one.title][k] == one.value));
filter.booleans = kept;
const shown = kept.flatMap((here, k) => here ? [source.data.x[k] + source.data.y[k]] : []);
const count = shown.filter(isNaN).length;
plot.title.text = count ? `${count} of ${shown.length} cases have no number here` : "";
plot.below[0].axis_label = headings[over.value]; plot.left[0].axis_label = headings[what.value];
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
return found.filter(tick => low <= tick && tick <= high);
"""
"""On a logarithmic axis: 1, 2 and 5 of each decade where few are shown, evenly spaced ones within one."""

_FEW = 8
"""Values of a field that are ticks themselves."""

_WIDEST, _LETTER = 600, 8
"""Pixels of a column, and of a letter in it."""


def layout(table: Table, pages: dict[str, str]) -> Any:
    """A table and a plot, with points coloured by the second field; a choice for each varied field filters both.

    Args:
        table: of the sweep.
        pages: case -> the file in its directory that a click opens; empty for the directory itself.
    """
    data: dict[str, list[Any]] = {name: [_plain(row[name]) for row in table.rows] for name in table.columns}
    data["link"] = [f"{case}/{pages[case]}" for case in data["case"]]
    numbers = [name for name in table.columns if any(isinstance(value, float | int) for value in data[name])]
    over = table.fields[0] if table.fields and table.fields[0] in numbers else numbers[0]
    what = next((name for name in ("amplitude", "peak_velocity", *numbers) if name in numbers and name != over), over)
    data["x"], data["y"] = _drawn(data[over]), _drawn(data[what])
    unknown = sum(math.isnan(x + y) for x, y in zip(data["x"], data["y"], strict=True))
    source = ColumnDataSource(name="cases", data=data)
    headings = {name: table.heading(name) for name in table.columns}
    kinds = {name: "log" if logarithmic(_drawn(data[name])) else "linear" for name in numbers}
    texts = {name: [_shown(value) for value in data[name]] for name in table.fields}
    kept = BooleanFilter(name="filter", booleans=[True] * len(table.rows))
    view, colour = CDSView(filter=kept), _colour(table, data, headings)
    labels = headings[over], headings[what]
    plots = {kind: _plot(source, view, kind, labels, colour) for kind in sorted(set(kinds.values()))}
    if unknown:
        plots[kinds[over]].title.text = f"{unknown} of {len(table.rows)} cases have no number here"
    choose_x = _select("over", over, numbers, "over")
    choose_y = _select("column", what, numbers, "column")
    only = [_select(name, "all", ["all", *dict.fromkeys(texts[name])], f"only {name}") for name in table.fields]
    args = {"source": source, "over": choose_x, "what": choose_y, "plots": plots, "kinds": kinds, "headings": headings}
    args |= {"only": only, "texts": texts, "filter": kept}
    choices = column(choose_y, choose_x, Div(text="Cases with:"), *only)
    top = row(plots[kinds[over]], choices, name="top", styles={"flex-wrap": "wrap"}, sizing_mode="stretch_width")
    for chooser in (choose_x, choose_y, *only):
        chooser.js_on_change("value", CustomJS(args={**args, "top": top}, code=_CHOOSE))
    columns = [
        TableColumn(
            field=name,
            title=headings[name],
            width=min(_WIDEST, 30 + _LETTER * max(map(len, [headings[name], *map(_shown, data[name])]))),
            formatter=HTMLTemplateFormatter(template=_LINK if name == "case" else _NUMBER),
        )
        for name in table.columns
        if any(value not in (None, "") for value in data[name])
    ]
    grid = DataTable(
        source=source,
        view=view,
        columns=columns,
        height=430,
        sizing_mode="stretch_width",
        autosize_mode="none",
        reorderable=False,
        stylesheets=[_DARK_TABLE],
    )
    return column(top, grid, sizing_mode="stretch_width")


def _select(title: str, value: str, options: list[str], name: str) -> Select:
    return Select(title=title, value=value, options=options, name=name, stylesheets=[_DARK_CHOICE])


def _colour(table: Table, data: dict[str, list[Any]], headings: dict[str, str]) -> tuple[Any, Any]:
    """Of the points, by the second varied field, and its bar; one colour and no bar where there is no such field."""
    name = table.fields[1] if len(table.fields) > 1 else ""
    texts = list(dict.fromkeys(map(str, data[name]))) if name else []
    if len(texts) < 2:
        return "#0072B2", None
    bar = ColorBar(title=headings[name], width=12)
    values = _drawn(data[name])
    if any(map(math.isnan, values)):
        colours = [CHAIN_COLOURS[k % len(CHAIN_COLOURS)] for k in range(len(texts))]
        bar.color_mapper = CategoricalColorMapper(factors=texts, palette=colours)
    else:
        kind = LogColorMapper if logarithmic(values) else LinearColorMapper
        bar.color_mapper = kind(palette=Viridis256[:230], low=min(values), high=max(values))
        bar.formatter = CustomJSTickFormatter(code=TICK)
        if len(texts) <= _FEW:
            bar.ticker = FixedTicker(ticks=sorted(set(values)))
    return {"field": name, "transform": bar.color_mapper}, bar


def _plot(source: ColumnDataSource, view: CDSView, kind: str, labels: tuple[str, str], colour: tuple[Any, Any]) -> Any:
    """The column that is chosen over another, on a linear or a logarithmic axis; a click opens the case."""
    (over, what), (fill, bar) = labels, colour
    plot = figure(
        tools=TOOLS,
        height=380,
        sizing_mode="stretch_width",
        styles={"flex": "1 1 400px"},
        x_axis_type=kind,
        x_axis_label=over,
        y_axis_label=what,
        name=f"plot {kind}",
    )
    plot.toolbar.logo = None
    if kind == "log":
        plot.xaxis.ticker = CustomJSTicker(major_code=_TICKS)
        plot.xaxis.formatter = CustomJSTickFormatter(code=TICK)
        plot.xgrid.ticker = plot.xaxis[0].ticker
    drawn = plot.scatter(
        "x", "y", size=10, source=source, view=view, fill_color=fill, line_color="white", name="points"
    )
    if bar is not None:
        plot.add_layout(bar.clone(), "right")
    plot.add_tools(HoverTool(renderers=[drawn], tooltips=[("case", "@case"), ("x", "@x"), ("y", "@y")]))
    plot.add_tools(TapTool(renderers=[drawn], callback=OpenURL(url="@link")))
    return plot


def _drawn(values: list[Any]) -> list[float]:
    """A column for an axis, which would show None at 0."""
    return [value if isinstance(value, float | int) else math.nan for value in values]


def _shown(value: Any) -> str:
    """As `_NUMBER` writes it, or about as long."""
    return f"{value:.6g}" if isinstance(value, float) else "" if value is None else str(value)


def _plain(value: Any) -> Any:
    if value is None or (isinstance(value, float) and not math.isfinite(value)):
        return None
    return value if isinstance(value, int | float | str) else str(value)
