"""Fields of a scene from force traces that an independent program made: their values and intervals, and the test of
fit.
"""

import json
import os

import measured
import numpy as np
import pytest

import granchain
from lammps_inputs import library, strict_yaml
from workflow.cli import main
from workflow.plugins.fit import estimate, goodness, study
from workflow.plugins.fit.model import Model
from workflow.runs.run_directory import RunDirectory

pytestmark = pytest.mark.usefixtures("lammps_here")

FREE = ",".join(measured.TRUTH)


def fit(directory, *more, scene=None, free=FREE, **table):
    """Exit code of the command, from a scene that is off by some tenths."""
    data = measured.table(directory / "data.csv", **table)
    path = directory / "scene.yaml"
    path.write_text(strict_yaml.dump(scene or measured.scene(modulus=1.15, coupling=0.7, kick=0.9)))
    words = ["fit", str(path), "--against", str(data), "--free", free, "-o", str(directory / "out"), *more]
    return main(words)


@pytest.fixture(scope="module")
def found(tmp_path_factory, request):
    """Directory of a fit of three fields and the time offset to four traces with 2% noise."""
    request.getfixturevalue("lammps_here")
    directory = tmp_path_factory.mktemp("fit")
    assert fit(directory) == 0
    return directory / "out"


@pytest.mark.slow
def test_three_fields_and_the_time_offset_are_found_from_noisy_traces_and_run_by_lammps(found):
    report = json.loads((found / "fit.json").read_text())
    truth = {**measured.TRUTH, "time offset": measured.LATE}
    for name, value in truth.items():
        entry = report["free"][name]
        width = entry["high"] - entry["low"]
        assert abs(entry["value"] - value) < width  # four standard errors
        assert width < 0.03 * value
    for channel in report["channels"].values():
        assert channel["over_largest"] == pytest.approx(0.02, abs=0.003)
    assert report["fits"] is True
    assert report["warnings"] == []
    assert report["assumed"] == ["material.radius", "material.density", "material.poisson_ratio"]
    assert library.load(found / "fitted.yaml").coupling.stiffness == report["free"]["coupling.stiffness"]["value"]
    directory = RunDirectory(found / "lammps")
    assert directory.job.outcome == "done"
    assert report["lammps"]["error_velocity"] == directory.job.check.velocity < 1e-3
    assert 1e-6 < report["lammps"]["difference"] < 0.1  # the largest; before the pulse there is none
    assert (found / "residuals.png").is_file()


@pytest.mark.slow
@pytest.mark.timeout(240 * int(os.environ.get("GRANCHAIN_SEEDS", "3")))
def test_intervals_hold_the_truth_and_fits_are_rejected_as_often_as_stated(tmp_path):
    """$GRANCHAIN_SEEDS tables (3) that differ in their noise; binomial numbers of them, of 95% and at most 1%."""
    seeds = int(os.environ.get("GRANCHAIN_SEEDS", "3"))
    inside, fitting = np.zeros(3, dtype=int), 0
    for seed in range(seeds):
        data = measured.table(tmp_path / "data.csv", seed=seed)
        wrong = measured.scene(modulus=1.15, coupling=0.7, kick=0.9)
        result = granchain.fit(wrong, data, list(measured.TRUTH), str(tmp_path / "o"), lammps=False)
        if result.fits:
            inside += [
                result.free[name].low <= value <= result.free[name].high for name, value in measured.TRUTH.items()
            ]
            fitting += 1
    assert repr(result).startswith(f"<fit: {next(iter(measured.TRUTH))} = ")
    assert all(name in result._repr_html_() for name in measured.TRUTH)
    assert np.all(inside >= 0.95 * fitting - 2.6 * np.sqrt(0.95 * 0.05 * fitting))
    assert seeds - fitting <= goodness.LEVEL * seeds + 2.6 * np.sqrt(goodness.LEVEL * seeds)


@pytest.mark.slow
def test_fields_that_the_data_do_not_distinguish_are_named(tmp_path, monkeypatch, capsys):
    """Contacts know Young's modulus over 1 - nu**2 only."""
    monkeypatch.setattr(study, "STARTS", 2)
    free = "material.youngs_modulus,material.poisson_ratio"
    scene = measured.scene(modulus=1.05)
    assert fit(tmp_path, "--no-lammps", scene=scene, free=free, names=measured.NAMES[:2]) == 0
    said = capsys.readouterr().out
    assert "do not distinguish material.youngs_modulus and material.poisson_ratio" in said
    report = json.loads((tmp_path / "out" / "fit.json").read_text())
    assert report["free"]["material.youngs_modulus"]["low"] is None
    assert report["free"]["time offset"]["value"] == pytest.approx(measured.LATE, rel=0.01)


