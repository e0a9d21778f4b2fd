"""What stands in which column of a sweep's table, in which order of rows: by files made by hand; labels in units."""

import pytest

from lammps_inputs import Scene
from workflow.quantities.columns import QUANTITIES
from workflow.sweep import collect, fields
from workflow.sweep.collect import SweepTable

REPORT = {
    "front": 58,
    "energy_drift": 1e-6,
    "participation": 4.5,
    "waves": [
        {"chain": 1, "bead": 55, "arrival": 70.0, "peak_velocity": 0.31, "speed": 0.74},
        {"chain": 2, "bead": 54, "arrival": 71.0, "peak_velocity": 0.32, "speed": 0.75},
    ],
    "equipartition": {
        "amplitudes": {"0.1": 20, "0.01": 40, "0.001": 50},
        "arrivals": {"0.1": 25, "0.01": 45, "0.001": 55},
        "final": {"value": 0.34, "uncertainty": 0.01, "reduction": 0.66},
        "beat_length": {"value": 12.0, "uncertainty": 0.5},
        "energy_share": {"exact": 0.97, "measured": 0.98, "measured_error": 2e-6},
        "state": "beating",
        "verdict": "they beat",
    },
    "far_end": {"wall_force": 1.3, "wall_force_chain": 0.9, "delay": 80.0, "transmitted_energy": 0.7},
    "cells": {"residual_energy": 0.002},
    "spectra": {"transmissibility": 0.4},
}
RECORD = {
    "engine": "lammps",
    "steps": 1000,
    "engine_seconds": 2.0,
    "wall_seconds": 3.0,
    "check": {"velocity": 1e-4, "amplitude": 1e-5, "arrival": 1e-3, "seconds": 9.0},
}
EXPECTED = {
    "amplitude": 0.34, "amplitude_uncertainty": 0.01, "agree_10": 20, "agree_1": 40, "synchronised_1": 45,
    "beat_length": 12.0, "beat_length_uncertainty": 0.5, "energy_share": 0.98, "energy_share_uncertainty": 2e-6,
    "state": "beating",
    "bead": 54, "arrival": 71.0, "peak_velocity": 0.32, "speed": 0.75, "residual_energy": 0.002,
    "transmissibility": 0.4,
    "wall_force": 1.3, "wall_force_chain": 0.9, "delay": 80.0, "transmitted_energy": 0.7, "front": 58,
    "participation": 4.5, "energy_drift": 1e-6, "error_velocity": 1e-4, "error_amplitude": 1e-5, "error_arrival": 1e-3,
    "engine": "lammps", "steps": 1000, "engine_seconds": 2.0, "wall_seconds": 3.0, "verdict": "they beat",
}  # fmt: skip


@pytest.mark.parametrize(
    "kick",
    [{"chain": 2, "velocity": 1.0}, [{"chain": 1, "velocity": 0.5}, {"chain": 2, "velocity": -1.0}]],
    ids=["one", "the harder of two, backwards"],
)
def test_every_column_holds_what_its_name_says_of_the_chain_that_was_hit_hardest(kick):
    found = collect.quantities(REPORT, RECORD, {"kick": kick})
    assert {name: found[name] for name in EXPECTED} == EXPECTED


IN = {
    "V": ("amplitude", "amplitude_uncertainty", "error_velocity", "error_amplitude"),
    "T": ("error_arrival",),
    "s": ("arrival", "delay"),
    "m": ("permanent",),
    "m/s": ("peak_velocity",),
    "beads/s": ("speed",),
    "N": ("wall_force", "wall_force_chain"),
}
"""Units of columns of scenes in SI; all others have none."""


def test_every_column_has_its_own_unit():
    of = {name: unit for unit, names in IN.items() for name in names}
    assert {name: quantity.unit(si=True) for name, quantity in QUANTITIES.items()} == {
        name: of.get(name, "") for name in QUANTITIES
    }


@pytest.mark.parametrize(("other", "same"), [(2.0005, True), (2.005, False)])
def test_bands_are_drawn_where_all_cases_have_them(other, same):
    rows = [{"case": "a"}, {"case": "b"}]
    bands = {"a": [[0.0, 1.0], [1.5, 2.0]], "b": [[0.0, 1.0], [1.5, other]]}
    table = SweepTable(["drive.frequency"], rows, False, bands=bands)
    assert (table.passed("drive.frequency") is not None) == same
    assert table.passed("gap") is None


def test_columns_begin_with_case_fields_and_outcome_and_end_with_the_reason():
    columns = SweepTable(["gap", "beads"], [], False).columns
    assert (columns[:4], columns[4:-1], columns[-1]) == (
        ["case", "gap", "beads", "outcome"],
        list(QUANTITIES),
        "reason",
    )


def test_rows_are_in_the_order_of_numbers_not_of_their_digits():
    assert sorted([10, 9.5, "bead", 2, 100.0], key=collect._rank) == [2, 9.5, 10, 100.0, "bead"]


