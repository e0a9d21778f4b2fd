"""What acts on a single bead from outside, from the start on: pushes and drives.

A push is a force over time, of a hammer or as a sensor recorded it. A drive is harmonic, of a shaker or a piezo
actuator, a piston of constant velocity, or a recorded motion. Forces on one bead add up, and so do prescribed motions.
"""

import itertools
import math
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import (
    Field,
    SerializerFunctionWrapHandler,
    field_serializer,
    field_validator,
    model_serializer,
    model_validator,
)

from lammps_inputs.errors import InputError
from lammps_inputs.facts import Fact
from lammps_inputs.ingredients.base import (
    Count,
    Ingredient,
    NotNegative,
    Phase,
    Positive,
    Setting,
    refuse_outside,
    table_text,
    with_keys,
)
from lammps_inputs.laws import in_time
from lammps_inputs.laws.in_time import MOST_IN_FORMULA, TimeLaw
from lammps_inputs.loads import Load, Motion
from lammps_inputs.system import System
from lammps_inputs.units import Label, Unit

Size = Annotated[float, Field(ge=-1e30, le=1e30)]
Time = Annotated[NotNegative, Unit("s")]
Force = Annotated[Size, Unit("N")]
Velocity = Annotated[Size, Unit("m/s")]

MOST_POINTS = 100_000

_SHAPES = {"half-sine": in_time.half_sine, "rectangular": in_time.rectangular}

MOST_BYTES = 16 << 20
"""Of a table in a file; `MOST_POINTS` take a fraction of that."""

_LEAST = 1e-30
"""Size of a force or velocity below which it is none."""


class OnBead(Ingredient):
    """What acts on one bead from outside, as long as it lasts."""

    key: ClassVar[str]
    several: ClassVar[bool] = True
    why: ClassVar[dict[Fact, str]] = {
        Fact.FRONT: "a window would take the bead that it acts on to its head",
        Fact.REVERSIBLE: "suzuki4 steps back in time within each cycle",
    }

    columns: ClassVar[tuple[str, ...]]
    """What the second column of a table may be."""

    chain: Count = 1
    """Chain of the bead."""
    bead: Count = 1
    """Number of the bead."""

    @classmethod
    def from_files(cls, value: Any, folder: Path) -> Any:
        """Content of a scene's file, with the points of a table that it names.

        Raises:
            InputError: the table cannot be read; names the file and the line.
        """
        if isinstance(value, list):
            return [cls.from_files(part, folder) for part in value]
        if isinstance(value, dict) and isinstance(value.get("table"), str) and "\n" not in value["table"]:
            path = folder / value["table"]
            head, points = _read(path, cls.key, cls.columns)
            named = head in cls.columns and "quantity" in cls.model_fields
            if named and value.get("quantity", head) != head:
                raise InputError(f"{path}:1: the column {head} is named, but {cls.key}.quantity is {value['quantity']}")
            return {**value, "table": points, **({"quantity": head} if named else {})}
        return value

    def refuse(self, setting: Setting) -> None:
        """Refuse a bead outside the array."""
        refuse_outside(setting.key_of(self), self, setting.chains, setting.beads)


def _points(value: Any, columns: tuple[str, ...]) -> Any:
    """Points of a table, as lists or lines of text, as tuples.

    Raises:
        ValueError: they are none.
    """
    if isinstance(value, str) and "\n" in value:
        _, value = _points_of(value, "line ", columns)
    if isinstance(value, str):
        second = " or ".join(columns)
        raise ValueError(f"should be a list of points [time, {second}]; a file's name may stand in a scene's file only")
    if isinstance(value, list):
        return tuple(tuple(point) if isinstance(point, list) else point for point in value)
    return value


def _refuse_points(points: tuple[tuple[float, float], ...]) -> None:
    """Refuse too few points, too many, and times that do not increase.

    Raises:
        ValueError: saying which.
    """
    if not 2 <= len(points) <= MOST_POINTS:
        raise ValueError(f"has {len(points)} points; 2 to {MOST_POINTS} are needed")
    for (before, _), (after, _) in itertools.pairwise(points):
        if not after > before:
            raise ValueError(f"times must increase; {after:g} follows {before:g}")


def _lines_if_long(points: tuple[tuple[float, float], ...]) -> Any:
    """Points of a long table as lines of text, which are read a hundred times faster than lists."""
    if len(points) <= MOST_IN_FORMULA:
        return points
    return "".join(f"{time!r}, {value!r}\n" for time, value in points)


