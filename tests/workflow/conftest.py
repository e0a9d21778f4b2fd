"""Runs that several tests look at, made once; a browser."""

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


@pytest.fixture(scope="module")
def browser(executable):
    """Chromium, driven by playwright."""
    path = executable("chromium")
    from playwright.sync_api import sync_playwright  # only for those who need it

    with sync_playwright() as driver:
        started = driver.chromium.launch(executable_path=path, args=["--no-sandbox", "--disable-gpu"])
        yield started
        started.close()
