"""Options of jobs and a site's file: what is written and said, what jobs ask their scheduler for, limits of runs."""

import re

import pytest
from bad_scenes import scene_text
from plug_ins import needs
from stock_lammps import scene

from lammps_inputs import file_names
from lammps_inputs.output import Limits
from workflow.cli import main
from workflow.plugins.jobs import job, job_files, site
from workflow.plugins.jobs.schedulers import OURS, SLURM
from workflow.plugins.jobs.site import JobOptions
from workflow.runs.files import RECORD


@pytest.fixture(autouse=True)
def no_site(monkeypatch, tmp_path):
    """No defaults of whoever runs the tests."""
    monkeypatch.delenv(site.VARIABLE, raising=False)
    monkeypatch.setenv("HOME", str(tmp_path / "home"))


ALL = {"nodes": 2, "ranks_per_node": 4, "time": "1-12:30:00", "partition": "long", "account": "grains"}
MORE = {"slurm": {"qos": "high", "constraint": "milan"}, "sge": {"parallel_environment": "orte"}}
"""Options that all schedulers have, and those of each."""


def test_jobs_ask_their_scheduler_for_what_was_asked_and_for_nothing_else(golden):
    """Slurm and Grid Engine take them in other tests; those of PBS were compared with its manual page."""
    lines = []
    for name in OURS:
        plain, full = JobOptions(scheduler=name), JobOptions(scheduler=name, array_limit=3, **ALL, **MORE.get(name, {}))
        name_of_file = plain.of_scheduler.script
        scripts = {
            "deck": job.render_job(plain, scene(beads=4).problem())[name_of_file],
            "array": job.render_array(full, ["a", "b", "c"], name="2-chains")[name_of_file],
            "one task of it": job.render_array(full, ["a", "b", "c"], tasks=[2])[name_of_file],
            "command": job.render_command(plain, "fit", ["granchain", "fit"], cores=6),
        }
        for kind, script in scripts.items():
            lines += [f"{name}, {kind}:", *re.findall(r"(?m)^(?:#SBATCH|#PBS|#\$|again=).*", script)]
    golden("requests", "\n".join(lines))


@pytest.mark.slow
def test_a_job_is_added_beside_the_same_deck_and_one_for_another_scheduler_replaces_it(tmp_path, monkeypatch, capsys):
    plain, with_job = tmp_path / "plain", tmp_path / "job"
    assert main(["deck", "two-chains", "-o", str(plain)]) == 0
    capsys.readouterr()
    assert main(["deck", "two-chains", "-o", str(with_job), "--slurm"]) == 0
    for name in (file_names.DECK, file_names.DATA, file_names.SCENE):
        assert (plain / name).read_bytes() == (with_job / name).read_bytes()
    added = {path.name for path in with_job.iterdir()} - {path.name for path in plain.iterdir()}
    assert added == {SLURM.script, job_files.INPUT, "in.continue"}
    said = capsys.readouterr().out
    assert "on 1 rank of 240 beads" in said
    assert "`sbatch job.sbatch` there submits the job; `granchain status" in said
    (tmp_path / "site.yaml").write_text("scheduler: pbs\nlmp: /opt/lmp\n")
    monkeypatch.setenv(site.VARIABLE, str(tmp_path / "site.yaml"))
    assert main(["deck", "two-chains", "-o", str(with_job), "--job", "--overwrite"]) == 0
    assert "`qsub job.pbs` there submits the job" in capsys.readouterr().out
    assert not (with_job / SLURM.script).exists()
    assert '\nlammps=(mpirun -np "$ranks" /opt/lmp ' in (with_job / "job.pbs").read_text()


