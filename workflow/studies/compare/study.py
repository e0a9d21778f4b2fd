"""The same scene with several engines side by side: what the cheap model of rigid beads keeps, and what it loses.

Each engine's run has a directory of its name; ``compare.json`` and a figure are beside them.
"""

import math
import tempfile
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, ExitStack, nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from lammps_inputs import InputError, Problem, Scene, file_names, physics, strict_yaml
from lammps_inputs.numbers import known
from workflow.engines.reference import engine as reference
from workflow.errors import RunError
from workflow.prepare.settings import settle
from workflow.runs import run as running
from workflow.runs.engines import ENGINES, LAMMPS, REFERENCE, RIGID, Progress, engine_called
from workflow.runs.files import RECORD
from workflow.runs.locks import alone
from workflow.runs.own_files import prepared, refuse_unusable, replacing
from workflow.runs.whole_files import as_json
from workflow.studies.compare.measure import Result, answer, last_row, measure
from workflow.studies.study import Study

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# --- report -----------------------------------------------------------------------------------------------------------

REPORT, FIGURE = "compare.json", "compare"
STUDY = Study(
    "compare",
    f"{REPORT} holds what was found, and each engine's run has a directory in it",
    tables=(file_names.SCENE, REPORT),
    figures=(FIGURE,),
    resume="the same command with --overwrite compares again",
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

    def of(self, engine: str) -> Result | None:
        """The result of one engine, if it ran."""
        return next((result for result in self.results if result.engine == engine), None)


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

MakeProgress = Callable[[str, Problem], AbstractContextManager[Progress | None]]


def engines_for(scene: Scene, asked: Sequence[str] | None) -> tuple[str, ...]:
    """The engines to run: those asked for, or all that can do the scene.

    Raises:
        InputError: an engine that does not exist, is named twice, or cannot do what the scene names.
    """
    if asked is None:
        able = [name for name in (RIGID.name, REFERENCE.name, LAMMPS.name) if not ENGINES[name].refusal(scene)]
        return tuple(able)
    for name in asked:
        if refusal := engine_called(name, "--engines").refusal(scene):
            raise InputError(f"--engines: {refusal}")
    if len(set(asked)) < len(asked):
        raise InputError("--engines: one is named twice")
    return tuple(asked)


def compare(
    scene: Scene,
    directory: Path,
    *,
    engines: Sequence[str] | None = None,
    overwrite: bool = False,
    progress: MakeProgress = lambda name, problem: nullcontext(),  # noqa: ARG005
) -> Comparison:
    """Run a scene with each engine in a directory of its own, and write what they found beside.

    Args:
        scene: what to compute; every bead is recorded.
        directory: new or empty, or an earlier comparison's with ``overwrite``.
        engines: of `workflow.runs.engines.ENGINES`; by default all that can do the scene.
        overwrite: whether earlier files may be replaced.
        progress: makes what follows each run.

    Raises:
        InputError: the directory or an engine cannot be used.
        RunError: a run failed or was interrupted.
    """
    if scene.window is not None:
        raise InputError("window: only lammps follows the pulse with one; leave it out to compare engines")
    names = engines_for(scene, engines)
    whole = {"beads": "all", "snapshots": None, "peaks": None}
    scene = scene.model_copy(update={"output": scene.output.model_copy(update=whole)})
    scene, settings = settle(scene, source=scene.name, own_step=LAMMPS.name in names)
    problem = scene.problem()
    rows = shown_rows(problem)
    own = (RECORD, *STUDY.files)
    refuse_unusable(directory, own, overwrite=overwrite)
    for name in names:
        if (directory / name).exists():
            refuse_unusable(directory / name, ENGINES[name].files, overwrite=overwrite)
    reference.load()  # compiled before any clock runs
    # nothing of an earlier comparison is touched before the whole new one is there
    with (
        prepared(directory, own, overwrite=overwrite),
        tempfile.TemporaryDirectory(prefix=".running-", dir=directory) as work,
    ):
        results = []
        for name in names:
            path = Path(work) / name
            with progress(name, problem) as follow:
                ran = running.run(scene, path, engine=name, settings=settings, check=False, progress=follow)
            if ran.outcome != "done":
                raise RunError(f"{directory / name}: {ran.outcome}; nothing to compare")
            results.append(measure(ran.directory, rows))
        last = last_row(results)
        found = Comparison(problem, tuple(results), rows, last, answer(results, last))
        texts = {file_names.SCENE: strict_yaml.dump(scene.resolved().plain()), REPORT: as_json(plain(found)) + "\n"}
        STUDY.write(Path(work), texts, {FIGURE: _figure(found)})
        _put_in_place(Path(work), directory, own, names)
    STUDY.mark(directory, done=True)
    return found


def _put_in_place(work: Path, directory: Path, own: tuple[str, ...], names: Sequence[str]) -> None:
    """Take all or nothing to where it belongs, in a directory that others are kept out of."""
    with ExitStack() as all_of_them:
        places = [(work, directory, [name for name in own if name != RECORD])]
        for name in names:
            (directory / name).mkdir(exist_ok=True)
            all_of_them.enter_context(alone(directory / name))
            places.append((work / name, directory / name, sorted(path.name for path in (work / name).iterdir())))
        for _, place, files in places:
            all_of_them.enter_context(replacing(place, files))
        for source, place, files in places:
            for file in files:
                (source / file).replace(place / file)


def shown_rows(problem: Problem) -> tuple[int, ...]:
    """Beads whose numbers and velocities are shown: near the start, then ever farther apart."""
    last = max(2, problem.beads - 5)
    wanted = [row for row in (2, 5, 10, 25, 50, 100) if row < last]
    if last > 200:
        wanted += np.geomspace(100, last, 3).round().astype(int).tolist()[1:-1]
    return (*wanted, last)[-MOST_SHOWN:]
