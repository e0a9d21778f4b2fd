"""Known beads of agreement, and synthetic sharings of known mismatch, beat and decay."""

import functools
import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from mirror import mirrored_problem
from synthetic_waves import of_keys, problem, reference, surveyed

from analysis.sharing.equipartition import Final, Sharing, error_of_crossing, runs_exact_waves
from analysis.sharing.impulses import measure
from analysis.sharing.survey import Survey
from analysis.sharing.verdict import SINGLE_CHAIN, EquipartitionState, expected_n_star, fit_decay, verdict_on
from lammps_inputs import Kick
from workflow.engines.reference import engine

RUNS = {
    (2, 0.5): (120, 192.0),
    (2, 0.1): (120, 192.0),
    (2, 0.01): (640, 900.0),
    (3, 0.1): (150, 230.0),
}


@functools.cache
def run(chains: int, kappa: float) -> Survey:
    return surveyed(reference(chains, kappa, *RUNS[chains, kappa]))


def beating(level: float, beat: float, decay: float, last: int = 200, first: int = 2, chains: int = 2) -> Sharing:
    """Amplitudes of the first chain and of all others beat about a level: cos(2 pi n / beat) exp(-n / decay)."""
    bead = np.arange(first, last + 1)
    deviation = 0.5 * np.cos(2.0 * np.pi * bead / beat) * np.exp(-bead / decay)
    amplitude = level * np.stack([1.0 + deviation, *[1.0 - deviation] * (chains - 1)], axis=1)
    arrival = np.stack([bead / 0.74] * chains, axis=1)
    return Sharing(0, bead, arrival, amplitude, 0.5)


@pytest.mark.parametrize("places", [slice(0, 1), slice(-1, None), slice(50, 60), slice(None)])
def test_where_all_amplitudes_are_0_the_mismatch_is_undefined_and_the_other_places_are_as_they_were(places):
    shared = beating(0.5, 20.0, 60.0)
    still = np.zeros(len(shared), dtype=bool)
    still[places] = True
    without = replace(shared, amplitude=np.where(still[:, np.newaxis], 0.0, shared.amplitude))
    assert np.isnan(without.mismatch[still]).all()
    np.testing.assert_array_equal(without.mismatch[~still], shared.mismatch[~still])
    np.testing.assert_array_equal(without.spread[~still], shared.spread[~still])
    assert np.isfinite(without.beats).all()
    assert without.agrees_from(0.01) is None or without.agrees_from(0.01) > without.bead[still].max()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("chains", "kappa", "of_a_tenth", "of_a_hundredth"),
    [(2, 0.5, 11, 17), (2, 0.1, 33, 62), (2, 0.01, 265, 507), (3, 0.1, 64, 105)],
)
def test_chains_agree_from_the_bead_of_the_table(chains, kappa, of_a_tenth, of_a_hundredth):
    """Weakly coupled ones within one per cent, which is less than a bead of the others."""
    found = [run(chains, kappa).shared.agrees_from(tolerance) for tolerance in (0.1, 0.01)]
    assert found == pytest.approx([of_a_tenth, of_a_hundredth], abs=0.0, rel=0.01 if kappa < 0.1 else 0.0)


@pytest.mark.parametrize(
    ("chains", "kappa", "peak"),
    [(2, 0.5, 0.35934), (2, 0.1, 0.36524), pytest.param(2, 0.01, 0.3196, marks=pytest.mark.slow), (3, 0.1, 0.25559)],
)
def test_final_amplitude_is_that_of_the_table_and_within_its_own_uncertainty(chains, kappa, peak):
    final = run(chains, kappa).shared.final
    assert final.value == pytest.approx(peak, abs=5e-5)
    assert abs(final.value - peak) <= final.uncertainty + 5e-6


@pytest.mark.parametrize(
    ("kappa", "share"), [(0.5, 0.552), (0.1, 0.571), pytest.param(0.01, 0.437, marks=pytest.mark.slow)]
)
def test_share_of_the_energy_in_the_waves_is_that_of_the_table_by_amplitude_and_by_measurement(kappa, share):
    found = run(2, kappa)
    assert np.sum(found.shared.wave_share[-1]) == pytest.approx(share, abs=1e-3)
    assert np.sum(found.energies.wave[-1]) == pytest.approx(share, abs=1e-3)


