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


@pytest.mark.parametrize(("other", "same"), [(2.0005, True), (2.005, False)])
def test_bands_are_drawn_where_all_cases_have_them(other, same):
    rows = [{"case": "a"}, {"case": "b"}]
    bands = {"a": [[0.0, 1.0], [1.5, 2.0]], "b": [[0.0, 1.0], [1.5, other]]}
    table = SweepTable(["drive.frequency"], rows, False, bands=bands)
    assert (table.passed("drive.frequency") is not None) == same
    assert table.passed("gap") is None


@pytest.mark.parametrize(
    ("field", "value"),
    [("kick[1].velocity", 1.0), ("kick[2].velocity", 0.5), ("kick[3].velocity", None), ("coupling.stiffness", 0.1)],
)
def test_a_field_is_looked_up_where_its_path_leads(field, value):
    scene = {"kick": [{"velocity": 1.0}, {"velocity": 0.5}], "coupling": {"stiffness": 0.1}}
    assert fields.look_up(scene, fields.parse(field)) == value


SI = {"material": {"radius": 1e-3}}


def test_columns_and_fields_have_their_own_label_unit_and_bounds(golden):
    """Of quantities in SI; of fields in SI and reduced, and between what they lie."""
    lines = [f"{name}: {quantity.unit(si=True) or 'no unit'}" for name, quantity in QUANTITIES.items()]
    for name in fields.all_fields(Scene):
        parts = fields.parse(name.replace("kinds.", "kinds.light."))
        reduced, si = (fields.label(parts, scene) for scene in ({}, SI))
        assert not set(reduced.words) & set("._"), name
        lines.append(f"{name}: {si.plain}; {reduced.plain}; {fields.bounds(parts)}")
    golden("labels", "\n".join(lines))


@pytest.mark.parametrize(("law", "unit"), [("linear", "kg/s"), ("viscoelastic", "kg/(s m^0.5)"), ("restitution", "")])
def test_the_unit_of_damped_contacts_is_that_of_their_law(law, unit):
    assert fields.unit(fields.parse("damping.contact"), SI | {"damping": {"law": law}}) == unit