class Push(OnBead):
    """A force on one bead, towards higher bead numbers when positive: of a shape, or from a table."""

    example: ClassVar[str] = "{peak: 0.5, duration: 3, shape: half-sine}"

    key = "push"
    columns = ("force",)

    peak: Annotated[Force | None, Label("peak force of the push")] = None
    """Largest force, positive towards higher bead numbers; with `duration` and `shape`."""
    duration: Annotated[Positive, Unit("s")] | None = None
    """Time from the start to the end of the force."""
    shape: Literal["half-sine", "rectangular"] | None = None
    """Shape of the force over time."""
    table: tuple[tuple[Time, Force], ...] | None = None
    """Points [time, force], linear in between and 0 outside; or the name of a CSV file beside the scene."""

    @field_validator("table", mode="before")
    @classmethod
    def _points(cls, value: Any) -> Any:
        return _points(value, cls.columns)

    @field_validator("table")
    @classmethod
    def _drawable(cls, value: tuple[tuple[float, float], ...] | None) -> tuple[tuple[float, float], ...] | None:
        if value is None:
            return value
        _refuse_points(value)
        jumps = [point for point in (value[0], value[-1]) if point[1] != 0.0 and (point is value[-1] or point[0] > 0.0)]
        if jumps:
            time, force = jumps[0]
            rule = "must begin (unless at time 0) and end with a force of 0"
            raise ValueError(f"{rule}, or the force would jump, here by {force:g} at time {time:g}")
        if not any(force for _, force in value):
            raise ValueError("has no force")
        return value

    @field_serializer("table", when_used="json-unless-none")
    def _lines_if_long(self, value: tuple[tuple[float, float], ...]) -> Any:
        return _lines_if_long(value)

    @model_validator(mode="after")
    def _of_a_shape_or_a_table(self) -> Self:
        shaped = {"peak": self.peak, "duration": self.duration, "shape": self.shape}
        named = [key for key, part in shaped.items() if part is not None]
        if self.table is not None and named:
            raise ValueError(f"{named[0]}: give either a table or peak, duration and shape (both are given)")
        if self.table is None and len(named) < len(shaped):
            missing = next(key for key in shaped if key not in named)
            raise ValueError(f"{missing}: is missing; a push needs peak, duration and shape, or a table")
        if self.peak is not None and abs(self.peak) < _LEAST:
            raise ValueError(f"peak: a push needs a force (at least 1e-30) ({self.peak:g} given)")
        return self

    def lacks(self, setting: Setting) -> frozenset[Fact]:  # noqa: ARG002
        """Facts that do not hold: the force depends on time, and on the place of the bead."""
        return frozenset({Fact.FRONT, Fact.REVERSIBLE})

    def speed(self, mass: float) -> float:
        """Speed of a free bead after the impulse of the force's size."""
        return self._law(1.0, 1.0).total / mass

    def loads(self, setting: Setting) -> tuple[Load, ...]:
        """The push, dimensionless."""
        return (Load(self.chain, self.bead, self._law(setting.scale.time, setting.scale.force)),)

    def _law(self, time: float, force: float) -> TimeLaw:
        """Law of the force, in these units of time and force."""
        if self.table is not None:
            points: NDArray[np.float64] = np.array(self.table)
            return in_time.of_force(points[:, 0] / time, points[:, 1] / force)
        assert self.peak is not None
        assert self.duration is not None
        assert self.shape is not None
        return _SHAPES[self.shape](self.peak / force, self.duration / time)


def _second_unit(keys: Any) -> str:
    """SI unit of the second column of a drive's table."""
    return "m/s" if keys.get("quantity") == "velocity" else "m"