def test_energies_of_the_chains_add_up_to_that_of_the_kick():
    assert np.allclose(np.sum(run(3, 0.1).energies.chain, axis=1), 1.0, rtol=0, atol=1e-5)


def by_hand(kicked: int = 0) -> Sharing:
    """Three chains at one bead: amplitudes 0.5, 0.25, 0.125, arriving at 10, 13, 9."""
    return Sharing(kicked, np.array([20]), np.array([[10.0, 13.0, 9.0]]), np.array([[0.5, 0.25, 0.125]]), 0.5)


def test_lags_mismatch_spread_and_shares_are_those_of_their_definitions():
    """A lag is positive for a wave after that of the chain that was hit; a wave is 1.579 beads long."""
    assert by_hand().lag.tolist() == [[0.0, 3.0, -1.0]]
    assert by_hand(kicked=1).lag.tolist() == [[-3.0, 0.0, -4.0]]
    assert by_hand().mismatch[0] == pytest.approx(0.375 / (0.875 / 3.0), rel=1e-15)
    passage = 1.579 / (0.9074701 * (0.875 / 3.0) ** 0.2)
    assert by_hand().spread[0] == pytest.approx(4.0 / passage, rel=5e-4)
    assert by_hand().wave_share[0] == pytest.approx(1.069323 * np.array([0.5, 0.25, 0.125]) ** 2 / 0.5, rel=1e-6)


@pytest.mark.slow
@settings(max_examples=50)
@given(st.floats(12.0, 60.0), st.floats(0.2, 0.5), st.floats(30.0, 200.0))
def test_a_known_beat_is_measured_within_its_scatter(beat, level, decay):
    found = beating(level, beat, decay).beat_length
    assert found.value == pytest.approx(beat, rel=2e-3)
    assert found.uncertainty < 0.01 * beat


@pytest.mark.slow
@settings(max_examples=50)
@given(st.floats(12.0, 40.0), st.floats(20.0, 50.0))
@example(20.0, 50.0)
def test_agreement_is_foretold_within_its_uncertainty(beat, decay):
    whole, cut = (beating(0.36, beat, decay, last) for last in (400, 100))
    agreed, expected = whole.agrees_from(0.01), cut.expected_agreement(0.01)
    assert abs(expected.value - agreed) <= expected.uncertainty
    assert expected.uncertainty <= beat + 0.3 * max(expected.value - 100.0, 0.0)  # half the way on only after two beats


@pytest.mark.parametrize(
    ("chains", "kicked", "foretold"),
    [(2, 2, True), (4, 1, True), (4, 2, True), (5, 1, True), (5, 2, False), (5, 4, False), (5, 5, True)],
)
def test_the_beats_foretell_agreement_unless_an_inner_chain_of_more_than_four_was_kicked(chains, kicked, foretold):
    """The rule of thumb gives a bead that has passed already."""
    keys = {"chains": chains, "coupling": {"stiffness": 0.3}, "kick": {"chain": kicked, "velocity": 1.0}}
    whole, cut = (replace(beating(0.36, 30.0, 40.0, last, 2, chains), kicked=kicked - 1) for last in (400, 130))
    expected = verdict_on(cut, of_keys(**keys, beads=400, duration=1.0), None).expected
    if foretold:
        assert abs(expected.value - whole.agrees_from(0.01)) <= expected.uncertainty
    else:
        assert expected is None


@pytest.mark.parametrize(("beads", "counts"), [(10, False), (11, True)])
def test_agreement_counts_that_is_as_long_as_the_last_half_beat(beads, counts):
    """The last half beat is 10 beads long; from bead 32 on amplitudes differ by a thousandth, over 9 or 10 beads."""
    deviation = np.concatenate([np.repeat([0.25, -0.25, 0.25], 10), np.full(beads, 5e-4)])
    amplitude = 0.5 * np.stack([1.0 + deviation, 1.0 - deviation], axis=1)
    shared = Sharing(0, np.arange(2, 32 + beads), np.zeros(amplitude.shape), amplitude, 0.5)
    assert np.diff(shared.beats).tolist() == [10.0]
    assert shared.agrees_from(0.01) == (32 if counts else None)


