"""The directory of a command that makes many runs, or none: ``run.json`` says which, and whether it came to its end."""

import contextlib
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from lammps_inputs import InputError
from workflow.runs.files import RECORD
from workflow.runs.locks import alone, changing
from workflow.runs.own_files import claim
from workflow.runs.record import read_record
from workflow.runs.whole_files import write_json

RESUMES = "the same command resumes it"


@contextlib.contextmanager
def study_directory(
    directory: Path, command: str, names: Iterable[str], *, result: str, resume: str = RESUMES
) -> Iterator[None]:
    """Make a directory if need be, and keep others out of it; it is done when the block ends without an exception.

    Args:
        directory: new, or of an earlier start of the same command.
        command: which makes it.
        names: of the files and folders that it writes.
        result: which file to look at, for ``granchain status``.
        resume: what to do with it where the command did not come to its end.

    Raises:
        InputError: the directory cannot be written, is in use, or holds such a file of somebody else's.
    """
    with contextlib.ExitStack() as stack:
        try:
            directory.mkdir(parents=True, exist_ok=True)
            stack.enter_context(alone(directory))
            claim(directory, names)
            mark(directory, command, done=False, result=result, resume=resume)
        except OSError as error:
            raise InputError(f"{directory}: cannot be written to ({error.strerror})") from None
        yield
        mark(directory, command, done=True, result=result, resume=resume)


def mark(directory: Path, command: str, *, done: bool, result: str, resume: str = RESUMES) -> None:
    """Note in ``run.json`` which command made a directory, and whether it came to its end."""
    path = directory / RECORD
    with changing(path):
        record = read_record(path) if path.is_file() else {"files": [RECORD]}
        study = {"command": command, "done": done, "result": result, "resume": resume}
        write_json(path, {**record, "study": study})


def sentence(study: dict[str, Any]) -> str:
    """What ``granchain status`` says of a directory whose ``run.json`` holds this as ``study``."""
    return f"of `granchain {study['command']}`; {study['result'] if study['done'] else study['resume']}"
