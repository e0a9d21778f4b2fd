"""Arguments of functions for scripts and notebooks: each is read by its type before the function begins.

What no argument can be ends in an `InputError` of one line that names the argument and valid values. Numbers, flags and
arrays of NumPy count as those of Python, tuples as lists, and text as a path.
"""

import functools
import inspect
import math
import numbers
import os
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import UnionType
from typing import Annotated, Any, Literal, ParamSpec, TypeVar, Union, get_args, get_origin, get_type_hints

import numpy as np

from lammps_inputs import InputError, complaints

P = ParamSpec("P")
R = TypeVar("R")
Reader = Callable[[Any], Any]
"""Value of an argument -> value that the function gets; raises ValueError, which says what is valid, for all others."""

SHOWN = 60
"""Characters of a value in a message."""


@dataclass(frozen=True)
class Between:
    """Bounds of a number, in an annotation.

    Attributes:
        low: the least value.
        high: the largest value.
        above: whether the least value itself is excluded.

    Examples:
        >>> str(Between(0.0, 1.0)), str(Between(0.0, above=True))
        ('0 to 1', 'above 0')
        >>> Between(0.0, 1.0).refuse(2.0, "a number")
        Traceback (most recent call last):
            ...
        ValueError: a number, 0 to 1
    """

    low: float
    high: float = math.inf
    above: bool = False

    def __str__(self) -> str:
        if not math.isfinite(self.high):
            return f"above {self.low:g}" if self.above else f"{self.low:g} or more"
        return f"above {self.low:g}, at most {self.high:g}" if self.above else f"{self.low:g} to {self.high:g}"

    def refuse(self, value: float, kind: str) -> None:
        """Refuse a number outside.

        Raises:
            ValueError: says what is valid.
        """
        if not self.low <= value <= self.high or (self.above and value == self.low):
            raise ValueError(f"{kind}, {self}")


@dataclass(frozen=True)
class Valid:
    """Reader of an argument whose type alone does not say what it may be, in an annotation.

    Attributes:
        read: see `Reader`.
    """

    read: Reader


class RefusedError(ValueError):
    """A value in an argument that holds several; its text begins with the value's place and the value."""


def checked(function: Callable[P, R]) -> Callable[P, R]:
    """Read the arguments of a function by their annotations before it begins.

    Messages of what it calls name options of the command line; they name the arguments in their place.

    Args:
        function: a function with an annotation for each argument.

    Returns:
        The function; it raises `InputError` for arguments that it does not have or cannot take.

    Examples:
        >>> @checked
        ... def half(value: float) -> float:
        ...     return value / 2
        >>> half(np.float64(3.0))
        1.5
        >>> half("three")
        Traceback (most recent call last):
            ...
        lammps_inputs.errors.InputError: value: 'three' given; a number
        >>> half(valu=3.0)
        Traceback (most recent call last):
            ...
        lammps_inputs.errors.InputError: valu: is no argument of half (did you mean `value`?)
    """
    signature = inspect.signature(function)
    by_names: Callable[..., R] = function
    names = [name for name, each in signature.parameters.items() if each.kind is not inspect.Parameter.VAR_KEYWORD]
    further = dict(_further(signature))

    @functools.cache
    def readers() -> dict[str, Reader]:
        kinds = {name: signature.parameters[name].annotation for name in names} | further
        return {name: reader(kind) for name, kind in kinds.items()}

    @functools.wraps(function)
    def call(*positional: P.args, **by_name: P.kwargs) -> R:
        _refuse_names(function.__name__, signature, [*names, *further], positional, by_name)
        bound = signature.bind(*positional, **by_name)
        try:
            values = _flat(bound.arguments, set(names)).items()
            read: Any = {name: _read(name, value, readers()[name]) for name, value in values}
            return by_names(**read)
        except InputError as error:
            error.args = (in_python(str(error), (*names, *further)),)
            raise

    return call


def _flat(arguments: Mapping[str, Any], names: set[str]) -> dict[str, Any]:
    """Arguments by name, those that are collected in a mapping beside the others."""
    flat: dict[str, Any] = {}
    for name, value in arguments.items():
        flat |= {name: value} if name in names else value
    return flat


