"""Gains and baselines of sensors in a fit: what is found of them, and which combinations no data determine."""

import json

import measured
import numpy as np
import pytest

import granchain
from analysis.files.traces import Calibration, Channel, Traces
from lammps_inputs import strict_yaml
from workflow.cli import main
from workflow.plugins.fit.estimate import estimate
from workflow.plugins.fit.sensors import Sensors

TIME = np.linspace(0.0, 6.0, 300)
CHANNELS = (Channel("wall", 1, right=True), Channel("contact", 1, 3), Channel("contact", 1, 4))
BOTH, GAIN, BASELINE = Calibration(None, None, "V"), Calibration(None, 0.2, "V"), Calibration(4.0, None, "V")
WORTH = np.array([30.0, 30.0, 30.0])
GAINS, BASELINES = np.array([-20.0, 2e5, 4.0]), np.array([9.0, 0.2, -0.3])


def pulses(rate):
    """Three pulses in N, [row, channel]; the rate moves and narrows them."""
    return 25.0 * np.exp(-((rate * TIME[:, np.newaxis] - [1.5, 2.0, 3.0]) ** 2) * 8.0)


def sensors(signals):
    table = Traces(TIME, CHANNELS, signals, True, {0: BOTH, 1: GAIN, 2: BASELINE})
    return Sensors.of(table, WORTH)


def test_gains_and_baselines_are_those_of_signals_without_noise_and_slopes_their_differences():
    signals = BASELINES + pulses(1.0) / GAINS
    kinds = sensors(signals)
    best = kinds.best(pulses(1.0), signals)
    assert kinds.free == ((0, "gain"), (0, "baseline"), (1, "gain"), (2, "baseline"))
    assert kinds.reported(best) == pytest.approx([-20.0, 9.0, 2e5, -0.3], rel=1e-10)
    np.testing.assert_allclose(kinds.values(signals, best), pulses(1.0), atol=1e-9)
    p = kinds.best(pulses(1.1), signals)
    differences = [kinds.signals(pulses(1.1), p + h) - kinds.signals(pulses(1.1), p - h) for h in 0.5 * np.eye(4)]
    np.testing.assert_allclose(kinds.slopes(pulses(1.1)), np.stack(differences, axis=-1), atol=1e-9)


@pytest.mark.slow
def test_intervals_of_gains_and_baselines_contain_the_truth_as_often_as_stated():
    """Numbers of 50 fits within 2.6 standard deviations of 95%, the rate of the pulses free, too."""
    count, inside = 50, np.zeros(5)
    exact = BASELINES + pulses(1.0) / GAINS
    size = np.abs(exact - [9.0, 0.2, -0.3]).max(axis=0)
    for seed in range(count):
        signals = exact + 0.05 * size * np.random.default_rng(seed).standard_normal(exact.shape)
        kinds = sensors(signals)

        def model(p, kinds=kinds):
            return kinds.signals(pulses(np.exp(p[0])), p[1:])

        def slopes(p, model=model, kinds=kinds):
            h = 1e-5 * np.eye(5)[0]
            of_rate = (model(p + h) - model(p - h)) / 2e-5
            return np.concatenate([of_rate[..., np.newaxis], kinds.slopes(pulses(np.exp(p[0])))], axis=-1)

        start = np.append(0.05, kinds.best(pulses(np.exp(0.05)), signals))
        found = estimate(lambda p, s=signals, model=model: s - model(p), slopes, start, kinds.size)
        truth = np.append(0.0, kinds.best(pulses(1.0), exact))
        inside += np.abs(found.parameters - truth) <= found.half_width
    assert np.all(inside >= 0.95 * count - 2.6 * np.sqrt(0.95 * 0.05 * count))
    assert np.any(inside < count)  # not by intervals that are too wide


@pytest.mark.parametrize(
    ("directions", "weak"),
    [
        ([[1.0, 1.0, 0.05, 0.0]], (((0, 1, 2), 1),)),
        ([[1.0, 1.0, 1.0, 0.0], [0.0, 1.0, -1.0, 0.0]], (((0, 1, 2), 2),)),
    ],
    ids=["a small share", "two of three"],
)
def test_whatever_changes_along_a_direction_that_the_data_do_not_show_is_undetermined(directions, weak):
    """Derivatives are orthogonal to the directions but for the errors of differences, 1e-5."""
    chance = np.random.default_rng(5)
    null = np.linalg.qr(np.array(directions).T)[0]
    jacobian = chance.standard_normal((60, 4))
    jacobian -= jacobian @ null @ null.T
    jacobian += 1e-5 * chance.standard_normal(jacobian.shape) / np.sqrt(60)
    slopes = jacobian[:, np.newaxis]
    data = chance.standard_normal((60, 1))
    found = estimate(lambda p: data - slopes @ p, lambda _: slopes, np.zeros(4), np.ones(1))
    assert tuple(entry for entry in found.weak if entry[1]) == weak
    undetermined = {k for group, _ in weak for k in group}
    assert {k for k in range(4) if np.isinf(found.half_width[k])} == undetermined


