"""Which files of a directory are ours: ``run.json`` lists them, and only those are ever replaced or removed.

A name is listed before its file is written, and only where no file of that name stands. What an overwritten run left
is put aside until the new one has all that it begins with, and put back where that fails, also at the next start after
a kill.
"""

import os
import shutil
import stat
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from lammps_inputs import InputError, file_names
from workflow.runs.files import (
    OWN_FILES,
    RECORD,
    TEMPORARY,
    TEMPORARY_NAME,
    all_parts,
    alone,
    changing,
    discard,
    part_number,
    write_json,
)
from workflow.runs.job import Job, load

_ASIDE, _GONE = f"{TEMPORARY}before-", f"{TEMPORARY}gone-"
"""Directories with what a new run takes the place of: until it has begun, and then until it is removed."""


def listed(directory: Path) -> set[str]:
    """Names of the files that ``run.json`` calls ours; it is itself among them if it is ours.

    Raises:
        InputError: it cannot be read.
    """
    return set(load(directory / RECORD).files)


def claim(directory: Path, names: Iterable[str]) -> None:
    """List files that are about to be written.

    Raises:
        InputError: one of them stands there and is not listed; the message says so.
    """
    path, wanted = directory / RECORD, list(dict.fromkeys(names))
    with changing(path):
        try:
            job = load(path)
        except InputError:
            _refuse_others(directory, wanted, set())
            return  # a damaged one is no hindrance, but takes no list
        exists = os.path.lexists(path)
        ours = set(job.files) if exists else {RECORD}
        _refuse_others(directory, wanted, ours)
        if RECORD not in ours:
            raise InputError(f"{path}: was not written by granchain, which needs that name; choose another directory")
        if not ours.issuperset(wanted):
            before = path.stat() if exists else None
            write_json(path, {**job.plain(), "files": sorted({*ours, *wanted, RECORD})})
            if before is not None:  # it describes the run, of which there is nothing new
                os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))


def retire(directory: Path, names: Iterable[str]) -> None:
    """Remove files of ours that something new makes old; others of such a name stay."""
    for name in listed(directory).intersection(names):
        (directory / name).unlink(missing_ok=True)


def _refuse_others(directory: Path, names: Iterable[str], ours: set[str]) -> None:
    for name in names:
        if name not in ours and os.path.lexists(directory / name):
            raise InputError(
                f"{directory / name}: is not listed in {RECORD} as written by granchain, so it is not replaced; "
                "move it away, or choose another directory"
            )


def make_directory(directory: Path) -> None:
    """Make a directory if need be.

    Raises:
        InputError: it cannot be made.
    """
    try:
        directory.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{directory}: cannot be written to ({error.strerror})") from None


def refuse_unusable(directory: Path, names: Iterable[str] = (), *, overwrite: bool = False) -> None:
    """See that a directory can take new files; nothing is made or touched.

    Args:
        directory: new, or empty, or with ``overwrite`` one whose ``run.json`` lists the files of a run.
        names: of the files to come.
        overwrite: whether files of ours may be replaced.

    Raises:
        InputError: the directory holds something else, or cannot be made.
    """
    try:
        if directory.exists() and not directory.is_dir():
            raise InputError(f"{directory}: is a file, not a directory; choose another -o")
        if directory.exists() and others(directory):
            if not overwrite:
                raise InputError(
                    f"{directory}: exists and is not empty; choose another directory, or overwrite it (--overwrite)"
                )
            ours = listed(directory)
            if not ours.issuperset((RECORD, file_names.SCENE)) and not list(directory.glob(f"{_ASIDE}*")):
                raise InputError(
                    f"{directory}: holds no {RECORD} that lists the files of an earlier run, so nothing in it is "
                    "overwritten; choose another -o"
                )
            _refuse_others(directory, names, ours)
        with tempfile.TemporaryFile(dir=next(path for path in (directory, *directory.parents) if path.exists())):
            pass
    except OSError as error:
        raise InputError(f"{directory}: cannot be written to ({error.strerror})") from None


@contextmanager
def prepared(directory: Path, names: Iterable[str] = (), *, overwrite: bool = False) -> Iterator[int]:
    """Make a directory and keep other runs out of it; what it yields is that of `workflow.runs.files.alone`.

    Raises:
        InputError: as `refuse_unusable`, or something runs there.
    """
    names = tuple(names)
    refuse_unusable(directory, names, overwrite=overwrite)
    make_directory(directory)
    with alone(directory) as lock:
        refuse_unusable(directory, names, overwrite=overwrite)  # others may have found it empty at the same time
        yield lock


