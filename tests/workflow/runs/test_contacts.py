"""What is said of the contacts of SI runs."""

import numpy as np
import pytest
from stock_lammps import scene

from lammps_inputs import Kick, Material, Output, strict_yaml
from lammps_inputs.limits import solids
from workflow.cli import main
from workflow.runs.contacts import at_most, measure
from workflow.runs.run import run

pytestmark = pytest.mark.usefixtures("lammps_here")

STEEL = Material(radius=4.76e-3, density=8000.0, youngs_modulus=193e9, poisson_ratio=0.3)


def steel(velocity=1.0, **changes):
    """Two beads for a contact's time; frames 0.1 T apart."""
    kick = changes.pop("kick", (Kick(velocity=velocity),))
    fastest = max(abs(hit.velocity) for hit in kick)
    time = scene(material=STEEL, kick=(Kick(velocity=fastest),)).scale.time
    every = changes.pop("every", 0.1) * time
    return scene(material=STEEL, kick=kick, duration=3.0 * time, output=Output(every=every), **changes)


def written(scene, path):
    path.write_text(strict_yaml.dump(scene.plain()))
    return str(path)


def test_two_steel_balls_press_as_hard_as_hertz_says(tmp_path):
    """At 1 m/s: overlap (5/8)^0.4 L, L = 12.2 um; F = A overlap^1.5; 1.4 N of 222 N are what frames fall short by."""
    result = run(steel(), tmp_path / "run", check=False)
    found = measure(result.directory)
    overlap = 0.625**0.4 * result.directory.problem.scale.length
    assert found.measured
    assert found.overlap == pytest.approx(overlap / 4.76e-3, rel=0.0025)
    assert found.force == pytest.approx(6.898e9 * overlap**1.5, rel=0.0045)
    assert found.pressure == pytest.approx(1.5 * found.force / (3.141592653589793 * 4.76e-3 / 2 * overlap), rel=0.003)
    assert found.yield_strength == pytest.approx(found.pressure / 1.6, rel=1e-14)


@pytest.mark.parametrize(
    ("kind", "radius_share", "stiffness"), [("rigid", 1.0, 1.0), ("flat", 1.0, 0.5), ("bead", 0.5, 0.5)]
)
def test_a_sphere_presses_on_a_wall_as_hard_as_hertz_says(kind, radius_share, stiffness, tmp_path):
    """A sphere flies at a wall (Chung and Ooi 2011, test 2): overlap ``(15 m v**2 / (16 E* R*^0.5))**0.4``.

    Frames are at most 0.01 T from the maximum, where the overlap is less by ``1e-4 T**2 * overlap**1.5 * 2**1.5 / 2``.
    """
    gap = 1e-6
    flying = steel(beads=2, gap=gap, walls={"right": kind}, kick=(Kick(bead=2, velocity=1.0),), every=0.02)
    found = measure(run(flying, tmp_path / "run", check=False).directory)
    modulus, radius = stiffness * 193e9 / (1.0 - 0.3**2), radius_share * STEEL.radius
    mass = 4.0 / 3.0 * np.pi * STEEL.radius**3 * 8000.0
    overlap = (15.0 * mass / (16.0 * modulus * radius**0.5)) ** 0.4
    force = 4.0 / 3.0 * modulus * radius**0.5 * overlap**1.5
    assert found.overlap == pytest.approx(overlap / STEEL.radius, rel=5e-4)
    assert found.force == pytest.approx(force, rel=1e-3)
    assert found.pressure == pytest.approx(1.5 * force / (np.pi * radius * overlap), rel=5e-4)
    bound = at_most(flying)
    assert (bound.overlap, bound.force) >= (found.overlap, found.force)


@pytest.mark.parametrize(("velocity", "warned"), [(120.0, False), (140.0, True)])
def test_a_warning_is_printed_from_a_tenth_of_the_radius_on(velocity, warned, tmp_path, capsys):
    """The overlap of steel is 1.912 R (V / c)^0.8, c = 4912 m/s: a tenth at 123 m/s in two beads."""
    path = written(steel(velocity), tmp_path / "a.yaml")
    assert main(["run", path, "-o", str(tmp_path / "out"), "--no-check"]) == 0
    assert ("overlaps are too large for Hertz's law" in capsys.readouterr().out) is warned


def test_overlaps_of_a_radius_make_a_failed_run(tmp_path, capsys):
    """Springs so stiff that the bound from below leaves it open; without them it would be refused."""
    kicks = (Kick(velocity=2100.0), Kick(bead=2, velocity=-2100.0))
    unit = scene(material=STEEL, kick=(Kick(velocity=1.0),)).scale
    stiffness = 1.0 * unit.stiffness * 2100.0**0.4
    through = steel(kick=kicks, chains=2, kappa=stiffness)
    problem = through.problem()
    low, _ = solids.overlap_bounds(problem.system)
    assert low * through.scale.length / STEEL.radius < solids.FLATTENED
    assert main(["run", written(through, tmp_path / "a.yaml"), "-o", str(tmp_path / "out"), "--no-check"]) == 1
    assert "so this is not a motion of such beads; are all numbers in SI units" in capsys.readouterr().out
