"""A gap (eq. 2) through LAMMPS, the reference, the command line and the end of a run."""

import numpy as np
import pytest
from stock_lammps import scene

from analysis.sharing.impulses import measure
from lammps_inputs import Material, file_names, find, physics
from lammps_inputs.decks import scene_files
from lammps_inputs.limits.closing import gap_of_eq_5, theta
from workflow.cli import main
from workflow.engines.reference import engine
from workflow.prepare.duration import with_duration
from workflow.runs.run import run

pytestmark = pytest.mark.usefixtures("lammps_here")

VERLET_ERROR = 1.5e-5
"""Of velocities at the default step after a way of 120 beads."""

STEEL = Material(radius=4.76e-3, density=8000.0, youngs_modulus=193e9, poisson_ratio=0.3)


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


def test_a_gap_that_is_absent_leaves_no_trace_in_the_deck():
    absent, zero, there = (scene_files.render(scene(beads=5, **gap)) for gap in ({}, {"gap": 0.0}, {"gap": 0.5}))
    assert absent == zero
    assert not any("gap" in text for text in absent.values())
    assert "gap 0.5" in there[file_names.DECK]
    assert there[file_names.DATA] != absent[file_names.DATA]
    # and one that is there changes titles, positions and how far neighbours are looked for, and no other line
    lines = zip(absent[file_names.DECK].splitlines(), there[file_names.DECK].splitlines(), strict=True)
    assert [a.split()[0] for a, b in lines if a != b] == ["#", "neighbor"]


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


def test_show_tells_theta_and_the_gap_of_eq_5(capsys):
    assert main(["show", "two-chains-gapped"]) == 0
    out = capsys.readouterr().out
    assert "# theta = omega D / V = 1.2854, " in out
    assert "#   eq. 5 has theta = 1.2854, which is a gap of 2.87424\n" in out


def test_show_tells_the_gap_of_eq_5_in_the_units_of_the_scene(tmp_path, capsys):
    unit = scene(material=STEEL).scale
    path = tmp_path / "steel.yaml"
    path.write_text(
        "name: steel\nchains: 2\nbeads: 10\nkick: {velocity: 1.0}\nduration: 1e-3\n"
        "material: {radius: 4.76e-3, density: 8000, youngs_modulus: 193e9, poisson_ratio: 0.3}\n"
        f"coupling: {{stiffness: {0.1 * unit.stiffness!r}}}\ngap: 1e-5\n"
    )
    assert main(["show", str(path)]) == 0
    assert f"which is a gap of {gap_of_eq_5(0.1) * unit.length:.6g} m\n" in capsys.readouterr().out


def test_show_says_nothing_of_gaps_where_there_is_none(capsys):
    assert main(["show", "two-chains"]) == 0
    assert "theta" not in capsys.readouterr().out