# --- a chain ----------------------------------------------------------------------------------------------------------

VOLTS = {"CH1": (25.0, 8.0), "CH2": (-40.0, 2.0)}
"""Gain in N/V and baseline in V of two channels."""

COLUMNS = "time=TIME,force_wall_right (V)=CH1,force_contact_10 (V)=CH2"


def scope(directory):
    """A scope's file of the right wall and contact 10, made of the forces of `measured`."""
    table = measured.table(directory / "newton.csv", names=measured.NAMES[:2])
    time, *forces = np.loadtxt(table, delimiter=",", skiprows=1, unpack=True)
    signals = [force / gain + baseline for force, (gain, baseline) in zip(forces, VOLTS.values(), strict=True)]
    rows = "".join(f"{1e6 * t:.1f},{a:.6f},{b:.6f}\r\n" for t, a, b in zip(time, *signals, strict=True))
    path = directory / "scope.csv"
    path.write_bytes(f"Model,S-4\r\nSamples,{len(time)}\r\n\r\nTIME,CH1,CH2\r\nus,V,V\r\n{rows}".encode())
    return path


@pytest.mark.slow
def test_a_modulus_and_the_gains_and_baselines_of_two_sensors_are_found_from_a_scopes_file(tmp_path):
    scene = tmp_path / "scene.yaml"
    scene.write_text(strict_yaml.dump(measured.scene(modulus=1.1)))
    words = ["fit", str(scene), "--against", str(scope(tmp_path)), "--columns", COLUMNS, "--no-lammps"]
    words += ["--gain", "CH1=free,CH2=free", "--baseline", "CH1=free,CH2=free", "--free", "material.youngs_modulus"]
    assert main([*words, "-o", str(tmp_path / "out")]) == 0
    free = json.loads((tmp_path / "out" / "fit.json").read_text())["free"]
    channels = dict(zip(VOLTS, measured.NAMES[:2], strict=True))
    truth = {f"gain of {channels[name]}": (gain, "N/V") for name, (gain, _) in VOLTS.items()}
    truth |= {f"baseline of {channels[name]}": (baseline, "V") for name, (_, baseline) in VOLTS.items()}
    truth |= {"material.youngs_modulus": (measured.MODULUS, "Pa"), "time offset": (measured.LATE, "s")}
    assert set(free) == set(truth)
    for name, (value, unit) in truth.items():
        entry = free[name]
        assert entry["unit"] == unit
        width = entry["high"] - entry["low"]
        assert abs(entry["value"] - value) < width < 0.02 * abs(value)  # four standard errors


@pytest.mark.slow
def test_modulus_impact_and_all_gains_together_are_undetermined_and_coupling_and_offset_are_not(tmp_path):
    """With T fixed a harder impact on softer contacts changes the size of all forces alone; springs have mass / T^2."""
    columns = dict(pair.split("=") for pair in COLUMNS.split(","))
    gain, baseline = dict.fromkeys(VOLTS, "free"), {name: baseline for name, (_, baseline) in VOLTS.items()}
    file = granchain.trace_file(scope(tmp_path), columns, gain=gain, baseline=baseline)
    fitted = granchain.fit(measured.scene(modulus=1.05), file, list(measured.TRUTH), tmp_path / "o", lammps=False)
    assert fitted.fits
    for name, value in (("time offset", measured.LATE), ("coupling.stiffness", measured.COUPLING)):
        determined = fitted.free.pop(name)
        assert abs(determined.value - value) < determined.high - determined.low < 0.02 * value  # four standard errors
    assert [(entry.value, entry.low, entry.high) for entry in fitted.free.values()] == [(None, None, None)] * 4
    [warning] = [text for text in fitted.warnings if "undetermined" in text]
    assert "give 1 of these 4" in warning
    assert (tmp_path / "o" / "fitted.yaml").read_text().startswith("# undetermined, one of many values")
