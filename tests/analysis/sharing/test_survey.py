"""The whole reading of a run: waveforms against the exact wave, what is called solitary, memory."""

import math
import tracemalloc
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mirror import mirrored_problem
from synthetic_waves import exact_waves, of_keys, problem, reference, surveyed

from analysis.shape.exact_wave import solitary_wave, wave_of
from analysis.shape.long_waves import sound_speed
from analysis.shape.waveforms import REACH, Passages, WaveformMeter
from analysis.sharing.is_solitary import Tolerances, characterise
from analysis.sharing.survey import numbered, survey
from analysis.sharing.verdict import EquipartitionState, Verdict
from analysis.tracking.pulses import Pulse
from analysis.trajectory import Trajectory
from lammps_inputs import Kick
from workflow.engines.reference import engine

EXACT = solitary_wave()


def shape_of(trajectory: Trajectory, peak: float, arrival: float, bead: int = 20, direction: int = 1):
    speed = float(EXACT.speed_at(peak))
    at = arrival + (bead - 1 if direction > 0 else trajectory.problem.beads - bead) / speed
    passages = Passages(*(np.array([number]) for number in (1, bead, at, peak, speed, direction, 0.0, 0.0, 0.0)))
    return WaveformMeter(trajectory.problem, passages).read(trajectory.blocks()).shape()


def test_a_pulse_on_a_static_load_has_no_difference_from_an_exact_wave():
    run = engine.run(of_keys(beads=20, duration=15.0, precompression={"force": 0.3}, kick={"velocity": 1.0}))
    shape = survey(run.blocks, run.problem).shape
    assert np.isfinite(shape.width).any()
    assert np.isnan([shape.residual, shape.residual_error]).all()


@settings(max_examples=6)
@given(st.floats(0.05, 1.0), st.floats(0.01, 0.3), st.floats(6.0, 15.0), st.sampled_from([1, -1]))
@pytest.mark.slow
def test_an_exact_wave_has_the_momentum_energy_and_shape_of_the_exact_wave(peak, every, arrival, direction):
    shape = shape_of(exact_waves([(peak, arrival)], every=every, direction=direction), peak, arrival, 20, direction)
    assert shape.momentum[0] == pytest.approx(float(EXACT.momentum_at(peak)), rel=1e-5)
    assert shape.energy[0] == pytest.approx(float(EXACT.energy_at(peak)), rel=1e-5)
    assert shape.residual[0] < 1e-9


@settings(max_examples=10)
@given(st.floats(0.05, 1.0), st.floats(0.01, 1.0), st.floats(6.0, 15.0))
@pytest.mark.slow
def test_width_is_within_its_stated_error_on_any_grid(peak, every, arrival):
    trajectory = exact_waves([(peak, arrival)], every=every)
    shape = shape_of(trajectory, peak, arrival)
    assert shape.width[0] == pytest.approx(EXACT.width, abs=shape.width_error[0] + 1e-12)
    assert shape.width_error[0] < EXACT.width * (4e-6 + 2.0 * trajectory.problem.every**5)


def test_with_few_beads_recorded_the_energy_is_that_of_the_virial_theorem():
    shape = shape_of(exact_waves([(0.5, 8.0)], recorded=(5, 20, 30)), 0.5, 8.0)
    assert shape.energy[0] == pytest.approx(float(EXACT.energy_at(0.5)), rel=1e-5)


@pytest.mark.parametrize("speed", [-0.8, np.inf])
def test_maxima_in_reverse_order_or_at_one_time_have_no_width(speed):
    passages = Passages(*(np.array([number]) for number in (1, 20, 30.0, 0.5, speed, 1, 0.0, 0.0, 0.0)))
    trajectory = exact_waves([(0.5, 8.0)])
    shape = WaveformMeter(trajectory.problem, passages).read([trajectory]).shape()
    assert np.isnan([shape.width, shape.momentum]).all()
    assert np.isfinite([shape.residual, shape.energy]).all()


