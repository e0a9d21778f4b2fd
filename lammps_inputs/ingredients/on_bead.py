"""What acts on a single bead from outside, from the start on: pushes and harmonic drives.

A push is a force over time, of a hammer or as a sensor recorded it. A drive moves a bead to and fro, or pushes and
pulls it, without end: a shaker, a piezo actuator.
"""

import itertools
import math
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, field_serializer, field_validator, model_validator

from lammps_inputs.errors import InputError
from lammps_inputs.facts import Fact
from lammps_inputs.ingredients.base import Count, Ingredient, NotNegative, Phase, Positive, Setting, refuse_outside
from lammps_inputs.laws.in_time import MOST_IN_FORMULA, HalfSine, Rectangular, Sine, TimeLaw, make_table
from lammps_inputs.loads import Load, Motion
from lammps_inputs.system import System
from lammps_inputs.units import Label, Unit

Time = Annotated[NotNegative, Unit("s")]
Force = Annotated[float, Field(ge=-1e30, le=1e30), Unit("N")]
Point = tuple[Time, Force]

MOST_POINTS = 100_000

_SHAPES: dict[str, type[HalfSine] | type[Rectangular]] = {"half-sine": HalfSine, "rectangular": Rectangular}


MOST_BYTES = 16 << 20
"""Of a table in a file; `MOST_POINTS` take a fraction of that."""


class OnBead(Ingredient):
    """What acts on one bead from outside, as long as it lasts."""

    key: ClassVar[str]
    several: ClassVar[bool] = True
    why: ClassVar[dict[Fact, str]] = {
        Fact.FRONT: "a window would take the bead that it acts on to its head",
        Fact.REVERSIBLE: "suzuki4 steps back in time within each cycle",
    }

    chain: Count = 1
    """Chain of the bead."""
    bead: Count = 1
    """Number of the bead."""

    def refuse(self, setting: Setting) -> None:
        """Refuse a bead outside the array."""
        refuse_outside(setting.key_of(self), self, setting.chains, setting.beads)


class Push(OnBead):
    """A force on one bead, towards higher bead numbers when positive: of a shape, or from a table."""

    example: ClassVar[str] = "{peak: 0.5, duration: 3, shape: half-sine}"

    key = "push"

    peak: Annotated[Force | None, Label("peak force of the push")] = None
    """Largest force, positive towards higher bead numbers; with `duration` and `shape`."""
    duration: Annotated[Positive, Unit("s")] | None = None
    """Time from the start to the end of the force."""
    shape: Literal["half-sine", "rectangular"] | None = None
    """Shape of the force over time."""
    table: tuple[Point, ...] | None = None
    """Points [time, force], linear in between and 0 outside; or the name of a CSV file beside the scene."""

    @classmethod
    def from_files(cls, value: Any, folder: Path) -> Any:
        """Content of a scene's file, with the points of a table that it names.

        Raises:
            InputError: the table cannot be read; names the file and the line.
        """
        if isinstance(value, list):
            return [cls.from_files(part, folder) for part in value]
        if isinstance(value, dict) and isinstance(value.get("table"), str) and "\n" not in value["table"]:
            return {**value, "table": _read(folder / value["table"])}
        return value

    @field_validator("table", mode="before")
    @classmethod
    def _points(cls, value: Any) -> Any:
        if isinstance(value, str) and "\n" in value:
            value = _points_of(value, "line ")
        if isinstance(value, str):
            raise ValueError("should be a list of points [time, force]; a file's name may stand in a scene's file only")
        if isinstance(value, list):
            return tuple(tuple(point) if isinstance(point, list) else point for point in value)
        return value

    @field_validator("table")
    @classmethod
    def _drawable(cls, value: tuple[Point, ...] | None) -> tuple[Point, ...] | None:
        if value is None:
            return value
        if not 2 <= len(value) <= MOST_POINTS:
            raise ValueError(f"has {len(value)} points; 2 to {MOST_POINTS} are needed")
        for (before, _), (after, _) in itertools.pairwise(value):
            if not after > before:
                raise ValueError(f"times must increase; {after:g} follows {before:g}")
        jumps = [point for point in (value[0], value[-1]) if point[1] != 0.0 and (point is value[-1] or point[0] > 0.0)]
        if jumps:
            time, force = jumps[0]
            rule = "must begin (unless at time 0) and end with a force of 0"
            raise ValueError(f"{rule}, or the force would jump, here by {force:g} at time {time:g}")
        if not any(force for _, force in value):
            raise ValueError("has no force")
        return value

    @field_serializer("table", when_used="json-unless-none")
    def _lines_if_long(self, value: tuple[Point, ...]) -> Any:
        """Points of a long table as lines of text, which are read a hundred times faster than lists."""
        if len(value) <= MOST_IN_FORMULA:
            return value
        return "".join(f"{time!r}, {force!r}\n" for time, force in value)

    @model_validator(mode="after")
    def _of_a_shape_or_a_table(self) -> Self:
        shaped = {"peak": self.peak, "duration": self.duration, "shape": self.shape}
        named = [key for key, part in shaped.items() if part is not None]
        if self.table is not None and named:
            raise ValueError(f"{named[0]}: give either a table or peak, duration and shape (both are given)")
        if self.table is None and len(named) < len(shaped):
            missing = next(key for key in shaped if key not in named)
            raise ValueError(f"{missing}: is missing; a push needs peak, duration and shape, or a table")
        if self.peak is not None and abs(self.peak) < 1e-30:
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
            return make_table(points[:, 0] / time, points[:, 1] / force)
        assert self.peak is not None
        assert self.duration is not None
        assert self.shape is not None
        return _SHAPES[self.shape](self.peak / force, self.duration / time)


