"""A gap (eq. 2) through LAMMPS, the reference, the command line and the end of a run."""

import numpy as np
import pytest
from stock_lammps import scene

from analysis.sharing.impulses import measure
from lammps_inputs import find, physics
from lammps_inputs.limits.closing import gap_of_eq_5, theta
from workflow.engines.reference import engine
from workflow.prepare.duration import with_duration
from workflow.runs.run import run

pytestmark = pytest.mark.usefixtures("lammps_here")

VERLET_ERROR = 1.5e-5
"""Of velocities at the default step after a way of 120 beads."""


def gapped(gap, **changes):
    return scene(**{"chains": 2, "beads": 12, "kappa": 0.1, "gap": gap, "duration": 40.0 + 20.0 * gap, **changes})


@pytest.mark.slow
@pytest.mark.parametrize(("gap", "kappa"), [(1e-6, 0.1), (2.874, 0.1), (100.0, None)])
def test_lammps_tends_to_the_reference_at_a_gap_as_the_step_squared(gap, kappa, tmp_path):
    every, duration = max(0.1, gap / 1000.0), 20.0 + 20.0 * gap
    errors = []
    for step in (0.02, 0.01):
        case = gapped(gap, kappa=kappa, beads=6, duration=duration, every=every, timestep=step)
        lammps = run(case, tmp_path / f"{step}", check=False).trajectory
        # a velocity after a contact that is off by 1e-8 is off by 1e-5 in place after a gap of 1000
        reference = engine.run(lammps.problem, steps_per_frame=4 * engine.default_steps_per_frame(lammps.problem))
        assert np.abs(reference.velocity[:, :, 5]).max() > 0.05  # the pulse got through
        errors.append(np.abs(lammps.velocity - reference.velocity).max())
    # the next order is h**2.5: off by at most a factor 2**0.5
    assert 2.0**1.5 < errors[0] / errors[1] < 2.0**2.5
    # a velocity off after a contact is a place off after a gap; and Verlet's swings are faster by (omega h)**2 / 24
    omega = (2.0 * (kappa or 0.0)) ** 0.5
    assert errors[1] < (10.0 + gap) * VERLET_ERROR + (omega * 0.01) ** 2 / 24.0 * omega * duration


@pytest.mark.parametrize(("gap", "kappa"), [(2.874, 0.1), (30.0, 0.1), (5.0, 0.001), (3.0, None)])
def test_a_run_until_a_bead_has_all_its_impulses_from_behind(gap, kappa):
    problem = with_duration(gapped(gap, kappa=kappa, beads=30, until_bead=12, duration=None)).problem()
    longer = gapped(gap, kappa=kappa, beads=30, duration=2.0 * problem.duration).problem()
    found, expected = (measure(case, engine.blocks(case)) for case in (problem, longer))
    row = found.row(12)
    assert found.first[:, row].max() > 0.1
    np.testing.assert_allclose(found.first[:, row], expected.first[:, row], rtol=0, atol=1e-6)


@pytest.mark.parametrize(
    ("name", "kappa", "gap"), [("two-chains-gapped", 0.1, 2.874), ("two-chains-gapped-strong", 1.0, 0.909)]
)
def test_the_gapped_scenes_have_the_gap_of_eq_5(name, kappa, gap):
    case = find(name)
    assert physics.kappa(case.problem().system) == kappa
    assert case.gap == gap_of_eq_5(kappa)
    assert case.gap == pytest.approx(gap, abs=5e-4)
    assert theta(physics.kappa(case.system), physics.gap(case.system)) == pytest.approx(1.2854, abs=5e-5)
