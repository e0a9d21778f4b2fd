"""The local server of the explorer: bound to this machine, under an address that holds a secret."""

import asyncio
import secrets
from collections.abc import Callable

from bokeh.application import Application
from bokeh.application.handlers.function import FunctionHandler
from bokeh.server.server import BaseServer
from bokeh.server.tornado import BokehTornado
from bokeh.server.util import bind_sockets
from tornado.httpserver import HTTPServer
from tornado.ioloop import IOLoop

from granchain import InputError, Scene
from workflow.plugins.explore.page import Tab

HOST = "127.0.0.1"

CLOSED_AFTER = 5_000
"""Milliseconds after which a tab without a connection counts as closed; a reloaded page begins anew."""


class LocalServer:
    """Server of the page of one scene; each tab has numbers of its own.

    Args:
        scene: what the page is about.
        source: what the user calls it, for messages.
        port: port of this machine; any free one by default.

    Raises:
        InputError: the port cannot be had.
    """

    def __init__(self, scene: Scene, source: str, port: int = 0) -> None:
        self._scene, self._source = scene, source
        if not 0 <= port < 1 << 16:
            raise InputError(f"--port: {port} given; a number from 1024 to 65535, or leave it out for a free one")
        try:
            self._sockets, self._port = bind_sockets(HOST, port)
        except OSError as error:
            raise InputError(f"--port: {port} cannot be had ({error.strerror}); leave it out for a free one") from None
        self._secret = secrets.token_urlsafe(24)

    @property
    def address(self) -> str:
        """Address of the page; whoever has it can open the page on this machine."""
        return f"http://{HOST}:{self._port}/{self._secret}/"

    async def serve(self, ended: asyncio.Event, started: Callable[[], None]) -> None:
        """Serve until an event, or until it is cancelled; call a function when the page can be opened."""
        application = BokehTornado(
            {"/": Application(FunctionHandler(lambda document: self._open(document)))},
            prefix=self._secret,
            extra_websocket_origins=[f"{HOST}:{self._port}"],
            check_unused_sessions_milliseconds=1_000,
            unused_session_lifetime_milliseconds=CLOSED_AFTER,
        )
        http = HTTPServer(application)
        http.add_sockets(self._sockets)
        server = BaseServer(IOLoop.current(), application, http)
        server.start()
        try:
            started()
            await ended.wait()
        finally:
            server.stop()
            await http.close_all_connections()

    def _open(self, document: object) -> None:
        Tab(document, self._scene, self._source)
