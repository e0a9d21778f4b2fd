"""A design file: a scene, what may change in it, and the objective.

::

    scene: two-chains                        # a name, a file (from this file's directory on), or the scene itself
    vary:
      chains: {from: 2, to: 8}               # a number between bounds, whole where the field is
      coupling.stiffness: {from: 0.01, to: 1, spacing: log}
      coupling.rows: {from: 1, to: 40, places: 2}      # a list of numbers, ascending
      walls.right: [bead, rigid]             # one of these
      pattern: {of: [heavy, light], places: 4}         # a list, each place one of these
    minimize: wall_force                     # or maximize
    where:
      mass: {to: 240}                        # from, to or both
    also: [delay]                            # what else to look at; the first makes a front with the objective
    beside: {...}                            # another scene to set the best against
    search: {evaluations: 2000, population: 40, seed: 1}   # no more designs than evaluations are all computed
    manufacture: {spread: 0.01, members: 32} # sizes and stiffnesses of beads, and the numbers above, off by so much
    verify: 3                                # of the best, so many in LAMMPS
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import Field, PlainValidator, model_validator

from granchain import InputError
from granchain.parts import axes, columns, fields, file_parts, schema, strict_yaml

# --- variables --------------------------------------------------------------------------------------------------------

DIGITS = 6
"""Significant digits of what is not whole, so that two that are practically the same are computed once."""


EDGE = 0.003
"""Part of a range from its end that counts as the end: the last stride of the search."""


@dataclass(frozen=True)
class Variable:
    """A field and what may stand there.

    Attributes:
        field: dotted path.
        choices: the field takes one of these; empty for numbers.
        low, high: bounds of a number, both possible.
        log: whether a number is varied by its logarithm.
        integer: whether a number is whole.
        places: number of entries where the field takes a list: choices in any order, or numbers in ascending order.
    """

    field: str
    choices: tuple[Any, ...] = ()
    low: float = 0.0
    high: float = 0.0
    log: bool = False
    integer: bool = False
    places: int | None = None

    @property
    def coordinates(self) -> int:
        """Number of coordinates of the field."""
        return self.places or 1

    @property
    def bounds(self) -> tuple[float, float]:
        """Lower and upper bound of each coordinate."""
        if self.choices:
            return 0.0, float(len(self.choices) - 1)
        return (math.log(self.low), math.log(self.high)) if self.log else (self.low, self.high)

    @property
    def steps(self) -> bool:
        """Whether its coordinates are whole numbers."""
        return bool(self.choices) or self.integer

    @property
    def values(self) -> int | None:
        """Number of different values; None where a number is not whole."""
        if not self.steps:
            return None
        low, high = self.bounds
        each = int(high - low + 1)
        return int(each**self.coordinates)

    def value(self, coordinates: Sequence[float]) -> Any:
        """Value of the field in the scene, from its coordinates."""
        values = [self._one(coordinate) for coordinate in coordinates]
        if self.places is None:
            return values[0]
        return values if self.choices else sorted(values)

    def coordinate(self, value: float) -> float:
        """Coordinate of a value, of a field that holds one number."""
        return math.log(value) if self.log else value

    def _one(self, coordinate: float) -> Any:
        if self.choices:
            return self.choices[round(coordinate)]
        if self.integer:
            return round(coordinate)
        value = math.exp(coordinate) if self.log else float(coordinate)
        return min(max(float(f"{value:.{DIGITS}g}"), self.low), self.high)

    def bound(self, value: Any) -> str:
        """``from`` or ``to`` where a number, or one of a list, is at the end of its range; else empty."""
        if self.choices:
            return ""
        low, high = self.bounds
        edge = 0.0 if self.integer else EDGE * (high - low)
        entries = value if isinstance(value, list) else [value]
        at = [math.log(entry) if self.log else entry for entry in entries]
        return "from" if min(at) <= low + edge else "to" if max(at) >= high - edge else ""


def values_of(variables: Sequence[Variable], vector: Sequence[float]) -> dict[str, Any]:
    """Field -> value, from a vector of all coordinates."""
    values, start = {}, 0
    for variable in variables:
        values[variable.field] = variable.value(list(vector[start : start + variable.coordinates]))
        start += variable.coordinates
    return values


# --- file -------------------------------------------------------------------------------------------------------------

MOST_PLACES = 64


class Search(file_parts.FilePart):
    """Settings of the search."""

    evaluations: Annotated[int, Field(ge=20, le=10_000_000)] = 2000
    """Largest number of designs of a search; where no more exist, all are computed."""
    population: Annotated[int, Field(ge=8, le=10_000)] | None = None
    """Designs of one generation; by default five for every coordinate, 20 to 100."""
    seed: Annotated[int, Field(ge=0, le=2**31 - 1)] = 1


class Manufacture(file_parts.FilePart):
    """How an ensemble with manufacturing errors is drawn: relative spread of the fields, number of members."""

    spread: Annotated[float, Field(gt=0, le=0.5)] = 0.01
    members: Annotated[int, Field(ge=2, le=10_000)] = 32


class Limit(file_parts.FilePart):
    """Bounds of a quantity."""

    low: Annotated[Any, Field(alias="from")] = None
    high: Annotated[Any, Field(alias="to")] = None

    @model_validator(mode="after")
    def _is_a_bound(self) -> Self:
        if self.low is None and self.high is None:
            raise ValueError("give from, to or both")
        for bound in (self.low, self.high):
            if bound is not None:
                file_parts.number(bound)
        if self.low is not None and self.high is not None and self.high < self.low:
            raise ValueError(f"goes from {self.low} to {self.high}; the smaller first")
        return self

    def violation(self, value: float | None) -> float:
        """Distance of a value beyond a bound over the size of the bound; 0 within the bounds, 1 where undefined."""
        if value is None:
            return 1.0
        below = 0.0 if self.low is None else max(0.0, self.low - value) / max(abs(self.low), 1e-12)
        above = 0.0 if self.high is None else max(0.0, value - self.high) / max(abs(self.high), 1e-12)
        return float(max(below, above))


class File(file_parts.FilePart):
    """The keys of a design file."""

    scene: Any
    vary: dict[str, Any]
    minimize: str | None = None
    maximize: str | None = None
    where: dict[str, Limit] = Field(default={})
    also: list[str] = Field(default=[])
    beside: Any = None
    search: Search = Search()
    manufacture: Manufacture = Manufacture()
    verify: Annotated[int, Field(ge=1, le=100)] = 3


Places = Annotated[int, Field(ge=1, le=MOST_PLACES)]


class _Bounds(file_parts.FilePart):
    """A number, or a list of so many."""

    low: Annotated[Any, PlainValidator(file_parts.number), Field(alias="from", json_schema_extra={"type": "number"})]
    high: Annotated[Any, PlainValidator(file_parts.number), Field(alias="to", json_schema_extra={"type": "number"})]
    spacing: Literal["linear", "log"] = "linear"
    places: Places | None = None

    @model_validator(mode="after")
    def _fits_together(self) -> Self:
        if self.high <= self.low:
            raise ValueError(f"to: {self.high} given, and from: {self.low}; the smaller first")
        if self.spacing == "log" and self.low <= 0:
            raise ValueError("spacing: log needs from and to above 0")
        return self


class _Choices(file_parts.FilePart):
    """A list of so many choices."""

    of: list[Any]
    places: Places


@dataclass(frozen=True)
class Design:
    """A design file that was read.

    Attributes:
        source: the file, for messages.
        scene: plain data of the scene to begin with.
        variables: the varied fields.
        beside: plain data of a scene to compare with, or None.
        request: the keys of the file.
    """

    source: str
    scene: dict[str, Any]
    variables: tuple[Variable, ...]
    beside: dict[str, Any] | None
    request: File

    @property
    def objective(self) -> str:
        """The quantity to minimise or maximise."""
        return self.request.minimize or self.request.maximize or ""

    @property
    def sign(self) -> float:
        """1 to make it small, -1 to make it large."""
        return 1.0 if self.request.minimize else -1.0

    @property
    def names(self) -> tuple[str, ...]:
        """The objective, the quantities with limits, and the further quantities."""
        return tuple(dict.fromkeys((self.objective, *self.request.where, *self.request.also)))

    def heading(self, name: str) -> str:
        """A varied field or a quantity with its unit, for tables."""
        return axes.heading(name, self.scene)

    def broken(self, quantities: Mapping[str, float | None]) -> list[str]:
        """Computed quantities that are outside their limits or undefined."""
        limits = self.request.where
        return [name for name in limits if name in quantities and limits[name].violation(quantities[name]) > 0.0]

    @property
    def count(self) -> int | None:
        """Number of different designs; None where some number is not whole."""
        each = [variable.values for variable in self.variables]
        return None if None in each else math.prod(size or 0 for size in each)

    @property
    def exhaustive(self) -> bool:
        """Whether every design is computed, since there are no more than evaluations."""
        return self.count is not None and self.count <= self.request.search.evaluations

    @property
    def population(self) -> int:
        """Number of designs in a generation: the one given, else five a coordinate, 20 to 100."""
        coordinates = sum(variable.coordinates for variable in self.variables)
        return self.request.search.population or min(100, max(20, 5 * coordinates))


def load(path: Path) -> Design:
    """Read a design file.

    Raises:
        InputError: a key of the file is invalid; the message names the file, the key and what is valid.
    """
    needed = "a design needs a `scene`, what may `vary`, and what to `minimize` or `maximize`"
    return from_plain(strict_yaml.load(path, needed), path)


def schema_of_file() -> dict[str, Any]:
    """JSON schema of a design file, in whose scene the varied fields may be missing."""
    file_schema, scene = schema.of(File, "design"), file_parts.scene_of_file()
    file_schema["$defs"] |= scene.pop("$defs") | {
        kind.__name__[1:]: schema.of(kind, "field") for kind in (_Bounds, _Choices)
    }
    spot: dict[str, Any] = {"anyOf": [{"type": "string"}, scene]}
    quantity = {
        "anyOf": [
            {"enum": list(columns.KNOWN)},
            {"type": "string", "pattern": f"^({'|'.join(columns.AT_BEAD)})@[1-9][0-9]*$"},
        ]
    }
    varied = [{"type": "array", "minItems": 2}, {"$ref": "#/$defs/Bounds"}, {"$ref": "#/$defs/Choices"}]
    file_schema["properties"] |= {
        "scene": spot,
        "beside": spot,
        "vary": {"type": "object", "minProperties": 1, "additionalProperties": {"anyOf": varied}},
        "minimize": quantity,
        "maximize": quantity,
        "also": {"type": "array", "items": quantity},
    }
    file_schema["properties"]["where"]["propertyNames"] = quantity
    return file_schema


def from_plain(data: Any, path: Path) -> Design:
    """Read the plain data of a design file; paths in it are relative to that file's directory.

    Raises:
        InputError: see `load`.
    """
    file = file_parts.validated(File, data, f"{path}: ", "design")
    if (file.minimize is None) == (file.maximize is None):
        raise InputError(f"{path}: give either minimize or maximize, and a quantity: {', '.join(columns.KNOWN)}")
    objectives = {key: [name] for key in ("minimize", "maximize") if (name := getattr(file, key)) is not None}
    for key, names in {**objectives, "where": file.where, "also": file.also}.items():
        for name in names:
            columns.refuse_unknown(name, f"{path}: {key}", "quantity")
    if not file.vary:
        raise InputError(f"{path}: vary: names no field")
    scene = file_parts.scene_in(file.scene, path, "scene")
    return Design(
        source=str(path),
        scene=scene,
        variables=tuple(_variable(name, entry, path, scene) for name, entry in file.vary.items()),
        beside=None if file.beside is None else file_parts.scene_in(file.beside, path, "beside"),
        request=file,
    )


def _variable(name: str, entry: Any, path: Path, scene: dict[str, Any]) -> Variable:
    where = f"{path}: vary.{name}"
    try:
        keys = fields.parse(name, scene)
    except InputError as error:
        raise InputError(f"{path}: vary: {error}") from None
    single = isinstance(entry, list)
    entry = {"of": entry, "places": 1} if single else entry
    if not isinstance(entry, dict):
        raise InputError(f"{where}: should be bounds such as {{from: 1, to: 10}}, or a list of choices")
    if "of" in entry:
        choices = file_parts.validated(_Choices, entry, f"{where}.")
        if len(choices.of) < 2:
            raise InputError(f"{where}: needs two choices or more")
        return Variable(name, choices=tuple(choices.of), places=None if single else choices.places)
    read = file_parts.validated(_Bounds, entry, f"{where}.")
    integer = fields.is_whole(keys)
    if integer and not all(isinstance(end, int) for end in (read.low, read.high)):
        raise InputError(f"{where}: takes whole numbers; {read.low} to {read.high} given")
    log = read.spacing == "log" and not integer
    return Variable(name, low=float(read.low), high=float(read.high), log=log, integer=integer, places=read.places)
