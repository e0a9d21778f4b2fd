"""Numbers at the time and bead that are chosen, a mark there on the maps, and a link that opens the page there."""

from collections.abc import Sequence
from typing import Any

from bokeh.models import Button, ColumnDataSource, CustomJS, Div, Select, Slider

from granchain.parts import panels
from workflow.plugins.pages.downsample import Thinned
from workflow.plugins.pages.plots import DARK_CONTROL, MAPPED, lists, shown_quantities
from workflow.plugins.pages.traces import ALL
from workflow.plugins.pages.units import Units

_READ = """
const i = beads.indexOf(Number(bead.value));
const k = Math.min(time.length - 1, Math.round((slider.value - slider.start) / slider.step));
marked.data = {x: [places[i]], y: [time[k]]};
const rows = chains.flatMap((number, c) => {
  const wanted = !chain || [all, String(number)].includes(chain.value);
  for (const mark of marks[c]) mark.visible = wanted;
  if (!wanted) return [];
  const cells = quantities.map(({name}) => {
    const value = images[c].data[name][0][k * beads.length + i];
    return isNaN(value) ? '\N{EN DASH}' : String(+value.toPrecision(6));
  });
  return [`<tr><th scope="row">bead ${beads[i]} of chain ${number}</th><td>${cells.join('</td><td>')}</td></tr>`];
});
const heads = quantities.map(({words, unit}) => `<th scope="col">${words}${unit}</th>`).join('');
const when = String(+time[k].toPrecision(6)) + time_unit;
readout.text = `<table><tr><th scope="col">t = ${when}</th>${heads}</tr>${rows.join('')}</table>`;
"""

_COPY = """
const values = {t: String(+slider.value.toPrecision(9)), bead: bead.value};
if (chain && chain.value != all) values.chain = chain.value;
const fragment = '#' + new URLSearchParams(values);
try { history.replaceState(null, '', fragment); } catch { location.hash = fragment; }
const show = words => { button.label = words; setTimeout(() => { button.label = label; }, 2000); };
const in_bar = () => show('link is in the address bar');
navigator.clipboard ? navigator.clipboard.writeText(location.href).then(() => show('link copied'), in_bar) : in_bar();
"""

_OPEN = """
const open = () => {
  const link = new URLSearchParams(location.hash.slice(1)), text = link.get('t')?.trim(), time = Number(text);
  const frame = Math.round((time - slider.start) / slider.step);
  if (chain?.options.some(([value]) => value == link.get('chain'))) chain.value = link.get('chain');
  if (bead.options.includes(link.get('bead'))) bead.value = link.get('bead');
  if (text && frame >= 0 && frame <= Math.round((slider.end - slider.start) / slider.step))
    slider.value = slider.start + frame * slider.step;
};
window.addEventListener('hashchange', open);
open();
"""

_TABLE = """
table { max-width: 100%; }
th, td { text-align: right; vertical-align: bottom; padding: 0 0 0 .7em; font-weight: normal; }
td { white-space: nowrap; }
th:first-child { text-align: left; padding-left: 0; }
tr:first-child th + th { max-width: 8em; }
"""


def selection(
    part: Thinned,
    units: Units,
    maps: Sequence[Any],
    slider: Slider,
    bead: Select,
    chain: Select | None,
) -> tuple[Any, Div]:
    """A button that makes a link to what is chosen, and the numbers there.

    Args:
        part: of a run's frames, in units of the page.
        units: of the page.
        maps: of the chains, on which the choice is marked.
        slider: choice of the time.
        bead: choice of the bead.
        chain: choice of the chain, or of all; None where there is one.
    """
    marked = ColumnDataSource(name="marked", data={"x": [], "y": []})
    looks = ({"line_color": "#000000", "line_width": 4.5}, {"line_color": "#ffe100", "line_width": 2})
    marks = [
        [plot.scatter("x", "y", source=marked, size=12, fill_color=None, **look) for look in looks] for plot in maps
    ]
    styles = {"overflow-x": "auto", "max-width": "100%"}
    readout = Div(name="readout", stylesheets=[_TABLE], styles=styles, sizing_mode="stretch_width")
    readout.html_attributes = {"role": "region", "aria-label": "numbers at the chosen time and bead"}
    choices = {"slider": slider, "bead": bead, "chain": chain, "all": ALL}
    arguments = {
        **lists(part),
        **choices,
        "images": [plot.renderers[0].data_source for plot in maps],
        "marked": marked,
        "marks": marks,
        "readout": readout,
        "quantities": [
            {"name": name, "words": MAPPED[name].of_cursor, "unit": in_brackets(units[MAPPED[name].unit])}
            for name in shown_quantities(part)
        ],
        "time_unit": units["time"].behind,
    }
    read = CustomJS(args=arguments, code=_READ)
    for control in filter(None, (slider, bead, chain)):
        control.js_on_change("value", read)
    maps[0].js_on_change("inner_width", read)  # once, when the page is laid out
    button = Button(label="copy link", name="link", width=150, stylesheets=[DARK_CONTROL])
    button.js_on_event("button_click", CustomJS(args={**choices, "button": button, "label": button.label}, code=_COPY))
    return button, readout


def open_link(root: Any) -> CustomJS:
    """Script that chooses the time, bead and chain that the page's address names; what is not on the page is ignored.

    Args:
        root: layout of the page.
    """
    choices = {name: root.select_one({"name": choice}) for name, choice in _CHOICES.items()}
    return CustomJS(args=choices, code=_OPEN)


def in_brackets(unit: panels.AxisUnit) -> str:
    """What stands behind a quantity: ``" (mm/s)"``, or nothing."""
    return f" ({unit.symbol})" if unit.behind else ""


_CHOICES = {"slider": "time", "bead": "bead", "chain": "chain"}
"""Choices that a link names, and their names on the page."""
