"""Contacts of other exponents: law, scale, deck, LAMMPS and reference against an integrator of their own."""

import re
import subprocess

import numpy as np
import pytest
from processes import HANGS
from stock_lammps import DEBIAN
from wrong_runs import deck_run

from analysis.shape.exact_wave import solitary_wave
from lammps_inputs import InputError, Scene, file_names, laws, library
from lammps_inputs.decks import deck
from lammps_inputs.facts import Fact
from lammps_inputs.laws.hertz import Hertz
from lammps_inputs.laws.power import Power
from lammps_inputs.limits import rates
from workflow.runs.run import run
from workflow.sweep.fields import all_fields
from workflow.verdicts.analyse import analyse
from workflow.verdicts.validate import validate

pytestmark = pytest.mark.usefixtures("lammps_here")

STEEL = {"radius": 4.76e-3, "density": 8000.0, "youngs_modulus": 193e9, "poisson_ratio": 0.3}


def touching(exponent, **changes):
    """Two coupled chains, so that all tests share one compiled kernel."""
    plain = {
        "name": "test",
        "chains": 2,
        "beads": 8,
        "contact": {"exponent": exponent},
        "coupling": {"stiffness": 0.1},
        "kick": {"velocity": 1.0},
        "duration": 15.0,
        "output": {"every": 0.5},
    }
    return library.from_plain({key: value for key, value in {**plain, **changes}.items() if value is not None}, "test")


@pytest.mark.parametrize("exponent", [1.0, 1.25, 2.0, 3.0])
def test_force_and_stiffness_are_slopes_and_reach_is_where_the_energy_is(exponent):
    law, s, h = Power(1.7, exponent), np.array([-0.5, 0.3, 1.2]), 1e-5
    slope = (laws.energy(law, s + h) - laws.energy(law, s - h)) / (2.0 * h)
    assert laws.force(law, s) == pytest.approx(slope, abs=1e-9)
    slope = (laws.force(law, s + h) - laws.force(law, s - h)) / (2.0 * h)
    assert laws.stiffness(law, s) == pytest.approx(slope, abs=1e-8)
    assert laws.energy(law, laws.reach(law, 0.7)) == pytest.approx(0.7, rel=1e-14)


def test_at_hertz_s_exponent_the_law_is_hertz_s_to_rounding():
    s = np.linspace(-0.2, 1.5, 50)
    for of in (laws.force, laws.energy, laws.stiffness):
        assert of(Power(1.3, 1.5), s) == pytest.approx(of(Hertz(1.3), s), rel=1e-14)


def test_the_exponent_of_spheres_leaves_deck_and_problem_as_they_are():
    named, plain = touching(1.5).problem(), touching(1.5, contact=None).problem()
    assert named == plain
    assert (deck.render_deck(named), deck.render_data(named)) == (deck.render_deck(plain), deck.render_data(plain))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("exponent", "amplitude", "coefficient"), [(1.25, 0.57734, 0.94668), (3.0, 0.90128, 0.80476)], ids=str
)
def test_a_kicked_chain_has_the_published_amplitude_and_law_of_speed(tmp_path, exponent, amplitude, coefficient):
    """Both chains are hit, so that they move as one alone."""
    kicks = [{"chain": 1, "velocity": 1.0}, {"chain": 2, "velocity": 1.0}]
    found = run(touching(exponent, beads=50, kick=kicks, duration=62.0, output={"every": 0.2}), tmp_path / "run")
    seen = analyse(found.directory, figures=False)
    (leading,) = (c for p, c in zip(seen.survey.pulses, seen.survey.characters, strict=True) if p.chain == 1)
    assert leading.peak_velocity == pytest.approx(amplitude, abs=found.check.amplitude + 1e-5)
    law = leading.speed / leading.peak_velocity ** ((exponent - 1.0) / (exponent + 1.0))
    assert law == pytest.approx(coefficient, abs=3e-5)
    assert law == pytest.approx(solitary_wave(exponent).speed, abs=3e-5)
    assert leading.solitary


def test_linear_contacts_carry_no_pulse(tmp_path):
    for exponent, leads in ((1.0, False), (1.04, False), (1.06, True)):
        assert touching(exponent).problem().system.holds(Fact.PULSE) == leads
    found = analyse(run(touching(1.0), tmp_path / "run", check=False).directory, figures=False)
    assert "does not apply" in found.survey.verdict.sentence
    assert found.conservation.energy_drift < 1e-4


