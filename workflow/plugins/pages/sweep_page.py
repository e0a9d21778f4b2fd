"""The page of a sweep: its table, sortable, and any column over any other, as points or as a map, of chosen cases."""

import math
from collections.abc import Sequence
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
    CheckboxGroup,
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

from granchain.parts import collect, panels, units
from workflow.plugins.pages.plots import CHAIN_COLOURS, TICK, TOOLS, choice, label, number

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

_NOT_SETTLED = '<% if (value !== null && not_settled) { %> <span title="not settled">&#9675;</span><% } %>'

_DARK_TABLE = """
@media (prefers-color-scheme: dark) {
  .slick-row, .slick-row .slick-cell, .bk-cell-index { background: #1b1d21 !important; color: #ddd !important; }
  .slick-row.odd, .slick-row.odd .slick-cell { background: #26292f !important; }
  .slick-row .slick-cell.selected { background: #2f4a6b !important; }
  .slick-row .slick-cell a { color: #8ab4f8; }
}
"""

_DARK_LINKS = "@media (prefers-color-scheme: dark) { a { color: #8ab4f8; } }"

_FIELDSET = """
.bk-input-group { display: flex; flex-wrap: wrap; max-height: 8rem; overflow-y: auto; }
"""

_CHOOSE = """
const {value: x} = drawn[over.value], {value: y, low, high, error, solid} = drawn[what.value];
const kept = y.map((_, k) => filters.every(({places, boxes, least, largest}) => boxes
  ? boxes.active.includes(places[k]) : Number(least.value) <= places[k] && places[k] <= Number(largest.value)));
filter.booleans = kept;
const others = (fields, not) => fields.filter(name => !not.includes(name));
const is_map = form !== null && form.value == "map";
const across = is_map && !axes[over.value] ? Object.keys(axes)[0] : over.value;
const up = is_map && (!axes[colour.value] || colour.value == across)
  ? others(Object.keys(axes), [across])[0] : colour.value;
const cells = kept.flatMap((shown, k) => shown && is_map ? [`${drawn[across].value[k]} ${drawn[up].value[k]}`] : []);
const shared = new Set(cells).size < cells.length;
const edge = (name, side) => y.map((_, k) => is_map && !shared ? axes[name][side][k] : NaN);
Object.assign(source.data, {
  x: drawn[across].value, y, low, high, error, solid, z: is_map ? drawn[up].value : y,
  left: edge(across, "low"), right: edge(across, "high"), bottom: edge(up, "low"), top: edge(up, "high"),
  hole: y.map(value => isNaN(value) ? 1 : 0), open: y.map((value, k) => isNaN(value) || solid[k] ? 0 : 1),
});
const plot = is_map ? maps[axes[across].kind + " " + axes[up].kind] : plots[kinds[across]];
const shown = y.map((value, k) => [value, solid[k], error[k]]).filter((_, k) => kept[k]);
const numbers = shown.map(([value]) => value).filter(value => !isNaN(value));
const unknown = shown.length - numbers.length;
const open = shown.some(([value, full]) => !isNaN(value) && !full);
const bars = !is_map && shown.some(([value, _, size]) => !isNaN(value) && size > 0);
const varied = others(Object.keys(texts), [across, up]).filter(
  name => new Set(texts[name].filter((_, k) => kept[k])).size > 1).map(name => labels[name]);
plot.title.text = shared ? `several cases at one point: choose one value of ${varied.join(", ")}` : [
  ...unknown ? [`${unknown} of ${shown.length} cases have no number` + (is_map ? " (hatched)" : "")] : [],
  ...open ? [is_map ? "crosses: not settled" : "hollow: not settled"] : [], ...bars ? ["bars: uncertainty"] : []
].join("; ") || " ";
plot.below[0].axis_label = labels[across]; plot.left[0].axis_label = labels[is_map ? up : what.value];
for (const [axis, name] of [[plot.below[0], across], [plot.left[0], is_map ? up : what.value]])
  if ("min_interval" in axis.ticker) axis.ticker.min_interval = integers.includes(name) ? 1 : 0;
const [least, largest] = [Math.min(...numbers), Math.max(...numbers)];
const scale = is_map ? (least > 0 && largest > 30 * least ? "log" : "linear") : colour.value;
for (const part of plot.renderers) {
  if (is_map && part.name == "cells") {
    const mapper = mappers[scale];
    if (numbers.length) [mapper.low, mapper.high] = least < largest ? [least, largest] : [least - 0.5, least + 0.5];
    part.glyph.fill_color = {field: "y", transform: mapper};
  } else if (!is_map && part.name != "ring") {
    const fill = colours[scale];
    part.glyph.line_color = fill;
    if (part.name == "points") part.glyph.fill_color = fill;
  }
}
for (const bar of plot.right) { bar.visible = bar.name == scale; if (is_map) bar.title = labels[what.value]; }
const file = is_map ? `map-over-${across}-and-${up}` : `over-${across}`;
plot.toolbar.tools.find(tool => tool.type == "SaveTool").filename = `${name}-${what.value}-${file}`;
if (top.children[0] != plot) top.children = [plot, top.children[1]];
source.change.emit();  // colours are read with the data
chosen.properties.value.change.emit();
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
const whole = integers.includes(name ? name.value : "");
return found.filter(tick => low <= tick && tick <= high && (!whole || Number.isInteger(tick)));
"""
"""On a logarithmic axis: 1, 2 and 5 of each decade where few are shown, evenly spaced ones within one; of whole numbers
whole ones."""

