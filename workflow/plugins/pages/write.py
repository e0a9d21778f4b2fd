"""The page of a directory, of a run or of a sweep: files of HTML that need no other."""

from collections.abc import Iterable
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
from bokeh.embed import file_html
from bokeh.events import DocumentReady
from bokeh.models import CustomJS, GridPlot, Plot, SaveTool, Slider
from bokeh.resources import INLINE

from granchain import InputError, analyze
from granchain.parts import (
    Problem,
    RunDirectory,
    analyse,
    analysis_lines,
    collect,
    engines,
    file_names,
    output_directory,
    panels,
    physics,
    provenance,
    radii,
    references,
    screen,
    strict_yaml,
    validate,
    validate_run,
    write_text,
)
from workflow.plugins.pages import compare_page
from workflow.plugins.pages.compared import (
    compared_lines,
    compared_tables,
    setting_table,
)
from workflow.plugins.pages.downsample import Thinned, thinned
from workflow.plugins.pages.results import results, sentence
from workflow.plugins.pages.run_page import layout
from workflow.plugins.pages.selection import open_link
from workflow.plugins.pages.sweep_page import layout as sweep_layout
from workflow.plugins.pages.units import page_unit

# --- HTML -------------------------------------------------------------------------------------------------------------

MOST_BYTES = 10_000_000

LAMMPS = "lammps"
"""Engine whose version a page states."""

_DARK = """
if (!window.matchMedia('(prefers-color-scheme: dark)').matches) return;
for (const plot of plots) {
  if (plot.title) plot.title.text_color = '#ddd';
  plot.background_fill_color = '#1b1d21'; plot.outline_line_color = '#777';
  for (const part of [...plot.above, ...plot.below, ...plot.left, ...plot.right, ...plot.center]) {
    for (const name of ['axis_label_text_color', 'major_label_text_color', 'axis_line_color', 'major_tick_line_color',
                        'minor_tick_line_color', 'text_color', 'label_text_color', 'title_text_color'])
      if (name in part) part[name] = '#ddd';
    if ('grid_line_color' in part) part.grid_line_color = '#3a3d44';
    if ('background_fill_color' in part) part.background_fill_color = '#1b1d21';
  }
}
"""

_NAMED = """
for (const {id, title} of sliders)
  Bokeh.index.find_one_by_id(id).slider_el.querySelector('.noUi-handle').setAttribute('aria-label', title);
"""
"""Handles of sliders have their title as name, also for screen readers."""

_PRINT_PIXELS = 2100
"""Least width of a saved image: 7 in at 300 dots an inch."""

_FINE = """
const screen = Object.getOwnPropertyDescriptor(window, 'devicePixelRatio');
const legends = view => [...view.renderer_views?.values() ?? []].filter(part => part._paint_glyphs);
let drawing = false;
for (const name of ['Figure', 'GridPlot']) {
  const view = Bokeh.Models.get(name).prototype.default_view.prototype, draw = view.export;
  view.export = function (...options) {
    if (drawing) return draw.apply(this, options);
    const value = Math.max(devicePixelRatio, Math.ceil(width / this.bbox.width));
    const inside = [this, ...this.child_views].flatMap(legends);
    drawing = true;
    Object.defineProperty(window, 'devicePixelRatio', {value, configurable: true});
    try {
      for (const legend of inside) legend._paint_glyphs();
      const image = draw.apply(this, options), {canvas} = image, brush = canvas.getContext('2d');
      brush.setTransform(1, 0, 0, 1, 0, 0);
      brush.globalCompositeOperation = 'destination-over';
      brush.fillStyle = getComputedStyle(document.body).backgroundColor;
      brush.fillRect(0, 0, canvas.width, canvas.height);
      return image;
    } finally {
      Object.defineProperty(window, 'devicePixelRatio', screen);
      for (const legend of inside) legend._paint_glyphs();
      drawing = false;
    }
  };
}
"""
"""Images are saved in so many pixels and on the page's background: Bokeh draws them with the pixels of the screen, for
which it asks the window."""