@pytest.mark.slow
@settings(max_examples=8)
@given(st.floats(0.1, 1.0), st.floats(0.5, 2.0))
def test_a_wave_that_is_too_wide_has_the_width_put_in_and_a_residual(peak, stretch):
    trajectory = exact_waves([(peak, 8.0)])
    time = trajectory.time[:, np.newaxis, np.newaxis]
    speed = float(EXACT.speed_at(peak))
    xi = (np.arange(40) - speed * (time - 8.0)) / stretch
    stretched = Trajectory(trajectory.problem, trajectory.time, trajectory.displacement, peak * EXACT.velocity(xi))
    bead = 26  # far enough in for the widest to be seen whole
    shape = shape_of(stretched, peak, 8.0, bead)
    assert shape.width[0] == pytest.approx(stretch * EXACT.width, rel=1e-3)
    grid = np.linspace(-2.9, 2.9, 400)
    expected = np.max(np.abs(EXACT.velocity(grid / stretch) - EXACT.velocity(grid)))
    assert shape.residual[0] == pytest.approx(expected, rel=0.15, abs=1e-6)


@pytest.mark.parametrize("arrival", [8.0, 8.13])
def test_the_momentum_is_that_of_eight_beads_of_travel_wherever_frames_lie(arrival):
    trajectory = exact_waves([(0.5, arrival)], every=0.25)
    drifting = Trajectory(trajectory.problem, trajectory.time, trajectory.displacement, trajectory.velocity + 0.01)
    shape = shape_of(drifting, 0.5, arrival)
    assert shape.momentum[0] == pytest.approx(float(EXACT.momentum_at(0.5)) + 8.0 * 0.01, rel=1e-5)
    assert shape.momentum_error[0] == pytest.approx(2.0 * 0.01, rel=1e-3)  # of a bead of travel at either end


def test_the_momentum_of_what_has_not_come_to_rest_after_four_beads_is_undefined():
    trajectory = exact_waves([(0.5, 8.0)], every=0.25)
    drifting = Trajectory(trajectory.problem, trajectory.time, trajectory.displacement, trajectory.velocity + 0.05)
    shape = shape_of(drifting, 0.5, 8.0)
    assert np.isnan([shape.momentum[0], shape.momentum_error[0]]).all()


def test_a_passage_that_the_run_does_not_show_whole_has_no_shape_but_an_energy():
    trajectory = exact_waves([(0.5, 8.0)])
    shape = shape_of(trajectory[: int(32.5 / 0.1)], 0.5, 8.0, 20)
    assert np.isnan([shape.width[0], shape.momentum[0], shape.residual[0]]).all()
    assert shape.energy[0] == pytest.approx(float(EXACT.energy_at(0.5)), rel=1e-5)


def test_waves_that_still_beat_fail_by_shape_and_amplitude():
    found = surveyed(reference(2, 0.1, 40, 50.0))
    for pulse, character in zip(found.pulses, found.characters, strict=True):
        if found.leads(pulse):
            assert {"shape", "amplitude"} <= set(character.fails)


def test_a_tolerance_decides_what_is_solitary():
    trajectory = reference(1, 0.0, 40, 50.0)
    strict = surveyed(trajectory, tolerances=Tolerances(shape=1e-12))
    assert strict.characters[0].fails == ("shape",)
    assert surveyed(trajectory).characters[0].fails == ()


@pytest.mark.parametrize("exponent", [1.5, 2.0])
def test_the_pulse_of_contacts_of_strength_30_is_the_exact_wave_of_these(exponent):
    """Its speed is 30**(1 / (n + 1)) times that in contacts of strength 1."""
    factor = 30.0 ** (1.0 / (exponent + 1.0))
    contact = {"exponent": exponent, "strength": 30.0}
    run = engine.run(of_keys(chains=1, beads=60, contact=contact, kick={"velocity": 1.0}, duration=65.0 / factor))
    (character,) = surveyed(run).characters
    assert character.fails == ()
    assert character.speed_excess == pytest.approx(0.0, abs=1e-4)
    expected = factor * float(solitary_wave(exponent).speed_at(character.peak_velocity))
    assert character.speed == pytest.approx(expected, rel=1e-4)


SHAPE = {"width": 1.6, "momentum": 1.0, "energy": 1.0, "residual": 0.005}
SHAPE |= {f"{name}_error": 0.0 for name in SHAPE}


