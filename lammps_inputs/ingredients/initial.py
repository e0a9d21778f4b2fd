"""Initial states: displacements and velocities of beads at the start, by bead or in a table.

What contacts and springs store at the displacements is part of the energy input.
"""

import hashlib
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Annotated, Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, field_serializer, field_validator, model_validator

from lammps_inputs import physics, plugins, strict_yaml
from lammps_inputs.errors import InputError
from lammps_inputs.facts import Fact
from lammps_inputs.ingredients.base import Count, Ingredient, ScenePart, Setting, refuse_outside, table_text
from lammps_inputs.system import System
from lammps_inputs.units import Label, Unit

Displacement = Annotated[float, Field(ge=-1e30, le=1e30), Unit("m")]
Velocity = Annotated[float, Field(ge=-1e30, le=1e30), Unit("m/s")]
Row = tuple[Count, Count, Displacement, Velocity]

COLUMNS = ("chain", "bead", "displacement", "velocity")
"""Columns of a table, by the names in its first line; one that is missing is 0, and of chains 1."""

MOST_BYTES = 1 << 30
"""Of a table in a file."""

MOST_ROWS_IN_A_LIST = 20
"""Rows of a table up to which a scene's file has them as a list; more are lines of text, which are read faster."""


class LastFrame(ScenePart):
    """Run whose last frame is the initial state: what a scene's file has in place of the name of its directory."""

    directory: str
    """Name of the run's directory."""
    chains: Count
    """Number of chains of the run."""
    beads: Count
    """Number of beads of each chain of the run."""
    time: Annotated[float, Field(ge=0, le=1e30), Unit("s")]
    """Time of the frame in the run."""
    sha256: str
    """Checksum of the rows of `table`."""


