"""Runs that several tests look at, made once."""

import functools

import pytest

from workflow.cli import main


@pytest.fixture(scope="session")
def paper(tmp_path_factory):
    """Name of an installed scene -> directory of its run, made and analysed by the command line."""

    @functools.cache
    def directory(name):
        path = tmp_path_factory.mktemp("paper") / name
        assert main(["run", name, "-o", str(path)]) == 0
        assert main(["analyze", str(path), "--no-figures"]) == 0
        return path

    return directory
