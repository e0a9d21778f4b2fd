"""``granchain deck --slurm``: what it writes and says, and what it refuses."""

import re

import pytest

from lammps_inputs import file_names
from workflow.cli import main
from workflow.plugins.jobs import job_files, site
from workflow.plugins.jobs.schedulers import SLURM
from workflow.runs.files import RECORD


@pytest.fixture(autouse=True)
def no_site(monkeypatch, tmp_path):
    """No defaults of whoever runs the tests."""
    monkeypatch.delenv(site.VARIABLE, raising=False)
    monkeypatch.setenv("HOME", str(tmp_path / "home"))


def asked(script):
    return [word for line in re.findall("(?m)^#SBATCH --(.*)", script) for word in line.split(" --")]


def test_a_job_is_added_and_the_deck_is_byte_for_byte_the_one_without(tmp_path, capsys):
    plain, with_job = tmp_path / "plain", tmp_path / "job"
    assert main(["deck", "two-chains", "-o", str(plain)]) == 0
    assert main(["deck", "two-chains", "-o", str(with_job), "--slurm"]) == 0
    for name in (file_names.DECK, file_names.DATA, file_names.SCENE):
        assert (plain / name).read_bytes() == (with_job / name).read_bytes()
    assert {path.name for path in with_job.iterdir()} - {path.name for path in plain.iterdir()} == {
        *(SLURM.script, job_files.INPUT, "in.continue"),
    }
    said = capsys.readouterr().out
    assert "on 1 rank of 240 beads" in said
    assert "`sbatch job.sbatch` there submits the job; `granchain status" in said


def test_options_stand_in_the_script_and_win_over_the_site_that_the_environment_names(tmp_path, monkeypatch):
    sites = tmp_path / "site.yaml"
    sites.write_text("partition: long\naccount: grains\ntime: 01:00:00\nmodules: [gcc/12]\n")
    monkeypatch.setenv(site.VARIABLE, str(sites))
    assert main(["deck", "two-chains", "-o", str(tmp_path / "site"), "--slurm"]) == 0
    assert "\n    module load gcc/12 || " in (tmp_path / "site" / SLURM.script).read_text()
    words = ["--slurm", "--partition", "short", "--nodes", "2", "--ranks-per-node", "4"]
    words += ["--module", "gcc/13", "--module", "lammps", "--lmp", "/opt/my lammps/lmp"]
    words += ["--launcher", "mpirun -np {ranks}"]
    assert main(["deck", "two-chains", "-o", str(tmp_path / "run"), *words]) == 0
    script = (tmp_path / "run" / SLURM.script).read_text()
    assert {"partition=short", "account=grains", "time=01:00:00", "nodes=2", "ntasks-per-node=4"} <= set(asked(script))
    assert "\nlammps=(mpirun -np \"$ranks\" '/opt/my lammps/lmp' " in script
    assert "\n    module load gcc/13 lammps || " in script
    assert f"\nmax_jobs={site.JobOptions().max_jobs} " in script


def test_a_deck_is_not_written_over_a_job_unless_asked_and_then_nothing_of_it_is_left(tmp_path):
    directory = tmp_path / "run"
    assert main(["deck", "two-chains", "-o", str(directory), "--slurm"]) == 0
    for name in (
        job_files.STATE,
        job_files.FLAG,
        job_files.FRAMES,
        job_files.OUTPUT,
        "chains.dump.bin",
        "chains.dump.2.bin",
    ):
        (directory / name).write_text("earlier")
    assert main(["deck", "two-chains", "-o", str(directory)]) == 2
    assert main(["deck", "two-chains", "-o", str(directory), "--overwrite"]) == 0
    assert {path.name for path in directory.iterdir()} == {RECORD, file_names.SCENE, file_names.DECK, file_names.DATA}
