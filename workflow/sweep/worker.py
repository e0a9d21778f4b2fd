"""A process that computes one case after another, so that what a fresh interpreter costs is paid once.

Started as ``python -m workflow.sweep.worker``. Each line of its input is a JSON object that `Job.from_line` reads, and
each is answered with one: ``end`` is "done", "stopped", or "failed" with a ``reason``; ``last`` says that this process
can do no other. Before it there may be others, each with a ``hint`` for whoever waits. It ends when its input does, and
dies with the process that started it.
"""

import contextlib
import ctypes
import json
import os
import signal
import sys
from pathlib import Path
from typing import Any

from lammps_inputs import InputError, file_names, library
from workflow import screen
from workflow.engines.lammps import hosted
from workflow.errors import RunError
from workflow.formats import written_as
from workflow.runs.files import RECORD
from workflow.runs.resume import resume
from workflow.runs.run import Run, run
from workflow.runs.run_directory import RunDirectory
from workflow.sweep.directory import Asked, begin
from workflow.sweep.jobs import Job
from workflow.verdicts.analyse import analyse


def main() -> int:
    """Do every job that comes in, until the input ends."""
    die_with_parent(os.getppid())
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # what LAMMPS or MPI print is no answer

    def say(answer: dict[str, Any]) -> None:
        answers.write(json.dumps(answer) + "\n")
        answers.flush()

    with screen.with_hints(lambda text: say({"hint": text})):
        for line in iter(sys.stdin.readline, ""):
            answer = _answer(Job.from_line(line))
            say(answer)
            if answer.get("last"):
                break
    os._exit(0)  # MPI, which LAMMPS started, would have its say at an orderly end


def _answer(job: Job) -> dict[str, Any]:
    """What came of a job."""
    try:
        return {"end": _do(job)}
    except (RunError, InputError, OSError) as error:
        return {"end": "failed", "reason": str(error), "last": isinstance(error, hosted.LammpsError)}
    except Exception as error:  # no memory, or a mistake of ours: must not end the other cases
        return {"end": "failed", "reason": f"{type(error).__name__}: {error}", "last": True}


def _do(job: Job) -> str:
    directory = Path(job.directory)
    if job.case is not None and _run(directory, job.case, check=job.check).outcome != "done":
        return "stopped"
    if job.case is None and job.check and (directory / RECORD).is_file():
        resume(directory)  # it is done, but perhaps its error was not measured any more
    with written_as(job.figures):
        analyse(RunDirectory(directory), figures=bool(job.figures))
    return "done"


def _run(directory: Path, case: Asked, *, check: bool) -> Run:
    """From the last restart if there is one; most cases take less time than passes until one is written."""
    if (directory / file_names.RESTART).is_file():
        with contextlib.suppress(InputError):  # not one to go on from
            resumed = resume(directory, check=check, lammps=hosted.run)
            if resumed is not None:
                return resumed
    scene = library.from_plain(case.scene, str(directory))
    begin(directory, case, scene)
    return run(scene, directory, engine=case.engine, overwrite=True, check=check, lammps=hosted.run)


def die_with_parent(parent: int) -> None:
    """Let the system kill this process when the one that started it is gone, so that two never share a directory."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(1, int(signal.SIGKILL))  # PR_SET_PDEATHSIG
    if os.getppid() != parent:
        os._exit(1)


if __name__ == "__main__":
    sys.exit(main())
