"""The state of a directory, ``run.json``: the request, the outcome, the choice of the step, and the error.

One type, one function that reads it and one that changes it. It is read strictly: the file may be damaged, or somebody
else's. What a run directory is besides follows from it, from the frames and from the locks (`workflow.runs.status`).

Examples:
    >>> job.update(tmp, outcome="failed", reason="the disk is full")
    >>> record = job.load(tmp / "run.json")
    >>> record.outcome, record.plain()["reason"]
    ('failed', 'the disk is full')
    >>> job.load(tmp / "absent.json").outcome is None
    True
"""

import functools
import importlib.metadata
import os
import platform
import shlex
import sys
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError
from pydantic_core import from_json

from lammps_inputs import InputError, file_names
from workflow.engines.lammps.files_on_disk import step_of
from workflow.engines.registry import EngineName, engine_names, load_engine
from workflow.runs.files import RECORD, changing, write_json

MAX_BYTES = 16 << 20
"""Ours are some kB; what comes from a scene file is at most 1 MiB."""


def _date(text: str) -> str:
    try:
        datetime.fromisoformat(text).timestamp()
    except OverflowError:
        raise ValueError("should be a date") from None
    return text


def _plain_name(name: str) -> str:
    if not name or "/" in name or name in (".", ".."):
        raise ValueError("should be a name without directory")
    return name


Count = Annotated[int, Field(ge=0, le=10**18)]
Number = Annotated[float, Field(ge=-1e30, le=1e30)]
Seconds = Annotated[float, Field(ge=0.0, le=1e12)]
Date = Annotated[str, AfterValidator(_date)]


class RecordPart(BaseModel):
    """Keys and their values; other keys are refused."""

    model_config = ConfigDict(frozen=True, strict=True, allow_inf_nan=False, extra="forbid")

    def plain(self) -> dict[str, Any]:
        """Keys and values as in the file; keys without a value are left out."""
        return {key: value for key, value in self.model_dump(exclude_unset=True).items() if value is not None}


class Resumed(RecordPart):
    """One time that a run was resumed."""

    at: Date
    from_step: Count


class StepChoice(RecordPart):
    """How a time step was chosen: a `workflow.prepare.step_choice.ChosenStep`."""

    accuracy: Number
    timestep: Number
    steps_per_frame: Count
    reference_timestep: Number
    expected_error: Number
    measured_error: Number
    measured: Number
    limited: bool
    seconds: Seconds
    asked: bool
    unreached: str
    rule_timestep: Number


class UncertaintyRecord(RecordPart):
    """Uncertainty of a run by the reference, dimensionless."""

    steps_per_frame: Count
    velocity: Number | None
    arrival: Number | None
    energy: Number | None
    momentum: Number | None


class ErrorPlace(RecordPart):
    """A bead of a chain, or another atom at it, at a time: data of an `analysis.compare.difference.DeviationPlace`."""

    chain: Count
    bead: Count
    time: Number | None
    resonator: Count
    noun: str | None = None


class ErrorRecord(RecordPart):
    """Measured error of a run, dimensionless: a `workflow.runs.completed_run.Check`."""

    velocity: Number | None
    where: ErrorPlace | None
    amplitude: Number | None
    arrival: Number | None
    reference: UncertaintyRecord
    seconds: Seconds


class FramesRecord(RecordPart):
    """Number of frames, and their SHA-256: `workflow.runs.run_directory.results`."""

    frames: Count
    sha256: str


class StudyRecord(RecordPart):
    """The command that made a directory of many runs or none.

    Attributes:
        command: its name.
        done: whether it came to its end.
        result: which file to look at.
        resume: what to do where it did not.
    """

    command: str
    done: bool
    result: str
    resume: str


