"""Runs that are killed or interrupted at any moment: what they computed is kept and reads, and is called incomplete."""

import contextlib
import json
import os
import signal
import subprocess
import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from processes import HANGS, started, wait_until, working_in
from stock_lammps import scene
from sweeps import GRANCHAIN

from analysis.files.binary_dump import CutDumpWarning
from lammps_inputs import strict_yaml
from workflow.cli import main
from workflow.engines.lammps import mpi
from workflow.runs.run import run
from workflow.runs.run_directory import RunDirectory

LONG = scene(chains=2, beads=120, kappa=0.1, duration=1e5, every=1.0)
"""Three quarters of a minute in LAMMPS."""

TWO = pytest.mark.skipif(mpi.cores() < 2, reason="needs two cores")


@dataclass
class Command:
    """``granchain run`` in a session of its own, as from a terminal."""

    process: subprocess.Popen
    run: Path

    def reach(self, file, size):
        """Wait until a file of the run has a size."""
        path = self.run / file
        assert wait_until(lambda: path.exists() and path.stat().st_size >= size, self.process)

    def end(self, number):
        """Send a signal to all that a terminal would send it to, and return code, output and complaints.

        SIGTERM goes to the command alone, as from a batch system.
        """
        (os.kill if number == signal.SIGTERM else os.killpg)(self.process.pid, number)
        out, err = self.process.communicate(timeout=HANGS)
        return self.process.returncode, out, err

    def nothing_is_left(self):
        return wait_until(lambda: not working_in(self.run))


@pytest.fixture
def start(tmp_path):
    """Starts a command that does not outlive the test."""
    (tmp_path / "long.yaml").write_text(strict_yaml.dump(LONG.plain()))
    with contextlib.ExitStack() as stack:

        def starting(ranks=1):
            words = [GRANCHAIN, "run", tmp_path / "long.yaml", "-o", tmp_path / "run", "--ranks", ranks]
            return Command(stack.enter_context(started(words)), tmp_path / "run")

        yield starting


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The first hundred frames of the same run, not interrupted."""
    short = LONG.model_copy(update={"duration": 100.0})
    return run(short, tmp_path_factory.mktemp("whole"), check=False).trajectory


def assert_frames_are_those_of(whole, directory):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", CutDumpWarning)  # the last frame may be cut
        found = RunDirectory(directory).trajectory
    count = min(found.frames, whole.frames)
    assert count > 0
    np.testing.assert_array_equal(found.velocity[:count], whole.velocity[:count])
    np.testing.assert_array_equal(found.displacement[:count], whole.displacement[:count])


def frames_of_incomplete_analysis(directory, capsys):
    assert main(["analyze", str(directory), "--no-figures"]) == 0
    report = json.loads((directory / "analysis.json").read_text())
    found, wanted = report["frames"]
    assert report["complete"] is False
    assert wanted == 100001
    assert f"incomplete: {found} of 100001 frames" in capsys.readouterr().out
    return found


# --- SIGKILL ----------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_what_a_killed_run_had_dumped_reads_and_analyses_as_incomplete(start, whole, capsys):
    command = start()
    command.reach("chains.dump.bin", 200_000)
    assert command.end(signal.SIGKILL)[0] == -signal.SIGKILL
    assert command.nothing_is_left()
    assert_frames_are_those_of(whole, command.run)
    assert frames_of_incomplete_analysis(command.run, capsys) > 0
    assert RunDirectory(command.run).job.outcome == "running"


@pytest.mark.slow
@pytest.mark.parametrize("file", ["scene.yaml", "run.json"])
def test_a_run_killed_at_its_beginning_leaves_a_directory_that_says_what_it_lacks(file, start, capsys):
    command = start()
    command.reach(file, 1)
    command.end(signal.SIGKILL)
    assert command.nothing_is_left()
    code = main(["analyze", str(command.run), "--no-figures"])
    out, err = capsys.readouterr()
    if (command.run / "chains.dump.bin").exists():  # LAMMPS was faster than the signal
        assert code == 0
        assert "\nthe run is incomplete: " in out  # after the units
    else:
        assert code == 2
        assert err == f"granchain: {command.run}: holds no chains.dump.bin; run the deck first\n"


def test_a_frame_cut_in_two_is_left_out(tmp_path, capsys):
    result = run(LONG.model_copy(update={"duration": 20.0}), tmp_path, check=False)
    os.truncate(result.directory.dump, result.directory.dump.stat().st_size - 1000)
    assert main(["analyze", str(tmp_path), "--no-figures"]) == 0
    assert "incomplete: 20 of 21 frames, to t = 19;" in capsys.readouterr().out


# --- Ctrl-C -----------------------------------------------------------------------------------------------------------

FURTHER = (signal.SIGQUIT, signal.SIGTERM, signal.SIGHUP, signal.SIGINT)


@pytest.mark.parametrize(
    ("size", "ranks", "number", "before"),
    [
        (1, 1, signal.SIGTERM, ()),
        pytest.param(100_000, 2, signal.SIGINT, (signal.SIGINT, *FURTHER * 5), marks=[TWO, pytest.mark.slow]),
    ],
)
def test_ctrl_c_or_sigterm_ends_a_run_with_one_line_and_its_frames_and_further_signals_change_nothing(
    size, ranks, number, before, start, whole, capsys
):
    command = start(ranks)
    command.reach("chains.dump.bin", size)
    for other in before:
        os.killpg(command.process.pid, other)
    code, out, err = command.end(number)
    record = RunDirectory(command.run).job.plain()
    assert (code, err) == (130, "")
    units, size, said = out.splitlines(keepends=True)
    assert "in reduced units: V = 1 (kick velocity)" in units
    assert "the run has 10,000,000 steps and 100,001 frames (591 MB) in an estimated time of" in size
    assert said == (
        f"the run was interrupted at step {record['steps_done']} of 10000000; its frames remain; "
        f"`granchain run --resume {command.run}` resumes at step {record['steps_done']}\n"
    )
    assert command.nothing_is_left()
    assert record["outcome"] == "interrupted"
    assert_frames_are_those_of(whole, command.run)
    assert frames_of_incomplete_analysis(command.run, capsys) == record["steps_done"] // 100 + 1


def test_ctrl_c_before_anything_is_written_is_one_line(tmp_path):
    slow = tmp_path / "slow.yaml"
    os.mkfifo(slow)  # a scene that is being read until somebody writes it
    command = [GRANCHAIN, "run", slow, "-o", tmp_path / "run"]
    with started(command) as process, slow.open("w"):  # waits for the reader
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=HANGS)
    assert (process.returncode, out, err) == (130, "", "granchain: interrupted\n")
    assert not (tmp_path / "run").exists()
