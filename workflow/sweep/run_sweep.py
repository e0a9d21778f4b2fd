"""Carry out a sweep on this machine: what is missing or failed, on all cores, each case in a run directory."""

import contextlib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lammps_inputs import InputError, Scene, file_names, library, strict_yaml
from workflow import formats
from workflow.engines.lammps import hosted
from workflow.errors import RunError
from workflow.prepare.settings import found_beforehand, refuse_unanalysable, refuse_unstable
from workflow.runs import job
from workflow.runs.completed_run import CompletedRun
from workflow.runs.engines import engine_called
from workflow.runs.files import RECORD, alone, write_json, write_text
from workflow.runs.output_directory import complete_replacement, make_directory, others, record_files
from workflow.runs.resume import resume
from workflow.runs.run import run
from workflow.runs.run_directory import RunDirectory
from workflow.runs.size import refuse_beforehand
from workflow.runs.status import Queue, cluster_queue, status
from workflow.screen import count_bar
from workflow.sweep.cases import CaseRequest, is_analysed, request_of, task
from workflow.sweep.file import Sweep, SweepCase, all_cases, scene_of
from workflow.verdicts.analysis_files import analyse
from workflow.workers import computations
from workflow.workers.pool import Pool, TaskResult

DEFINITION = "sweep.yaml"
"""File in the directory of a sweep that makes its cases again."""

_WRITTEN = "# written by `granchain sweep`: it makes the cases of this directory\n"

# --- directory --------------------------------------------------------------------------------------------------------


def begin(path: Path, wanted: CaseRequest, scene: Scene) -> None:
    """Make a case's directory; from then on it is a run directory that may be overwritten."""
    path.mkdir(parents=True, exist_ok=True)
    record_files(path, (file_names.SCENE,))
    job.update(path, request=wanted.plain())
    write_text(path / file_names.SCENE, library.render_scene(scene))


def refuse_another(path: Path, wanted: CaseRequest, scene: Scene) -> None:
    """See that a directory is not there, or this case's.

    Raises:
        InputError: it holds something else, or the same case of another scene or engine.
    """
    complete_replacement(path)  # of a sweep that was killed
    earlier = request_of(path)
    if earlier is None:
        if path.is_dir() and (not (rest := others(path)) or (rest == {RECORD} and RECORD in job.account(path).files)):
            return  # interrupted before anything was written
        if path.exists() or path.is_symlink():
            raise InputError(f"{path}: exists and is not a case of a sweep; choose another -o")
        return
    advice = "choose another -o, or remove this directory"
    if earlier.engine != wanted.engine:
        raise InputError(f"{path}: is the same case computed by {earlier.engine}, not {wanted.engine}; {advice}")
    key = _first_difference(earlier.scene, wanted.scene)
    if key is None and (path / file_names.SCENE).is_file():
        try:
            written = library.load(path / file_names.SCENE).plain()
        except InputError:  # damaged: it is rewritten
            return
        resolved = scene.resolved().plain()
        key = _first_difference(written, resolved, found_beforehand(scene))
    if key is not None:
        raise InputError(f"{path}: holds this case of another scene ({key} differs); {advice}")


def _first_difference(first: dict[str, Any], second: dict[str, Any], ignored: Iterable[str] = ()) -> str | None:
    keys = [key for key in {**first, **second} if key not in ("limits", *ignored) and first.get(key) != second.get(key)]
    return keys[0] if keys else None


def note_failure(path: Path, reason: str) -> None:
    """Let ``run.json`` say why a case failed, where the run could not do so itself."""
    record = job.account(path)
    if path.is_dir() and record.outcome not in ("done", "failed"):
        write_json(path / RECORD, {**record.plain(), "outcome": "failed", "reason": reason})


# --- computation ------------------------------------------------------------------------------------------------------


def compute(
    directory: str, case: dict[str, Any] | None, check: bool, figures: list[str], width: float | None = None
) -> str:
    """Run and analyse a case; "done" or "stopped"."""
    path = Path(directory)
    if case is not None:
        done = _run(path, CaseRequest(**case), check=check)
        if done.outcome != "done":
            return "stopped"
        analysed = done.directory  # with the frames that were read for the check
    else:
        if check and (path / RECORD).is_file():
            resume(path)  # it is done, but perhaps its error was not measured any more
        analysed = RunDirectory(path)
    with formats.written_as(figures, width):
        analyse(analysed, figures=bool(figures))
    return "done"