class Job(RecordPart):
    """What a ``run.json`` holds; a key that is missing is None. An engine may add keys in a type derived from this.

    Attributes:
        files: all that may be replaced or removed in the directory, by name.
        request: what a layer above expects of the run in this directory, kept when the run is repeated.
        study: of the directory of another command than ``run``.
        outcome: state of the run: "running" also after a kill.
        reason: why it failed.
        files_sha256: SHA-256 of the input files.
        resumed: when, and from which step.
        lammps: version of LAMMPS as a date.
        engine_seconds: wall time of the engine; ``wall_seconds`` of the whole.
    """

    files: list[Annotated[str, AfterValidator(_plain_name)]] = Field(default_factory=list)
    request: dict[str, Any] | None = None
    study: StudyRecord | None = None
    outcome: Literal["running", "done", "interrupted", "failed"] | None = None
    reason: str | None = None
    engine: EngineName | None = None
    ranks: Annotated[int, Field(ge=1, le=10**6)] | None = None
    steps: Count | None = None
    steps_done: Count | None = None
    started: Date | None = None
    command: list[str] | None = None
    host: str | None = None
    machine: str | None = None
    python: str | None = None
    versions: dict[str, str] = Field(default_factory=dict)
    files_sha256: str | None = None
    settings: StepChoice | None = None
    resumed: list[Resumed] = Field(default_factory=list)
    lammps: int | None = None
    engine_seconds: Seconds = 0.0
    wall_seconds: Seconds = 0.0
    uncertainty: UncertaintyRecord | None = None
    check: ErrorRecord | None = None
    results: FramesRecord | None = None
    contacts: dict[str, Any] | None = None


def load(path: Path) -> Job:
    """What a ``run.json`` holds; nothing where there is none.

    Raises:
        InputError: it cannot be read, or holds what no run leaves; names the key.
    """
    try:
        if not path.is_file():
            return Job()
        with path.open("rb") as file:
            raw = file.read(MAX_BYTES + 1)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from None
    if len(raw) > MAX_BYTES:
        raise InputError(f"{path}: cannot be read (larger than {MAX_BYTES >> 20} MiB)")
    try:
        data = from_json(raw, allow_inf_nan=False)
        return _kind(data).model_validate(data)
    except ValidationError as error:
        from lammps_inputs.complaints import describe  # loads all that a scene may be

        raise InputError(f"{path}: cannot be read ({describe(error, Job)})") from None
    except ValueError as error:
        raise InputError(f"{path}: cannot be read ({error})") from None


def _kind(data: Any) -> type[Job]:
    """Type of a record: that of its engine where it has keys that only some engine records."""
    if not isinstance(data, dict) or data.keys() <= Job.model_fields.keys() or data.get("engine") not in engine_names():
        return Job
    kind: type[Job] = load_engine(data["engine"]).record
    return kind


def account(directory: Path) -> Job:
    """What the ``run.json`` of a directory holds; nothing where there is none, or it cannot be read."""
    try:
        return load(directory / RECORD)
    except InputError:
        return Job()


def update(directory: Path, **changes: Any) -> None:
    """Change keys of a directory's ``run.json``, or with None remove them; it is written whole.

    Raises:
        InputError: it cannot be read.
        EndedError: it cannot be written; what was there before still is.
    """
    path = directory / RECORD
    with changing(path):
        data = {"files": [RECORD]} | load(path).plain() | changes
        write_json(path, {key: value for key, value in data.items() if value is not None})


def restart_refused(job: Job) -> str:
    """Reason why a run cannot be resumed from its restart, but for missing frames; empty if it can."""
    if job.versions.get("lammps") != importlib.metadata.version("lammps"):
        return "the restart is of another version of LAMMPS"
    return ""


def onwards(directory: Path, job: Job) -> str:
    """How to complete a local run that is incomplete."""
    return f"`granchain run --resume {shlex.quote(str(directory))}` {goes_on_from(directory, job)}"


def goes_on_from(directory: Path, job: Job | None = None) -> str:
    """The step from which an incomplete run resumes; a local one by its account."""
    step = step_of(directory / file_names.RESTART)
    if not step:
        return "starts again, as there is no restart"
    if job is not None and job.engine == "lammps" and (why := restart_refused(job)):
        return f"starts again, for {why}"
    return f"resumes at step {step}"


def provenance() -> dict[str, Any]:
    """Entries of ``run.json``, and of reports: where and with what something was computed."""
    return {
        "started": datetime.now(UTC).isoformat(timespec="seconds"),
        "command": [os.fsencode(word).decode("utf-8", "replace") for word in sys.argv],
        "host": platform.node(),
        "machine": f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores",
        "python": platform.python_version(),
        "versions": _versions(),
    }


@functools.cache
def _versions() -> dict[str, str]:
    """Versions by package, looked up once, since a process of a sweep runs many scenes."""
    names = ("granchain", "lammps", "numpy", "MDAnalysis", "matplotlib", "numba", "scipy", "pydantic")
    return {name: importlib.metadata.version(name) for name in names}
