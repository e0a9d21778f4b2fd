"""Maxima between frames: whatever blocks they are read in, whichever way the pulse runs, and how sure they are."""

import itertools
from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest
from mirror import mirrored_problem
from scipy.interpolate import BPoly
from synthetic_waves import of_keys, problem, reference, surveyed

from analysis.tracking.kinks import DOUBT, MARGIN, kinks, unfollowed
from analysis.tracking.leading_waves import leading_waves
from analysis.tracking.peaks import PeakMeter, Peaks, find_peaks, sharp
from analysis.trajectory import Trajectory
from lammps_inputs import Problem
from lammps_inputs.laws.in_time import half_sine, rectangular
from lammps_inputs.loads import Load
from workflow.engines.reference import engine


@pytest.fixture(scope="module")
def fine() -> Trajectory:
    """Two chains, recorded often enough to know every maximum to 1e-9."""
    return reference(beads=60, duration=80.0, every=0.01)


def thinned(trajectory: Trajectory, stride: int, recorded: tuple[int, ...] | None = None) -> Trajectory:
    columns = slice(None) if recorded is None else np.array(recorded) - 1
    return Trajectory(
        replace(trajectory.problem.coarser(stride), rows=trajectory.problem.rows.only(recorded)),
        trajectory.time[::stride],
        trajectory.displacement[::stride][:, :, columns],
        trajectory.velocity[::stride][:, :, columns],
    )


def pushed(like: Problem, push: Load, **changes: Any) -> Problem:
    return replace(like, system=replace(like.system, loads=(push,)), **changes)


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("stride", [20, 100, 200])
def test_first_maxima_alone_are_the_first_of_all_however_far_apart_frames_are(fine, stride, direction):
    run = thinned(fine, stride)
    alone = PeakMeter(first_only=True, direction=direction).read([run])
    first = find_peaks([run], direction=direction).first()
    assert len(first) > 10
    for field in fields(Peaks):
        assert np.array_equal(getattr(alone, field.name), getattr(first, field.name), equal_nan=True), field.name


@pytest.mark.parametrize(("strength", "mass", "exponent"), [(1e-4, 1.0, 1.5), (1e6, 1.0, 1.5), (1e6, 100.0, 3.0)])
def test_maxima_of_stronger_contacts_and_heavier_beads_are_those_of_equal_ones_at_another_time(
    strength, mass, exponent
):
    """Velocities of equal kicks are the same at t (A / m)**(1 / (n + 1)): whichever arrivals are known is, too."""
    factor = (strength / mass) ** (1.0 / (exponent + 1.0))
    scene = {"chains": 1, "beads": 20, "kick": {"velocity": 1.0}}
    plain = of_keys(**scene, contact={"exponent": exponent}, duration=30.0)
    contact = {"exponent": exponent, "strength": strength}
    beads = {"kinds": {"heavy": {"mass": mass}}, "pattern": ["heavy"]}
    other = of_keys(**scene, **beads, contact=contact, duration=30.0 / factor, output={"every": 0.1 / factor})
    expected, found = (find_peaks([engine.run(each)]) for each in (plain, other))
    assert found.bead.tolist() == expected.bead.tolist()
    assert sharp(found).tolist() == sharp(expected).tolist() == [False, *(18 * [True]), False]
    assert np.all(np.abs(found.velocity - expected.velocity) <= found.velocity_error + expected.velocity_error + 1e-6)