class Drive(OnBead):
    """``displacement * (sin(2 pi frequency t + phase) - sin(phase))``, or a force ``force * sin(...)``, of one bead."""

    example: ClassVar[str] = "{displacement: 0.1, frequency: 0.05}"
    sources = ("coste1997",)

    key = "drive"

    displacement: Annotated[Annotated[Positive, Unit("m")] | None, Label("drive displacement", "X")] = None
    """Amplitude of the prescribed displacement; or give `force`."""
    force: Annotated[Annotated[Positive, Unit("N")] | None, Label("drive force", "F_d")] = None
    """Amplitude of the force on the bead; or give `displacement`."""
    frequency: Annotated[Positive, Unit("Hz"), Label("drive frequency", "f")]
    """Frequency f, in cycles per unit time."""
    phase: Phase = 0.0
    """Phase; with -90 the bead starts at rest and moves towards higher bead numbers."""

    @model_validator(mode="after")
    def _one_of_the_two(self) -> Self:
        if (self.displacement is None) == (self.force is None):
            reason = "neither is given" if self.force is None else "both are given"
            raise ValueError(f"displacement: give either displacement or force ({reason})")
        return self

    def refuse(self, setting: Setting) -> None:
        """Refuse a bead outside the array, too, and what does not go with motion for ever."""
        super().refuse(setting)
        if self.displacement is not None and any(
            (kick.chain, kick.bead) == (self.chain, self.bead) for kick in setting.kicks
        ):
            key = setting.key_of(self)
            raise ValueError(f"{key}.displacement: prescribes the motion of the bead; drive or kick another")

    def refuse_system(self, setting: Setting, system: System) -> None:
        """Refuse what else would move a bead whose motion is given."""
        if self.displacement is None:
            return
        places = [(load.chain, load.bead) for load in system.loads]
        places += [(motion.chain, motion.bead) for motion in system.motions]
        if places.count((self.chain, self.bead)) > 1:
            key = setting.key_of(self)
            raise ValueError(
                f"{key}.displacement: bead {self.bead} of chain {self.chain} is moved or pushed otherwise, too; leave "
                "one of them out"
            )

    def lacks(self, setting: Setting) -> frozenset[Fact]:  # noqa: ARG002
        """Facts that do not hold: no pulse leads, time matters, and what moves a bead takes up any momentum."""
        taken = {Fact.PULSE, Fact.FRONT, Fact.REVERSIBLE}
        return frozenset(taken if self.displacement is None else {*taken, Fact.MOMENTUM})

    def speed(self, mass: float) -> float:
        """Largest velocity of the bead's motion; of a free bead under the force, about its mean."""
        if self.displacement is not None:
            return self.displacement * self._omega
        return (self.force or 0.0) / (mass * self._omega)

    def loads(self, setting: Setting) -> tuple[Load, ...]:
        """The force, dimensionless."""
        if self.force is None:
            return ()
        law = Sine(self.force / setting.scale.force, self._omega * setting.scale.time, math.radians(self.phase))
        return (Load(self.chain, self.bead, law),)

    def motions(self, setting: Setting) -> tuple[Motion, ...]:
        """The motion, dimensionless."""
        if self.displacement is None:
            return ()
        amplitude, omega = self.displacement / setting.scale.length, self._omega * setting.scale.time
        return (Motion(self.chain, self.bead, amplitude, omega, math.radians(self.phase)),)

    @property
    def _omega(self) -> float:
        return 2.0 * math.pi * self.frequency


def _read(path: Path) -> list[list[float]]:
    """Points in a CSV file: two numbers a line; a first line of names is passed over."""
    try:
        with path.open("rb") as file:
            raw = file.read(MOST_BYTES + 1)
        content = raw.decode("utf-8-sig")
    except (OSError, ValueError) as error:
        why = (error.strerror if isinstance(error, OSError) else None) or "it is not a text file"
        raise InputError(f"{path}: the table of a push cannot be read: {why}") from None
    if len(raw) > MOST_BYTES:
        raise InputError(f"{path}: the table of a push cannot be read: it is larger than {MOST_BYTES >> 20} MiB")
    try:
        return _points_of(content, f"{path}:")
    except ValueError as error:
        raise InputError(str(error)) from None


def _points_of(content: str, place: str) -> list[list[float]]:
    """Points in lines of text: two numbers a line; a first line of names is passed over.

    Raises:
        ValueError: a line that is none; its number follows ``place``.
    """
    points = []
    for number, row in enumerate(content.splitlines(), 1):
        words = [word.strip() for word in row.replace(";", ",").split(",")]
        if words == [""]:
            continue
        try:
            time, force = map(float, words)
            if not (math.isfinite(time) and math.isfinite(force)):
                raise ValueError
        except ValueError:
            if number == 1:
                continue
            raise ValueError(f"{place}{number}: {row[:40]!r} found; two numbers are needed, time and force") from None
        points.append([time, force])
    return points
