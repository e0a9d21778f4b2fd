"""Job scripts: what they do where there is no Slurm to submit to, and what hostile text does to them."""

import contextlib
import os
import re
import shlex
import shutil
import signal
import subprocess
from datetime import datetime

import numpy as np
import pytest
from cluster import stop_after_a_stretch
from hypothesis import given
from hypothesis import strategies as st
from processes import HANGS, wait_until, working_in
from stock_lammps import MPIEXEC, WHEEL, scene

from analysis.files.recording import blocks
from analysis.trajectory import joined
from lammps_inputs import InputError, Output, file_names, library
from lammps_inputs.decks import scene_files
from workflow.engines.lammps.files_on_disk import step_of
from workflow.plugins.jobs import job, job_files, site
from workflow.plugins.jobs.schedulers import SLURM
from workflow.plugins.jobs.site import JobOptions
from workflow.runs.files import parts

HOSTILE = (
    "x\n#SBATCH --uid=root",
    "$(touch pwned)",
    "`touch pwned`",
    "x' 'touch pwned",
    'x" "touch pwned',
    "x; touch pwned | touch pwned && touch pwned",
    "../../etc",
    "--wrap=touch",
    "\x1b[31mred",
    "x\u2028y",
    "",
    "a" * 10_000,
)

LAUNCHER = f"{MPIEXEC} -n {{ranks}}"


@pytest.fixture(autouse=True)
def short_stretches(monkeypatch):
    """Jobs look at their flag often, so that tests need not wait."""
    monkeypatch.setattr(job, "STRETCH", 0.1)


def placed(case, directory, **options):
    """The deck and job of a scene in a new directory."""
    directory.mkdir()
    scene_files.write(case, directory)
    chosen = JobOptions(**{"lmp": str(WHEEL), "launcher": LAUNCHER, "checkpoint": 2, **options})
    for name, text in job.render_job(chosen, case.problem()).items():
        (directory / name).write_text(text)
    return directory


@contextlib.contextmanager
def job_of(directory, **environment):
    """The script in the environment that Slurm gives it, with its output where Slurm puts it."""
    head = (directory / SLURM.script).read_text()
    nodes, ranks = (re.search(rf"^#SBATCH .*--{name}=(\d+)", head, flags=re.MULTILINE)[1] for name in REQUESTS)
    variables = {"SLURM_JOB_ID": 1, "SLURM_JOB_NUM_NODES": nodes, "SLURM_NTASKS_PER_NODE": ranks, **environment}
    with (
        (directory / job_files.OUTPUT).open("a") as output,
        subprocess.Popen(
            ["bash", SLURM.script],
            cwd=directory,
            env={**os.environ, **{name: str(value) for name, value in variables.items()}},
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=output,
            start_new_session=True,
        ) as process,
    ):
        try:
            yield process
        finally:
            for pid in (process.pid, *working_in(directory)):
                with contextlib.suppress(ProcessLookupError):
                    os.kill(pid, signal.SIGKILL)


REQUESTS = ("nodes", "ntasks-per-node")


def go(directory, **environment):
    """Run the script to its end; what it adds to its output."""
    output = directory / job_files.OUTPUT
    before = output.read_text() if output.exists() else ""
    with job_of(directory, **environment) as process:
        process.wait(HANGS)
    return output.read_text().removeprefix(before)


def stop(directory, **environment):
    """Run the script, and signal as Slurm does that its time limit is near, when it computes."""
    with job_of(directory, **environment) as process:
        assert wait_until(directory.joinpath(job_files.FLAG).exists, process)
        process.send_signal(signal.SIGUSR1)
        process.wait(HANGS)


LINE = re.compile(r"(\w+) job=(\S*) cluster=(\S*) host=(\S+) at=(\S+) until=(\S+) (.*?) *\n")


def state(directory):
    """State, job, cluster, host, times, and reason of the line that a job left."""
    text = (directory / job_files.STATE).read_text()
    assert len(text) == 501
    return LINE.fullmatch(text).groups()


def ended(directory):
    """State and reason that a job left."""
    return state(directory)[0], state(directory)[-1]


# --- what a job does --------------------------------------------------------------------------------------------------


