"""The one way in which functions are compiled, and where the machine code is kept between processes.

numba's cache on disk notices a change of the file that holds a function, not of the functions that it inlines from
others. So the code is kept in a directory that is named after a hash of all sources that are ever compiled, and of the
versions: whatever changes, nothing old is found.
"""

import functools
import hashlib
import importlib.metadata
import inspect
import os
import stat
import tempfile
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
from numba.core import event

from lammps_inputs.ingredients import INGREDIENTS
from workflow import screen

_config: Any = numba.config

F = TypeVar("F", bound=Callable[..., Any])

_SOURCES = ("lammps_inputs/laws", "workflow/engines/reference", "workflow/engines/collisions")


def compiled(function: F | None = None, **options: Any) -> Any:
    """The function as machine code, kept on disk where there is a place for it; options are numba's."""
    if function is None:
        return functools.partial(compiled, **options)
    place = cache_directory()
    before = _config.CACHE_DIR
    try:
        _config.CACHE_DIR = str(place)
        return cast(F, numba.njit(cache=place is not None, **options)(function))
    finally:
        _config.CACHE_DIR = before


def inner(function: F) -> F:
    """The same for a function that compiled ones alone call: what Python needs to call it takes long to compile."""
    return cast(F, compiled(function, no_cpython_wrapper=True))


class _Hint(event.Listener):
    """Says once for each engine that it is compiled, not merely found compiled."""

    def __init__(self) -> None:
        self._said: set[str] = set()

    def on_start(self, event: Any) -> None:
        """Say which engine, and how often that will happen."""
        module = str(event.data["dispatcher"].py_func.__module__)
        name = next((name for folder, name in _ENGINES.items() if module.startswith(folder)), None)
        if name is None or name in self._said:
            return
        self._said.add(name)
        often = "once for this kind of scene" if cache_directory() else "anew each time: no directory can keep it"
        screen.hint(f"compiling {name}, which takes some ten seconds; {often}")

    def on_end(self, event: Any) -> None:
        """Say nothing."""


_ENGINES = {"workflow.engines.reference": "the reference", "workflow.engines.collisions": "the engine of rigid beads"}

_events: Any = event
_events.register("numba:compile", _Hint())


@functools.cache
def cache_directory() -> Path | None:
    """Where machine code of just these sources is kept; None if no directory can be written that only we can write.

    In ``$NUMBA_CACHE_DIR``, the user's cache directory, or a private one among the temporary files.
    """
    private = Path(tempfile.gettempdir()) / f"granchain-{os.getuid()}"
    named = [os.environ.get("NUMBA_CACHE_DIR"), os.environ.get("XDG_CACHE_HOME")]
    home = os.environ.get("HOME")
    bases = [*(Path(name) / "granchain" for name in named if name), *([Path(home, ".cache/granchain")] if home else [])]
    for base in (*bases, private):
        place = base / f"compiled-{fingerprint(sources())[:16]}"
        try:
            for folder in (base, place):
                folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            if all(_ours(folder) for folder in (base, place)) and os.access(place, os.W_OK | os.X_OK):
                return place
        except OSError:
            continue
    return None


def _ours(folder: Path) -> bool:
    """Whether nobody else can put a file there: what is found is run."""
    found = folder.lstat()
    return found.st_uid == os.getuid() and not found.st_mode & (stat.S_IWGRP | stat.S_IWOTH)


def fingerprint(sources: Iterable[tuple[str, bytes]]) -> str:
    """SHA-256 over names and contents of sources, and the versions of what compiles them."""
    digest = hashlib.sha256()
    for name in ("granchain", "numba", "numpy"):
        digest.update(f"{name} {importlib.metadata.version(name)}\n".encode())
    for name, content in sources:
        digest.update(f"{name} {len(content)}\n".encode() + content)
    return digest.hexdigest()


def sources() -> list[tuple[str, bytes]]:
    """All that is ever compiled: laws, engines, and the modules of a user's own ingredients."""
    root = Path(__file__).parents[1]
    files = [file for folder in _SOURCES for file in sorted((root / folder).rglob("*.py"))]
    own = {inspect.getsourcefile(ingredient) for ingredient in INGREDIENTS.values()}
    files += sorted(Path(file) for file in own if file and root not in Path(file).parents)
    return [
        (file.relative_to(root).as_posix() if root in file.parents else file.name, file.read_bytes()) for file in files
    ]
