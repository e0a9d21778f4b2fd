"""The benchmark of sweeps runs what it says."""

from pathlib import Path

import pytest

from workflow.studies.bench import commands


@pytest.mark.slow
def test_the_ratios_are_of_the_same_sweep_and_count_every_case(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(commands, "CASES", 2)
    faster, overhead = commands.sweep_ratios(tmp_path / "b")
    assert faster.value > 0.0
    assert faster.reached == (faster.value >= 1.8 or commands.cores() < 2)
    assert overhead.reached == (overhead.value <= commands.OVERHEAD)
    assert len(list((tmp_path / "b" / "one").glob("*/analysis.json"))) == 2
