"""What differs between the schedulers of clusters, as one table: `OURS`.

All else of a job is the same (`job`, and the shell commands beside it). A text of the table that is shell stands in
those commands at the place ``@name@`` of its field. Slurm sends a job a signal before its time limit. PBS Professional
does not, and Grid Engine sends it to the ranks as well, which end by it; so there the job has a timer of its own.

Sources: the manual pages sbatch(1) and squeue(1) of Slurm 22.05; qsub(1B), qstat(1B) and the sources of OpenPBS 23;
submit(1) and qstat(1) of Son of Grid Engine 8.1.9.
"""

import json
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

from workflow.plugins.jobs import job_files


class Request(NamedTuple):
    """What a job asks of a scheduler.

    Attributes:
        name: of the job.
        nodes: number of nodes.
        ranks: MPI ranks of a node.
        cores: cores of a job that runs one command; None for a job of decks.
        limit: time limit in seconds.
        time: the time limit as the user wrote it, HH:MM:SS or D-HH:MM:SS.
        stop_before: seconds before the limit at which the job is to stop.
        tasks: numbers of an array's tasks from 0, ascending; none where the job is no array.
        array_limit: tasks that may run at once.
        site: names of partition, account and the like that were asked for.
        directory: that the job works in.
    """

    name: str
    nodes: int
    ranks: int
    cores: int | None
    limit: int
    time: str
    stop_before: int
    tasks: Sequence[int]
    array_limit: int | None
    site: Mapping[str, str]
    directory: Path


class ListedJob(NamedTuple):
    """A job, or task of an array, in a queue: whether it waits, and its task from 0 (None where it is no array's)."""

    number: str
    waiting: bool
    task: int | None
    directory: str


Ask = Callable[..., str | None]
"""Output of a command by its words; None where it cannot be run or fails."""


@dataclass(frozen=True)
class Scheduler:
    """What a job asks of one scheduler, and how; fields without an explanation are shell.

    Attributes:
        title: its name in sentences.
        submit: command that submits a job.
        cancel: command that ends one.
        script: name of the job's file.
        launcher: what starts the ranks where nothing else is asked for.
        options: keys of a site's file that only this scheduler has.
        has_lists: whether a job may name several partitions.
        max_tasks: tasks of an array where the site did not change its setting.
        max_tasks_setting: name of that setting.
        head: directives of a request, and commands that bring the job into its directory and open its output.
        queue: name of the cluster and its jobs, by asking; None where the scheduler does not answer.
        warns: whether it signals the job before its time limit.
        command_signal: signal that stops a command.
        sender: where the signal before the time limit comes from.
        job: number of the job, as the queue lists it.
        number: how many jobs there were with this one.
        cluster: name of the cluster.
        ranks: number of ranks.
        ends: seconds since 1970 of the time limit, ``{sum}`` standing for the sum by the job's own clock.
        running: numbers of jobs that run, one a line; ``$last`` is one of them if it runs.
        line: number of the task's line in the list of cases, from 1.
        dependency: options that let the next job begin after this one.
        task_again: array of options for the next job of this task.
        submission: command that submits the next job with the options ``{again}`` after ``{number}`` jobs; what it
            prints is read where ``{parsable}`` stands for `parsable`.
        parsable: option that makes it print no more than the job's number.
        next: number of the next job, from what was printed.
    """

    title: str
    submit: str
    cancel: str
    script: str
    launcher: str
    options: tuple[str, ...]
    has_lists: bool
    max_tasks: int
    max_tasks_setting: str
    head: Callable[[Request], list[str]]
    queue: Callable[[Ask], tuple[str, list[ListedJob]] | None]
    warns: bool
    command_signal: str
    sender: str
    job: str
    number: str
    cluster: str
    ranks: str
    ends: str
    running: str
    line: str
    dependency: str
    task_again: str
    submission: str
    parsable: str
    next: str

    @property
    def by_hand(self) -> str:
        """Command that submits a job in its directory."""
        return f"{self.submit} {self.script}"


def _hours(seconds: int) -> str:
    """Seconds as H:MM:SS, for schedulers that have no days."""
    return f"{seconds // 3600}:{seconds // 60 % 60:02}:{seconds % 60:02}"


