"""What a job asks of a cluster: options, and a site's defaults for them from one YAML file.

Everything here ends in a shell script, so everything is checked here: names by pattern, one line of printable text
else. `job` quotes it all the same.
"""

import os
import re
import shlex
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError, field_validator, model_validator

from granchain import InputError
from granchain.parts import complaints, output, schema, strict_yaml
from workflow.plugins.jobs.registry import SCHEDULERS
from workflow.plugins.jobs.schedulers import Scheduler

VARIABLE = "GRANCHAIN_SITE"
DEFAULT_FILE = Path(".config/granchain/site.yaml")
"""In the user's home."""

RANKS = "{ranks}"
"""Stands for the number of ranks in a launcher."""

_TIME = re.compile(r"(?:(\d{1,3})-)?(\d{1,4}):([0-5]\d):([0-5]\d)")


def _checked(is_right: Callable[[Any], object], words: str) -> AfterValidator:
    def check(value: Any) -> Any:
        if not is_right(value):
            raise ValueError(words)
        return value

    return AfterValidator(check)


def _is_time(text: str) -> bool:
    return bool(_TIME.fullmatch(text)) and 60 <= seconds(text) <= 365 * 86400


def _are_modules(words: tuple[str, ...]) -> bool:
    return all(re.fullmatch("[A-Za-z0-9][A-Za-z0-9._/+@:=-]{0,127}", word) for word in words)


def _plain(text: str) -> bool:
    return bool(text.strip()) and text.isprintable() and len(text) <= 4096


def _is_executable(text: str) -> bool:
    return _plain(text) and not text.startswith("-")


def _is_command(text: str) -> bool:
    try:
        words = shlex.split(text)
    except ValueError:
        words = []
    return _plain(text) and bool(words) and not words[0].startswith("-")


_WORD = "[A-Za-z0-9][A-Za-z0-9._+-]{0,127}"
_LIST = f"{_WORD}(,{_WORD}){{0,15}}"
_ONE = "should be one word of letters, digits, `.`, `_`, `+`, `-`"

Count = Annotated[int, Field(ge=1, le=10**6)]
Name = Annotated[str, _checked(re.compile(_WORD).fullmatch, _ONE)]
Names = Annotated[str, _checked(re.compile(_LIST).fullmatch, f"{_ONE}, or several with commas")]
Modules = Annotated[tuple[str, ...], _checked(_are_modules, "a module should be one word such as lammps/2025.07")]
Time = Annotated[str, _checked(_is_time, "should be HH:MM:SS or D-HH:MM:SS, from a minute to a year")]
Executable = Annotated[str, _checked(_is_executable, "should be a name or path, in one line of printable text")]
Command = Annotated[str, _checked(_is_command, f"should be a command with its options, such as `mpirun -np {RANKS}`")]


if TYPE_CHECKING:
    SchedulerName = str
else:
    SchedulerName = Literal[tuple(SCHEDULERS)]


