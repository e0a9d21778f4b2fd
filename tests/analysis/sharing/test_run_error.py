"""Uncertainties of a survey with the error of the run that it was made of."""

import math

import numpy as np
import pytest
from synthetic_waves import of_keys, surveyed

from analysis.gauges.gauge import gauges
from analysis.sharing.run_error import UNMEASURED, MeasuredError, with_run_error
from workflow.engines.reference import engine
from workflow.measures.forces.force_meter import ForceMeter
from workflow.verdicts.analysis_report import EnergyShare, train

ERROR = MeasuredError(velocity=3e-3, amplitude=1e-3, arrival=2e-2, measured=True)


@pytest.fixture(scope="module")
def run():
    keys = {"chains": 2, "beads": 60, "coupling": {"stiffness": 0.5}, "kick": {"velocity": 1.0}, "duration": 90.0}
    return engine.run(of_keys(**keys))


@pytest.fixture(scope="module")
def of_frames(run):
    return surveyed(run)


def test_the_reference_adds_its_uncertainty_to_the_error_that_it_measures():
    error = MeasuredError.of(1e-3, 1e-4, 2e-3, 1e-4, 3e-4)
    assert (error.velocity, error.arrival) == pytest.approx((1.1e-3, 2.3e-3))
    assert error.amplitude == pytest.approx(1.1e-4)  # the reference's in peaks is as much smaller as the run's


def test_errors_of_peaks_that_are_not_known_are_those_of_velocities():
    assert MeasuredError.of(0.0, math.nan, math.nan, 1e-5, math.nan) == MeasuredError(1e-5, 1e-5, 1e-5, measured=True)
    assert not MeasuredError.of(math.nan, 1.0, 1.0, 1.0, 1.0).measured


def test_without_a_measured_error_nothing_is_added(of_frames):
    assert with_run_error(of_frames, UNMEASURED) is of_frames


def test_every_uncertainty_of_a_survey_covers_the_error_of_the_run(of_frames):
    total = with_run_error(of_frames, ERROR)
    moving = of_frames.waves.peak_velocity_error > 0.0
    for name, least in (("arrival_error", ERROR.arrival), ("peak_velocity_error", ERROR.amplitude)):
        before, after = getattr(of_frames.waves, name), getattr(total.waves, name)
        known = moving & np.isfinite(before)
        assert np.all(after[known] >= before[known] + least * (1.0 - 1e-9))
        assert np.all(after[~moving] == 0.0)  # a kicked bead is fastest at the start, exactly
    before, after = (results.shared.followed.final for results in (of_frames, total))
    assert after.value == before.value
    assert after.uncertainty == pytest.approx(before.uncertainty + ERROR.amplitude, rel=1e-9)
    share = EnergyShare(total)
    relative = 2.0 * ERROR.amplitude / total.shared.amplitude[total.energies.place[-1]]
    added = share.measured_error - EnergyShare(of_frames).measured_error
    assert added == pytest.approx(np.sum(relative * total.energies.wave[-1]), rel=1e-6)
    assert train(total).uncertainty[0] >= train(of_frames).uncertainty[0] + 0.9 * ERROR.amplitude


def test_pulses_that_do_not_lead_have_the_error_of_all_velocities(of_frames):
    total = with_run_error(of_frames, ERROR)
    others = [k for k, pulse in enumerate(of_frames.pulses) if not of_frames.leads(pulse)]
    assert others
    for k in others:
        last = total.pulses[k].peak_velocity_error[-1] - of_frames.pulses[k].peak_velocity_error[-1]
        assert last == pytest.approx(ERROR.velocity)
        assert total.characters[k].peak_velocity_error >= ERROR.amplitude


def test_a_pulse_on_a_static_load_begins_with_the_velocity_of_the_kick_exactly_and_at_once():
    keys = {"beads": 24, "precompression": {"force": 0.1}, "kick": {"velocity": 1.0, "bead": 9}, "duration": 18.0}
    (pulse,) = with_run_error(surveyed(engine.run(of_keys(**keys))), ERROR).pulses
    assert (pulse.bead[0], pulse.peak_velocity_error[0], pulse.arrival_error[0]) == (9, 0.0, 0.0)
    assert np.all(pulse.peak_velocity_error[1:] >= ERROR.amplitude)
    assert np.all(pulse.arrival_error[1:] >= ERROR.arrival)


