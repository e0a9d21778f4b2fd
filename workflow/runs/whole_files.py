"""Files written whole or not at all: under another name, and then renamed."""

import json
import math
import os
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

from workflow.errors import EndedError, RunError
from workflow.formats import figure_files

if TYPE_CHECKING:
    from matplotlib.figure import Figure  # takes a while to import

TEMPORARY = ".granchain-"
"""In the name of a file that is being written, so that a kill leaves nothing that could be somebody else's."""


def write_bytes(path: Path, content: bytes) -> None:
    """Write a file whole or not at all.

    Raises:
        EndedError: it cannot be written; what was there before still is.
    """
    try:
        _write(path, content)
    except OSError as error:
        raise EndedError(f"{path}: cannot be written ({error.strerror}); what was there is left as it was") from None


def _write(path: Path, content: bytes) -> None:
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}{TEMPORARY}")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        Path(name).chmod(0o644)
        Path(name).replace(path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


def write_figure(directory: Path, name: str, figure: "Figure") -> tuple[Path, ...]:
    """Write a figure in the formats of `workflow.formats`; returns the files.

    Raises:
        RunError: it holds numbers that cannot be drawn.
    """
    from analysis.figures.style import picture

    paths = tuple(directory / file for file in figure_files(name))
    for path in paths:
        try:
            content = picture(figure, path.suffix[1:])
        except OverflowError:
            raise RunError(f"{path}: numbers near 1e308 cannot be drawn; are the frames damaged?") from None
        write_bytes(path, content)
    return paths


def write_text(path: Path, text: str) -> None:
    """Write a text file whole or not at all."""
    write_bytes(path, text.encode("utf-8"))


def write_json(path: Path, data: dict[str, Any]) -> None:
    """Write JSON whole or not at all; numbers round-trip, and what is not finite becomes null, for JSON has no NaN."""
    write_text(path, as_json(data) + "\n")


def as_json(data: Any) -> str:
    """JSON of plain data; what is not finite becomes null, for JSON has no NaN."""
    return json.dumps(_finite(data), indent=2, ensure_ascii=False, allow_nan=False)


def _finite(data: Any) -> Any:
    if isinstance(data, dict):
        return {key: _finite(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [_finite(value) for value in data]
    return None if isinstance(data, float) and not math.isfinite(data) else data
