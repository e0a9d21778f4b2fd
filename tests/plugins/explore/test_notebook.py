"""`granchain.explore` in a notebook: the page is served from its process until it is closed."""

import re
import threading
import urllib.error
import urllib.request

import pytest

import granchain


def test_the_page_of_a_cell_is_a_frame_of_a_server_that_ends_with_close():
    threads = set(threading.enumerate())
    page = granchain.explore({"name": "tiny", "beads": 8, "kick": {"velocity": 1.0}, "duration": 4.0})
    (address,) = re.findall(r'<iframe src="(http://127\.0\.0\.1:\d+/[\w-]+/)"', page._repr_html_())
    assert address == page.address
    with urllib.request.urlopen(address) as answer:
        assert b"tiny: explore" in answer.read()
    page.close()
    page.close()
    assert "iframe" not in page._repr_html_()
    with pytest.raises(urllib.error.URLError):
        urllib.request.urlopen(address)
    for thread in set(threading.enumerate()) - threads:
        thread.join()  # of the tab's computation