@pytest.mark.parametrize("recorded", [None, (5, 20, 21, 22, 30, 31, 40, 50, 55)])
@pytest.mark.parametrize("every", [0.1, 0.5, 0.83, 1.24, 1.6])
def test_no_maximum_is_farther_off_than_it_says_however_coarse_the_frames(fine, every, recorded):
    for name in ("maximum", "impulse"):
        true = leading_waves(find_peaks([fine]), fine.problem, name)
        coarse = thinned(fine, round(every / 0.01), recorded)
        found = leading_waves(find_peaks([coarse]), coarse.problem, name)
        seen = 0
        for k in np.flatnonzero((found.bead > 1) & (found.bead < 57) & (found.peak_velocity > 0.05)):
            own = true.where((true.chain == found.chain[k]) & (true.bead == found.bead[k]))
            if abs(own.time[0] - found.time[k]) < 1.0:  # else another maximum, as the analysis warns above 1.4 T
                seen += 1
                assert abs(found.peak_velocity[k] - own.peak_velocity[0]) <= found.peak_velocity_error[k]
                assert abs(found.arrival[k] - own.arrival[0]) <= found.arrival_error[k]
        assert seen >= (18 if recorded else 110) - (4 if every > 1.4 else 0)


def test_frames_up_to_half_a_unit_apart_show_maxima_to_1e_4_and_coarser_ones_to_2e_3_and_say_so(fine):
    for stride, largest in ((10, 1e-4), (30, 1e-4), (50, 1e-4), (83, 3e-4), (124, 2e-3)):
        coarse = thinned(fine, stride)
        found = leading_waves(find_peaks([coarse]), coarse.problem)
        assert found.peak_velocity_error[found.bead < 57].max() < largest


@pytest.mark.slow
def test_frames_one_unit_apart_show_maxima_of_a_damped_chain_to_half_a_per_cent_and_half_of_them_to_2e_4_and_say_so():
    plain = {"beads": 40, "kick": {"velocity": 1.0}, "duration": 60.0, "damping": {"contact": 0.02}}
    run = engine.run(of_keys(**plain, output={"every": 0.05}))
    true, found = (leading_waves(find_peaks([part]), part.problem) for part in (run, thinned(run, 20)))
    assert np.array_equal(found.bead, true.bead)
    assert np.all(np.abs(found.peak_velocity - true.peak_velocity) <= found.peak_velocity_error)
    assert found.peak_velocity_error.max() < 5e-3
    assert np.median(found.peak_velocity_error) < 2e-4


def test_a_maximum_beside_every_largest_frame_is_no_lower_than_the_frame():
    run = engine.run(problem(4, 10.0, 30, 40.0, 2.0))
    peaks, v = find_peaks([run]), run.velocity
    largest = (v[1:-1] > 1e-3) & (v[:-2] < v[1:-1]) & (v[1:-1] >= v[2:])
    assert np.count_nonzero(largest) > 100
    for frame, chain, bead in np.argwhere(largest):
        near = np.abs(peaks.time - run.time[frame + 1]) < 2.0
        beside = near & (peaks.chain == chain + 1) & (peaks.bead == bead + 1)
        assert peaks.velocity[beside].max() > v[frame + 1, chain, bead] - 2e-9


@pytest.fixture(scope="module")
def gapped() -> Trajectory:
    return engine.run(problem(2, 0.1, 40, 250.0, 0.25, gap=2.8742376715100764))


def test_where_beads_fly_freely_the_time_of_the_maximum_is_not_defined(gapped):
    peaks = find_peaks(gapped.blocks())
    free = ~sharp(peaks) & (peaks.time > 0.0)
    assert np.count_nonzero(free) > 50
    assert np.all(np.isinf(peaks.time_error[free]))
    waves = leading_waves(peaks, gapped.problem, "maximum")
    unknown = np.isnan(waves.arrival)
    assert np.array_equal(unknown, np.isinf(waves.arrival_error))
    assert np.count_nonzero(unknown) > 10
    assert np.count_nonzero(np.isnan(waves.speed)) > 10


def test_an_impulse_of_constant_strength_has_its_centre_in_its_middle():
    what = problem(1, 0.0, 3, 20.0, 0.1, recorded=(2,), gap=5.0)
    time = np.arange(what.frames + 1) * what.every
    rise = np.clip(time - 3.0, 0.0, 2.0)  # velocity grows from t = 3 to 5, then stays but for a slow loss
    velocity = 0.25 * rise * (1.0 - 1e-6 * np.clip(time - 5.0, 0.0, None))
    displacement = 0.25 * (0.5 * rise**2 + 2.0 * np.clip(time - 5.0, 0.0, None))
    run = Trajectory(what, time, displacement[:, None, None], velocity[:, None, None])
    (centre,) = leading_waves(find_peaks([run]), what, "impulse").arrival
    assert centre == pytest.approx(4.0, abs=0.01)


