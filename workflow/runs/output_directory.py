"""Which files of a directory are ours: ``run.json`` lists them, and only those are ever replaced or removed.

A name is listed before its file is written, and only where no file of that name stands. A run or a deck begins in a
new or empty directory, or replaces an earlier one whose directory holds nothing else. Its first files are written into
a folder of that directory. One rename of the folder decides for them; then the earlier files are removed and the new
ones moved to their place, after a kill by the next command. The directory itself is never moved: a user may stand in
it, and it may be a mount point. Folders of ours stay.

Examples:
    >>> output_directory.make_directory(tmp / "study")
    >>> output_directory.record_files(tmp / "study", ["table.csv"])
    >>> job.load(tmp / "study" / "run.json").files
    ['run.json', 'table.csv']
"""

import os
import stat
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from lammps_inputs import InputError, file_names
from workflow.runs.files import (
    OWN_FILES,
    RECORD,
    TEMPORARY_NAME,
    alone,
    as_json,
    changing,
    complete,
    part_number,
    parts,
    write_json,
)
from workflow.runs.job import Job, load

_NEXT = ".granchain-next"
"""Folder with the first files of what replaces an earlier run."""


def listed(directory: Path) -> set[str]:
    """Names of the files that ``run.json`` calls ours; it is itself among them if it is ours.

    Raises:
        InputError: it cannot be read.
    """
    return set(load(directory / RECORD).files)