_OPEN = """
const link = source.data.link[cb_data.source.selected.indices[0]];
if (link) window.open(link);
"""

_SELECTED = """
const [k] = source.selected.indices;
if (k !== undefined) chosen.value = source.data.case[k];
"""

_NAMED = """
const k = source.data.case.indexOf(chosen.value);
if (k < 0) return;
if (source.selected.indices.length != 1 || source.selected.indices[0] != k) source.selected.indices = [k];
const {value, error} = drawn[what.value], digits = error[k] > 0 ? 1 - Math.floor(Math.log10(error[k])) : 0;
const number = !(error[k] > 0) ? +value[k].toPrecision(6)
  : `${value[k].toFixed(Math.min(20, Math.max(0, digits)))} ± ${error[k].toPrecision(2)}`;
const open = source.data.open[k] ? " (not settled)" : "";
marked.data = {x: [source.data.x[k]], y: [source.data.z[k]]};
named.text = `${words[k]}<br>${escaped[what.value]}: ` + (isNaN(value[k]) ? "no number" : number + open);
"""

_KEYS = """
const {shadow_el: root, grid} = Bokeh.index.find_one_by_id(table.id);
grid.focus = () => {};
const heads = () => root.querySelectorAll('.slick-header-column');
const reach = () => heads().forEach(head => {
  if (head.tabIndex == 0) return;
  head.tabIndex = 0;
  head.setAttribute('role', 'columnheader');
});
new MutationObserver(reach).observe(root, {childList: true, subtree: true});
reach();
root.addEventListener('keydown', event => {
  if (!['Enter', ' '].includes(event.key) || !event.target.classList.contains('slick-header-column')) return;
  event.preventDefault();
  event.target.click();
});
"""
"""Heads of columns are reached by the tabulator, and sort by Enter or space. The table does not take the focus from the
list of cases, or from a head, where rows are selected."""

_FEW = 8
"""Values of a field that have a box each, and are ticks themselves."""

_WIDEST, _LETTER = 600, 8
"""Largest width of a column, and that of a letter in it, in pixels."""

_HIGHEST, _ROW = 430, 25
"""Largest height of the table, and that of a row, in pixels."""

_BLUE = "#0072B2"

_ONE_COLOUR = ""
"""Choice of no field that colours the points."""


