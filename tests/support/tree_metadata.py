"""Metadata of an installed distribution, from a ``pyproject.toml``: what makes its entry points known."""

import tomllib
from pathlib import Path
from typing import Any


def write_metadata(project_file: Path, directory: Path) -> dict[str, Any]:
    """Write the ``dist-info`` of a project into a directory, for PYTHONPATH; the project's table."""
    project = tomllib.loads(project_file.read_text(encoding="utf-8"))["project"]
    metadata = directory / f"{project['name']}-{project['version']}.dist-info"
    metadata.mkdir(exist_ok=True)
    (metadata / "METADATA").write_text(
        f"Metadata-Version: 2.3\nName: {project['name']}\nVersion: {project['version']}\n", encoding="utf-8"
    )
    groups = {"console_scripts": project["scripts"], **project["entry-points"]}
    sections = [
        f"[{group}]\n" + "".join(f"{name} = {value}\n" for name, value in points.items())
        for group, points in groups.items()
    ]
    (metadata / "entry_points.txt").write_text("\n".join(sections), encoding="utf-8")
    return project