def test_changes_of_sign_between_two_beads_make_no_beat():
    amplitude = np.full((20, 2), 0.36)
    amplitude[:, 0] *= np.where(np.arange(20) == 12, 0.9999, 1.01)
    shared = Sharing(0, np.arange(2, 22), np.zeros((20, 2)), amplitude, 0.5)
    assert shared.beat_length is None
    assert shared.agrees_from(0.1) is None


@pytest.mark.parametrize("direction", [1, -1])
def test_chains_with_gaps_are_compared_by_the_impulses_of_first_contacts(direction):
    what = problem(2, 0.1, 30, 250.0, 0.25, gap=2.8742376715100764)
    kicked = what if direction > 0 else mirrored_problem(what)
    found = surveyed(engine.run(kicked)).shared
    expected = measure(what, [engine.run(what)])
    rows = np.isin(expected.bead, found.bead)
    assert found.compared == "impulses of first contacts"
    assert len(found) > 10
    np.testing.assert_allclose(found.amplitude, expected.first[:, rows].T, rtol=0, atol=2e-6)


RULE = [  # 10 + 5 / kappa * (chains / 2)**1.6 beads
    ({}, 60.0),
    ({"coupling": {"stiffness": 2.0}}, 12.5),
    ({"coupling": {"stiffness": 0.003}}, 10.0 + 5.0 / 0.003),
    ({"chains": 20, "kick": {"chain": 20, "velocity": 1.0}}, 10.0 + 50.0 * 10.0**1.6),
    ({"chains": 3, "coupling": {"stiffness": 0.01}}, 10.0 + 500.0 * 1.5**1.6),
    ({"coupling": {"stiffness": 2.1}}, None),
    ({"coupling": {"stiffness": 0.0029}}, None),
    ({"chains": 21}, None),
    ({"chains": 3, "coupling": {"stiffness": 0.009}}, None),
    ({"chains": 3, "coupling": {"stiffness": 0.1, "topology": "ring"}}, None),
    ({"chains": 3, "kick": {"chain": 2, "velocity": 1.0}}, None),
    ({"kick": {"bead": 2, "velocity": 1.0}}, None),
    ({"kick": [{"velocity": 1.0}, {"chain": 2, "velocity": 0.5}]}, None),
    ({"contact": {"exponent": 2}}, None),
    ({"contact": {"strength": 2}}, 10.0 + 50.0 * 2.0**0.8),
    ({"disorder": {"mass": 1e-3}}, None),
    ({"push": {"peak": 0.1, "duration": 3.0, "shape": "half-sine"}}, None),
    ({"damping": {"contact": 1e-3}}, None),
    ({"precompression": {"force": 0.1}}, None),
    ({"gap": 0.1}, None),
]


@pytest.mark.parametrize(("keys", "bead"), RULE)
def test_verdict_without_any_place_gives_the_rule_of_thumb_where_that_was_measured(keys, bead):
    plain = {"chains": 2, "beads": 40, "coupling": {"stiffness": 0.1}, "kick": {"velocity": 1.0}, "duration": 1.0}
    what = of_keys(**{**plain, **keys})
    empty = Sharing(0, np.zeros(0, dtype=np.int64), *np.zeros((2, 0, what.chains)), 0.5)
    verdict = verdict_on(empty, what, None)
    assert verdict.state is EquipartitionState.SHORT
    assert (None if verdict.expected is None else verdict.expected.value) == (bead and pytest.approx(bead))


def test_a_weakly_coupled_pulse_decays_by_the_law():
    fit = surveyed(reference(2, 0.002, 400, 560.0)).decay
    assert fit.n_star == pytest.approx(fit.n_star_expected, rel=0.01)
    assert fit.v0 == pytest.approx(SINGLE_CHAIN, rel=0.005)
    assert fit.deviation < 2e-3


@pytest.mark.slow
def test_the_pulse_of_a_chain_between_two_decays_twice_as_fast():
    fit = surveyed(reference(3, 0.002, 400, 560.0, kicks=[Kick(chain=2, velocity=1.0)])).decay
    assert fit.n_star == pytest.approx(expected_n_star(0.002, 2), rel=0.02)


