"""Shifts in time, and forces of links, measured on motions of which they are known."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from small_problems import problem
from synthetic_waves import of_keys

from analysis.compare.identify import identify, least_squares, time_shift
from lammps_inputs.chains import coupled_chains
from workflow.engines.reference import engine

# --- shifts -----------------------------------------------------------------------------------------------------------


@pytest.mark.slow
@given(st.floats(1e-9, 0.05), st.sampled_from([-1.0, 1.0]), st.floats(0.1, 3.0))
def test_a_shift_is_found_with_its_sign(shift, sign, frequency):
    t = np.linspace(0.0, 40.0, 2001)[:, np.newaxis, np.newaxis]
    ahead = np.sin(frequency * (t + sign * shift))
    found = time_shift(ahead - np.sin(frequency * t), frequency * np.cos(frequency * t))
    # sin(a (t + s)) - sin(a t) = sin(a s) cos(a t) - (1 - cos(a s)) sin(a t); over 40 the last is at right angles to
    # the rate but for |sin(80 a)| / (4 a) of a sum of squares above 13
    assert found.time == pytest.approx(sign * shift, rel=(frequency * shift) ** 2 / 6.0 + shift / 13.0 + 1e-6)
    assert found.explained > 1.0 - (frequency * shift) ** 2 - 1e-9


def test_a_difference_at_right_angles_to_the_rate_is_no_shift():
    t = np.arange(1000) * 2.0 * np.pi / 1000.0
    assert time_shift(np.sin(t), np.cos(t)).explained < 1e-20


@pytest.mark.parametrize(("difference", "rate"), [(0.0, 1.0), (1.0, 0.0), (0.0, 0.0)])
def test_nothing_is_no_shift(difference, rate):
    assert time_shift(np.full(9, difference), np.full(9, rate)).explained == 0.0


# --- columns ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(5))
def test_an_error_of_the_residual_changes_a_factor_by_its_bound_at_most(seed):
    draw = np.random.default_rng(seed)
    columns, error = draw.normal(size=(3, 50, 2, 4)), draw.normal(size=(50, 2, 4))
    factors = np.array([0.3, -2.0, 1.0])
    fit = least_squares(np.tensordot(factors, columns, 1) + 0.1 * error, list(columns))
    assert np.all(np.abs(fit.change - factors) <= fit.bound * 0.1 * np.linalg.norm(error))
    assert fit.left <= 0.1 * np.linalg.norm(error)


def test_columns_that_are_alike_have_no_bound_and_others_have():
    first, second, residual = np.random.default_rng(1).normal(size=(3, 60))
    fit = least_squares(residual, [first, second, 2.0 * first, 0.0 * first])
    assert np.isfinite(fit.bound).tolist() == [False, True, False, False]


# --- springs ----------------------------------------------------------------------------------------------------------


def felt(kappa, actual=0.1, **changes):
    """What is identified in a run with one coupling of a problem that has another."""
    claimed = problem(kappa=actual, **changes)
    links = coupled_chains(claimed.chains, kappa)
    return identify(
        replace(engine.run(replace(claimed, system=replace(claimed.system, links=links))), problem=claimed),
        engine.run(claimed),
    )


@pytest.mark.parametrize(
    ("kappa", "claimed", "chains"),
    [(0.01, 0.09, 2), (0.1, 0.09, 3), (0.5, 0.09, 5), (3.0, 0.09, 2), (0.0, 0.1, 2), (0.02, 0.0, 2)],
)
def test_the_coupling_is_found_also_where_there_is_none_or_the_scene_has_none(kappa, claimed, chains):
    (departure,) = felt(kappa, claimed, chains=chains, beads=20, frames=200).departures
    factor = kappa / (claimed or 1.0)
    assert (departure.name, departure.scene == 0.0) == ("coupling", claimed == 0.0)
    assert departure.factor == pytest.approx(factor, rel=2e-3, abs=1e-3 if kappa == 0.0 else 0.0)
    assert abs(departure.factor - factor) <= departure.uncertainty


def test_springs_of_a_cubic_force_are_found_cubic():
    keys = {"chains": 2, "beads": 2, "gap": 100.0, "kick": {"velocity": 1.0}, "duration": 10.0}
    linear, cubic = (of_keys(**keys, coupling={name: size}) for name, size in (("stiffness", 0.1), ("cubic", 0.03)))
    (departure,) = identify(replace(engine.run(cubic), problem=linear), engine.run(linear)).departures
    assert (departure.name, departure.quantity) == ("coupling", "exponent")
    assert abs(departure.factor - 2.0) <= departure.uncertainty < 0.3