@pytest.mark.parametrize(("count", "variation"), [(40, 0.1 / 0.55), (6, np.nan)], ids=["ten beads", "five beads"])
def test_speed_is_compared_with_the_exact_wave_and_the_amplitude_with_itself_over_ten_beads(count, variation):
    """The peak velocity rises by 0.01 a bead, to 0.6 at the last."""
    bead = np.arange(1, count + 1)
    peak = 0.6 - 0.01 * (count - bead)
    pulse = Pulse(1, 1, bead, bead / 0.8, peak, 1.002 * EXACT.speed_at(peak), *np.zeros((3, count)))
    found = characterise(pulse, count - 1, SHAPE, problem=problem(1, 0.0))
    assert found.speed_excess == pytest.approx(0.002, rel=1e-9)
    assert found.variation == pytest.approx(variation, nan_ok=True)
    assert found.fails == (() if np.isnan(variation) else ("amplitude",))


@pytest.mark.parametrize("exponent", [1.5, 3.0])
def test_errors_of_speeds_and_velocities_move_what_follows_from_them_by_as_much_as_is_stated(exponent):
    """Speeds 20 % above the exact one and velocities that rise, each off by 0.001 the worse way."""
    bead, error = np.arange(1, 41), np.full(40, 1e-3)
    peak = 0.6 - 0.01 * (40 - bead)
    what = of_keys(beads=40, kick={"velocity": 1.0}, contact={"exponent": exponent}, duration=1.0)
    pulse = Pulse(1, 1, bead, bead / 0.8, peak, 1.2 * wave_of(what.system).speed_at(peak), 0.0 * error, error, error)
    fast = replace(pulse, speed=pulse.speed + error, peak_velocity=peak - error)
    steep = replace(pulse, peak_velocity=peak + np.where(bead == 40, error, -error))
    stated, fast, steep = (characterise(each, 39, SHAPE, problem=what) for each in (pulse, fast, steep))
    assert fast.speed_excess - stated.speed_excess == pytest.approx(stated.speed_excess_error, rel=5e-3)  # first order
    moved = steep.variation - stated.variation
    assert moved <= stated.variation_error == pytest.approx(moved, rel=0.02)  # one velocity in eleven is off upwards


def test_a_pulse_is_compared_with_the_exact_wave_where_no_unlike_bead_is_within_the_length_of_that():
    bead = np.arange(1, 41)
    pulse = Pulse(1, 1, bead, bead / 0.8, *np.ones((2, 40)), *np.zeros((3, 40)))
    unlike = {"kinds": {"heavy": {"mass": 2.0}}, "replace": {"bead": 20, "kind": "heavy"}}
    what = of_keys(beads=40, kick={"velocity": 1.0}, duration=1.0, **unlike)
    known = [np.isfinite(characterise(pulse, at, SHAPE, problem=what).speed_excess) for at in range(40)]
    assert bead[~np.array(known)].tolist() == list(range(20 - math.ceil(REACH), 20 + math.ceil(REACH) + 1))


READ_BOTH_WAYS = {
    "coupled": {"chains": 2, "beads": 60, "coupling": {"stiffness": 0.1}, "duration": 80.0},
    "some beads": {"chains": 2, "coupling": {"stiffness": 0.1}, "output": {"beads": [3, 9, 10, 17, 24, 33]}},
    "coupled in some rows": {"chains": 2, "coupling": {"stiffness": 0.1, "rows": [1, 12]}},
    "with gaps": {"chains": 2, "beads": 20, "coupling": {"stiffness": 0.1}, "gap": 1.0, "duration": 80.0},
    "tapered, kicked twice": {"taper": 0.01, "kick": [{"velocity": 1.0}, {"bead": 9, "velocity": 0.5}]},
    "kicked from both ends": {"kick": [{"velocity": 1.0}, {"bead": 40, "velocity": -0.5}]},
    "loaded and tapered": {
        "chains": 2,
        "taper": 0.01,
        "coupling": {"stiffness": 0.1},
        "precompression": {"force": 0.03},
        "duration": 30.0,
    },
}


