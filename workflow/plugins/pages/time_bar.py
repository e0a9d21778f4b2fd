"""The time of a page: a slider, steps of one frame, and play at a chosen speed."""

import math
from typing import Any

from bokeh.layouts import row
from bokeh.models import Button, CustomJS, CustomJSTickFormatter, Slider, Toggle

from granchain.parts import panels
from workflow.plugins.pages.downsample import Thinned
from workflow.plugins.pages.plots import DARK_CONTROL, choice

SPEEDS = ("0.1", "0.25", "0.5", "1", "2", "4", "10")
"""Speeds of play, over that at which a run takes some 16 s."""

_PLAY = """
clearInterval(window.playing);
const last = Math.round((slider.end - slider.start) / slider.step), jump = Math.max(1, Math.round(last / 400));
let played;  // in frames; the slider stands at whole ones
if (button.active) window.playing = setInterval(() => {
  const k = Math.round((slider.value - slider.start) / slider.step);
  if (Math.floor(played) != k) played = k;
  played = k >= last ? 0 : Math.min(last, played + jump * Number(speed.value));
  slider.value = slider.start + Math.floor(played) * slider.step;
}, 40);
"""

_STEP = """
const last = Math.round((slider.end - slider.start) / slider.step);
const k = Math.round((slider.value - slider.start) / slider.step) + frames;
slider.value = slider.start + Math.max(0, Math.min(last, k)) * slider.step;
"""

_TIME = "return tick.toFixed(digits) + unit"


def time_bar(part: Thinned, unit: panels.AxisUnit) -> tuple[Slider, Any]:
    """A slider whose values are times, and the bar in which it stands with what moves it.

    Args:
        part: of a run's frames, in units of the page.
        unit: of its times.
    """
    slider = _slider(part, unit)
    play = Toggle(label="play / pause", width=100, name="play", stylesheets=[DARK_CONTROL])
    steps = []
    for name, frames in (("back", -1), ("forward", 1)):
        steps.append(Button(label=name, width=70, name=name, stylesheets=[DARK_CONTROL]))
        steps[-1].js_on_event("button_click", CustomJS(args={"slider": slider, "frames": frames}, code=_STEP))
    speed = choice("speed", "1", [(value, f"{value} x") for value in SPEEDS], "speed")
    speed.width = 80
    play.js_on_change("active", CustomJS(args={"slider": slider, "button": play, "speed": speed}, code=_PLAY))
    controls = row(play, *steps, speed, styles={"align-items": "end"})
    slider.styles = {"flex": "1 1 320px"}
    bar = row(controls, slider, sizing_mode="stretch_width", styles={"flex-wrap": "wrap", "align-items": "end"})
    return slider, bar


def _slider(part: Thinned, unit: panels.AxisUnit) -> Slider:
    """A slider whose values are times, written to a tenth of the time between frames."""
    digits = max(0, 1 - math.floor(math.log10(part.every)))
    written = CustomJSTickFormatter(args={"digits": digits, "unit": unit.behind}, code=_TIME)
    start = float(part.time[0])
    end = start + max(1, len(part.time) - 1) * part.every
    slider = Slider(start=start, end=end, value=start, step=part.every, title="time", name="time", format=written)
    slider.sizing_mode = "stretch_width"
    return slider
