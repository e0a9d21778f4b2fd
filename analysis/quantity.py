"""Quantities: what a field of a result means stands once, in its class; JSON, CSV heads, help and the manual follow.

A result is a frozen dataclass whose fields `declare` a `Quantity`; so may properties, whose docstring is the meaning::

    @result
    class Passage:
        time: float = declare("time of the passage", "time", symbol="t")

        @property
        @derived("time")  # its docstring is the meaning
        def doubled(self) -> float:
            "Twice the time of the passage."

A field that `computed` declares is computed when it is first needed, by a function of the result::

    @result
    class Passages:
        waves: Waves
        last: float = computed("time of the last passage", "time", of=lambda passages: passages.waves.time[-1])

Their values are dimensionless where the unit is one of the scene's, and converted in `in_units`, once.

Plug-ins take this module for what they measure: `result` and `declare` for the class, `plain` for JSON, `csv_of` and
`headings` for tables, `declared` for what its fields mean.

Examples:
    >>> @quantity.result
    ... class Passage:
    ...     time: float = quantity.declare("time of the passage", "time", "the pulse stopped before", symbol="t")
    >>> quantity.plain(Passage(2.0), units.Scale(mass=0.01, length=1e-6, velocity=0.5, si=True))  # in SI
    {'time': 4e-06}
    >>> quantity.declared(Passage)["time"][0].undefined
    'the pulse stopped before'
"""

import csv
import io
import math
import typing
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import MISSING, dataclass, field, fields, is_dataclass, replace
from enum import Enum
from functools import cache, cached_property
from typing import Any, Literal, TypeVar, dataclass_transform

import numpy as np
from numpy.typing import NDArray

from lammps_inputs.numbers import known
from lammps_inputs.units import REDUCED, SI, Scale

Kind = TypeVar("Kind")


@dataclass(frozen=True)
class QuantityColumn:
    """A number of a quantity as a column of a sweep's table.

    Attributes:
        name: name of the column.
        label: words of an axis that shows it; empty for text.
        key: key of the number in the quantity's value, where that is not one number.
        symbol: symbol in TeX, on that axis.
    """

    name: str
    label: str = ""
    key: str = ""
    symbol: str = ""


@dataclass(frozen=True)
class Quantity:
    """Definition of the quantity that a field holds.

    Attributes:
        meaning: definition, in a sentence.
        unit: a key of `lammps_inputs.units.SI`, in which values are dimensionless and converted where they are written;
            or the symbol of another unit (``V``, ``T``, ``beads``), in which they are written as they are; or empty.
        undefined: under which condition there is no value: NaN or None, null in JSON.
        symbol: in equations.
        columns: of a sweep's table.
        column: label of a column that has the field's own name; None where there is none.
        digits: format in a printed table of records; None where it is left out of that.
        head: over that column, in place of the field's name.
        pure: whether it is a number without unit, such as a ratio, and neither a count nor the number of a bead.
        counts: whether it is a whole number, such as a count or the number of a bead, or true or false.
    """

    meaning: str
    unit: str = ""
    undefined: str = ""
    symbol: str = ""
    columns: tuple[QuantityColumn, ...] = ()
    column: str | None = None
    digits: str | None = None
    head: str = ""
    pure: bool = False
    counts: bool = False

    def symbol_of_unit(self, *, si: bool) -> str:
        """Symbol of the unit, such as ``m/s`` or ``reduced``; empty where there is no unit."""
        if self.unit not in SI:
            return self.unit
        return SI[self.unit] if si else REDUCED


_DECLARED = "quantity"
"""Key of a field's metadata, and attribute of a property's function."""

_COMPUTED = "of"
"""Key of a field's metadata: function that computes its value."""


def declare(
    meaning: str,
    unit: str = "",
    undefined: str = "",
    symbol: str = "",
    columns: tuple[QuantityColumn, ...] = (),
    *,
    default: Any = MISSING,
    **shown: Any,
) -> Any:
    """A field of a result, and the `Quantity` that it holds.

    Args:
        meaning: definition, in a sentence without its capital and full stop.
        unit: key of `lammps_inputs.units.SI`, whose values are dimensionless; or the symbol of another unit.
        undefined: under which condition there is no value.
        symbol: symbol in equations, in TeX.
        columns: columns of a sweep's table.
        default: value of the field where none is passed.
        shown: ``column``, ``digits`` and ``head`` of the `Quantity`.

    Returns:
        The field, in a class that `result` makes a dataclass.
    """
    return field(default=default, metadata={_DECLARED: Quantity(meaning, unit, undefined, symbol, columns, **shown)})


