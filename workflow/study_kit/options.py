"""Options that commands of several studies have, and the end of such a command where it is interrupted.

Plug-ins take this module for their commands: `add_output`, `add_jobs` and `add_traces` add options, `within` and
`listed` are types of numbers, `split`, `both_ends`, `second_field` and `trace_file` read words, `interrupted` is the
result after Ctrl-C.

Examples:
    >>> import argparse
    >>> parser = argparse.ArgumentParser()
    >>> options.add_output(parser)
    >>> _ = parser.add_argument("--rows", type=options.within(int, 1, 100), default=10)
    >>> parser.parse_args(["-o", "out", "--rows", "20"]).rows
    20
    >>> options.split("beat_length = 20", "--where", "beat_length=20")
    ('beat_length', '20')
    >>> options.second_field("chains=2,3,4").values
    (2, 3, 4)
"""

import argparse
import contextlib
import textwrap
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

from analysis.files.traces import FREE, Given, TraceFile
from lammps_inputs import InputError, strict_yaml
from lammps_inputs.units import Label
from workflow.screen import CommandResult
from workflow.sweep import fields
from workflow.sweep.axes import label

if TYPE_CHECKING:
    from analysis.figures.studies import StudyAxis


def add_output(parser: argparse.ArgumentParser) -> None:
    """Add the option for the directory of a study."""
    parser.add_argument(
        "-o", "--output", metavar="DIR", type=Path, required=True, help="new directory, or one to resume"
    )


def add_jobs(parser: argparse.ArgumentParser, words: str = "scenes at a time (default all cores)") -> None:
    """Add the option for the number of worker processes; None by default."""
    parser.add_argument("--jobs", metavar="N", type=within(int, 1, 1024), help=words)


COLUMNS = '"time (us)=TIME,force_wall_right (V)=CH1"'
"""Example of ``--columns``."""


def add_traces(parser: argparse.ArgumentParser, *, free: bool) -> None:
    """Add the options that say how a file of traces is to be read.

    Args:
        parser: parser of a command.
        free: whether gains and baselines may be estimated.
    """
    or_free, example = (" or free", "CH1=20.5,CH2=free") if free else ("", "CH1=20.5")
    parser.add_argument(
        "--columns",
        metavar="NAME=COLUMN,...",
        help=f"columns of FILE by their headings or numbers (#4), with units where FILE has none: {COLUMNS}",
    )
    parser.add_argument(
        "--skip", metavar="LINES", type=within(int, 0, 10**6), help="lines of FILE before the names of its columns"
    )
    parser.add_argument(
        "--gain",
        metavar="COLUMN=GAIN,...",
        help=f"force (velocity, displacement) per unit of a column, such as N/V: {example}",
    )
    parser.add_argument(
        "--baseline",
        metavar="COLUMN=SIGNAL,...",
        help=f"signal of a column at rest, in its unit{or_free}: force = gain (signal - baseline)",
    )


def trace_file(arguments: argparse.Namespace, *, free: bool) -> TraceFile:
    """The file of traces in ``arguments.against``, as the options of `add_traces` describe it.

    Args:
        arguments: arguments of the command.
        free: whether gains and baselines may be estimated.

    Returns:
        The file, which is not read.

    Raises:
        InputError: an option is no list of such pairs.
    """
    columns = {} if arguments.columns is None else _pairs(arguments.columns, "--columns", COLUMNS)
    or_free = " or CH1=free" * free
    gain = _calibrations(arguments.gain, "--gain", f"CH1=20.5{or_free}", free=free)
    baseline = _calibrations(arguments.baseline, "--baseline", f"CH1=0.02{or_free}", free=free)
    return TraceFile(arguments.against, columns, arguments.skip, gain, baseline)


def _calibrations(text: str | None, option: str, example: str, *, free: bool) -> dict[str, Given]:
    """Gains or baselines of columns by ``--gain CH1=20.5,CH2=free``.

    Raises:
        InputError: it is no such list.
    """
    values: dict[str, Given] = {}
    for name, value in ({} if text is None else _pairs(text, option, example)).items():
        values[name] = "free" if free and value == FREE else number(value, option, example)
    return values


def trace_words(arguments: argparse.Namespace) -> list[str]:
    """Words of the options of `add_traces` that are given, for the same command elsewhere.

    Args:
        arguments: arguments of the command.

    Returns:
        Words such as ``--skip=5``.
    """
    values = {name: getattr(arguments, name) for name in ("columns", "skip", "gain", "baseline")}
    return [f"--{name}={value}" for name, value in values.items() if value is not None]


def _pairs(text: str, option: str, example: str) -> dict[str, str]:
    """Pairs of ``NAME=VALUE,...``.

    Raises:
        InputError: it is no such list, or names one twice.
    """
    pairs: dict[str, str] = {}
    for part in text.split(","):
        name, value = split(part, option, example)
        if name in pairs:
            raise InputError(f"{option}: {name} is given twice")
        pairs[name] = value
    return pairs


