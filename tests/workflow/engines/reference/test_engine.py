"""The reference: published numbers, measured orders, exact symmetries, and agreement with what is independent of it."""

import functools
import math
from dataclasses import replace

import numpy as np
import pytest
from stock_lammps import scene
from synthetic_waves import of_keys

from analysis import motion
from analysis.compare.common_times import near_the_front
from analysis.tracking.leading_waves import leading_waves
from analysis.tracking.peaks import find_peaks
from analysis.trajectory import EXCHANGES
from lammps_inputs import Kick, find, physics
from lammps_inputs.laws import Law, Pure
from lammps_inputs.laws.weight import Weight
from lammps_inputs.limits.rates import stability_bound
from lammps_inputs.links import Links
from workflow.engines.reference.engine import blocks, brought_up, default_steps_per_frame, make_state, passages, run
from workflow.engines.reference.kernel import FrameArrays
from workflow.engines.reference.schemes import BLANES_MOAN, SUZUKI4, VERLET

SCHEMES = [VERLET, BLANES_MOAN]

CONTACT_TIME = 2 * (5 / 8) ** 0.4 * math.sqrt(math.pi) * math.gamma(1.4) / math.gamma(0.9)
"""Of two beads that meet at V = 1: r'^2 = 1 - 8/5 r^2.5 integrated; 2.438838."""

EPS = np.finfo(float).eps


def problem(**changes):
    """Two chains of 12 rows to t = 10, a frame each 0.1."""
    return scene(**{"chains": 2, "beads": 12, "kappa": 0.1, "duration": 10.0, **changes}).problem()


class Wind(Law):
    """``-rate t``, a force on every bead that grows with time."""

    varies = True

    rate: Pure

    @staticmethod
    def force(s, t, rate):
        return -rate * t + 0.0 * s

    @staticmethod
    def power(s, t, rate):  # noqa: ARG004
        return -rate * s

    @staticmethod
    def stiffness(s, t, rate):  # noqa: ARG004
        return 0.0 * s

    @staticmethod
    def max_strain(energy, rate):  # noqa: ARG004
        return 0.0

    @classmethod
    def stiffest(cls, energy, *law):  # noqa: ARG003
        return 0.0

    def now(self, t):
        return Weight(self.rate * t, 1.0)


def integrated(state, like, scheme, h, steps):
    """One frame, ``steps`` steps of h after a state of the kernel."""
    shape = (1, like.chains, like.beads)
    frames = FrameArrays(np.empty(shape), np.empty(shape), np.zeros((1, len(EXCHANGES))))
    state.span[3] = 1
    state.advance(scheme, h, 0, steps, np.arange(1, like.beads + 1), frames)
    return frames.x[0], frames.v[0]


def all_rows(like):
    """The start of a problem with every row active."""
    state = make_state(like, None)
    state.span[:2] = 1, like.beads
    return state


def order(h, error):
    """Slope of the regression of log(error) on log(h)."""
    return float(np.polyfit(np.log(h), np.log(error), 1)[0])


# --- published numbers -----------------------------------------------------------------


@functools.cache
def waves(chains, kappa, beads, duration):
    what = problem(chains=chains, kappa=kappa, beads=beads, duration=duration, every=0.2)
    return leading_waves(find_peaks(blocks(what)), what)


def test_two_chains_have_the_published_peaks():
    published = {5: (0.5011, 0.3529), 10: (0.3223, 0.4630), 20: (0.3351, 0.3993), 30: (0.3964, 0.3329)}
    published |= {40: (0.3548, 0.3761), 55: (0.36892, 0.36157)}
    for bead, peaks in published.items():
        digits = 5e-6 if bead == 55 else 5e-5  # half of the last one printed, and the reference's 1e-6
        assert waves(2, 0.1, 70, 90.0).at(bead).peak_velocity == pytest.approx(peaks, abs=digits + 2e-6)


def test_three_chains_have_the_published_peaks_at_bead_90():
    assert waves(3, 0.1, 100, 155.0).at(90).peak_velocity == pytest.approx((0.25525, 0.25563, 0.25596), abs=7e-6)


