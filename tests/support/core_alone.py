"""Runs the tests of the core without plug-ins: ``python tests/support/core_alone.py [ARGUMENT OF PYTEST...]``.

Studies and tools are plug-ins. The tests run in a copy of the tree that has neither ``workflow/studies`` and
``workflow/tools`` nor their tests, and declares none of them.
"""

import os
import shutil
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[2]

PLUG_INS = ("workflow/studies", "workflow/tools", "tests/workflow/studies", "tests/workflow/tools")

DECLARED = ('= "workflow.studies.', '= "workflow.tools.')
"""What lines of ``pyproject.toml`` that declare them hold."""


def copy_without_plug_ins(copy: Path) -> None:
    """Write what git does not ignore, but plug-ins, and the metadata that an installation of it would have."""
    words = ["git", "ls-files", "--cached", "--others", "--exclude-standard", "-z"]
    listed = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    for name in filter(None, listed.split("\0")):
        if not name.startswith(tuple(f"{folder}/" for folder in PLUG_INS)) and (ROOT / name).exists():
            (copy / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, copy / name)
    project_file = copy / "pyproject.toml"
    lines = project_file.read_text(encoding="utf-8").splitlines(keepends=True)
    project_file.write_text(
        "".join(line for line in lines if not any(words in line for words in DECLARED)), encoding="utf-8"
    )
    project = tomllib.loads(project_file.read_text(encoding="utf-8"))["project"]
    metadata = copy / f"{project['name']}-{project['version']}.dist-info"
    metadata.mkdir()
    (metadata / "METADATA").write_text(
        f"Metadata-Version: 2.3\nName: {project['name']}\nVersion: {project['version']}\n", encoding="utf-8"
    )
    groups = {"console_scripts": project["scripts"], **project["entry-points"]}
    sections = [
        f"[{group}]\n" + "".join(f"{name} = {value}\n" for name, value in points.items())
        for group, points in groups.items()
    ]
    (metadata / "entry_points.txt").write_text("\n".join(sections), encoding="utf-8")


def main(arguments: list[str]) -> int:
    """Exit code of pytest with these arguments on such a copy."""
    with tempfile.TemporaryDirectory() as directory:
        copy = Path(directory)
        copy.chmod(0o755)  # tests that give up root still read it
        copy_without_plug_ins(copy)
        # before the installation in the order of imports, and so are its entry points
        environment = {**os.environ, "PYTHONPATH": str(copy)}
        return subprocess.run([sys.executable, "-m", "pytest", *arguments], cwd=copy, env=environment).returncode


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