KINDS = {
    # the pulse stays away from the border of the ranks, where sums may be taken in another order
    "coupled": scene(chains=3, beads=121, kappa=0.1, duration=60.0, every=2.0),
    "suzuki4": scene(chains=2, beads=100, kappa=0.1, duration=200.0, every=5.0, scheme="suzuki4"),
    "window": scene(chains=2, beads=200, kappa=0.1, duration=150.0, every=5.0, window=64),
    "few beads": scene(chains=3, beads=101, kappa=0.1, duration=120.0).model_copy(
        update={"output": Output(every=2.0, beads=(1, 50, 101))}
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "release", "ranks", "was_a_job"),
    [
        ("coupled", "wheel", 2, True),
        ("suzuki4", "wheel", 1, True),
        ("window", "wheel", 1, True),
        ("few beads", "2021", 1, True),
        ("few beads", "wheel", 1, False),
    ],
)
def test_a_stopped_job_or_run_resumes_as_a_job_bit_for_bit(kind, release, ranks, was_a_job, lmp_of, tmp_path):
    case, whole = KINDS[kind], tmp_path / "whole"
    whole.mkdir()
    scene_files.write(case, whole)
    subprocess.run([WHEEL, "-in", file_names.DECK, "-screen", "none"], cwd=whole, check=True, timeout=HANGS)
    launcher = LAUNCHER if release == "wheel" else "/usr/bin/env"
    options = {"lmp": str(lmp_of(release)), "launcher": launcher, "ranks_per_node": ranks, "max_jobs": 1}
    directory, problem = placed(case, tmp_path / "job", **options), case.problem()
    grain = problem.steps_between_stops
    stop_after_a_stretch(directory, problem.steps // 3 // grain * grain)
    stop(directory)
    assert ended(directory)[0] == "incomplete"
    if not was_a_job:
        for name in (job_files.FRAMES, job_files.STATE, job_files.FLAG):
            (directory / name).unlink()
    go(directory)
    assert ended(directory) == ("done", "")
    found, expected = (joined(blocks(parts(path), problem)) for path in (directory, whole))
    assert len(parts(directory)) == 2
    np.testing.assert_array_equal(found.time, expected.time)
    np.testing.assert_array_equal(found.displacement, expected.displacement)
    np.testing.assert_array_equal(found.velocity, expected.velocity)


@pytest.mark.slow
def test_a_job_that_is_done_leaves_its_results_alone_and_does_nothing_when_it_runs_again(tmp_path):
    directory = placed(scene(beads=4), tmp_path / "job", ranks_per_node=1)
    go(directory)
    assert ended(directory) == ("done", "")
    before = {path.name: path.stat().st_mtime_ns for path in directory.iterdir() if path.name != job_files.OUTPUT}
    assert before.keys() == {
        *(file_names.SCENE, file_names.DECK, file_names.DATA, file_names.DUMP, file_names.LOG),
        *(SLURM.script, job_files.STATE),
    }
    assert "this run is done" in go(directory)
    after = {path.name: path.stat().st_mtime_ns for path in directory.iterdir() if path.name != job_files.OUTPUT}
    assert after == before


@pytest.mark.slow
@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"lmp": "/nowhere/lmp"}, "/nowhere/lmp .*' ended before in.job did: .*/nowhere/lmp.*No such file"),
        ({"launcher": "/nowhere/srun"}, "'/nowhere/srun .*/nowhere/srun: No such file"),
        ({"modules": ("no/such",)}, "module load no/such failed"),
    ],
    ids=["no lmp", "no launcher", "no module"],
)
def test_a_job_that_cannot_compute_says_why_before_it_does(options, says, tmp_path):
    directory = placed(scene(beads=4), tmp_path / "job", **options)
    go(directory)
    assert ended(directory)[0] == "failed"
    assert re.search(says, ended(directory)[1])
    assert parts(directory) == []


@pytest.mark.slow
def test_copies_of_a_serial_lammps_leave_the_frames_of_an_earlier_job_as_they_are(tmp_path):
    directory = placed(ENDLESS, tmp_path / "job", launcher="/usr/bin/env", checkpoint=1, max_jobs=1)
    stop(directory)
    files = [path for path in directory.iterdir() if path.name.startswith("chains.")]
    before = {path: path.read_bytes() for path in files}
    go(directory, SLURM_NTASKS=2)
    assert "it has not 2 ranks" in ended(directory)[1]
    assert {path: path.read_bytes() for path in files} == before