class JobOptions(BaseModel):
    """What a job asks for; everything has a default."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    scheduler: SchedulerName = "slurm"
    """Of the cluster: Slurm, PBS Professional or Grid Engine."""
    nodes: Count = 1
    ranks_per_node: Count | None = None
    """None where it is to be advised by the number of beads."""
    cores_per_node: Count | None = None
    """Of the site; bounds the advice."""
    time: Time = "24:00:00"
    """Limit of one job: HH:MM:SS or D-HH:MM:SS."""
    margin: Count | None = None
    """Seconds before the limit at which a job stops computing; by default a tenth of it, 30 s to 10 min."""
    checkpoint: Count = 900
    """Seconds between two restarts, about."""
    max_jobs: Count = 100
    """Jobs, each submitted by the one before, after which a run stops."""
    array_limit: Count | None = None
    """Tasks of an array that may run at once."""
    cases_per_task: Count = 1
    """Cases that a task of an array computes, one after the other."""
    partition: Names | None = None
    """Partition, or queue."""
    account: Name | None = None
    qos: Name | None = None
    """Only of Slurm."""
    constraint: Name | None = None
    """Only of Slurm."""
    parallel_environment: Name | None = None
    """Only of Grid Engine: that of MPI ranks (default mpi), asked for where there are several."""
    node_environment: Name | None = None
    """Only of Grid Engine: that of a command on several cores of one node (default smp)."""
    modules: Modules = ()
    limits: output.Limits | None = None
    """Of runs on this machine, where a scene names none; of no meaning for a job."""
    launcher: Command | None = None
    """What starts the ranks, such as ``srun --mpi=pmi2``; by default ``srun`` on Slurm, else ``mpirun -np {ranks}``."""
    lmp: Executable = "lmp"

    _from_list = field_validator("modules", mode="before")(strict_yaml.as_tuple)

    @model_validator(mode="after")
    def _leaves_time(self) -> Self:
        if self.margin is not None and self.margin >= self.limit:
            raise ValueError(f"margin: {self.margin} s leave nothing of a time of {self.time}")
        return self

    @model_validator(mode="after")
    def _suits_scheduler(self) -> Self:
        scheduler = self.of_scheduler
        for key in (key for other in SCHEDULERS.values() for key in other.options if key not in scheduler.options):
            if getattr(self, key) is not None:
                its = ", ".join(("partition", "account", *scheduler.options))
                raise ValueError(f"{key}: {scheduler.title} has no such option; it has {its}")
        if not scheduler.has_lists and "," in (self.partition or ""):
            raise ValueError(f"partition: {scheduler.title} takes one queue, {self.partition!r} given")
        return self

    @property
    def of_scheduler(self) -> Scheduler:
        """What the scheduler needs in a job."""
        return SCHEDULERS[self.scheduler]

    @property
    def limit(self) -> int:
        """Seconds that one job may take."""
        return seconds(self.time)

    @property
    def stop_before(self) -> int:
        """Seconds before the limit at which a job stops computing."""
        return max(30, min(600, self.limit // 10)) if self.margin is None else self.margin

    @property
    def ranks(self) -> int:
        """MPI ranks in all; one a node where nothing was said."""
        return self.nodes * (self.ranks_per_node or 1)


def seconds(time: str) -> int:
    """Seconds of a time that `JobOptions` accepts."""
    match = _TIME.fullmatch(time)
    assert match is not None
    days, hours, minutes, rest = (int(part or 0) for part in match.groups())
    return ((days * 24 + hours) * 60 + minutes) * 60 + rest


def find_site(file: Path | None = None) -> Path | None:
    """The file with a site's defaults: the argument, else that of the environment, else that in the user's home."""
    if file is not None:
        return file
    named = os.environ.get(VARIABLE)
    if named:
        return Path(named)
    try:
        path = Path.home() / DEFAULT_FILE
        return path if path.is_file() else None
    except (OSError, RuntimeError):  # a home that cannot be found or read has no defaults
        return None


def load(path: Path) -> dict[str, Any]:
    """Content of a site's file, checked.

    Raises:
        InputError: naming the file, the key, what was given and what would be right.
    """
    data = strict_yaml.load(path, "a site's file holds defaults of the options of jobs, such as `partition: NAME`")
    try:
        JobOptions.model_validate(data)
    except ValidationError as error:
        raise InputError(f"{path}: {complaints.describe(error, JobOptions)}") from None
    return data


def limits() -> tuple[str, output.Limits]:
    """Name of the site's file, and limits of runs on this machine from it; none where there is no file.

    Raises:
        InputError: as `load`.
    """
    path = find_site()
    named = None if path is None else JobOptions.model_validate(load(path)).limits
    return f"~/{DEFAULT_FILE}", named or output.Limits()


def options(named: dict[str, Any], site: Path | None = None) -> JobOptions:
    """Options of a job: those of the command line over those of the site, over the defaults.

    Args:
        named: options of the command line by name.
        site: file of the site's defaults.

    Raises:
        InputError: naming the option or the file's key.
    """
    try:
        JobOptions.model_validate(named)
        return JobOptions.model_validate({**(load(site) if site is not None else {}), **named})
    except ValidationError as error:
        words = complaints.describe(error, JobOptions)
        first, _, rest = words.partition(":")
        key, bracket, number = first.partition("[")
        if key not in named:
            raise InputError(f"{site}: {words}") from None
        raise InputError(f"--{OPTIONS.get(key, key.replace('_', '-'))}{bracket}{number}:{rest}") from None


OPTIONS = {"modules": "module"}
"""Names on the command line that differ from the file's."""


def schema_of_site() -> dict[str, Any]:
    """JSON schema of a site's file."""
    return schema.of(JobOptions, "site")