@pytest.mark.parametrize(("chain", "springs"), [(1, 1), (2, 2), (3, 2), (4, 1)])
def test_the_law_expects_a_spring_for_each_neighbour(chain, springs):
    bead = np.arange(2, 120)
    amplitude = np.full((118, 4), 0.01)
    amplitude[:, chain - 1] = SINGLE_CHAIN * (1.0 - (bead - 1) / 500.0) ** 2.5
    shared = Sharing(chain - 1, bead, np.zeros((118, 4)), amplitude, 0.5)
    fit = fit_decay(shared, problem(4, 0.002, kicks=[Kick(chain=chain, velocity=1.0)]))
    assert fit.n_star_expected == pytest.approx(2.709 / (0.002 * springs), rel=2e-4)


def test_contacts_32_times_as_strong_decay_as_others_do_on_a_sixteenth_of_the_springs():
    """Both are the same motion, four times as fast."""
    bead = np.arange(2, 120)
    amplitude = np.stack([SINGLE_CHAIN * (1.0 - (bead - 1) / 500.0) ** 2.5, 0.01 + 0.0 * bead], axis=1)
    shared = Sharing(0, bead, np.zeros((118, 2)), amplitude, 0.5)
    keys = {"chains": 2, "beads": 120, "kick": {"velocity": 1.0}, "duration": 1.0}
    strong = of_keys(**keys, coupling={"stiffness": 0.032}, contact={"strength": 32.0})
    assert fit_decay(shared, strong).n_star_expected == pytest.approx(expected_n_star(0.002), rel=1e-12)


@pytest.mark.slow
@settings(max_examples=30)
@given(st.floats(1e-4, 5e-3), st.floats(0.98, 1.02))
def test_a_known_decay_is_fitted_exactly(kappa, factor):
    n_star = factor * expected_n_star(kappa)
    bead = np.arange(2, 120)
    first = SINGLE_CHAIN * (1.0 - (bead - 1) / n_star) ** 2.5
    shared = Sharing(0, bead, np.zeros((118, 2)), np.stack([first, 0.1 * first], axis=1), 0.5)
    fit = fit_decay(shared, problem(2, kappa))
    assert fit.n_star == pytest.approx(n_star, rel=1e-9)
    assert fit.v0 == pytest.approx(SINGLE_CHAIN, rel=1e-9)


def test_the_uncertainties_of_a_fitted_decay_are_the_scatter_of_fits_to_noise():
    """A sample of 400 knows its standard deviation to 3.5 per cent; bounds are three times that."""
    bead, random = np.arange(2, 120), np.random.default_rng(7)
    fits = []
    for _ in range(400):
        line = SINGLE_CHAIN**0.4 * (1.0 - (bead - 1) / 125.0) + random.normal(0.0, 1e-3, len(bead))
        shared = Sharing(0, bead, np.zeros((118, 2)), np.stack([line**2.5, 1e-6 + 0.0 * bead], axis=1), 0.5)
        fits.append(fit_decay(shared, problem(2, 0.002)))
    for name in ("n_star", "v0"):
        scatter = np.std([getattr(fit, name) for fit in fits], ddof=1)
        stated = np.sqrt(np.mean([getattr(fit, f"{name}_error") ** 2 for fit in fits]))
        assert stated == pytest.approx(scatter, rel=0.105), name


def test_the_uncertainties_of_a_fitted_decay_hold_the_errors_of_amplitudes_of_either_sign():
    """An exact decay has no scatter: they are the sums of what each amplitude changes by its error."""
    bead, error = np.arange(2, 60), 1e-5
    first = SINGLE_CHAIN * (1.0 - (bead - 1) / 125.0) ** 2.5

    def fitted(amplitude):
        both = np.stack([amplitude, 1e-6 + 0.0 * bead], axis=1)
        shared = Sharing(0, bead, np.zeros((58, 2)), both, 0.5, amplitude_error=np.full((58, 2), error))
        return fit_decay(shared, problem(2, 0.002))

    exact, moved = fitted(first), [fitted(first + error * row) for row in np.eye(58)]
    for name in ("n_star", "v0"):
        most = sum(abs(getattr(fit, name) - getattr(exact, name)) for fit in moved)
        assert getattr(exact, f"{name}_error") == pytest.approx(most, rel=1e-3), name


def of_one_chain(amplitude, last=101) -> Sharing:
    bead = np.arange(2, last + 1)
    return Sharing(0, bead, np.zeros((len(bead), 1)), amplitude(bead)[:, np.newaxis], 0.5)


