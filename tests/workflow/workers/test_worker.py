"""Processes of the worker pool: none outlives, or works after, the process that started it."""

import json
import os
import subprocess
import sys

import pytest

from workflow.workers.pool import Task


@pytest.mark.slow
@pytest.mark.parametrize(("starter", "works"), [(os.getpid, True), (os.getppid, False)], ids=["alive", "ended"])
def test_a_worker_process_does_its_task_only_if_the_process_that_started_it_is_still_there(starter, works, tmp_path):
    task = Task("os:mkdir", {"path": str(tmp_path / "made")})
    command = [sys.executable, "-P", "-m", "workflow.workers.worker", str(starter())]
    done = subprocess.run(command, input=json.dumps(task._asdict()) + "\n", capture_output=True, text=True, check=False)
    assert (tmp_path / "made").exists() == works
    assert (done.returncode, done.stdout) == ((0, '{"value": null}\n') if works else (1, ""))
