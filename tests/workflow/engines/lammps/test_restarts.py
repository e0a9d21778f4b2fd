"""A restart takes the place of an earlier one when all that it needs is on the disk."""

import os
import shutil
from pathlib import Path

import pytest
from stock_lammps import run, scene

from lammps_inputs import file_names
from workflow.engines.lammps import files_on_disk

STEP = 400


@pytest.fixture
def ready(tmp_path, monkeypatch):
    """In a directory with frames and a restart that LAMMPS has just written."""
    run(scene(beads=4), tmp_path / "run", before_run=f"restart {STEP} one two")
    monkeypatch.chdir(tmp_path / "run")
    shutil.copy("one", file_names.UNFINISHED)
    return Path(file_names.DUMP)


def test_frames_restart_and_its_sum_reach_the_disk_before_the_restart_takes_its_place(ready, monkeypatch):
    order, rename = [], Path.replace

    def fsync(handle):
        order.append(Path(f"/proc/self/fd/{handle}").readlink().name)

    def replace(path, target):
        order.append(str(target))
        rename(path, target)

    monkeypatch.setattr(os, "fsync", fsync)
    monkeypatch.setattr(Path, "replace", replace)
    files_on_disk.keep(ready, STEP)
    sums = file_names.RESTART_SUMS
    assert order == [file_names.DUMP, file_names.UNFINISHED, f".{sums}.granchain-part", sums, file_names.RESTART]
    assert files_on_disk.intact(Path(file_names.RESTART))


def test_a_restart_of_another_step_is_not_kept(ready):
    with pytest.raises(OSError, match="cannot be written completely"):
        files_on_disk.keep(ready, STEP + 1)
    assert not Path(file_names.UNFINISHED).exists()
    assert not Path(file_names.RESTART).exists()