@pytest.mark.parametrize(("kappa", "final"), [(0.5, 0.35934), (0.1, 0.36524)])
def test_level_chains_have_the_published_final_peak(kappa, final):
    assert waves(2, kappa, 200, 275.0).at(190).peak_velocity == pytest.approx((final, final), abs=7e-6)


def test_one_chain_has_the_published_solitary_wave():
    wave = waves(1, None, 120, 160.0).at(100)
    assert wave.peak_velocity == pytest.approx(0.6816315, abs=1e-6)
    assert wave.speed == pytest.approx(0.8405088, abs=5e-6)  # arrivals two beads apart, each to some 1e-6
    assert wave.arrival == pytest.approx(0.77532 + 99 / 0.8405088, abs=1e-5)


def test_one_chain_throws_its_first_beads_back_as_published():
    velocity = run(problem(chains=1, kappa=None, beads=120, duration=140.0)).velocity[-1, 0]
    assert velocity[:2] == pytest.approx((-0.071085, -0.030274), abs=2e-6)


def test_a_contact_of_two_beads_has_the_exact_overlap_and_ends_at_the_exact_time():
    two = run(problem(chains=1, kappa=None, beads=2, duration=3.0, every=0.001), steps_per_frame=1)
    overlap = motion.overlaps(two.problem.system, two.displacement)[:, 0, 0]
    assert overlap.max() == pytest.approx((5 / 8) ** 0.4, abs=1e-6)  # sampled within 0.0005, curvature 1.25
    assert two.time[overlap > 0][-1] == pytest.approx(CONTACT_TIME, abs=0.0011)
    assert pytest.approx(2.438838, abs=5e-7) == CONTACT_TIME


# --- measured orders --------------------------------------------------------------------------------------------------

PRESSED = 12


def pressed():
    """Two coupled chains of beads that overlap by about 1 all the while to t = 0.5: a smooth problem."""
    rng = np.random.default_rng(1)
    state = all_rows(problem(beads=PRESSED, kappa=0.5))
    state.x[1:-1] = (-np.arange(PRESSED) + rng.uniform(-0.1, 0.1, (2, PRESSED))).T
    state.v[1:-1] = rng.uniform(-0.3, 0.3, (PRESSED, 2))
    return state


@pytest.mark.parametrize(
    ("scheme", "steps", "band"),
    [
        (VERLET, (8, 12, 16, 24, 32, 48, 64), 0.005),
        (BLANES_MOAN, (2, 3, 4, 6, 8, 12, 16), 0.03),
        (SUZUKI4, (4, 6, 8, 12, 16, 24, 32), 0.03),
    ],
    ids=lambda value: getattr(value, "name", ""),
)
def test_a_scheme_has_its_order_while_contacts_stay_closed(scheme, steps, band):
    like = problem(beads=PRESSED, kappa=0.5)
    x, exact = integrated(pressed(), like, BLANES_MOAN, 0.5 / 256, 256)
    assert motion.overlaps(like.system, x).min() > 0.5
    steps = np.array(steps)
    error = [np.abs(integrated(pressed(), like, scheme, 0.5 / n, n)[1] - exact).max() for n in steps]
    assert order(0.5 / steps, error) == pytest.approx(scheme.order, abs=band)


@pytest.mark.parametrize(("share", "steps"), [(0.01, 2), (1.0, 2), (1.01, 4), (7.0, 14), (7.01, 16)])
def test_steps_are_an_even_number_that_are_a_fifteenth_of_the_stability_bound_long_or_shorter(share, steps):
    """Frames are so many times two such steps apart."""
    apart = share * 2.0 / 15.0 * stability_bound(problem().system)
    assert default_steps_per_frame(replace(problem(), timestep=apart, steps_per_frame=1)) == steps


@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda scheme: scheme.name)
def test_a_scheme_has_its_order_on_a_linear_spring(scheme):
    far = problem(beads=2, gap=60.0, duration=8.0, every=8.0, timestep=0.01)
    omega = math.sqrt(0.2)
    steps = np.array([10, 14, 20, 28, 40, 56, 80])
    exact = 0.5 * (1 + math.cos(8 * omega))
    error = [abs(run(far, scheme=scheme, steps_per_frame=n).velocity[-1, 0, 0] - exact) for n in steps]
    assert order(8 / steps, error) == pytest.approx(scheme.order, abs=0.03)


