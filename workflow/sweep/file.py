"""A sweep file: a scene, and lists or ranges of any of its fields.

::

    scene: two-chains              # a name, a file (from this file's directory on), or the scene itself
    vary:
      coupling.stiffness: [0.05, 0.1, 0.2]
      kick.velocity: {from: 0.1, to: 10, count: 5, spacing: log}
      # whole numbers: {from: 2, to: 8} is each of them
    combine: product               # or zip: the first values together, then the second, ...
    engine: lammps                 # or reference, ...
"""

import hashlib
import itertools
import json
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, Field, PlainValidator, model_validator

from lammps_inputs import InputError, Scene, library, schema, strict_yaml
from lammps_inputs.numbers import text
from workflow.engines.registry import EngineName
from workflow.sweep import fields
from workflow.sweep.file_parts import FilePart, Number, number, scene_in, scene_of_file, validated

MAX_CASES = 100_000


class SpacedValues(FilePart):
    """Evenly spaced values, or evenly spaced logarithms, both ends among them."""

    first: Annotated[Any, PlainValidator(number), Field(alias="from")]
    last: Annotated[Any, PlainValidator(number), Field(alias="to")]
    count: Annotated[int, Field(ge=2, le=MAX_CASES)] | None = None
    """Number of values; None for all whole numbers between the ends."""
    spacing: Literal["linear", "log"] = "linear"
    digits: Annotated[int, Field(ge=1, le=15)] = 15
    """Significant digits that the values between the ends are rounded to."""

    @model_validator(mode="after")
    def _fits_together(self) -> Self:
        if self.first == self.last:
            raise ValueError("to: is the same as from; give the one value as a list")
        if self.count is None:
            if not (isinstance(self.first, int) and isinstance(self.last, int)) or self.spacing == "log":
                raise ValueError("count: is missing; it may be left out between whole numbers, evenly spaced")
            if abs(self.last - self.first) >= MAX_CASES:
                raise ValueError(f"to: too far from `from` for every whole number ({MAX_CASES} at most); give a count")
        if self.spacing == "log" and min(self.first, self.last) <= 0:
            raise ValueError("spacing: log needs from and to above 0")
        return self

    def __len__(self) -> int:
        return abs(self.last - self.first) + 1 if self.count is None else self.count

    def values(self) -> list[Number]:
        """The values from first to last; whole numbers where both ends are and the values come out whole."""
        if self.count is None:
            step = 1 if self.last > self.first else -1
            return list(range(self.first, self.last + step, step))
        first, last = Fraction(repr(self.first)), Fraction(repr(self.last))
        between: list[float] = []
        for k in range(1, self.count - 1):
            part = Fraction(k, self.count - 1)
            if self.spacing == "linear":
                value = float(first + part * (last - first))
            else:
                value = float(self.first) * (float(self.last) / float(self.first)) ** float(part)
            between.append(float(f"{value:.{self.digits}g}"))
        if isinstance(self.first, int) and isinstance(self.last, int) and all(value.is_integer() for value in between):
            return [self.first, *map(int, between), self.last]
        return [self.first, *between, self.last]


def _some(value: dict[str, Any]) -> dict[str, Any]:
    if not value:
        raise ValueError("names no field; `granchain run` runs a single scene")
    return value


class _File(FilePart):
    scene: Any
    vary: Annotated[dict[str, Any], AfterValidator(_some)]
    combine: Literal["product", "zip"] = "product"
    engine: EngineName = "lammps"


def schema_of_file() -> dict[str, Any]:
    """JSON schema of a sweep file; what it says of a scene may lack what is varied."""
    document, scene = schema.of(_File, "sweep"), scene_of_file()
    document["$defs"] = scene.pop("$defs") | {"SpacedValues": schema.of(SpacedValues, "range")}
    document["properties"]["scene"] = {"anyOf": [{"type": "string"}, scene]}
    document["properties"]["vary"] = {
        "type": "object",
        "additionalProperties": {"anyOf": [{"type": "array"}, {"$ref": "#/$defs/Range"}]},
    }
    return document


@dataclass(frozen=True)
class Sweep:
    """A sweep file that was read: what its cases are made of.

    Attributes:
        source: the file, for messages.
        scene: plain data of the scene that the cases start from.
        vary: field -> its values, ordered by field, so that the order in the file does not matter.
        combine: "product" or "zip".
        engine: what computes.
    """

    source: str
    scene: dict[str, Any]
    vary: dict[str, list[Any]]
    combine: Literal["product", "zip"]
    engine: str

    def plain(self) -> dict[str, Any]:
        """Plain data of a sweep file that makes the same cases."""
        return {"scene": self.scene, "vary": self.vary, "combine": self.combine, "engine": self.engine}


def load(path: Path) -> Sweep:
    """Read a sweep file; its cases are not looked at yet.

    Raises:
        InputError: naming the file, the key, what was given and what would be right.
    """
    return from_plain(strict_yaml.load(path, "a sweep needs a `scene` and what to `vary`"), path)


