"""A real browser for the tests of pages."""

import os
import shutil

import pytest


@pytest.fixture(scope="session")
def browser():
    path = shutil.which("chromium")
    if path is None:
        assert not os.environ.get("CI"), "continuous integration installs chromium"
        pytest.skip("chromium is not installed")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as driver:
        started = driver.chromium.launch(executable_path=path, args=["--no-sandbox", "--disable-gpu"])
        yield started
        started.close()


@pytest.fixture
def look(browser):
    """Opens a page without a network; fails at its end if the page complained."""
    complaints = []

    def opened(path, **options):
        page = browser.new_context(offline=True, viewport={"width": 1300, "height": 1700}, **options).new_page()
        page.set_default_timeout(120_000)
        page.on("console", lambda said: complaints.append(said.text) if said.type in ("error", "warning") else None)
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.goto(path.resolve().as_uri())
        page.wait_for_function("window.Bokeh && Bokeh.documents.length && Bokeh.documents[0].is_idle")
        return page

    yield opened
    assert complaints == []