def record_files(directory: Path, names: Iterable[str], outdated: Iterable[str] = ()) -> None:
    """List files that are about to be written, and remove those of ours that they make out of date.

    Args:
        directory: where they are written.
        names: of the files.
        outdated: further names; files of the user's of such a name stay.

    Raises:
        InputError: one of the files stands there and is not listed; the message says so.
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
        _refuse_others(directory, (RECORD, *wanted), ours)
        if not ours.issuperset(wanted):
            before = path.stat() if exists else None
            write_json(path, {**job.plain(), "files": sorted({*ours, *wanted, RECORD})})
            if before is not None:  # it describes the run, of which there is nothing new
                os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))
    _remove(directory, ours.intersection(outdated).difference(wanted))


def _refuse_others(directory: Path, names: Iterable[str], ours: set[str]) -> None:
    for name in names:
        if name not in ours and os.path.lexists(directory / name):
            raise InputError(
                f"{directory / name}: is not listed in {RECORD} as written by granchain, so it is not replaced; "
                "move it away, or choose another directory"
            )


def _remove(directory: Path, names: Iterable[str]) -> None:
    for name in names:
        if not (directory / name).is_dir():
            (directory / name).unlink(missing_ok=True)


@contextmanager
def _refused(path: Path) -> Iterator[None]:
    """Refuse a path in one line where the operating system does."""
    try:
        yield
    except OSError as error:
        raise InputError(f"{path}: cannot be written to ({error.strerror})") from None


def make_directory(directory: Path) -> None:
    """Make a directory if need be.

    Raises:
        InputError: it cannot be made.
    """
    with _refused(directory):
        directory.mkdir(parents=True, exist_ok=True)


def others(directory: Path) -> set[str]:
    """Names of what a directory holds, without what a kill may leave behind and nobody else gives such a name."""
    return {path.name for path in directory.iterdir() if not TEMPORARY_NAME.fullmatch(path.name)}


def refuse_unusable(directory: Path, names: Iterable[str] = (), *, overwrite: bool = False) -> None:
    """See that a directory can take new files; nothing is made, and only an interrupted replacement is completed.

    Args:
        directory: new, or empty, or with ``overwrite`` that of a run, which holds nothing but what ``run.json`` lists.
        names: of the files to come.
        overwrite: whether the run may be replaced.

    Raises:
        InputError: the directory holds something else, or cannot be made.
    """
    complete_replacement(directory)
    with _refused(directory):
        if directory.exists() and not directory.is_dir():
            raise InputError(f"{directory}: is a file, not a directory; choose another -o")
        if directory.exists() and (contents := others(directory)):
            if not overwrite:
                raise InputError(
                    f"{directory}: exists and is not empty; choose another directory, or overwrite it (--overwrite)"
                )
            if not listed(directory).issuperset((RECORD, file_names.SCENE)):
                raise InputError(
                    f"{directory}: holds no {RECORD} that lists the files of an earlier run, so nothing in it is "
                    "overwritten; choose another -o"
                )
            folders = {name for name in names if (directory / name).is_dir()}
            shown = sorted(name for name in contents if not name.startswith("."))  # hidden ones of systems stay
            _refuse_others(directory, shown, _of_run(directory) - folders)
        with tempfile.TemporaryFile(dir=next(path for path in (directory, *directory.parents) if path.exists())):
            pass


def _of_run(directory: Path) -> set[str]:
    """Names of the files of a run: those that are listed, and further files of frames."""
    names = listed(directory)
    return names | {path.name for path in parts(directory)} if file_names.DUMP in names else names


@contextmanager
def prepared(
    directory: Path, files: Mapping[str, str], names: Iterable[str], *, overwrite: bool = False, **record: Any
) -> Iterator[int]:
    """Begin something new in a directory, and keep other runs out of it during a block.

    Args:
        directory: see `refuse_unusable`.
        files: name and text of the files that it begins with.
        names: of all files that it may write.
        overwrite: whether an earlier run may be replaced; of that, only what a layer above requested is kept.
        record: what ``run.json`` holds besides (`workflow.runs.job.Job`).

    Yields:
        What `workflow.runs.files.alone` does.

    Raises:
        InputError: as `refuse_unusable`, or something runs there.
        EndedError: the files cannot be written; what was there before still is.
    """
    names = {RECORD, *names}
    refuse_unusable(directory, names, overwrite=overwrite)
    make_directory(directory)
    with alone(directory) as lock:
        refuse_unusable(directory, names, overwrite=overwrite)  # others may have found it empty at the same time
        earlier = load(directory / RECORD)
        folders = (name for name in earlier.files if (directory / name).is_dir())
        job = Job.model_validate({**record, "files": sorted({*names, *folders}), "request": earlier.request})
        with complete(directory / _NEXT, directory=True, named=directory) as folder:
            for name, text in {**files, RECORD: as_json(job.plain()) + "\n"}.items():
                (folder / name).write_bytes(text.encode("utf-8"))
                (folder / name).chmod(0o644)
        with _refused(directory):
            _put_in_place(directory)
        yield lock


def complete_replacement(directory: Path) -> None:
    """Complete what a killed command began: put first files that were completely written in the place of a run.

    Raises:
        InputError: it cannot be done, or something runs there.
    """
    with _refused(directory):
        if (directory / _NEXT).is_dir():
            with alone(directory):
                _put_in_place(directory)


def _put_in_place(directory: Path) -> None:
    """Remove the files of an earlier run, their list at last, and move the new ones to their place."""
    folder = directory / _NEXT
    if (folder / RECORD).exists() and (directory / RECORD).exists():
        _remove(directory, sorted(_of_run(directory), key=lambda name: name == RECORD))
    for path in folder.iterdir():
        path.replace(directory / path.name)
    folder.rmdir()


def refuse_unwritable(directory: Path, files: Iterable[Path]) -> None:
    """See that a directory, and those files in it that are continued, can be written to.

    Raises:
        InputError: one of them cannot.
    """
    with _refused(directory), tempfile.TemporaryFile(dir=directory):
        pass
    for path in files:
        with _refused(path), path.open("ab"):
            pass


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


def refuse_links(directory: Path) -> None:
    """See that nothing that a run writes goes elsewhere.

    Raises:
        InputError: one of its files is a link, or no file.
    """
    for path in directory.iterdir():
        if (path.name in OWN_FILES or part_number(path)) and not stat.S_ISREG(path.lstat().st_mode):
            raise InputError(f"{path}: is a link or no file, and nothing is written through one; put a file there")