class Initial(Ingredient):
    """Displacement and velocity of one bead at the start, those of many in a table, or the last frame of a run."""

    example: ClassVar[str] = "{bead: 1, displacement: 0.6}"
    sources = ("hutzler2004",)
    several: ClassVar[bool] = True
    why: ClassVar[dict[Fact, str]] = {
        Fact.FRONT: "a window begins with beads at rest",
        Fact.PULSE: "beads that are displaced at the start may send out many pulses",
    }

    chain: Count = 1
    """Chain of the bead."""
    bead: Count | None = None
    """Number of the bead; or give a list, `table` or `run`."""
    displacement: Annotated[Displacement | tuple[Displacement, ...] | None, Label("initial displacement", "x_0")] = None
    """Displacement from rest at the start, positive towards higher bead numbers, or a list with that of every bead of
    the chain; 0 if omitted."""
    velocity: Annotated[Velocity | tuple[Velocity, ...] | None, Label("initial velocity", "v_0")] = None
    """Velocity at the start, positive towards higher bead numbers, or a list with that of every bead of the chain; 0 if
    omitted. A kick of the bead adds to it."""
    table: tuple[Row, ...] | None = None
    """Rows [chain, bead, displacement, velocity]; or the name of a CSV file beside the scene with such columns."""
    run: LastFrame | None = None
    """Directory of a finished run, beside the scene, whose last frame is the initial state. The scene in the new run's
    directory holds it in `table`."""

    @classmethod
    def from_files(cls, value: Any, folder: Path) -> Any:
        """Content of a scene's file, with the rows of a table that it names.

        Raises:
            InputError: the table cannot be read; names the file and the line.
        """
        if isinstance(value, list):
            return [cls.from_files(part, folder) for part in value]
        if isinstance(value, dict) and isinstance(value.get("run"), str):
            if "table" in value:
                raise InputError("initial.run: give either a table or a run (both are given)")
            if "run" not in plugins.declared("starts"):
                raise InputError("initial.run: no installed distribution declares `run` as one of granchain.starts")
            return {**value, **plugins.load("starts", "run")(folder / value["run"])}
        if isinstance(value, dict) and isinstance(value.get("table"), str) and "\n" not in value["table"]:
            return {**value, "table": _read(folder / value["table"])}
        return value

    _from_list = field_validator("displacement", "velocity", mode="before")(strict_yaml.as_tuple)

    @field_validator("table", mode="before")
    @classmethod
    def _rows(cls, value: Any) -> Any:
        if isinstance(value, str) and "\n" in value:
            value = rows_of(value, "line ")
        if isinstance(value, str):
            raise ValueError(
                "should be a list of rows [chain, bead, displacement, velocity]; a file's name may stand in a scene's "
                "file only"
            )
        if isinstance(value, list):
            return tuple(tuple(row) if isinstance(row, list) else row for row in value)
        return value

    @field_validator("run", mode="before")
    @classmethod
    def _frame(cls, value: Any) -> Any:
        if isinstance(value, str):
            raise ValueError("the name of a run's directory may stand in a scene's file only")
        return value

    @field_validator("table")
    @classmethod
    def _each_bead_once(cls, value: tuple[Row, ...] | None) -> tuple[Row, ...] | None:
        if value is None:
            return value
        if not value:
            raise ValueError("has no rows")
        named: set[tuple[int, int]] = set()
        for chain, bead, *_ in value:
            if (chain, bead) in named:
                raise ValueError(f"names bead {bead} of chain {chain} twice; give one row for each bead")
            named.add((chain, bead))
        return value

    @field_serializer("table", when_used="json-unless-none")
    def _lines_if_long(self, value: tuple[Row, ...]) -> Any:
        if len(value) <= MOST_ROWS_IN_A_LIST:
            return value
        return _text(value)

    @model_validator(mode="after")
    def _bead_or_table(self) -> Self:
        beside = [key for key in ("bead", "displacement", "velocity") if getattr(self, key) is not None]
        if self.table is not None and beside:
            raise ValueError(f"{beside[0]}: give either a table or one bead (both are given)")
        if self.run is not None and (self.table is None or digest_of(self.table) != self.run.sha256):
            raise ValueError("run: the rows of `table` are not those of the run, by their checksum; name the run again")
        if self._lists and self.bead is not None:
            raise ValueError("bead: give either a list with a value of every bead or one bead (both are given)")
        if len({len(values) for values in self._lists}) > 1:
            raise ValueError("displacement: the lists of displacements and velocities differ in length")
        if self.table is None and self.bead is None and not self._lists:
            raise ValueError("bead: is missing; give the number of a bead, a list of displacements, or a table")
        if self.table is None and not (self.displacement or self.velocity):
            raise ValueError("displacement: is missing; give a displacement, a velocity or both")
        return self

    @property
    def _lists(self) -> list[tuple[float, ...]]:
        """Lists with a value of every bead of the chain."""
        return [values for values in (self.displacement, self.velocity) if isinstance(values, tuple)]

    @property
    def rows(self) -> tuple[Row, ...]:
        """Rows of the table, of the lists, or that of the one bead."""
        if self.table is not None:
            return self.table
        beads = range(1, len(self._lists[0]) + 1) if self._lists else (self.bead or 1,)
        columns = (np.broadcast_to(values or 0.0, len(beads)).tolist() for values in (self.displacement, self.velocity))
        return tuple((self.chain, *row) for row in zip(beads, *columns, strict=True))

    @property
    def stores(self) -> bool:
        """Whether any bead is displaced, by which links store energy."""
        return any(row[2] for row in self.rows)

    def refuse(self, setting: Setting) -> None:
        """Refuse beads outside the array, beads named twice, and displacements where contacts depend on the past."""
        key = setting.key_of(self)
        if self.run is not None and (self.run.chains, self.run.beads) != (setting.chains, setting.beads):
            raise ValueError(
                f"{key}.run: {self.run.directory} has {self.run.chains} x {self.run.beads} beads, and this scene "
                f"{setting.chains} x {setting.beads}"
            )
        if self.bead is not None:
            refuse_outside(key, self, setting.chains, setting.beads)
        if any(len(values) != setting.beads for values in self._lists):
            raise ValueError(f"{key}: has {len(self._lists[0])} values for the {setting.beads} beads of the chain")
        for number, (_, bead, *_) in enumerate(self.table or (), 1):
            if bead > setting.beads:
                raise ValueError(
                    f"{key}.table: row {number}: bead {bead} is outside the array (beads 1 to {setting.beads})"
                )
        before = [part for _, part in setting.named if isinstance(part, Initial)]
        before = before[: next(n for n, part in enumerate(before) if part is self)]
        named = {row[:2] for part in before for row in part.rows}
        for chain, bead, *_ in self.rows:
            if (chain, bead) in named:
                raise ValueError(f"{key}: names bead {bead} of chain {chain}, which an entry before does, too")

    def refuse_system(self, setting: Setting, system: System) -> None:
        """Refuse displacements of contacts with a state, and beads whose motion is given."""
        key = setting.key_of(self)
        if self.stores and physics.contacts_with_state(system):
            raise ValueError(
                f"{key}: displacements would need the past of contacts that yield; give velocities alone, or contacts "
                "that do not yield"
            )
        moved = {(motion.chain, motion.bead) for motion in system.motions}
        for chain, bead, *_ in self.rows:
            if (chain, bead) in moved:
                raise ValueError(f"{key}: the motion of bead {bead} of chain {chain} is given by a drive; name another")

    def lacks(self, setting: Setting) -> frozenset[Fact]:  # noqa: ARG002
        """Facts that do not hold: with displacements no pulse leads; a window begins at rest."""
        return frozenset({Fact.FRONT, *((Fact.PULSE, Fact.REST) if self.stores else ())})

    def speed(self, mass: float) -> float:  # noqa: ARG002
        """Largest velocity."""
        return max(abs(row[3]) for row in self.rows)

    def released(self, setting: Setting, system: System) -> float:  # noqa: ARG002
        """Speed of a bead of the reference mass with the energy of the link that stores most."""
        return physics.released_speed(system)

    def start(self, setting: Setting) -> NDArray[np.float64]:
        """Rows of beads, [row, (chain, bead, displacement, velocity)], dimensionless."""
        return np.array(self.rows) / [1.0, 1.0, setting.scale.length, setting.scale.velocity]


