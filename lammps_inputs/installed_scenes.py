"""The installed scenes, found without loading the types of scenes, which takes half a second.

Examples:
    >>> installed_scenes.installed()["two-chains"].name
    'two-chains.yaml'
    >>> installed_scenes.descriptions()["one-chain"]
    'one chain: the solitary wave, for comparison'
"""

import importlib.resources
from pathlib import Path

from lammps_inputs import plugins, strict_yaml


def installed() -> dict[str, Path]:
    """Name -> file of the scenes that come with granchain, and then with other distributions (`plugins`)."""
    files: dict[str, Path] = {}
    for point in plugins.declared("scenes").values():
        paths = [Path(str(path)) for path in importlib.resources.files(point.value).iterdir()]
        files |= {path.stem: path for path in sorted(paths) if path.suffix == ".yaml" and path.stem not in files}
    return files


def descriptions() -> dict[str, str]:
    """Name -> what the scene says of itself in one line."""
    return {name: str(strict_yaml.load(path).get("description", "")) for name, path in installed().items()}
