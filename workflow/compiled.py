"""The one way in which functions are compiled, and where the machine code is kept between processes.

Programs that are written for the laws of a system (`module`) are kept there, too.

numba's cache on disk notices a change of the file that holds a function, not of the functions that it inlines from
others. So the code is kept in a directory that is named after a hash of all sources that are ever compiled, and of the
versions: whatever changes, nothing old is found.

Plug-ins take this module for loops of their own, such as those of an engine: `ieee` compiles a function that Python
calls, `ieee_called_by_compiled` one that only compiled functions call.

Examples:
    >>> @compiled.ieee
    ... def inverse(number):
    ...     return 1.0 / number
    >>> inverse(4.0), inverse(0.0)  # IEEE arithmetic: no exception
    (0.25, inf)
"""

import contextlib
import functools
import gc
import hashlib
import importlib.metadata
import inspect
import os
import stat
import sys
import tempfile
from collections.abc import Callable, Iterable
from importlib.abc import InspectLoader
from importlib.util import find_spec, module_from_spec, spec_from_file_location, spec_from_loader
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any, TypeVar, cast

import numba
from numba.core import event
from numba.core.dispatcher import Dispatcher

from lammps_inputs import plugins
from lammps_inputs.ingredients.registry import INGREDIENTS
from workflow import processor_time, screen

_config: Any = numba.config

F = TypeVar("F", bound=Callable[..., Any])

_SOURCES = (
    "lammps_inputs/laws",
    "workflow/engines/lammps",
    "workflow/engines/reference",
)

_COMPILES_NOTHING = "workflow.runs"
"""Package that declares LAMMPS and the reference as engines."""


def compiled(function: F, **options: Any) -> F:
    """The function as machine code, kept in the cache directory where there is one; options are numba's."""
    place = cache_directory()
    before = _config.CACHE_DIR
    try:
        _config.CACHE_DIR = str(place)
        cache = place is not None and Path(function.__code__.co_filename).is_file()
        return cast(F, numba.njit(cache=cache, **options)(function))
    finally:
        _config.CACHE_DIR = before


def called_by_compiled(function: F) -> F:
    """The function compiled for calls by compiled ones alone: what Python needs to call it takes long to compile."""
    return compiled(function, no_cpython_wrapper=True)


_IEEE: Any = {"error_model": "numpy", "forceinline": True}
"""IEEE arithmetic: no reordering, division by zero gives inf; inlined into callers."""


def inlined(function: F) -> F:
    """A scalar function, such as one of a law, compiled for loops that are to become vector instructions.

    Arithmetic is IEEE's: a test of each divisor would prevent such instructions.
    """
    options: Any = {**_IEEE, "no_cpython_wrapper": True}
    return cast(F, numba.njit(**options)(function))


def ieee(function: F) -> F:
    """The function with IEEE arithmetic.

    Inlined into its callers, since most of the time would go into counting references to the arrays it is handed.
    """
    return compiled(function, **_IEEE)


def ieee_called_by_compiled(function: F) -> F:
    """The function with IEEE arithmetic, compiled for calls by compiled ones alone."""
    return compiled(function, no_cpython_wrapper=True, **_IEEE)


@functools.cache
def module(text: str) -> ModuleType:
    """A module made from a text, which is kept as a file in the cache directory where there is one."""
    name = f"{_WRITTEN}{hashlib.sha256(text.encode()).hexdigest()[:16]}"
    place = cache_directory()
    spec = spec_from_loader(name, _Text(text))
    if place is not None:
        with contextlib.suppress(OSError):
            spec = spec_from_file_location(name, _written(place / f"{name}.py", text))
    assert spec is not None
    assert spec.loader is not None
    loaded = sys.modules[name] = module_from_spec(spec)
    spec.loader.exec_module(loaded)
    return loaded


def _written(path: Path, text: str) -> Path:
    """Write a file at once, with a fixed time: numba takes the code of a file with another time for stale."""
    if not path.is_file() or path.read_text(encoding="utf-8") != text:
        with tempfile.NamedTemporaryFile("w", encoding="utf-8", dir=path.parent, delete=False) as file:
            file.write(text)
        os.utime(file.name, (0, 0))
        Path(file.name).replace(path)
    return path


class _Text(InspectLoader):
    """Loads a module from a text that is in no file."""

    def __init__(self, text: str) -> None:
        self._text = text

    def get_source(self, fullname: str) -> str:  # noqa: ARG002
        """The text."""
        return self._text


