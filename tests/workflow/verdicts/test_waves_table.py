"""waves.csv: the lag and the energies of a wave stand in its own line, whichever way it runs."""

import csv
import io
from types import SimpleNamespace

import numpy as np
import pytest
from small_problems import problem

from analysis.tracking.leading_waves import with_speeds
from workflow.verdicts.analysis_report import waves_csv


@pytest.mark.parametrize("direction", [1, -1])
def test_each_wave_has_its_own_lag_and_energies(direction):
    """Beads 2 and 3 from the end that was hit; chain 2 was hit, and chain 1 is later by 0.5 and by 0.25."""
    what = problem(beads=10)
    along = np.array([2, 3])
    bead = along if direction > 0 else 11 - along[::-1]
    passed = np.array([3.0, 4.0])[::direction]
    arrival = np.concatenate([passed + np.array([0.5, 0.25])[::direction], passed])
    waves = with_speeds(np.repeat([1, 2], 2), np.tile(bead, 2), arrival, np.full(4, 0.6), direction=direction)
    found = SimpleNamespace(
        problem=what,
        waves=waves,
        direction=direction,
        shape=SimpleNamespace(width=np.full(4, 2.3), residual=np.zeros(4)),
        shared=SimpleNamespace(bead=along, kicked=1, energy=0.5),
        energies=SimpleNamespace(
            place=np.array([0, 1]),
            chain=np.array([[0.7, 0.3], [0.6, 0.4]]),  # [bead, chain]
            wave=np.array([[0.65, 0.25], [0.55, 0.35]]),
        ),
    )
    lines = {(int(one["chain"]), int(one["bead"])): one for one in csv.DictReader(io.StringIO(waves_csv(found)))}
    for place, at in enumerate((2, 3) if direction > 0 else (9, 8)):
        for chain, late in ((1, (0.5, 0.25)[place]), (2, 0.0)):
            one = lines[chain, at]
            assert float(one["lag"]) == pytest.approx(late)
            assert float(one["speed"]) > 0.0
            assert float(one["chain_energy"]) == pytest.approx(0.5 * found.energies.chain[place, chain - 1])
            assert float(one["wave_energy"]) == pytest.approx(0.5 * found.energies.wave[place, chain - 1])