def _text(rows: Iterable[Sequence[Any]]) -> str:
    """Rows as lines of text, below the names of the columns."""
    lines = (f"{chain},{bead},{x!r},{v!r}\n" for chain, bead, x, v in rows)
    return "".join([",".join(COLUMNS) + "\n", *lines])


def digest_of(rows: Iterable[Sequence[Any]]) -> str:
    """Checksum of rows [chain, bead, displacement, velocity], by their text."""
    return hashlib.sha256(_text(rows).encode()).hexdigest()


def _read(path: Path) -> list[list[float]]:
    """Rows of a CSV file."""
    content = table_text(path, "an initial state", MOST_BYTES)
    try:
        return rows_of(content, f"{path}:")
    except ValueError as error:
        raise InputError(str(error)) from None


def rows_of(content: str, place: str) -> list[list[float]]:
    """Rows [chain, bead, displacement, velocity] in lines of text, of which the first has the names of the columns.

    Raises:
        ValueError: a line that is none; its number follows ``place``.
    """
    lines = content.splitlines()
    names = [word.strip() for word in lines[0].replace(";", ",").split(",")] if lines else []
    if not set(names) <= set(COLUMNS) or "bead" not in names or len(set(names)) < max(2, len(names)):
        raise ValueError(f"{place}1: {', '.join(names)[:60]!r} found; valid: `{','.join(COLUMNS)}`")
    rows = []
    for number, line in enumerate(lines[1:], 2):
        words = [word.strip() for word in line.replace(";", ",").split(",")]
        if words == [""]:
            continue
        try:
            row = {"chain": 1.0, "displacement": 0.0, "velocity": 0.0} | {
                name: float(word) for name, word in zip(names, words, strict=True) if word
            }
            ordered: list[Any] = [row[name] for name in COLUMNS]
            if not (np.all(np.isfinite(ordered)) and all(value == int(value) >= 1 for value in ordered[:2])):
                raise ValueError
        except (ValueError, KeyError):
            raise ValueError(f"{place}{number}: {line[:60]!r} found; valid: numbers for {', '.join(names)}") from None
        rows.append([int(ordered[0]), int(ordered[1]), *ordered[2:]])
    return rows