def digest(functions: Iterable[Any]) -> str:
    """Hash of the modules of functions, and of what these take from others: functions, modules and numbers."""
    contents: dict[str, bytes] = {}
    waiting, done = list(functions), set()
    while waiting:
        value = waiting.pop()
        value = value.py_func if isinstance(value, Dispatcher) else value
        if not isinstance(value, FunctionType | ModuleType) or value in done:
            continue
        done.add(value)
        name = value.__name__ if isinstance(value, ModuleType) else value.__module__
        file = vars(sys.modules[name]).get("__file__") if name in sys.modules else None
        if file is not None:
            contents[name] = Path(file).read_bytes()
        if isinstance(value, FunctionType):
            taken = {other: value.__globals__.get(other) for other in value.__code__.co_names}
            contents |= {
                f"{name}.{other}": repr(it).encode() for other, it in taken.items() if isinstance(it, int | float)
            }
            waiting += taken.values()
    return fingerprint(sorted(contents.items()))


class _Hint(event.Listener):
    """Prints a hint once for each engine that is compiled rather than loaded from the cache."""

    def __init__(self) -> None:
        self._said: set[str] = set()

    def on_start(self, event: Any) -> None:
        """Print which engine is compiled, and how often that happens."""
        module = str(event.data["dispatcher"].py_func.__module__)
        name = "the reference" if module.startswith(_WRITTEN) else _engine_of(module)
        if name is None or name in self._said:
            return
        self._said.add(name)
        often = "once for this kind of scene" if cache_directory() else "each time: no cache directory is writable"
        screen.hint(f"compiling {name}; takes a few seconds, {often}")

    def on_end(self, event: Any) -> None:
        """Print nothing."""


class _Compiling(event.Listener):
    """Pauses the garbage collector during a compilation, which makes a million objects, none of them garbage.

    Searching them takes a sixth of its time. A compilation may be part of another; numba lets no other thread compile.
    Its processor time is left out of what is limited (`workflow.processor_time`).
    """

    def __init__(self) -> None:
        self._under_way = 0
        self._collects = False
        self._started = 0.0

    def on_start(self, event: Any) -> None:  # noqa: ARG002
        """Pause the collector."""
        if self._under_way == 0:
            self._started = processor_time.clock()
            self._collects = gc.isenabled()
            gc.disable()
        self._under_way += 1

    def on_end(self, event: Any) -> None:  # noqa: ARG002
        """Start the collector again if it was running."""
        self._under_way -= 1
        if self._under_way == 0:
            processor_time.leave_out(processor_time.clock() - self._started)
        if self._under_way == 0 and self._collects:
            gc.enable()


_WRITTEN = "granchain_program_"
"""Start of the names of modules that are made from texts."""

_events: Any = event
for _listener in (_Hint(), _Compiling()):
    _events.register("numba:compile", _listener)


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
    """Whether nobody else can put a file into a folder, as its files are executed."""
    state = folder.lstat()
    return state.st_uid == os.getuid() and not state.st_mode & (stat.S_IWGRP | stat.S_IWOTH)


def fingerprint(sources: Iterable[tuple[str, bytes]]) -> str:
    """SHA-256 over names and contents of sources, and the versions of what compiles them."""
    digest = hashlib.sha256()
    for name in ("granchain", "numba", "numpy"):
        digest.update(f"{name} {importlib.metadata.version(name)}\n".encode())
    for name, content in sources:
        digest.update(f"{name} {len(content)}\n".encode() + content)
    return digest.hexdigest()


def _engine_packages() -> dict[str, str]:
    """Package of each engine that is a plug-in -> name of the engine's entry point."""
    packages = {point.module.rpartition(".")[0]: name for name, point in plugins.declared("engines").items()}
    return {package: name for package, name in packages.items() if package not in ("", _COMPILES_NOTHING)}


def _engine_of(module: str) -> str | None:
    """What the engine that a module belongs to is called in sentences; None where it belongs to none."""
    package = module.rpartition(".")[0]
    entry = _engine_packages().get(package)
    return None if entry is None else str(plugins.load("engines", entry).title)


def sources() -> list[tuple[str, bytes]]:
    """All that is ever compiled: laws, engines, and the modules of a user's own ingredients."""
    root = Path(__file__).parents[1]
    files = [file for folder in _SOURCES for file in sorted((root / folder).rglob("*.py"))]
    files += [
        file
        for package in _engine_packages()
        if (spec := find_spec(package)) is not None
        for folder in spec.submodule_search_locations or ()
        for file in sorted(Path(folder).rglob("*.py"))
    ]
    ingredient_files = {
        inspect.getsourcefile(kind) for ingredient in INGREDIENTS.values() for kind in (ingredient, *ingredient.kinds())
    }
    files += sorted(Path(file) for file in ingredient_files if file and root not in Path(file).parents)
    return [
        (file.relative_to(root).as_posix() if root in file.parents else file.name, file.read_bytes()) for file in files
    ]
