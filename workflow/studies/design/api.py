"""Designs for scripts and notebooks: ``workflow.api.design``."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from workflow.api import as_path
from workflow.studies.design import file, study
from workflow.studies.design.result import DesignResult


def design(
    definition: Mapping[str, Any] | Path | str, directory: Path | str, *, jobs: int | None = None
) -> DesignResult:
    """Find the scene that minimises or maximises a quantity within bounds, on all cores; resumes an interrupted call.

    Args:
        definition: a design file, or its content as a mapping.
        directory: new, or resumed.
        jobs: designs at a time; as many as there are cores by default.

    Raises:
        InputError: the file is invalid, or no design is within its limits.
        RunError: LAMMPS failed.
    """
    wanted = (
        file.from_plain(dict(definition), Path("design"))
        if isinstance(definition, Mapping)
        else file.load(Path(definition))
    )
    return study.carry_out(wanted, as_path(directory), jobs)