def _beginning_with_letter(name: str) -> str:
    """A name of a job, which only Slurm lets begin with a digit."""
    return name if name[0].isalpha() else f"job-{name}"


# --- Slurm ------------------------------------------------------------------------------------------------------------


def _slurm_head(request: Request) -> list[str]:
    """Directives of Slurm.

    Slurm would expand a % in the directory's name but for the backslashes before the name of the output. A backslash
    in the directory's name it takes away, so there the script itself opens its output.
    """
    ranks, signal = f"--ntasks-per-node={request.ranks}", "USR1"
    if request.cores is not None:
        ranks, signal = f"--ntasks=1 --cpus-per-task={request.cores}", SLURM.command_signal
    array = ""
    if request.tasks:
        limit = "" if request.array_limit is None else f"%{request.array_limit}"
        array = f" --array={_ranges(request.tasks)}{limit}"
    head = [
        f"#SBATCH --job-name={request.name} --nodes={request.nodes} {ranks}{array}",
        f"#SBATCH --time={request.time} --signal=B:{signal}@{request.stop_before}",
    ]
    if request.site:
        head.append(f"#SBATCH {' '.join(f'--{key}={value}' for key, value in request.site.items())}")
    if "\\" not in str(request.directory):
        return [*head, rf"#SBATCH --output=\\{job_files.OUTPUT} --open-mode=append"]
    return [
        *head,
        "#SBATCH --output=/dev/null",
        f"[ ! /dev/stdout -ef /dev/null ] || exec >>{job_files.OUTPUT} 2>&1",
    ]


def _ranges(numbers: Sequence[int]) -> str:
    """Ascending numbers as Slurm reads them, such as ``0-3,7``."""
    ranges: list[list[int]] = []
    for number in numbers:
        if ranges and number == ranges[-1][1] + 1:
            ranges[-1][1] = number
        else:
            ranges.append([number, number])
    return ",".join(str(first) if first == last else f"{first}-{last}" for first, last in ranges)


_SLURM_WAITING = ("PD", "RQ", "RH", "RF", "SE", "RD", "RV", "SO")


def _slurm_queue(ask: Ask) -> tuple[str, list[ListedJob]] | None:
    settings, jobs = ask("scontrol", "show", "config"), ask("squeue", "-h", "-r", "-o", "%A|%t|%K|%Z")
    if settings is None or jobs is None:
        return None
    name = re.search(r"^ClusterName *= *(.*?) *$", settings, flags=re.MULTILINE)
    return name[1] if name else "", slurm_jobs(jobs)


def slurm_jobs(text: str) -> list[ListedJob]:
    """Jobs as ``squeue`` lists them: number, state, task and directory."""
    jobs = []
    for line in text.splitlines():
        number, state, task, directory = [*line.split("|", 3), "", "", ""][:4]
        jobs.append(ListedJob(number, state in _SLURM_WAITING, int(task) if task.isdigit() else None, directory))
    return jobs


SLURM = Scheduler(
    title="Slurm",
    submit="sbatch",
    cancel="scancel",
    script="job.sbatch",
    launcher="srun",
    options=("qos", "constraint"),
    has_lists=True,
    max_tasks=1001,
    max_tasks_setting="MaxArraySize",
    head=_slurm_head,
    queue=_slurm_queue,
    warns=True,
    command_signal="TERM",
    sender="Slurm",
    job="$SLURM_JOB_ID",
    number="${1:-1}",
    cluster="$SLURM_CLUSTER_NAME",
    ranks="${SLURM_NTASKS:-$((SLURM_JOB_NUM_NODES * SLURM_NTASKS_PER_NODE))}",
    ends="${{SLURM_JOB_END_TIME:-{sum}}}",
    running='squeue -h -t R -o %A -j "$last" 2>/dev/null',
    line="$((SLURM_ARRAY_TASK_ID + 1))",
    dependency='--dependency="afterany:$SLURM_JOB_ID"',
    task_again='--array=$SLURM_ARRAY_TASK_ID --dependency="afterany:${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID"',
    submission="sbatch{parsable} {again} job.sbatch $(({number} + 1))",
    parsable=" --parsable",
    next="${next%%;*}",
)

