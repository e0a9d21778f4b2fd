"""The cases of a sweep: which values, under which name, and the scene that follows."""

import hashlib
import itertools
import json
import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from lammps_inputs import InputError, Scene, library
from lammps_inputs.numbers import text
from workflow.sweep import fields
from workflow.sweep.file import Sweep

LONGEST_NAME = 150
"""Characters; file systems take 255, and figures and temporary files add to it."""

_LONGEST_VALUE = 40
_WORD = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]*")


@dataclass(frozen=True)
class Case:
    """One case.

    Attributes:
        name: of its directory; depends on the fields and values of this case alone.
        values: field -> value.
    """

    name: str
    values: dict[str, Any]


def all_cases(sweep: Sweep) -> list[Case]:
    """Every case, each checked to be a scene.

    Raises:
        InputError: two of the same name, or one that is no scene, by name.
    """
    cases, names = [], set()
    for values in _combinations(sweep):
        case = Case(case_name(values), values)
        if case.name in names:
            raise InputError(f"{sweep.source}: vary: the case {case.name} is there twice; a value is given twice")
        names.add(case.name)
        scene_of(sweep, case)
        cases.append(case)
    return cases


def _combinations(sweep: Sweep) -> Iterator[dict[str, Any]]:
    columns = list(sweep.vary.values())
    rows = itertools.product(*columns) if sweep.combine == "product" else zip(*columns, strict=True)
    return (dict(zip(sweep.vary, row, strict=True)) for row in rows)


def scene_of(sweep: Sweep, case: Case) -> Scene:
    """The scene of a case.

    Raises:
        InputError: it is none; names the case.
    """
    where = f"{sweep.source}: case {case.name}"
    scene = sweep.scene
    try:
        for field, value in case.values.items():
            scene = fields.put(scene, fields.parse(field), value)
    except InputError as error:
        raise InputError(f"{where}: {error}") from None
    return library.from_plain(scene, where)


def case_name(values: dict[str, Any]) -> str:
    """``coupling.stiffness=0.05,kick.velocity=0.1``: letters, digits and ``._-+=,``, of bounded length.

    Numbers are written so that they read back exactly; what cannot be written shortly is a fingerprint.
    """
    full = ",".join(f"{field.replace('[', '').replace(']', '')}={_written(value)}" for field, value in values.items())
    if len(full) <= LONGEST_NAME:
        return full
    mark = f"..{_fingerprint(full)}"
    return full[: LONGEST_NAME - len(mark)] + mark


def _written(value: Any) -> str:
    if value is None:
        return "none"
    if isinstance(value, float) or (isinstance(value, int) and 2**53 <= abs(value) <= 10**300):
        return text(value + 0.0)  # zero has no sign
    plain = str(value) if isinstance(value, int | str) else ""
    short = len(plain) <= _LONGEST_VALUE and (isinstance(value, int) or _WORD.fullmatch(plain))
    return plain if short else _fingerprint(json.dumps(value, sort_keys=True))


def _fingerprint(words: str) -> str:
    return hashlib.sha256(words.encode()).hexdigest()[:10]
