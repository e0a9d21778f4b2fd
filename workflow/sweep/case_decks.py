"""Decks of a sweep's cases in place of runs, each in the directory of its case, with files of a plug-in beside it."""

import contextlib
import importlib
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lammps_inputs import InputError, Problem, Scene, file_names, library, load
from lammps_inputs.decks import scene_files
from workflow.errors import RunError
from workflow.prepare.settings import settle
from workflow.runs.files import LAMMPS_FILES, RECORD, write_json, write_text
from workflow.runs.job import Job
from workflow.runs.output_directory import listed, record_files
from workflow.runs.status import Queue, cluster_queue, status
from workflow.screen import count_bar
from workflow.sweep.cases import CaseRequest
from workflow.sweep.file import Sweep, SweepCase, all_cases, scene_of
from workflow.sweep.run_sweep import begin, planned, refuse_if_queued, request
from workflow.workers import computations
from workflow.workers.pool import Pool, Task, TaskResult


@dataclass(frozen=True)
class CaseDecks:
    """Cases of a sweep whose decks can be written; other commands are kept out of the directory meanwhile.

    Attributes:
        definition: the sweep.
        directory: has a directory for each case.
        cases: every case.
        states: name of each case -> its state (`workflow.runs.status.MEANING`).
        queue: queue of the cluster; None where there is no scheduler.
    """

    definition: Sweep
    directory: Path
    cases: list[SweepCase]
    states: dict[str, str]
    queue: Queue | None

    @property
    def under_way(self) -> list[str]:
        """Names of the cases that wait in the queue or run."""
        return [name for name, state in self.states.items() if state in ("waiting", "running")]

    @property
    def to_do(self) -> list[str]:
        """Names of the cases that neither are done nor wait nor run."""
        return [name for name, state in self.states.items() if state not in ("done", "waiting", "running")]

    def refuse_if_queued(self, names: Iterable[str], advice: str) -> None:
        """Refuse to go on while a case waits in the queue or runs.

        Args:
            names: names of the cases.
            advice: what to do, for the message.

        Raises:
            InputError: one does.
        """
        refuse_if_queued(self.directory, names, self.queue, advice)

    def write(self, beside: str, arguments: dict[str, Any]) -> list[Problem]:
        """Write decks of the cases that are to do, and files beside them, on all cores; restarts stay, to be resumed.

        Args:
            beside: ``module:function``, called with the problem of a case and the arguments; it returns name -> text of
                the files beside the deck, with None for one that is written later.
            arguments: plain data.

        Returns:
            The problem of the fewest beads, and that of the fewest rows.

        Raises:
            InputError: a case has no deck, or the function refuses it.
            RunError: a deck cannot be written.
        """
        tasks, names = [], set(self.to_do)
        for case in (each for each in self.cases if each.name in names):
            wanted = request(self.definition, case, scene_of(self.definition, case))
            data = {
                "directory": str(self.directory.absolute() / case.name),
                "case": wanted.plain(),
                "source": f"{self.definition.source}: case {case.name}",
                "beside": beside,
                "arguments": arguments,
            }
            tasks.append(computations.Computation(case.name, Task(f"{__name__}:write_case", data)))
        with count_bar("decks") as progress, Pool() as pool:
            sizes = computations.evaluate(tasks, pool=pool, progress=progress, tell=_refuse_failure)
        fewest = [min(sizes, key=lambda name: sizes[name].value[of]) for of in ("beads", "rows")]
        return [load(self.directory / name / file_names.SCENE).problem() for name in fewest]


@contextlib.contextmanager
def planned_decks(definition: Sweep, directory: Path, accept: Callable[[Scene], None]) -> Iterator[CaseDecks]:
    """Cases of a sweep for which decks are to be written, with the directory made and other commands kept out of it.

    Args:
        definition: the sweep.
        directory: new, or that of the same sweep.
        accept: called with the scene of each case before anything is written.

    Raises:
        InputError: LAMMPS does not compute the sweep, or a scene is not accepted; else as
            `workflow.sweep.run_sweep.planned`.
    """
    if definition.engine != "lammps":
        raise InputError(f"{definition.source}: engine: a job runs lammps, not {definition.engine}")
    for case in all_cases(definition):
        accept(scene_of(definition, case))
    with planned(definition, directory) as cases:
        queue = cluster_queue()
        states: dict[str, str] = {case.name: status(directory / case.name, queue).state for case in cases}
        yield CaseDecks(definition, directory, cases, states, queue)


def _refuse_failure(_: str, answer: TaskResult) -> None:
    if answer.failed:
        raise RunError(answer.failed)
    if "refused" in answer.value:
        raise InputError(answer.value["refused"])


def write_case(
    directory: str, case: dict[str, Any], source: str, beside: str, arguments: dict[str, Any]
) -> dict[str, Any]:
    """Write the deck of a case, unless it is there whole, and files beside it; for the worker pool.

    Returns:
        Numbers of beads and rows in LAMMPS; or ``refused``, why the case is refused.
    """
    try:
        problem = _write_case(Path(directory), CaseRequest(**case), source, beside, arguments)
    except InputError as error:
        return {"refused": str(error)}
    return {"beads": problem.chains * problem.rows.existing, "rows": problem.rows.existing}


def _write_case(path: Path, wanted: CaseRequest, source: str, beside: str, arguments: dict[str, Any]) -> Problem:
    scene = library.from_plain(wanted.scene, source)
    if not all((path / name).is_file() for name in (file_names.SCENE, file_names.DECK, file_names.DATA)):
        _write_deck(path, wanted, scene, source)
    try:
        written = load(path / file_names.SCENE)
    except InputError:  # damaged
        _write_deck(path, wanted, scene, source)
        written = load(path / file_names.SCENE)
    problem = written.problem()
    for name, text in scene_files.render(written, problem).items():
        if not (path / name).is_file() or (path / name).read_bytes() != text.encode("utf-8"):  # damaged
            write_text(path / name, text)
    module, _, function = beside.partition(":")
    files: Mapping[str, str | None] = getattr(importlib.import_module(module), function)(problem, **arguments)
    of_another_run = listed(path).difference(LAMMPS_FILES)  # one that did not end here
    record_files(path, files, outdated=of_another_run)
    write_json(path / RECORD, Job(files=sorted(listed(path)), request=wanted.plain()).plain())
    for name, content in files.items():
        if content is not None:
            write_text(path / name, content)
    return problem


def _write_deck(path: Path, wanted: CaseRequest, scene: Scene, source: str) -> None:
    settled, _ = settle(scene, source=source)
    files = scene_files.render(settled)
    begin(path, wanted, scene)
    record_files(path, LAMMPS_FILES)
    for name, text in files.items():
        write_text(path / name, text)