def computed(
    meaning: str,
    unit: str = "",
    undefined: str = "",
    symbol: str = "",
    columns: tuple[QuantityColumn, ...] = (),
    *,
    of: Callable[[Any], Any],
    init: Literal[False] = False,
    **shown: Any,
) -> Any:
    """A field of a result that is computed when it is first needed, and the `Quantity` that it holds.

    Args:
        meaning, unit, undefined, symbol, columns: see `Quantity`.
        of: computes the value from the result.
        init: False; no such field is an argument of the result's class.
        shown: ``column``, ``digits`` and ``head`` of the `Quantity`.
    """
    quantity = Quantity(meaning, unit, undefined, symbol, columns, **shown)
    return field(init=init, repr=False, compare=False, metadata={_DECLARED: quantity, _COMPUTED: of})


def derived(unit: str = "", undefined: str = "", symbol: str = "", column: str | None = None) -> Callable[[Kind], Kind]:
    """A property of a result, and the `Quantity` that it holds; the docstring says the meaning.

    Args:
        unit, undefined, symbol, column: see `Quantity`.

    Returns:
        A decorator of the property's function.
    """

    def mark(function: Kind) -> Kind:
        meaning = " ".join((function.__doc__ or "").split()).removesuffix(".")
        setattr(
            function, _DECLARED, Quantity(meaning[:1].lower() + meaning[1:], unit, undefined, symbol, column=column)
        )
        return function

    return mark


@dataclass_transform(frozen_default=True, field_specifiers=(declare, computed, field))
def result(kind: type[Kind]) -> type[Kind]:
    """Make a class a frozen dataclass whose fields declare what they hold.

    Args:
        kind: class whose fields are made by `declare` or `computed`; other fields are no quantities.

    Returns:
        The dataclass; fields of `computed` are computed when they are first needed.

    Examples:
        >>> @quantity.result
        ... class Passages:
        ...     times: tuple[float, ...]
        ...     last: float = quantity.computed("time of the last passage", "time", of=lambda run: run.times[-1])
        >>> Passages((1.5, 2.0)).last
        2.0
    """
    made = dataclass(frozen=True)(kind)
    for member in fields(made):  # type: ignore[arg-type]
        if _COMPUTED in member.metadata:
            value = cached_property(member.metadata[_COMPUTED])
            value.__set_name__(made, member.name)
            setattr(made, member.name, value)
    return made


def _declared(kind: Any) -> dict[str, tuple[Quantity, Any]]:
    types = typing.get_type_hints(kind)
    quantities = {
        member.name: (member.metadata[_DECLARED], types[member.name]) for member in fields(kind) if member.metadata
    }
    for base in reversed(kind.__mro__):
        for name, value in vars(base).items():
            if isinstance(value, property) and hasattr(value.fget, _DECLARED):
                quantities[name] = getattr(value.fget, _DECLARED), typing.get_type_hints(value.fget)["return"]
    for name, (quantity, kind_of_value) in quantities.items():
        columns = quantity.columns
        if quantity.column is not None:
            columns = (QuantityColumn(name, quantity.column, symbol=quantity.symbol),)
        floats, integers = (_holds(kind_of_value, kinds) for kinds in ((float, np.float64), (int, bool, np.int64)))
        quantities[name] = (
            replace(quantity, columns=columns, pure=floats and not quantity.unit, counts=integers and not floats),
            kind_of_value,
        )
    return quantities


def _holds(kind: Any, kinds: tuple[Any, ...]) -> bool:
    """Whether values of a type are numbers of some kinds, or arrays or mappings of them."""
    return kind in kinds or any(_holds(part, kinds) for part in typing.get_args(kind))


declared: Callable[[Any], dict[str, tuple[Quantity, Any]]] = cache(_declared)
"""Name -> quantity and type, of all fields and properties of a result that declare one."""


def walk(kind: Any, path: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Quantity]]:
    """Every quantity of a type, with the keys that lead to it; those of results within results follow theirs."""
    if typing.get_args(kind):
        for argument in typing.get_args(kind):
            yield from walk(argument, path)
    elif isinstance(kind, type) and is_dataclass(kind):
        for name, (quantity, within) in declared(kind).items():
            yield (*path, name), quantity
            for keys, inner in walk(within, (*path, name)):
                of_estimate = keys[-1] in ("value", "uncertainty") and inner.pure and quantity.unit != ""
                yield keys, replace(inner, unit=quantity.unit, pure=False) if of_estimate else inner


def in_units(value: Any, unit: str, scale: Scale) -> Any:
    """A dimensionless number or array in the scene's units; what has another unit as it is."""
    return scale.measured(value, unit) if unit in SI else value


