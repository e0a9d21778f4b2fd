"""Labels of what was varied, in the units of the scenes."""

import pytest

from workflow.sweep.table import Table

UNITS = {
    "coupling.stiffness": "N/m",
    "kick.velocity": "m/s",
    "kick[2].velocity": "m/s",
    "gap": "m",
    "duration": "s",
    "timestep": "s",
    "output.every": "s",
    "output.snapshots": "s",
    "material.radius": "m",
    "material.density": "kg/m3",
    "material.youngs_modulus": "Pa",
}


@pytest.mark.parametrize(("name", "unit"), UNITS.items())
def test_a_field_is_labelled_with_its_unit(name, unit):
    words = name.replace("_", " ").replace(".", " ")
    assert Table([name], [], True).label(name) == f"{words} ({unit})"
    assert Table([name], [], False).label(name) == f"{words} (reduced)"


@pytest.mark.parametrize("name", ["beads", "chains", "kick.bead", "accuracy", "material.poisson_ratio"])
def test_a_number_without_a_unit_has_none(name):
    assert "(" not in Table([name], [], True).label(name)