def one_reversed(traces):
    return traces * [1.0, -1.0]


def clipped(traces):
    return np.minimum(traces, [0.8 * traces[:, 0].max(), np.inf])


@pytest.mark.slow
@pytest.mark.parametrize(
    ("change", "wrong", "noise", "fits", "says"),
    [
        (one_reversed, {}, 0.02, False, "reverse the sign of force_contact_10_chain_1 in"),
        (clipped, {}, 0.02, False, "force_wall_right_chain_1 is clipped: "),
        (np.copy, {"kick": 1.05}, 0.0, False, "fit better, to first order: kick.velocity by -4.76%"),
        (np.copy, {}, 0.0, None, "the data show no noise"),
    ],
)
def test_a_model_that_does_not_fit_gets_no_intervals_and_the_cause_is_named(
    change, wrong, noise, fits, says, tmp_path, capsys
):
    scene, free = measured.scene(modulus=1.05, **wrong), "material.youngs_modulus"
    names = measured.NAMES[:2]
    code = fit(tmp_path, "--no-lammps", scene=scene, free=free, names=names, noise=noise, change=change)
    said = capsys.readouterr().out
    assert code == (fits is False)
    assert said.startswith("the model does not fit" if fits is False else "no test of fit")
    assert says in said
    report = json.loads((tmp_path / "out" / "fit.json").read_text())
    assert report["fits"] is fits
    assert all(entry["low"] is None and entry["high"] is None for entry in report["free"].values())
    assert (tmp_path / "out" / "fitted.yaml").read_text().startswith("# the model does not fit") == (fits is False)


def line(seed=3, wrong=0.0):
    """Two parameters of a straight line in two channels, one with half of the noise and a hole; what is wrong adds."""
    time = np.linspace(0.0, 1.0, 400)
    noise = np.random.default_rng(seed).standard_normal((400, 2)) * [0.02, 0.01] + wrong
    data = np.stack([1.0 + 2.0 * time, 2.0 * time], axis=1) + noise
    data[100:150, 1] = np.nan
    slopes = np.stack([np.stack([np.ones(400), np.zeros(400)], axis=1), np.stack([time, time], axis=1)], axis=-1)

    def residuals(p):
        return data - slopes @ p

    return residuals, lambda _: slopes, np.array([1.0, 1.0])


def test_each_channel_is_weighed_by_its_own_noise():
    residuals, slopes, size = line()
    found = estimate.estimate(residuals, slopes, np.zeros(2), size)
    assert found.parameters == pytest.approx([1.0, 2.0], abs=4.0 * float(found.error.max()))
    assert found.noise == pytest.approx([0.02, 0.01], rel=0.15)
    weights = 1.0 / found.noise
    jacobian = (slopes(None) * weights[:, np.newaxis])[np.isfinite(residuals(np.zeros(2)))]
    assert found.error == pytest.approx(np.sqrt(np.diag(np.linalg.inv(jacobian.T @ jacobian))), rel=1e-6)
    assert found.half_width == pytest.approx(1.963 * found.error, rel=1e-4)  # of 95%, of Student's t with 748 degrees


RISE = (np.arange(400.0) / 400.0)[:, np.newaxis]


def judged(seed=3, wrong=0.0):
    """Test of fit of `line`, whose first quarter is before the arrival, with the square of time as a fixed field."""
    residuals, slopes, size = line(seed, wrong)
    found = estimate.estimate(residuals, slopes, np.zeros(2), size)
    before = np.broadcast_to(RISE < 0.25, (400, 2))
    fixed = np.broadcast_to(RISE**2, (400, 2))[..., np.newaxis]
    return goodness.goodness(residuals(found.parameters), before, found.noise, slopes(None), fixed)


@pytest.mark.slow
def test_white_residuals_are_rejected_as_rarely_as_stated():
    joint = np.array([judged(seed).joint for seed in range(200)])
    assert np.sum(joint < goodness.LEVEL) <= 200 * goodness.LEVEL + 2.6 * np.sqrt(200 * goodness.LEVEL)
    assert np.mean(joint < 0.5) > 0.1  # not by never rejecting


WAVY = 0.01 * np.sin(np.arange(400) / 5.0)[:, np.newaxis]
LOUD = 0.02 * np.random.default_rng(8).standard_normal((400, 1)) * (RISE >= 0.25)


