"""A reader can follow the tutorials: their commands run and print what they quote; the manual's links exist."""

import re
import runpy
from pathlib import Path

import plug_ins
import pytest
import tutorial

import workflow
from lammps_inputs import library, strict_yaml
from workflow.sweep import file as sweep_file

pytest_plugins = ("slurm",)

PACKAGES = ("lammps_inputs", "analysis", "workflow")
FOLDER = Path(workflow.__file__).parent / "tutorials"
ROOT = FOLDER.parents[1]
MANUAL = [ROOT / "README.md", *(page for name in PACKAGES for page in sorted((ROOT / name).rglob("*.md")))]
TUTORIALS = {path.stem: path.read_text(encoding="utf-8") for path in sorted(FOLDER.glob("*.md"))}
PAGES = list(TUTORIALS)
COMMANDS = FOLDER.parent / "README.md"
PAGES_OF_PLUG_INS = sorted(
    str(path.relative_to(ROOT))
    for path in FOLDER.parent.glob("plugins/*/README.md")
    if path.parent.name != "jobs"  # which shows a site's file
)


@pytest.mark.slow
@pytest.mark.usefixtures("lammps_here", "pool_here", "one_figure")
@pytest.mark.parametrize("name", [*(name for name in PAGES if not tutorial.types_studies(TUTORIALS[name])), "README"])
def test_the_commands_of_a_page_print_what_it_quotes(name, tmp_path, request):
    page = TUTORIALS.get(name) or COMMANDS.read_text(encoding="utf-8")
    more = request.getfixturevalue("slurm").environment if "sbatch" in page else {}
    tutorial.follow(page, tmp_path, tutorial.environment(more))


@pytest.mark.slow
@pytest.mark.usefixtures("lammps_here", "pool_here")
def test_the_python_examples_of_the_readme_pages_run_one_after_the_other(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    pages = [(ROOT / name / "README.md").read_text(encoding="utf-8") for name in (".", "analysis")]
    programs = [program for page in pages for program in re.findall(r"```python\n(.*?)```", page, re.S)]
    assert len(programs) == 2
    for number, program in enumerate(programs):
        (tmp_path / f"example{number}.py").write_text(program, encoding="utf-8")
        runpy.run_path(f"example{number}.py")


@pytest.mark.slow
@pytest.mark.usefixtures("lammps_here")
def test_the_commands_that_the_readme_quotes_print_these_lines(tmp_path):
    page = (ROOT / "README.md").read_text(encoding="utf-8")
    section = page[page.index("## Two commands") : page.index("## A scene")]
    quoted = re.findall(r"(?:^ {4}\S.*\n)+", section, re.M)
    commands = ("granchain run two-chains -o two-chains", "granchain analyze two-chains")
    for lines, command in zip(quoted, commands, strict=True):
        timeless = re.sub(r"\d\S* s\b", "... s", lines).replace("LAMMPS 20250722", "LAMMPS ...")
        tutorial.compare(timeless, tutorial.called(command, tmp_path))


@pytest.mark.parametrize("page", MANUAL, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_and_pictures_of_the_manual_exist(page):
    homes = []  # plug-ins to which links lead
    text = re.sub(r"^```diff\n.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)  # of other pages
    for link in re.findall(r"\]\(([^)\s]+)\)", text):
        place, _, anchor = link.partition("#")
        target = page.parent / place if place else page
        home = re.search(r"/plugins/(\w+)/", str(target.resolve()))
        if home and home[1] in plug_ins.WITHOUT:
            homes.append(home[1])
            continue
        assert ":" in link or target.exists(), link
        if anchor and ":" not in link:
            heads = re.findall(r"^#+ (.*)$", target.read_text(encoding="utf-8"), re.M)
            assert anchor in {re.sub(r"[^\w -]", "", head).lower().replace(" ", "-") for head in heads}, link
    plug_ins.skip_if_deleted(*homes)


@pytest.mark.parametrize("page", ["README.md", "workflow/README.md", *PAGES_OF_PLUG_INS])
def test_scenes_and_sweeps_of_the_readme_pages_are_valid(page, tmp_path):
    for block in re.findall(r"```yaml\n(.*?)```", (ROOT / page).read_text(encoding="utf-8"), re.S):
        data = strict_yaml.parse(block, page)
        if "vary" not in data:
            assert library.from_plain(data, page).system
        elif "minimize" not in data:
            assert sweep_file.all_cases(sweep_file.from_plain(data, tmp_path / "sweep.yaml"))
