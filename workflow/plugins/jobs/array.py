"""Write a sweep for a cluster: a deck per case, and one array of jobs over those that are not done."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from granchain import InputError, RunError, Scene
from granchain.parts import (
    LAMMPS_FILES,
    RECORD,
    Asked,
    Job,
    Pool,
    Problem,
    Sweep,
    SweepCase,
    Task,
    TaskResult,
    begin,
    cluster_queue,
    computations,
    count_bar,
    file_names,
    library,
    listed,
    load,
    planned,
    record_files,
    refuse_if_queued,
    request,
    scene_files,
    scene_of,
    settle,
    status,
    write_json,
    write_text,
)
from workflow.plugins.jobs import job, job_files
from workflow.plugins.jobs.ranks import with_ranks
from workflow.plugins.jobs.registry import JOB_FILES, SCHEDULERS, SCRIPTS
from workflow.plugins.jobs.schedulers import Scheduler
from workflow.plugins.jobs.site import JobOptions


@dataclass(frozen=True)
class WrittenSweep:
    """Numbers of what was written for a cluster.

    Attributes:
        cases: cases that the sweep names.
        tasks: how many of them the array will do.
        under_way: how many wait in the queue or run.
        ranks: MPI ranks of each.
        numbers: lines of the list that the array's numbers count, from 0.
    """

    cases: int
    tasks: int
    under_way: int
    ranks: int
    numbers: int


def write_array(definition: Sweep, directory: Path, options: JobOptions) -> WrittenSweep:
    """Write decks and the array; nothing of a case that is done, waits or runs is touched.

    Args:
        definition: the sweep.
        directory: made if need be; the array is to be submitted there.
        options: of the job.

    Raises:
        InputError: as `workflow.sweep.run_sweep.plan`; or the list of cases would change under an array in the queue.
    """
    if definition.engine != "lammps":
        raise InputError(f"{definition.source}: engine: a job runs lammps, not {definition.engine}")
    with planned(definition, directory) as cases:
        queue = cluster_queue()
        states = {case.name: status(directory / case.name, queue).state for case in cases}
        under_way = [name for name, state in states.items() if state in ("waiting", "running")]
        todo = [case for case in cases if states[case.name] not in ("done", "waiting", "running")]
        if not todo:
            return WrittenSweep(len(cases), 0, len(under_way), 0, 0)
        lines = _lines(directory)
        listed = [name for line in lines for name in line]
        new = sorted(states.keys() - set(listed))
        if listed and new:
            advice = "cases are added to an array's list when it has ended"
            advice += f" ({options.of_scheduler.cancel} ends it), or choose another -o"
            refuse_if_queued(directory, listed, queue, advice)
        count = options.cases_per_task
        lines += [tuple(new[first : first + count]) for first in range(0, len(new), count)]
        small = _write_cases(definition, todo, directory.absolute(), options.scheduler)
        options = with_ranks(options, small[0])
        if options.ranks > (rows := small[-1].rows):
            raise InputError(
                f"--ranks-per-node: {options.ranks} ranks in all, but ranks divide the {rows} rows of a case"
            )
        place = {name: number for number, line in enumerate(lines) for name in line}
        tasks = [place[case.name] for case in todo]
        files = job.render_array(options, lines, name=small[0].name, tasks=tasks, directory=directory)
        record_files(directory, (*files, job_files.OUTPUT), outdated=SCRIPTS)
        for name, text in files.items():
            write_text(directory / name, text)
    return WrittenSweep(len(cases), len(tasks), len(under_way), options.ranks, len(lines))


def _lines(directory: Path) -> list[tuple[str, ...]]:
    """Tasks of an array that was written before, each with its cases; they keep their numbers."""
    path = directory / file_names.CASES
    return [tuple(line.split()) for line in path.read_text(encoding="utf-8").splitlines()] if path.is_file() else []


def _write_cases(definition: Sweep, todo: list[SweepCase], directory: Path, scheduler: str) -> list[Problem]:
    """Write what each case needs, on all cores; the problems of the fewest beads and of the fewest rows.

    Raises:
        InputError: a case cannot be a job.
    """

    def ready(_: str, answer: TaskResult) -> None:
        if answer.failed:
            raise RunError(answer.failed)
        if "refused" in answer.value:
            raise InputError(answer.value["refused"])

    cases = []
    for case in todo:
        wanted, source = request(definition, case, scene_of(definition, case)), f"{definition.source}: case {case.name}"
        arguments = {
            "directory": str(directory / case.name),
            "case": wanted.plain(),
            "source": source,
            "scheduler": scheduler,
        }
        cases.append(computations.Computation(case.name, Task(f"{__name__}:write_case", arguments)))
    with count_bar("decks") as progress, Pool() as pool:
        sizes = computations.evaluate(cases, pool=pool, progress=progress, tell=ready)
    fewest = [min(sizes, key=lambda name: sizes[name].value[of]) for of in ("beads", "rows")]
    return [load(directory / name / file_names.SCENE).problem() for name in fewest]


def write_case(directory: str, case: dict[str, Any], source: str, scheduler: str) -> dict[str, Any]:
    """Write the deck of a case, unless it is there whole, and what a job needs beside it; a restart is resumed.

    Returns:
        Numbers of beads and rows in LAMMPS; or ``refused``, why the case cannot be a job.
    """
    path, wanted = Path(directory), Asked(**case)
    try:
        problem = _write_case(path, wanted, source, SCHEDULERS[scheduler])
    except InputError as error:
        return {"refused": str(error)}
    return {"beads": problem.chains * problem.rows, "rows": problem.rows}


def _write_case(path: Path, wanted: Asked, source: str, scheduler: Scheduler) -> Problem:
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
    files = job.case_files(problem, scheduler)
    of_another_run = listed(path).difference(LAMMPS_FILES)  # one that did not end here
    record_files(path, JOB_FILES, outdated=of_another_run)
    write_json(path / RECORD, Job(files=sorted(listed(path)), request=wanted.plain()).plain())
    for name, text in files.items():
        write_text(path / name, text)
    return problem


def _write_deck(path: Path, wanted: Asked, scene: Scene, source: str) -> None:
    settled, _ = settle(scene, source=source)
    files = scene_files.render(settled)
    begin(path, wanted, scene)
    record_files(path, LAMMPS_FILES)
    for name, text in files.items():
        write_text(path / name, text)
