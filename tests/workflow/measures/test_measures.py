"""Measurements of gauges, the far end, spectra, sound and energy: hand-made numbers in scenes' units."""

import csv
import io
from dataclasses import replace

import numpy as np
import pytest
from stock_lammps import scene
from synthetic_waves import of_keys

from analysis.gauges.gauge import gauges as places_of
from analysis.quantity import csv_of
from analysis.sharing.energies import Flow
from lammps_inputs import Kick, Material, library
from workflow.measures.energy import EnergyMeasurement
from workflow.measures.far_end import FarEndMeasurement, Transmitted
from workflow.measures.forces.measurement import ForceMeasurement
from workflow.measures.forces.readings import Readings
from workflow.measures.forces.reflection import Reflection
from workflow.measures.spectra import SpectrumMeasurement, VelocitySpectra
from workflow.measures.window import LeftBehind, WindowMeter
from workflow.screen import print_table

STEEL = {"radius": 4.76e-3, "density": 8000.0, "youngs_modulus": 193e9, "poisson_ratio": 0.3}

KICK = (Kick(velocity=0.5),)


@pytest.fixture(scope="module", params=[False, True], ids=["reduced", "SI"])
def problem(request):
    """Two chains of ten beads."""
    return scene(chains=2, beads=10, kick=KICK, material=Material(**STEEL) if request.param else None).problem()


def readings(problem, static, **asked):
    """Two frames of three gauges: force 10 * gauge + chain (from 1) above rest in the second."""
    places = places_of(problem.system, **(asked or {"wall": False, "contacts": (2, 7), "sensors": (5,)}))
    number = np.add.outer(np.arange(1.0, 3.0), 10.0 * np.arange(1.0, 4.0))  # [chain, gauge]
    rest = np.full((2, 3), static)
    force = np.stack([rest, rest + number])
    ended = number < 12.0  # chain 1's first
    seen = {"impulse": 2.0 * number, "dwell": 3.0 * number, "ended": ended, "contacts": np.ones((2, 3), dtype=np.int64)}
    for place, name in enumerate(("largest", "at", "impulse", "dwell"), 1):
        seen[f"{name}_error"] = 1e-6 * place * number
    return Readings(places, np.array([0.0, 4.0]), force, rest, rest + number, 0.1 * number, **seen)


def measurement_of(seen, problem):
    return ForceMeasurement(problem, seen.entries({}), seen)