@pytest.mark.slow
@pytest.mark.parametrize("recorded", [None, (2,)])
def test_the_error_of_a_peak_where_a_contact_opens_between_two_frames_is_below_what_is_said(recorded):
    fine = reference(1, 0.0, 2, duration=20.0, every=0.01, gap=3.6)  # bead 2 leaves with exactly 1
    for start in range(0, 50, 2):
        found = find_peaks([thinned(fine[start:], 50, recorded)])
        there = found.bead == 2
        assert np.all(np.abs(found.velocity[there] - 1.0) <= found.velocity_error[there]), start


FINE = 0.01
"""Time between frames of which maxima are known."""


def hit(bead, **keys):
    return {"beads": bead + 8, "kick": {"bead": bead, "velocity": 1.0}, "duration": 20.0, **keys}


def coupled(damping):
    """Two chains of five beads between walls that dissipate."""
    kicks = [{"velocity": 1.0}, {"chain": 2, "bead": 3, "velocity": 0.26}]
    keys = {"chains": 2, "beads": 5, "coupling": {"stiffness": 0.3}, "walls": {"left": "flat", "right": "rigid"}}
    return {**keys, "kick": kicks, "duration": 16.0, "damping": damping}


def stiffening(within):
    ramp = {"from": 0.2, "to": 2.0, "times": [2.97, 2.97 + within]}
    return {"beads": 8, "kick": {"velocity": 1.0}, "duration": 4.0, "foundation": {"stiffness": ramp}}


BETWEEN = {
    "contacts close": (
        {"beads": 6, "kick": [{"velocity": 1.0}, {"bead": 4, "velocity": -0.5}], "duration": 7.0},
        [50],
        2,
    ),
    # a contact with a linear dashpot opens: bead 4 is fastest then, and again a quarter of T later
    "a force jumps": (
        {"beads": 8, "contact": {"exponent": 3.0}, "duration": 16.0, "timestep": 0.01}
        | {"damping": {"contact": 0.20873, "law": "linear"}, "foundation": {"stiffness": 0.28136}}
        | {"kick": {"bead": 7, "velocity": 1.0}},
        [27],
        1,
    ),
    # contacts so stiff under their load that the fastest motion turns by 2 rad from frame to frame
    "fast under a load": (
        {"beads": 9, "contact": {"exponent": 2.0}, "precompression": {"force": 5.0}, "duration": 10.0}
        | {"walls": {"left": "bead", "right": "bead"}, "kick": {"bead": 3, "velocity": 1.0}, "timestep": 0.005},
        [33],
        4,
    ),
    "dashpots stop beads": (hit(3, damping={"contact": 30.0}, duration=12.0), [10], 10),
    "dashpots let go": (hit(3, damping={"contact": 0.3, "tension": "cut"}, duration=12.0), [10], 10),
    "a foundation stiffens at once": (stiffening(0.001), [10], 1),
    "a foundation stiffens": (stiffening(0.3), [10], 1),
    "a kicked bead is pushed": (
        {"beads": 4, "kick": {"bead": 2, "velocity": 1.0}, "duration": 5.0}
        | {"push": {"bead": 2, "peak": 0.3, "duration": 4.0, "shape": "half-sine"}},
        [50],
        50,
    ),
    # a contact that closes or opens changes the slope of the force of the dashpot beside it
    "dashpots of heavy neighbours": (
        {"beads": 4, "kick": {"velocity": 1.0}, "duration": 12.0, "damping": {"contact": 0.1}}
        | {"kinds": {"bead": {"mass": 4.0}}, "pattern": ["bead"]},
        [5, 10, 20],
        2,
    ),
    "dashpots": (coupled({"contact": 0.1}), [5, 10, 50], 50),
    "viscoelastic": (coupled({"contact": 0.3, "law": "viscoelastic"}), [5, 10, 50], 50),
    "restitution": (coupled({"contact": 0.53, "law": "restitution"}), [5, 10, 50], 50),
    # at 0.5 T a flat maximum was off by 1.13 times its bound
    "cut": (coupled({"contact": 0.115, "tension": "cut", "coupling": 0.05}), [10, 30], 30),
    "linear contacts": (hit(3, contact={"exponent": 1.0}), [10, 20, 50], 50),
    "cubic contacts": (hit(3, contact={"exponent": 3.0}), [10, 20, 50], 50),
    # in frames that begin at other times a velocity was off by 1.10 times its bound
    "gaps": (hit(3, damping={"contact": 0.3}, walls={"right": "flat", "left": "bead"}, gap=0.3), [10, 20, 50], 50),
}
"""What happens between two frames: keys, and how many fine frames are from frame to frame, and from start to start."""


