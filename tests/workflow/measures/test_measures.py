"""Measurements of gauges, the far end, spectra and energy by hand-made numbers: reports, tables, sentences."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from leaves import leaves
from stock_lammps import scene
from synthetic_waves import of_keys

from analysis.gauges.gauge import gauges as places_of
from analysis.quantity import csv_of
from analysis.sharing.energies import Flow
from analysis.trajectory import Trajectory
from lammps_inputs import Kick, Material, library
from workflow.measures.energy import EnergyMeasurement
from workflow.measures.far_end import FarEndMeasurement, Transmitted
from workflow.measures.forces.measurement import ForceMeasurement
from workflow.measures.forces.readings import Readings
from workflow.measures.plastic import PlasticMeasurement, Yielded, YieldMeter, YieldTable
from workflow.measures.spectra import SpectrumMeasurement, VelocitySpectra
from workflow.measures.window import LeftBehind, WindowMeter
from workflow.screen import print_table

STEEL = {"radius": 4.76e-3, "density": 8000.0, "youngs_modulus": 193e9, "poisson_ratio": 0.3}

KICK = (Kick(velocity=0.5),)


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


def forces(problem):
    """Without and under a static load, where frames do not show a force, and where none exceeds the load."""
    free, loaded, unseen = readings(problem, 0.0), readings(problem, 5.0), readings(problem, 5.0)
    free.largest_error[0, 1] = 1e-3 * free.largest[0, 1]
    unseen.largest[1, 2] = unseen.impulse[1, 2] = np.nan
    nothing, force = np.full((2, 3), np.nan), np.stack([loaded.static, loaded.static - 1.0])
    relieved = replace(loaded, force=force, largest=loaded.static, at=nothing, dwell=nothing)
    for seen in (free, loaded, unseen, relieved):
        yield ForceMeasurement(problem, seen.entries({}), seen), seen.table()


def spectra(*, si):
    """Of two beads in two chains, the second driven at half of the first line."""
    size, frequency = (1e-6, 1000.0) if si else (0.1, 0.05)
    drive = {"chain": 2, "displacement": size, "frequency": frequency}
    plain = {"name": "a", "chains": 2, "beads": 10, "drive": drive, "duration": 10.0 / frequency}
    driven = library.from_plain({**plain, **({"material": STEEL} if si else {})}, "a").problem()
    lines = np.zeros((3, 2, 2))
    lines[1, 0], lines[2, 1] = [0.1, 0.2], [0.3, 0.4]  # [line, chain, bead]
    at_drive = np.array([[[0.5, 0.1], [0.8, 0.2]]])
    seen = VelocitySpectra(
        beads=(1, 8),
        after=4.0,
        frequency=np.array([0.0, 0.5, 1.0]),
        amplitude=lines,
        drive=np.array([frequency * driven.scale.time]),
        at_drive=at_drive,
        amplitude_error=0.1 * lines,
        at_drive_error=0.1 * at_drive,
    )
    return SpectrumMeasurement(driven, seen.found(driven), seen), seen.table()


@pytest.mark.parametrize("units", ["reduced", "SI"])
def test_each_measurement_has_the_numbers_units_and_sentences_that_are_its_own(units, golden, capsys):
    problem = scene(chains=2, beads=10, kick=KICK, material=Material(**STEEL) if units == "SI" else None).problem()
    share = np.array([[1.0, 0.0], [0.2, 0.8], [0.7, 0.3], [0.4, 0.6]])
    flow = Flow(np.arange(4.0), share, np.array([0.0, 0.1, 0.0, 0.0]), 10.0 * share, np.where(share > 0, share, np.nan))
    passed = Transmitted(2.0, 1.5, 30.0, 0.25, 0.02, 0.01, 0.03, 0.04)
    others = [(EnergyMeasurement(problem, flow), None), (FarEndMeasurement(problem, passed), None)]
    text = []
    for measurement, columns in itertools.chain(forces(problem), [spectra(si=units == "SI")], others):
        text += ["", measurement.key, *leaves(measurement.plain())]
        text += [] if columns is None else csv_of(columns, measurement.problem.scale).splitlines()
        for line in measurement.lines():
            print(line) if isinstance(line, str) else print_table(*line)
        text += capsys.readouterr().out.splitlines()
    golden(units, "\n".join(text))


def test_the_law_drawn_through_largest_forces_in_newtons_goes_through_forces_that_follow_it():
    problem = of_keys(
        beads=31, material=STEEL, contact={"yield": {"overlap": 0.1}}, kick={"velocity": 0.5}, duration=1e-3
    )
    contact, ones = np.arange(1, 31), np.ones(30, dtype=np.int64)
    force, overlap = 0.3 * contact**-0.5, 0.2 / contact
    table = YieldTable(ones, contact, overlap, force, 0.5 * overlap, ones, 0.1 * overlap)
    values = Yielded(30, 0.1, 0.5, -0.5, 0.01)
    measured, law = PlasticMeasurement(problem, values, table).sheet().rows[0][0].curves
    np.testing.assert_allclose(measured.y, force * problem.scale.force, rtol=1e-12)
    np.testing.assert_allclose(law.y, measured.y[15:], rtol=1e-12)
    assert PlasticMeasurement(problem, values, replace(table, permanent=0.0 * overlap)).sheet() is None


def test_a_contact_has_begun_to_open_whose_overlap_is_less_than_its_largest():
    """The first is at its largest overlap, the second below it, and the third was never closed."""
    problem = of_keys(beads=4, contact={"yield": {"overlap": 0.1}}, kick={"velocity": 1.0}, duration=1.0)
    x = np.array([0.75, 0.5, 0.25, 0.5])
    state = np.array([0.0, 0.25, 0.375, 0.0, 0.0])
    last = Trajectory(
        problem,
        np.ones(1),
        *(row[np.newaxis, np.newaxis] for row in (x, 0.0 * x)),
        contact_state=state[np.newaxis, np.newaxis],
    )
    yielded, table = YieldMeter().read([last])
    assert table.opened.tolist() == [0, 1, 0]
    assert table.overlap.tolist() == [0.25, 0.375, 0.0]
    onset, largest = 0.1, np.array([0.25, 0.375])
    force = np.sqrt(onset) * (1.5 * largest - 0.5 * onset)
    np.testing.assert_allclose(table.force, [*force, 0.0], rtol=1e-12)
    share = np.sqrt(onset / largest) * (1.5 - 0.5 * onset / largest)
    np.testing.assert_allclose(table.permanent, [*largest * (1.0 - share), 0.0], rtol=1e-12)
    assert (yielded.contacts, yielded.permanent) == (2, table.permanent[1])


def test_a_window_leaves_behind_the_largest_of_the_velocities_that_beads_had_when_it_left_them():
    """First bead of the window in each part, and the velocities of its beads at the end of that part."""
    pieces = [(1, np.array([0.1, 0.5, 0.2])), (3, np.array([0.9, 0.0, 0.0])), (3, np.array([0.3, 0.7, 0.0]))]
    pieces += [(4, np.array([0.8, 0.9, 0.9]))]
    assert WindowMeter().result(pieces) == LeftBehind(0.5, 2)
    assert WindowMeter().result(pieces[1:]) == LeftBehind(0.3, 3)
    assert WindowMeter().result(pieces[:1]) == (0.0, 0)