def _run(directory: Path, case: CaseRequest, *, check: bool) -> CompletedRun:
    """Run a case from its last restart if there is one; most cases end before one is written."""
    if (directory / file_names.RESTART).is_file():
        with contextlib.suppress(InputError):  # not one to resume from
            resumed = resume(directory, check=check, lammps=hosted.run)
            if resumed is not None:
                return resumed
    scene = library.from_plain(case.scene, str(directory))
    begin(directory, case, scene)
    return run(scene, directory, engine=case.engine, overwrite=True, check=check, lammps=hosted.run)


# --- sweep ------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Swept:
    """How a sweep ended.

    Attributes:
        cases: number of cases that it names.
        before: number of cases that were done before.
        done: number of cases that are done.
        failed: name and reason of each that failed.
        interrupted: whether it was stopped before its end.
        others: cases in the directory with values that the sweep no longer names; they stay.
    """

    cases: int
    before: int
    done: int
    failed: list[tuple[str, str]]
    interrupted: bool
    others: int = 0


def sweep(
    definition: Sweep,
    directory: Path,
    *,
    processes: int | None = None,
    check: bool = True,
    figures: bool = False,
) -> Swept:
    """Run and analyse every case that a directory does not hold yet; Ctrl-C keeps what is done.

    Args:
        definition: the sweep.
        directory: made if need be; gets one directory per case.
        processes: cases computed at a time; by default as many as there are cores.
        check: whether to measure the error of LAMMPS runs.
        figures: whether to draw every case.

    Raises:
        InputError: a case is no scene, or its directory holds something else. Nothing has run then.
    """
    failed: list[tuple[str, str]] = []

    def note(name: str, answer: TaskResult) -> None:
        if answer.value != "done":
            failed.append((name, " ".join(answer.failed.split()) or "was stopped"))
            with contextlib.suppress(RunError):  # the disk may be full; reported at the end
                note_failure(directory / name, failed[-1][1])

    with planned(definition, directory) as cases:
        others = len(_others(directory, cases))
        if (directory / file_names.CASES).is_file():  # leave cases to the jobs of a cluster that were sent out for them
            refuse_if_queued(directory, [case.name for case in cases], cluster_queue(), "wait for it, or end it first")
        missing = _missing(cases, directory, figures=figures)
        before = len(cases) - len(missing)
        drawn = formats.asked() if figures else ()
        tasks = []
        for case, unfinished in missing:
            scene = scene_of(definition, case)
            wanted = request(definition, case, scene) if unfinished else None
            case_task = task((directory / case.name).absolute(), wanted, check=check, figures=drawn)
            tasks.append(computations.Computation(case.name, case_task, cost=_work(scene)))

        try:
            with count_bar("sweep") as progress, Pool(processes) as pool:
                computations.evaluate(
                    tasks,
                    pool=pool,
                    progress=lambda now, _, bad: progress(before + now, len(cases), bad),
                    tell=note,
                    failed=lambda answer: answer.value != "done",
                )
        except KeyboardInterrupt:
            done = len(cases) - len(_missing(cases, directory, figures=figures))  # some ended while they were stopped
            return Swept(len(cases), before, done, failed, interrupted=True, others=others)
    return Swept(len(cases), before, len(cases) - len(failed), failed, interrupted=False, others=others)


@contextlib.contextmanager
def planned(definition: Sweep, directory: Path) -> Iterator[list[SweepCase]]:
    """The cases of `plan`, with the directory made and other runs kept out of it.

    Raises:
        InputError: as `sweep`.
    """
    names_before = _names(directory)
    cases = plan(definition, directory)
    make_directory(directory)
    with alone(directory):
        if _names(directory) != names_before:  # another sweep may have begun there at the same time
            plan(definition, directory)
        _keep(definition, directory)
        yield cases


def _keep(definition: Sweep, directory: Path) -> None:
    """Write the sweep file into the directory, unless it stands there, or the user has a file of that name."""
    path, text = directory / DEFINITION, _WRITTEN + strict_yaml.dump(definition.plain())
    try:
        before = path.read_text(encoding="utf-8", errors="replace")
    except FileNotFoundError:
        before = _WRITTEN
    except OSError:
        return
    if before.startswith(_WRITTEN) and before != text and not path.is_symlink():
        write_text(path, text)


