"""Options that commands of several studies have, and how such a command carries out its study."""

import argparse
import contextlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import yaml

from lammps_inputs import InputError
from workflow.engines.lammps.mpi import cores
from workflow.screen import count_bar
from workflow.workers.pool import Pool

Found = TypeVar("Found")


def add_output(parser: argparse.ArgumentParser) -> None:
    """The directory that a study is carried out in."""
    parser.add_argument(
        "-o", "--output", metavar="DIR", type=Path, required=True, help="new directory, or one to resume"
    )


def add_jobs(parser: argparse.ArgumentParser, words: str = "scenes at a time (default all cores)") -> None:
    """The number of worker processes; None by default."""
    parser.add_argument("--jobs", metavar="N", type=within(int, 1, 1024), help=words)


def within(kind: type[int] | type[float], low: float, high: float) -> Callable[[str], float]:
    """The type of an option whose numbers have bounds."""

    def read(text: str) -> float:
        with contextlib.suppress(ValueError):
            if low <= kind(text) <= high:
                return kind(text)
        raise argparse.ArgumentTypeError(f"{text} given; {low:g} to {high:g}")

    return read


def listed(kind: type[int] | type[float]) -> Callable[[str], tuple[float, ...]]:
    """The type of an option that takes numbers with commas between."""

    def read(text: str) -> tuple[float, ...]:
        try:
            return tuple(kind(part) for part in text.split(","))
        except ValueError:
            words = "whole numbers" if kind is int else "numbers"
            raise argparse.ArgumentTypeError(f"{text!r} given; {words} with commas between") from None

    return read


def on_cores(command: str, jobs: int | None, carry_out: Callable[..., Found]) -> Found | None:
    """What a study finds with worker processes and a bar of its progress; None where it is interrupted.

    Args:
        command: of the study.
        jobs: scenes at a time; None for all cores.
        carry_out: takes ``pool`` and ``progress``.
    """
    try:
        with count_bar(command) as progress, Pool(jobs or cores(), interrupt=True) as pool:
            return carry_out(pool=pool, progress=progress)
    except KeyboardInterrupt:
        print("interrupted: computed scenes remain; the same command resumes")
        return None


def split(text: str, option: str, example: str) -> tuple[str, str]:
    """Both sides of ``NAME=VALUE``.

    Raises:
        InputError: there are none.
    """
    name, sign, value = (part.strip() for part in text.partition("="))
    if not (name and sign and value):
        raise InputError(f"{option}: {text!r} given; such as {example}")
    return name, value


def number(text: str, option: str, example: str) -> float:
    """A number of ordinary size.

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


def second_field(text: str | None) -> tuple[str, tuple[Any, ...]]:
    """Field and values of ``--over FIELD=A,B,...``; empty without the option.

    Raises:
        InputError: there are no such values, or one is given twice.
    """
    if not text:
        return "", ()
    field, places = split(text, "--over", "chains=2,3,4")
    try:
        values = tuple(yaml.safe_load(f"[{places}]"))
    except yaml.YAMLError:
        values = ()
    if not values or len(set(map(str, values))) < len(values):
        raise InputError(f"--over: {places!r} given; different values with commas between, such as chains=2,3,4")
    return field, values
