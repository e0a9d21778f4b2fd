"""A reader can follow the pages of the manual that type commands of studies."""

from pathlib import Path

import pytest
import tutorial

import workflow

FOLDER = Path(workflow.__file__).parent
TUTORIALS = {path.stem: path.read_text(encoding="utf-8") for path in sorted((FOLDER / "tutorials").glob("*.md"))}
PAGES = {
    **{name: page for name, page in TUTORIALS.items() if tutorial.types_studies(page)},
    **{
        section.partition("\n")[0].removeprefix("## "): section
        for section in tutorial.sections((FOLDER / "README.md").read_text(encoding="utf-8"))
        if tutorial.types_studies(section)
    },
}


def test_there_are_such_pages():
    assert PAGES


@pytest.mark.slow
@pytest.mark.usefixtures("lammps_here", "pool_here")
@pytest.mark.parametrize("name", PAGES)
def test_the_commands_of_a_page_print_what_it_quotes(name, tmp_path):
    tutorial.follow(PAGES[name], tmp_path, tutorial.environment({}))
