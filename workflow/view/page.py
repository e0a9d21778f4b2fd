"""One HTML file around plots, tables and text; needs no network, no server, and is readable in dark mode."""

from collections.abc import Sequence
from html import escape
from typing import Any

from bokeh.embed import file_html
from bokeh.events import DocumentReady
from bokeh.models import CustomJS, Plot
from bokeh.resources import INLINE

from lammps_inputs import InputError

MOST_BYTES = 10_000_000

_DARK = """
if (!window.matchMedia('(prefers-color-scheme: dark)').matches) return;
for (const plot of plots) {
  if (plot.title) plot.title.text_color = '#ddd';
  plot.background_fill_color = '#1b1d21'; plot.border_fill_color = '#1b1d21'; plot.outline_line_color = '#777';
  for (const part of [...plot.above, ...plot.below, ...plot.left, ...plot.right, ...plot.center]) {
    for (const name of ['axis_label_text_color', 'major_label_text_color', 'axis_line_color', 'major_tick_line_color',
                        'minor_tick_line_color', 'text_color', 'label_text_color', 'title_text_color'])
      if (name in part) part[name] = '#ddd';
    if ('grid_line_color' in part) part.grid_line_color = '#3a3d44';
    if ('background_fill_color' in part) part.background_fill_color = '#1b1d21';
  }
}
"""

_TEMPLATE = """{% block preamble %}
<meta name="viewport" content="width=device-width, initial-scale=1">
<link rel="icon" href="data:,">
<style>
:root { color-scheme: light dark; }
html { height: auto; }
body { font: 15px/1.45 system-ui, sans-serif; max-width: 88rem; height: auto; }
html > body { margin: 1.2rem auto; padding: 0 1rem; }
@media (prefers-color-scheme: dark) { body { background: #1b1d21; color: #ddd; } a { color: #8ab4f8; } }
pre { overflow: auto; font-size: .85rem; }
h1 { font-size: 1.4rem; margin: 0 0 .3rem; }
p { margin: .2rem 0; }
summary { cursor: pointer; }
</style>
{% endblock %}
{% block contents %}
<h1>{{ title }}</h1>
{{ head }}
{{ super() }}
{{ foot }}
{% endblock %}
"""


def paragraphs(lines: Sequence[str]) -> str:
    """Text as HTML."""
    return "".join(f"<p>{escape(line)}</p>" for line in lines)


def folded(heading: str, text: str) -> str:
    """A text that unfolds when its heading is clicked."""
    return f"<details><summary>{escape(heading)}</summary><pre>{escape(text)}</pre></details>"


def render(title: str, root: Any, *, head: str, foot: str = "") -> str:
    """The page.

    Args:
        title: its heading, as text.
        root: a Bokeh layout.
        head, foot: HTML above and below.

    Raises:
        InputError: it would be larger than `MOST_BYTES`.
    """
    from bokeh.document import Document

    document = Document()
    document.add_root(root)
    plots = [model for model in document.models if isinstance(model, Plot)]
    document.js_on_event(DocumentReady, CustomJS(args={"plots": plots}, code=_DARK))
    variables = {"head": head, "foot": foot}
    made: str = file_html(document, INLINE, title=escape(title), template=_TEMPLATE, template_variables=variables)
    if len(made) > MOST_BYTES:
        raise InputError(f"view: {title}: the page would have {len(made) / 1e6:.0f} MB; record fewer beads or frames")
    return made