@pytest.mark.slow
@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda scheme: scheme.name)
def test_a_contact_that_closes_and_opens_costs_an_error_of_order_five_halves(scheme):
    # the velocities after it, which are exactly 0 and 1; root mean square over where in a step the contact opens
    two = problem(chains=1, kappa=None, beads=2, duration=4.0, every=4.0, timestep=0.01)
    mean, error = [], []
    for octave in range(3, 10):
        steps = np.unique(np.geomspace(2**octave, 2 ** (octave + 1), 48).astype(int))
        wrong = [run(two, scheme=scheme, steps_per_frame=n).velocity[-1, 0, 0] for n in steps]
        mean.append(4 / steps.mean())
        error.append(np.sqrt(np.mean(np.square(wrong))))
    assert order(mean, error) == pytest.approx(2.5, abs=0.15)


def test_the_error_of_verlet_at_the_end_of_two_chains_is_the_published_one():
    two = find("two-chains").problem()
    verlet, exact = (run(two, scheme=scheme, steps_per_frame=10).velocity[-1] for scheme in SCHEMES)
    assert np.abs(verlet - exact).max() == pytest.approx(
        0.149 * 0.01**2, rel=0.01
    )  # the error law of velocity Verlet; at t = 192


def test_the_energy_of_verlet_swings_as_the_step_squared():
    like = problem(beads=40, duration=40.0, every=0.4)
    steps = np.array([4, 8, 16, 32, 64])
    swing = [np.ptp(energies(run(like, scheme=VERLET, steps_per_frame=n))) for n in steps]
    assert order(0.4 / steps, swing) == pytest.approx(2.0, abs=0.05)


def energies(trajectory):
    return motion.energy(trajectory.problem.system, trajectory.displacement, trajectory.velocity)


# --- what the equations conserve, and their symmetries ----------------------------------------------------------------

SHAPES = [(1, None, 0.0), (2, 0.1, 0.0), (3, 0.5, 0.0), (5, 2.0, 0.0), (2, 0.1, 0.3)]


@pytest.mark.parametrize(("chains", "kappa", "gap"), SHAPES)
@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda scheme: scheme.name)
def test_momentum_is_kept_to_rounding(scheme, chains, kappa, gap):
    like = problem(chains=chains, kappa=kappa, gap=gap, kick=(Kick(velocity=1.0), Kick(bead=9, velocity=-0.4)))
    found = run(like, scheme=scheme)
    # a kick rounds each velocity, below 1 here, by eps / 2 at most: ten times the root of the number of roundings
    roundings = scheme.forces_per_step * like.frames * 2 * like.beads * chains
    assert (
        np.abs(motion.momentum(like.system, found.velocity) - physics.momentum(like.system)).max()
        < 10 * roundings**0.5 * EPS / 2
    )


@pytest.mark.parametrize(("chains", "kappa", "gap"), SHAPES)
def test_energy_is_kept_to_one_millionth_at_the_default_step(chains, kappa, gap):
    like = problem(chains=chains, kappa=kappa, gap=gap)
    assert energies(run(like)) == pytest.approx(physics.energy(like.system), abs=1e-6)


@pytest.mark.parametrize(("chains", "kappa", "gap"), SHAPES)
def test_the_last_bead_kicked_backwards_mirrors_the_first_kicked_forwards_bit_for_bit(chains, kappa, gap):
    forwards, backwards = (
        run(problem(chains=chains, kappa=kappa, gap=gap, kick=(kick,)))
        for kick in (Kick(bead=1, velocity=1.0), Kick(bead=12, velocity=-1.0))
    )
    np.testing.assert_array_equal(forwards.displacement, -backwards.displacement[:, :, ::-1])
    np.testing.assert_array_equal(forwards.velocity, -backwards.velocity[:, :, ::-1])


def test_a_scheme_retraces_its_way_when_velocities_are_turned():
    like = problem()
    state = all_rows(like)
    integrated(state, like, BLANES_MOAN, 0.05, 200)
    np.negative(state.v, out=state.v)
    x, v = integrated(state, like, BLANES_MOAN, 0.05, 200)
    # 400 steps of 7 stages, each with a random rounding below 8 eps; errors at most grow as time does, over 20
    bound = (400 * 7) ** 0.5 * 8 * EPS * 20
    np.testing.assert_allclose(x, 0.0, atol=bound)
    np.testing.assert_allclose(v, -physics.initial_velocity(like.system), rtol=0, atol=bound)