def layout(
    table: collect.SweepTable, files: dict[str, list[str]], name: str, directory: str = ""
) -> tuple[Any, tuple[CustomJS, ...]]:
    """A table, and a plot of points or a map; a choice for each varied field filters all of them.

    Returns:
        All of them, and what draws the columns that are chosen and lets keys sort, to be run when the page is ready.

    Args:
        table: of the sweep.
        files: case -> its page and figures, as far as there are any; a click opens the first.
        name: that names of saved images begin with.
        directory: name of the sweep's directory, for the command that makes the page of a case.
    """
    data = _data(table, files)
    numbers = [key for key in table.columns if any(isinstance(value, float | int) for value in data[key])]
    over = table.fields[0] if table.fields and table.fields[0] in numbers else numbers[0]
    quantity = next((key for key in ("amplitude", "peak_velocity", *numbers) if key in numbers and key != over), over)
    drawn = {key: points(table, key) for key in numbers}
    source = ColumnDataSource(name="cases", data={**data, **_at_first(drawn[over], drawn[quantity])})
    labels = {key: table.label(key).plain for key in table.columns}
    kinds = {key: "log" if table.axis(key).logarithmic else "linear" for key in numbers}
    axes, colours = _map_axes(table, kinds), _colours(table, data)
    choices = _choices(table, data, numbers, (over, quantity), list(colours), can_be_map=len(axes) > 1)
    integers = [key for key in numbers if all(isinstance(value, int | None) for value in data[key])]
    cases = BooleanFilter(name="filter", booleans=[True] * len(table.rows))
    marked = ColumnDataSource({"x": [], "y": []}, name="marked")
    drawing = _Drawing(source, CDSView(filter=cases), marked, choices, integers)
    plots = {kind: _point_plot(drawing, kind, colours) for kind in sorted(set(kinds.values()))}
    looks = {"palette": Viridis256, "nan_color": "#00000000", "high": 1.0}
    mappers = {"linear": LinearColorMapper(low=0.0, **looks), "log": LogColorMapper(low=0.1, **looks)}
    pairs = [(x["kind"], z["kind"]) for a, x in axes.items() for b, z in axes.items() if a != b]
    maps = {f"{x} {z}": _map_plot(drawing, (x, z), mappers) for x, z in dict.fromkeys(pairs)}
    top = row(plots[kinds[over]], choices.column, name="top", styles={"flex-wrap": "wrap"}, sizing_mode="stretch_width")
    arguments = {"source": source, "drawn": drawn, "labels": labels, "kinds": kinds, "integers": integers, "name": name}
    arguments |= {"plots": plots, "maps": maps, "axes": axes, "mappers": mappers, "top": top, "filter": cases}
    arguments |= {"colours": {key: fill for key, (fill, _) in colours.items()}, **choices.arguments}
    arguments["texts"] = {key: [_shown(value) for value in data[key]] for key in table.fields}
    choose = CustomJS(args=arguments, code=_CHOOSE)
    for chooser in choices.of_drawing:
        chooser.js_on_change("active" if isinstance(chooser, CheckboxGroup) else "value", choose)
    words = [_case_words(case, link, directory) for case, link in zip(data["case"], data["link"], strict=True)]
    _name_chosen(drawing, words, {"drawn": drawn, "escaped": {key: escape(text) for key, text in labels.items()}})
    grid = DataTable(
        source=source,
        view=CDSView(filter=cases),  # Bokeh redraws a table for ever that shares the view of glyphs
        columns=_columns(table, data),
        height=min(_HIGHEST, _ROW * (len(table.rows) + 2)),
        sizing_mode="stretch_width",
        autosize_mode="none",
        reorderable=False,
        index_position=None,
        stylesheets=[_DARK_TABLE],
    )
    keys = CustomJS(args={"table": grid}, code=_KEYS)
    return column(top, grid, sizing_mode="stretch_width"), (choose, keys)


def _data(table: collect.SweepTable, files: dict[str, list[str]]) -> dict[str, list[Any]]:
    """Columns of the table, the first file of each case, links to all, and whether a case has not settled."""
    data: dict[str, list[Any]] = {key: [_plain(row[key]) for row in table.rows] for key in table.columns}
    data["link"] = [next((f"{case}/{file}" for file in files[case]), "") for case in data["case"]]
    data["files"] = [" ".join(_anchor(case, file) for file in files[case]) for case in data["case"]]
    data["not_settled"] = table.unsettled("amplitude").tolist()
    return data


def _at_first(over: dict[str, list[float]], quantity: dict[str, list[float]]) -> dict[str, list[float]]:
    """Columns of what is drawn at first, which are points; the cells of a map are not defined."""
    y = quantity["value"]
    cells = dict.fromkeys(("left", "right", "bottom", "top"), [math.nan] * len(y))
    marks = dict.fromkeys(("hole", "open"), [0.0] * len(y))
    return {**quantity, "x": over["value"], "y": y, "z": y, **cells, **marks}


def _name_chosen(drawing: "_Drawing", words: list[str], arguments: dict[str, Any]) -> None:
    """Let the case that is chosen in the list, the table or a plot be marked in all of them, and named.

    Args:
        drawing: what the plots share.
        words: what is said of each case, in HTML.
        arguments: of the script that names it, on the columns.
    """
    source, choices = drawing.source, drawing.choices
    named = {"source": source, "words": words, "named": choices.named, "marked": drawing.marked}
    named |= {"what": choices.quantity, "chosen": choices.case, **arguments}
    choices.case.js_on_change("value", CustomJS(args=named, code=_NAMED))
    selected = CustomJS(args={"source": source, "chosen": choices.case}, code=_SELECTED)
    source.selected.js_on_change("indices", selected)


