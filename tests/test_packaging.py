"""What is built from the sources: whole, and at work elsewhere."""

import sys
import tarfile
import zipfile
from pathlib import Path

import pytest
from extending import in_turn
from processes import output_of

ROOT = Path(__file__).parents[1]
PACKAGES = ("lammps_inputs", "analysis", "workflow")

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def built(executable, tmp_path_factory):
    """The wheel, and the sdist that it was built from, of what git knows."""
    place = tmp_path_factory.mktemp("built")
    output_of(executable("git"), "clone", "-q", ROOT, place / "source")
    code = f"import hatchling.build as made; print(made.build_sdist({str(place)!r}))"
    output_of(
        sys.executable, "-m", "pip", "install", "-q", "--target", place / "backend", "hatchling>=1.27", "editables"
    )
    environment = {"PYTHONPATH": str(place / "backend"), "PATH": "/usr/bin:/bin"}
    sdist = place / output_of(sys.executable, "-c", code, cwd=place / "source", env=environment).split()[-1]
    # without an environment that pip would build for the backend once more
    words = ("pip", "wheel", "-q", "--no-deps", "--no-build-isolation", "-w", place, sdist)
    output_of(sys.executable, "-m", *words, env=environment)
    return sdist, next(place.glob("*.whl"))


@pytest.fixture(scope="module")
def site(built, tmp_path_factory):
    """Directory in which the wheel is installed."""
    place = tmp_path_factory.mktemp("installed")
    output_of(sys.executable, "-m", "pip", "install", "-q", "--no-deps", "--no-compile", "--target", place, built[1])
    return place


def test_the_wheel_holds_every_file_of_the_packages(built, executable):
    held = {name for name in zipfile.ZipFile(built[1]).namelist() if ".dist-info/" not in name}
    tracked = output_of(executable("git"), "ls-files", *PACKAGES, cwd=ROOT).split()
    assert held == {name.removeprefix("workflow/python/") for name in tracked}
    assert {"granchain/__init__.py", "granchain/py.typed"} < held


def test_the_sdist_holds_all_there_is_also_tests_change_log_and_pictures(built, executable):
    with tarfile.open(built[0]) as archive:
        held = {name.partition("/")[2] for name in archive.getnames() if not archive.getmember(name).isdir()}
    assert held == {*output_of(executable("git"), "ls-files", cwd=ROOT).split(), "PKG-INFO"}


def test_the_main_job_runs_from_the_wheel_elsewhere(site, tmp_path):
    # no path of the sources: the interpreter starts elsewhere, and what was installed comes first
    environment = {"PYTHONPATH": str(site), "PATH": "/usr/bin:/bin", "HOME": str(tmp_path)}
    where = "import granchain, workflow; print(granchain.__file__, workflow.__file__)"
    paths = output_of(sys.executable, "-P", "-c", where, cwd=tmp_path, env=environment).split()
    assert all(path.startswith(str(site)) for path in paths)
    commands = (["run", "one-chain", "-o", "demo"], ["analyze", "demo", "--no-figures"], ["help", "coupling"])
    _, analysed, explained = in_turn(environment, tmp_path, *commands)
    assert "analysis.json" in analysed
    assert "Springs between" in explained
