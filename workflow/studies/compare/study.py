"""The same scene with several engines side by side: what the cheap model of rigid beads keeps, and what it loses.

Each engine's run has a directory of its name; ``compare.json`` and a figure are beside them.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from lammps_inputs import InputError, Problem, Scene, file_names, physics, strict_yaml
from lammps_inputs.numbers import known
from workflow.engines.reference import engine as reference
from workflow.prepare.settings import settle
from workflow.runs.engines import ENGINES, LAMMPS, REFERENCE, RIGID, engine_called
from workflow.runs.files import as_json
from workflow.studies.compare.measure import Result, answer, last_row, measure
from workflow.studies.kept_runs import kept_run
from workflow.studies.study import Study
from workflow.workers.evaluate import Progress

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# --- report -----------------------------------------------------------------------------------------------------------

REPORT, FIGURE = "compare.json", "compare"
STUDY = Study(
    "compare",
    f"{REPORT} holds what was found, and each engine's run has a directory in it",
    tables=(file_names.SCENE, REPORT),
    figures=(FIGURE,),
)


@dataclass(frozen=True)
class Comparison:
    """Several engines' results of one scene.

    Attributes:
        rows: numbers of the beads that are shown.
        last: last bead up to which every engine passed an impulse on; 1 if none did.
        answer: sentences that say what was found.
    """

    problem: Problem
    results: tuple[Result, ...]
    rows: tuple[int, ...]
    last: int
    answer: tuple[str, ...]


def plain(found: Comparison) -> dict[str, Any]:
    """The contents of ``compare.json``, dimensionless (times in T, impulses in m V; ``scale`` has the units).

    | key            | what                                                                               |
    |----------------|------------------------------------------------------------------------------------|
    | answer         | sentences                                                                          |
    | last_bead      | up to which every engine passed an impulse on                                      |
    | beads          | struck bead of each row of the arrays below                                        |
    | engines        | per engine: first_impulse, impulse, contacts, first_time [chain][row]; imbalance;  |
    |                | peak [chain][shown]; momentum_share, energy_share (last: springs); seconds         |
    """
    problem, scale = found.problem, found.problem.scale
    system = problem.system
    return {
        "scene": problem.name,
        "kappa": physics.kappa(system),
        "gap": physics.gap(system),
        "theta": math.sqrt(2.0 * physics.kappa(system)) * physics.gap(system),
        "duration": problem.duration,
        "scale": {"mass": scale.mass, "length": scale.length, "time": scale.time, "velocity": scale.velocity},
        "answer": list(found.answer),
        "last_bead": found.last,
        "shown": list(found.rows),
        "beads": found.results[0].impulses.bead.tolist(),
        "engines": {result.engine: _plain_result(result) for result in found.results},
    }


def _plain_result(result: Result) -> dict[str, Any]:
    impulses = result.impulses
    return {
        "seconds": result.seconds,
        "wall_seconds": result.wall,
        "momentum_share": result.momentum.tolist(),
        "energy_share": result.energy.tolist(),
        "peak": result.peak.tolist(),
        "first_impulse": impulses.first.tolist(),
        "impulse": impulses.whole.tolist(),
        "contacts": impulses.contacts.tolist(),
        "first_time": impulses.time.tolist(),
        "imbalance": known(impulses.imbalance),
    }


def _figure(found: Comparison) -> "Figure":
    from analysis.figures.engines import Curve, engines_figure  # matplotlib takes half a second to import

    curves = [
        Curve(result.engine, result.time, result.velocity, result.impulses.bead, result.impulses.first)
        for result in found.results
    ]
    return engines_figure(found.problem, found.rows, curves)


# --- runs -------------------------------------------------------------------------------------------------------------

MOST_SHOWN = 7


def engines_for(scene: Scene, asked: Sequence[str] | None) -> tuple[str, ...]:
    """The engines to run: those asked for, or all that can do the scene.

    Raises:
        InputError: an engine that does not exist, is named twice, or cannot do what the scene names.
    """
    if asked is None:
        return tuple(engine.name for engine in (RIGID, REFERENCE, LAMMPS) if not engine.refusal(scene))
    for name in asked:
        if refusal := engine_called(name, "--engines").refusal(scene):
            raise InputError(f"--engines: {refusal}")
    if len(set(asked)) < len(asked):
        raise InputError("--engines: one is named twice")
    return tuple(asked)


def compare(
    scene: Scene,
    directory: Path,
    engines: Sequence[str] | None = None,
    progress: Progress | None = None,
) -> Comparison:
    """Run a scene with each engine in a directory of its own, and write what they found beside.

    Args:
        scene: what to compute; every bead is recorded.
        directory: made if need be; runs of the same scene in it are kept.
        engines: of `workflow.runs.engines.ENGINES`; by default all that can do the scene.
        progress: called with the runs done, their total, and 0.

    Raises:
        InputError: the directory or an engine cannot be used.
        RunError: a run failed.
    """
    if scene.window is not None:
        raise InputError("window: only lammps follows the pulse with one; leave it out to compare engines")
    names = engines_for(scene, engines)
    whole = {"beads": "all", "snapshots": None, "peaks": None}
    scene = scene.model_copy(update={"output": scene.output.model_copy(update=whole)})
    scene, settings = settle(scene, source=scene.name, own_step=LAMMPS.name in names)
    problem = scene.problem()
    rows, results = shown_rows(problem), []
    text = strict_yaml.dump(scene.resolved().plain())
    study = replace(STUDY, others=tuple(ENGINES))
    reference.load()  # compiled before any clock runs
    with study.opened(directory):
        path = directory / file_names.SCENE
        if path.is_file() and path.read_text(encoding="utf-8") != text:
            raise InputError(f"{path}: is another scene than the one to compare; choose another -o")
        study.write(directory, {file_names.SCENE: text})
        for count, name in enumerate(names):  # one at a time, for each is timed
            if progress is not None:
                progress(count, len(names), 0)
            results.append(measure(kept_run(scene, name, directory / name, settings), rows))
        last = last_row(results)
        found = Comparison(problem, tuple(results), rows, last, answer(results, last))
        study.write(directory, {REPORT: as_json(plain(found)) + "\n"}, {FIGURE: _figure(found)})
    return found


def shown_rows(problem: Problem) -> tuple[int, ...]:
    """Beads whose numbers and velocities are shown: near the start, then ever farther apart."""
    last = max(2, problem.beads - 5)
    wanted = [row for row in (2, 5, 10, 25, 50, 100) if row < last]
    if last > 200:
        wanted += np.geomspace(100, last, 3).round().astype(int).tolist()[1:-1]
    return (*wanted, last)[-MOST_SHOWN:]