def test_a_figure_is_of_cases_that_are_done_and_has_a_tick_for_each_other(tmp_path, monkeypatch):
    drawn = []
    monkeypatch.setattr(collect, "write_figure", lambda _path, _name, figure: drawn.append(figure) or ())
    blank = dict.fromkeys(QUANTITIES)
    rows = [
        {**blank, "case": str(gap), "gap": gap, "outcome": outcome, "speed": 10.0 * gap, "reason": None}
        for gap, outcome in ((1.0, "done"), (2.0, "failed"), (3.0, "done"), (4.0, "incomplete"))
    ]
    collect.plot(SweepTable(["gap"], rows, False), tmp_path, "speed", "gap", None)
    line, foot = drawn[0].axes[0].get_lines()
    assert [place for place in line.get_xydata().tolist() if place[1] == place[1]] == [[1.0, 10.0], [3.0, 30.0]]
    assert foot.get_xdata().tolist() == [2.0, 4.0]


@pytest.mark.parametrize(
    ("field", "value"),
    [("kick[1].velocity", 1.0), ("kick[2].velocity", 0.5), ("kick[3].velocity", None), ("coupling.stiffness", 0.1)],
)
def test_a_field_is_looked_up_where_its_path_leads(field, value):
    scene = {"kick": [{"velocity": 1.0}, {"velocity": 0.5}], "coupling": {"stiffness": 0.1}}
    assert fields.look_up(scene, fields.parse(field)) == value


# --- labels -----------------------------------------------------------------------------------------------------------

SI = {"material": {"radius": 1e-3}}

UNITS = {
    "coupling.stiffness": "N/m",
    "coupling.stiffness.from": "N/m",
    "coupling.cubic": "N/m3",
    "kick.velocity": "m/s",
    "kick[2].velocity": "m/s",
    "damping.contact": "kg/s",
    "damping.beads": "kg/s",
    "drive.frequency": "Hz",
    "drive[2].displacement": "m",
    "push.peak": "N",
    "push.duration": "s",
    "precompression.force": "N",
    "gravity": "m/s2",
    "gravity.acceleration": "m/s2",
    "contact.stiffness": "N/m^p",
    "foundation.cubic": "N/m3",
    "walls.right.stiffness": "N/m^1.5",
    "kinds.light.mass": "kg",
    "gap": "m",
    "duration": "s",
    "output.every": "s",
    "output.spectra.after": "s",
    "material.density": "kg/m3",
}


def label(name, scene):
    return fields.label(fields.parse(name), scene)


@pytest.mark.parametrize(("name", "unit"), UNITS.items())
def test_a_field_is_labelled_with_its_unit(name, unit):
    assert label(name, SI).plain.endswith(f" ({unit})")
    assert label(name, {}).plain.endswith(" (reduced)")


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("coupling.stiffness", "coupling stiffness k (N/m)"),
        ("foundation.stiffness.from", "foundation stiffness, value before the ramp (N/m)"),
        ("kick[2].velocity", "kick velocity, kick 2 (m/s)"),
        ("kinds.light.mass", "mass, kind light (kg)"),
        ("walls.right.stiffness", "right wall, stiffness (N/m^1.5)"),
        ("gravity.acceleration", "acceleration of gravity g (m/s2)"),
        ("chains", "number of chains N"),
        ("timestep", "time step (s)"),
    ],
)
def test_labels_of_fields_are_nouns_with_their_symbols(name, text):
    assert label(name, SI).plain == text


def test_no_label_of_a_field_shows_its_key_as_it_is_written_in_a_scene():
    for name in fields.all_fields(Scene):
        words = label(name.replace("kinds.", "kinds.light."), {}).words
        assert not set(words) & set("._"), name


def test_the_unit_of_a_wall_names_no_exponent_where_the_scene_may_have_others():
    assert fields.unit(fields.parse("walls.right.stiffness"), SI | {"contact": {"exponent": 2.0}}) == "N/m^p"


@pytest.mark.parametrize(
    "name", ["beads", "chains", "kick.bead", "accuracy", "material.poisson_ratio", "contact.exponent", "walls.right"]
)
def test_a_number_without_a_unit_has_none(name):
    assert label(name, SI).unit == ""


@pytest.mark.parametrize(("law", "unit"), [("linear", "kg/s"), ("viscoelastic", "kg/(s m^0.5)"), ("restitution", "")])
def test_the_unit_of_damped_contacts_is_that_of_their_law(law, unit):
    assert fields.unit(fields.parse("damping.contact"), SI | {"damping": {"law": law}}) == unit


def test_degrees_are_degrees_in_all_units():
    assert label("drive.phase", {}).plain == label("drive.phase", SI).plain == "drive phase (degrees)"


@pytest.mark.parametrize(
    ("name", "bounds"),
    [
        ("coupling.stiffness", (0.0, 1e30)),
        ("coupling.stiffness.from", (0.0, 1e30)),
        ("kick[2].velocity", (-1e30, 1e30)),
        ("beads", (2.0, 1e8)),
        ("accuracy", (1e-10, 0.1)),
        ("output.every", (0.0, 1e30)),
    ],
)
def test_the_bounds_of_a_field_are_those_of_its_type(name, bounds):
    assert fields.bounds(fields.parse(name)) == bounds
