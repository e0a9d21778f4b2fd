"""The same scene with several engines side by side: what the cheap model of rigid beads keeps, and what it loses.

Each engine's run stands whole in a directory of its name; ``compare.json`` and a figure stand beside them.
"""

import tempfile
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, ExitStack, nullcontext
from pathlib import Path

import numpy as np

from lammps_inputs import InputError, Problem, Scene, file_names, strict_yaml
from workflow.engines.reference import engine as reference
from workflow.errors import RunError
from workflow.formats import figure_files
from workflow.prepare.settings import settle
from workflow.runs import run as running
from workflow.runs.engines import ENGINES, LAMMPS, REFERENCE, RIGID, Progress, engine_called
from workflow.runs.files import RECORD
from workflow.runs.locks import alone
from workflow.runs.own_files import prepare, prepared, replacing
from workflow.runs.study_directory import mark
from workflow.runs.whole_files import write_json, write_text
from workflow.studies.compare.answer import answer
from workflow.studies.compare.measure import last_row, measure
from workflow.studies.compare.report import FIGURE, REPORT, Comparison, draw, plain

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
    own = (file_names.SCENE, RECORD, REPORT, *figure_files(FIGURE))
    prepare(directory, own, overwrite=overwrite)
    for name in names:
        if (directory / name).exists():
            prepare(directory / name, ENGINES[name].files, overwrite=overwrite)
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
        write_text(Path(work) / file_names.SCENE, strict_yaml.dump(scene.resolved().plain()))
        write_json(Path(work) / REPORT, plain(found))
        draw(Path(work), found)
        _put_in_place(Path(work), directory, own, names)
    result = f"{REPORT} holds what was found, and each engine's run has a directory in it"
    mark(directory, "compare", done=True, result=result, resume="the same command with --overwrite compares again")
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