def test_options_stand_in_the_script_and_win_over_the_site_that_the_environment_names(tmp_path, monkeypatch):
    (tmp_path / "site.yaml").write_text("partition: long\naccount: grains\ntime: 01:00:00\nmodules: [gcc/12]\n")
    monkeypatch.setenv(site.VARIABLE, str(tmp_path / "site.yaml"))
    words = ["--slurm", "--partition", "short", "--nodes", "2", "--ranks-per-node", "4", "--module", "gcc/13"]
    words += ["--module", "lammps", "--lmp", "/opt/my lammps/lmp", "--launcher", "mpirun -np {ranks}"]
    assert main(["deck", "two-chains", "-o", str(tmp_path / "run"), *words]) == 0
    script = (tmp_path / "run" / SLURM.script).read_text()
    asked = {word for line in re.findall("(?m)^#SBATCH --(.*)", script) for word in line.split(" --")}
    assert {"partition=short", "account=grains", "time=01:00:00", "nodes=2", "ntasks-per-node=4"} <= asked
    assert "\nlammps=(mpirun -np \"$ranks\" '/opt/my lammps/lmp' " in script
    assert "\n    module load gcc/13 lammps || " in script


@pytest.mark.slow
def test_a_deck_is_not_written_over_a_job_unless_asked_and_then_nothing_of_it_is_left(tmp_path):
    directory = tmp_path / "run"
    assert main(["deck", "two-chains", "-o", str(directory), "--slurm"]) == 0
    left = (job_files.STATE, job_files.FLAG, job_files.FRAMES, job_files.OUTPUT, "chains.dump.bin", "chains.dump.2.bin")
    for name in left:
        (directory / name).write_text("earlier")
    assert main(["deck", "two-chains", "-o", str(directory)]) == 2
    assert main(["deck", "two-chains", "-o", str(directory), "--overwrite"]) == 0
    assert {path.name for path in directory.iterdir()} == {RECORD, file_names.SCENE, file_names.DECK, file_names.DATA}


@pytest.fixture
def small_limits(monkeypatch):
    """Runs of a byte need a limit of their own."""
    monkeypatch.setattr("workflow.runs.size.MOST", Limits(gigabytes=1e-9, hours=1.0))


@pytest.mark.parametrize(
    ("of_site", "of_scene", "code"),
    [("1e-4", {}, 0), ("2e-5", {}, 2), ("1e-9", {"limits": "{gigabytes: 1e-4}"}, 0)],
    ids=["enough", "not enough", "the scene's comes first"],
)
@pytest.mark.usefixtures("lammps_here", "small_limits")
def test_a_site_sets_the_limit_where_the_scene_names_none(of_site, of_scene, code, tmp_path, monkeypatch):
    (tmp_path / "site.yaml").write_text(f"limits: {{gigabytes: {of_site}}}\n")
    monkeypatch.setenv(site.VARIABLE, str(tmp_path / "site.yaml"))
    (tmp_path / "scene.yaml").write_text(scene_text(**of_scene))
    assert main(["run", str(tmp_path / "scene.yaml"), "-o", str(tmp_path / "out"), "--no-check"]) == code


@pytest.mark.parametrize(
    ("words", "cores"),
    [
        pytest.param(["design", "design.yaml", "--jobs", "2"], 2, marks=needs("design")),
        pytest.param(["fit", "one-chain", "--against", "data.csv", "--free", "kick.velocity"], 1, marks=needs("fit")),
    ],
    ids=["design", "fit"],
)
def test_a_design_and_a_fit_are_jobs_on_one_node_that_type_the_command(words, cores, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "design.yaml").write_text("scene: two-chains\nvary: {beads: [10, 11]}\nminimize: front\n")
    (tmp_path / "data.csv").write_text("time,velocity_1_3\n0,0\n1,0.1\n2,0\n")
    options = ["-o", "out", "--slurm", "--time", "00:10:00"]
    assert main([*words, *options, "--nodes", "2"]) == 2
    assert "--nodes: 2 given" in capsys.readouterr().err
    assert main([*words, *options]) == 0
    assert "sbatch job.sbatch" in capsys.readouterr().out
    script = (tmp_path / "out" / "job.sbatch").read_text()
    assert f" --cpus-per-task={cores}\n" in script
    assert f" {words[0]} " in script
