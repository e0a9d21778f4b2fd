"""Bounds of the overlap against exact motion, Hertz's pressures against published numbers, beads of real materials."""

import numpy as np
import pytest
from stock_lammps import scene

from lammps_inputs import Kick, Material, System, physics
from lammps_inputs.chains import coupled_chains
from lammps_inputs.laws.plastic import YIELD_PRESSURE
from lammps_inputs.limits.solids import impossible, overlap_bounds, peak_pressure, sound_speed, unlikely
from workflow.engines.reference import engine

STEEL = Material(radius=4.76e-3, density=8000.0, youngs_modulus=193e9, poisson_ratio=0.3)

SHORT = 0.02**2 / 4 * 2
"""How far frames 0.02 apart fall short of an overlap below 3, relatively: sqrt(overlap) every**2 / 4."""


def bounds_of(chains, beads, kappa, gap, kicks):
    links = coupled_chains(chains, kappa, gap)
    return overlap_bounds(System(chains=chains, beads=beads, kicks=tuple(kicks), links=links))


def bounds(problem):
    return overlap_bounds(problem.system)


def largest(problem):
    x = engine.run(problem).displacement
    return (x[..., :-1] - x[..., 1:]).max() - physics.gap(problem.system)


def test_two_beads_that_collide_reach_both_bounds():
    low, high = bounds(scene(beads=2).problem())
    assert low == pytest.approx(0.625**0.4, rel=1e-15)
    assert high == pytest.approx(0.625**0.4, rel=1e-15)


CASES = {
    "one chain": {"beads": 20},
    "two chains": {"beads": 20, "chains": 2, "kappa": 0.1},
    "two stiff chains": {"beads": 12, "chains": 2, "kappa": 2.0},
    "five chains, the middle one hit": {"beads": 8, "chains": 5, "kappa": 0.3, "kick": (Kick(chain=3, velocity=1.0),)},
    "gap": {"beads": 8, "gap": 1.0},
    "coupled gap": {"beads": 8, "gap": 0.3, "chains": 2, "kappa": 0.01},
    "head on": {"beads": 10, "kick": (Kick(velocity=1.0), Kick(bead=2, velocity=-0.9))},
    "in a row": {"beads": 6, "kick": tuple(Kick(bead=bead, velocity=1.0) for bead in (1, 2, 3))},
    "two chains without springs": {"beads": 6, "chains": 2, "kick": (Kick(velocity=0.1), Kick(chain=2, velocity=1.0))},
    "pulled apart": {"beads": 6, "kick": (Kick(velocity=-1.0), Kick(bead=2, velocity=0.2))},
}


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_the_largest_overlap_lies_between_the_bounds(case):
    problem = scene(**{"duration": 8.0, "every": 0.02, **case}).problem()
    low, high = bounds(problem)
    assert low * (1.0 - SHORT) <= largest(problem) <= high * (1.0 + 1e-6)  # the reference keeps energy to 1e-6


def test_bounds_are_those_of_relative_motion_and_the_lower_is_0_where_beads_need_not_meet():
    at_rest, moving = ([(1, 1, 1.0 + u), (1, 2, u), (1, 3, u)] for u in (0.0, 0.5))
    assert bounds_of(1, 3, 0.0, 0.0, moving) == pytest.approx(bounds_of(1, 3, 0.0, 0.0, at_rest), rel=1e-14)
    assert bounds_of(1, 4, 0.0, 0.0, [(1, 1, -1.0)])[0] == 0.0
    assert bounds_of(2, 4, 1.0, 10.0, [(1, 1, 1.0)])[0] == 0.0  # springs may stop the bead within the gap


def test_the_pressure_is_the_published_one_of_two_spheres():
    """code_aster, V6.04.222: two spheres of 50 mm (E = 20 GPa, nu = 0.3) approach by 4 mm: 2798.3 MPa."""
    assert peak_pressure(4e-3, 50e-3, 20e9, 0.3) == pytest.approx(2798.3e6, abs=0.05e6)


def test_yield_begins_at_1_6_times_the_yield_strength():
    """Tresca, on the axis of the contact below the surface (Johnson 3.45): largest |stress_z - stress_r| is Y."""
    z = np.linspace(0.01, 2.0, 2000)  # in contact radii
    axial = -1.0 / (1.0 + z**2)
    radial = -1.3 * (1.0 - z * np.arctan(1.0 / z)) + 0.5 / (1.0 + z**2)
    difference = np.abs(radial - axial)
    assert 1.0 / difference.max() == pytest.approx(YIELD_PRESSURE, abs=0.02)
    assert z[difference.argmax()] == pytest.approx(0.48, abs=0.01)


def test_sound_in_steel_runs_at_4_9_km_a_second():
    assert sound_speed(STEEL.youngs_modulus, STEEL.density) == pytest.approx(4911.7, abs=0.1)


def test_the_fastest_kick_gives_an_overlap_of_a_radius_or_has_the_speed_of_sound():
    """An overlap of 1.9125 R (V / c)^0.8, where the bead meets the next one."""
    sound = sound_speed(STEEL.youngs_modulus, STEEL.density)
    fastest = sound * 1.9125**-1.25
    scene(material=STEEL, kick=(Kick(velocity=0.999 * fastest),))
    with pytest.raises(ValueError, match="kick: gives an overlap of at least 1 times the radius"):
        scene(material=STEEL, kick=(Kick(velocity=1.001 * fastest),))
    scene(material=STEEL, kick=(Kick(velocity=-sound),))  # which meets none
    with pytest.raises(ValueError, match="faster than sound"):
        scene(material=STEEL, kick=(Kick(velocity=-sound * (1.0 + 1e-12)),))


BEADS = {
    "steel": (4.76e-3, 8000.0, 193e9),
    "aluminium": (5e-3, 2700.0, 70e9),
    "lead": (5e-3, 11_340.0, 16e9),
    "tungsten carbide": (3e-3, 15_600.0, 650e9),
    "silica, 2 um across": (1e-6, 2000.0, 70e9),
    "PTFE": (4.76e-3, 2200.0, 0.5e9),
    "soft silicone": (5e-3, 1100.0, 1e5),
    "soft hydrogel": (5e-3, 1000.0, 1e3),
    "microgel": (1e-6, 1000.0, 1e3),
    "polystyrene foam": (5e-3, 15.0, 3e6),
    "celluloid shell": (2e-2, 84.0, 2e9),
    "wrecking ball": (0.5, 7800.0, 200e9),
}
"""Radius (m), density (kg/m3), Young's modulus (Pa)."""


def said(*bead):
    return " ".join([impossible(*bead), *unlikely(*bead)])


@pytest.mark.parametrize(("radius", "density", "modulus"), BEADS.values(), ids=BEADS)
def test_beads_of_real_materials_are_likely_and_those_of_wrong_units_are_not(radius, density, modulus):
    assert impossible(radius, density, modulus) == ""
    assert unlikely(radius, density, modulus) == []
    assert "GPa is" in said(radius, density, 1e-9 * modulus)
    if density > 2300.0:
        assert "MPa is" in said(radius, density, 1e-6 * modulus)
    if density > 900.0:
        assert "g/cm3 is" in said(radius, 1e-3 * density, modulus)
        assert impossible(radius, 1e3 * density, modulus).startswith("density: ")
    if radius >= 1e-3:
        assert "mm is" in said(1e3 * radius, density, modulus)
