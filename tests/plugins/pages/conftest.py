"""The browser opens pages without a network."""

import pytest

READY = "window.Bokeh && Bokeh.documents.length && Bokeh.documents[0].is_idle"


@pytest.fixture
def open_page(browser):
    """Opens a page without a network; fails at the end if a page complained or asked for anything."""
    complaints = []

    def complain_of(asked, url):
        if asked.url.split("#")[0] != url and not asked.url.startswith(("data:", "blob:")):
            complaints.append(asked.url)

    def opened(path, fragment="", width=1300):
        url = path.resolve().as_uri()
        page = browser.new_context(offline=True, viewport={"width": width, "height": 1700}).new_page()
        page.set_default_timeout(120_000)
        page.on("console", lambda said: complaints.append(said.text) if said.type in ("error", "warning") else None)
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on("request", lambda asked: complain_of(asked, url))
        page.goto(url + fragment)
        page.wait_for_function(READY)
        return page

    yield opened
    assert complaints == []
