"""Test the tree without some plug-ins: ``python tests/support/core_alone.py [NAME...] [-- ARGUMENT OF PYTEST...]``.

A plug-in is a folder of ``workflow/plugins``, with its tests in ``tests/plugins``. Without names, or with ``all``, all
plug-ins are deleted. The tests, the fast ones unless arguments say otherwise, run in a copy of the tree that has
neither the folders of these plug-ins nor their tests, and does not declare them in ``pyproject.toml``. A plug-in that
imports a deleted one is deleted, too. Tests of others that need a deleted one are skipped by its name (`plug_ins`).
"""

import ast
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from tree_metadata import write_metadata

ROOT = Path(__file__).parents[2]

PLUG_INS = "workflow/plugins"

TESTS = "tests/plugins"


def plug_ins() -> list[str]:
    """Names of all plug-ins."""
    folders = (ROOT / PLUG_INS).iterdir()
    return sorted(folder.name for folder in folders if folder.is_dir() and folder.name != "__pycache__")


def imported_by(path: Path) -> set[str]:
    """Names of the plug-ins that a module imports, anywhere in it."""
    modules = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            modules |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            modules |= {f"{node.module}.{alias.name}" for alias in node.names}
    prefix = PLUG_INS.replace("/", ".") + "."
    return {module.removeprefix(prefix).partition(".")[0] for module in modules if module.startswith(prefix)}


def imports() -> dict[str, set[str]]:
    """Plug-in -> the others that its modules import."""
    return {
        name: {other for path in (ROOT / PLUG_INS / name).rglob("*.py") for other in imported_by(path)} - {name}
        for name in plug_ins()
    }


def with_those_that_stand_on(names: set[str]) -> set[str]:
    """These plug-ins and all that import one of them, directly or not."""
    deleted = set(names)
    while more := {name for name, others in imports().items() if others & deleted} - deleted:
        deleted |= more
    return deleted


def tracked() -> Iterator[str]:
    """Files of the tree that git does not ignore."""
    words = ["git", "ls-files", "--cached", "--others", "--exclude-standard", "-z"]
    listed = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    yield from (name for name in listed.split("\0") if name and (ROOT / name).exists())


def copy_without(names: set[str], copy: Path) -> None:
    """Write the tree without some plug-ins, and the metadata that an installation of it would have."""
    folders = tuple(f"{parent}/{name}/" for parent in (PLUG_INS, TESTS) for name in names)
    if names == set(plug_ins()):
        folders += (f"{PLUG_INS}/", f"{TESTS}/")
    for name in tracked():
        if not name.startswith(folders):
            (copy / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, copy / name)
    any_of = "|".join(names) or "(?!)"  # which matches nothing
    _drop_lines(copy / "workflow" / "README.md", rf"^- \[.*\]\(plugins/({any_of})/")
    project_file = copy / "pyproject.toml"
    _drop_lines(project_file, rf'["/]{PLUG_INS.replace("/", "[./]")}[./]({any_of})\b')
    write_metadata(project_file, copy)


def _drop_lines(path: Path, pattern: str) -> None:
    """Leave out the lines of a file in which a pattern is found."""
    lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
    path.write_text("".join(line for line in lines if not re.search(pattern, line)), encoding="utf-8")


def main(arguments: list[str]) -> int:
    """Exit code of pytest on such a copy."""
    end = arguments.index("--") if "--" in arguments else len(arguments)
    words, rest = arguments[:end], arguments[end + 1 :]
    names = set(plug_ins()) if words in ([], ["all"]) else set(words)
    if unknown := names - set(plug_ins()):
        print(f"no plug-in {', '.join(sorted(unknown))}; there are {', '.join(plug_ins())}", file=sys.stderr)
        return 2
    deleted = with_those_that_stand_on(names)
    print("without", ", ".join(sorted(deleted)), flush=True)
    with tempfile.TemporaryDirectory() as directory:
        copy = Path(directory)
        copy.chmod(0o755)  # tests that give up root still read it
        copy_without(deleted, copy)
        # before the installation in the order of imports, and so are its entry points
        environment = {
            **os.environ,
            "PYTHONPATH": os.pathsep.join([str(copy), str(copy / "workflow" / "python")]),
            "GRANCHAIN_TESTS_WITHOUT": " ".join(sorted(deleted)),  # for `plug_ins`
        }
        return subprocess.run([sys.executable, "-m", "pytest", *rest], cwd=copy, env=environment).returncode


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