@pytest.mark.parametrize("speed", [1e-12, 1e12])
def test_a_run_at_any_v_is_a_scaled_copy_of_the_run_at_1(speed):
    one, other = (
        run(problem(kick=(Kick(velocity=v),), kappa=0.1 * v**0.4, duration=10 * v**-0.2, every=0.1 * v**-0.2))
        for v in (1.0, speed)
    )
    # kappa and step differ by some eps, which shifts times below 10 and forces below 1 in proportion, and then rounding
    bound = 10 * 10 * 16 * EPS
    np.testing.assert_allclose(other.velocity, one.velocity, rtol=0, atol=bound)
    np.testing.assert_allclose(other.displacement, one.displacement, rtol=0, atol=bound)


def test_a_bead_of_mass_2_that_swings_as_the_sine_brings_up_minus_the_square_of_that():
    """Its velocity is the cosine: m / 2 (cos^2 - 1), in units of m V^2 with V the largest velocity."""
    kinds = {"kinds": {"heavy": {"mass": 2.0}, "light": {}}, "pattern": ["heavy", "light"]}
    drive = {"displacement": 0.1, "frequency": 0.2}
    swung = of_keys(chains=1, beads=3, drive=drive, duration=5.0, **kinds)
    time = np.linspace(0.0, 5.0, 11)
    phase = 2.0 * np.pi * 0.2 * swung.scale.time * time
    np.testing.assert_allclose(brought_up(swung, time), -(np.sin(phase) ** 2), rtol=0.0, atol=1e-12)


# --- rows that are integrated -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("bead", [1, 20, 40])
@pytest.mark.parametrize(("chains", "kappa", "gap"), SHAPES[1::3])
def test_integrating_the_rows_that_can_move_is_bit_for_bit_integrating_all(chains, kappa, gap, bead):
    kick = Kick(bead=bead, velocity=1.0 if bead < 40 else -1.0)
    like = problem(chains=chains, kappa=kappa, gap=gap, beads=40, kick=(kick,))
    found = run(like, steps_per_frame=4)
    x, v = integrated(all_rows(like), like, BLANES_MOAN, like.every / 4, 4 * like.frames)
    np.testing.assert_array_equal(found.displacement[-1], x)
    np.testing.assert_array_equal(found.velocity[-1], v)


@pytest.mark.parametrize(("chains", "kappa"), [(2, 0.01), (2, 0.1), (3, 0.1)])
def test_a_window_of_forty_rows_has_the_front_of_the_full_run_bit_for_bit(chains, kappa):
    like = problem(chains=chains, kappa=kappa, beads=300, duration=350.0, every=0.5)
    full, seen = (run(like, rows=window) for window in (None, 40))
    for frame in range(0, full.frames, 7):
        front = np.flatnonzero((full.velocity[frame] != 0.0).any(axis=0))[-1]
        rows = slice(max(0, front - 8), front + 1)
        np.testing.assert_array_equal(seen.velocity[frame, :, rows], full.velocity[frame, :, rows])


def test_frames_of_a_window_show_all_rows_until_the_pulse_has_passed_as_many_and_then_those_near_it_bit_for_bit():
    like, seen = problem(beads=115, duration=120.0, every=0.5), 0
    whole = run(like)
    for block in blocks(replace(like, rows=like.rows.near_front(64))):
        before = np.flatnonzero(whole.velocity[max(0, seen - 1)].any(axis=0))[-1] + 1
        assert (block.first == 1) == (before < 64)
        part, same = near_the_front(block), slice(seen, seen + block.frames)
        np.testing.assert_array_equal(part.velocity, whole.velocity[same][..., part.beads - 1])
        seen += block.frames
    assert seen == whole.frames
    assert before > 64


# --- what is independent of it ----------------------------------------------------------------------------------------


