"""Options that commands of several studies have: fields and quantities with values."""

from typing import Any

import yaml

from lammps_inputs import InputError


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
