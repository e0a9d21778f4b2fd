"""Results of a study by key, one line each of a file: whatever happens, what is done stays and is readable."""

import hashlib
import json
import os
from pathlib import Path
from typing import Any

from lammps_inputs import InputError


def key_of(request: Any) -> str:
    """Of plain data: the same for the same request."""
    return hashlib.sha256(json.dumps(request, sort_keys=True).encode()).hexdigest()[:20]


class Results(dict[str, Any]):
    """Key -> result as plain data; `keep` writes it to the disk at once.

    Args:
        path: read if it is there, and added to; a line that a kill cut short is dropped. None keeps nothing.

    Raises:
        InputError: it cannot be read or written.
    """

    def __init__(self, path: Path | None) -> None:
        super().__init__()
        self._file = None
        if path is None:
            return
        try:
            text = path.read_bytes() if path.is_file() else b""
            whole = text[: text.rfind(b"\n") + 1]
            if len(whole) < len(text):
                os.truncate(path, len(whole))
            self._file = path.open("a", encoding="utf-8")
        except OSError as error:
            raise InputError(f"{path}: cannot be used ({error.strerror})") from None
        for line in whole.splitlines():
            self._take(line)

    def _take(self, line: bytes) -> None:
        try:
            data = json.loads(line)
            self[str(data["key"])] = data["result"]
        except (ValueError, TypeError, KeyError, RecursionError):
            return  # not ours

    def keep(self, key: str, result: Any) -> None:
        """Add a result."""
        self[key] = result
        if self._file is not None:
            self._file.write(json.dumps({"key": key, "result": result}) + "\n")
            self._file.flush()

    def __enter__(self) -> "Results":
        return self

    def __exit__(self, *_: object) -> None:
        if self._file is not None:
            self._file.close()