ENDLESS = scene(chains=2, beads=60, kappa=0.1, duration=1e6, every=100.0)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("options", "says"),
    [({}, "the next job could not be submitted:"), ({"max_jobs": 1}, "stopped after 1 jobs (--max-jobs)")],
    ids=["no sbatch", "no more jobs"],
)
def test_a_job_out_of_time_leaves_a_restart_and_says_why_no_other_follows(options, says, tmp_path):
    (tmp_path / "sbatch").symlink_to("/bin/false")
    directory = placed(ENDLESS, tmp_path / "job", checkpoint=1, **options)
    stop(directory, PATH=f"{tmp_path}:{os.environ['PATH']}")
    assert ended(directory)[0] == "incomplete"
    assert ended(directory)[1].startswith(says)
    assert 0 < step_of(directory / file_names.RESTART) < ENDLESS.problem().steps


def placed_task(directory, cases, **options):
    """An array of one task with some cases by name, in a new directory."""
    directory.mkdir()
    for name, case in cases.items():
        placed(case, directory / name)
        (directory / name / SLURM.script).unlink()
    chosen = JobOptions(**{"lmp": str(WHEEL), "launcher": LAUNCHER, "checkpoint": 2, **options})
    for name, text in job.render_array(chosen, [tuple(cases)]).items():
        (directory / name).write_text(text)
    return directory


SHORT = scene(chains=2, beads=8, kappa=0.1, duration=2.0)


@pytest.mark.slow
def test_a_task_of_several_cases_does_each_once_also_those_after_one_that_fails(tmp_path):
    directory = placed_task(tmp_path / "array", {"one": SHORT, "bad": SHORT, "two": SHORT})
    bad = directory / "bad" / file_names.DECK
    whole = bad.read_text()
    bad.write_text(whole.replace("fix motion all nve", "fix motion all nonsense"))
    go(directory, SLURM_ARRAY_TASK_ID=0)
    assert [ended(directory / name)[0] for name in ("one", "bad", "two")] == ["done", "failed", "done"]
    assert "ERROR: Unrecognized fix style" in ended(directory / "bad")[1]
    alone = placed(SHORT, tmp_path / "alone")
    go(alone)
    frames = (alone / file_names.DUMP).read_bytes()
    assert all((directory / name / file_names.DUMP).read_bytes() == frames for name in ("one", "two"))
    bad.write_text(whole)
    before = (directory / "one" / job_files.STATE).stat().st_mtime_ns
    go(directory, SLURM_ARRAY_TASK_ID=0)
    assert ended(directory / "bad")[0] == "done"
    assert (directory / "one" / job_files.STATE).stat().st_mtime_ns == before


# --- what stands in it ------------------------------------------------------------------------------------------------


def requests(script):
    """Options of Slurm in a script."""
    return [word for line in re.findall("(?m)^#SBATCH --(.*)", script) for word in line.split(" --")]


def test_where_slurm_does_not_tell_the_end_of_a_job_its_time_limit_does(tmp_path):
    directory = placed(scene(beads=4), tmp_path / "job", time="1-12:30:05", lmp="/nowhere/lmp")
    (tmp_path / "date").write_text(
        f'#!/bin/sh\n[ "$*" != +%s ] || exec echo 1000000\nexec {shutil.which("date")} "$@"\n'
    )
    (tmp_path / "date").chmod(0o755)
    go(directory, PATH=f"{tmp_path}:{os.environ['PATH']}")
    assert datetime.fromisoformat(state(directory)[5]).timestamp() == 1_000_000 + 131405


@pytest.mark.parametrize("option", ["time", "partition", "account", "qos", "constraint", "modules"])
def test_hostile_text_in_an_option_is_refused_in_one_line(option):
    for text in HOSTILE:
        with pytest.raises(InputError) as refused:
            site.options({option: [text] if option == "modules" else text})
        assert str(refused.value).isprintable()