@pytest.mark.slow
@pytest.mark.parametrize("name", READ_BOTH_WAYS)
def test_a_run_towards_bead_1_is_read_as_the_mirror_image_of_one_away_from_it(name):
    plain = of_keys(**{"beads": 40, "kick": {"velocity": 1.0}, "duration": 55.0, **READ_BOTH_WAYS[name]})
    up, down = (surveyed(engine.run(each)) for each in (plain, mirrored_problem(plain)))
    assert (up.direction, down.direction) == (1, -1)
    waves = down.waves.where(np.lexsort((-down.waves.bead, down.waves.chain)))
    assert np.array_equal(plain.beads + 1 - waves.bead, up.waves.bead)
    pulses = sorted((pulse.chain, -pulse.direction, *(plain.beads + 1 - pulse.bead)) for pulse in down.pulses)
    assert pulses == sorted((pulse.chain, pulse.direction, *pulse.bead) for pulse in up.pulses)
    assert np.array_equal(down.shared.bead, up.shared.bead)
    pairs = [(getattr(waves, of_wave), getattr(up.waves, of_wave)) for of_wave in ("pulse", "arrival", "speed")]
    pairs += [(getattr(down.shared, of_place), getattr(up.shared, of_place)) for of_place in ("amplitude", "spread")]
    pairs += [(down.energies.wave, up.energies.wave), (down.energies.chain, up.energies.chain)]
    for found, expected in pairs:
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-8)
    assert down.verdict.sentence.removesuffix(" (beads are counted along the pulse's way, from the last bead)") == (
        up.verdict.sentence
    )


@pytest.mark.parametrize(
    ("direction", "sentence", "counted"),
    [(-1, "agree from bead 12 on", True), (1, "agree from bead 12 on", False), (-1, "no kick", False)],
)
def test_a_sentence_on_beads_says_how_it_counts_them_where_that_is_not_by_their_numbers(direction, sentence, counted):
    verdict = Verdict(EquipartitionState.BEATING, sentence)
    assert numbered(verdict, direction).sentence == sentence + counted * (
        " (beads are counted along the pulse's way, from the last bead)"
    )


@pytest.mark.slow
def test_memory_does_not_grow_with_the_number_of_frames(monkeypatch):
    monkeypatch.setattr("analysis.trajectory.BLOCK_BYTES", 1 << 20)

    def peak_memory(every: float) -> int:
        what = problem(2, 0.1, 60, 80.0, every)

        def read() -> Iterator[Trajectory]:
            yield from engine.blocks(what)

        survey(read, what)  # caches fill
        tracemalloc.start()
        survey(read, what)
        _, peak = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        return peak

    assert peak_memory(0.01) < 1.2 * peak_memory(0.04)  # both of several blocks


@pytest.mark.slow
@pytest.mark.parametrize("kick", [Kick(velocity=-1.0), Kick(velocity=1.0, bead=5)])
def test_any_run_however_short_is_surveyed_without_a_word(kick):
    run = reference(2, 0.1, 10, 4.0, kicks=[kick])
    for frames in (1, 2, 3, 40):
        surveyed(run[:frames])


def test_with_kicks_from_both_ends_the_leading_wave_is_a_pulse_and_not_what_the_other_left_behind():
    found = surveyed(reference(1, 0.0, 100, 140.0, kicks=[Kick(velocity=1.0), Kick(bead=100, velocity=-0.7)]))
    assert np.all(np.diff(found.waves.arrival) > 0.0)
    assert {pulse.direction for pulse in found.pulses} == {1, -1}


def under_load(force, **changes):
    keys = {
        "beads": 60,
        "kick": {"velocity": 1.0},
        "duration": 55.0,
        "precompression": {"force": force},
    }
    pressed = of_keys(**{**keys, **changes})
    return survey(lambda: engine.blocks(pressed), pressed)


@pytest.mark.slow
@pytest.mark.parametrize("force", [300.0, 1.0, 0.003])
def test_a_kick_on_a_static_load_is_one_pulse_whatever_sound_follows(force):
    found = under_load(force)
    assert [found.leads(pulse) for pulse in found.pulses] == [True]
    assert len(found.characters) == 1
    assert (len(found.crests) > 10) == (force >= 1.0)


@pytest.mark.slow
def test_a_train_on_a_static_load_is_as_many_pulses_as_there_are_ahead_of_sound():
    """Three beads that are hit together make three solitary waves."""
    found = under_load(0.003, kick=[{"bead": bead, "velocity": 1.0} for bead in (1, 2, 3)])
    c0 = float(sound_speed(found.problem.system)[0, 30])
    assert len(found.pulses) == 3
    assert all(np.median(pulse.speed) > 1.2 * c0 for pulse in found.pulses)
    assert all(np.median(crest.speed) < c0 for crest in found.crests)
