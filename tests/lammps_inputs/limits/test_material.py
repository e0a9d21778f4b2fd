"""Beads of real materials are accepted without a word; numbers in other units are refused, or unlikely."""

import pytest

from lammps_inputs.limits.solids import impossible, unlikely

BEADS = {
    "steel": (4.76e-3, 8000.0, 193e9),
    "brass": (4.76e-3, 8500.0, 103e9),
    "aluminium": (5e-3, 2700.0, 70e9),
    "titanium": (5e-3, 4430.0, 114e9),
    "beryllium": (5e-3, 1848.0, 287e9),
    "lead": (5e-3, 11_340.0, 16e9),
    "tungsten carbide": (3e-3, 15_600.0, 650e9),
    "alumina": (2e-3, 3900.0, 380e9),
    "diamond": (1e-3, 3515.0, 1.1e12),
    "glass": (2.5e-3, 2500.0, 70e9),
    "silica, 2 um across": (1e-6, 2000.0, 70e9),
    "ice": (1e-2, 917.0, 9e9),
    "PTFE": (4.76e-3, 2200.0, 0.5e9),
    "polycarbonate": (4.76e-3, 1200.0, 2.3e9),
    "rubber": (5e-3, 1100.0, 5e6),
    "soft silicone": (5e-3, 1100.0, 1e5),
    "hydrogel": (1e-2, 1000.0, 1e4),
    "soft hydrogel": (5e-3, 1000.0, 1e3),
    "microgel": (1e-6, 1000.0, 1e3),
    "polystyrene foam": (5e-3, 15.0, 3e6),
    "aerogel": (5e-3, 100.0, 1e6),
    "celluloid shell": (2e-2, 84.0, 2e9),
    "wrecking ball": (0.5, 7800.0, 200e9),
}
"""Radius (m), density (kg/m3), Young's modulus (Pa)."""

SOLID = [bead for bead in BEADS.values() if bead[1] > 900.0]


@pytest.mark.parametrize("bead", BEADS.values(), ids=BEADS)
def test_beads_of_real_materials_are_possible_and_likely(bead):
    assert impossible(*bead) == ""
    assert unlikely(*bead) == []


def said(*bead):
    return " ".join([impossible(*bead), *unlikely(*bead)])


@pytest.mark.parametrize("bead", BEADS.values(), ids=BEADS)
def test_a_modulus_in_gigapascals_is_seen(bead):
    radius, density, modulus = bead
    assert "GPa is" in said(radius, density, 1e-9 * modulus)


@pytest.mark.parametrize("bead", [bead for bead in SOLID if bead[1] > 2300.0 and bead[2] < 1e12])
def test_a_modulus_in_megapascals_is_unlikely_in_dense_solids(bead):
    radius, density, modulus = bead
    assert "MPa is" in said(radius, density, 1e-6 * modulus)


@pytest.mark.parametrize("bead", SOLID)
def test_a_density_in_grams_or_a_thousand_times_too_large_is_seen(bead):
    radius, density, modulus = bead
    assert "g/cm3 is" in said(radius, 1e-3 * density, modulus)
    assert impossible(radius, 1e3 * density, modulus).startswith("density: ")


@pytest.mark.parametrize("bead", [bead for bead in BEADS.values() if bead[0] >= 1e-3])
def test_a_radius_in_millimetres_is_unlikely(bead):
    radius, density, modulus = bead
    assert "mm is" in said(1e3 * radius, density, modulus)
