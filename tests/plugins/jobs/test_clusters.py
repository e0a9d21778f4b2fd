"""Jobs that ``granchain deck --job`` writes, under a real Slurm and a real Grid Engine, with real MPI ranks."""

import contextlib
import os
import signal

import numpy as np
import pytest
from cluster import POLLED, stop_after_a_stretch
from processes import wait_until, working_in
from stock_lammps import MPIEXEC, WHEEL, scene
from stock_lammps import run as run_stock

from lammps_inputs import file_names, library, strict_yaml
from workflow.cli import main
from workflow.plugins.jobs import job, job_files
from workflow.plugins.jobs.registry import SCHEDULERS
from workflow.plugins.jobs.site import JobOptions
from workflow.runs.files import parts
from workflow.runs.run_directory import RunDirectory
from workflow.runs.status import cluster_queue, status, statuses

pytest_plugins = ("slurm", "gridengine")
pytestmark = pytest.mark.slow

LAUNCHERS = {"slurm": "srun --mpi=pmi2", "sge": f"{MPIEXEC} -n {{ranks}}"}
HELD = {"slurm": ("--hold", "scontrol release"), "sge": ("-h", "qrls")}
"""Option that holds a job when it is submitted, and the command that releases it."""

SHORT = scene(chains=3, beads=31, kappa=0.1, duration=60.0, every=0.5)
ENDLESS = scene(chains=2, beads=60, kappa=0.1, duration=1e6, every=2.0)
DIVERSE = {
    **{"name": "test", "chains": 3, "beads": 20, "duration": 1000.0, "timestep": 0.005, "output": {"every": 1.25}},
    "kinds": {"heavy": {"mass": 1}, "light": {"mass": 0.5, "stiffness": 2.0}},  # LAMMPS's style `granular`
    "pattern": ["heavy", "light"],
    "coupling": {"stiffness": 0.1, "cubic": 0.02, "topology": "ring"},
    "damping": {"contact": 0.002, "beads": 1e-4},
    "kick": {"velocity": 1.0},
}

each = pytest.mark.parametrize("name", LAUNCHERS)


@pytest.fixture
def name():
    """Scheduler of tests that are about one alone."""
    return "slurm"


@pytest.fixture
def cluster(name, request, monkeypatch):
    """The scheduler, for the commands that this process starts as well; with nothing left of earlier tests."""
    running = request.getfixturevalue({"slurm": "slurm", "sge": "grid_engine"}[name])
    for variable, value in running.environment.items():
        if variable == "PATH" or variable.startswith(("SGE_", "SLURM_")):
            monkeypatch.setenv(variable, value)
    yield running
    running.end()


def site_file(name, path, **options):
    """A site's file."""
    path.write_text(
        strict_yaml.dump(
            {"scheduler": name, "launcher": LAUNCHERS[name], "lmp": str(WHEEL), "checkpoint": 2, **options}
        )
    )
    return str(path)


def written(name, case, directory, **options):
    """The deck and job of a scene, by the command line; options as in a site's file."""
    scene_file, site = directory.with_suffix(".yaml"), directory.with_suffix(".site.yaml")
    scene_file.write_text(strict_yaml.dump(case.plain()))
    words = ["deck", str(scene_file), "-o", str(directory), "--job", "--site", site_file(name, site, **options)]
    assert main(words) == 0
    return directory


def told(directory):
    return status(directory, cluster_queue())


def assert_same(directory, expected):
    found = RunDirectory(directory).trajectory
    np.testing.assert_array_equal(found.displacement, expected.displacement)
    np.testing.assert_array_equal(found.velocity, expected.velocity)


@each
def test_a_job_of_two_ranks_in_a_directory_whose_name_means_something_ends_bit_for_bit(name, cluster, tmp_path, capsys):
    directory = written(name, SHORT, tmp_path / "50%j of a\\b %x $JOB_ID", ranks_per_node=2)
    assert told(directory).state == "written"
    assert told(directory).why == f"`{SCHEDULERS[name].submit} {SCHEDULERS[name].script}` there starts it"
    hold, release = HELD[name]
    number = cluster.submit(directory, hold)
    assert (told(directory).state, told(directory).why) == ("waiting", f"job {number}")
    cluster.call(*release.split(), number)
    cluster.wait()
    assert told(directory).state == "done", (directory / job_files.OUTPUT).read_text()
    assert "  2 by 1 by 1 MPI processor grid" in (directory / file_names.LOG).read_text()
    assert_same(directory, run_stock(SHORT, tmp_path / "local"))
    assert main(["status", str(directory)]) == 0
    assert f"{directory}: done, 6000 steps" in capsys.readouterr().out