def plain(value: Any, scale: Scale, unit: str = "") -> Any:
    """A result as data for JSON, in the scene's units; what is undefined is None.

    Args:
        value: a result, or a number, array, mapping or sequence of the unit.
        scale: units of the scene.
        unit: unit of the value, as of `Quantity`; a result has those of its fields.

    Returns:
        Dictionaries, lists, numbers and text.
    """
    if is_dataclass(value):
        quantities = declared(type(value))
        return {name: plain(getattr(value, name), scale, quantity.unit) for name, (quantity, _) in quantities.items()}
    if isinstance(value, Mapping):
        return {str(key): plain(entry, scale, unit) for key, entry in value.items()}
    if isinstance(value, np.ndarray):
        return plain(in_units(value, unit, scale).tolist(), scale)
    if isinstance(value, Sequence) and not isinstance(value, str):
        return [plain(entry, scale, unit) for entry in value]
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, np.generic):
        value = value.item()
    return known(in_units(value, unit, scale)) if isinstance(value, float) else value


def plain_at(value: Any, keys: Iterable[str], scale: Scale) -> Any:
    """The part of the `plain` data of a result that keys lead to; no other is computed. None where there is none."""
    unit = ""
    for key in keys:
        if isinstance(value, Mapping):
            value = value.get(key)
        elif is_dataclass(value):
            unit, value = declared(type(value))[key][0].unit, getattr(value, key)
        else:
            return None
    return plain(value, scale, unit)


def to_csv(columns: Mapping[str, Iterable[Any]]) -> str:
    """CSV text of columns, a line for each row; numbers read back exactly, and an undefined number is empty."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(columns)
    values = [column.tolist() if isinstance(column, np.ndarray) else column for column in columns.values()]
    for row in zip(*values, strict=True):
        writer.writerow(["" if isinstance(entry, float) and known(entry) is None else entry for entry in row])
    return out.getvalue()


def csv_of_rows(rows: Sequence[Mapping[str, Any]], head: Sequence[str] = ()) -> str:
    """CSV of rows by column; numbers read back exactly, what is undefined is empty, what is infinite is ``inf``.

    Args:
        rows: column -> value.
        head: the columns; by default those of the first row.

    Returns:
        The text, a line for each row.

    Examples:
        >>> quantity.csv_of_rows([{"coupling": 0.1, "rows": 58.0}, {"coupling": 0.0, "rows": None}]).splitlines()
        ['coupling,rows', '0.1,58.0', '0.0,']
    """
    return to_csv({name: [_unbounded(row[name]) for row in rows] for name in head or rows[0]})


def _unbounded(value: Any) -> Any:
    return str(value) if isinstance(value, float) and math.isinf(value) else value


def structured(columns: Mapping[str, NDArray[Any]]) -> NDArray[np.void]:
    """Structured array, [row], with a field for each column, [row]; a field has the type of its column."""
    rows = len(next(iter(columns.values())))
    array = np.zeros(rows, dtype=[(name, column.dtype) for name, column in columns.items()])
    for name, column in columns.items():
        array[name] = column
    return array


def data_frame(array: NDArray[np.void], heading: Callable[[str], str]) -> Any:
    """Data frame of pandas with the fields of a structured array, [row], as columns under their headings.

    Raises:
        ImportError: pandas is not installed.
    """
    import pandas as pd

    return pd.DataFrame(array).rename(columns={name: heading(name) for name in array.dtype.names or ()})


def table(record: Any, scale: Scale) -> dict[str, Any]:
    """Heading -> values in the scene's units, of a result whose fields are columns, or columns by name."""
    columns = {}
    for name, (quantity, _) in declared(type(record)).items():
        value = getattr(record, name)
        for heading, column in value.items() if isinstance(value, Mapping) else [(name, value)]:
            columns[scale.heading(heading, quantity.unit)] = in_units(column, quantity.unit, scale)
    return columns


def csv_of(record: Any, scale: Scale) -> str:
    """CSV text of a result whose fields are columns, or columns by name, in the scene's units.

    Args:
        record: result whose fields are arrays [row], or mappings from a heading to one.
        scale: units of the scene.

    Returns:
        The text, a line for each row; numbers read back exactly, and an undefined number is empty.
    """
    return to_csv(table(record, scale))


def headings(kind: Any, scale: Scale, words: Mapping[str, str] | None = None) -> list[str]:
    """Headings of a table, with units: the names of a type's quantities, or words for some of them.

    Args:
        kind: result whose fields are columns.
        scale: units of the scene.
        words: name of a field -> words in its place; by default all fields with their names.

    Returns:
        The headings, in the order of the words.
    """
    quantities = declared(kind)
    return [
        scale.heading(text, quantities[name][0].unit)
        for name, text in (words or {name: name for name in quantities}).items()
    ]


def written(record: Any, name: str, scale: Scale, digits: str) -> str:
    """A number of a result as a cell of a printed table, in the scene's units; ``-`` where it is undefined."""
    return cell(plain(getattr(record, name), scale, declared(type(record))[name][0].unit), digits)


def cell(value: float | str | None, digits: str) -> str:
    """A number of a printed table, or a text; ``-`` where it is undefined."""
    if isinstance(value, str):
        return value
    return "-" if value is None or known(value) is None else f"{value:{digits}}"
