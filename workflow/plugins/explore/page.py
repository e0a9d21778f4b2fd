"""One tab of the explorer: a form with the numbers of a scene, and what the reference computes of it."""

import threading
import time
from collections.abc import Callable
from functools import partial
from html import escape
from typing import Any, NamedTuple

from bokeh.document import Document
from bokeh.events import DocumentReady
from bokeh.layouts import column, row
from bokeh.models import Button, CheckboxGroup, CustomJS, Div, Slider, TextInput

from granchain import InputError, RunError, Scene
from granchain.parts import analysis_lines, fields, html, library, numbers, provenance, references, screen, strict_yaml
from workflow.plugins.explore.compute import ComputedScene, computed
from workflow.plugins.explore.picture import Picture
from workflow.plugins.explore.scene_numbers import SWITCHED, SceneNumber, numbers_of, read, slider_range, written
from workflow.plugins.pages.write import TEMPLATE, page_scripts

_FIELD = """
.bk-input-group > label { white-space: nowrap; }
@media (prefers-color-scheme: dark) { .bk-input { background-color: #26292f; color: #ddd; } }
"""

_WRAPPED = "pre { white-space: pre-wrap; }"

_FIELD_WIDTH = 110

_HIDDEN_TITLE = ".bk-slider-title { display: none; }"
"""The field beside a slider has the same words; as its title they are the slider's name for screen readers."""

_COPY = "navigator.clipboard.writeText(text.tags[0])"

_SAVE = """
const link = document.createElement('a');
link.href = URL.createObjectURL(new Blob([text.tags[0]], {type: 'application/yaml'}));
link.download = name + '.yaml';
link.click();
URL.revokeObjectURL(link.href);
"""


LATE = 300
"""Milliseconds after which a page says that it is computing."""


class Answer(NamedTuple):
    """What came of a change: its run, if it was computed, and a line on that."""

    result: ComputedScene | None
    line: str


def answer(plain: dict[str, Any], source: str, validated: Callable[[Scene], None]) -> Answer:
    """Validate and compute a scene.

    Args:
        plain: its plain data.
        source: what the user calls it, for messages.
        validated: called with the scene before it is computed.
    """
    started = time.perf_counter()
    try:
        scene = library.from_plain(plain, source)
        validated(scene)
        result = computed(scene)
    except (InputError, RunError) as error:
        return Answer(None, str(error))
    except Exception as error:  # no memory, or a mistake of ours: the page goes on
        return Answer(None, f"{type(error).__name__}: {error}")
    seconds = numbers.time_text(time.perf_counter() - started)
    return Answer(result, f"uncertainty of velocities {result.uncertainty:.1e} V; computed in {seconds}")