def test_a_job_cut_by_its_time_limit_submits_itself_and_ends_bit_for_bit_as_one_that_was_not(cluster, tmp_path):
    case = library.from_plain(DIVERSE, "test")
    directory = written("slurm", case, tmp_path / "job", ranks_per_node=1, time="00:01:00", margin=50)
    stop_after_a_stretch(directory)
    cluster.submit(directory)
    cluster.wait()
    assert told(directory).state == "done", (directory / job_files.OUTPUT).read_text()
    assert len(parts(directory)) > 1
    assert_same(directory, run_stock(case, tmp_path / "whole"))


@pytest.mark.parametrize("name", ["sge"])
def test_in_an_array_a_case_that_fails_is_told_and_a_task_near_its_time_limit_submits_itself_alone(
    name, cluster, tmp_path
):
    path, directory = tmp_path / "sweep.yaml", tmp_path / "s"
    path.write_text(strict_yaml.dump({"scene": SHORT.plain(), "vary": {"beads": [12, 13, 31]}}))
    site = site_file(name, tmp_path / "site.yaml", array_limit=2, time="00:01:00", margin=55)
    assert main(["sweep", str(path), "-o", str(directory), "--job", "--site", site]) == 0
    (directory / "beads=13" / file_names.DATA).write_text("12 atoms\n")
    stopped = directory / "beads=31"
    stop_after_a_stretch(stopped)
    number = cluster.submit(directory, "-h")
    waiting = statuses([directory], cluster_queue())
    assert [(each.state, each.why) for each in waiting] == [("waiting", f"job {number}.{task}") for task in (1, 2, 3)]
    cluster.call("qrls", number)
    assert wait_until(lambda: told(stopped).why.startswith(f"job {int(number) + 1}."), every=POLLED)
    cluster.call("qalter", "-a", "01010000", int(number) + 1)  # begins when its job has surely ended: now
    cluster.wait()
    assert [each.state for each in statuses([directory], cluster_queue())] == ["done", "failed", "done"]
    assert len(parts(stopped)) == 2
    assert_same(stopped, run_stock(RunDirectory(stopped).scene, tmp_path / "whole"))


@each
def test_a_job_that_was_killed_is_incomplete_and_resumes_when_submitted_again(name, cluster, tmp_path):
    directory = written(name, ENDLESS, tmp_path / "job", ranks_per_node=1)
    number, output = cluster.submit(directory), directory / job_files.OUTPUT
    assert wait_until((directory / file_names.RESTART).exists), output.read_text()
    found = told(directory)
    assert (found.state, found.steps, found.why) == ("running", 10**8, f"job {number}")
    cluster.submit(directory)
    assert wait_until(lambda: "computes here" in output.read_text(), every=POLLED)
    for process in working_in(directory):
        with contextlib.suppress(ProcessLookupError):  # ends with the others
            os.kill(process, signal.SIGKILL)
    cluster.wait()
    killed = told(directory)
    assert killed.state == "incomplete"
    assert killed.why.startswith(f"job {number} is gone: killed, or its node lost; ")
    assert f"{SCHEDULERS[name].script}` there resumes at step " in killed.why
    assert killed.step > 0
    cluster.submit(directory)
    assert wait_until((directory / "chains.dump.2.bin").exists), output.read_text()
    assert wait_until(lambda: told(directory).step > killed.step, every=POLLED)
    cluster.end()
    time = RunDirectory(directory).trajectory.time
    steps = np.rint(time / ENDLESS.problem().timestep).astype(int)
    assert (np.diff(steps) == ENDLESS.problem().steps_per_frame).all()


@each
def test_a_command_that_is_stopped_near_its_time_limit_is_submitted_again_and_resumes(name, cluster, tmp_path):
    """The command is one that does not end by itself the first time."""
    script = "[ -f done ] && echo again && exit; trap 'kill $!; touch done; exit 130' TERM; touch up; "
    words = ["bash", "-c", script + "sleep infinity & wait"]
    options = JobOptions(scheduler=name, time="00:01:00", margin=57)
    (tmp_path / SCHEDULERS[name].script).write_text(job.render_command(options, "stopped", words, cores=2))
    number = cluster.submit(tmp_path)
    if name == "slurm":  # its own signal may come a minute late
        assert wait_until((tmp_path / "up").is_file)
        cluster.call("scancel", "--batch", "--signal=TERM", number)
    cluster.wait()
    assert "again" in (tmp_path / job_files.OUTPUT).read_text()