@pytest.mark.parametrize("static", [0.0, 5.0])
def test_each_gauge_and_chain_has_an_entry_of_its_own_numbers(problem, static):
    scale, entries = problem.scale, measurement_of(readings(problem, static), problem).plain()
    names = [("contact 2", 2), ("contact 7", 7), ("sensor 5", 5)]
    assert [(one["name"], one["bead"], one["chain"]) for one in entries] == [(*n, c) for n in names for c in (1, 2)]
    for place, one in enumerate(entries):
        number = 10.0 * (1 + place // 2) + one["chain"]
        expected = {
            "largest": (static + number) * scale.force,
            "at": 0.1 * number * scale.time,
            "impulse": 2.0 * number * scale.momentum,
            "dwell": 3.0 * number * scale.time,
            "largest_error": 1e-6 * number * scale.force,
            "at_error": 2e-6 * number * scale.time,
            "impulse_error": 3e-6 * number * scale.momentum,
            "dwell_error": 4e-6 * number * scale.time,
            "dwell_ended": number < 12.0,
            "last": 1.0,
            "static": static * scale.force if static else None,
            "dynamic": number * scale.force if static else None,
            "reflected": None,
        }
        assert {key: one[key] for key in expected} == pytest.approx(expected)
        assert set(one) == {*expected, "kind", "name", "chain", "bead", "contacts"}


def test_the_figure_has_a_row_for_each_gauge(problem):
    assert len(measurement_of(readings(problem, 0.0), problem).sheet().rows) == 3


def test_gauges_whose_force_frames_do_not_show_are_named(problem):
    seen = readings(problem, 5.0)
    seen.largest[1, 2] = seen.impulse[1, 2] = np.nan
    _, sentence, *_ = measurement_of(seen, problem).lines()
    every = problem.scale.written(problem.every, "time", ".3g")
    assert sentence == (
        f"frames {every} apart do not show the force between them at sensor 5, chain 2; take a smaller `output.every`"
    )


def test_the_uncertainty_of_forces_is_printed_where_it_matters(problem):
    seen = readings(problem, 0.0)
    assert not any("uncertainty" in line for line in measurement_of(seen, problem).lines() if isinstance(line, str))
    seen.largest_error[0, 1] = 1e-3 * seen.largest[0, 1]
    _, sentence, *_ = measurement_of(seen, problem).lines()
    assert "the uncertainty of largest forces, by frames " in sentence
    assert "is up to 1.0e-03 of the excess over rest (contact 7, chain 1" in sentence


def test_what_each_wall_feels_and_reflects_is_said_of_each_chain():
    walled = of_keys(chains=2, beads=10, kick={"velocity": 1.0}, duration=1.0, walls={"left": "bead", "right": "flat"})
    seen = readings(walled, 0.0, wall=True, contacts=(2,))
    names = [gauge.name for gauge in seen.gauges]
    ratios = {gauge.side: (0.1 * n, 0.1 * n + 0.01) for n, gauge in enumerate(seen.gauges, 1)}
    reflected = {side: [Reflection(ratio, 0.001, (1, 2), (3, 4)) for ratio in ratios[side]] for side in ratios}
    said = [line for line in ForceMeasurement(walled, seen.entries(reflected), seen).lines() if isinstance(line, str)]
    for place, gauge in enumerate(seen.gauges):
        for chain in (0, 1) if gauge.kind == "wall" else ():
            where = f"in chain {chain + 1} the"
            times = seen.largest[chain, place] / seen.largest[chain, names.index("contact 2")]
            assert f"{where} largest force at the {gauge.name} is {times:.4f} times that at contact 2" in said
            bounced = f"{where} {gauge.name} reflects the first pulse with {ratios[gauge.side][chain]:.4f} +- 0.001"
            assert any(line.startswith(bounced) for line in said)


@pytest.mark.parametrize("static", [0.0, 5.0])
def test_each_gauge_and_chain_has_its_column_in_forces_csv(problem, static):
    scale = problem.scale
    rest, line = csv.DictReader(io.StringIO(csv_of(readings(problem, static).table(), scale)))
    second, newton = (" (s)", " (N)") if scale.si else ("", "")
    assert float(line.pop(f"time{second}")) == pytest.approx(4.0 * scale.time)
    expected, total = {}, " total" if static else ""
    for gauge, name in enumerate(("contact 2", "contact 7", "sensor 5"), 1):
        for chain in (1, 2):
            expected[f"{name} chain {chain}{total}{newton}"] = (static + 10.0 * gauge + chain) * scale.force
            if static:
                expected[f"{name} chain {chain} dynamic{newton}"] = (10.0 * gauge + chain) * scale.force
    assert {name: float(value) for name, value in line.items()} == pytest.approx(expected)
    assert float(rest[f"sensor 5 chain 2{total}{newton}"]) == pytest.approx(static * scale.force)


def test_what_comes_through_is_in_the_scenes_units_and_energy_a_share(problem):
    found = Transmitted(2.0, 1.5, 30.0, 0.25, 0.02, 0.01, 0.03, 0.04)
    force, time = problem.scale.force, problem.scale.time
    values = {"wall_force": 2.0 * force, "wall_force_chain": 1.5 * force, "delay": 30.0 * time}
    errors = {"wall_force_error": 0.02 * force, "wall_force_chain_error": 0.01 * force, "delay_error": 0.03 * time}
    shares = {"transmitted_energy": 0.25, "transmitted_energy_error": 0.04}
    assert FarEndMeasurement(problem, found).plain() == pytest.approx({**values, **errors, **shares})


@pytest.fixture(params=[False, True], ids=["reduced", "SI"])
def spectra(request):
    """Of two beads in two chains, the second driven at half of the first line."""
    unit = {"material": STEEL} if request.param else {}
    size, frequency = (1e-6, 1000.0) if request.param else (0.1, 0.05)
    drive = {"chain": 2, "displacement": size, "frequency": frequency}
    plain = {"name": "a", "chains": 2, "beads": 10, "drive": drive, "duration": 10.0 / frequency, **unit}
    driven = library.from_plain(plain, "a").problem()
    lines = np.zeros((3, 2, 2))
    lines[1, 0], lines[2, 1] = [0.1, 0.2], [0.3, 0.4]  # [line, chain, bead]
    at_drive = np.array([[[0.5, 0.1], [0.8, 0.2]]])
    seen = VelocitySpectra(
        (1, 8),
        4.0,
        np.array([0.0, 0.5, 1.0]),
        lines,
        np.array([frequency * driven.scale.time]),
        at_drive,
        amplitude_error=0.1 * lines,
        at_drive_error=0.1 * at_drive,
    )
    return SpectrumMeasurement(driven, seen.found(driven), seen), driven.scale, frequency


def test_spectra_say_what_the_last_bead_has_of_the_drive_in_the_chain_that_is_driven(spectra):
    found, scale, frequency = spectra
    found = found.plain()
    assert found["transmissibility"] == pytest.approx(0.25)
    assert (found["after"], found["resolution"]) == pytest.approx((4.0 * scale.time, 0.5 / scale.time))
    entries = {(one["chain"], one["bead"]): one for one in found["beads"]}
    assert sorted(entries) == [(1, 1), (1, 8), (2, 1), (2, 8)]
    last = entries[2, 8]
    assert (last["frequency"], last["amplitude"]) == pytest.approx((1.0 / scale.time, 0.4 * scale.velocity))
    errors = (last["frequency_error"], last["amplitude_error"])
    assert errors == pytest.approx((0.25 / scale.time, 0.04 * scale.velocity))
    told = {"frequency": frequency, "amplitude": 0.2 * scale.velocity, "transmissibility": 0.25}
    told |= {"amplitude_error": 0.02 * scale.velocity, "transmissibility_error": 0.04 / 0.72}
    assert last["at_drive"] == [pytest.approx(told)]


def test_energy_over_time_is_told_chain_by_chain(problem):
    part = np.array([[0.75, 0.25]])
    flow = Flow(np.array([3.0]), part, np.array([0.1]), 10.0 * part, np.array([[1.0, np.nan]]))
    told = EnergyMeasurement(problem, flow).plain()
    assert told["time"] == [3.0 * problem.scale.time]
    assert told["share"] == [[0.75, 0.25]]
    assert told["centre"] == [[7.5, 2.5]]
    assert told["spread"] == [[1.0, None]]
    assert told["between"] == [0.1]


# --- what is printed --------------------------------------------------------------------------------------------------


@pytest.fixture
def printed(capsys):
    """What the terminal shows of a measurement."""

    def shown(measurement):
        for line in measurement.lines():
            print(line) if isinstance(line, str) else print_table(*line)
        return capsys.readouterr().out

    return shown


def numbers(words):
    return [float(word) for word in words]


def test_of_a_gauge_force_time_impulse_and_dwell_are_told(problem, printed):
    scale = problem.scale
    places = places_of(problem.system, wall=False, contacts=(2, 7), sensors=())
    most = np.add.outer(np.arange(1.0, 3.0), np.array([10.0, 20.0]))  # [chain, gauge]
    force = np.stack([0.0 * most, most])
    there = np.ones((2, 2), dtype=np.int64)
    seen = {"impulse": 2.0 * most, "dwell": 3.0 * most, "ended": there > 0, "contacts": there}
    seen |= {f"{name}_error": 0.0 * most for name in ("largest", "at", "impulse", "dwell")}
    found = Readings(places, np.array([0.0, 4.0]), force, 0.0 * most, most, 0.1 * most, **seen)
    out = printed(measurement_of(found, problem))
    for name, unit in (("largest", "N"), ("at", "s"), ("impulse", "kg m/s"), ("dwell", "s")):
        assert (f"{name} ({unit})" in " ".join(out.split())) == scale.si
    told = [line.split() for line in out.splitlines() if line.strip().startswith(("contact", "1 ", "2 "))]
    worth = np.array([1.0, 0.1, 2.0, 3.0]) * [scale.force, scale.time, scale.momentum, scale.time]
    expected = [number * worth for number in (11.0, 12.0, 21.0, 22.0)]
    for words, right in zip(told, expected, strict=True):
        np.testing.assert_allclose(numbers(words[-4:]), right, rtol=1e-3)


def test_under_a_static_load_the_table_names_total_and_dynamic_and_what_is_so_far(problem, printed):
    out = printed(measurement_of(readings(problem, 5.0), problem))
    words = " ".join(out.split())
    for name in ("static", "largest total", "largest dynamic", "at", "dynamic impulse", "dwell above static"):
        assert name in words
    rows = [line for line in out.splitlines() if line.split()[:1] in (["contact"], ["sensor"], ["2"])]
    assert ["so far" in row for row in rows] == [False, True, True, True, True, True]
    assert "inside a pulse: the force still differs from the static force" in words


def test_what_never_exceeds_the_static_load_has_no_dynamic_force(problem, printed):
    seen = readings(problem, 5.0)
    nothing, force = np.full(seen.static.shape, np.nan), np.stack([seen.static, seen.static - 1.0])
    seen = replace(seen, force=force, largest=seen.static, at=nothing, dwell=nothing)
    found = measurement_of(seen, problem)
    for entry in found.plain():
        assert [entry[key] for key in ("at", "dynamic", "dwell_ended", "last")] == [None] * 4
        assert entry["largest"] == entry["static"]
    assert "inside a pulse" not in printed(found)


def test_of_the_energy_least_most_and_last_are_told_with_their_times(problem, printed):
    share, time = np.array([1.0, 0.2, 0.7, 0.4]), np.arange(4.0)
    both = np.stack([share, 1.0 - share], axis=1)
    flow = Flow(time, both, 0.0 * time, 10.0 * both, both)
    told = [line for line in printed(EnergyMeasurement(problem, flow)).splitlines() if "+-" in line]
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


def test_of_spectra_the_highest_line_and_what_is_passed_on_are_told(spectra, printed):
    found, scale, frequency = spectra
    out = printed(found)
    assert f"from t = {4.0 * scale.time:.5g}{' s' if scale.si else ''} on" in out
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


def test_a_measurement_is_displayed_as_its_numbers_in_the_scenes_units(problem):
    found = FarEndMeasurement(problem, Transmitted(2.0, 1.0, 3.0, 0.5))
    assert repr(found) == f"<far_end of {problem.name}, in the scene's units: {found.plain()}>"
    assert f"'delay': {3.0 * problem.scale.time!r}" in repr(found)


def test_a_window_leaves_behind_the_largest_of_the_velocities_that_beads_had_when_it_left_them():
    """First bead of the window in each part, and the velocities of its beads at the end of that part."""
    pieces = [(1, np.array([0.1, 0.5, 0.2])), (3, np.array([0.9, 0.0, 0.0])), (3, np.array([0.3, 0.7, 0.0]))]
    pieces += [(4, np.array([0.8, 0.9, 0.9]))]
    assert WindowMeter().result(pieces) == LeftBehind(0.5, 2)
    assert WindowMeter().result(pieces[1:]) == LeftBehind(0.3, 3)
    assert WindowMeter().result(pieces[:1]) == (0.0, 0)
