"""The page of a scene in a cell of a notebook, served from its process."""

import asyncio
import threading
from html import escape

from granchain import load
from granchain.parts import checked, inputs
from workflow.plugins.pages import need_bokeh

HEIGHT = 1100
"""Pixels of the frame in a notebook."""


class ExplorerPage:
    """Page of a scene, served from this process until it is closed; a notebook on this machine displays it.

    Args:
        scene: what the page is about; see `granchain.load`.
    """

    def __init__(self, scene: inputs.AnyScene) -> None:
        from workflow.plugins.explore.server import LocalServer  # bokeh takes half a second to import

        self._server = LocalServer(load(scene), inputs.source_of(scene))
        self._started = threading.Event()
        self._thread = threading.Thread(target=lambda: asyncio.run(self._serve()), daemon=True)
        self._thread.start()
        self._started.wait()

    async def _serve(self) -> None:
        self._loop, self._ended = asyncio.get_running_loop(), asyncio.Event()
        await self._server.serve(self._ended, self._started.set)

    @property
    def address(self) -> str:
        """Address of the page, for a browser on this machine."""
        return self._server.address

    def close(self) -> None:
        """End the server; the page then says that its connection is lost."""
        if self._thread.is_alive():
            self._loop.call_soon_threadsafe(self._ended.set)
            self._thread.join()

    def __repr__(self) -> str:
        return f"<page {self.address}>" if self._thread.is_alive() else "<page, closed>"

    def _repr_html_(self) -> str:
        if not self._thread.is_alive():
            return f"<p>{escape(repr(self)[1:-1])}</p>"
        return f'<iframe src="{escape(self.address, quote=True)}" width="100%" height="{HEIGHT}"></iframe>'


@checked
def explore(scene: inputs.AnyScene) -> ExplorerPage:
    """Serve a page on which the numbers of a scene are changed and the reference integrator computes it anew.

    Args:
        scene: see `load`.

    Returns:
        The page, which a notebook in a browser on this machine displays; its method ``close`` ends it.

    Raises:
        InputError: there is no such scene, or Bokeh is not installed.

    Examples:
        >>> page = granchain.explore("two-chains")
        >>> page.close()
        >>> page
        <page, closed>
    """
    need_bokeh("explore")
    return ExplorerPage(scene)
