"""Fits for scripts and notebooks: ``workflow.api.fit``."""

from collections.abc import Sequence
from pathlib import Path

from workflow.api import AnyScene, as_path, load
from workflow.studies.fit import study
from workflow.studies.fit.result import Fit


def fit(
    scene: AnyScene,
    against: Path | str,
    free: Sequence[str],
    directory: Path | str,
    *,
    offset: float | None = None,
    lammps: bool = True,
) -> Fit:
    """Estimate fields of a scene from measured traces, with confidence intervals where a test of fit is passed.

    Writes the same files as ``granchain fit``.

    Args:
        scene: its values are the start of the search.
        against: table of traces in the scene's units.
        free: fields to estimate, such as ``["coupling.stiffness", "kick.velocity"]``.
        directory: created if it does not exist.
        offset: by how much the table's times are later than the scene's; None to estimate it, too.
        lammps: whether to run the fitted scene in LAMMPS.

    Raises:
        InputError: the scene, the table or a field cannot be used.
        RunError: LAMMPS failed.
    """
    names = [free] if isinstance(free, str) else list(free)
    source = str(scene) if isinstance(scene, str | Path) else "scene"
    return study.fit(
        load(scene).plain(), Path(against), names, as_path(directory), source=source, offset=offset, lammps=lammps
    )
