"""What analysis.json says of trains, the decay law and the final amplitude, and waves.csv: hand-made numbers."""

import csv
import io
from types import SimpleNamespace

import numpy as np
import pytest
from small_problems import problem

from analysis.sharing.survey import Survey, survey
from analysis.tracking.leading_waves import lags, with_speeds
from analysis.tracking.pulses import Pulse
from workflow.engines.reference import engine
from workflow.verdicts import analysis_report
from workflow.verdicts.analysis_report import LeadingWave, waves_table


def summary(waves, problem, chain, succession=()):
    """Leading wave of a chain, by waves and changes alone."""
    of_waves = Survey(problem, tuple, "maximum").replaced(passages=waves, waves=waves, succession=succession)
    return LeadingWave(of_waves, chain)


@pytest.mark.parametrize(("first", "bead"), [(4, 6), (7, 7), (2, 6)])
def test_a_wave_towards_bead_1_is_reported_at_the_last_bead_clear_of_that_end(first, bead):
    number = np.arange(first, 20)
    waves = with_speeds(np.ones(len(number), int), number, 20.0 - number, np.full(len(number), 0.5), direction=-1)
    back = problem(chains=1, beads=20, kicks=((1, 20, -1.0),))
    assert summary(waves, back, 1).bead == bead


@pytest.fixture(scope="module")
def three():
    """What is found of a chain of 90 beads, three of which were kicked at once."""
    kicks = ((1, 1, 1.0), (1, 2, 1.0), (1, 3, 1.0))
    one = problem(chains=1, beads=90, kicks=kicks, timestep=0.1, steps_per_frame=1, frames=1400)
    run = engine.run(one)
    return survey(run.blocks, one)


def test_amplitudes_of_a_train_are_those_that_its_pulses_have_far_from_the_ends(three):
    """Those of 330 beads; the last pulse has 0.41 five beads before the end, from which the first has come back."""
    seen = analysis_report.train(three)
    assert seen.peak_velocity == pytest.approx([0.92391, 0.65773, 0.32287], abs=1e-5)
    assert np.all(seen.uncertainty < 1e-5)


@pytest.mark.parametrize(("amplitude", "count"), [((0.5, 0.5), 2), ((0.5, 0.6), 1), ((0.6, 0.5), 0)])
def test_a_train_ends_before_the_first_pulse_that_is_not_steady(amplitude, count):
    """Ten beads apart; an amplitude grows from 0.5 to what is given over 80 beads."""
    bead = np.arange(2, 81)

    def pulse(late, last):
        return Pulse(
            1, 1, bead, bead + late, 0.5 + (last - 0.5) * bead / 80.0, np.ones(len(bead)), *np.zeros((3, len(bead)))
        )

    found = SimpleNamespace(
        problem=problem(chains=1, beads=80),
        shared=SimpleNamespace(kicked=0),
        direction=1,
        pulses=tuple(pulse(10.0 * k, last) for k, last in enumerate(amplitude)),
        clear=(np.ones(len(bead), dtype=bool),) * 2,
    )
    seen = analysis_report.train(found)
    assert (0 if seen is None else len(seen)) == count


@pytest.mark.parametrize("direction", [1, -1])
def test_each_wave_has_its_own_lag_and_energies(direction):
    """Beads 2 and 3 from the end that was hit; chain 2 was hit, and chain 1 is later by 0.5 and by 0.25."""
    what = problem(beads=10, kicks=((2, 1 if direction > 0 else 10, float(direction)),))
    along = np.array([2, 3])
    bead = along if direction > 0 else 11 - along[::-1]
    passed = np.array([3.0, 4.0])[::direction]
    arrival = np.concatenate([passed + np.array([0.5, 0.25])[::direction], passed])
    chains, errors = np.repeat([1, 2], 2), np.array([1e-3, 2e-3, 4e-3, 8e-3])
    waves = with_speeds(chains, np.tile(bead, 2), arrival, np.full(4, 0.6), arrival_error=errors, direction=direction)
    found = SimpleNamespace(
        problem=what,
        waves=waves,
        lags=lags(waves, 2),
        direction=direction,
        shape=SimpleNamespace(
            width=np.full(4, 2.3), residual=np.zeros(4), width_error=np.zeros(4), residual_error=np.zeros(4)
        ),
        shared=SimpleNamespace(bead=along, kicked=1, energy=0.5),
        energies=SimpleNamespace(
            place=np.array([0, 1]),
            chain=np.array([[0.7, 0.3], [0.6, 0.4]]),  # [bead, chain]
            wave=np.array([[0.65, 0.25], [0.55, 0.35]]),
            chain_error=np.array([[7e-3, 3e-3], [6e-3, 4e-3]]),
            wave_error=np.array([[6.5e-3, 2.5e-3], [5.5e-3, 3.5e-3]]),
        ),
    )
    lines = {
        (int(one["chain"]), int(one["bead"])): one for one in csv.DictReader(io.StringIO(waves_table(found).to_csv()))
    }
    for place, at in enumerate((2, 3) if direction > 0 else (9, 8)):
        for chain, behind in ((1, (0.5, 0.25)[place]), (2, 0.0)):
            one = lines[chain, at]
            assert float(one["lag"]) == pytest.approx(behind)
            both = errors[:2][bead == at] + errors[2:][bead == at]
            assert float(one["lag_error"]) == pytest.approx(both[0] if chain == 1 else 0.0)
            assert float(one["speed"]) > 0.0
            assert float(one["chain_energy"]) == pytest.approx(0.5 * found.energies.chain[place, chain - 1])
            assert float(one["wave_energy"]) == pytest.approx(0.5 * found.energies.wave[place, chain - 1])
            for name in ("chain_energy", "wave_energy"):
                assert float(one[f"{name}_error"]) == pytest.approx(0.01 * float(one[name]))