def points(table: collect.SweepTable, key: str) -> dict[str, list[float]]:
    """A column of a table as points: value, uncertainty, ends of the bar of that (NaN: none), 0 for a hollow mark.

    What `granchain collect --plot` does not draw, as cases that are not done, has no value; varied fields have one.
    """
    axis = table.axis(key)
    value = axis.values
    error = np.full(len(value), np.nan) if axis.error is None else axis.error
    half = np.where(error > 0.0, error, np.nan)
    solid = 1.0 - axis.open
    columns = {"value": value, "low": value - half, "high": value + half, "error": error, "solid": solid}
    return {name: column.tolist() for name, column in columns.items()}


def _map_axes(table: collect.SweepTable, kinds: dict[str, str]) -> dict[str, dict[str, Any]]:
    """Fields that can be an axis of a map: kind of the axis, and the ends of each case's cell."""
    axes = {}
    for name in table.fields:
        values = table.numbers(name)
        distinct = np.unique(values)
        if name in kinds and np.all(np.isfinite(values)) and len(distinct) > 1:
            ends, cells = table.axis(name).edges, np.searchsorted(distinct, values)
            axes[name] = {"kind": kinds[name], "low": ends[cells].tolist(), "high": ends[cells + 1].tolist()}
    return axes


# --- choices ----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _PageChoices:
    """What a user chooses, and where it stands.

    Attributes:
        over, quantity, colour: columns that are drawn.
        form: points or a map; None where there can be no map.
        filters: of each varied field the place of each case's value among all, and the boxes or ends that choose.
        case, named: choice of a case, and what is said of it.
    """

    over: Select
    quantity: Select
    colour: Select
    form: Select | None
    filters: list[dict[str, Any]]
    case: Select
    named: Div

    @property
    def of_drawing(self) -> list[Any]:
        """Choices that change what is drawn."""
        controls = [
            control for entry in self.filters for key, control in entry.items() if key not in ("places", "head")
        ]
        return [*filter(None, [self.over, self.quantity, self.colour, self.form]), *controls]

    @property
    def arguments(self) -> dict[str, Any]:
        """Arguments of the script that draws."""
        filters = [{"boxes": None, "least": None, "largest": None} | entry for entry in self.filters]
        filters = [{key: value for key, value in entry.items() if key != "head"} for entry in filters]
        return {
            "over": self.over,
            "what": self.quantity,
            "colour": self.colour,
            "form": self.form,
            "filters": filters,
            "chosen": self.case,
        }

    @property
    def column(self) -> Any:
        """All choices, one below the other."""
        filters = []
        for entry in self.filters:
            ends = [entry[key] for key in ("least", "largest") if key in entry]
            filters += [entry["head"], row(*ends) if ends else entry["boxes"]]
        form = [] if self.form is None else [self.form]
        drawn = [self.quantity, self.over, self.colour, *form]
        return column(*drawn, *filters, self.case, self.named, styles={"flex": "1 1 280px"}, name="choices")


def _choices(
    table: collect.SweepTable,
    data: dict[str, list[Any]],
    numbers: Sequence[str],
    at_first: tuple[str, str],
    colours: Sequence[str],
    *,
    can_be_map: bool,
) -> _PageChoices:
    """Choices of what is drawn, of the cases, and of one case.

    Args:
        table: of the sweep.
        data: its columns.
        numbers: columns of numbers.
        at_first: columns along the horizontal and the vertical axis at first.
        colours: columns that may colour the points, and none.
        can_be_map: whether two varied fields can be the axes of a map.
    """
    columns = [(key, table.label(key).plain) for key in numbers]
    second = table.fields[1] if len(table.fields) > 1 and table.fields[1] in colours else _ONE_COLOUR
    names = [(key, table.label(key).plain if key else "one colour") for key in colours]
    words = "colour, or vertical axis of a map" if can_be_map else "colour"
    return _PageChoices(
        over=choice("over", at_first[0], columns, "over"),
        quantity=choice("quantity", at_first[1], columns, "column"),
        colour=choice(words, second, names, "colour"),
        form=choice("as", "points", ["points", "map"], "form") if can_be_map else None,
        filters=[_filter(table, key, data[key]) for key in table.fields],
        case=choice("case", "", ["", *data["case"]], "case"),
        named=Div(name="named", sizing_mode="stretch_width", stylesheets=[_DARK_LINKS]),
    )


