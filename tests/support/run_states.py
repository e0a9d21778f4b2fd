"""Directories in each state that a run may have, without running anything."""

import os
import platform
import struct
import time

from small_problems import problem
from stock_lammps import scene

from analysis.files.recording import Writer
from lammps_inputs import file_names, physics
from lammps_inputs.decks import scene_files
from workflow.runs.files import RECORD, write_json
from workflow.runs.status import Queue

CASE = scene(chains=2, beads=8, kappa=0.1, duration=10.0, every=0.1)
STEPS = CASE.problem().steps


def with_deck(directory, **changes):
    directory.mkdir(exist_ok=True)
    scene_files.write(CASE.model_copy(update=changes), directory)
    return directory


def with_frames(directory, last, name=file_names.DUMP):
    """Frames until one, as LAMMPS would have written them."""
    zero = physics.initial_velocity(CASE.problem().system) * 0.0
    with Writer(directory / name, problem()) as writer:
        for frame in range(last + 1):
            writer.append(frame * CASE.problem().steps_per_frame, zero, zero)
    return directory


def aged(directory, seconds=3600.0):
    """As it would be an hour later."""
    for path in directory.iterdir():
        os.utime(path, (time.time() - seconds,) * 2)
    return directory


def with_restart(directory, step):
    """The head and the end of a restart as LAMMPS writes it."""
    magic = b"LammpS RestartT\0"
    (directory / file_names.RESTART).write_bytes(magic + bytes(8) + struct.pack("<iq", 5, step) + bytes(600) + magic)
    return directory


def with_record(directory, **record):
    write_json(directory / RECORD, {"engine": "lammps", "steps": STEPS, "host": platform.node(), **record})
    return directory


def alps(*jobs):
    return Queue("alps", list(jobs))