@pytest.mark.slow
@pytest.mark.parametrize(("keys", "strides", "apart"), BETWEEN.values(), ids=BETWEEN)
def test_maxima_are_as_sure_as_they_say_whatever_happens_between_two_frames(keys, strides, apart):
    run, worst = engine.run(of_keys(**keys, output={"every": FINE})), 0.0
    for stride, direction in itertools.product(strides, (1, -1)):
        true = find_peaks([run], direction=direction)
        for start in range(0, stride, apart):
            found = find_peaks([run[start::stride]], direction=direction)
            found = found.where((found.velocity > 0.05) & (found.time > start * FINE))
            for k in range(len(found)):
                own = true.where((true.chain == found.chain[k]) & (true.bead == found.bead[k]))
                own = own.where(np.argmin(np.abs(own.time - found.time[k]))[np.newaxis])
                for name, rounding in (("velocity", 2e-6), ("time", 1e-6)):
                    off = np.abs(getattr(own, name) - getattr(found, name)[k])
                    stated = getattr(own, f"{name}_error") + getattr(found, f"{name}_error")[k] + rounding
                    worst = max(worst, float((off / stated)[0]))
    assert 0.05 < worst < 1.0


@pytest.mark.slow
@pytest.mark.parametrize("law", [rectangular, half_sine])
@pytest.mark.parametrize("recorded", [None, (2,)])
def test_the_error_of_a_peak_is_below_what_is_said_where_a_push_ends_between_two_frames(law, recorded):
    for share in np.linspace(0.02, 0.98, 13):
        push = Load(1, 2, law(0.2, 4.0 + 0.5 * share))
        what = pushed(problem(1, 0.0, 3, 20.0, 0.5, gap=30.0), push)
        what = replace(what, rows=what.rows.only(recorded))
        time = np.arange(what.frames + 1) * what.every
        x, v = np.zeros((2, len(time), 1, 3))
        x[:, 0, 1], v[:, 0, 1] = push.travel(time), push.impulse(time)
        columns = what.rows.numbers - 1
        run = Trajectory(what, time, x[..., columns], v[..., columns])
        found = leading_waves(find_peaks([run]), what, "impulse")
        (peak,), (centre,) = found.peak_velocity, found.arrival
        true = push.end - push.travel(push.end) / push.total_impulse
        assert abs(peak - push.total_impulse) <= found.peak_velocity_error[0]
        assert abs(centre - true) <= found.arrival_error[0]


# --- forces that begin near a frame -----------------------------------------------------------------------------------


