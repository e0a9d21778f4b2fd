"""The software as it is cited: its authors, title and year, and the address that ``CITATION.cff`` has."""

import importlib.resources

import yaml

AUTHORS = "The granchain authors"

TITLE = "Shock pulses in single and weakly coupled granular chains"
"""What the software is cited as, after its name."""

YEAR = 2026
"""Year of the version that ``pyproject.toml`` names."""


def address() -> str:
    """Where this software can be had, from ``CITATION.cff``; empty until there is such a place."""
    page = (importlib.resources.files("workflow.plugins.cite") / "CITATION.cff").read_text(encoding="utf-8")
    return str(yaml.safe_load(page).get("url") or "")


def in_a_line(version: str) -> str:
    """The software in one line."""
    return ", ".join(filter(None, (AUTHORS, f"granchain {version}", TITLE, address())))


def bibtex(version: str) -> str:
    """BibTeX entry of this software; ``CITATION.cff`` says the same to hosts of repositories."""
    place = f"  url = {{{address()}}},\n" if address() else ""
    return (
        f"@software{{granchain,\n  author = {{{{{AUTHORS}}}}},\n  title = {{granchain: {TITLE}}},\n"
        f"  version = {{{version}}},\n  license = {{MIT}},\n  year = {{{YEAR}}},\n{place}}}"
    )
