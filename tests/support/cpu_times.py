"""What tests cost in seconds of processor, their processes included: of use where other programs run, too.

A plugin: ``PYTHONPATH=tests/support pytest -p cpu_times``, with an empty ``XDG_CACHE_HOME`` to count the compiler.
"""

import os
from collections.abc import Iterator
from typing import Any

import pytest

COSTLIEST = 60


def _spent() -> float:
    return sum(os.times()[:4])


def _counted(item: Any, phase: str) -> Iterator[None]:
    before = _spent()
    yield
    item.user_properties.append((f"cpu {phase}", _spent() - before))


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_setup(item):
    yield from _counted(item, "setup")


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_call(item):
    yield from _counted(item, "call")


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_teardown(item):
    yield from _counted(item, "teardown")


def pytest_terminal_summary(terminalreporter):
    found = [
        (seconds, f"{name.removeprefix('cpu '):8} {report.nodeid}")
        for reports in terminalreporter.stats.values()
        for report in reports
        if getattr(report, "when", None) == "teardown"
        for name, seconds in report.user_properties
        if name.startswith("cpu ")
    ]
    terminalreporter.section(f"{sum(seconds for seconds, _ in found):.0f} s of processor")
    for seconds, what in sorted(found, reverse=True)[:COSTLIEST]:
        terminalreporter.write_line(f"{seconds:8.2f} {what}")