TEMPLATE = """{% block preamble %}
<meta name="viewport" content="width=device-width, initial-scale=1">
<link rel="icon" href="data:,">
<style>
:root { color-scheme: light dark; }
html { height: auto; }
body { font: 15px/1.45 system-ui, sans-serif; max-width: 88rem; height: auto; background: #fff; }
html > body { margin: 1.2rem auto; padding: 0 1rem; }
@media (prefers-color-scheme: dark) { body { background: #1b1d21; color: #ddd; } a { color: #8ab4f8; } }
pre { overflow: auto; font-size: .85rem; }
h1 { font-size: 1.4rem; margin: 0 0 .3rem; }
p { margin: .2rem 0; }
h1, p, .values th { overflow-wrap: anywhere; }
summary { cursor: pointer; }
#results p, #results table { font-size: .9rem; }
.values { overflow-x: auto; font-size: .9rem; }
.values table { border-collapse: collapse; }
.values caption { text-align: left; font-weight: 600; padding: 1rem 0 .2rem; }
.values td, .values th { text-align: right; vertical-align: top; padding: .1rem .4rem .1rem .8rem; white-space: nowrap;
  border-top: 1px solid #8883; }
.values :is(td, th):first-child { text-align: left; padding-left: 0; font-weight: 400; white-space: normal;
  min-width: 9rem; }
.values td:last-child { min-width: 8rem; white-space: normal; }
</style>
{% endblock %}
{% block contents %}
<h1>{{ title }}</h1>
{{ head }}
{{ super() }}
{{ foot }}
{% endblock %}
"""


def folded(heading: str, text: str) -> str:
    """A text that unfolds when its heading is clicked."""
    return f"<details><summary>{escape(heading)}</summary><pre>{escape(text)}</pre></details>"


def render(title: str, name: str, root: Any, *, head: str, foot: str, ready: Iterable[CustomJS] = ()) -> str:
    """The page.

    Args:
        title: its heading, as text.
        name: that names of saved images begin with.
        root: a Bokeh layout.
        head, foot: HTML above and below; the latter with `workflow.provenance.foot`.
        ready: what to do when it is shown.

    Raises:
        InputError: it would be larger than `MOST_BYTES`.
    """
    from bokeh.document import Document

    document = Document()
    document.add_root(root)
    for code in (themed(root, name), *page_scripts(document), *ready):
        document.js_on_event(DocumentReady, code)
    variables = {"head": head, "foot": foot}
    made: str = file_html(document, INLINE, title=escape(title), template=TEMPLATE, template_variables=variables)
    if len(made) > MOST_BYTES:
        raise InputError(f"view: {title}: the page would have {len(made) / 1e6:.0f} MB; record fewer beads or frames")
    return made


def themed(root: Any, name: str) -> CustomJS:
    """Script that gives plots the colours of the page's theme; it also names their saved images.

    Args:
        root: Bokeh layout that holds the plots.
        name: that names of saved images begin with.
    """
    plots = [model for model in root.references() if isinstance(model, Plot)]
    for plot in plots:
        plot.border_fill_color = None  # the page's; Bokeh leaves a rim of colours that are changed
    for drawn in (*plots, *root.select({"type": GridPlot})):
        for tool in drawn.toolbar.tools:
            if isinstance(tool, SaveTool) and tool.filename is None:
                tool.filename = f"{name}-{drawn.name}"
    return CustomJS(args={"plots": plots}, code=_DARK)


def page_scripts(document: Any) -> tuple[CustomJS, CustomJS]:
    """Scripts that save images in print resolution, and name the sliders of a page for screen readers."""
    sliders = [model for model in document.models if isinstance(model, Slider)]
    return CustomJS(args={"width": _PRINT_PIXELS}, code=_FINE), CustomJS(args={"sliders": sliders}, code=_NAMED)


# --- directories ------------------------------------------------------------------------------------------------------

VIEW = "view.html"

FINE = 0.5
"""Time between frames up to which a pulse is followed closely, in units of T in contacts of strength 1."""


def write(directory: Path) -> Path:
    """Write ``view.html`` into a directory.

    Raises:
        InputError: there is nothing to be seen in it.
    """
    if not directory.is_dir():
        raise InputError(f"{directory}: no such directory")
    if (directory / file_names.SCENE).is_file():
        return _run(directory)
    if not any((path / file_names.SCENE).is_file() for path in directory.iterdir()):
        raise InputError(f"{directory}: neither a run nor a sweep; it has no {file_names.SCENE}")
    return _sweep(directory)


