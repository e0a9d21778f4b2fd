"""Fits go on from one start alone, which is near enough in all tests."""

from collections.abc import Iterator

import pytest

from workflow.plugins.fit import study


@pytest.fixture(scope="package", autouse=True)
def from_the_start_alone() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(study, "STARTS", 1)
        patch.setattr(study, "BEGUN", 1)
        yield