def test_forces_impulses_and_dwells_cover_the_error_of_the_run(run):
    meter = ForceMeter(run.problem, gauges(run.problem.system, contacts=(10,)))
    of_frames = meter.read((run,))
    total = of_frames.with_error(ERROR, run.problem)
    for name in ("largest", "at", "impulse", "dwell"):
        np.testing.assert_array_equal(getattr(total, name), getattr(of_frames, name))
        added = getattr(total, f"{name}_error") - getattr(of_frames, f"{name}_error")
        assert np.all(added >= 0.5 * ERROR.velocity)
    assert of_frames.with_error(UNMEASURED, run.problem) is of_frames


def test_the_decay_of_a_pulse_has_the_error_of_the_run_in_its_uncertainty():
    keys = {"chains": 2, "beads": 50, "coupling": {"stiffness": 0.005}, "kick": {"velocity": 1.0}, "duration": 55.0}
    of_frames = surveyed(engine.run(of_keys(**keys)))
    total = with_run_error(of_frames, ERROR)
    assert total.decay.n_star == of_frames.decay.n_star
    # far ahead of the fitted beads, n* moves by at least what a common error of all amplitudes makes of it
    moved = 0.4 * ERROR.amplitude / of_frames.decay.v0 * of_frames.decay.n_star
    assert total.decay.n_star_error - of_frames.decay.n_star_error > moved
    assert total.decay.v0 == of_frames.decay.v0
    assert total.decay.v0_error - of_frames.decay.v0_error > ERROR.amplitude


ERRORS_OF_CHARACTERS = [
    *("arrival_error", "peak_velocity_error", "speed_error", "width_error", "residual_error"),
    *("speed_excess_error", "variation_error", "momentum_error", "energy_error"),
]


def test_numbers_that_follow_from_passages_have_the_error_of_the_run(of_frames):
    total = with_run_error(of_frames, ERROR)
    for name, part in (("speed", "waves"), ("width", "shape"), ("residual", "shape")):
        before, after = (getattr(getattr(results, part), f"{name}_error") for results in (of_frames, total))
        known = np.isfinite(before)
        assert np.sum(known) > 80
        assert np.all(after[known] > before[known])
        np.testing.assert_array_equal(np.isfinite(after), known)
    behind = of_frames.waves.chain != of_frames.shared.kicked + 1
    added = total.lags.error - of_frames.lags.error
    known = np.isfinite(added) & (of_frames.waves.time > 0.0)
    assert np.all(added[known & ~behind] == 0.0)
    assert np.all((added[known & behind] > 0.0) & (added[known & behind] <= 2.0 * ERROR.arrival * (1.0 + 1e-9)))
    for before, after in zip(of_frames.characters, total.characters, strict=True):
        added = {name: getattr(after, name) - getattr(before, name) for name in ERRORS_OF_CHARACTERS}
        off, late = added["peak_velocity_error"] / before.peak_velocity, added["speed_error"] / before.speed
        expected = {
            "residual_error": off + ERROR.velocity / before.peak_velocity,
            "variation_error": (2.0 + before.variation) * off,
            "energy_error": 2.0 * off * before.energy,
            "speed_excess_error": (1.0 + before.speed_excess) * (late + off),
            "momentum_error": 8.0 * ERROR.velocity  # four beads either way
            + before.momentum * before.speed * added["arrival_error"],
        }
        for name in (name for name in expected if np.isfinite(added[name])):
            assert added[name] == pytest.approx(expected[name], rel=1e-6)
        assert added["width_error"] > before.width * late or np.isnan(added["width_error"])


def test_energies_are_off_by_no_more_than_errors_of_velocities_make_them():
    """Bodies of masses m with springs that hold as much energy: each velocity, and each spring's, off either way."""
    chance = np.random.default_rng(2)
    for size in (1e-3, 0.1, 2.0) * 30:
        mass, v, u = chance.uniform(0.1, 3.0, 6), chance.normal(size=6), chance.normal(size=6)
        off = size * chance.choice([-1.0, 1.0], size=(2, 6))
        exact, moved = (0.5 * np.sum(mass * (a**2 + b**2)) for a, b in ((v, u), (v + off[0], u + off[1])))
        assert abs(moved - exact) <= MeasuredError(size, measured=True).of_energy(moved, np.sum(mass)) * (1.0 + 1e-12)
