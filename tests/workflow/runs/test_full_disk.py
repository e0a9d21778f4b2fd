"""A disk that is full during frames, restart, record and analysis: one line says so, and what was there stays."""

import os
import shutil
import signal
import subprocess
import warnings
from pathlib import Path

import numpy as np
import pytest
from kill_many import frames
from stock_lammps import run as run_deck
from stock_lammps import scene

from analysis.files.binary_dump import CutDumpWarning
from lammps_inputs import file_names, strict_yaml
from workflow.cli import main
from workflow.engines.lammps import files_on_disk, mpi
from workflow.engines.lammps.files_on_disk import FramesOnDisk
from workflow.engines.registry import engine_names
from workflow.errors import RunError
from workflow.runs.resume import resume
from workflow.runs.run import run
from workflow.runs.run_directory import RunDirectory

RANKS = [1, pytest.param(2, marks=pytest.mark.skipif(mpi.cores() < 2, reason="needs two cores"))]

DENSE = scene(chains=2, beads=30, kappa=0.1, duration=250.0, every=0.1)
"""3.9 MB of frames."""

SPARSE = scene(chains=3, beads=40, kappa=0.1, duration=2000.0, every=2.0, recorded=(1,))
"""Frames of 0.3 kB; a restart takes 25 kB, and the run some seconds."""


class Disk:
    """A small one of its own."""

    def __init__(self, path):
        self.path = path
        path.mkdir()
        done = subprocess.run(
            ["mount", "-t", "tmpfs", "-o", "size=2m", "granchain-test", path], capture_output=True, text=True
        )
        if done.returncode:
            pytest.skip(f"cannot mount a small disk: {done.stderr.strip()}")

    def grow(self):
        subprocess.run(["mount", "-o", "remount,size=40m", self.path], check=True)

    def fill(self, *, but):
        """Leave some bytes free."""
        status = os.statvfs(self.path)
        free = status.f_bavail * status.f_frsize
        with (self.path / "filler").open("ab") as file:
            file.write(bytes(max(0, free - but)))

    def unmount(self):
        subprocess.run(["umount", "-l", self.path], check=True)


@pytest.fixture
def disk(tmp_path):
    made = Disk(tmp_path / "disk")
    yield made
    made.unmount()


def complaint(words, capsys):
    """The one line that a command fails with."""
    assert main([str(word) for word in words]) == 1
    out, err = capsys.readouterr()
    assert all("units: " in line for line in out.splitlines())
    (line,) = err.splitlines()
    return line


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    return run(DENSE, tmp_path_factory.mktemp("dense") / "whole", check=False).directory


@pytest.mark.slow
@pytest.mark.parametrize("ranks", RANKS)
def test_frames_that_fill_the_disk_are_kept_and_gone_on_with(ranks, disk, whole, tmp_path, capsys):
    (tmp_path / "scene.yaml").write_text(strict_yaml.dump(DENSE.plain()))
    directory = disk.path / "run"
    words = ["run", tmp_path / "scene.yaml", "-o", directory, "--ranks", ranks, "--restart-every", "0", "--no-check"]
    line = complaint(words, capsys)
    assert "No space left on device" in line or "is the disk full?" in line
    assert f"; `granchain run --resume {directory}` resumes at step " in line
    assert not list(directory.glob(".*"))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", CutDumpWarning)  # the last frame may be cut
        kept = frames(directory)
    assert 1000 < len(kept) < 2501
    np.testing.assert_array_equal(kept, frames(whole.path)[: len(kept)])
    disk.grow()
    result = resume(directory, check=False)
    assert result.directory.job.resumed[0].from_step > 0
    np.testing.assert_array_equal(frames(directory), frames(whole.path))
    assert result.directory.job.results == whole.job.results


@pytest.mark.slow
def test_a_restart_that_does_not_fit_leaves_the_one_before(disk, tmp_path):
    directory = disk.path / "run"

    def fill(*_):
        if not seen and (directory / file_names.RESTART).exists():
            seen.append(files_on_disk.step_of(directory / file_names.RESTART))
            disk.fill(but=8192)
            os.kill(os.getpid(), signal.SIGINT)  # a restart is written at Ctrl-C, too

    seen = []
    with pytest.raises(RunError, match=r"at step \d+, chains\.restart cannot be written.*--resume") as caught:
        run(SPARSE, directory, check=False, restart_every=0.0, progress=fill)
    assert len(str(caught.value).splitlines()) == 1
    assert files_on_disk.step_of(directory / file_names.RESTART) >= seen[0] > 0
    assert not (directory / file_names.UNFINISHED).exists()
    (disk.path / "filler").unlink()
    result = resume(directory, check=False)
    assert result.directory.job.resumed[0].from_step >= seen[0]
    assert result.directory.job.reason is None
    assert result.directory.job.results == run(SPARSE, tmp_path / "whole", check=False).directory.job.results


