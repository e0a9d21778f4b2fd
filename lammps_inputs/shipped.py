"""The installed scenes, found without loading the types of scenes, which takes half a second."""

import importlib.resources
from pathlib import Path

from lammps_inputs import strict_yaml


def installed() -> dict[str, Path]:
    """Name -> file of the scenes that come with the package."""
    folder = Path(str(importlib.resources.files("lammps_inputs") / "scenes"))
    return {path.stem: path for path in sorted(folder.glob("*.yaml"))}


def descriptions() -> dict[str, str]:
    """Name -> what the scene says of itself in one line."""
    return {name: str(strict_yaml.load(path).get("description", "")) for name, path in installed().items()}
