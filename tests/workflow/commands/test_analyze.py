"""What `analyze` prints of gauges, spectra and energy: hand-made numbers, with their units."""

import numpy as np
import pytest
from stock_lammps import scene

from analysis.gauges.gauge import gauges
from analysis.gauges.readings import Readings
from analysis.gauges.spectra import Spectra
from analysis.sharing.energy_flow import Flow
from lammps_inputs import Kick, Material, library
from workflow.commands import analyze

STEEL = {"radius": 4.76e-3, "density": 8000.0, "youngs_modulus": 193e9, "poisson_ratio": 0.3}


@pytest.fixture(params=[False, True], ids=["reduced", "SI"])
def problem(request):
    """Two chains of ten beads."""
    material = Material(**STEEL) if request.param else None
    return scene(chains=2, beads=10, kick=(Kick(velocity=0.5),), material=material).problem()


def numbers(words):
    return [float(word) for word in words]


def test_of_a_gauge_force_time_impulse_and_dwell_are_told(problem, capsys):
    scale = problem.scale
    places = gauges(problem, wall=False, contacts=(2, 7), sensors=())
    most = np.add.outer(np.arange(1.0, 3.0), np.array([10.0, 20.0]))  # [chain, gauge]
    force = np.stack([0.0 * most, most])
    seen = {"impulse": 2.0 * most, "dwell": 3.0 * most, "contacts": np.ones((2, 2), dtype=np.int64)}
    readings = Readings(places, np.array([0.0, 4.0]), force, 0.0 * most, most, 0.1 * most, **seen)
    analyze._print_forces(problem, readings, {})
    out = capsys.readouterr().out
    for name, unit in (("largest", "N"), ("at", "s"), ("impulse", "kg m/s"), ("dwell", "s")):
        assert (f"{name} ({unit})" in " ".join(out.split())) == scale.si
    told = [line.split() for line in out.splitlines() if line.strip().startswith(("contact", "1 ", "2 "))]
    worth = np.array([1.0, 0.1, 2.0, 3.0]) * [scale.force, scale.time, scale.momentum, scale.time]
    expected = [number * worth for number in (11.0, 12.0, 21.0, 22.0)]
    for words, right in zip(told, expected, strict=True):
        np.testing.assert_allclose(numbers(words[-4:]), right, rtol=1e-3)


def test_of_the_energy_least_most_and_last_are_told_with_their_times(problem, capsys):
    share, time = np.array([1.0, 0.2, 0.7, 0.4]), np.arange(4.0)
    both = np.stack([share, 1.0 - share], axis=1)
    analyze._print_energy(problem, Flow(time, both, 0.0 * time, 10.0 * both, both))
    told = [line for line in capsys.readouterr().out.splitlines() if "+-" in line]
    unit = problem.scale.time
    for line, words in zip(
        told,
        (
            f"1 0.2000 at {1.0 * unit:.5g} 0.7000 at {2.0 * unit:.5g} 0.4000 4.0 +- 0.4",
            f"2 0.3000 at {2.0 * unit:.5g} 0.8000 at {1.0 * unit:.5g} 0.6000 6.0 +- 0.6",
        ),
        strict=True,
    ):
        assert line.split() == words.split()


@pytest.mark.parametrize("si", [False, True])
def test_of_spectra_the_highest_line_and_what_is_passed_on_are_told(si, capsys):
    size, frequency = (1e-6, 1000.0) if si else (0.1, 0.05)
    drive = {"chain": 2, "displacement": size, "frequency": frequency}
    plain = {"name": "a", "chains": 2, "beads": 10, "drive": drive, "duration": 10.0 / frequency}
    problem = library.from_plain({**plain, **({"material": STEEL} if si else {})}, "a").problem()
    scale = problem.scale
    lines = np.zeros((3, 2, 2))
    lines[1, 0], lines[2, 1] = [0.1, 0.2], [0.3, 0.4]  # [line, chain, bead]
    at_drive = np.array([[[0.5, 0.1], [0.8, 0.2]]])
    spectra = Spectra((1, 8), 4.0, np.array([0.0, 0.5, 1.0]), lines, np.array([frequency * scale.time]), at_drive)
    analyze._print_spectra(problem, spectra)
    out = capsys.readouterr().out
    assert f"from t = {4.0 * scale.time:.5g} on" in out
    assert f"{frequency:.5g}" in out
    half, whole, velocity = 0.5 / scale.time, 1.0 / scale.time, scale.velocity
    expected = [
        [1, 1, half, 0.1 * velocity, 1.0],
        [2, whole, 0.3 * velocity, 1.0],
        [8, 1, half, 0.2 * velocity, 0.2],
        [2, whole, 0.4 * velocity, 0.25],
    ]
    told = [line.split() for line in out.splitlines()]
    told = [numbers(words) for words in told if words and words[0] in ("1", "2", "8")]
    assert len(told) == 4
    for found, right in zip(told, expected, strict=True):
        np.testing.assert_allclose(found, right, rtol=1e-3)