def refuse_unwritable(directory: Path, files: Iterable[Path]) -> None:
    """See that a directory, and those files in it that are continued, can be written to.

    Raises:
        InputError: one of them cannot.
    """
    place = directory
    try:
        with tempfile.TemporaryFile(dir=directory):
            pass
        for place in files:
            with place.open("ab"):
                pass
    except OSError as error:
        raise InputError(f"{place}: cannot be written to ({error.strerror})") from None


def refuse_to_overwrite(source: str, directory: Path) -> None:
    """See that a scene's own file is not the one that its run would write.

    Raises:
        InputError: it is.
    """
    path = Path(source)
    try:
        same = path.is_file() and path.samefile(directory / file_names.SCENE)
    except (OSError, ValueError):
        return
    if same:
        raise InputError(
            f"-o: {source} stands in {directory}, where a run writes a {file_names.SCENE} of its own; choose another -o"
        )


def others(directory: Path) -> set[str]:
    """Names of what a directory holds, without what a kill may leave behind and nobody else gives such a name."""
    names = {path.name for path in directory.iterdir()}
    return {name for name in names if not (TEMPORARY_NAME.fullmatch(name) or name.startswith((_ASIDE, _GONE)))}


@contextmanager
def replacing(directory: Path, names: Iterable[str]) -> Iterator[None]:
    """Write the first files of something new in a directory that was prepared and is locked.

    What the files of the earlier run were is put aside meanwhile, removed when all is written, and put back on failure.

    Args:
        directory: see `prepared`.
        names: of the files to come.

    Raises:
        InputError: the directory cannot be written to.
    """
    wanted = list(names)
    aside = None
    try:
        remove_leftovers(directory)
        job = load(directory / RECORD)
        ours = {name for name in job.files if not (directory / name).is_dir()}
        _refuse_others(directory, wanted, set(job.files))
        if ours:
            aside = Path(tempfile.mkdtemp(prefix=_ASIDE, dir=directory))
            _move(directory, aside, ours)
        new = Job(files=sorted({RECORD, *wanted, *set(job.files) - ours}), request=job.request)
        write_json(directory / RECORD, new.plain())
        yield
    except BaseException as error:
        if aside is not None:
            _put_back(directory, aside)
        else:
            for name in (*wanted, RECORD):
                (directory / name).unlink(missing_ok=True)
        if isinstance(error, OSError):
            left = f"{directory}: cannot be written to ({error.strerror}); it is left as it was"
            raise InputError(left) from None
        raise
    if aside is not None:
        gone = aside.rename(directory / aside.name.replace(_ASIDE, _GONE))
        shutil.rmtree(gone, ignore_errors=True)


def _move(directory: Path, aside: Path, ours: set[str]) -> None:
    """Put the files of a run aside, its list as the last: where that is aside, everything is."""
    names = sorted(ours)
    if file_names.DUMP in ours:
        names += [path.name for path in all_parts(directory) if path.name not in ours]
    for name in (*(name for name in names if name != RECORD), RECORD):
        if os.path.lexists(directory / name):
            (directory / name).rename(aside / name)


def _put_back(directory: Path, aside: Path) -> None:
    """Take away what was written since files were put aside, and put these back."""
    if (aside / RECORD).exists() and (directory / RECORD).exists():
        for name in listed(directory) - {RECORD}:
            if not (directory / name).is_dir():
                (directory / name).unlink(missing_ok=True)
    for path in sorted(aside.iterdir(), key=lambda path: path.name == RECORD):
        path.replace(directory / path.name)
    aside.rmdir()


def remove_leftovers(directory: Path) -> None:
    """Remove files that were being written when an earlier run was killed; finish what it did with files put aside."""
    for path in directory.glob(f"{_ASIDE}*"):
        _put_back(directory, path)
    for path in directory.glob(f"{_GONE}*"):
        shutil.rmtree(path, ignore_errors=True)
    for path in directory.iterdir():
        if TEMPORARY_NAME.fullmatch(path.name):
            discard(path)


def refuse_links(directory: Path) -> None:
    """See that nothing that a run writes goes elsewhere.

    Raises:
        InputError: one of its files is a link, or no file.
    """
    for path in directory.iterdir():
        if (path.name in OWN_FILES or part_number(path)) and not stat.S_ISREG(path.lstat().st_mode):
            raise InputError(f"{path}: is a link or no file, and nothing is written through one; put a file there")
