"""The pages of a directory: of a run, of a sweep, of a comparison."""

import warnings
from html import escape
from pathlib import Path

from analysis.figures.style import axis_unit, shown_chains
from analysis.files.binary_dump import CutDumpWarning
from lammps_inputs import InputError, Problem, file_names, strict_yaml
from workflow.runs.own_files import claim
from workflow.runs.run_directory import RunDirectory
from workflow.runs.whole_files import write_text
from workflow.sweep.collect import collect
from workflow.verdicts.analyse import analyse, default_beads
from workflow.view.page import folded, paragraphs, render
from workflow.view.run_page import layout
from workflow.view.sweep_page import layout as sweep_layout
from workflow.view.thin import Thinned, thinned

VIEW = "view.html"

FINE = 0.5
"""Time between frames up to which a pulse is followed closely, in units of T."""


def write(directory: Path) -> list[Path]:
    """Write ``view.html`` into a directory; of a comparison, into that of each of its runs.

    Raises:
        InputError: there is nothing to be seen in it.
    """
    if not directory.is_dir():
        raise InputError(f"{directory}: no such directory")
    compared = (directory / "compare.json").is_file()  # beside the scene that was compared
    if (directory / file_names.SCENE).is_file() and not compared:
        return [_run(directory)]
    inside = sorted(path for path in directory.iterdir() if (path / file_names.SCENE).is_file())
    if not inside:
        raise InputError(f"{directory}: neither a run nor a sweep; it has no {file_names.SCENE}")
    if compared:
        return [_run(path) for path in inside]
    return [_sweep(directory)]


def _run(path: Path) -> Path:
    directory = RunDirectory(path)
    problem, scene = directory.problem, directory.scene
    lines, found = [], None
    try:
        analysis = analyse(directory, figures=False)
        found = analysis.survey
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
        layout(problem, part, found, list(default_beads(problem))),
        head=paragraphs([scene.description] * bool(scene.description) + lines),
        foot=foot,
    )
    claim(path, (VIEW,))
    write_text(path / VIEW, made)
    return path / VIEW


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
    )
    path = directory / VIEW
    if path.exists() and not path.read_text(encoding="utf-8", errors="replace").startswith("<!DOCTYPE html>"):
        raise InputError(f"{path}: exists and is no page of granchain's; move it away")
    write_text(path, made)
    return path