@pytest.mark.parametrize(
    ("wrong", "tests"),
    [
        (WAVY, {"autocorrelation", "runs"}),
        (LOUD * [0.0, 1.0], {"size"}),
        (0.05 * RISE**2, {"fixed"}),
    ],
    ids=["autocorrelated", "larger after the arrival", "fixed field wrong"],
)
def test_each_misfit_is_rejected_by_the_test_that_is_for_it(wrong, tests):
    found = judged(wrong=wrong)
    assert found.joint < goodness.LEVEL
    failed = np.any(found.rejected, axis=1)
    rejecting = {name for name, some in zip(goodness.TESTS, failed, strict=True) if some}
    assert rejecting | ({"fixed"} if found.wrong[0] else set()) >= tests
    if tests == {"fixed"}:  # the change that fits best is the true one
        assert abs(found.change[0] - 0.05) < 3.0 * found.change_error[0] < 0.03


def test_filtered_noise_is_rejected_and_fewer_rows_of_it_are_not():
    noise = np.random.default_rng(2).standard_normal((1600, 1))
    filtered = 0.5 * noise[:-1] + 0.5 * noise[1:]
    for rows, rejected in ((filtered, True), (filtered[::2], False)):
        nothing = np.zeros((len(rows), 1, 0))
        found = goodness.goodness(rows, np.arange(len(rows))[:, np.newaxis] < 400, np.ones(1), nothing, nothing)
        assert (found.joint < goodness.LEVEL) == rejected


@pytest.mark.parametrize(
    ("values", "found"),
    [
        ([0.0, 1.0, 3.0, 3.0, 3.0, 1.0], (3.0, 3)),
        ([0.0, -3.0, -3.0, -3.0, -3.0, 1.0], (-3.0, 4)),
        ([0.0, 1.0, 3.0, 3.0, np.nan, 3.0], (None, 0)),
        ([0.0, 0.0, 0.0, 0.0, 3.0, 1.0], (None, 0)),  # at rest
    ],
)
def test_consecutive_samples_at_an_extreme_value_that_the_model_exceeds_are_clipped(values, found):
    level, count = goodness.clipped(np.array(values), 1.2 * np.array(values))
    assert (None if np.isnan(level) else level, count) == found
    assert goodness.clipped(np.array(values), 0.9 * np.array(values))[1] == 0  # equal since digits are few


def test_a_step_of_the_values_is_their_resolution():
    noise = np.random.default_rng(1).standard_normal(300)
    assert goodness.resolution(np.round(noise / 0.125) * 0.125) == 0.125
    assert goodness.resolution(noise) == 0.0


def test_what_the_data_do_not_depend_on_is_named():
    residuals, slopes, size = line()
    more = np.concatenate([slopes(None), np.zeros((400, 2, 1))], axis=-1)
    found = estimate.estimate(lambda p: residuals(p[:2]), lambda _: more, np.zeros(3), size)
    assert found.weak == (((2,), True),)
    assert np.isinf(found.half_width[2])
    assert np.all(np.isfinite(found.half_width[:2]))


@pytest.mark.parametrize(
    ("smallest", "weak"),
    [(0.12, ()), (1.1e-3, (((0, 1), False),)), (9e-4, (((0, 1), True),))],
)
def test_two_parameters_whose_slopes_are_alike_are_said_to_be(smallest, weak):
    """Columns of length 1 with the product r have the singular values sqrt(1 + r) and sqrt(1 - r)."""
    r = 1.0 - smallest**2
    slopes = np.array([[1.0, r], [0.0, np.sqrt(1.0 - r * r)], [0.0, 0.0]])[:, np.newaxis]
    data = np.array([[1.0], [0.5], [1e-6]])
    found = estimate.estimate(lambda p: data - slopes @ p, lambda _: slopes, np.zeros(2), np.ones(1))
    assert found.weak == weak
    told_apart = smallest > 1e-3
    assert np.isfinite(found.half_width).all() == told_apart
    if told_apart:
        assert found.correlation[0, 1] == pytest.approx(-r, abs=1e-9)


@pytest.mark.slow
def test_derivatives_along_the_flow_are_those_of_differences_and_fit_the_same(found, tmp_path):
    data = measured.table(tmp_path / "data.csv")
    scene = measured.scene(modulus=1.15, coupling=0.7, kick=0.9)
    flow, differences = (Model(scene, "scene", list(measured.TRUTH), data, None, gradient=way) for way in (True, False))
    parameters = np.array([0.0, 0.0, 0.0, measured.LATE / flow.unit_time])
    columns, expected = (np.nan_to_num(model.slopes(parameters)) for model in (flow, differences))
    # contacts that open make differences of logarithms by 1e-4 wrong by some 1e-5
    assert np.max(np.abs(columns - expected)) < 1e-4 * np.max(np.abs(expected))
    assert fit(tmp_path, "--no-lammps", "--gradient") == 0
    before, after = (json.loads((path / "fit.json").read_text())["free"] for path in (found, tmp_path / "out"))
    for name in before:
        width = before[name]["high"] - before[name]["low"]
        assert abs(after[name]["value"] - before[name]["value"]) < 1e-3 * width