class Tab:
    """State of one tab, which ends with it.

    Args:
        document: Bokeh's, empty.
        scene: what the numbers are of at first.
        source: what the user calls it, for messages.
    """

    def __init__(self, document: Document, scene: Scene, source: str) -> None:
        self._document, self._source = document, source
        self._all = scene.plain()
        self._left_out: set[str] = set()
        self._computing: dict[str, Any] | None = None
        self._closed = False
        self._picture: Picture | None = None
        self._sentences = ""
        self._status = Div(name="status", sizing_mode="stretch_width", disable_math=True)
        self._plots = column(Div(), sizing_mode="stretch_width")
        self._units = Div(name="units", sizing_mode="stretch_width", disable_math=True)
        self._yaml = Div(name="yaml", sizing_mode="stretch_width", stylesheets=[_WRAPPED])
        self._widgets: dict[str, list[Any]] = {}
        form = column(*self._form(), *self._saving(scene.name), styles={"flex": "1 1 300px"}, name="form")
        results = column(self._status, self._plots, styles={"flex": "4 1 560px", "min-width": "0"})
        for part in (form, results):
            part.sizing_mode = "stretch_width"
        document.add_root(row(form, results, styles={"flex-wrap": "wrap", "gap": "1rem"}, sizing_mode="stretch_width"))
        document.title = f"{scene.name}: explore"
        document.template = TEMPLATE
        cited = references.of_scene(scene)
        del cited[references.OF_ENGINE]  # LAMMPS, which computes nothing here
        document.template_variables["head"] = f"<p>{escape(scene.description)}</p>"
        document.template_variables["foot"] = provenance.foot(
            dict.fromkeys(key for keys in cited.values() for key in keys)
        )
        for code in page_scripts(document):
            document.js_on_event(DocumentReady, code)
        document.on_session_destroyed(self._close)
        self._show_scene(scene)
        self._compute_if_idle()

    # --- form ---------------------------------------------------------------------------------------------------------

    def _form(self) -> list[Any]:
        """Sliders, fields and switches, in the order of the scene's keys."""
        parts: list[Any] = []
        of_scene = numbers_of(self._all)
        for key in self._all:
            of_key = [number for number in of_scene if number.key == key]
            self._widgets[key] = [self._number(number) for number in of_key]
            if key in SWITCHED:
                parts.append(self._switch(key))
            parts += self._widgets[key]
        return [self._units, *parts]

    def _switch(self, key: str) -> CheckboxGroup:
        switch = CheckboxGroup(labels=[key], active=[0], styles={"font-weight": "bold"})
        switch.on_change("active", lambda _attribute, _before, active: self._turn(key, bool(active)))
        return switch

    def _turn(self, key: str, active: bool) -> None:
        """Leave a key of the scene out, or take it in again."""
        (self._left_out.discard if active else self._left_out.add)(key)
        for widget in self._widgets[key]:
            widget.visible = active
        self._compute_if_idle()

    def _number(self, number: SceneNumber) -> Any:
        """Field of a number, with a slider where it is one."""
        field = TextInput(title=number.label, value=written(number.value), name=number.name, stylesheets=[_FIELD])
        if not number.slides:
            field.sizing_mode = "stretch_width"
            field.on_change("value", lambda _attribute, _before, words: self._typed(number, words))
            return field
        is_whole = fields.is_whole(number.path)
        area = slider_range(number, number.value)
        slider = Slider(
            title=number.label,
            name=f"slider {number.name}",
            start=area.start,
            end=area.end,
            step=area.step,
            value=number.value,
            show_value=False,
            stylesheets=[_HIDDEN_TITLE],
            sizing_mode="stretch_width",
            margin=(26, 15, 0, 10),  # beside the field, below its title
        )
        slider.on_change(
            "value",
            lambda _attribute, _before, value: self._slid(number, area.rounded(value, is_whole=is_whole), field),
        )
        field.on_change("value", lambda _attribute, _before, words: self._typed(number, words, slider))
        field.width = _FIELD_WIDTH
        return row(field, slider, sizing_mode="stretch_width")

    def _slid(self, number: SceneNumber, value: float, field: TextInput) -> None:
        if value != self._value(number):
            self._set(number, value)
            field.value = written(value)
            self._compute_if_idle()

    def _typed(self, number: SceneNumber, words: str, slider: Slider | None = None) -> None:
        try:
            value = read(words, number)
        except InputError as error:
            self._say(str(error), wrong=True)
            return
        if value == self._value(number):
            return
        self._set(number, value)
        if slider is not None and isinstance(value, int | float):
            if not slider.start <= value <= slider.end:
                area = slider_range(number, value)
                slider.update(start=area.start, end=area.end, step=area.step)
            slider.value = value
        self._compute_if_idle()

    def _value(self, number: SceneNumber) -> Any:
        return fields.look_up(self._all, number.path)

    def _set(self, number: SceneNumber, value: Any) -> None:
        self._all = fields.put(self._all, number.path, value)

    def _saving(self, name: str) -> list[Any]:
        """The scene as YAML, to copy or to save."""
        buttons = []
        for label, code in (("copy", _COPY), ("save", _SAVE)):
            buttons.append(Button(label=f"{label} YAML", name=label))
            buttons[-1].js_on_click(CustomJS(args={"text": self._yaml, "name": name}, code=code))
        return [row(*buttons), self._yaml]

    # --- computation --------------------------------------------------------------------------------------------------

    def _wanted(self) -> dict[str, Any]:
        return {key: value for key, value in self._all.items() if key not in self._left_out}

    def _compute_if_idle(self) -> None:
        """Compute the scene in a thread, unless one is being computed: the last change is then computed after that."""
        if self._computing is not None or self._closed:
            return
        plain = self._computing = self._wanted()
        self._document.add_timeout_callback(lambda: self._say_late(plain), LATE)
        # a daemon, so that the program ends at once
        threading.Thread(target=self._compute, args=(plain,), daemon=True).start()

    def _say_late(self, plain: dict[str, Any]) -> None:
        if self._computing is plain:
            self._say("computing")

    def _compute(self, plain: dict[str, Any]) -> None:
        with screen.with_hints(lambda text: self._next(partial(self._say, text))):
            computed_answer = answer(plain, self._source, lambda scene: self._next(partial(self._show_scene, scene)))
        self._next(partial(self._finish, computed_answer))

    def _next(self, callback: Callable[[], None]) -> None:
        """Call a function in the server's thread, unless the tab has been closed."""
        if not self._closed:
            self._document.add_next_tick_callback(callback)

    def _finish(self, computed_answer: Answer) -> None:
        """Show what came of a change; compute the last one if there was another meanwhile."""
        before, self._computing = self._computing, None
        self._document.hold("combine")
        try:
            self._show(computed_answer)
        finally:
            self._document.unhold()
        if before != self._wanted():
            self._compute_if_idle()

    def _close(self, _context: Any) -> None:
        self._closed = True

    # --- results ------------------------------------------------------------------------------------------------------

    def _show(self, outcome: Answer) -> None:
        if outcome.result is None:
            self._say(outcome.line, wrong=True)
            return
        self._sentences = _listed(outcome.result)
        self._say(outcome.line)
        if self._picture is None or not self._picture.renew(outcome.result):
            self._picture = Picture(outcome.result, None if self._picture is None else self._picture.bead)
            self._plots.children = [self._picture.root]
        self._status.tags = list(self._yaml.tags)  # the scene that is shown, once it is

    def _say(self, line: str, *, wrong: bool = False) -> None:
        role = "alert" if wrong else "status"
        style = " style='color: #d33; font-weight: bold'" if wrong else ""
        self._status.text = f"<p role='{role}'{style}>{escape(line)}</p>{self._sentences}"

    def _show_scene(self, scene: Scene) -> None:
        self._units.text = escape(scene.units)
        text = strict_yaml.dump(scene.plain())
        self._yaml.update(text=html.text(text), tags=[text])


def _listed(result: ComputedScene) -> str:
    """Sentences on the pulses, as `granchain analyze` prints them."""
    sentences = "".join(f"<li>{escape(sentence)}</li>" for sentence in analysis_lines.of_pulses(result.survey))
    return f"<ul>{sentences}</ul>"