@pytest.mark.parametrize("begun", [0, 7, 10])
def test_frames_that_lammps_did_not_miss_are_missed(begun, tmp_path):
    problem = scene(chains=2, beads=30, kappa=0.1).problem()  # a frame each 10 steps
    file = tmp_path / "frames"
    on_disk = FramesOnDisk(file, problem, begun)
    file.write_bytes(b"")
    first = -(-begun // 10)
    sizes = {step: 1600 * (step // 10 - first + 1) for step in (begun, 20, 29, 30, 200)}
    for step, size in sizes.items():
        file.write_bytes(bytes(size))
        assert on_disk.whole(step)
    file.write_bytes(bytes(sizes[200] - 1))
    assert not on_disk.whole(200)
    assert not FramesOnDisk(file, problem, 0).whole(100000)


@pytest.mark.slow
def test_a_record_that_cannot_be_written_does_not_hide_why(disk):
    directory = disk.path / "run"

    def fill(*_):
        disk.fill(but=0)

    with pytest.raises(RunError, match=r"No space left|disk full"):
        run(DENSE, directory, check=False, progress=fill)
    assert RunDirectory(directory).job.outcome in ("running", "failed")
    (disk.path / "filler").unlink()
    disk.grow()
    assert resume(directory, check=False).outcome == "done"


@pytest.mark.parametrize("engine", [name for name in engine_names() if name != "lammps"])
def test_other_engines_say_so_too(engine, disk):
    dense = scene(chains=2, beads=30, kappa=0.1, gap=1.0, duration=250.0, every=0.1)
    with pytest.raises(RunError, match=r"No space left on device.*--resume.* starts again, as there is no restart$"):
        run(dense, disk.path / "run", engine=engine)
    disk.grow()
    assert resume(disk.path / "run").outcome == "done"


@pytest.mark.slow
def test_an_analysis_that_does_not_fit_leaves_the_earlier_one(disk, capsys):
    directory = run(scene(chains=2, beads=20, kappa=0.1, duration=30.0), disk.path / "run", check=False).directory.path
    words = ["analyze", str(directory), "--no-figures"]
    assert main(words) == 0
    capsys.readouterr()
    before = {path.name: path.read_bytes() for path in directory.iterdir()}
    disk.fill(but=0)
    line = complaint(words, capsys)
    assert line.startswith(f"granchain: {directory}/")
    assert line.endswith("cannot be written (No space left on device); what was there is left as it was")
    assert {path.name: path.read_bytes() for path in directory.iterdir()} == before
    (disk.path / "filler").unlink()
    assert main(words) == 0


@pytest.mark.slow
def test_a_run_that_does_not_even_begin_can_be_begun_later(disk, tmp_path, capsys):
    disk.fill(but=4096)
    (tmp_path / "scene.yaml").write_text(strict_yaml.dump(scene(chains=2, beads=120, kappa=0.1).plain()))
    words = ["run", str(tmp_path / "scene.yaml"), "-o", str(disk.path / "run"), "--no-check"]
    line = complaint([*words, "--quiet"], capsys)
    assert "cannot be written (No space left on device)" in line
    (disk.path / "filler").unlink()
    disk.grow()
    assert main([*words, *(["--overwrite"] if (disk.path / "run" / file_names.SCENE).exists() else [])]) == 0


def small(duration):
    return scene(chains=2, beads=20, kappa=0.1, duration=duration)


def test_a_run_that_does_not_fit_does_not_replace_the_earlier_one(disk, tmp_path, capsys):
    directory = run(small(1.0), disk.path / "run", engine="reference").directory.path
    before = {path.name: path.read_bytes() for path in directory.iterdir()}
    (tmp_path / "scene.yaml").write_text(strict_yaml.dump(small(2.0).plain()))
    disk.fill(but=0)
    words = ["run", tmp_path / "scene.yaml", "-o", directory, "--engine", "reference", "--overwrite"]
    line = complaint(words, capsys)
    assert line.startswith(f"granchain: {directory}: cannot be written (No space left on device); what was there is")
    assert {path.name: path.read_bytes() for path in directory.iterdir()} == before


def test_a_run_at_a_mount_point_is_overwritten(disk):
    run(small(1.0), disk.path, engine="reference")
    run(small(2.0), disk.path, engine="reference", overwrite=True)
    assert RunDirectory(disk.path).scene.duration == 2.0


# --- a restart takes the place of an earlier one when all that it needs is on the disk --------------------------------

STEP = 400


@pytest.fixture
def ready(tmp_path, monkeypatch):
    """In a directory with frames and a restart that LAMMPS has just written."""
    run_deck(scene(beads=4), tmp_path / "run", before_run=f"restart {STEP} one two")
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
