"""What a page of a run holds, without a browser: hand-made frames, in the scene's units."""

from types import SimpleNamespace

import numpy as np
import pytest
from stock_lammps import scene

from analysis import motion
from analysis.tracking.leading_waves import with_speeds
from analysis.trajectory import Trajectory
from lammps_inputs import Kick, Material
from workflow.view import run_page
from workflow.view.thin import thinned

STEEL = Material(radius=4.76e-3, density=8000.0, youngs_modulus=193e9, poisson_ratio=0.3)


@pytest.fixture(scope="module", params=[None, STEEL], ids=["reduced", "SI"])
def held(request):
    """A problem of three chains, a run in which each number is another, and what a page holds of chains 1 and 3."""
    kick = (Kick(velocity=0.5),)
    material = request.param
    unit = scene(chains=3, beads=6, kick=kick, material=material).scale
    what = scene(chains=3, beads=6, kick=kick, material=material, kappa=0.1 * unit.stiffness, duration=4.0 * unit.time)
    problem = what.problem()
    shape = (problem.frames + 1, 3, 6)
    displacement = 0.1 * np.cos(np.arange(np.prod(shape))).reshape(shape)
    time = np.arange(problem.frames + 1) * problem.every
    run = Trajectory(problem, time, displacement, 1.0 + np.arange(np.prod(shape)).reshape(shape))
    return problem, run, thinned(problem, [run[:7], run[7:]], [0, 2])


def test_every_number_is_the_runs_in_the_scenes_units(held):
    problem, run, part = held
    scale, overlap = problem.scale, motion.overlaps(problem, run.displacement)
    assert part.chains == [1, 3]
    np.testing.assert_allclose(part.time, run.time * scale.time)
    for place, chain in enumerate((0, 2)):
        np.testing.assert_allclose(part.displacement[place], run.displacement[:, chain] * scale.length)
        np.testing.assert_allclose(part.velocity[place], run.velocity[:, chain] * scale.velocity)
        np.testing.assert_allclose(part.overlap[place][:, :-1], overlap[:, chain] * scale.length)
        force = np.maximum(overlap[:, chain], 0.0) ** 1.5
        np.testing.assert_allclose(part.force[place][:, :-1], force * scale.force, atol=1e-12 * scale.force)
        own = motion.bead_energy(problem, run.displacement, run.velocity)[:, chain].sum(axis=-1)
        np.testing.assert_allclose(part.energy[place], own * scale.energy)


def test_the_middle_of_a_pixel_is_its_bead_and_time(held):
    _, _, part = held
    data = run_page._image_source(part, 1).data
    rows, columns = data["velocity"][0].shape
    middle = (data["x"][0] + 0.5 * data["dw"][0] / columns, data["y"][0] + 0.5 * data["dh"][0] / rows)
    assert middle == pytest.approx((1.0, 0.0), abs=1e-12 * float(part.time[-1]))
    assert data["dw"][0] / columns == 1.0
    assert data["dh"][0] / rows == pytest.approx(float(part.time[1]))


def test_the_arrival_after_that_in_the_first_chain_is_positive_where_a_chain_is_later(held):
    problem, _, part = held
    chain, bead = np.repeat([1, 3], 3), np.tile([2, 3, 4], 2)
    waves = with_speeds(chain, bead, 1.2 * bead + 0.3 * (chain == 3), 0.1 * chain + 0.01 * bead)
    symbol = {"time": "", "velocity": ""}
    peaks, lags = run_page._distances(problem, part, SimpleNamespace(waves=waves), (0, 6), symbol)
    scale = problem.scale
    for plot, expected in (
        (peaks, {"chain 1": 0.1 + 0.01 * bead[:3], "chain 3": 0.3 + 0.01 * bead[:3]}),
        (lags, {"chain 1": np.zeros(3), "chain 3": np.full(3, 0.3)}),
    ):
        lines = dict(zip((item.label.value for item in plot.legend[0].items), plot.renderers, strict=True))
        for name, values in expected.items():
            glyph, data = lines[name].glyph, lines[name].data_source.data
            assert list(data[glyph.x]) == [2, 3, 4]
            worth = scale.velocity if plot is peaks else scale.time
            np.testing.assert_allclose(data[glyph.y], values * worth, atol=1e-12)


def test_springs_are_drawn_between_chains_that_are_tied(held):
    problem, _, part = held
    images = [run_page._image_source(part, place) for place in range(2)]
    both = thinned(problem, [Trajectory(problem, *(np.zeros(s) for s in ((1,), (1, 3, 6), (1, 3, 6))))], [1, 2])
    for kept, springs in ((part, []), (both, [[0, 1]])):  # chains 1 and 3 are tied to chain 2 only
        plot, _ = run_page._moving(problem, kept, images, run_page.Span(), run_page.LinearColorMapper(palette=["#000"]))
        (move,) = (code for codes in plot.js_property_callbacks.values() for code in codes if "springs" in code.args)
        assert move.args["springs"] == springs
