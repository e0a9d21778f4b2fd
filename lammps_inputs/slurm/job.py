"""Slurm jobs: a deck, or a list of them as one array, run to the end by jobs that submit each other.

| file          | what                                                                                  |
|---------------|---------------------------------------------------------------------------------------|
| job.sbatch    | requests nodes and time, checks LAMMPS and the deck, submits itself until done (``job.sh``) |
| in.job        | the deck, or its continuation, up to the time limit; then a restart; removed when done  |
| in.continue   | see `continuation`; removed when done                                                 |
| cases.txt     | of an array: the directories of one task a line                                       |
| job.state     | written by the job: the state of the run, for `granchain status`                       |
| job.step      | written by the job: step of the last restart; removed when done                        |
| job.frames    | written by the job: which frames belong to the restart; removed when done              |
| job.out       | output of the job, and messages of Slurm                                               |

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
from collections.abc import Mapping, Sequence
from pathlib import Path

from lammps_inputs import file_names, window
from lammps_inputs.decks import deck
from lammps_inputs.decks.continuation import onward_lines, render_continuation, restart_lines
from lammps_inputs.errors import InputError
from lammps_inputs.problem import Problem
from lammps_inputs.slurm.site import JobOptions

_DIRECTORY = re.compile(r"[A-Za-z0-9_][A-Za-z0-9._=,+-]{0,254}")
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,63}")
_MAX_CASES = 100_000


def render_job(options: JobOptions, problem: Problem, directory: Path | None = None) -> dict[str, str]:
    """File name -> text of what a job needs beside the deck, in the deck's directory.

    Raises:
        InputError: more ranks than rows, or the scene asks for what only `granchain run` does.
    """
    if options.ranks > problem.rows:
        raise InputError(f"--ranks-per-node: {options.ranks} ranks in all, but ranks divide the {problem.rows} rows")
    return {file_names.JOB: _script(options, problem.name, directory), **case_files(problem)}


def case_files(problem: Problem) -> dict[str, str]:
    """File name -> text of what the directory of one case needs beside its deck, in an array or alone.

    Raises:
        InputError: the scene asks for what only `granchain run` does.
    """
    return {file_names.JOB_INPUT: render_input(problem), file_names.CONTINUE: render_continuation(problem)}


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
        options: what every task asks for.
        cases: of each task its directory, or several, relative, with `/` between their parts.
        name: of the job.
        tasks: numbers of the tasks to do, from 0; all by default.
        directory: that the files are written to.

    Raises:
        InputError: no cases, too many, one twice, or a directory with another name than letters, digits and ``._=,+-``.
    """
    if not 0 < len(cases) <= _MAX_CASES:
        raise InputError(f"an array of {len(cases)} cases; 1 to {_MAX_CASES} are possible")
    seen = set()
    lines = [(line,) if isinstance(line, str) else line for line in cases]
    for case in itertools.chain(*lines):
        if not all(_DIRECTORY.fullmatch(part) for part in case.split("/")):
            raise InputError(f"{case!r}: not a relative directory of letters, digits and `._=,+-`")
        if case in seen:
            raise InputError(f"{case!r}: is in the list of cases twice")
        seen.add(case)
    numbers = range(len(cases)) if tasks is None else sorted(set(tasks))
    if not numbers or numbers[0] < 0 or numbers[-1] >= len(cases):
        raise InputError(f"tasks of an array: numbers from 0 to {len(cases) - 1}, {list(numbers)[:5]} given")
    listing = "".join(f"{' '.join(line)}\n" for line in lines)
    return {file_names.JOB: _script(options, name, directory, listing, _ranges(numbers)), file_names.CASES: listing}


def _ranges(numbers: Sequence[int]) -> str:
    """Ascending numbers as Slurm reads them, such as ``0-3,7``."""
    found: list[list[int]] = []
    for number in numbers:
        if found and number == found[-1][1] + 1:
            found[-1][1] = number
        else:
            found.append([number, number])
    return ",".join(str(first) if first == last else f"{first}-{last}" for first, last in found)


def _head(options: JobOptions, name: str, directory: Path | None, more: Mapping[str, object]) -> list[str]:
    """First lines of a job: what it asks Slurm for, ``more`` by option without those that are None.

    Slurm would expand a % in the directory's name but for the backslashes before the name of the output. A backslash
    in the directory's name it takes away, so there the script alone opens its output.

    Raises:
        InputError: the name is none.
    """
    if not _NAME.fullmatch(name):
        raise InputError(f"{name!r}: not a name for a job; letters, digits, `.`, `_`, `-`, at most 64")
    plain = "\\" not in str((directory or Path()).absolute())
    asked = {
        "job-name": name,
        "nodes": options.nodes,
        **more,
        "time": options.time,
        "partition": options.partition,
        "account": options.account,
        "qos": options.qos,
        "constraint": options.constraint,
        "output": rf"\\{file_names.JOB_OUTPUT}" if plain else "/dev/null",
        "open-mode": "append",
    }
    return ["#!/bin/bash", *(f"#SBATCH --{key}={value}" for key, value in asked.items() if value is not None), ""]


