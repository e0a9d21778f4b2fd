"""Jobs: a deck, or a list of them as one array, run to the end by jobs that submit each other.

| file          | content                                                                                       |
|---------------|-----------------------------------------------------------------------------------------------|
| job.sbatch    | the job: it starts LAMMPS, and before its time limit submits the next one (``job.sh``);        |
|               | ``job.pbs`` or ``job.sge`` where the scheduler is not Slurm                                   |
| in.job        | the deck or its continuation, in stretches between which ``job.flag`` is read; removed when done |
| in.continue   | see `continuation`; removed when done                                                          |
| cases.txt     | of an array: the directories of one task a line                                                |
| job.state     | one line: state, job, cluster, node, time, time limit, reason; for `granchain status`          |
| job.flag      | one word: ``go``, from the job ``stop``, from ``in.job`` ``stopped``, ``done`` or ``full``       |
| job.frames    | files of frames and their bytes at the restart; removed when done, as is ``chains.restart``    |
| job.out       | output of the job, and messages of the scheduler and of what starts the ranks                  |

The deck itself is not touched. Every text that comes from a user is checked by a pattern and quoted.

`render_command` is a job that runs one command on the cores of one node, and submits itself until that has come to its
end. The command is to end with exit code 130 when it is interrupted, keeping its results, and to resume when it
is started again. What it prints is in ``job.out``.
"""

import hashlib
import importlib.resources
import itertools
import re
import shlex
from collections.abc import Sequence
from pathlib import Path

from granchain import InputError
from granchain.parts import Problem, continuation, cost_model, deck, file_names
from workflow.plugins.jobs import job_files
from workflow.plugins.jobs.schedulers import SLURM, Request, Scheduler
from workflow.plugins.jobs.site import RANKS, JobOptions

_DIRECTORY = re.compile(r"[A-Za-z0-9_][A-Za-z0-9._=,+-]{0,254}")
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,63}")
_MAX_CASES = 100_000

STRETCH = 5.0
"""Seconds of a run between two looks at ``job.flag``, by the model of `step_seconds`: a small part of any margin."""


def render_job(options: JobOptions, problem: Problem, directory: Path | None = None) -> dict[str, str]:
    """File name -> text of what a job needs beside the deck, in the deck's directory.

    Raises:
        InputError: more ranks than rows, or the scene asks for what only `granchain run` does.
    """
    refuse_more_ranks(options, problem.rows.existing)
    head = _head(options, problem.name, directory, [], None)
    script = _deck_job(options, head, [f"again=({options.of_scheduler.dependency})"])
    return {options.of_scheduler.script: f"{script}compute\n", **case_files(problem, options.of_scheduler)}


def refuse_more_ranks(options: JobOptions, rows: int) -> None:
    """Refuse a named number of ranks that is larger than that of rows.

    Raises:
        InputError: it is.
    """
    if options.ranks_per_node is not None and options.ranks > rows:
        raise InputError(f"--ranks-per-node: {options.ranks} ranks in all, but ranks divide the {rows} rows")


def case_files(problem: Problem, scheduler: Scheduler = SLURM) -> dict[str, str]:
    """File name -> text of what the directory of one case needs beside its deck, in an array or alone.

    Raises:
        InputError: the scene asks for what only `granchain run` does.
    """
    return {
        job_files.INPUT: render_input(problem, scheduler),
        file_names.CONTINUE: continuation.render_continuation(problem),
    }


def render_array(
    options: JobOptions,
    cases: Sequence[str | tuple[str, ...]],
    *,
    name: str = "sweep",
    tasks: Sequence[int] | None = None,
    directory: Path | None = None,
) -> dict[str, str]:
    """File name -> text of one array over directories that each hold a deck and `case_files`.

    The files belong into the directory that the cases are relative to, and the array is submitted there. A case that is
    done is passed over. The array refuses to run with another list of cases than it was made for.

    Args:
        options: options of every task.
        cases: directory of each task, or several, relative, with `/` between their parts.
        name: name of the job.
        tasks: numbers of the tasks to do, from 0; all by default.
        directory: directory to which the files are written.

    Raises:
        InputError: no cases, too many, one twice, or a directory with another name than letters, digits and ``._=,+-``.
    """
    if not 0 < len(cases) <= _MAX_CASES:
        raise InputError(f"an array of {len(cases)} cases; 1 to {_MAX_CASES} are possible")
    listed = set()
    lines = [(line,) if isinstance(line, str) else line for line in cases]
    for case in itertools.chain(*lines):
        if not all(_DIRECTORY.fullmatch(part) for part in case.split("/")):
            raise InputError(f"{case!r}: not a relative directory of letters, digits and `._=,+-`")
        if case in listed:
            raise InputError(f"{case!r}: is in the list of cases twice")
        listed.add(case)
    numbers = range(len(cases)) if tasks is None else sorted(set(tasks))
    if not numbers or numbers[0] < 0 or numbers[-1] >= len(cases):
        raise InputError(f"tasks of an array: numbers from 0 to {len(cases) - 1}, {list(numbers)[:5]} given")
    listing = "".join(f"{' '.join(line)}\n" for line in lines)
    scheduler = options.of_scheduler
    values = [
        f"cases_sum={hashlib.sha256(listing.encode()).hexdigest()}",
        f"again=({scheduler.task_again})",
    ]
    script = _deck_job(options, _head(options, name, directory, numbers, None), values)
    return {scheduler.script: script + _shell("array.sh", scheduler), file_names.CASES: listing}


