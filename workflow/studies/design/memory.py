"""All designs that were computed, one line each of a file: whatever happens, what is done stays and is readable."""

import hashlib
import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lammps_inputs import InputError

FILE = "evaluations.jsonl"


@dataclass(frozen=True)
class Record:
    """One design.

    Attributes:
        values: field -> value.
        quantities: name -> value, None where it has none; empty if refused.
        refused: why it is no scene; empty if it is one.
        seconds: processor time.
    """

    values: dict[str, Any]
    quantities: dict[str, float | None]
    refused: str
    seconds: float


def key_of(scene: dict[str, Any]) -> str:
    """Of a scene's plain data: the same for the same scene."""
    return hashlib.sha256(json.dumps(scene, sort_keys=True).encode()).hexdigest()[:20]


class Memory:
    """Records by key, kept in a file.

    Args:
        path: read if it is there; a line that a kill cut short is dropped.

    Raises:
        InputError: it cannot be read or written.
    """

    def __init__(self, path: Path) -> None:
        self.records: dict[str, Record] = {}
        try:
            text = path.read_bytes() if path.is_file() else b""
            whole = text[: text.rfind(b"\n") + 1]
            if len(whole) < len(text):
                os.truncate(path, len(whole))
            for line in whole.splitlines():
                self._take(line)
            self._file = path.open("a", encoding="utf-8")
        except OSError as error:
            raise InputError(f"{path}: cannot be used ({error.strerror})") from None

    def _take(self, line: bytes) -> None:
        try:
            data = json.loads(line)
            key = str(data.pop("key"))
            self.records[key] = Record(**data)
        except (ValueError, TypeError, KeyError, AttributeError):
            return  # not ours

    def known(self, key: str, names: tuple[str, ...]) -> Record | None:
        """The record of a scene, if it has what is asked for."""
        record = self.records.get(key)
        if record is None or record.refused or all(name in record.quantities for name in names):
            return record
        return None

    def add(self, key: str, record: Record) -> None:
        """Keep a record, on the disk at once."""
        self.records[key] = record
        line = {
            "key": key,
            "values": record.values,
            "quantities": record.quantities,
            "refused": record.refused,
            "seconds": record.seconds,
        }
        self._file.write(json.dumps(line) + "\n")
        self._file.flush()

    def close(self) -> None:
        """Close the file."""
        self._file.close()
