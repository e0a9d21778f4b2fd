"""Labels of what was varied, in the units of the scenes."""

import pytest

from workflow.sweep import fields
from workflow.sweep.collect import Table

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
    unit = fields.unit(fields.parse(name), scene)
    return Table([name], [], si="material" in scene, units={name: unit}).label(name)


@pytest.mark.parametrize(("name", "unit"), UNITS.items())
def test_a_field_is_labelled_with_its_unit(name, unit):
    words = name.replace("_", " ").replace(".", " ")
    assert label(name, SI) == f"{words} ({unit})"
    assert label(name, {}) == f"{words} (reduced)"


def test_the_unit_of_a_wall_names_no_exponent_where_the_scene_may_have_others():
    assert fields.unit(fields.parse("walls.right.stiffness"), SI | {"contact": {"exponent": 2.0}}) == "N/m^p"


@pytest.mark.parametrize(
    "name", ["beads", "chains", "kick.bead", "accuracy", "material.poisson_ratio", "contact.exponent", "walls.right"]
)
def test_a_number_without_a_unit_has_none(name):
    assert "(" not in label(name, SI)


@pytest.mark.parametrize(("law", "unit"), [("linear", "kg/s"), ("viscoelastic", "kg/(s m^0.5)"), ("restitution", "")])
def test_the_unit_of_damped_contacts_is_that_of_their_law(law, unit):
    assert fields.unit(fields.parse("damping.contact"), SI | {"damping": {"law": law}}) == unit


def test_degrees_are_degrees_in_all_units():
    assert label("drive.phase", {}) == label("drive.phase", SI) == "drive phase (degrees)"
