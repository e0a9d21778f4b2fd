"""The builder of the site: pages with several headings of the first level become one page a section, with contents."""

import os
import sys
import tomllib
from pathlib import Path

import pytest

SITE = Path(__file__).parents[1] / ".github" / "site"


@pytest.fixture(scope="module")
def build():
    """The builder's module, which needs none of its extra."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(SITE))
        import build

        yield build
    for name in ("build", "sections"):
        del sys.modules[name]


def test_every_page_of_the_site_has_one_heading_of_the_first_level_and_loses_no_line(build):
    cut = build.cut_pages()
    assert {"lammps_inputs/SCENES.md", "workflow/README.md"} <= cut.keys()
    for path, text in build.manual().items():
        pages = [cut[path].overview, *(one.text for one in cut[path].sections)] if path in cut else [text]
        for page in pages:
            assert [level for _, level, _ in build.sections.headings(page)].count(1) == 1, (path, page[:80])
        lines = {line for line in text.splitlines() if not line.startswith("#")}
        assert lines <= {line for page in pages for line in page.splitlines()}, path
        assert len({one.name for one in cut[path].sections}) == len(pages) - 1 if path in cut else True


def test_every_link_of_the_manual_leads_to_a_page_of_the_site(build):
    texts = build.manual()
    missing = []
    for path, text in texts.items():
        for match in build.sections.ANY_LINK.finditer(build.CODE.sub("", text)):
            target = os.path.normpath(Path(path).parent / match[1])
            if ":" not in match[1] and target.endswith(".md") and target not in texts:
                missing.append(f"{path}: {match[1]}{match[2]}")
    assert missing == []


def test_every_section_is_in_the_navigation_below_its_part(build):
    settings = tomllib.loads(build.navigation())["project"]["nav"]
    text = str(settings)
    for path, page in build.cut_pages().items():
        folder = path.rpartition("/")[0]
        for section in page.sections:
            assert f"'{section.title}': '{folder}/{section.name}'" in text
            assert f"'{section.part}': [" in text
