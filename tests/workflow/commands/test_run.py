"""What `run` prints of a run's error: hand-made numbers, with place, time and unit."""

from types import SimpleNamespace

import pytest
from stock_lammps import scene

from analysis.against.difference import Place
from lammps_inputs import Kick, Material
from workflow.commands.run import _checked
from workflow.runs.check import Check

STEEL = Material(radius=4.76e-3, density=8000.0, youngs_modulus=193e9, poisson_ratio=0.3)


@pytest.mark.parametrize("material", [None, STEEL], ids=["reduced", "SI"])
def test_the_error_is_told_with_its_bead_and_time_in_the_scenes_units(material):
    problem = scene(beads=10, kick=(Kick(velocity=0.5),), material=material).problem()
    uncertainty = SimpleNamespace(velocity=8.5e-6, arrival=2.9e-5)
    said = _checked(Check(1.6e-4, Place(2, 7, 160.0), 5.7e-4, 6.3e-6, uncertainty, 0.0), problem)
    second = " s" if material else ""
    assert said == (
        f"error: velocities 1.6e-04 V (bead 7 of chain 2, t = {160.0 * problem.scale.time:.5g}{second}), "
        "peaks 6.3e-06 V, arrivals 5.7e-04 T; uncertainty of the reference 8.5e-06 V, 2.9e-05 T"
    )
