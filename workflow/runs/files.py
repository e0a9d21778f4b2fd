"""Which files in a run's directory are a run's: their names, and those of the frames there are."""

import re
from pathlib import Path

from lammps_inputs import file_names

EVENTS = "events.csv"
RECORD = "run.json"

OWN_FILES = (
    *(file_names.SCENE, file_names.DECK, file_names.DATA, file_names.DUMP, file_names.LOG, EVENTS, RECORD),
    *(
        file_names.CONTINUE,
        file_names.RESTART,
        file_names.RESTART_SUMS,
        file_names.UNFINISHED,
        file_names.PEAKS,
        file_names.PEAKS_STATE,
    ),
    *file_names.JOB_FILES,
    file_names.SNAPSHOTS,
)
LAMMPS_FILES = tuple(name for name in OWN_FILES if name != EVENTS and name not in file_names.JOB_FILES)
"""What the deck for LAMMPS, and a run of it, may leave in a directory before it is analysed."""

_PART = re.compile(r"chains\.(dump|snapshots)(?:\.([1-9][0-9]{0,8}))?\.bin")


def parts(directory: Path, kind: str = "dump") -> list[Path]:
    """The files of frames there are, in order; with "snapshots" those of all beads beside frames of some."""
    found = {path: match for path in directory.iterdir() if (match := _PART.fullmatch(path.name)) and path.is_file()}
    return sorted((path for path, match in found.items() if match[1] == kind), key=part_number)


def all_parts(directory: Path) -> list[Path]:
    """The files of frames and those of snapshots."""
    return [*parts(directory), *parts(directory, "snapshots")]


def part_number(path: Path) -> int:
    """Number of a file of frames; 0 if it is none."""
    match = _PART.fullmatch(path.name)
    return 0 if match is None else int(match[2] or 1)
