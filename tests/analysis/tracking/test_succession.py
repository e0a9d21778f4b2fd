"""One leading pulse is followed from bead to bead, or ends where another one leads."""

from dataclasses import replace

import numpy as np
import pytest
from small_problems import problem
from synthetic_waves import exact_waves, of_keys, surveyed

from analysis.shape.exact_wave import solitary_wave
from analysis.shape.waveforms import Passages, WaveformMeter
from analysis.sharing.equipartition import Sharing
from analysis.sharing.survey import Survey
from analysis.tracking.leading_waves import leading_waves
from analysis.tracking.peaks import Peaks, find_peaks
from analysis.tracking.succession import Change, changes, numbers
from lammps_inputs import find
from workflow.engines.reference import engine

BEAD = np.arange(1, 21)

EXACT = solitary_wave()


def maxima(*pulses: tuple[np.ndarray, np.ndarray, np.ndarray]) -> Peaks:
    """Maxima of a chain of 20 beads at which pulses pass, each of (beads, times, peak velocities)."""
    bead, time, velocity = (np.concatenate(column) for column in zip(*pulses, strict=True))
    zero = np.zeros(len(bead))
    found = Peaks(np.ones(len(bead), int), bead, time, velocity, velocity, time, *np.tile(zero, (3, 1)))
    return found.where(np.lexsort((time, bead)))


def one(**changed: object) -> Change:
    return replace(Change(1, 12, 13, 0.05, 0.2), **changed)


CHAIN = problem(chains=1, beads=20)
SLOW, FAST = 1.5, 0.8
"""Times from bead to bead, 0.75 and 0.4 times that of the exact wave of the smaller pulse."""


def ahead(pace=SLOW):
    """A small pulse that is no maximum beyond bead 12."""
    return BEAD[:12], pace * BEAD[:12], np.full(12, 0.05)


def behind(pace=SLOW):
    """A larger pulse behind the small one."""
    return BEAD, pace * BEAD + 4.0, np.full(20, 0.2)


@pytest.mark.parametrize("pace", [SLOW, FAST])
@pytest.mark.parametrize("direction", [1, -1])
def test_a_pulse_ends_where_the_first_maximum_of_the_next_bead_is_that_of_the_pulse_behind(direction, pace):
    peaks, chain = maxima(ahead(pace), behind(pace)), CHAIN
    last, first = 12, 13
    if direction < 0:
        chain = problem(chains=1, beads=20, kicks=((1, 20, -1.0),))
        peaks, last, first = maxima(*((21 - bead, *of_pulse) for bead, *of_pulse in (ahead(pace), behind(pace)))), 9, 8
        peaks = replace(peaks, direction=-1)
    assert changes(peaks, chain) == (one(last=last, first=first),)
    waves = leading_waves(peaks, chain)
    ended = waves.pulse == 1
    assert set(waves.bead[ended]) == set(BEAD[:12] if direction > 0 else BEAD[8:])
    undefined = np.isin(waves.bead, [last, first])
    assert np.array_equal(np.isnan(waves.speed), undefined)
    np.testing.assert_allclose(waves.speed[~undefined], 1.0 / pace)


@pytest.mark.parametrize(("pace", "early"), [(SLOW, 2.0), (0.6, 0.7)])
def test_a_pulse_ends_where_another_one_forms_ahead_of_it(pace, early):
    leads = (BEAD[:12], pace * BEAD[:12], np.full(12, 0.2))
    goes_on = (BEAD[12:], pace * BEAD[12:], np.full(8, 0.18))
    forms = (BEAD[12:], pace * BEAD[12:] - early, np.full(8, 0.1))
    (change,) = changes(maxima(leads, goes_on, forms), CHAIN)
    assert (change.last, change.first, change.peak_velocity) == (12, 13, 0.2)
    assert np.isnan(change.behind)


@pytest.mark.parametrize(
    "pulse",
    [
        (BEAD, 1.2 * BEAD + 0.2 * (BEAD % 2), np.tile([0.2, 0.9], 10)),
        (BEAD, 1.2 * BEAD, 0.01 * BEAD**2.0),
        (BEAD, 1.2 * BEAD + 2.0 * (BEAD > 12), np.where(BEAD > 12, 0.05, 0.2)),
        (BEAD[::6], 1.2 * BEAD[::6], np.full(4, 0.2)),
    ],
    ids=["dimer", "growing", "a jump without another pulse", "few beads"],
)
def test_a_pulse_goes_on_where_no_other_maximum_fits_better_and_oscillations_follow(pulse):
    bead, time, velocity = pulse
    tail = [(bead, time + late, 0.05 * velocity) for late in (1.3, 2.6, 3.9, 5.2)]
    assert changes(maxima(pulse, *tail), CHAIN) == ()