def _head(options: JobOptions, name: str, directory: Path | None, tasks: Sequence[int], cores: int | None) -> list[str]:
    """First lines of a job: what it requests of the scheduler, and a timer where that sends no signal before the limit.

    Raises:
        InputError: the name is none of a job.
    """
    if not _NAME.fullmatch(name):
        raise InputError(f"{name!r}: not a name for a job; letters, digits, `.`, `_`, `-`, at most 64")
    keys = {"partition", "account", *options.of_scheduler.options}
    request = Request(
        name=name,
        nodes=options.nodes,
        ranks=options.ranks_per_node or 1,
        cores=cores,
        limit=options.limit,
        time=options.time,
        stop_before=options.stop_before,
        tasks=tasks,
        array_limit=options.array_limit,
        site=options.model_dump(include=keys, exclude_none=True),
        directory=(directory or Path()).absolute(),
    )
    lines = ["#!/bin/bash", *options.of_scheduler.head(request)]
    if not options.of_scheduler.warns:
        timer = f"timeout {options.limit - options.stop_before} tail -f --pid=$$ /dev/null"
        lines.append(f"{{ {timer}; [ $? -ne 124 ] || kill -USR1 $$; }} &  # ends with this shell")
    return lines


def _module_lines(options: JobOptions, failure: str) -> list[str]:
    """Commands that load the modules; ``failure`` is the command where that fails. Nothing where there are none."""
    if not options.modules:
        return []
    modules = shlex.join(options.modules)
    return ["type module >/dev/null 2>&1 || . /etc/profile", f"module load {modules} || {failure.format(modules)}"]


def _deck_job(options: JobOptions, head: list[str], values: list[str]) -> str:
    """The text of a job of decks without its last commands: head, values and functions."""
    scheduler, by_clock = options.of_scheduler, f"$(($(date +%s) + {options.limit}))"
    words = [_with_ranks(word) for word in (*shlex.split(options.launcher or scheduler.launcher), options.lmp)]
    lines = [
        *head,
        f"# In this directory: {scheduler.by_hand}    State: granchain status .    Output: {job_files.OUTPUT}",
        f"ranks={scheduler.ranks}",
        f"lammps=({' '.join(words)} -log none -screen none -nocite)",
        f"max_jobs={options.max_jobs} checkpoint={options.checkpoint}  # seconds between two restarts",
        f'ends=$(date -Is -d "@{scheduler.ends.format(sum=by_clock)}")  # the time limit',
        *values,
    ]
    modules = _module_lines(options, 'end failed "module load {} failed" || return')
    submission = scheduler.submission.format(parsable=scheduler.parsable, again='"${again[@]}"', number="number")
    functions = _shell("job.sh", scheduler, submission=submission, modules="".join(f"    {line}\n" for line in modules))
    return "\n".join(lines) + "\n\n" + functions


def _with_ranks(word: str) -> str:
    """A word of a command, quoted, with the number of ranks where it stands for that."""
    return '"$ranks"'.join(shlex.quote(part) if part else "" for part in word.split(RANKS))


def _shell(name: str, scheduler: Scheduler, **more: str) -> str:
    """Shell commands that are the same in every such job, with those of a scheduler in their places.

    Args:
        name: of the file beside this module.
        scheduler: what stands in the places of its fields.
        more: what stands in further places, or instead.
    """
    text = Path(str(importlib.resources.files("workflow.plugins.jobs") / name)).read_text(encoding="utf-8")
    places = {**vars(scheduler), **more}
    return re.sub("@([a-z_]+)@", lambda place: places[place[1]], text)


def render_command(
    options: JobOptions,
    name: str,
    words: Sequence[str],
    *,
    cores: int,
    jobs: int | None = None,
    directory: Path | None = None,
) -> str:
    """The text of a job's script, to be submitted in the directory that the command works in.

    Args:
        options: what the job asks for; one node.
        name: of the job.
        words: of the command.
        cores: that it uses.
        jobs: at most, each submitted by the one before; by default as the options say.
        directory: that the job works in.

    Raises:
        InputError: more than one node is asked for.
    """
    if options.nodes != 1:
        raise InputError(f"--nodes: {options.nodes} given; this command works on the cores of one node")
    scheduler = options.of_scheduler
    lines = [
        *_head(options, name, directory, [], cores),
        f"# In this directory: {scheduler.by_hand}    Output: {job_files.OUTPUT}",
        f"max_jobs={options.max_jobs if jobs is None else jobs}",
        f"command=({shlex.join(words)})",
        *_module_lines(options, "exit 1"),
        "",
    ]
    submission = scheduler.submission.format(parsable="", again=scheduler.dependency, number=scheduler.number)
    return "\n".join(lines) + "\n" + _shell("command.sh", scheduler, submission=submission)


