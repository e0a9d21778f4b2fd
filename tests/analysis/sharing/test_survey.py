"""The whole reading of a run: waveforms against the exact wave, what is called solitary, memory."""

import tracemalloc
from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from synthetic_waves import exact_waves, of_keys, problem, reference, surveyed

from analysis.quantity import csv_of
from analysis.shape.exact_wave import solitary_wave
from analysis.shape.long_waves import sound_speed
from analysis.shape.waveforms import Passages, Waveforms
from analysis.sharing.is_solitary import Tolerances, characterise
from analysis.sharing.survey import survey
from analysis.tracking.leading_waves import from_csv, leading_waves
from analysis.tracking.peaks import find_peaks
from analysis.tracking.pulses import Pulse
from analysis.trajectory import Trajectory, blocks, mirrored, mirrored_problem, watch
from lammps_inputs import Kick
from workflow.engines.reference import engine

EXACT = solitary_wave()


def shape_of(trajectory: Trajectory, peak: float, arrival: float, bead: int = 20, direction: int = 1):
    speed = float(EXACT.speed_at(peak))
    at = arrival + (bead - 1 if direction > 0 else trajectory.problem.beads - bead) / speed
    passages = Passages(*(np.array([number]) for number in (1, bead, at, peak, speed, direction)))
    return watch(Waveforms(trajectory.problem, passages), blocks(trajectory)).shape()


@settings(max_examples=25)
@given(st.floats(0.05, 1.0), st.floats(0.01, 0.3), st.floats(6.0, 15.0), st.sampled_from([1, -1]))
@pytest.mark.slow
def test_an_exact_wave_has_the_momentum_energy_and_shape_of_the_exact_wave(peak, every, arrival, direction):
    shape = shape_of(exact_waves([(peak, arrival)], every=every, direction=direction), peak, arrival, 20, direction)
    assert shape.momentum[0] == pytest.approx(float(EXACT.momentum_at(peak)), rel=1e-5)
    assert shape.energy[0] == pytest.approx(float(EXACT.energy_at(peak)), rel=1e-5)
    assert shape.residual[0] < 1e-9


@settings(max_examples=50)
@given(st.floats(0.05, 1.0), st.floats(0.01, 1.0), st.floats(6.0, 15.0))
@pytest.mark.slow
def test_width_is_within_its_stated_error_on_any_grid(peak, every, arrival):
    """The bound is twice the errors that `Shape` states: 5e-7 at 0.1, 3e-3 at 0.5 and 9e-2 at 1."""
    trajectory = exact_waves([(peak, arrival)], every=every)
    width = shape_of(trajectory, peak, arrival).width[0]
    assert width == pytest.approx(EXACT.width, rel=4e-6 + 0.2 * trajectory.problem.every**5)


def test_with_few_beads_recorded_the_energy_is_that_of_the_virial_theorem():
    shape = shape_of(exact_waves([(0.5, 8.0)], recorded=(5, 20, 30)), 0.5, 8.0)
    assert shape.energy[0] == pytest.approx(float(EXACT.energy_at(0.5)), rel=1e-5)


@pytest.mark.parametrize("speed", [-0.8, np.inf])
def test_maxima_in_reverse_order_or_at_one_time_have_no_width(speed):
    passages = Passages(*(np.array([number]) for number in (1, 20, 30.0, 0.5, speed, 1)))
    trajectory = exact_waves([(0.5, 8.0)])
    shape = watch(Waveforms(trajectory.problem, passages), [trajectory]).shape()
    assert np.isnan([shape.width, shape.momentum]).all()
    assert np.isfinite([shape.residual, shape.energy]).all()


@settings(max_examples=20)
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


@pytest.mark.parametrize("arrival", [8.0, 8.13, 8.21])
def test_the_momentum_is_that_of_eight_beads_of_travel_wherever_frames_lie(arrival):
    trajectory = exact_waves([(0.5, arrival)], every=0.25)
    drifting = Trajectory(trajectory.problem, trajectory.time, trajectory.displacement, trajectory.velocity + 0.1)
    momentum = shape_of(drifting, 0.5, arrival).momentum[0]
    assert momentum == pytest.approx(float(EXACT.momentum_at(0.5)) + 8.0 * 0.1, rel=1e-5)


def test_a_passage_that_the_run_does_not_show_whole_has_no_shape_but_an_energy():
    trajectory = exact_waves([(0.5, 8.0)])
    shape = shape_of(trajectory[: int(32.5 / 0.1)], 0.5, 8.0, 20)
    assert np.isnan([shape.width[0], shape.momentum[0], shape.residual[0]]).all()
    assert shape.energy[0] == pytest.approx(float(EXACT.energy_at(0.5)), rel=1e-5)


def test_waves_are_solitary_once_equipartitioned():
    found = surveyed(reference(2, 0.1))
    leading = [c for p, c in zip(found.pulses, found.characters, strict=True) if found.leads(p)]
    assert len(leading) == 2
    assert all(character.solitary for character in leading)
    late = found.waves.bead[: len(found.shape.residual)] == 110
    assert np.all(found.shape.residual[late] < 1e-3)


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