def _run(path: Path) -> Path:
    directory = RunDirectory(path)
    problem, scene = directory.problem, directory.scene
    lines, shown_results, survey, measurements = [sentence(scene.units)], "", None, None
    try:
        analysis = analyze(directory.path, figures=False)
        survey = analysis.survey
        measurements = analysis.measurements
        shown_results = results(analysis_lines.lines(analysis))
    except InputError as error:
        lines.append(f"Not analysed: {error}")
    check = directory.job.check
    if check is not None and check.velocity is not None:
        lines.append(f"Error against the reference: velocities {check.velocity:.1e} V.")
    part = thinned(problem, directory.blocks_so_far(), panels.shown_chains(problem))
    lines += _left_out(problem, part)
    texts = {"scene": strict_yaml.dump(scene.plain())}
    if (path / file_names.DECK).is_file():
        texts[file_names.DECK] = (path / file_names.DECK).read_text(encoding="utf-8", errors="replace")
    foot = "".join(folded(heading, text) for heading, text in texts.items())
    root = layout(
        problem,
        part,
        survey,
        list(analyse.default_beads(problem)),
        measurements=measurements,
        radius=radii(scene.setting),
    )
    made = render(
        f"{scene.name}: {problem.chains} x {problem.beads} beads",
        scene.name,
        root,
        head="".join(f"<p>{escape(line)}</p>" for line in (scene.description, *lines) if line) + shown_results,
        ready=[open_link(root)],
        foot=foot + provenance.foot(_cited([directory]), _computed(directory)),
    )
    output_directory.record_files(path, (VIEW,))
    write_text(path / VIEW, made)
    return path / VIEW


def _cited(runs: Iterable[RunDirectory]) -> list[str]:
    """Publications that some runs use: on their scenes and on what computed or checked them; none twice."""
    keys: dict[str, None] = {}
    for run in runs:
        cited = references.of_scene(run.scene)
        if run.engine != "lammps":
            del cited[references.OF_ENGINE]
        if run.engine not in ("lammps", "reference"):
            del cited[references.OF_REFERENCE]
        keys |= dict.fromkeys(key for of_subject in cited.values() for key in of_subject)
    return list(keys)


def _computed(directory: RunDirectory) -> str:
    """Sentence on the engine, time and machine by which a run was computed, as far as it recorded them."""
    job, engine = directory.job, engines.engine_called(directory.engine).title
    if directory.engine == "lammps":
        engine = f"{engine} {job.lammps or job.versions.get('lammps', '')}".rstrip()
    granchain = job.versions.get("granchain")
    parts = [engine, f"granchain {granchain}" if granchain else "", job.started or "", job.machine or ""]
    return f"The run was computed by {', '.join(filter(None, parts))}."


def _shown(problem: Problem, part: Thinned) -> list[str]:
    """Which part of its frames a page shows of a run, in words; empty where it shows all."""
    apart = problem.every * part.frame_stride
    time = page_unit(problem, "time", apart)
    distance = f"{apart * time.worth:.3g} {time.symbol}" if problem.scale.si else f"{apart:.3g} T"
    parts = [
        f"{len(part.chains)} of {problem.chains} chains" if len(part.chains) < problem.chains else "",
        f"one bead in {part.bead_stride}" if part.bead_stride > 1 else "",
        f"one frame in {part.frame_stride}, {distance} apart" if part.frame_stride > 1 else "",
    ]
    return [f"Shown: {', '.join(filter(None, parts))}; each number is the run's own."] if any(parts) else []


def _left_out(problem: Problem, part: Thinned) -> list[str]:
    """What a page does not show of a run, in words."""
    apart = problem.every * part.frame_stride
    time = page_unit(problem, "time", apart)
    distance = f"{apart * time.worth:.3g} {time.symbol}" if problem.scale.si else f"{apart:.3g} T"
    lines = _shown(problem, part)
    if part.frame_stride > 1:
        lines.append(
            "Each velocity is the largest in size around its frame, so that no peak is lost;"
            " displacement, overlap, force and energy are those at its time."
        )
    forces = ["overlaps", "forces"] if np.any(np.isfinite(part.force)) else []
    fine = FINE * physics.pulse_time(problem.system)
    unknown = [*(["velocities"] if problem.every > fine else []), *forces]
    if apart > fine and unknown:
        *others, last = unknown
        names = f"{', '.join(others)} and {last}" if others else last
        lines.append(
            f"Frames shown are {distance} apart, too far to follow a pulse closely: {names} may have been larger "
            "between them."
        )
    if problem.rows.follow:
        lines.append("Grey: the window has left; what happened there is not known.")
    return lines


