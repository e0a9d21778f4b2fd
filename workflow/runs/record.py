"""What ``run.json`` holds, read strictly: the file may be damaged, or somebody else's."""

from datetime import datetime
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError
from pydantic_core import from_json

from lammps_inputs import InputError

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


class _Part(BaseModel):
    """What is not named here is nobody's business."""

    model_config = ConfigDict(frozen=True, strict=True, allow_inf_nan=False)


class _Resumed(_Part):
    at: Date
    from_step: Count


class _Settings(_Part):
    accuracy: Number
    timestep: Number
    steps_per_frame: Count
    reference_timestep: Number
    expected_error: Number
    measured_error: Number
    measured: Number
    limited: bool
    seconds: Seconds
    asked: bool = True
    unreached: str = ""
    model_config = ConfigDict(extra="forbid")


class _Certificate(_Part):
    steps_per_frame: Count | None = None
    velocity: Number | None
    arrival: Number | None


class _Check(_Part):
    velocity: Number | None
    amplitude: Number | None
    arrival: Number | None
    seconds: Seconds


class _Sample(_Part):
    chain: Count
    bead: Count
    displacement: Number
    velocity: Number


class _Results(_Part):
    frames: Count
    sha256: str
    samples: list[_Sample]


class _Study(_Part):
    command: str
    done: bool
    result: str
    resume: str


class _Record(_Part):
    outcome: Literal["running", "done", "interrupted", "failed"] | None = None
    reason: str | None = None
    engine: Literal["lammps", "reference", "collisions"] | None = None
    ranks: Annotated[int, Field(ge=1, le=10**6)] | None = None
    steps: Count | None = None
    steps_done: Count | None = None
    started: Date | None = None
    command: list[str] | None = None
    host: str | None = None
    machine: str | None = None
    python: str | None = None
    versions: dict[str, str] = Field(default_factory=dict)
    files: list[Annotated[str, AfterValidator(_plain_name)]] = Field(default_factory=list)
    files_sha256: str | None = None
    scene: dict[str, Any] | None = None
    settings: _Settings | None = None
    force: bool = False
    resumed: list[_Resumed] = Field(default_factory=list)
    lammps: int | None = None
    engine_seconds: Seconds = 0.0
    wall_seconds: Seconds = 0.0
    collisions: Count | None = None
    certificate: _Certificate | None = None
    check: _Check | None = None
    results: _Results | None = None
    study: _Study | None = None


def read_record(path: Path) -> dict[str, Any]:
    """What a ``run.json`` holds; what stands in it is of the kind that it should be, and what is not is missing.

    Raises:
        InputError: it cannot be read, or holds what no run leaves; names the key.
    """
    try:
        with path.open("rb") as file:
            raw = file.read(MAX_BYTES + 1)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from None
    if len(raw) > MAX_BYTES:
        raise InputError(f"{path}: cannot be read (larger than {MAX_BYTES >> 20} MiB)")
    try:
        data = from_json(raw, allow_inf_nan=False)
        _Record.model_validate(data)
    except ValidationError as error:
        from lammps_inputs.library import describe  # loads all that a scene may be

        raise InputError(f"{path}: cannot be read ({describe(error, _Record)})") from None
    except ValueError as error:
        raise InputError(f"{path}: cannot be read ({error})") from None
    assert isinstance(data, dict)
    return data
