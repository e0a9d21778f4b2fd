"""Write a sweep for a cluster: a deck per case, and one array of jobs over those that are not done."""

import argparse
from dataclasses import dataclass
from pathlib import Path

from granchain import Scene
from granchain.parts import Problem, case_decks, file_names, output_directory, write_text
from workflow.plugins.jobs import job, job_files
from workflow.plugins.jobs.ranks import with_ranks
from workflow.plugins.jobs.registry import JOB_FILES, SCHEDULERS, SCRIPTS
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


def _rows(scene: Scene) -> int:
    """Rows of a scene in LAMMPS, at most."""
    return scene.window if isinstance(scene.window, int) else scene.beads


def write_array(arguments: argparse.Namespace, options: JobOptions) -> WrittenSweep:
    """Write decks and the array; nothing of a case that is done, waits or runs is touched.

    Args:
        arguments: of the command ``sweep``; the array is to be submitted in its directory.
        options: of the job.

    Raises:
        InputError: as `workflow.sweep.run_sweep.plan`; or the list of cases would change under an array in the queue.
    """
    directory = arguments.output
    with case_decks(arguments, lambda scene: job.refuse_more_ranks(options, _rows(scene))) as decks:
        if not decks.to_do:
            return WrittenSweep(len(decks.states), 0, len(decks.under_way), 0, 0)
        lines = _lines(directory)
        listed = [name for line in lines for name in line]
        new = sorted(decks.states.keys() - set(listed))
        if listed and new:
            advice = "cases are added to an array's list when it has ended"
            advice += f" ({options.of_scheduler.cancel} ends it), or choose another -o"
            decks.refuse_if_queued(listed, advice)
        count = options.cases_per_task
        lines += [tuple(new[first : first + count]) for first in range(0, len(new), count)]
        small = decks.write(f"{__name__}:files_of_case", {"scheduler": options.scheduler})
        job.refuse_more_ranks(options, small[-1].rows.existing)  # of windows whose width is found by trials, too
        options = with_ranks(options, small[0])
        place = {name: number for number, line in enumerate(lines) for name in line}
        tasks = [place[name] for name in decks.to_do]
        files = job.render_array(options, lines, name=small[0].name, tasks=tasks, directory=directory)
        output_directory.record_files(directory, (*files, job_files.OUTPUT), outdated=SCRIPTS)
        for name, text in files.items():
            write_text(directory / name, text)
    return WrittenSweep(len(decks.states), len(tasks), len(decks.under_way), options.ranks, len(lines))


def _lines(directory: Path) -> list[tuple[str, ...]]:
    """Tasks of an array that was written before, each with its cases; they keep their numbers."""
    path = directory / file_names.CASES
    return [tuple(line.split()) for line in path.read_text(encoding="utf-8").splitlines()] if path.is_file() else []


def files_of_case(problem: Problem, scheduler: str) -> dict[str, str | None]:
    """Name -> text of what a job needs beside the deck of a case, and None for what it writes itself."""
    return {**dict.fromkeys(JOB_FILES), **job.case_files(problem, SCHEDULERS[scheduler])}
