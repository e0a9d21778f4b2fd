"""A disk that is full during frames, restart and analysis: one line says so, and what was there stays."""

import os
import signal
import subprocess
import warnings

import numpy as np
import pytest
from kill_many import frames
from stock_lammps import scene

from analysis.files.binary_dump import CutDumpWarning
from lammps_inputs import file_names, strict_yaml
from workflow.cli import main
from workflow.engines.lammps import files_on_disk
from workflow.errors import RunError
from workflow.runs.resume import resume
from workflow.runs.run import run


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


@pytest.fixture
def disk(tmp_path):
    made = Disk(tmp_path / "disk")
    yield made
    subprocess.run(["umount", "-l", made.path], check=True)


def complaint(words, capsys):
    """The one line of complaint of a command that fails, whose output is otherwise as usual."""
    assert main([str(word) for word in words]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    return line


@pytest.mark.parametrize("engine", ["reference", pytest.param("lammps", marks=pytest.mark.slow)])
def test_frames_that_fill_the_disk_are_kept_and_gone_on_with(engine, disk, tmp_path, capsys):
    dense = scene(chains=2, beads=30, kappa=0.1, duration=250.0, every=0.1)  # 3.9 MB of frames
    (tmp_path / "scene.yaml").write_text(strict_yaml.dump(dense.plain()))
    whole, directory = run(dense, tmp_path / "whole", engine=engine, check=False).directory, disk.path / "run"
    words = ["run", tmp_path / "scene.yaml", "-o", directory, "--engine", engine, "--restart-every", "0", "--no-check"]
    line = complaint(words, capsys)
    assert "No space left on device" in line or "is the disk full?" in line
    assert f"`granchain run --resume {directory}` " in line
    assert not list(directory.glob(".*"))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", CutDumpWarning)  # the last frame may be cut
        kept = frames(directory)
    assert 1000 < len(kept) < 2501
    np.testing.assert_array_equal(kept, frames(whole.path)[: len(kept)])
    disk.grow()
    result = resume(directory, check=False)
    assert (result.directory.job.resumed[0].from_step > 0) == (engine == "lammps")
    np.testing.assert_array_equal(frames(directory), frames(whole.path))
    assert result.directory.job.results == whole.job.results


@pytest.mark.slow
def test_a_restart_that_does_not_fit_leaves_the_one_before(disk, tmp_path):
    """Frames take 0.3 kB, a restart 25 kB, and the run some seconds."""
    sparse = scene(chains=3, beads=40, kappa=0.1, duration=2000.0, every=2.0, recorded=(1,))
    directory, seen = disk.path / "run", []

    def fill(*_):
        if not seen and (directory / file_names.RESTART).exists():
            seen.append(files_on_disk.step_of(directory / file_names.RESTART))
            disk.fill(but=8192)
            os.kill(os.getpid(), signal.SIGINT)  # a restart is written at Ctrl-C, too

    with pytest.raises(RunError, match=r"at step \d+, chains\.restart cannot be written.*--resume") as caught:
        run(sparse, directory, check=False, restart_every=0.0, progress=fill)
    assert len(str(caught.value).splitlines()) == 1
    assert files_on_disk.step_of(directory / file_names.RESTART) >= seen[0] > 0
    assert not (directory / file_names.UNFINISHED).exists()
    (disk.path / "filler").unlink()
    result = resume(directory, check=False)
    assert result.directory.job.resumed[0].from_step >= seen[0]
    assert result.directory.job.results == run(sparse, tmp_path / "whole", check=False).directory.job.results


@pytest.mark.slow
def test_an_analysis_or_another_run_that_does_not_fit_leaves_what_was_there(disk, tmp_path, capsys):
    small = scene(chains=2, beads=20, kappa=0.1, duration=30.0)
    directory = run(small, disk.path / "run", engine="reference").directory.path
    (tmp_path / "scene.yaml").write_text(strict_yaml.dump(small.model_copy(update={"duration": 2.0}).plain()))
    analyze = ["analyze", directory, "--no-figures"]
    again = ["run", tmp_path / "scene.yaml", "-o", directory, "--engine", "reference", "--overwrite"]
    assert main([str(word) for word in analyze]) == 0
    before = {path.name: path.read_bytes() for path in directory.iterdir()}
    disk.fill(but=0)
    capsys.readouterr()
    for words in (analyze, again):
        line = complaint(words, capsys)
        assert line.startswith(f"granchain: {directory}")
        assert "cannot be written (No space left on device); what was there is left as it was" in line
        assert {path.name: path.read_bytes() for path in directory.iterdir()} == before
    (disk.path / "filler").unlink()
    for words in (analyze, again):
        assert main([str(word) for word in words]) == 0
