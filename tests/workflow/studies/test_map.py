"""Equipartition over coupling and number of chains."""

from pathlib import Path

import pytest

from workflow.cli import main
from workflow.studies.map.study import run_case


@pytest.mark.parametrize(
    ("chains", "kappa", "ten", "one", "amplitude"),
    [
        (2, 0.5, 11, 17, 0.35934),
        (2, 0.1, 33, 62, 0.36524),
        pytest.param(2, 0.01, 265, 507, 0.3196, marks=pytest.mark.slow),
        (3, 0.1, 64, 105, 0.25559),
    ],
)
def test_the_known_distances_and_amplitudes_come_out_and_agree_with_a_window_twice_as_wide(
    chains: int, kappa: float, ten: int, one: int, amplitude: float
) -> None:
    case = run_case(chains, kappa)
    assert (case.ten, case.one) == (ten, one)
    assert case.amplitude == pytest.approx(amplitude, abs=5e-5)
    assert case.window_error <= 1e-6


def test_a_chain_too_short_to_level_out_says_so() -> None:
    case = run_case(2, 0.01, most_beads=100)
    assert case.one is None
    assert case.beads == 100


@pytest.mark.slow
@pytest.mark.usefixtures("pool_here")
def test_the_command_prints_a_table_and_writes_the_figure(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["map", "-o", str(tmp_path / "m"), "--couplings", "0.5,1", "--chains", "2,3"]) == 0
    assert "1% from" in capsys.readouterr().out
    assert (tmp_path / "m" / "map.png").stat().st_size > 10_000
    assert len((tmp_path / "m" / "map.csv").read_text().splitlines()) == 5