def _further(signature: inspect.Signature) -> Iterable[tuple[str, Any]]:
    """Name and type of the arguments that ``**name: Unpack[TypedDict]`` stands for."""
    for each in signature.parameters.values():
        if each.kind is inspect.Parameter.VAR_KEYWORD:
            [kind] = get_args(each.annotation)
            yield from get_type_hints(kind, include_extras=True).items()


def _refuse_names(
    function: str, signature: inspect.Signature, names: list[str], positional: tuple[Any, ...], by_name: dict[str, Any]
) -> None:
    """Refuse a call whose arguments are not those of the function."""
    for name in by_name:
        if name not in names:
            hint = complaints.suggestion(name[:SHOWN], names) or f"; arguments are {', '.join(names)}"
            raise InputError(f"{name[:SHOWN]}: is no argument of {function}{hint}")
    free = [
        name
        for name, each in signature.parameters.items()
        if each.kind in (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    ]
    if len(positional) > len(free):
        named = f"; {', '.join(name for name in names if name not in free)} are given by name" if names != free else ""
        raise InputError(f"{function}: {len(positional)} arguments given; {', '.join(free)}{named}")
    for name in free[: len(positional)]:
        if name in by_name:
            raise InputError(f"{name}: given twice, by its place and by its name")
    for name in free[len(positional) :]:
        if name not in by_name and signature.parameters[name].default is inspect.Parameter.empty:
            raise InputError(f"{name}: is missing; {function} takes {', '.join(names)}")


def _read(name: str, value: Any, read: Reader) -> Any:
    """Value of an argument.

    Raises:
        InputError: it cannot be one; names the argument.
    """
    try:
        return read(value)
    except InputError as error:
        raise InputError(f"{name}: {error}") from None
    except RefusedError as error:
        raise InputError(f"{name}{error}") from None
    except ValueError as error:
        raise InputError(f"{name}: {shown(value)} given; {error}") from None


def shown(value: Any) -> str:
    """A value in a message, shortened."""
    try:
        text = repr(value)
    except Exception as error:  # of an object of the user's
        text = f"<{type(value).__name__}, whose repr fails: {type(error).__name__}>"
    return text if len(text) <= SHOWN else f"{text[: SHOWN - 3]}..."


# --- readers ----------------------------------------------------------------------------------------------------------


def reader(kind: Any) -> Reader:
    """Reader of the arguments of a type.

    Args:
        kind: an annotation of an argument: a flag, number, text or path, a word of several, a sequence or mapping of
            these, a class, any of them or None; or of any type with `Between` or `Valid`.
    """
    origin, inside = get_origin(kind), get_args(kind)
    if origin is Annotated:
        return _annotated(*inside)
    if origin in (Union, UnionType) and type(None) in inside:
        others = tuple(each for each in inside if each is not type(None))
        read = reader(others[0] if len(others) == 1 else Union[others])  # noqa: UP007  others are known at run time only
        return lambda value: None if value is None else read(value)
    if origin in (Union, UnionType) and set(inside) == {Path, str}:
        return path
    if origin is Literal:
        return lambda value: _word(value, inside)
    if origin is not None and issubclass(origin, Mapping):
        return functools.partial(_mapping, read=reader(inside[1]))
    if origin is not None and issubclass(origin, Sequence):
        return functools.partial(_sequence, read=reader(inside[0]))
    return _PLAIN.get(kind) or functools.partial(_instance, kind=kind)


def _annotated(kind: Any, note: Any, *_: Any) -> Reader:
    if isinstance(note, Valid):
        return note.read
    return functools.partial(_number, kind=kind, bounds=note)


def _flag(value: Any) -> bool:
    if not isinstance(value, bool | np.bool_):
        raise ValueError("True or False")
    return bool(value)


def _number(value: Any, kind: type[int] | type[float], bounds: Between | None = None) -> float:
    """An int or a float."""
    integral = kind is int
    words = "a whole number" if integral else "a number"
    fits = isinstance(value, numbers.Integral if integral else numbers.Real) and not isinstance(value, bool)
    try:
        fits = fits and math.isfinite(value)
    except OverflowError:  # an integer that no float can be
        fits = False
    if not fits:
        raise ValueError(f"{words}, {bounds}" if bounds else words)
    number = kind(value)
    if bounds:
        bounds.refuse(number, words)
    return number


def text(value: Any) -> str:
    """Text, also of NumPy.

    Raises:
        ValueError: it is none.
    """
    if not isinstance(value, str) or not value.strip():
        raise ValueError("text")
    return str(value)


def path(value: Any) -> Path:
    """Path of a file or directory.

    Raises:
        ValueError: it is none.
    """
    name = os.fspath(value) if isinstance(value, str | os.PathLike) else b""
    if not isinstance(name, str) or not name or "\0" in name:
        raise ValueError("a path such as 'out'")
    return Path(name)


def _word(value: Any, words: Sequence[str]) -> str:
    if not isinstance(value, str) or value not in words:
        hint = complaints.suggestion(value[:SHOWN], words) if isinstance(value, str) else ""
        raise ValueError(f"{' or '.join(map(repr, words))}{hint}")
    return str(value)


def _sequence(value: Any, read: Reader) -> list[Any]:
    """A list; one text stands for a list of one."""
    if isinstance(value, str):
        value = [value]
    if isinstance(value, bytes | Mapping | set | frozenset) or not isinstance(value, Iterable):
        raise ValueError("a list")
    try:
        values = list(value)
    except TypeError:  # an array of no dimension
        raise ValueError("a list") from None
    return [_part(f"[{place}]", each, read) for place, each in enumerate(values)]


def _mapping(value: Any, read: Reader) -> dict[str, Any]:
    if not isinstance(value, Mapping):
        raise ValueError("a mapping, name -> value")
    for key in value:
        if not isinstance(key, str):
            raise ValueError("a mapping, name -> value, whose names are text")
    return {str(key): _part(f"[{shown(key)}]", each, read) for key, each in value.items()}


def _part(place: str, value: Any, read: Reader) -> Any:
    try:
        return read(value)
    except RefusedError as error:
        raise RefusedError(f"{place}{error}") from None
    except ValueError as error:
        raise RefusedError(f"{place}: {shown(value)} given; {error}") from None


def _instance(value: Any, kind: Any) -> Any:
    if kind is not Any and not isinstance(value, kind):
        raise ValueError(f"a {kind.__name__}")
    return value


_PLAIN: dict[Any, Reader] = {
    bool: _flag,
    int: functools.partial(_number, kind=int),
    float: functools.partial(_number, kind=float),
    str: text,
    Any: lambda value: value,
}


# --- messages ---------------------------------------------------------------------------------------------------------

_QUOTED = re.compile(r"(`[^`]*`)")
_OPTION = re.compile(r"(?<![\w-])--([a-z]+(?:-[a-z]+)*)(?![\w-])")
_OUTPUT = re.compile(r"(?<![\w-])-o(?: [A-Z]+)?(?![\w-])")

OF_OPTIONS = {
    "tolerance": ("tolerances", "tolerance"),
    "plot": ("quantity",),
    "and": ("beside",),
    "overwrite": ("overwrite=True",),
    "force": ("force=True",),
    "no-lammps": ("lammps=False",),
    "no-check": ("check=False",),
    "linear": ("linear=True",),
    "units": ("units",),
}
"""Option of a command -> arguments of functions in its place, of which a function has the first or the second."""


def in_python(message: str, names: Sequence[str]) -> str:
    """A message of a command with the names of a function's arguments in place of options.

    Args:
        message: text; commands in it, between backticks, remain as they are.
        names: names of the arguments of the function.
    """

    def argument(option: re.Match[str]) -> str:
        choices: tuple[str, ...] = OF_OPTIONS.get(option[1], (option[1].replace("-", "_"),))
        return next((each for each in choices if each.partition("=")[0] in names), choices[0])

    output = next((name for name in ("output", "directory") if name in names), "directory")
    parts = _QUOTED.split(message)
    for place in range(len(parts)):
        if not (parts[place].startswith("`") and " " in parts[place]):  # a command
            parts[place] = _OUTPUT.sub(output, _OPTION.sub(argument, parts[place]))
    return "".join(parts)