# --- PBS Professional, and Grid Engine, which has much from it --------------------------------------------------------

_AFTER_LIMIT = '-a "$(date -d "$ends" +%Y%m%d%H%M.%S)"'
"""Option that lets a job wait until this one has surely ended: neither lets it wait for one task of an array."""

_NUMBER_AND_TASK = "%%[.[]*}${task:+.$task}"


def _pbs_head(request: Request) -> list[str]:
    """Directives of PBS, which copies output only at the end of a job; so the script itself opens it.

    The indices of a range must differ: a task alone is the first of two with the stride 2.
    """
    chunk = f"ncpus={request.ranks}:mpiprocs={request.ranks}" if request.cores is None else f"ncpus={request.cores}"
    scatter = " -l place=scatter" if request.nodes > 1 else ""
    head = [
        f"#PBS -N {_beginning_with_letter(request.name)} -S /bin/bash -V -j oe -o /dev/null",
        f"#PBS -l select={request.nodes}:{chunk}{scatter} -l walltime={_hours(request.limit)}",
        *_queue_and_account("#PBS", request),
    ]
    if request.tasks:
        first, last = request.tasks[0] + 1, request.tasks[-1] + 1
        limit = "" if request.array_limit is None else f"%{request.array_limit}"
        head.append(f"#PBS -J {first}-{last}{limit}" if first < last else f"#PBS -J {first}-{first + 1}:2")
    return [*head, *_begin("PBS_O_WORKDIR"), "task=$PBS_ARRAY_INDEX"]


def _begin(variable: str) -> list[str]:
    """Commands that bring a job into the directory where it was submitted, and open its output there."""
    return [f'cd -- "${variable}" && exec >>{job_files.OUTPUT} 2>&1 || exit']


def _queue_and_account(prefix: str, request: Request) -> list[str]:
    """Directive for the queue and the account; none where neither is asked for."""
    letters = {"partition": "-q", "account": "-A"}
    options = [f"{letter} {request.site[key]}" for key, letter in letters.items() if key in request.site]
    return [f"{prefix} {' '.join(options)}"] if options else []


def _pbs_queue(ask: Ask) -> tuple[str, list[ListedJob]] | None:
    text = ask("qstat", "-t", "-f", "-F", "json")
    try:
        return None if text is None else pbs_jobs(text)
    except (ValueError, AttributeError):  # PBS writes some names of jobs such that it is no JSON
        return None


def pbs_jobs(text: str) -> tuple[str, list[ListedJob]]:
    """Name of the server, and jobs as ``qstat -t -f -F json`` lists them; an array's own line stands for no job."""
    listing = json.loads(text)
    jobs = []
    for identifier, job in listing.get("Jobs", {}).items():
        match = re.match(r"(\d+)(?:\[(\d+)\])?(?=\.|$)", identifier)
        state = job.get("job_state")
        if match is None or state in ("X", "F", "M"):  # an array, or a job that has ended or is of another server
            continue
        number, index = match.groups()
        task = None if index is None else int(index) - 1
        directory = str(job.get("Variable_List", {}).get("PBS_O_WORKDIR", ""))
        jobs.append(ListedJob(number + (f".{index}" if index else ""), state in ("Q", "H", "W", "T"), task, directory))
    return str(listing.get("pbs_server", "")).partition(".")[0], jobs


PBS = Scheduler(
    title="PBS Professional",
    submit="qsub",
    cancel="qdel",
    script="job.pbs",
    launcher="mpirun -np {ranks}",
    options=(),
    has_lists=False,
    max_tasks=10_000,
    max_tasks_setting="max_array_size",
    head=_pbs_head,
    queue=_pbs_queue,
    warns=False,
    command_signal="USR1",
    sender="the timer above",
    job="${PBS_JOBID" + _NUMBER_AND_TASK,
    number="${granchain_job:-1}",
    cluster="$(cut -d . -f 2 <<<$PBS_JOBID)",
    ranks='$(wc -l <"$PBS_NODEFILE")',
    ends="{sum}",
    running="qstat -t 2>/dev/null | "
    "sed -nE '/ R [^ ]+ *$/{ s/^([0-9]+)\\[([0-9]+)].*/\\1.\\2/p; s/^([0-9]+)[.].* .*/\\1/p }'",
    line="${task}",
    dependency='-W depend=afterany:"$PBS_JOBID"',
    task_again=f"-J $task-$((task + 1)):2 {_AFTER_LIMIT}",
    submission="qsub{parsable} {again} -v granchain_job=$(({number} + 1)) job.pbs",
    parsable="",
    next="${next" + _NUMBER_AND_TASK,
)