def _script(options: JobOptions, name: str, directory: Path | None, listing: str | None = None, tasks: str = "") -> str:
    limit = "" if options.array_limit is None else f"%{options.array_limit}"
    asked = {
        "ntasks-per-node": options.ranks_per_node or 1,
        "cpus-per-task": 1,
        "array": None if listing is None else tasks + limit,
    }
    values = {
        "margin": options.stop_before,
        "checkpoint": options.checkpoint,
        "max_jobs": options.max_jobs,
        "lmp": options.lmp,
        **({} if listing is None else {"cases_sum": hashlib.sha256(listing.encode()).hexdigest()}),
    }
    lines = [
        *_head(options, name, directory, asked),
        f"# In this directory: sbatch {file_names.JOB}    State: granchain status .    Output: {file_names.JOB_OUTPUT}",
        *(f"{key}={shlex.quote(str(value))}" for key, value in values.items()),
        f"launch=({shlex.join(shlex.split(options.launcher))})",
        f"modules=({shlex.join(options.modules)})",
        "",
    ]
    return "\n".join(lines) + "\n" + _body("job.sh") + ("compute\n" if listing is None else _body("array.sh"))


def _body(name: str) -> str:
    """What is the same in every such job."""
    return Path(str(importlib.resources.files("lammps_inputs.slurm") / name)).read_text(encoding="utf-8")


def render_command(
    options: JobOptions,
    name: str,
    words: Sequence[str],
    *,
    cores: int,
    jobs: int | None = None,
    directory: Path | None = None,
) -> str:
    """The text of ``job.sbatch``, to be submitted in the directory that the command works in.

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
    asked = {"ntasks": 1, "cpus-per-task": cores, "signal": f"B:TERM@{options.stop_before}"}
    lines = [
        *_head(options, name, directory, asked),
        f"# In this directory: sbatch {file_names.JOB}    Output: {file_names.JOB_OUTPUT}",
        f"max_jobs={options.max_jobs if jobs is None else jobs}",
        f"command=({shlex.join(words)})",
        f"modules=({shlex.join(options.modules)})",
        "",
    ]
    return "\n".join(lines) + "\n" + _body("command.sh")


def render_input(problem: Problem) -> str:
    """The text of ``in.job``.

    Time is looked at between two runs of ``look`` steps, and all ranks must see the same: so atoms vote, and a sum over
    all ranks counts them.
    """
    whole = problem.frames_per_snapshot
    save = [
        *restart_lines(problem),
        "shell sh .job.keep ${dump} $(v_dump_bytes:%.0f)"
        + ("" if whole is None else " ${snapshots} $(v_snapshots_bytes:%.0f)"),
        "variable kept delete",
        "variable kept file .job.kept",
        'if "${kept} == lost" then "quit 3"',
    ]
    grain = window.stride(problem)
    sizes = _size_lines("dump", "v_every", _frame_bytes(problem))
    if whole is not None:
        sizes += _size_lines("snapshots", f"({whole}*v_every)", _frame_bytes(problem.snapshots()))
    tell = f'print "$(step:%.0f)" file {file_names.JOB_STEP} screen no'
    sections = [
        [
            f"# For {file_names.JOB}: ${{part}} to its end, or until ${{seconds}} have passed and a restart is left.",
            f"log {file_names.LOG} append",
            "timer timeout ${seconds} every 2000000000   # counts from here; never ends a run",
        ],
        [
            "variable steps equal step        # the part sets up and goes no further",
            "include ${part}",
        ],
        [
            "variable untimed equal $((step>0)&&(version<20230802))   # such a part has frames without their time",
            *sizes,
            "variable kept string none",
            f"variable left equal {problem.steps}-step",
            f"variable stride equal $(ceil(v_look/{grain})*{grain})",
            "variable next equal (v_left<v_stride)*v_left+(v_left>=v_stride)*v_stride",
            "variable over atom timeremain<=0.0   # some releases stop at 0",
            "group late empty",
            "variable looks loop ${rounds}",
        ],
        [
            "label again",
            "variable steps equal $(step+v_next:%.0f)",
            *onward_lines(problem),
            'if "${left} == 0" then "jump SELF end"',
            "group late clear",
            "group late variable over",
            'if "$(count(late)) > 0" then "jump SELF end"',
            "next looks",
            "jump SELF again",
            *save,
            tell,
            "variable looks loop ${rounds}",
            "jump SELF again",
        ],
        ["label end", *save, tell],
    ]
    return "\n\n".join("\n".join(lines) for lines in sections) + "\n"


def _size_lines(dump: str, every: str, frame: int) -> list[str]:
    """Variables for the bytes that the part of a dump must have by its frames."""
    return [
        f"variable {dump}_first equal $(ceil(step/{every}))",
        f"variable {dump}_bytes equal (floor(step/{every})-v_{dump}_first+1)*({frame}+4*v_ranks-8*v_untimed)",
    ]


def _frame_bytes(problem: Problem) -> int:
    """Bytes of a frame of the dump, but for 4 bytes a rank."""
    names = deck.columns(problem)
    atoms = problem.chains * problem.rows_a_frame
    return 143 + len(" ".join(names)) + 8 * len(names) * atoms
