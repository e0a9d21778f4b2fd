"""The last section of every page: what it cites, and when, where and with which versions it was made.

Examples:
    >>> page = provenance.foot(["hertz1882"], note="One run.")
    >>> "H. Hertz" in page, "One run." in page
    (True, True)
"""

import functools
import html
import importlib.metadata
import os
import platform
import subprocess
from collections.abc import Iterable
from datetime import datetime
from pathlib import Path

from lammps_inputs import references

HOME = Path(__file__).resolve().parents[1]
STYLE = (
    "<style>.provenance { font-size: .9rem; border-top: 1px solid #999; margin-top: 2rem; } "
    ".provenance h2 { font-size: 1.1rem; margin: .8rem 0 .2rem; } .provenance p { margin: .2rem 0; }</style>"
)


def foot(cited: Iterable[str], note: str = "") -> str:
    """References and provenance, in HTML.

    Args:
        cited: keys of the bibliography, in the order of their numbers on the page; none twice.
        note: a further line on the origin of the numbers.
    """
    listed = "".join(
        f'<li id="r{number}">{html.escape(references.text(key))}.</li>' for number, key in enumerate(cited, 1)
    )
    literature = f"<h2>References</h2><ol>{listed}</ol>" if listed else ""
    lines = "".join(f"<p>{html.escape(line)}</p>" for line in (*made_by(), note) if line)
    return f'<footer class="provenance">{STYLE}{literature}<h2>Provenance</h2>{lines}</footer>'


def made_by() -> tuple[str, ...]:
    """Software with versions and commit, date, and machine, in one line each."""
    return (
        f"Software: granchain {importlib.metadata.version('granchain')}{commit()}, "
        f"LAMMPS {importlib.metadata.version('lammps')}, Python {platform.python_version()}.",
        f"Date: {datetime.now().astimezone().isoformat(sep=' ', timespec='minutes')}.",
        f"Machine: {processor()}, {os.cpu_count()} cores, {platform.system()}.",
    )


@functools.cache
def commit() -> str:
    """The git commit of a working copy, as ``(commit abc)`` after a blank; nothing for an installed package."""
    if not (HOME / ".git").exists():
        return ""
    command = ["git", "-C", str(HOME), "describe", "--always", "--dirty", "--exclude=*"]
    try:
        completed = subprocess.run(command, capture_output=True, text=True, timeout=10, check=True)
    except (OSError, subprocess.SubprocessError):
        return ""
    return f" (commit {completed.stdout.strip()})"


@functools.cache
def processor() -> str:
    """Name of the processor, or its architecture where the system does not report it."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        lines = []
    names = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(names, "") or platform.processor() or platform.machine()
