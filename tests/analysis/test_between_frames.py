"""What is said of the time between frames, against the same run with frames ten times as dense."""

import itertools
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from errors_between_frames import thinned
from synthetic_waves import of_keys, surveyed

from analysis.between_frames import interpolated
from analysis.gauges.gauge import gauges
from analysis.trajectory import Trajectory
from workflow.engines.reference import engine
from workflow.measures.forces.force_meter import ForceMeter
from workflow.measures.forces.readings import Readings

DENSE = 0.05
"""Time between dense frames; coarse ones are the tenth or twentieth of them."""

SCENES = {
    "coupled": {"chains": 2, "beads": 30, "coupling": {"stiffness": 0.3}, "duration": 50.0},
    "towards bead 1": {"chains": 2, "beads": 20, "coupling": {"stiffness": 0.1}, "duration": 30.0},
    "stiff springs": {"chains": 2, "beads": 20, "coupling": {"stiffness": 5.0}, "duration": 30.0},
    "dimers": {"beads": 24, "kinds": {"a": {}, "b": {"mass": 0.3}}, "pattern": ["a", "b"], "duration": 30.0},
    "resonators": {"beads": 20, "resonators": {"mass": 0.1, "stiffness": 1.0}, "duration": 30.0},
    "damped": {"beads": 20, "damping": {"contact": 0.1}, "duration": 30.0},
    "viscoelastic": {"chains": 2, "beads": 20, "coupling": {"stiffness": 0.1}, "duration": 30.0}
    | {"damping": {"contact": 0.1, "law": "viscoelastic", "beads": 0.01, "coupling": 0.02}},
    "loaded": {"beads": 20, "precompression": {"force": 0.3}, "walls": {"right": "bead"}, "duration": 20.0},
    "loaded a little": {"beads": 30, "precompression": {"force": 0.1}, "walls": {"right": "bead"}, "duration": 28.0},
    "light beads under a large load": {"beads": 10, "contact": {"exponent": 3}, "duration": 10.0}
    | {"kinds": {"light": {"mass": 0.3}}, "pattern": ["light"], "precompression": {"force": 15.0}}
    | {"walls": {"left": "bead", "right": "bead"}},
    "column": {"beads": 6, "contact": {"exponent": 2}, "gravity": 0.1, "damping": {"contact": 0.05}, "duration": 10.0}
    | {"walls": {"left": "bead", "right": "bead"}},
    "between walls": {"beads": 8, "gap": 0.5, "walls": {"left": "flat", "right": "rigid"}, "duration": 40.0},
    "driven": {"beads": 8, "precompression": {"force": 1.0}, "duration": 30.0}
    | {"drive": {"bead": 1, "displacement": 0.1, "frequency": 0.2}},
    "quadratic": {"beads": 20, "contact": {"exponent": 2}, "duration": 25.0},
    "pushed": {"beads": 20, "push": {"peak": 0.7, "duration": 3.0, "shape": "half-sine"}, "duration": 30.0},
    "gaps": {"beads": 12, "gap": 0.3, "duration": 40.0},
    "yielding": {"chains": 2, "beads": 16, "coupling": {"stiffness": 0.1}, "contact": {"yield": {"overlap": 0.2}}}
    | {"duration": 25.0},
}

ROUNDING = 1e-8
"""Error of the reference's energies, and of differences over a thousandth of the time between frames."""


