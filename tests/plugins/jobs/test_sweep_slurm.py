"""A sweep written for a cluster, and what a real Slurm makes of it."""

import numpy as np
import pytest
from refusals import refusal
from stock_lammps import WHEEL
from sweeps import SMALL, sweep, sweep_file

from lammps_inputs import library
from workflow.cli import main
from workflow.plugins.jobs.schedulers import slurm_jobs
from workflow.plugins.jobs.states import queue_of
from workflow.runs.run import run
from workflow.runs.run_directory import RunDirectory
from workflow.runs.status import statuses

pytest_plugins = ("slurm",)
pytestmark = pytest.mark.usefixtures("lammps_here", "pool_here")


@pytest.mark.slow
def test_a_sweep_is_an_array_with_a_deck_per_case_in_which_added_cases_come_last_and_done_ones_are_left_out(tmp_path):
    assert sweep(sweep_file(tmp_path, beads=[12]), tmp_path / "s") == 0
    for beads in ([12, 13], [10, 12, 13]):
        path = sweep_file(tmp_path, beads=beads)
        assert main(["sweep", str(path), "-o", str(tmp_path / "s"), "--slurm"]) == 0
    assert (tmp_path / "s" / "cases.txt").read_text() == "beads=12\nbeads=13\nbeads=10\n"
    assert " --array=1-2\n" in (tmp_path / "s" / "job.sbatch").read_text()
    for name in ("beads=10", "beads=13"):
        files = {path.name for path in (tmp_path / "s" / name).iterdir()}
        assert files == {"run.json", "scene.yaml", "in.chains", "data.chains", "in.job", "in.continue"}


@pytest.mark.slow
def test_tasks_of_several_cases_are_lines_of_the_list(tmp_path):
    for beads, task in ([10, 11, 12, 13, 14], "0-2"), ([9], "3"):
        path = sweep_file(tmp_path, beads=beads)
        words = ["sweep", str(path), "-o", str(tmp_path / "s"), "--slurm", "--cases-per-task", "2"]
        assert main(words) == 0
        assert f" --array={task}\n" in (tmp_path / "s" / "job.sbatch").read_text()
    lines = (tmp_path / "s" / "cases.txt").read_text().splitlines()
    assert lines == ["beads=10 beads=11", "beads=12 beads=13", "beads=14", "beads=9"]
    known = queue_of("c", slurm_jobs(f"7|PD|1|{tmp_path / 's'}"))
    assert [job.directory.name for job in known.jobs] == ["beads=12", "beads=13"]
    assert [one.directory.name for one in statuses([tmp_path / "s"], known)] == " ".join(lines).split()


def test_more_ranks_than_a_case_has_rows_are_one_line(tmp_path, capsys):
    words = ["sweep", sweep_file(tmp_path, beads=[12]), "-o", tmp_path / "s", "--slurm", "--ranks-per-node", "13"]
    assert "ranks divide the 12 rows" in refusal(words, capsys)
    assert not (tmp_path / "s").exists()


@pytest.mark.slow
def test_an_array_does_the_cases_and_they_come_back_bit_for_bit(slurm, tmp_path, monkeypatch, capsys):
    for name, value in slurm.environment.items():
        monkeypatch.setenv(name, value)
    path = sweep_file(tmp_path, coupling__stiffness=[0.1, 0.2, 0.3])
    command = ["sweep", str(path), "-o", str(tmp_path / "s"), "--slurm", "--time", "00:10:00", "--lmp", str(WHEEL)]
    assert main(command) == 0
    broken = tmp_path / "s" / "coupling.stiffness=0.3"
    whole = (broken / "in.chains").read_text()
    (broken / "in.chains").write_text(whole.replace("fix motion all nve", "fix motion all nonsense"))
    slurm.submit(tmp_path / "s", "--hold")
    assert main(["sweep", str(path), "-o", str(tmp_path / "s")]) == 2
    assert "is waiting (job " in capsys.readouterr().err
    added = sweep_file(tmp_path, coupling__stiffness=[0.1, 0.4])
    assert main(["sweep", str(added), *command[2:]]) == 2
    assert "cases are added to an array's list when it has ended" in capsys.readouterr().err
    slurm.call("scontrol", "release", slurm.queue()[0].partition("_")[0])
    slurm.wait()
    assert main(["collect", str(tmp_path / "s")]) == 0
    assert "3 cases: 2 done, 1 failed" in capsys.readouterr().out
    (broken / "in.chains").write_text(whole)
    path = sweep_file(tmp_path, coupling__stiffness=[0.1, 0.2, 0.3])
    assert main(command) == 0
    assert " --array=2\n" in (tmp_path / "s" / "job.sbatch").read_text()
    slurm.submit(tmp_path / "s")
    slurm.wait()
    assert sweep(path, tmp_path / "s") == 0  # analyses what came back, and computes nothing
    assert "3 of 3 cases done (2 of them before)" in capsys.readouterr().out
    alone = run(library.from_plain({**SMALL, "coupling": {"stiffness": 0.3}}, ""), tmp_path / "alone", check=False)
    np.testing.assert_array_equal(RunDirectory(broken).trajectory.velocity, alone.trajectory.velocity)