def within(kind: type[int] | type[float], low: float, high: float) -> Callable[[str], float]:
    """The type of an option whose numbers have bounds.

    Args:
        kind: int or float.
        low: the least number.
        high: the largest number.

    Returns:
        A function from text to the number, which raises ``argparse.ArgumentTypeError`` for others.
    """

    def read(text: str) -> float:
        with contextlib.suppress(ValueError):
            if low <= kind(text) <= high:
                return kind(text)
        raise argparse.ArgumentTypeError(f"{text} given; {low:g} to {high:g}")

    return read


def listed(kind: type[int] | type[float]) -> Callable[[str], tuple[float, ...]]:
    """The type of an option that takes numbers with commas between.

    Args:
        kind: int or float.

    Returns:
        A function from text to the numbers, which raises ``argparse.ArgumentTypeError`` for other text.
    """

    def read(text: str) -> tuple[float, ...]:
        try:
            return tuple(kind(part) for part in text.split(","))
        except ValueError:
            words = "whole numbers" if kind is int else "numbers"
            raise argparse.ArgumentTypeError(f"{text!r} given; {words} with commas between") from None

    return read


def interrupted() -> CommandResult:
    """Result of a command that Ctrl-C ended; its next start takes computed scenes from a cache."""
    print("the command was interrupted; computed scenes remain, and the same command resumes")
    return CommandResult(130, {})


def split(text: str, option: str, example: str) -> tuple[str, str]:
    """Both sides of ``NAME=VALUE``.

    Args:
        text: what the user wrote.
        option: name of the option, for the message.
        example: valid text, for the message.

    Returns:
        Name and value, without blanks around them.

    Raises:
        InputError: there are none.
    """
    name, sign, value = (part.strip() for part in text.partition("="))
    if not (name and sign and value):
        raise InputError(f"{option}: {text!r} given; such as {example}")
    return name, value


def number(text: str, option: str, example: str) -> float:
    """A number of ordinary size.

    Args:
        text: what the user wrote.
        option: name of the option, for the message.
        example: valid text, for the message.

    Returns:
        The number, smaller than 1e300.

    Raises:
        InputError: it is none.
    """
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not abs(value) < 1e300:
        raise InputError(f"{option}: {text!r} is no number; such as {example}")
    return value


def both_ends(text: str, option: str, example: str) -> tuple[float, float]:
    """Both numbers of ``LOW:HIGH``.

    Args:
        text: what the user wrote.
        option: name of the option, for the message.
        example: valid text, for the message.

    Returns:
        Both numbers; the first may be the larger one.

    Raises:
        InputError: a side is no number.
    """
    low, _, high = text.partition(":")
    return number(low, option, example), number(high, option, example)


@dataclass(frozen=True)
class SecondField:
    """A second field of a study, and its values; without one an empty name, and one value of no meaning."""

    name: str = ""
    values: tuple[Any, ...] = (None,)

    def put(self, scene: dict[str, Any], value: Any) -> dict[str, Any]:
        """Plain data of a scene with a value in the field."""
        return fields.put_all(scene, {self.name: value} if self.name else {})

    @property
    def is_numeric(self) -> bool:
        """Whether the values can stand along an axis."""
        return bool(self.name) and all(isinstance(value, int | float) for value in self.values)

    def axis(self, values: Sequence[Any], scene: dict[str, Any]) -> "StudyAxis | None":
        """Values of the field in a figure, by their numbers from 1 where they are no numbers; None without a field."""
        from analysis.figures.studies import StudyAxis, floats  # matplotlib takes half a second to import

        if not self.name:
            return None
        named = label(self.name, scene)
        if self.is_numeric:
            return StudyAxis(named, floats(values))
        numbers = floats([self.values.index(value) + 1 for value in values])
        return StudyAxis(Label(f"value of {named.words}, by its number"), numbers)


def second_field(text: str | None) -> SecondField:
    """Field and values of ``--over FIELD=A,B,...``.

    Raises:
        InputError: there are no such values, or one is given twice.
    """
    if not text:
        return SecondField()
    field, places = split(text, "--over", "chains=2,3,4")
    try:
        values = tuple(map(hashable, strict_yaml.parse(f"values: [{places}]", "--over")["values"]))
        count = len(set(values))
    except (InputError, TypeError):  # a mapping, too, is no value
        values, count = (), 0
    if not count or count < len(values):
        raise InputError(f"--over: {places!r} given; different values with commas between, such as chains=2,3,4")
    return SecondField(field, values)


def example_file(module: ModuleType) -> str:
    """File with all its keys, explained by comments: the example in the docstring of the module that reads it."""
    _, _, block = (module.__doc__ or "").partition("::\n\n")
    return textwrap.dedent(block).rstrip() + "\n"


def hashable(value: Any) -> Any:
    """A value of a field as a key of a dictionary: lists as tuples."""
    return tuple(map(hashable, value)) if isinstance(value, list | tuple) else value
