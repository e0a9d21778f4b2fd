"""The browser opens pages without a network."""

import pytest


@pytest.fixture(scope="module")
def open_page(browser):
    """Opens a page without a network; fails at the end of the module if a page complained or asked for anything."""
    complaints = []

    def opened(
        path,
        fragment="",
        *,
        waiting="window.Bokeh && Bokeh.documents.length && Bokeh.documents[0].is_idle",
        width=1300,
        height=1700,
        **options,
    ):
        url = path.resolve().as_uri()
        context = browser.new_context(offline=True, viewport={"width": width, "height": height}, **options)
        page = context.new_page()
        page.set_default_timeout(120_000)
        page.on("console", lambda said: complaints.append(said.text) if said.type in ("error", "warning") else None)
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on(
            "request",
            lambda asked: (
                None
                if asked.url.split("#")[0] == url or asked.url.startswith(("data:", "blob:"))
                else complaints.append(asked.url)
            ),
        )
        page.goto(url + fragment)
        page.wait_for_function(waiting)
        return page

    yield opened
    assert complaints == []


@pytest.fixture
def look(open_page):
    return open_page
