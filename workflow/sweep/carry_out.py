"""Carry out a sweep on this machine: what is missing or failed, on all cores."""

import contextlib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from analysis.files.recording import FARTHEST
from lammps_inputs import InputError, Scene, file_names
from workflow.engines.lammps.mpi import cores
from workflow.errors import RunError
from workflow.formats import asked
from workflow.prepare.settings import refuse_unstable
from workflow.runs.engines import ENGINES
from workflow.runs.files import alone
from workflow.runs.own_files import make_directory
from workflow.runs.size import refuse_beforehand
from workflow.runs.status import Queue, slurm_queue, status
from workflow.screen import count_bar
from workflow.sweep import directory as directories
from workflow.sweep.directory import Asked, task
from workflow.sweep.file import Case, Sweep, all_cases, scene_of
from workflow.workers import evaluate
from workflow.workers.pool import Answer, Pool


@dataclass(frozen=True)
class Swept:
    """How a sweep ended.

    Attributes:
        cases: all that it names.
        before: how many were done before.
        done: how many are done.
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
    what: Sweep,
    directory: Path,
    *,
    processes: int | None = None,
    check: bool = True,
    figures: bool = False,
) -> Swept:
    """Run and analyse every case that a directory does not hold yet; Ctrl-C keeps what is done.

    Args:
        what: the sweep.
        directory: made if need be; gets one directory per case.
        processes: cases computed at a time; by default as many as there are cores.
        check: whether to measure the error of LAMMPS runs.
        figures: whether to draw every case.

    Raises:
        InputError: a case is no scene, or its directory holds something else. Nothing has run then.
    """
    failed: list[tuple[str, str]] = []

    def note(name: str, answer: Answer) -> None:
        if answer.value != "done":
            failed.append((name, " ".join(answer.failed.split()) or "was stopped"))
            with contextlib.suppress(RunError):  # the disk may be full; reported at the end
                directories.note_failure(directory / name, failed[-1][1])

    with planned(what, directory) as cases:
        others = len(_others(directory, cases))
        if (directory / file_names.CASES).is_file():  # leave cases to the jobs of a cluster that were sent out for them
            refuse_if_queued(directory, [case.name for case in cases], slurm_queue(), "wait for it, or end it first")
        missing = _missing(cases, directory, figures=figures)
        before = len(cases) - len(missing)
        formats = asked() if figures else ()
        tasks = []
        for case, unfinished in missing:
            scene = scene_of(what, case)
            wanted = request(what, case, scene) if unfinished else None
            own = task((directory / case.name).absolute(), wanted, check=check, figures=formats)
            tasks.append(evaluate.Case(case.name, own, cost=_work(scene)))

        try:
            with count_bar("sweep") as progress, Pool(min(processes or cores(), len(missing))) as pool:
                evaluate.evaluate(
                    tasks,
                    pool=pool,
                    progress=lambda now, _, bad: progress(before + now, len(cases), bad),
                    tell=note,
                    failed=lambda one: one.value != "done",
                )
        except KeyboardInterrupt:
            done = len(cases) - len(_missing(cases, directory, figures=figures))  # some ended while they were stopped
            return Swept(len(cases), before, done, failed, interrupted=True, others=others)
    return Swept(len(cases), before, len(cases) - len(failed), failed, interrupted=False, others=others)


@contextlib.contextmanager
def planned(what: Sweep, directory: Path) -> Iterator[list[Case]]:
    """The cases of `plan`, with the directory made and other runs kept out of it.

    Raises:
        InputError: as `sweep`.
    """
    seen = _names(directory)
    cases = plan(what, directory)
    make_directory(directory)
    with alone(directory):
        if _names(directory) != seen:  # another sweep may have begun there at the same time
            plan(what, directory)
        yield cases


def _names(directory: Path) -> set[str]:
    with contextlib.suppress(OSError):  # which `plan` explains, unless it is not there yet
        return {path.name for path in directory.iterdir()}
    return set()


def plan(what: Sweep, directory: Path) -> list[Case]:
    """All cases of a sweep, each seen to fit into a directory.

    Raises:
        InputError: as `sweep`.
    """
    cases = all_cases(what)
    _refuse_what_is_not_a_sweep(directory, cases)
    for case in cases:
        scene = scene_of(what, case)
        _refuse_what_cannot_run(f"{what.source}: case {case.name}", what.engine, scene)
        directories.refuse_another(directory / case.name, request(what, case, scene), scene)
    for case in _others(directory, cases):
        _refuse_of_another_sweep(what, directory, case)
    return cases


def _others(directory: Path, cases: list[Case]) -> list[Case]:
    """Cases in a directory that are none of these: of an earlier version of the sweep's file."""
    names = {case.name for case in cases}
    paths = sorted(path for path in directory.iterdir() if path.name not in names) if directory.is_dir() else []
    found = ((path.name, directories.asked(path)) for path in paths)
    return [Case(name, asked.swept) for name, asked in found if asked is not None]