def from_plain(data: dict[str, Any], path: Path) -> Sweep:
    """A sweep from nested plain data that stood in a file.

    Raises:
        InputError: as `load`.
    """
    file = validated(_File, data, f"{path}: ", "sweep")
    scene = scene_in(file.scene, path)
    names = sorted(file.vary)
    names_by_keys: dict[fields.Path, str] = {}
    for name in names:
        try:
            keys = tuple((key, number or 1) for key, number in fields.parse(name, scene))
        except InputError as error:
            raise InputError(f"{path}: vary: {error}") from None
        if keys in names_by_keys:
            raise InputError(f"{path}: vary.{name}: is the same field as `{names_by_keys[keys]}`")
        names_by_keys[keys] = name
        above = next((other for other in names if name.startswith((f"{other}.", f"{other}["))), None)
        if above is not None:
            raise InputError(f"{path}: vary.{name}: lies within `{above}`, which is varied too")
    varied = {name: _values_or_range(file.vary[name], f"{path}: vary.{name}") for name in names}
    _refuse_too_many({name: len(values) for name, values in varied.items()}, file.combine, path)
    return Sweep(
        source=str(path),
        scene=scene,
        vary={name: values.values() if isinstance(values, SpacedValues) else values for name, values in varied.items()},
        combine=file.combine,
        engine=file.engine,
    )


def _values_or_range(entry: Any, where: str) -> list[Any] | SpacedValues:
    if isinstance(entry, list):
        if not entry:
            raise InputError(f"{where}: is an empty list")
        return entry
    if not isinstance(entry, dict):
        raise InputError(f"{where}: should be a list, or a range such as {{from: 1, to: 10, count: 4}}")
    return validated(SpacedValues, entry, f"{where}.")


def _refuse_too_many(counts: dict[str, int], combine: str, path: Path) -> None:
    """Refuse more cases than `MAX_CASES`, and lists of unequal length for zip, before any case is built."""
    if combine == "zip" and len(set(counts.values())) > 1:
        counted = ", ".join(f"{field} has {count}" for field, count in counts.items())
        raise InputError(f"{path}: vary: zip needs as many values of each field ({counted})")
    count = math.prod(counts.values()) if combine == "product" else max(counts.values())
    if count > MAX_CASES:
        raise InputError(f"{path}: vary: makes {count} cases; at most {MAX_CASES}")


# --- cases ------------------------------------------------------------------------------------------------------------

LONGEST_NAME = 150
"""Largest length in characters; file systems take 255, and names of figures and temporary files are longer."""

_LONGEST_VALUE = 40
_FEW_DIGITS, _EXACT, _LARGEST = 6, 17, 10**300
_WORD = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]*")


@dataclass(frozen=True)
class SweepCase:
    """One case.

    Attributes:
        name: of its directory; depends on the fields and values of this case alone, unless a value of another case has
            the same first digits.
        values: field -> value.
    """

    name: str
    values: dict[str, Any]


def all_cases(sweep: Sweep) -> list[SweepCase]:
    """Every case, each checked to be a scene.

    Raises:
        InputError: two of the same name, or one that is no scene, by name.
    """
    cases, names = [], set()
    columns = list(sweep.vary.values())
    digits = {field: _digits(values) for field, values in sweep.vary.items()}
    for row in itertools.product(*columns) if sweep.combine == "product" else zip(*columns, strict=True):
        values = dict(zip(sweep.vary, row, strict=True))
        case = SweepCase(case_name(values, digits), values)
        if case.name in names:
            raise InputError(f"{sweep.source}: vary: the case {case.name} is there twice; a value is given twice")
        names.add(case.name)
        scene_of(sweep, case)
        cases.append(case)
    return cases


def scene_of(sweep: Sweep, case: SweepCase) -> Scene:
    """The scene of a case.

    Raises:
        InputError: it is none; names the case.
    """
    where = f"{sweep.source}: case {case.name}"
    try:
        scene = fields.put_all(sweep.scene, case.values)
    except InputError as error:
        raise InputError(f"{where}: {error}") from None
    return library.from_plain(scene, where)


def case_name(values: dict[str, Any], digits: Mapping[str, int] = MappingProxyType({})) -> str:
    """``coupling.stiffness=0.05,kick.velocity=0.1``: letters, digits and ``._-+=,``, of bounded length.

    What cannot be written shortly is a fingerprint.

    Args:
        values: field -> value.
        digits: field -> significant digits of its numbers; numbers of other fields read back exactly.
    """
    full = ",".join(
        f"{field.replace('[', '').replace(']', '')}={_written(value, digits.get(field, _EXACT))}"
        for field, value in values.items()
    )
    if len(full) <= LONGEST_NAME:
        return full
    mark = f"..{_fingerprint(full)}"
    return full[: LONGEST_NAME - len(mark)] + mark


def _written(value: Any, digits: int) -> str:
    if value is None:
        return "none"
    if isinstance(value, float) or (isinstance(value, int) and 2**53 <= abs(value) <= _LARGEST):
        return text(float(f"{value:.{digits}g}") + 0.0)  # zero has no sign
    plain = str(value) if isinstance(value, int | str) else ""
    short = len(plain) <= _LONGEST_VALUE and (isinstance(value, int) or _WORD.fullmatch(plain))
    return plain if short else _fingerprint(json.dumps(value, sort_keys=True))


def _digits(values: list[Any]) -> int:
    """Significant digits that keep the numbers of a field apart, at least `_FEW_DIGITS`."""
    numbers = {value for value in values if isinstance(value, int | float) and abs(value) <= _LARGEST}
    for digits in range(_FEW_DIGITS, _EXACT):
        if len({f"{value:.{digits}g}" for value in numbers}) == len(numbers):
            return digits
    return _EXACT


def _fingerprint(words: str) -> str:
    return hashlib.sha256(words.encode()).hexdigest()[:10]