def acceleration(x, like):
    """Eq. 1, written once more, [chain, bead], in any precision."""
    a = np.zeros_like(x)
    push = np.maximum(x[:, :-1] - x[:, 1:] - physics.gap(like.system), 0) ** (x.dtype.type(3) / 2)
    a[:, :-1] -= push
    a[:, 1:] += push
    pull = physics.kappa(like.system) * (x[1:] - x[:-1])
    a[:-1] += pull
    a[1:] -= pull
    return a


@pytest.mark.slow
@pytest.mark.skipif(np.finfo(np.longdouble).eps > EPS / 100, reason="no longer float than float64 here")
@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda scheme: scheme.name)
@pytest.mark.parametrize(("chains", "kappa", "gap"), SHAPES)
def test_the_same_scheme_in_extended_precision_agrees_to_rounding(chains, kappa, gap, scheme):
    like = problem(chains=chains, kappa=kappa, gap=gap)
    steps = 4 * like.frames
    x = np.zeros((like.chains, like.beads), np.longdouble)
    v = physics.initial_velocity(like.system).astype(np.longdouble)
    h = np.longdouble(like.every / 4)
    for _ in range(steps):
        for kick, drift in zip(scheme.kicks, (*scheme.drifts, 0.0), strict=True):
            v += kick * h * acceleration(x, like)
            x += drift * h * v
    found = run(like, scheme=scheme, steps_per_frame=4)
    # a stage rounds positions and velocities, below 8, at random; such errors grow at most as time does, to 10
    bound = (steps * len(scheme.kicks)) ** 0.5 * 8 * EPS * 10
    np.testing.assert_allclose(found.velocity[-1], v.astype(float), rtol=0, atol=bound)
    np.testing.assert_allclose(found.displacement[-1], x.astype(float), rtol=0, atol=bound)


# --- the leading pulse at every bead without frames -------------------------------------------------------------------


def test_leading_peaks_are_those_of_recorded_frames():
    short = problem(beads=60, duration=90.0)
    recorded = leading_waves(find_peaks([run(short, steps_per_frame=1)]), short)
    noted = passages(short, timestep=0.1)
    clear = recorded.bead < 55  # the free end makes arrivals ill-defined
    np.testing.assert_array_equal(noted.bead, recorded.bead)
    # both interpolate steps of 0.1 with polynomials of degree 3 and 5: v h**4 / 384 with v about 10
    np.testing.assert_allclose(noted.peak_velocity[clear], recorded.peak_velocity[clear], atol=5e-6)
    np.testing.assert_allclose(noted.arrival[clear], recorded.arrival[clear], atol=5e-5)


def test_no_peak_is_later_than_the_problem_s_end_however_many_calls_its_steps_take():
    """In 1200 steps, of at most 1000 a call; the pulse passes a bead in 1.5."""
    arrival = passages(problem(beads=80, duration=60.0), timestep=0.05).arrival
    assert 58.0 < arrival.max() <= 60.0


@pytest.mark.slow
@pytest.mark.parametrize(("chains", "kappa"), [(1, None), (2, 0.1)])
def test_a_window_behind_the_front_changes_no_bit_of_the_leading_pulse(chains, kappa):
    like = problem(chains=chains, beads=400, kappa=kappa, duration=2000.0)
    whole, windowed = (passages(like, until_bead=390, rows=window) for window in (None, 40))
    ahead, same = (leading.bead <= 390 for leading in (windowed, whole))
    np.testing.assert_array_equal(windowed.arrival[ahead], whole.arrival[same])
    np.testing.assert_array_equal(windowed.peak_velocity[ahead], whole.peak_velocity[same])


def test_a_law_in_time_moves_beads_at_rest_far_from_the_kick():
    still = problem(chains=1, kappa=0.0, kick=Kick(bead=12, velocity=1.0))
    wind = Links.ground("wind", Wind(0.1))
    moved = run(replace(still, system=replace(still.system, links=(*still.system.links, wind))))
    expected = 0.05 * moved.time[:, np.newaxis] ** 2 + (np.arange(12) == 11)  # v' = t / 10; the last bead flies off
    np.testing.assert_allclose(moved.velocity[:, 0], expected, rtol=0.0, atol=1e-12)


def test_a_law_in_time_between_beads_is_refused():
    with pytest.raises(ValueError, match="wind: a law that depends on time is that of links to the ground"):
        Links.along("wind", Wind(0.1))
