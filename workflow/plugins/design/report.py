"""The page of a design study: the best in pictures, the search, and what small errors do. Computes nothing new."""

import html
import math

import numpy as np
from matplotlib.figure import Figure

from granchain.parts import Floats, RunDirectory, axes, drawing, forces, page, references, spacetime, units
from workflow.plugins.design.figures import Objective, front_figure, history_figure, members_figure, wall_figure
from workflow.plugins.design.result import SET_AGAINST, DesignResult
from workflow.plugins.design.search import RULED_OUT, worth


def render(result: DesignResult) -> str:
    """The report in HTML, with its figures."""
    design, best = result.design, result.verified[0]
    wanted = ("least" if design.sign > 0.0 else "largest") + f" {design.objective}"
    words = "".join(f"<p><b>Warning:</b> {html.escape(warning)}.</p>" for warning in result.warnings)
    parts = {
        "The best": words + page.table(*result.table()) + _shown(_of_best(result)),
        "The search": _search_words(result) + _shown(_of_search(result)),
        f"Manufacturing tolerance of {result.sensitivity.spread:.2%}": _made(result),
    }
    scene = best.directory.scene.name
    summary = (
        f"Of {len(result.records)} designs of {scene} the one with the {wanted}. Numbers are in the scene's units; "
        "every design was computed by the reference, the best again by LAMMPS."
    )
    if result.undefined:
        summary += f" In {result.undefined} of them the objective or a quantity with a limit is undefined."
    cited = {key: None for keys in references.of_scene(best.directory.scene).values() for key in keys}
    body = "\n".join(f"<section><h2>{name}</h2>{part}</section>" for name, part in parts.items())
    return page.document(f"{scene}: {wanted}", summary, body, cited)


def _shown(pictures: list[page.PageFigure]) -> str:
    return "".join(page.shown(picture) for picture in pictures)


def _search_words(result: DesignResult) -> str:
    values = _values(result)
    how = (
        "These are all designs there are."
        if result.design.exhaustive
        else "Differential evolution, and steps along each field from its best; a better design may exist."
    )
    return (
        f"<p>{how} {int(np.isfinite(values).sum())} of {len(values)} keep the limits; a design took "
        f"{result.seconds * 1e3:.3g} ms of processor time.</p>"
    )


def _values(result: DesignResult, name: str | None = None) -> Floats:
    """A quantity of every design, by default the objective, [design]; NaN where undefined or a limit is broken."""
    design = result.design
    chosen = name or design.objective
    return np.array(
        [
            math.nan if worth(design, r) >= RULED_OUT or (v := r.quantities.get(chosen)) is None else v
            for r in result.records
        ]
    )


def _objective(result: DesignResult) -> Objective:
    beside = None if result.beside is None else result.beside.reference[result.design.objective]
    return Objective(_label(result, result.design.objective), result.design.sign, beside)


def _label(result: DesignResult, name: str) -> units.Label:
    return axes.label(name, result.design.scene)


def _of_search(result: DesignResult) -> list[page.PageFigure]:
    objective, values = _objective(result), _values(result)
    pictures = [page.drawn("history", history_figure(objective, values), "Every design, as the search came to it.")]
    if result.design.request.also:
        name = result.design.request.also[0]
        figure = front_figure(objective, values, _label(result, name), _values(result, name))
        pictures.append(page.drawn("front", figure, f"Pareto front of {result.design.objective} and {name}."))
    return pictures


def _of_best(result: DesignResult) -> list[page.PageFigure]:
    best = result.verified[0].directory
    map_of_best = drawing.draw(spacetime.spacetime_sheet(spacetime.space_time_meter(best.problem).read(best.blocks())))
    pictures = [page.drawn("spacetime", map_of_best, "The best in space and time, by LAMMPS.")]
    against = [] if result.beside is None else [(SET_AGAINST, result.beside.directory)]
    curves = [
        (name, *curve) for name, directory in [("the best", best), *against] if (curve := _wall(directory)) is not None
    ]
    if curves:
        scale = best.problem.scale
        labels = (
            units.Label("time", "t", scale.symbol("time")),
            units.Label("force on the wall, all chains", "F", scale.symbol("force")),
        )
        pictures.append(page.drawn("wall", wall_figure(curves, *labels), "Force on the far wall over time, by LAMMPS."))
    return pictures


def _wall(directory: RunDirectory) -> tuple[Floats, Floats] | None:
    problem = directory.problem
    name = "right wall" if problem.direction > 0 else "left wall"
    if not problem.system.walls:
        return None
    readings = forces.read(directory.blocks(), problem, wall=True)
    of_wall = [place for place, gauge in enumerate(readings.gauges) if gauge.name == name]
    force = readings.force[:, :, of_wall].sum(axis=1) * problem.scale.force
    return (readings.time * problem.scale.time, force[:, 0]) if of_wall else None


def _made(result: DesignResult) -> str:
    small = result.sensitivity
    best = result.best.quantities[result.design.objective] or 0.0
    words = (
        f"<p>{small.asked} designs whose beads differ in size and stiffness, and whose numbers are off, all uniformly "
        f"distributed within {small.spread:.2%}; {html.escape(result.tolerance)}; as designed {best:.5g}.</p>"
    )
    if not small.enough:
        return words
    figure: Figure = members_figure(_objective(result), best, small.members)
    return words + _shown([page.drawn("members", figure, "Distribution over designs with these errors.")])
