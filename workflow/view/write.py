"""The page of a directory, of a run or of a sweep: files of HTML that need no other."""

import warnings
from collections.abc import Iterable
from html import escape
from pathlib import Path
from typing import Any

from bokeh.embed import file_html
from bokeh.events import DocumentReady
from bokeh.models import CustomJS, Plot
from bokeh.resources import INLINE

from analysis.figures.style import axis_unit, shown_chains
from analysis.files.binary_dump import CutDumpWarning
from lammps_inputs import InputError, Problem, Scene, file_names, references, strict_yaml
from lammps_inputs.ingredients.unequal import radii
from workflow import provenance
from workflow.runs.files import write_text
from workflow.runs.job import Job
from workflow.runs.own_files import claim
from workflow.runs.run_directory import RunDirectory
from workflow.sweep.collect import collect
from workflow.verdicts.analyse import analyse, default_beads
from workflow.verdicts.findings.gauges import Forces
from workflow.view.run_page import layout
from workflow.view.sweep_page import layout as sweep_layout
from workflow.view.thin import Thinned, thinned

# --- HTML -------------------------------------------------------------------------------------------------------------

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


def folded(heading: str, text: str) -> str:
    """A text that unfolds when its heading is clicked."""
    return f"<details><summary>{escape(heading)}</summary><pre>{escape(text)}</pre></details>"


def render(title: str, root: Any, *, head: str, foot: str) -> str:
    """The page.

    Args:
        title: its heading, as text.
        root: a Bokeh layout.
        head, foot: HTML above and below; the latter with `workflow.provenance.foot`.

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


# --- directories ------------------------------------------------------------------------------------------------------

VIEW = "view.html"

FINE = 0.5
"""Time between frames up to which a pulse is followed closely, in units of T."""


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
    lines, found, readings = [], None, None
    try:
        analysis = analyse(directory, figures=False)
        found = analysis.survey
        readings = next((one.readings for one in analysis.findings.values() if isinstance(one, Forces)), None)
        if problem.chains > 1:
            lines.append(f"Equipartition: {found.verdict.sentence}.")
        if not analysis.complete:
            lines.append("The run is incomplete; what there is is shown.")
    except InputError as error:
        lines.append(f"Not analysed: {error}")
    check = directory.job.check
    if check is not None and check.velocity is not None:
        lines.append(f"Error against the reference: velocities {check.velocity:.1e} V.")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", CutDumpWarning)  # that the run is incomplete is said in words
        part = thinned(problem, directory.blocks(), shown_chains(problem))
    lines += _left_out(problem, part)
    texts = {"scene": strict_yaml.dump(scene.plain())}
    if (path / file_names.DECK).is_file():
        texts[file_names.DECK] = (path / file_names.DECK).read_text(encoding="utf-8", errors="replace")
    foot = "".join(folded(heading, text) for heading, text in texts.items())
    made = render(
        f"{scene.name}: {problem.chains} x {problem.beads} beads",
        layout(problem, part, found, list(default_beads(problem)), readings=readings, radius=radii(scene)),
        head="".join(f"<p>{escape(line)}</p>" for line in (scene.description, *lines) if line),
        foot=foot + provenance.foot(_cited([scene]), _computed(directory.job)),
    )
    claim(path, (VIEW,))
    write_text(path / VIEW, made)
    return path / VIEW


def _cited(scenes: Iterable[Scene]) -> list[str]:
    """Publications that some scenes use, none twice."""
    return list(dict.fromkeys(key for scene in scenes for keys in references.of_scene(scene).values() for key in keys))


def _computed(job: Job) -> str:
    """When, where and with which versions a run was computed, as far as it recorded that."""
    versions = " and ".join(f"{name} {job.versions[name]}" for name in ("granchain", "lammps") if name in job.versions)
    parts = [job.started or "", f"with {versions}" if versions else "", f"on {job.machine}" if job.machine else ""]
    return f"The run was computed: {', '.join(filter(None, parts))}." if any(parts) else ""


def _left_out(problem: Problem, part: Thinned) -> list[str]:
    """What a page does not show of a run, in words."""
    apart = problem.every * part.frame_stride
    time = axis_unit(problem, "time", apart)
    distance = f"{apart * time.worth:.3g} {time.symbol}" if problem.scale.si else f"{apart:.3g} T"
    kept = [
        f"{len(part.chains)} of {problem.chains} chains" if len(part.chains) < problem.chains else "",
        f"one bead in {part.bead_stride}" if part.bead_stride > 1 else "",
        f"one frame in {part.frame_stride}, {distance} apart" if part.frame_stride > 1 else "",
    ]
    lines = [f"Shown: {', '.join(filter(None, kept))}; each number is the run's own."] if any(kept) else []
    if part.frame_stride > 1:
        lines.append(
            "Each velocity is the largest in size around its frame, so that no peak is lost;"
            " displacement, overlap, force and energy are those at its time."
        )
    if apart > FINE:
        lines.append(
            f"Frames shown are {distance} apart, too far to follow a pulse closely: "
            + ("overlaps and forces" if problem.every <= FINE else "velocities, overlaps and forces")
            + " may have been larger between them."
        )
    if problem.window is not None:
        lines.append("Grey: the window has left; what happened there is not known.")
    return lines


def _sweep(directory: Path) -> Path:
    table = collect(directory)
    pages = {row["case"]: VIEW if (directory / row["case"] / VIEW).is_file() else "" for row in table.rows}
    made = render(
        f"{table.scene or directory.name}: {len(table.rows)} cases",
        sweep_layout(table, pages),
        head="<p>Click a column's head to sort, a case or a point to open it"
        " (<code>granchain view " + escape(str(directory.name)) + "/CASE</code> makes a case's page).</p>",
        foot=provenance.foot(_cited(RunDirectory(directory / row["case"]).scene for row in table.rows)),
    )
    path = directory / VIEW
    if path.exists() and not path.read_text(encoding="utf-8", errors="replace").startswith("<!DOCTYPE html>"):
        raise InputError(f"{path}: exists and is no page of granchain's; move it away")
    write_text(path, made)
    return path
