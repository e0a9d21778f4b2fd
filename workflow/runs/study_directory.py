"""The directory of a command that makes many runs, or none: ``run.json`` says which, and whether it came to its end."""

import contextlib
from collections.abc import Iterable, Iterator
from pathlib import Path

from workflow.runs import job
from workflow.runs.locks import alone
from workflow.runs.own_files import claim, make_directory

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
    make_directory(directory)
    with alone(directory):
        claim(directory, names)
        mark(directory, command, done=False, result=result, resume=resume)
        yield
        mark(directory, command, done=True, result=result, resume=resume)


def mark(directory: Path, command: str, *, done: bool, result: str, resume: str = RESUMES) -> None:
    """Note in ``run.json`` which command made a directory, and whether it came to its end."""
    study = job.Study(command=command, done=done, result=result, resume=resume)
    job.update(directory, study=study.plain())