@pytest.mark.parametrize("option", ["lmp", "launcher"])
def test_hostile_text_in_a_command_is_refused_or_one_quoted_word(option, tmp_path):
    plain = requests(job.render_job(JobOptions(), scene(beads=4).problem())[SLURM.script])
    for text in HOSTILE:
        try:
            options = site.options({option: text})
        except InputError:
            continue
        script = job.render_job(options, scene(beads=4).problem())[SLURM.script]
        assert requests(script) == plain
        values = script.split("# In this directory")[1].split("ends=")[0].partition("\n")[2]
        show = values + '\nprintf "%s\\0" "${lammps[@]}"'
        environment = {**os.environ, "SLURM_NTASKS": "1"}
        shown = subprocess.run(["bash", "-c", show], cwd=tmp_path, env=environment, capture_output=True, check=True)
        command = ["srun", text] if option == "lmp" else [*shlex.split(text), "lmp"]
        words = shown.stdout.decode().split("\0")[:-1]
        assert words == [*command, "-log", "none", "-screen", "none", "-nocite"]
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "cases",
    [[], ["a", "a"], *([name] for name in ("/etc", "a/../b", "a/", "", "a b", "a\nb", "-rf", ".git", "$(ls)"))],
    ids=str,
)
def test_a_list_of_cases_that_leads_elsewhere_is_refused(cases):
    with pytest.raises(InputError):
        job.render_array(JobOptions(), cases)


@pytest.mark.slow
@given(st.sets(st.integers(0, 40), min_size=1))
def test_an_array_is_of_the_tasks_that_are_asked_for(tasks):
    script = job.render_array(JobOptions(), [f"c{number}" for number in range(41)], tasks=sorted(tasks))[SLURM.script]
    (numbers,) = (word.removeprefix("array=") for word in requests(script) if word.startswith("array="))
    read = set()
    for part in numbers.split(","):
        first, _, last = part.partition("-")
        read |= set(range(int(first), int(last or first) + 1))
    assert read == tasks


def test_an_array_refuses_another_list_of_cases_than_it_was_made_for(tmp_path):
    for name, text in job.render_array(JobOptions(), ["a", "b"]).items():
        (tmp_path / name).write_text(text)
    (tmp_path / file_names.CASES).write_text("b\na\n")
    assert "cases.txt is not the list of this array" in go(tmp_path, SLURM_ARRAY_TASK_ID=0)


@pytest.mark.slow
@pytest.mark.parametrize(
    "frames",
    [
        "a[$(touch$IFS\\pwned)]:x[$(touch pwned)]",
        "../../thesis.txt:0",
        "chains.dump.a[$(touch pwned)].bin:0",
    ],
)
def test_what_a_run_directory_from_someone_else_holds_reaches_no_shell_and_no_other_file(frames, tmp_path):
    thesis = tmp_path / "thesis.txt"
    thesis.write_text("all of it")
    (tmp_path / "x").mkdir()
    directory = placed(scene(beads=4), tmp_path / "x" / "job", ranks_per_node=1)
    (directory / job_files.STATE).write_text("running job=$(touch\tpwned);touch\tpwned cluster=$(touch pwned)\n")
    (directory / file_names.RESTART).write_text("none")
    (directory / job_files.FRAMES).write_text(f"{frames}\n")
    go(directory)
    assert ended(directory)[0] == "failed"
    assert ended(directory)[1].endswith("is shorter than at the restart, or job.frames is damaged")
    assert not list(tmp_path.rglob("pwned*"))
    assert thesis.read_text() == "all of it"


# --- a site's defaults ------------------------------------------------------------------------------------------------


def test_a_site_is_found_where_the_environment_says_else_at_home(tmp_path, monkeypatch):
    monkeypatch.delenv(site.VARIABLE, raising=False)
    monkeypatch.setenv("HOME", str(tmp_path))
    assert site.find_site() is None
    home = tmp_path / site.DEFAULT_FILE
    home.parent.mkdir(parents=True)
    home.write_text("nodes: 1\n")
    assert site.find_site() == home
    monkeypatch.setenv(site.VARIABLE, "/else/where.yaml")
    assert str(site.find_site()) == "/else/where.yaml"
    assert site.find_site(home) == home


def test_the_job_of_a_law_by_lepton_looks_at_its_flag_every_few_seconds_not_minutes():
    formula = {"name": "a", "beads": 40, "kick": {"velocity": 1}, "contact": {"force": "A*(exp(s) - 1)", "A": 1}}
    step = 1e-3 * library.from_plain({**formula, "duration": 1.0}, "a").scale.time
    case = library.from_plain({**formula, "timestep": step, "duration": step}, "a")
    lines = job._stretch_lines(case.problem())
    assert float(re.search(r"variable seconds equal ([\d.e-]+)", lines[0])[1]) > 1e-4