def _names(directory: Path) -> set[str]:
    with contextlib.suppress(OSError):  # which `plan` explains, unless it is not there yet
        return {path.name for path in directory.iterdir()}
    return set()


def plan(definition: Sweep, directory: Path) -> list[SweepCase]:
    """All cases of a sweep, each seen to fit into a directory.

    Raises:
        InputError: as `sweep`.
    """
    cases = all_cases(definition)
    _refuse_what_is_not_a_sweep(directory, cases)
    for case in cases:
        scene = scene_of(definition, case)
        _refuse_what_cannot_run(f"{definition.source}: case {case.name}", definition.engine, scene)
        refuse_another(directory / case.name, request(definition, case, scene), scene)
    for case in _others(directory, cases):
        _refuse_of_another_sweep(definition, directory, case)
    return cases


def _others(directory: Path, cases: list[SweepCase]) -> list[SweepCase]:
    """Cases in a directory that are none of these: of an earlier version of the sweep's file."""
    names = {case.name for case in cases}
    paths = sorted(path for path in directory.iterdir() if path.name not in names) if directory.is_dir() else []
    requests = ((path.name, request_of(path)) for path in paths)
    return [SweepCase(name, case_request.swept) for name, case_request in requests if case_request is not None]


def _refuse_of_another_sweep(definition: Sweep, directory: Path, case: SweepCase) -> None:
    """Let a directory, and so its table, hold cases of one scene over the same fields.

    Raises:
        InputError: a case is of other fields, or of another scene or engine.
    """
    if case.values.keys() != definition.vary.keys():
        raise InputError(
            f"{directory}: holds cases over {', '.join(case.values)}, and this sweep varies "
            f"{', '.join(definition.vary)}; choose another -o"
        )
    scene = scene_of(definition, case)
    refuse_another(directory / case.name, request(definition, case, scene), scene)


def request(definition: Sweep, case: SweepCase, scene: Scene) -> CaseRequest:
    """Request of a case of a sweep, whose scene this is."""
    return CaseRequest(case.values, scene.plain(), definition.engine)


def _refuse_what_is_not_a_sweep(directory: Path, cases: list[SweepCase]) -> None:
    try:
        if not directory.exists():
            return
        if not directory.is_dir():
            raise InputError(f"{directory}: is a file, not a directory; choose another -o")
        names = {entry.name for entry in directory.iterdir()}
    except OSError as error:
        raise InputError(f"{directory}: cannot be read ({error.strerror})") from None
    is_sweep = any(case.name in names for case in cases) or any(request_of(directory / name) for name in names)
    if names and not is_sweep:
        raise InputError(f"{directory}: exists and is not the directory of a sweep; choose another -o")


def _refuse_what_cannot_run(where: str, engine: str, scene: Scene) -> None:
    refuse_unanalysable(scene, where)
    chosen = engine_called(engine)
    if refusal := chosen.refusal(scene):
        raise InputError(f"{where}: engine: {refusal}")
    if chosen.own_step:
        refuse_unstable(scene, where)
    refuse_beforehand(scene, where, chosen)


def refuse_if_queued(directory: Path, names: Iterable[str], queue: Queue | None, advice: str) -> None:
    """See that no case waits in a queue or runs.

    Raises:
        InputError: one does; says what to do.
    """
    for name in names:
        state = status(directory / name, queue)
        if state.state in ("waiting", "running"):
            raise InputError(f"{directory / name}: is {state.state} ({state.why}); {advice}")


def _missing(cases: list[SweepCase], directory: Path, *, figures: bool) -> list[tuple[SweepCase, bool]]:
    """Cases that are to be run (True), or only to be analysed."""
    missing = []
    for case in cases:
        path = directory / case.name
        unfinished = status(path).state != "done"
        if unfinished or not is_analysed(path, figures=figures):
            missing.append((case, unfinished))
    return missing


def _work(scene: Scene) -> float:
    """Beads times time, in units of T; a pulse takes about three of them a bead."""
    time = 3.0 * (scene.until_bead or 0) if scene.duration is None else scene.duration / scene.scale.time
    return scene.chains * scene.beads * time