def _filter(table: collect.SweepTable, key: str, values: list[Any]) -> dict[str, Any]:
    """Boxes for the values of a field, or, of many numbers, their least and largest; and the place of each case's."""
    distinct = sorted(
        set(values), key=lambda value: (isinstance(value, str), value or 0) if value is not None else (2,)
    )
    places = [distinct.index(value) for value in values]
    texts = [_shown(value) for value in distinct]
    head = Div(text=f"Cases with {escape(table.label(key).plain)}")
    if len(distinct) > _FEW and all(isinstance(value, int | float) for value in distinct):
        options = [(str(place), text) for place, text in enumerate(texts)]
        least = choice("from", options[0][0], options, f"least {key}")
        return {"head": head, "places": places, "least": least} | {
            "largest": choice("to", options[-1][0], options, f"largest {key}")
        }
    boxes = CheckboxGroup(
        labels=texts, active=list(range(len(texts))), inline=True, name=f"only {key}", stylesheets=[_FIELDSET]
    )
    return {"head": head, "places": places, "boxes": boxes}


def _case_words(case: str, link: str, directory: str) -> str:
    """Link to the page of a case, or the command that makes it, in HTML."""
    if link:
        return f'<a href="{escape(link)}">{escape(case)}</a>'
    return f"{escape(case)}: <code>granchain view {escape(f'{directory}/{case}')}</code> makes its page"


# --- table ------------------------------------------------------------------------------------------------------------


def _anchor(case: str, file: str) -> str:
    """A link to a file of a case, in HTML."""
    return f'<a href="{escape(f"{case}/{file}")}">{escape(Path(file).stem)}</a>'


def _columns(table: collect.SweepTable, data: dict[str, list[Any]]) -> list[TableColumn]:
    """Columns that hold anything, those of the printed table first, as wide as their texts.

    Uncertainties stand behind their numbers; a ring marks those of chains that are not settled.
    """
    columns = []
    first = ["case", *table.summary]
    uncertainties = {key: table.uncertainty(key) for key in table.columns}
    for key in sorted(table.columns, key=lambda key: first.index(key) if key in first else len(first)):
        if all(value in (None, "") for value in data[key]) or key in uncertainties.values():
            continue
        heading = table.heading(key)
        error, template = uncertainties[key], _LINK if key == "case" else _NUMBER
        letters = max(map(len, [heading, *map(_shown, data[key])]))
        if error:
            template, letters = _WITH_UNCERTAINTY.replace("{error}", error), letters + len(" +- 0.00012")
        if np.isfinite(table.numbers(key)).any() and table.unsettled(key).any():
            template, letters = template + _NOT_SETTLED, letters + 2
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


# --- plots ------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Drawing:
    """What the plots of a page share.

    Attributes:
        source, view: cases, and those that are shown.
        marked: point of the case that is chosen, in a ring.
        choices: of the columns.
        integers: columns of whole numbers.
    """

    source: ColumnDataSource
    view: CDSView
    marked: ColumnDataSource
    choices: _PageChoices
    integers: list[str]


def _colours(table: collect.SweepTable, data: dict[str, list[Any]]) -> dict[str, tuple[Any, ColorBar | None]]:
    """Colour of the points by a varied field, or by another column of text, and its bar; one colour comes first."""
    colours: dict[str, tuple[Any, ColorBar | None]] = {_ONE_COLOUR: (_BLUE, None)}
    for name in dict.fromkeys((*table.fields, "outcome", "state", "engine")):
        texts = list(dict.fromkeys(map(str, data[name])))
        if len(texts) < 2:
            continue
        bar = ColorBar(title=table.label(name).plain, width=12, name=name)
        values = _drawn(data[name])
        if any(map(math.isnan, values)):
            palette = [CHAIN_COLOURS[k % len(CHAIN_COLOURS)] for k in range(len(texts))]
            bar.color_mapper = CategoricalColorMapper(factors=texts, palette=palette)
        else:
            kind = LogColorMapper if table.axis(name).logarithmic else LinearColorMapper
            bar.color_mapper = kind(palette=Viridis256[70:230], low=min(values), high=max(values))
            bar.formatter = CustomJSTickFormatter(code=TICK)
            if len(texts) <= _FEW:
                bar.ticker = FixedTicker(ticks=sorted(set(values)))
        colours[name] = {"field": name, "transform": bar.color_mapper}, bar
    return colours


