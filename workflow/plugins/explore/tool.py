"""Change the numbers of a scene on a page and see at once what the reference integrator computes."""

import argparse
import asyncio

from granchain.parts import library
from workflow.plugins.pages import need_bokeh, open_in_browser

EXAMPLES = (
    "explore two-chains        # serves a page on this machine until Ctrl-C",
    "explore my.yaml --port 5007 --no-open",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the scene, and where its page is served."""
    parser.add_argument("scene", metavar="SCENE", help="an installed scene or a YAML file")
    parser.add_argument("--port", metavar="N", type=int, default=0, help="port of this machine (default: a free one)")
    parser.add_argument("--no-open", action="store_true", help="print the address only")


def execute(arguments: argparse.Namespace) -> int:
    """Serve the page until Ctrl-C."""
    need_bokeh("explore")
    from workflow.plugins.explore.server import LocalServer  # bokeh takes half a second to import

    server = LocalServer(library.find(arguments.scene), arguments.scene, arguments.port)

    def started() -> None:
        print(f"the page of {arguments.scene}, on this machine only, until Ctrl-C: {server.address}", flush=True)
        if not arguments.no_open:
            open_in_browser(server.address)

    asyncio.run(server.serve(asyncio.Event(), started))
    return 0