@cache
def dense(name: str) -> Trajectory:
    """A scene's dense frames."""
    keys = dict(SCENES[name])
    if not {"push", "drive"} & set(keys):
        keys["kick"] = {"velocity": -1.0, "bead": 20} if name == "towards bead 1" else {"velocity": 1.0}
    run = engine.run(of_keys(**keys, output={"every": DENSE}))
    return run[: (run.frames - 1) // 20 * 20 + 1]


CLOSER = ["coupled", "dimers", "column", "light beads under a large load"]
"""Scenes that are also read in frames half as far apart as a usual run's."""

LED = [name for name in SCENES if name not in ("light beads under a large load", "column", "between walls", "driven")]
"""Scenes in which a pulse leads and is followed."""


@pytest.mark.slow
@pytest.mark.parametrize("name", LED)
def test_energies_of_chains_waves_and_pulses_and_momenta_of_pulses_are_as_uncertain_as_stated(name):
    fine, coarse = surveyed(dense(name)), surveyed(thinned(dense(name), 10))
    beads = [found.shared.bead[found.energies.place] for found in (fine, coarse)]
    _, here, there = np.intersect1d(*beads, return_indices=True)
    stated = 0
    for quantity in ("chain", "wave"):
        true, value = (getattr(found.energies, quantity)[place] for found, place in ((fine, here), (coarse, there)))
        error = getattr(coarse.energies, f"{quantity}_error")[there]
        known = np.isfinite(value) & np.isfinite(true)
        assert np.array_equal(np.isfinite(error), np.isfinite(value))
        assert np.all(np.abs(value - true)[known] <= error[known] + ROUNDING)
        stated += int(known.sum())
    assert stated > 0
    for found, place in zip(coarse.characters, coarse.pulses, strict=True):
        true = [
            one
            for one, other in zip(fine.characters, fine.pulses, strict=True)
            if (other.chain, other.direction, one.bead) == (place.chain, place.direction, found.bead)
            and abs(one.arrival - found.arrival) < 0.5
        ]
        for one, quantity in itertools.product(true, ("energy", "momentum")):
            off, bound = abs(getattr(found, quantity) - getattr(one, quantity)), getattr(found, f"{quantity}_error")
            assert np.isnan(off) or off <= bound + ROUNDING


# --- forces -----------------------------------------------------------------------------------------------------------

STATED = ("largest", "at", "impulse", "dwell")


def read(run: Trajectory) -> Readings:
    """Forces at walls, in the first, the middle and the last contact; and where all beads are recorded inside one."""
    beads = run.problem.beads
    middle = (beads // 2,)
    inside = middle if run.problem.rows.neighbours else ()
    places = gauges(run.problem.system, wall=True, contacts=(1, *middle, beads - 1), sensors=inside)
    return ForceMeter(run.problem, places).read((run[:7], run[7:]))


@cache
def forces(name: str) -> Readings:
    """Forces in a scene's dense frames."""
    return read(dense(name))


def of_few_beads(run: Trajectory) -> Trajectory:
    """A run of which the beads at both ends and in the middle are recorded alone."""
    beads = run.problem.beads
    recorded = tuple(sorted({1, 2, beads // 2, beads // 2 + 1, beads - 1, beads}))
    places = np.array(recorded) - 1
    problem = replace(run.problem, rows=run.problem.rows.only(recorded))
    return Trajectory(problem, run.time, run.displacement[..., places], run.velocity[..., places])


def checked(fine: Readings, coarse: Readings) -> int:
    """See that forces differ from those of denser frames by no more than both state; how many are stated."""
    stated = 0
    for name in STATED:
        value, error = getattr(coarse, name), getattr(coarse, f"{name}_error")
        gauges_of_both = slice(value.shape[1])  # the sensors are last
        true, more = (values[:, gauges_of_both] for values in (getattr(fine, name), getattr(fine, f"{name}_error")))
        both = np.isfinite(value) & np.isfinite(true)
        if name == "dwell":
            both &= coarse.ended & fine.ended[:, gauges_of_both]
        assert np.array_equal(np.isfinite(error), np.isfinite(value)), name
        assert np.all(np.abs(value - true)[both] <= (error + more)[both] + ROUNDING), name
        stated += int(both.sum())
    return stated


@pytest.mark.slow
@pytest.mark.parametrize(("name", "stride"), [*((name, 10) for name in SCENES), *((name, 2) for name in CLOSER)])
def test_forces_are_as_uncertain_as_stated(name, stride):
    coarse = read(thinned(dense(name), stride))
    assert checked(forces(name), coarse) > 0 or (name == "light beads under a large load" and stride > 4)
    assert np.all(coarse.largest[np.isfinite(coarse.largest)] >= coarse.force.max(axis=0)[np.isfinite(coarse.largest)])


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in SCENES if name != "yielding"])
def test_forces_between_few_recorded_beads_are_as_uncertain_as_stated(name):
    checked(forces(name), read(thinned(of_few_beads(dense(name)), 10)))


@pytest.mark.slow
def test_frames_too_far_apart_for_the_forces_between_them_state_none():
    """The fastest motion has a phase of 8 from one frame to the next."""
    run = dense("light beads under a large load")
    found = read(thinned(run, 10))
    for name in STATED:
        assert np.isnan(getattr(found, name)).all()
        assert np.isnan(getattr(found, f"{name}_error")).all()
    assert np.isfinite(found.force).all()


# --- polynomials ------------------------------------------------------------------------------------------------------


def test_an_energy_that_is_a_polynomial_of_degree_three_is_certain():
    curve = np.polynomial.Polynomial([0.5, -0.2, 0.3, 0.1])
    known = np.array(
        [[curve.deriv(order)(time) if order else curve(time) for order in range(3)] for time in (0.0, 0.7)]
    )
    found = interpolated(known[..., np.newaxis], np.array([0.3]), 0.7)
    assert found.value[0] == pytest.approx(curve(0.21), abs=1e-15)
    assert found.rate[0] == pytest.approx(curve.deriv()(0.21), abs=1e-14)
    assert found.uncertainty[0] < 1e-14


def test_an_energy_that_jumps_between_frames_is_uncertain_by_the_jump():
    known = np.array([[0.5, 0.0, 0.0], [0.4, 0.0, 0.0]])
    found = interpolated(known[..., np.newaxis], np.array([0.5]), 0.7)
    assert 0.1 <= found.uncertainty[0] < 0.3