def _plot(drawing: _Drawing, kinds: tuple[str, str], name: str) -> Any:
    """An empty plot with linear or logarithmic axes."""
    plot = figure(
        tools=TOOLS,
        toolbar_location="above",
        toolbar_sticky=False,
        title=" ",  # room for the text that follows the choice
        height=400,
        sizing_mode="stretch_width",
        styles={"flex": "1 1 400px"},
        x_axis_type=kinds[0],
        y_axis_type=kinds[1],
        x_axis_label=" ",
        y_axis_label=" ",
        name=name,
    )
    plot.toolbar.logo = None
    plot.title.text_font_size = "9pt"
    label(plot)
    axes = ((plot.xaxis, plot.xgrid, drawing.choices.over), (plot.yaxis, plot.ygrid, None))
    for kind, (axis, grid, chooser) in zip(kinds, axes, strict=True):
        if kind == "log":
            arguments = {"name": chooser, "integers": drawing.integers}
            axis.ticker = CustomJSTicker(major_code=_TICKS, args=arguments)
            grid.ticker = axis[0].ticker
    return plot


def _point_plot(drawing: _Drawing, kind: str, colours: dict[str, tuple[Any, ColorBar | None]]) -> Any:
    """The column that is chosen over another, on a linear or a logarithmic axis; a click opens the case."""
    source, view = drawing.source, drawing.view
    plot = _plot(drawing, (kind, "linear"), f"plot {kind}")
    fill, _ = colours[drawing.choices.colour.value]
    line = {"source": source, "view": view, "line_color": fill, "line_width": 1.5}
    plot.segment("x", "low", "x", "high", name="errors", **line)
    for end in ("low", "high"):
        plot.scatter("x", end, marker="dash", size=9, name="ends", **line)
    drawn = plot.scatter("x", "y", size=10, fill_color=fill, fill_alpha="solid", name="points", **line)
    for key, (_, bar) in colours.items():
        if bar is not None:
            plot.add_layout(bar.clone(visible=key == drawing.choices.colour.value), "right")
    _answer(plot, drawn, drawing)
    return plot


def _map_plot(drawing: _Drawing, kinds: tuple[str, str], mappers: dict[str, Any]) -> Any:
    """The column that is chosen over two fields, in cells; hatched where there is no number, crossed if not settled."""
    source, view = drawing.source, drawing.view
    plot = _plot(drawing, kinds, f"map {kinds[0]} {kinds[1]}")
    plot.grid.visible = False
    for ranged in (plot.x_range, plot.y_range):
        ranged.range_padding = 0.0
    sides = {"left": "left", "right": "right", "bottom": "bottom", "top": "top", "source": source, "view": view}
    fill = {"field": "y", "transform": mappers["linear"]}
    cells = plot.quad(fill_color=fill, line_color=None, name="cells", **sides)
    hatch = {"hatch_pattern": "/", "hatch_color": "#888888", "hatch_alpha": "hole", "hatch_scale": 10}
    plot.quad(fill_color=None, line_color=None, name="holes", **hatch, **sides)
    for colour, width in (("#ffffff", 4), ("#000000", 1.5)):
        plot.scatter(
            "x",
            "z",
            marker="x",
            size=9,
            line_color=colour,
            line_width=width,
            line_alpha="open",
            source=source,
            view=view,
            name="crosses",
        )
    for kind, mapper in mappers.items():
        bar = ColorBar(color_mapper=mapper, title=" ", width=12, name=kind, formatter=CustomJSTickFormatter(code=TICK))
        plot.add_layout(bar, "right")
    _answer(plot, cells, drawing)
    return plot


def _answer(plot: Any, drawn: Any, drawing: _Drawing) -> None:
    """Let a cursor name a case and its numbers, and a click open it; a ring marks the one that is chosen."""
    for renderer in plot.renderers:
        renderer.nonselection_glyph = None  # others than the chosen case keep their looks
    ring = {"size": 22, "fill_color": None, "line_color": "#cc79a7", "line_width": 2.5, "name": "ring"}
    plot.scatter("x", "y", source=drawing.marked, **ring)
    tips = [("case", "@case"), ("over", "@x{custom}"), ("quantity", "@y{custom}"), ("uncertainty", "@error{custom}")]
    formatters = {f"@{key}": number(panels.AxisUnit(1.0, units.REDUCED)) for key in ("x", "y", "error")}
    plot.add_tools(HoverTool(renderers=[drawn], tooltips=tips, formatters=formatters))
    open_case = CustomJS(args={"source": drawing.source}, code=_OPEN)
    plot.add_tools(TapTool(renderers=[drawn], callback=open_case))


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