def render_input(problem: Problem, scheduler: Scheduler = SLURM) -> str:
    """The text of ``in.job``.

    LAMMPS reads ``job.flag`` on one rank and broadcasts the word, so that all ranks see the same. To read the file
    again, the variable is deleted; it must not be deleted by ``next``: LAMMPS of 2021 then crashes.
    """
    read_flag = ["variable flag delete", f"variable flag file {job_files.FLAG}"]
    sections = [
        [
            f"# For {scheduler.script}: the run to its end, or to a restart when {job_files.FLAG} says stop",
            f"log {file_names.LOG} append",
            "processors ${ranks} 1 1          # refused where copies of LAMMPS were started instead of ranks",
        ],
        _part_lines(),
        ["variable steps equal step        # the input sets up and goes no further", "include ${input}"],
        _size_lines(problem),
        _stretch_lines(problem),
        [
            "label restarted",
            f"variable restart_step equal $(step+v_look*ceil(v_checkpoint/{STRETCH:g}):%.0f)",
        ],
        [
            "label stretch",
            "variable steps equal $(step+v_next:%.0f)",
            *continuation.onward_lines(problem, timings=False),
            *read_flag,
            'if "${flag} == go && ${left} > 0 && $(step) < ${restart_step}" then "jump SELF stretch"',
        ],
        [
            *continuation.restart_lines(problem),
            *_keep_lines(),
            *read_flag,
            'if "${flag} == full" then "quit 1"',
            f'if "${{left}} == 0" then "print done file {job_files.FLAG}" "quit"',
            f'if "${{flag}} == stop" then "print stopped file {job_files.FLAG}" "quit"',
            "jump SELF restarted",
        ],
    ]
    return "\n\n".join("\n".join(lines) for lines in sections) + "\n"


def _part_lines() -> list[str]:
    """Variables for the input and the file of frames of a part, by its number."""
    later = file_names.DUMP.replace(".bin", ".${part}.bin")
    return [
        f'if "${{part}} == 1" then "variable {name} string {first}" else "variable {name} string {later}"'
        for name, first, later in [
            ("input", file_names.DECK, file_names.CONTINUE),
            ("dump", file_names.DUMP, later),
        ]
    ]


def _size_lines(problem: Problem) -> list[str]:
    """Variables for the bytes that the file of frames must have."""
    return [
        "variable untimed equal $((step>0)&&(version<20230802))   # such a part has frames without their time",
        "variable dump_first equal $(ceil(step/v_every))",
        "variable dump_bytes equal (floor(step/v_every)-v_dump_first+1)"
        f"*({_frame_bytes(problem)}+4*v_ranks-8*v_untimed)",
    ]


def _frame_bytes(problem: Problem) -> int:
    """Bytes of a frame of the dump, but for 4 bytes a rank."""
    names = deck.columns(problem)
    atoms = problem.chains * problem.rows.count
    return 143 + len(" ".join(names)) + 8 * len(names) * atoms


def _stretch_lines(problem: Problem) -> list[str]:
    """Variables for the steps of a stretch: about `STRETCH` seconds, at the least those after which a run may stop."""
    fixed, bead = cost_model.step_seconds(problem)
    beads, grain = problem.chains * problem.rows.existing * bead, problem.steps_between_stops
    frames = f"+{cost_model.frame_seconds(_frame_bytes(problem)):.3g}/v_every"
    seconds = f"{fixed:.3g}+{beads:.3g}/v_ranks+{cost_model.MESSAGES:g}*(v_ranks>1){frames}"
    return [
        f"variable seconds equal {seconds}   # of a step, by a model",
        f"variable look equal ceil({STRETCH:g}/v_seconds/{grain})*{grain}",
        f"variable left equal {problem.steps}-step",
        "variable next equal (v_left<v_look)*v_left+(v_left>=v_look)*v_look",
    ]


def _keep_lines() -> list[str]:
    """Put the restart that was written in place of the one before, if it and all frames until then are on the disk.

    The record of the frames is put in place first: where only that was done, it is right for the restart before, too.
    """
    record, restart = f"{job_files.FRAMES}.part", file_names.UNFINISHED
    return [
        f'print "${{dump}}:$(v_dump_bytes:%.0f)" file {record} screen no',
        f"shell stat -c %n:%s ${{dump}} | cmp -s - {record} && &",
        f"  tail -c 16 {restart} | grep -q RestartT && &",
        f"  mv {record} {job_files.FRAMES} && mv {restart} {file_names.RESTART} || &",
        f"  echo full 1<>{job_files.FLAG}",
    ]
