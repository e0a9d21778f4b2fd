"""Chains closed to rings: what their symmetry, exact modes and conservation laws say, in both engines."""

import math

import numpy as np
import pytest
from plain_scene import goes_on_bit_for_bit

from analysis.conservation import ConservationMeter
from lammps_inputs import library
from workflow.engines.reference import engine
from workflow.engines.reference.step_halving import StepHalving
from workflow.runs.run import run
from workflow.verdicts.analysis_files import analyse

BONDED = {"force": "k*s", "k": 0.7, "tension": "allowed"}


def ring(**changes):
    """A ring of 12 beads, bead 1 of which is kicked, with other keys, and without those of None."""
    plain = {
        "name": "ring",
        "beads": 12,
        "periodic": True,
        "kick": {"velocity": 1.0},
        "duration": 30.0,
        "timestep": 0.01,
        "output": {"every": 0.5},
    }
    return library.from_plain({key: value for key, value in {**plain, **changes}.items() if value is not None}, "test")


def velocity(scene):
    return engine.run(scene.problem()).velocity


@pytest.mark.slow
@pytest.mark.usefixtures("lammps_here")
def test_the_first_passage_is_that_of_an_open_chain(tmp_path):
    """At the beads before it meets the small pulse that the rebounding first bead has sent the other way."""
    closed, opened = (
        analyse(run(ring(periodic=key, beads=30, duration=40.0), tmp_path / str(key)).directory, figures=False)
        for key in (True, None)
    )
    one, other = closed.waves, opened.waves
    assert one.bead.tolist() == list(range(2, 31))
    assert np.all(one.peak_velocity > 0.6)
    assert np.all(np.diff(one.arrival) > 0.0)
    for name in ("arrival", "peak_velocity", "speed"):
        values, expected = getattr(one, name)[1:20], getattr(other, name)[2:21]
        np.testing.assert_allclose(values, expected, rtol=0.0, atol=1e-9)
    [far_end] = [each for each in closed.measurements.values() if each.key == "far_end"]
    assert all(value is None for value in far_end.plain().values())
    assert closed.conservation.momentum_drift < 1e-13


TURNED = {
    "plain": ({}, {}),
    "gaps": ({"gap": [0.1 * k for k in range(12)]}, {"gap": [0.1 * (k % 12) for k in range(9, 21)]}),
    "strengths": (
        {"contact": {"strength": [1.0 + 0.1 * k for k in range(12)]}},
        {"contact": {"strength": [1.0 + 0.1 * (k % 12) for k in range(9, 21)]}},
    ),
    "beads and dashpots": (
        {"damping": {"contact": 0.9, "law": "restitution"}, "kinds": {"a": {"mass": 3.0, "radius": 1.4}, "b": {}}}
        | {"pattern": ["a", *"bbbbbb", "a", *"bbbb"]},
        {"damping": {"contact": 0.9, "law": "restitution"}, "kinds": {"a": {"mass": 3.0, "radius": 1.4}, "b": {}}}
        | {"pattern": [*"bbb", "a", *"bbbbbb", "a", "b"]},
    ),
    "contacts that yield": ({"contact": {"yield": {"overlap": 0.1}}},) * 2,
}


@pytest.mark.slow
@pytest.mark.parametrize(("keys", "turned"), TURNED.values(), ids=TURNED)
def test_a_ring_whose_beads_are_numbered_from_another_one_moves_alike(keys, turned):
    here = velocity(ring(kick={"bead": 2, "velocity": 1.0}, **keys))
    there = velocity(ring(kick={"bead": 5, "velocity": 1.0}, **turned))
    np.testing.assert_allclose(np.roll(there, -3, axis=-1), here, rtol=0.0, atol=1e-11)


@pytest.mark.slow
@pytest.mark.usefixtures("lammps_here")
def test_a_ring_with_two_equal_halves_moves_as_one_of_half_the_length(tmp_path):
    kinds = {"kinds": {"a": {"mass": 2.0}, "b": {}}, "pattern": ["a", "b", "b"]}
    short = ring(beads=6, **kinds)
    long = ring(beads=12, kick=[{"bead": 1, "velocity": 1.0}, {"bead": 7, "velocity": 1.0}], **kinds)
    for compute in (velocity, lambda scene: run(scene, tmp_path / str(scene.beads)).trajectory.velocity):
        half, whole = compute(short), compute(long)
        np.testing.assert_allclose(whole, np.concatenate([half, half], axis=-1), rtol=0.0, atol=1e-10)


@pytest.mark.slow
@pytest.mark.usefixtures("lammps_here")
@pytest.mark.parametrize("wavenumber", [1, 3])
def test_a_mode_of_a_bonded_ring_oscillates_at_its_frequency(wavenumber, tmp_path):
    beads = 8
    start = [0.2 * math.cos(2.0 * math.pi * wavenumber * n / beads) for n in range(beads)]
    rows = [{"bead": n + 1, "displacement": x} for n, x in enumerate(start) if abs(x) > 1e-12]
    case = ring(beads=beads, contact=BONDED, initial=rows, kick=None)
    problem = case.problem()
    omega = 2.0 * math.sin(math.pi * wavenumber / beads)
    halving = StepHalving(problem)
    stated = halving.run().velocity
    x0 = np.array(start) / problem.scale.length
    time = np.arange(problem.frames + 1) * problem.every
    exact = -omega * np.sin(omega * time)[:, np.newaxis] * x0
    assert np.max(np.abs(velocity(case)[:, 0] - exact)) < max(stated, 1e-12)
    errors = []
    for step in (0.1, 0.05):
        rough = case.model_copy(update={"timestep": step})
        errors.append(np.abs(run(rough, tmp_path / str(step), check=False).trajectory.velocity[:, 0] - exact).max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.05)


@pytest.mark.usefixtures("lammps_here")
def test_a_ring_drifts_several_times_round_its_box(tmp_path):
    """Its momentum is conserved to rounding, and each displacement counts from the bead's place at the start."""
    done = run(ring(beads=3, duration=150.0, timestep=0.005), tmp_path / "run")
    length = 3 * done.trajectory.problem.layout.diameter
    mean = done.trajectory.displacement.mean(axis=(1, 2))
    np.testing.assert_allclose(mean, done.trajectory.time / 3.0, rtol=1e-12, atol=1e-12)
    assert mean[-1] > 3.0 * length
    assert ConservationMeter(done.trajectory.problem).read([done.trajectory]).momentum_drift < 1e-12
    assert done.check.velocity < 1e-3


@pytest.mark.slow
def test_the_force_in_the_closing_contact_is_that_of_any_other(tmp_path):
    """A pulse from bead 3 passes contact 12 as one from bead 1 passes contact 10."""
    forces = []
    for kicked, contact in ((3, 12), (1, 10)):
        output = {"every": 0.5, "forces": {"contacts": [contact], "sensors": [contact % 12 + 1]}}
        done = run(
            ring(kick={"bead": kicked, "velocity": 1.0}, duration=18.0, output=output),
            tmp_path / str(kicked),
            engine="reference",
        )
        forces.append(analyse(done.directory, figures=False).measurements["forces"].plain())
    for here, there in zip(*forces, strict=True):
        for key in ("largest", "at", "impulse", "dwell"):
            assert here[key] == pytest.approx(there[key], abs=1e-7)


@pytest.mark.slow
@pytest.mark.usefixtures("lammps_here")
def test_a_ring_that_was_interrupted_far_from_its_box_goes_on_bit_for_bit(tmp_path):
    goes_on_bit_for_bit(ring(beads=3, duration=150.0), tmp_path, after=2000)
