"""Runs of LAMMPS that measure a deck are forks of one process, but where a test is about processes."""

import pytest
from lammps_in_fork import lammps_in_fork

from workflow.plugins.adopt import evaluate


@pytest.fixture
def here(monkeypatch: pytest.MonkeyPatch) -> None:
    """The four runs of LAMMPS are forks of one process, for claims that are not about processes."""
    monkeypatch.setattr(evaluate.Workplace, "lammps", lammps_in_fork)