@pytest.mark.parametrize("length", [5.0, 10.0, 14.0])
def test_an_amplitude_that_approaches_a_limit_is_that_within_its_uncertainty(length):
    shared = of_one_chain(lambda bead: 0.3 * (1.0 + 0.5 * np.exp(-bead / length)))
    final = shared.final
    assert abs(final.value - 0.3) <= final.uncertainty + 1e-12
    assert final.uncertainty < 1e-3
    unsure = replace(shared, amplitude_error=np.full(shared.amplitude.shape, 1e-4)).final
    assert unsure == Final(final.value, pytest.approx(final.uncertainty + 1e-4, rel=1e-12))


@pytest.mark.parametrize("last", [3, 6, 10, 11, 12])
def test_a_limit_is_seen_from_two_stretches_of_five_beads_on(last):
    final = of_one_chain(lambda bead: np.full(len(bead), 0.3), last).final
    assert final == (Final(0.3, 0.0) if last > 10 else None)


FALLING = {
    "line": lambda bead: 0.6 - 0.001 * bead,
    "exponential": lambda bead: 0.6 * np.exp(-bead / 1000.0),
    "power": lambda bead: 0.6 * bead ** (-1.0 / 6.0),
    "taper": lambda bead: 0.6 * 1.02**bead,
}


@pytest.mark.parametrize("name", FALLING)
def test_an_amplitude_that_goes_on_changing_has_no_limit_but_a_range(name):
    found = of_one_chain(FALLING[name])
    assert found.final is None
    span = found.span
    assert (span.first, span.last) == (52, found.bead[-1])
    assert sorted((span.least, span.largest)) == pytest.approx(sorted(FALLING[name](np.array([52.0, 101.0]))))


TIED = {"chains": 2, "coupling": {"stiffness": 0.1}}
KICK = {"chain": 1, "velocity": 1.0}

CHANGING = [
    ("energy is dissipated", {"damping": {"contact": 1e-4}}),
    ("beads, contacts or loads differ along the chain", {"disorder": {"mass": 1e-3}}),
    ("no pulse keeps its shape", {"foundation": {"stiffness": 0.1}}),
    (
        "chains of unlike beads are coupled",
        {**TIED, "kinds": {"a": {}, "b": {"mass": 2.0}}, "pattern": [["a"], ["b"]]},
    ),
    ("the chains are not coupled there", {"chains": 2, "coupling": {"stiffness": 0.1, "rows": [1, 10]}}),
    ("the chains are not coupled there", {"chains": 2, "kick": [KICK, {"chain": 2, "velocity": 0.5}]}),
    ("the chains have exchanged energy for less than half a beat", {"chains": 2, "coupling": {"stiffness": 1e-3}}),
]


@pytest.mark.parametrize(("why", "keys"), CHANGING)
def test_where_amplitudes_have_no_limit_the_reason_is_stated(why, keys):
    """Read from the frames of equal beads that lose nothing: the reason is in the scene, not in the motion."""
    plain = {"beads": 40, "kick": KICK, "duration": 60.0, "output": {"every": 0.2}}
    moved = {key: keys[key] for key in ("chains", "coupling", "kick") if key in keys}
    run = engine.run(of_keys(**{**plain, **moved}))
    found = surveyed(replace(run, problem=of_keys(**{**plain, **keys}))).shared
    assert (found.changing, found.final) == (why, None)


@pytest.mark.parametrize(
    ("keys", "exact"),
    [
        ({}, True),
        ({"coupling": {"stiffness": 0.1}, "chains": 2}, True),
        ({"contact": {"exponent": 2}}, True),
        ({"kinds": {"a": {"mass": 1}, "b": {"mass": 0.5}}, "pattern": ["a", "b"]}, False),
        ({"contact": {"yield": {"overlap": 0.1}}}, False),
        ({"damping": {"contact": 0.1}}, False),
        ({"gap": 0.5}, False),
        ({"precompression": {"force": 0.1}}, False),
    ],
)
def test_exact_waves_run_in_touching_equal_elastic_beads_without_a_load(keys, exact):
    plain = {"chains": 1, "beads": 20, "kick": {"velocity": 1.0}, "duration": 5.0}
    assert runs_exact_waves(of_keys(**{**plain, **keys}).system) == exact