def test_in_chains_with_gaps_one_pulse_leads():
    assert changes(maxima(ahead(), behind()), problem(chains=1, beads=20, gap=0.5)) == ()


def test_numbers_count_the_pulses_of_each_chain():
    first = maxima((BEAD, 1.0 * BEAD, np.full(20, 0.2)))
    found = numbers(first, (one(last=3, first=4), one(last=9, first=11), one(chain=2)), CHAIN)
    assert np.array_equal(found, 1 + (BEAD >= 4) + (BEAD >= 11))


# --- scenes -----------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def beside_brass() -> Survey:
    """The installed scene with a chain of steel beside one of brass, until its first two pulses have ended."""
    scene = find("steel-beside-brass").model_copy(update={"beads": 50, "duration": 1e-3})
    return surveyed(engine.run(scene.problem()))


def test_the_pulse_in_steel_ends_beside_that_in_brass_and_a_new_one_leads(beside_brass):
    found = [(change.chain, change.last, change.first) for change in beside_brass.succession]
    assert found == [(1, 23, 24), (1, 38, 39)]
    assert all(change.peak_velocity < 0.3 * change.behind for change in beside_brass.succession)
    for pulse in (1, 2, 3):
        steel = beside_brass.waves.where((beside_brass.waves.chain == 1) & (beside_brass.waves.pulse == pulse))
        assert np.all(np.diff(steel.peak_velocity[:-1]) < 0.0)
        assert np.all(np.diff(steel.arrival) > 0.0)
    assert set(beside_brass.waves.of_chain(2).pulse) == {1}


def test_amplitudes_and_verdicts_are_those_of_the_last_pulse(beside_brass):
    followed = beside_brass.shared.followed
    assert beside_brass.shared.bead[0] < 24
    assert followed.bead[0] == 39
    assert followed.amplitude.shape == (len(followed.bead), 2)
    assert followed.span.first >= 39


def test_sharing_follows_one_pulse_in_each_chain_that_counts():
    pulse = np.array([[1, 1, np.nan], [1, 2, np.nan], [1, 2, np.nan], [2, 2, np.nan]])
    amplitude = np.where(np.isnan(pulse), np.nan, 0.3)
    shared = Sharing(0, np.arange(2, 6), amplitude, amplitude, 0.5, pulse=pulse)
    assert shared.changes.tolist() == [1, 3]
    assert shared.followed.bead.tolist() == [5]
    assert replace(shared, pulse=None).followed.bead.tolist() == [2, 3, 4, 5]


@pytest.mark.parametrize("load", [{}, {"precompression": {"force": 0.13}}], ids=["free", "loaded"])
def test_the_leading_pulse_begins_at_the_kicked_bead_where_its_speed_is_undefined(load):
    run = engine.run(of_keys(beads=24, kick={"velocity": 0.5, "bead": 9}, duration=18.0, **load))
    waves = leading_waves(find_peaks(run.blocks()), run.problem)
    assert waves.bead[0] == 9
    assert np.isnan(waves.speed[0])
    assert np.all(waves.speed[1:] > 0.5)


@pytest.mark.parametrize(("apart", "defined"), [(2.2, False), (12.0, True)])
def test_a_wave_that_a_larger_one_overlaps_has_no_difference_from_the_exact_wave(apart, defined):
    bead, speeds = 20, [float(EXACT.speed_at(peak)) for peak in (0.3, 0.5)]
    arrival = 8.0 + (bead - 1) / speeds[0]
    run = exact_waves([(0.3, 8.0), (0.5, arrival + apart - (bead - 1) / speeds[1])])
    passage = Passages(*(np.array([number]) for number in (1, bead, arrival, 0.3, speeds[0], 1, 0.0, 0.0, 0.0)))
    residual = WaveformMeter(run.problem, passage).read(run.blocks()).shape().residual[0]
    assert np.isfinite(residual) == defined