@pytest.mark.parametrize("power", [0.0, 0.5, 1.0, 1.5, 3.0])
@pytest.mark.parametrize(("away", "between"), [(0.3, True), (0.6, True), (0.02, False), (1.0, False)])
def test_what_no_polynomial_follows_is_what_hermites_misses(power, away, between):
    times, worst = np.linspace(0.0, 1.0, 501), np.zeros(2)
    for factor in DOUBT:
        begin = 1.0 - min(factor * away, 1.0) if between else -factor * away
        ends = [max(end - begin, 0.0) for end in (0.0, 1.0)]
        data = [
            [on ** (power + 1.0) / (power + 1.0), on**power * (on > 0), power * on ** (power - 1.0) if on > 0 else 0.0]
            for on in ends
        ]
        fitted, since = BPoly.from_derivatives([0.0, 1.0], data), np.maximum(times - begin, 0.0)
        misses = (
            (fitted(times) - since ** (power + 1.0) / (power + 1.0)),
            fitted(times, 1) - since**power * (since > 0.0),
        )
        worst = np.fmax(worst, [np.abs(missed).max() for missed in misses])
    found = unfollowed(power, np.array([away]), np.array([between]))[:, 0]
    np.testing.assert_allclose(found, MARGIN * worst, rtol=0.12, atol=1e-12)


@pytest.mark.parametrize("every", [0.1, 0.5, 1.0])
def test_maxima_of_four_times_as_fast_a_motion_in_frames_as_much_closer_are_the_same(every):
    """Contacts 4**2.5 and springs 4**2 times as strong: the same velocities at a quarter of the times."""

    def scaled(factor):
        keys = {"coupling": {"stiffness": 0.1 * factor**2}, "contact": {"strength": factor**2.5}}
        keys |= {name: value / factor for name, value in (("duration", 16.0), ("timestep", 0.0125))}
        return of_keys(chains=2, beads=16, kick={"velocity": 1.0}, output={"every": every / factor}, **keys)

    run = engine.run(scaled(1.0))
    slow, fast = (
        find_peaks([run]),
        find_peaks([Trajectory(scaled(4.0), run.time / 4.0, run.displacement / 4.0, run.velocity)]),
    )
    assert len(slow.time) > 20
    np.testing.assert_allclose(fast.velocity, slow.velocity, rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(4.0 * fast.time, slow.time, rtol=0.0, atol=1e-11)


def test_a_force_that_begins_between_two_frames_begins_after_the_first_however_far_away_it_seems_to():
    near, far = unfollowed(1.5, np.array([1.5, 1.9]), np.array([True, True])).T
    assert np.array_equal(near, far)
    assert np.all(near > 0.0)


def test_bounds_by_forces_that_begin_between_frames_are_those_of_the_mirror_image():
    kinds = {"heavy": {"mass": 1.0}, "light": {"mass": 0.4}, "medium": {"mass": 0.7}}
    damped = {"damping": {"contact": 0.1}, "duration": 8.0, "output": {"every": 0.5}}
    one = of_keys(chains=1, beads=12, kinds=kinds, pattern=list(kinds), kick={"velocity": 1.0}, **damped)
    run, other = engine.run(one), engine.run(mirrored_problem(one))
    start, bead = (each.ravel() for each in np.indices((run.frames - 1, 12)))
    bounds, mirrored = (kinks(each, start, 0 * bead, at) for each, at in ((run, bead), (other, 11 - bead)))
    assert np.count_nonzero(bounds > 1e-6) > 100
    np.testing.assert_allclose(mirrored, bounds, rtol=1e-6, atol=1e-12)


@pytest.mark.parametrize("sign", [1, -1])
def test_a_second_kick_ahead_begins_another_pulse_and_no_speed_leads_across(sign):
    bead = 10 if sign > 0 else 11
    kicks = [{"bead": 1 if sign > 0 else 20, "velocity": sign}, {"bead": bead, "velocity": 0.9 * sign}]
    results = surveyed(engine.run(of_keys(chains=1, beads=20, kick=kicks, duration=16.0)))
    waves = results.waves
    behind = sign * waves.bead < sign * bead
    np.testing.assert_array_equal(waves.pulse, np.where(behind, 1, 2))
    undefined = waves.bead[np.isnan(waves.speed) & (np.abs(waves.bead - 10.5) < 8.0)].tolist()  # clear of the ends
    assert undefined == sorted([bead, bead - sign])