# --- comparisons ------------------------------------------------------------------------------------------------------


def write_comparison(directory: RunDirectory, against: RunDirectory) -> Path:
    """Write ``against-B.html`` into the directory of a run, where B is the name of the directory of another one.

    Raises:
        InputError: they have other numbers of chains or beads, other units, or no bead or time in common.
    """
    runs = directory, against
    comparison, _ = validate_run.compare_runs(runs)
    return _compared(runs, comparison, f"against-{against.path.resolve().name}.html")


def write_validation(directory: RunDirectory, comparison: validate.Validation, against: RunDirectory | None) -> Path:
    """Write the page of a validation into the directory of its run.

    Args:
        directory: directory of the run.
        comparison: the validation.
        against: the run that it was compared with; None for the reference.
    """
    return _compared((directory,) if against is None else (directory, against), comparison, comparison.page)


def _compared(runs: tuple[RunDirectory, ...], comparison: validate.Validation, file: str) -> Path:
    """Write the page of a comparison into the directory of its run.

    Args:
        runs: the run, and the other one where it was not compared with the reference.
        comparison: what differs.
        file: name of the page.
    """
    directory, problem = runs[0], comparison.problem
    first, second = [*(run.path.resolve().name for run in runs), comparison.against][:2]
    pairs = validate_run.compared_pairs(runs, comparison)
    frames = compare_page.compared_frames(problem, pairs, panels.shown_chains(problem))
    root, choose = compare_page.layout(problem, frames, (first, second), analyse.default_beads(problem)[0])
    lines = [*compared_lines(runs, comparison), *_shown(problem, frames.first)]
    if frames.first.frame_stride > 1:
        lines.append("Each velocity and each difference is the largest in size around its frame.")
    if problem.rows.follow:
        lines.append("Grey: the window has left.")
    made = render(
        f"{directory.scene.name}: {first} against {second}",
        f"{directory.scene.name}-{Path(file).stem}",
        root,
        ready=[choose],
        head="".join(f"<p>{escape(line)}</p>" for line in lines) + _html_tables(setting_table(runs, comparison)),
        foot=_html_tables(*compared_tables(runs, comparison)) + provenance.foot(_cited(runs)),
    )
    output_directory.record_files(directory.path, (file,))
    write_text(directory.path / file, made)
    return directory.path / file


def _html_tables(*tables: screen.PrintedTable | None) -> str:
    """Tables as they are printed on a screen, in HTML, without those that are None; wide ones scroll."""
    return "".join(map(_html_table, filter(None, tables)))


def _html_table(table: screen.PrintedTable) -> str:
    head = "".join(f'<th scope="col">{escape(cell)}</th>' for cell in table.head)
    rows = "".join(
        f'<tr><th scope="row">{escape(name)}</th>{"".join(f"<td>{escape(cell)}</td>" for cell in cells)}</tr>'
        for name, *cells in table.rows
    )
    parts = f"<caption>{escape(table.title)}</caption><thead><tr>{head}</tr></thead><tbody>{rows}</tbody>"
    return f'<div class="values" tabindex="0"><table>{parts}</table></div>'


# --- sweeps -----------------------------------------------------------------------------------------------------------


def _sweep(directory: Path) -> Path:
    table = collect.collect(directory)
    title = table.scene or directory.name
    files = {}
    for case in (row["case"] for row in table.rows):
        page = [VIEW] if (directory / case / VIEW).is_file() else []
        files[case] = [*page, *analyse.figures_in(directory / case)]
    root, ready = sweep_layout(table, files, title, directory.resolve().name)
    made = render(
        f"{title}: {len(table.rows)} cases",
        title,
        root,
        ready=ready,
        head="<p>A click or Enter on a column's head sorts; one on a case opens its page or else its first figure, "
        "where there is one. A case that is chosen, in the list, the table or the plot, is named below the list.</p>",
        foot=provenance.foot(_cited(RunDirectory(directory / row["case"]) for row in table.rows)),
    )
    path = directory / VIEW
    if path.exists() and not path.read_text(encoding="utf-8", errors="replace").startswith("<!DOCTYPE html>"):
        raise InputError(f"{path}: exists and is no page of granchain's; move it away")
    write_text(path, made)
    return path