def _refuse_of_another_sweep(what: Sweep, directory: Path, case: Case) -> None:
    """Let a directory, and so its table, hold cases of one scene over the same fields.

    Raises:
        InputError: a case is of other fields, or of another scene or engine.
    """
    if case.values.keys() != what.vary.keys():
        raise InputError(
            f"{directory}: holds cases over {', '.join(case.values)}, and this sweep varies {', '.join(what.vary)}; "
            "choose another -o"
        )
    scene = scene_of(what, case)
    directories.refuse_another(directory / case.name, request(what, case, scene), scene)


def request(what: Sweep, case: Case, scene: Scene) -> Asked:
    """What a case is asked to be."""
    return Asked(case.values, scene.plain(), what.engine)


def _refuse_what_is_not_a_sweep(directory: Path, cases: list[Case]) -> None:
    try:
        if not directory.exists():
            return
        if not directory.is_dir():
            raise InputError(f"{directory}: is a file, not a directory; choose another -o")
        found = {entry.name for entry in directory.iterdir()}
    except OSError as error:
        raise InputError(f"{directory}: cannot be read ({error.strerror})") from None
    own = any(case.name in found for case in cases) or any(directories.asked(directory / name) for name in found)
    if found and not own:
        raise InputError(f"{directory}: exists and is not the directory of a sweep; choose another -o")


def _refuse_what_cannot_run(where: str, engine: str, scene: Scene) -> None:
    every = scene.resolved().output.every or 0.0
    if every > FARTHEST * scene.scale.time * (1.0 + 1e-9):
        limit = FARTHEST * scene.scale.time
        raise InputError(
            f"{where}: output.every: waves between frames are missed; at most {limit:.4g} ({every:g} given)"
        )
    if refusal := ENGINES[engine].refusal(scene):
        raise InputError(f"{where}: engine: {refusal}")
    if ENGINES[engine].own_step:
        refuse_unstable(scene, where)
    refuse_beforehand(scene, where, ENGINES[engine])


def refuse_if_queued(directory: Path, names: Iterable[str], known: Queue | None, advice: str) -> None:
    """See that no case waits in Slurm's queue or runs.

    Raises:
        InputError: one does; says what to do.
    """
    for name in names:
        found = status(directory / name, known)
        if found.state in ("waiting", "running"):
            raise InputError(f"{directory / name}: is {found.state} ({found.why}); {advice}")


def _missing(cases: list[Case], directory: Path, *, figures: bool) -> list[tuple[Case, bool]]:
    """Cases that are to be run (True), or only to be analysed."""
    found = []
    for case in cases:
        path = directory / case.name
        unfinished = status(path).state != "done"
        if unfinished or not directories.is_analysed(path, figures=figures):
            found.append((case, unfinished))
    return found


def _work(scene: Scene) -> float:
    """Beads times time, in units of T; a pulse takes about three of them a bead."""
    time = 3.0 * (scene.until_bead or 0) if scene.duration is None else scene.duration / scene.scale.time
    return scene.chains * scene.beads * time