@pytest.mark.parametrize(("count", "variation"), [(40, 0.1 / 0.55), (6, np.nan)], ids=["ten beads", "five beads"])
def test_speed_is_compared_with_the_exact_wave_and_the_amplitude_with_itself_over_ten_beads(count, variation):
    """The peak velocity rises by 0.01 a bead, to 0.6 at the last."""
    bead = np.arange(1, count + 1)
    peak = 0.6 - 0.01 * (count - bead)
    pulse = Pulse(1, 1, bead, bead / 0.8, peak, 1.002 * EXACT.speed_at(peak), *np.zeros((2, count)))
    shape = {"width": 1.6, "momentum": 1.0, "energy": 1.0, "residual": 0.005}
    found = characterise(pulse, count - 1, shape, problem=problem(1, 0.0))
    assert found.speed_excess == pytest.approx(0.002, rel=1e-9)
    assert found.variation == pytest.approx(variation, nan_ok=True)
    assert found.fails == (() if np.isnan(variation) else ("amplitude",))


def test_a_pulse_that_could_not_be_measured_is_not_called_solitary():
    found = surveyed(reference(1, 0.0, 40, 8.0))
    assert all(not character.solitary for character in found.characters)


def test_the_mirror_of_the_mirror_is_the_run_itself():
    trajectory = reference(2, 0.1, 20, 5.0, recorded=(2, 3, 11))
    twice = mirrored(mirrored(trajectory))
    assert mirrored_problem(trajectory.problem).recorded == (10, 18, 19)
    assert twice.problem == trajectory.problem
    assert np.array_equal(twice.displacement, trajectory.displacement)
    assert np.array_equal(twice.velocity, trajectory.velocity)


def test_a_run_in_pieces_of_any_size_gives_the_same():
    trajectory = reference(2, 0.1, 60, 80.0)
    whole = survey(lambda: [trajectory], trajectory.problem)
    pieces = [trajectory[start : start + 7] for start in range(0, trajectory.frames, 7)]
    parts = survey(lambda: pieces, trajectory.problem)
    for name in ("arrival", "peak_velocity", "speed"):
        assert np.allclose(getattr(whole.waves, name), getattr(parts.waves, name), rtol=1e-11, atol=1e-12)
    assert np.allclose(whole.shape.residual, parts.shape.residual, rtol=0, atol=1e-11, equal_nan=True)
    assert np.allclose(whole.energies.wave, parts.energies.wave, rtol=0, atol=1e-12, equal_nan=True)
    assert whole.verdict.since == parts.verdict.since


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


@pytest.mark.parametrize("kicks", [[Kick(velocity=-1.0)], [Kick(velocity=1.0, bead=5)], [Kick(velocity=-1.0, bead=5)]])
@pytest.mark.parametrize("frames", [1, 2, 3, 40])
def test_any_run_however_short_is_surveyed_without_a_word(kicks, frames):
    surveyed(reference(2, 0.1, 10, 4.0, kicks=kicks)[:frames])


@pytest.mark.parametrize("recorded", ["all", [2, 6, 11, 15]])
@pytest.mark.parametrize("every", [0.25, 0.5])
def test_a_pulse_differs_from_one_of_closer_frames_by_no_more_than_it_states(recorded, every):
    plain = {"beads": 20, "kick": {"velocity": 1.0}, "duration": 30.0, "timestep": 0.01}
    fine, coarse = (
        engine.run(of_keys(**{**plain, "output": output}))
        for output in ({"every": 0.02}, {"every": every, "beads": recorded})
    )
    found = surveyed(coarse).characters[0]
    true = find_peaks(blocks(fine))
    (k,) = np.flatnonzero((true.bead == found.bead) & (np.abs(true.time - found.arrival) < 0.5))
    assert abs(found.arrival - true.time[k]) <= found.arrival_error < 0.5
    assert abs(found.peak_velocity - true.velocity[k]) <= found.peak_velocity_error < 0.01


def test_a_run_without_frames_is_refused():
    with pytest.raises(ValueError, match="no frames"):
        survey(lambda: [], problem(2, 0.1, 10, 4.0))


def test_with_kicks_from_both_ends_the_leading_wave_is_a_pulse_and_not_what_the_other_left_behind():
    found = surveyed(reference(1, 0.0, 100, 140.0, kicks=[Kick(velocity=1.0), Kick(bead=100, velocity=-0.7)]))
    assert np.all(np.diff(found.waves.arrival) > 0.0)
    assert {pulse.direction for pulse in found.pulses} == {1, -1}


@pytest.mark.parametrize("gap", [0.0, 0.5])
def test_of_waves_found_on_the_way_those_have_a_shape_whose_maximum_is_known(gap):
    whole = engine.run(problem(1, 0.0, 20, 60.0, gap=gap))
    waves = leading_waves(find_peaks(blocks(whole)), whole.problem)
    scale = whole.problem.scale
    few = problem(1, 0.0, 20, 60.0, recorded=(10, 20), gap=gap)
    seen = Trajectory(few, whole.time, whole.displacement[..., [9, 19]], whole.velocity[..., [9, 19]])
    found = surveyed(seen, leading=from_csv(csv_of(waves, scale), scale))
    shown = set(found.waves.bead[np.isfinite(found.shape.residual)].tolist())
    assert shown == ({10} if gap == 0.0 else set())  # bead 20 flies off at its largest velocity


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
