"""Jobs that ``--scheduler sge`` writes, under a real Grid Engine with real MPI ranks."""

import contextlib
import os
import re
import signal

import numpy as np
import pytest
from cluster import POLLED
from processes import wait_until, working_in
from stock_lammps import MPIEXEC, WHEEL, scene
from stock_lammps import run as run_stock

from lammps_inputs import file_names, strict_yaml
from workflow.cli import main
from workflow.plugins.jobs import job, job_files
from workflow.plugins.jobs.site import JobOptions
from workflow.runs.files import parts
from workflow.runs.run_directory import RunDirectory
from workflow.runs.status import cluster_queue, status, statuses

pytest_plugins = ("gridengine",)

SHORT = scene(chains=3, beads=31, kappa=0.1, duration=60.0, every=0.5)
ENDLESS = scene(chains=2, beads=60, kappa=0.1, duration=1e6, every=2.0)


@pytest.fixture
def cluster(grid_engine, monkeypatch):
    """Grid Engine, for the commands that this process starts as well; with nothing left of earlier tests."""
    for name in ("PATH", "SGE_ROOT", "SGE_CELL", "SGE_ARCH", "SGE_QMASTER_PORT", "SGE_EXECD_PORT"):
        monkeypatch.setenv(name, grid_engine.environment[name])
    yield grid_engine
    grid_engine.end()


SITE = {"scheduler": "sge", "launcher": f"{MPIEXEC} -n {{ranks}}", "lmp": str(WHEEL), "checkpoint": 2}


def site_file(directory, **options):
    """File of a site that has Grid Engine."""
    path = directory / "site.yaml"
    path.write_text(strict_yaml.dump({**SITE, **options}))
    return str(path)


def written(case, directory, **options):
    """The deck and job of a scene, by the command line; options as in a site's file."""
    scene_file, site = directory.with_suffix(".yaml"), site_file(directory.parent, **options)
    scene_file.write_text(strict_yaml.dump(case.plain()))
    assert main(["deck", str(scene_file), "-o", str(directory), "--job", "--site", site]) == 0
    return directory


def state_of(directory):
    return status(directory, cluster_queue())


def assert_same(directory, expected):
    resumed = RunDirectory(directory).trajectory
    np.testing.assert_array_equal(resumed.displacement, expected.displacement)
    np.testing.assert_array_equal(resumed.velocity, expected.velocity)


@pytest.mark.slow
def test_a_job_of_two_ranks_waits_runs_and_ends_bit_for_bit_as_a_run_on_this_machine(cluster, tmp_path):
    directory = written(SHORT, tmp_path / "50%j of a\\b $JOB_ID", ranks_per_node=2)
    assert state_of(directory).state == "written"
    assert state_of(directory).why == "`qsub job.sge` there starts it"
    number = cluster.submit(directory, "-h")
    assert (state_of(directory).state, state_of(directory).why) == ("waiting", f"job {number}")
    cluster.call("qrls", number)
    cluster.wait()
    assert state_of(directory).state == "done", (directory / job_files.OUTPUT).read_text()
    assert "  2 by 1 by 1 MPI processor grid" in (directory / file_names.LOG).read_text()
    assert_same(directory, run_stock(SHORT, tmp_path / "local"))


@pytest.mark.slow
def test_in_an_array_a_case_that_fails_is_told_and_a_task_near_its_time_limit_submits_itself_alone(
    cluster, tmp_path, capsys
):
    sweep = {"scene": {**SHORT.plain(), "timestep": 0.01}, "vary": {"beads": [12, 13, 31]}}
    path, directory = tmp_path / "sweep.yaml", tmp_path / "s"
    path.write_text(strict_yaml.dump(sweep))
    site = site_file(tmp_path, array_limit=2, time="00:01:00", margin=55)
    assert main(["sweep", str(path), "-o", str(directory), "--job", "--site", site]) == 0
    assert "`qsub job.sge` there submits one array" in capsys.readouterr().out
    (directory / "beads=13" / file_names.DATA).write_text("12 atoms\n")
    # the task computes no more than one stretch until its timer ends
    stopped = directory / "beads=31"
    path, pause = stopped / job_files.INPUT, stopped / "pause"
    text = path.read_text().replace("label stretch", f"shell sh {pause.name}\n\nlabel stretch")
    path.write_text(re.sub("(?m)^(variable look equal) .*", r"\1 1000", text))
    pause.write_text(f"[ -f {file_names.RESTART} ] || until grep stop {job_files.FLAG}; do sleep 0.1; done\n")
    number = cluster.submit(directory, "-h")
    waiting = statuses([directory], cluster_queue())
    assert [(each.state, each.why) for each in waiting] == [("waiting", f"job {number}.{task}") for task in (1, 2, 3)]
    cluster.call("qrls", number)
    assert wait_until(lambda: state_of(stopped).why.startswith(f"job {int(number) + 1}."), every=POLLED)
    cluster.call("qalter", "-a", "01010000", int(number) + 1)  # begins when its job has surely ended: now
    cluster.wait()
    assert [each.state for each in statuses([directory], cluster_queue())] == ["done", "failed", "done"]
    assert len(parts(stopped)) == 2
    assert_same(stopped, run_stock(RunDirectory(stopped).scene, tmp_path / "whole"))


@pytest.mark.slow
def test_a_job_that_was_killed_is_incomplete_and_resumes_when_submitted_again(cluster, tmp_path):
    directory = written(ENDLESS, tmp_path / "job", ranks_per_node=1)
    number = cluster.submit(directory)
    assert wait_until((directory / file_names.RESTART).exists), (directory / job_files.OUTPUT).read_text()
    assert (state_of(directory).state, state_of(directory).why) == ("running", f"job {number}")
    cluster.submit(directory)
    assert wait_until(lambda: "computes here" in (directory / job_files.OUTPUT).read_text())
    for process in working_in(directory):
        with contextlib.suppress(ProcessLookupError):  # ends with the others
            os.kill(process, signal.SIGKILL)
    cluster.wait()
    killed = state_of(directory)
    assert killed.state == "incomplete"
    assert killed.why.startswith(
        f"job {number} is gone: killed, or its node lost; `qsub job.sge` there resumes at step "
    )
    cluster.submit(directory)
    assert wait_until((directory / "chains.dump.2.bin").exists), (directory / job_files.OUTPUT).read_text()


@pytest.mark.slow
def test_a_command_that_is_stopped_near_its_time_limit_is_submitted_again_and_resumes(cluster, tmp_path):
    """The command is one that does not end by itself the first time."""
    script = "[ -f done ] && echo again && exit; trap 'kill $!; touch done; exit 130' TERM; sleep infinity & wait"
    options = JobOptions(scheduler="sge", time="00:01:00", margin=57)
    (tmp_path / "job.sge").write_text(job.render_command(options, "stopped", ["bash", "-c", script], cores=2))
    cluster.submit(tmp_path)
    cluster.wait()
    assert "again" in (tmp_path / job_files.OUTPUT).read_text()
