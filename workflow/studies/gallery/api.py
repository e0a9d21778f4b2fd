"""The gallery for scripts and notebooks: ``workflow.api.gallery``."""

from collections.abc import Sequence
from pathlib import Path

from workflow.api import as_path
from workflow.screen import count_bar
from workflow.studies.gallery import study


def gallery(directory: Path | str, names: Sequence[str] = ()) -> study.Sections:
    """Compute published results and compare them with the publications, as ``index.html``; all entries, or those named.

    Raises:
        InputError: there is no such entry, or the directory cannot be used.
    """
    with count_bar("gallery") as progress:
        return study.gallery(as_path(directory), [names] if isinstance(names, str) else names, progress=progress)