def _grid_engine_head(request: Request) -> list[str]:
    """Directives of Grid Engine; slots of more than one core are those of a parallel environment of the site.

    Grid Engine expands a $ in names of directories (-cwd, -o); so the script itself goes there and opens its output.
    """
    name, slots = request.site.get("parallel_environment", "mpi"), request.nodes * request.ranks
    if request.cores is not None:
        name, slots = request.site.get("node_environment", "smp"), request.cores
    environment = f" -pe {name} {slots}" if slots > 1 else ""
    head = [
        f"#$ -N {_beginning_with_letter(request.name)} -S /bin/bash -V -j y -o /dev/null",
        f"#$ -l h_rt={_hours(request.limit)}{environment}",
        *_queue_and_account("#$", request),
    ]
    if request.tasks:
        limit = "" if request.array_limit is None else f" -tc {request.array_limit}"
        head.append(f"#$ -t {request.tasks[0] + 1}-{request.tasks[-1] + 1}{limit}")
    return [*head, *_begin("SGE_O_WORKDIR"), "task=${SGE_TASK_ID/undefined/}"]


def _grid_engine_queue(ask: Ask) -> tuple[str, list[ListedJob]] | None:
    host = ask("qconf", "-sss")
    listing = None if host is None else ask("qstat", "-g", "d", "-xml")
    if host is None or listing is None:
        return None
    numbers = re.findall(r"<JB_job_number>(\d+)<", listing)
    details = ask("qstat", "-j", ",".join(dict.fromkeys(numbers))) if numbers else ""
    return host.strip(), grid_engine_jobs(listing, details or "")


def grid_engine_jobs(listing: str, details: str) -> list[ListedJob]:
    """Jobs as ``qstat -g d -xml`` lists them, in directories that ``qstat -j`` names."""
    directories, number = {}, ""
    for line in details.splitlines():
        key, _, value = line.partition(":")
        if key == "job_number":
            number = value.strip()
        elif key == "sge_o_workdir":
            directories[number] = value.lstrip()
    jobs = []
    for job in ElementTree.fromstring(listing).iter("job_list"):
        number, state, task = (job.findtext(key, "") for key in ("JB_job_number", "state", "tasks"))
        shown = f"{number}.{task}" if task else number
        jobs.append(ListedJob(shown, "qw" in state, int(task) - 1 if task else None, directories.get(number, "")))
    return jobs


GRID_ENGINE = Scheduler(
    title="Grid Engine",
    submit="qsub",
    cancel="qdel",
    script="job.sge",
    launcher="mpirun -np {ranks}",
    options=("parallel_environment", "node_environment"),
    has_lists=True,
    max_tasks=75_000,
    max_tasks_setting="max_aj_tasks",
    head=_grid_engine_head,
    queue=_grid_engine_queue,
    warns=False,
    command_signal="USR1",
    sender="the timer above",
    job="$JOB_ID${task:+.$task}",
    number="${granchain_job:-1}",
    cluster="$(qconf -sss)",
    ranks="$NSLOTS",
    ends="{sum}",
    running="""qstat -s r 2>/dev/null | awk '{ print $1 ($10 == "" ? "" : "." $10) }'""",
    line="${task}",
    dependency="-hold_jid $JOB_ID",
    task_again=f"-t $task {_AFTER_LIMIT}",
    submission="qsub{parsable} {again} -v granchain_job=$(({number} + 1)) job.sge",
    parsable=" -terse",
    next="${next" + _NUMBER_AND_TASK,
)

OURS = {"slurm": SLURM, "pbs": PBS, "sge": GRID_ENGINE}
"""Schedulers by the name that users give them; `registry` adds those of other distributions."""
