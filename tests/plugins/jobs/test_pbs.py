"""Jobs of PBS Professional in a shell that stands for it, as there is no PBS that could be installed."""

import json
import os
import re
import signal
import subprocess

import numpy as np
import pytest
from cluster import stop_after_a_stretch
from processes import HANGS, wait_until
from stock_lammps import MPIEXEC, WHEEL, scene
from stock_lammps import run as run_stock

from lammps_inputs import file_names
from lammps_inputs.decks import scene_files
from workflow.plugins.jobs import job, job_files, schedulers
from workflow.plugins.jobs.registry import SCHEDULERS
from workflow.plugins.jobs.schedulers import ListedJob
from workflow.plugins.jobs.site import JobOptions
from workflow.runs.files import parts
from workflow.runs.run_directory import RunDirectory

CASE = scene(chains=2, beads=31, kappa=0.1, duration=60.0, every=0.5)
OPTIONS = JobOptions(scheduler="pbs", lmp=str(WHEEL), launcher=f"{MPIEXEC} -n {{ranks}}", time="00:01:00", margin=58)


class Shell:
    """A shell in the environment that PBS gives a job, with a qsub that only records its arguments."""

    def __init__(self, directory):
        self.directory, self.programs = directory, directory / "programs"
        self.programs.mkdir(parents=True)
        self.submitted = self.programs / "submitted"
        (self.programs / "nodes").write_text("localhost\n")
        (self.programs / "qsub").write_text(f'#!/bin/sh\necho "$@" >{self.submitted}; echo 18.master.site\n')
        (self.programs / "qsub").chmod(0o755)
        scene_files.write(CASE, directory)
        for name, text in job.render_job(OPTIONS, CASE.problem()).items():
            (directory / name).write_text(text)
        stop_after_a_stretch(directory)

    def environment(self, number):
        return {
            **os.environ,
            "PBS_JOBID": f"{number}.master.site",
            "PBS_NODEFILE": str(self.programs / "nodes"),
            "PBS_O_WORKDIR": str(self.directory),
            "PATH": f"{self.programs}:{os.environ['PATH']}",
        }

    def run(self, number=17, **variables):
        """Run the job's script to its end, as text that the shell reads, which is how PBS gives it to a shell."""
        environment = {**self.environment(number), **variables}
        with (self.directory / "job.pbs").open() as script:
            subprocess.run(["bash"], cwd="/", env=environment, stdin=script, timeout=HANGS, start_new_session=True)

    def state(self):
        """State, job and cluster that the job left."""
        line = (self.directory / job_files.STATE).read_text()
        return re.match(r"(\w+) job=(\S*) cluster=(\S*) ", line).groups()


@pytest.mark.slow
def test_a_job_near_its_limit_submits_the_next_which_ends_bit_for_bit_as_one_that_was_not(tmp_path):
    shell = Shell(tmp_path / "job")
    shell.run()
    assert shell.state() == ("waiting", "18", "master")
    assert shell.submitted.read_text() == "-W depend=afterany:17.master.site -v granchain_job=2 job.pbs\n"
    shell.run(18, granchain_job="2")
    assert shell.state() == ("done", "18", "master")
    assert len(parts(shell.directory)) == 2
    resumed, whole = RunDirectory(shell.directory).trajectory, run_stock(CASE, tmp_path / "whole")
    np.testing.assert_array_equal(resumed.displacement, whole.displacement)
    np.testing.assert_array_equal(resumed.velocity, whole.velocity)


@pytest.mark.slow
def test_a_job_of_pbs_that_is_deleted_says_so(tmp_path):
    """PBS sends SIGTERM to all processes of a job that is deleted or out of time."""
    shell = Shell(tmp_path / "job")
    words = ["bash", "-c", (shell.directory / "job.pbs").read_text().replace("timeout 2 ", "timeout 1000 ")]
    with subprocess.Popen(words, cwd="/", env=shell.environment(17), start_new_session=True) as process:
        assert wait_until(lambda: (shell.directory / file_names.DUMP).exists(), process)
        os.killpg(process.pid, signal.SIGTERM)
        process.wait(HANGS)
    assert shell.state()[0] == "incomplete"
    assert "cancelled, or stopped at its time limit" in (shell.directory / job_files.STATE).read_text()
    assert not shell.submitted.exists()


# --- what a queue lists -----------------------------------------------------------------------------------------------


def test_the_queue_of_pbs_is_read_with_tasks_by_their_number_and_without_jobs_that_have_ended():
    def listed(state, directory):
        return {"Job_Name": "x", "job_state": state, "Variable_List": {"PBS_O_HOME": "/h", "PBS_O_WORKDIR": directory}}

    jobs = {
        "16[].master.site": {**listed("B", "/a"), "array": "True"},
        "16[1].master.site": listed("X", "/a"),
        "16[2].master.site": listed("R", "/a"),
        "16[3].master.site": listed("Q", "/a"),
        "17.master.site": listed("H", "/b"),
        "18.master.site": listed("E", "/c"),
    }
    text = json.dumps({"timestamp": 1, "pbs_version": "23", "pbs_server": "master.site", "Jobs": jobs})
    assert schedulers.pbs_jobs(text) == (
        "master",
        [
            ListedJob("16.2", False, 1, "/a"),
            ListedJob("16.3", True, 2, "/a"),
            ListedJob("17", True, None, "/b"),
            ListedJob("18", False, None, "/c"),
        ],
    )
    for broken in ("", "{", '{"Jobs": []}', "[]"):
        assert schedulers.PBS.queue(lambda *_, text=broken: text) is None
    assert schedulers.pbs_jobs('{"pbs_server": "master"}') == ("master", [])


def test_where_no_scheduler_answers_there_is_no_queue():
    assert all(scheduler.queue(lambda *_: None) is None for scheduler in SCHEDULERS.values())