def with_error(shared: Sharing, error: float, seed: int = 0) -> tuple[Sharing, Sharing]:
    """Amplitudes with a bound on their errors, and amplitudes that differ by as much."""
    signs = np.random.default_rng(seed).choice([-1.0, 1.0], shared.amplitude.shape)
    bounds = np.full(shared.amplitude.shape, error)
    moved = shared.amplitude + error * signs
    return (replace(shared, amplitude_error=bounds), replace(shared, amplitude=moved, amplitude_error=bounds))


@pytest.mark.parametrize("seed", range(5))
def test_a_beat_length_moves_within_its_uncertainty_when_amplitudes_err(seed):
    bounded, moved = with_error(beating(0.36, 30.0, 80.0, 100), 1e-3, seed)
    assert bounded.beat_length.uncertainty > 5.0 * beating(0.36, 30.0, 80.0, 100).beat_length.uncertainty
    assert abs(moved.beat_length.value - bounded.beat_length.value) <= bounded.beat_length.uncertainty


def test_errors_of_amplitudes_make_the_bead_of_agreement_as_much_less_certain_as_the_line_through_the_last_tops():
    """Amplitudes a off make the logarithm of a mismatch m ``(2 / m + 1) a`` off, over their mean."""
    exact = beating(0.36, 30.0, 80.0, 100)
    halves = itertools.pairwise(exact.beats)
    tops = [max((m, n) for n, m in zip(exact.bead, exact.mismatch, strict=True) if a <= n <= b) for a, b in halves]
    mismatch, bead = np.array(tops[-3:]).T
    errors = 1e-3 / 0.36 * (2.0 / mismatch + 1.0)
    grown = error_of_crossing(bead, np.log(mismatch), math.log(0.01), errors)
    less, more = (each.expected_agreement(0.01).uncertainty for each in (exact, with_error(exact, 1e-3)[0]))
    assert mismatch.max() > 0.2
    assert more - less == pytest.approx(grown, rel=1e-9)


@pytest.mark.slow
@settings(max_examples=50)
@given(st.integers(3, 40), st.floats(1e-6, 1e-4), st.integers(0, 10**6))
@pytest.mark.parametrize("level", [0.2, None], ids=["ahead", "in the middle"])
def test_a_crossing_of_a_fitted_line_moves_by_at_most_its_error_and_by_as_much_in_the_worst_case(
    level, count, size, seed
):
    places = np.arange(10.0, 10.0 + count)
    values = 1.0 - 0.01 * places
    level = np.mean(values) if level is None else level
    bound = error_of_crossing(places, values, level, np.full(count, size))

    def crossing(signs: np.ndarray) -> float:
        slope, intercept = np.polyfit(places, values + size * signs, 1)
        return float((level - intercept) / slope)

    exact = crossing(np.zeros(count))
    drawn = np.random.default_rng(seed).choice([-1.0, 1.0], count)
    assert abs(crossing(drawn) - exact) <= 1.1 * bound  # slopes change by 3 % at most
    each = [abs(crossing(unit) - exact) for unit in np.eye(count)]
    assert sum(each) == pytest.approx(bound, rel=0.05)


def test_mismatch_and_spread_are_off_by_no_more_than_errors_of_amplitudes_and_arrivals_make_them():
    chance, bead = np.random.default_rng(4), np.array([6, 7])
    for _ in range(100):
        arrival, amplitude = 10.0 + chance.uniform(0.0, 1.0, (2, 3)), chance.uniform(0.2, 0.8, (2, 3))
        errors = np.full((2, 3), 1e-3), np.full((2, 3), 1e-4)
        late, off = (size * chance.choice([-1.0, 1.0], size=(2, 3)) for size in errors)
        exact = Sharing(0, bead, arrival, amplitude, 0.5, *errors).at_last()
        moved = Sharing(0, bead, arrival + late, amplitude + off, 0.5).at_last()
        for estimate, other in zip(exact, moved, strict=True):
            assert abs(other.value - estimate.value) <= 1.001 * estimate.uncertainty  # to first order
    assert Sharing(0, bead, arrival[:, :1], amplitude[:, :1], 0.5).at_last() is None
    assert Sharing(0, bead[:0], arrival[:0], amplitude[:0], 0.5).at_last() is None
    assert [float(estimate.value) for estimate in by_hand().at_last()] == [by_hand().mismatch[0], by_hand().spread[0]]
