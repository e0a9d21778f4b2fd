"""The tests do not depend on how they are started, nor on one another."""

import os
import signal
import subprocess
import sys
import warnings
from pathlib import Path

import pytest
from processes import HANGS, started

HERE = Path(__file__)


def test_ctrl_c_reaches_what_a_test_starts():
    with started(["sleep", "infinity"]) as process:
        os.killpg(process.pid, signal.SIGINT)
        assert process.wait(HANGS) == -signal.SIGINT


@pytest.mark.slow
def test_a_suite_started_with_ctrl_c_ignored_tests_ctrl_c_all_the_same():
    words = ["-q", "-p", "no:cacheprovider", "-c", HERE.parents[1] / "pyproject.toml"]
    words.append(f"{HERE}::{test_ctrl_c_reaches_what_a_test_starts.__name__}")
    # as a shell does with `pytest &`
    ignoring = f"trap '' INT; exec {sys.executable} -m pytest \"$@\""
    command = ["sh", "-c", ignoring, "sh", *map(str, words)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=HERE.parents[1])
    assert done.returncode == 0, done.stdout


@pytest.mark.slow
def test_a_test_that_hangs_fails_by_its_name_and_the_others_run(tmp_path):
    file = tmp_path / "test_hanging.py"
    file.write_text("import threading\ndef test_hangs(): threading.Event().wait()\ndef test_more(): pass\n")
    words = ["-q", "-p", "no:cacheprovider", "-c", HERE.parents[1] / "pyproject.toml", "-n", "1", "-o", "timeout=1"]
    command = [sys.executable, "-m", "pytest", *map(str, words), str(file)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=HANGS)
    assert "::test_hangs - Failed: Timeout (>1.0s)" in done.stdout
    assert "1 failed, 1 passed" in done.stdout


def test_a_test_that_fails_leaves_no_process_and_no_pipe():
    with warnings.catch_warnings():
        warnings.simplefilter("error", ResourceWarning)
        with pytest.raises(AssertionError), started(["sleep", "infinity"]) as process:
            raise AssertionError
    assert process.returncode == -signal.SIGKILL
    assert process.stdout.closed
    assert process.stderr.closed
