"""The page on how to add a part: its diffs apply, and what they add works as the page says."""

import pytest
from core_alone import ROOT
from extending import git_apply, sections


@pytest.mark.parametrize("section", sections())
def test_the_diffs_of_a_section_apply_to_the_tree(section, executable):
    executable("git")
    assert sections()[section], "a section of this page shows its addition as a diff"
    git_apply("".join(sections()[section]), ROOT, "--check")
