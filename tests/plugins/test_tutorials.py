"""A reader can follow the tutorials that type commands of studies, and the pages of plug-ins."""

from pathlib import Path

import pytest
import tutorial

import workflow

FOLDER = Path(workflow.__file__).parent
TUTORIALS = {path.stem: path.read_text(encoding="utf-8") for path in sorted((FOLDER / "tutorials").glob("*.md"))}
PAGES = {
    **{name: page for name, page in TUTORIALS.items() if tutorial.types_studies(page)},
    **{
        f"{path.parent.name}: {section.partition(chr(10))[0].removeprefix('## ')}": section
        for path in sorted(FOLDER.glob("plugins/*/README.md"))
        for section in tutorial.sections(path.read_text(encoding="utf-8"))
        if "```sh\n" in section
    },
}


@pytest.mark.slow
@pytest.mark.usefixtures("lammps_here", "pool_here", "one_figure")
@pytest.mark.parametrize("name", PAGES)
def test_the_commands_of_a_page_print_what_it_quotes(name, tmp_path):
    tutorial.follow(PAGES[name], tmp_path, tutorial.environment({}))
