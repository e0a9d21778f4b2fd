"""Write an interactive HTML page of a run or sweep."""

import argparse
from pathlib import Path

from granchain.parts import RunDirectory, screen
from workflow.plugins.pages import need_bokeh, open_in_browser

JOB = "Analysis"
EXAMPLES = (
    "view demo                 # writes demo/view.html, and opens it where there is a screen",
    "view demo --against finer  # compares two runs: writes demo/against-finer.html",
    "view swept --no-open",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the directories."""
    parser.add_argument("directory", metavar="DIR", type=Path, help="of a run (also a cut one) or a sweep")
    parser.add_argument(
        "--against", metavar="DIR", type=Path, help="another run with the same chains and beads; compares the two"
    )
    parser.add_argument("--no-open", action="store_true", help="write the page only")


def execute(arguments: argparse.Namespace) -> int:
    """Write the page; open it in a browser if there is a screen."""
    need_bokeh()
    from workflow.plugins.pages.write import write, write_comparison  # bokeh takes half a second to import

    if arguments.against is None:
        page = write(arguments.directory)
    else:
        page = write_comparison(RunDirectory(arguments.directory), RunDirectory(arguments.against))
    print(f"{screen.one_line(page)}: {page.stat().st_size / 1e6:.1f} MB")
    if not arguments.no_open and not open_in_browser(page.resolve().as_uri()):
        print(f"there is no screen here: open {screen.one_line(page)} in a browser")
    return 0