def test_a_pulse_is_no_faster_than_a_bead_a_unit_of_time_whatever_the_exponent():
    assert [rates.pace(touching(p).system) for p in (1.0, 1.25, 1.5, 2.0, 3.0)] == [1.0] * 5


def test_an_accuracy_is_kept_with_another_exponent(tmp_path):
    asked = touching(2.0, accuracy=1e-3, duration=10.0)
    assert run(asked, tmp_path / "run").check.velocity <= 1e-3


@pytest.mark.skipif(not DEBIAN.exists(), reason="needs Debian's LAMMPS")
def test_the_2021_release_says_in_one_line_what_it_cannot_do_and_does_linear_contacts(tmp_path):
    said = {}
    for exponent in (1.0, 2.0):
        folder = tmp_path / str(exponent)
        folder.mkdir()
        deck.write(touching(exponent), folder)
        done = subprocess.run(
            [DEBIAN, "-in", file_names.DECK], cwd=folder, capture_output=True, text=True, timeout=HANGS
        )
        said[exponent] = done.stdout
    assert "need LAMMPS of 15Jun2023 or later" in said[2.0].splitlines()[-1]
    assert "Total wall time" in said[1.0]


def test_in_si_units_lengths_are_those_of_the_exponent():
    case = touching(2.0, material=STEEL, contact={"exponent": 2, "stiffness": 1e10}, coupling={"stiffness": 1e6},
                    duration=1e-3, output={"every": 1e-5}, kick={"velocity": 2.0})  # fmt: skip
    mass = 4.0 / 3.0 * np.pi * STEEL["radius"] ** 3 * STEEL["density"]
    assert case.scale.length == pytest.approx((mass * 4.0 / 1e10) ** (1.0 / 3.0), rel=1e-14)
    # a force of A L**2 is one of m V / T
    assert case.scale.force == pytest.approx(1e10 * case.scale.length**2, rel=1e-13)
    assert case.problem().system.along[0].law == Power(1.0, 2.0)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"contact": {"exponent": 0.9}}, "contact.exponent: should be greater than or equal to 1, 0.9 given"),
        ({"contact": {"exponent": 3.1}}, "contact.exponent: should be less than or equal to 3, 3.1 given"),
        ({"material": STEEL}, "contact.stiffness: is missing"),
        (
            {"material": STEEL, "contact": {"exponent": 1.5, "stiffness": 1e9}},
            "contact.stiffness: the material says how stiff",
        ),
        (
            {"walls": {"right": "flat"}},
            "walls.right: how hard a flat wall is is known for spheres, of exponent 1.5, not 2",
        ),
        ({"walls": {"left": "rigid"}}, "walls.left: how hard a rigid wall is is known for spheres"),
        ({"taper": 0.02}, "contact.exponent: 2 given; how the contacts of beads of unlike radius"),
        ({"contact": {"exponent": 1.2}, "scheme": "suzuki4"}, "contact: contacts of an exponent below 1.5 open"),
    ],
    ids=lambda value: re.sub(r"\W+", "-", str(value))[:40],
)
def test_what_cannot_be_is_refused_in_one_line(changes, said):
    with pytest.raises(InputError) as error:
        touching(2.0, **changes)
    assert said in str(error.value)
    assert len(str(error.value).splitlines()) == 1


def test_masses_may_differ():
    kinds = {"kinds": {"light": {"mass": 0.5, "radius": 1.0}}, "pattern": ["light"]}
    assert np.all(touching(2.0, **kinds).problem().system.mass == 0.5)


def test_validate_names_another_exponent(tmp_path):
    def changed(path):
        text = (path / file_names.DECK).read_text()
        assert '"0.3333333333333333*(4-r)^3"' in text
        (path / file_names.DECK).write_text(text.replace('"0.3333333333333333*(4-r)^3"', '"(4-r)^3.1/3.1"'))

    case = touching(2.0, output={"every": 0.1})
    assert (
        "the contacts have the exponent 2.100 instead of 2"
        in validate(deck_run(case, tmp_path / "run", changed)).causes
    )


def test_a_sweep_may_vary_the_exponent():
    assert "contact.exponent" in all_fields(Scene)
