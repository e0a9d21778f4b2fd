"""Pages to look at a run or a sweep with: one self-contained HTML file each, drawn by Bokeh. Computes nothing new."""

import os
import sys
import webbrowser

from granchain import InputError


def need_bokeh(command: str = "view") -> None:
    """See that what draws is there, for a command.

    Raises:
        InputError: it is not.
    """
    try:
        import bokeh  # noqa: F401
    except ImportError:
        raise InputError(f"{command}: draws with Bokeh, which is not installed; `pip install 'bokeh>=3.4'`") from None


def open_in_browser(address: str) -> bool:
    """Open a page in the user's browser; whether there is a screen for one."""
    has_screen = sys.stdout.isatty() and (
        sys.platform == "darwin" or "DISPLAY" in os.environ or "WAYLAND_DISPLAY" in os.environ
    )
    if has_screen:
        webbrowser.open(address)
    return has_screen