@with_keys(
    {
        "from": (
            Annotated[Time | None, Field(description="Time at which a constant velocity begins; 0 if omitted.")],
            None,
        )
    }
)
class Drive(OnBead):
    """Prescribed motion of one bead, harmonic, of constant velocity or from a table, or a harmonic force on it."""

    example: ClassVar[str] = "{displacement: 0.1, frequency: 0.05}"
    sources = ("coste1997",)

    key = "drive"
    columns = ("displacement", "velocity")

    displacement: Annotated[Annotated[Positive, Unit("m")] | None, Label("drive displacement", "X")] = None
    """Amplitude of a prescribed harmonic displacement; with `frequency`."""
    force: Annotated[Annotated[Positive, Unit("N")] | None, Label("drive force", "F_d")] = None
    """Amplitude of a harmonic force on the bead; with `frequency`."""
    frequency: Annotated[Annotated[Positive, Unit("Hz")] | None, Label("drive frequency", "f")] = None
    """Frequency f, in cycles per unit time."""
    phase: Phase = 0.0
    """Phase; with -90 the bead starts at rest and moves towards higher bead numbers."""
    velocity: Annotated[Velocity | None, Label("piston velocity")] = None
    """Constant velocity of a piston, positive towards higher bead numbers."""
    until: Time | None = None
    """Time at which a constant velocity ends; never if omitted."""
    table: tuple[tuple[Time, Annotated[Size, Unit(_second_unit)]], ...] | None = None
    """Points [time, displacement] or [time, velocity]; or the name of a CSV file beside the scene, whose first line
    names the columns."""
    quantity: Literal["displacement", "velocity"] | None = None
    """Second column of the table: `displacement`, a cubic spline between points and at rest outside; or `velocity`,
    linear between points, 0 before them and constant after them."""

    @field_validator("table", mode="before")
    @classmethod
    def _points(cls, value: Any) -> Any:
        return _points(value, cls.columns)

    @field_validator("table")
    @classmethod
    def _moves(cls, value: tuple[tuple[float, float], ...] | None) -> tuple[tuple[float, float], ...] | None:
        if value is not None:
            _refuse_points(value)
            if not any(second for _, second in value):
                raise ValueError("has no motion")
        return value

    @field_serializer("table", when_used="json-unless-none")
    def _lines_if_long(self, value: tuple[tuple[float, float], ...]) -> Any:
        return _lines_if_long(value)

    @model_serializer(mode="wrap")
    def _without_phase(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Keys, without the phase of a motion that is not harmonic."""
        return {key: value for key, value in handler(self).items() if key != "phase" or self.frequency is not None}

    @model_validator(mode="after")
    def _of_a_kind(self) -> Self:
        keys = {"displacement": "frequency", "force": "frequency", "velocity": "", "table": "quantity"}
        kinds = [key for key in keys if getattr(self, key) is not None]
        if len(kinds) != 1:
            reason = f"{' and '.join(kinds)} are given" if kinds else "none is given"
            raise ValueError(f"displacement: give either displacement, force, velocity or table ({reason})")
        (kind,) = kinds
        if (needed := keys[kind]) and getattr(self, needed) is None:
            why = "a harmonic drive" if needed == "frequency" else "a table without names of its columns"
            valid = "" if needed == "frequency" else ", displacement or velocity"
            raise ValueError(f"{needed}: is missing; {why} needs it{valid}")
        for key, owners in _BESIDE.items():
            if getattr(self, key) not in (None, 0.0) and kind not in owners:
                raise ValueError(f"{key}: goes with {' or '.join(owners)} only; leave it out with {kind}")
        return self

    @model_validator(mode="after")
    def _of_a_motion(self) -> Self:
        if self.velocity is not None and abs(self.velocity) < _LEAST:
            raise ValueError(f"velocity: a piston needs a velocity (at least {_LEAST:g}) ({self.velocity:g} given)")
        begin = self._begin
        if self.until is not None and not self.until > begin:
            raise ValueError(f"until: must be later than the start at {begin:g} ({self.until:g} given)")
        if self.table is not None and self.quantity == "displacement" and self.table[0][1] != 0.0:
            time, displacement = self.table[0]
            raise ValueError(
                f"table: must begin with a displacement of 0, as the bead is at its place until then, here with "
                f"{displacement:g} at time {time:g}"
            )
        return self

    @property
    def _begin(self) -> float:
        """Time of the start of a piston."""
        return getattr(self, "from") or 0.0

    @property
    def _prescribes(self) -> str:
        """Key that prescribes the motion; empty of a force."""
        return next((key for key in ("displacement", "velocity", "table") if getattr(self, key) is not None), "")

    def refuse(self, setting: Setting) -> None:
        """Refuse a bead outside the array, too, and a kick of a bead whose motion is given."""
        super().refuse(setting)
        if self._prescribes and any((kick.chain, kick.bead) == (self.chain, self.bead) for kick in setting.kicks):
            key = setting.key_of(self)
            raise ValueError(f"{key}.{self._prescribes}: prescribes the motion of the bead; drive or kick another")

    def refuse_system(self, setting: Setting, system: System) -> None:
        """Refuse a force on a bead whose motion is given, which would have no effect."""
        if self._prescribes and (self.chain, self.bead) in [(load.chain, load.bead) for load in system.loads]:
            key = setting.key_of(self)
            raise ValueError(
                f"{key}.{self._prescribes}: bead {self.bead} of chain {self.chain} is pushed, too, which has no effect "
                "on a prescribed motion; leave one of them out"
            )

    def lacks(self, setting: Setting) -> frozenset[Fact]:  # noqa: ARG002
        """Facts that do not hold: time matters, no pulse leads, and what moves a bead takes up any momentum."""
        taken = {Fact.FRONT, Fact.REVERSIBLE}
        if self.frequency is not None:
            taken.add(Fact.PULSE)
        if self._prescribes:
            taken.add(Fact.MOMENTUM)
        return frozenset(taken)

    def speed(self, mass: float) -> float:
        """Largest velocity of the bead's motion; of a free bead under the force, about its mean."""
        if self.force is not None:
            return self.force / (mass * self._omega)
        return abs(self._motion(1.0, 1.0).fastest)

    def loads(self, setting: Setting) -> tuple[Load, ...]:
        """The force, dimensionless."""
        if self.force is None:
            return ()
        law = in_time.sine(self.force / setting.scale.force, self._omega * setting.scale.time, math.radians(self.phase))
        return (Load(self.chain, self.bead, law),)

    def motions(self, setting: Setting) -> tuple[Motion, ...]:
        """The motion, dimensionless."""
        if self.force is not None:
            return ()
        return (Motion(self.chain, self.bead, (self._motion(setting.scale.time, setting.scale.length),)),)

    def _motion(self, time: float, length: float) -> TimeLaw:
        """Law of the motion, in these units of time and length."""
        if self.displacement is not None:
            return in_time.Oscillation(self.displacement / length, self._omega * time, math.radians(self.phase))
        if self.velocity is not None:
            end = math.inf if self.until is None else self.until
            return in_time.constant_velocity(self.velocity * time / length, self._begin / time, end / time)
        points: NDArray[np.float64] = np.array(self.table)
        if self.quantity == "velocity":
            return in_time.of_velocity(points[:, 0] / time, points[:, 1] * (time / length))
        return in_time.of_displacement(points[:, 0] / time, points[:, 1] / length)

    @property
    def _omega(self) -> float:
        return 2.0 * math.pi * (self.frequency or 0.0)


_BESIDE = {
    "frequency": ("displacement", "force"),
    "phase": ("displacement", "force"),
    "from": ("velocity",),
    "until": ("velocity",),
    "quantity": ("table",),
}
"""Keys of a drive -> those that they go with."""


def _read(path: Path, key: str, columns: tuple[str, ...]) -> tuple[str, list[list[float]]]:
    """Name of the second column of a CSV file, empty where there is none, and its points: two numbers a line."""
    content = table_text(path, f"a {key}", MOST_BYTES)
    try:
        return _points_of(content, f"{path}:", columns)
    except ValueError as error:
        raise InputError(str(error)) from None


def _points_of(content: str, place: str, columns: tuple[str, ...]) -> tuple[str, list[list[float]]]:
    """Name of the second column in lines of text, empty where there is none, and points: two numbers a line.

    Raises:
        ValueError: a line that is none, or whose time is not later; its number follows ``place``.
    """
    points: list[list[float]] = []
    head = ""
    for number, row in enumerate(content.splitlines(), 1):
        words = [word.strip() for word in row.replace(";", ",").split(",")]
        if words == [""]:
            continue
        try:
            time, value = map(float, words)
            if not (math.isfinite(time) and math.isfinite(value)):
                raise ValueError
        except ValueError:
            if number == 1:
                head = words[1] if len(words) > 1 else ""
                continue
            needed = f"two numbers are needed, time and {' or '.join(columns)}"
            raise ValueError(f"{place}{number}: {row[:40]!r} found; {needed}") from None
        if points and not time > points[-1][0]:
            raise ValueError(f"{place}{number}: times must increase; {time:g} follows {points[-1][0]:g}")
        points.append([time, value])
    return head, points
