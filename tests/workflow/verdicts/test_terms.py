"""Terms of verdicts, and the numbers that the manual quotes: each is that of the program."""

import math
import re
from pathlib import Path

import pytest

from analysis.shape.exact_wave import solitary_wave
from analysis.sharing.verdict import SINGLE_CHAIN
from analysis.tracking.undisturbed import APART
from lammps_inputs import physics
from lammps_inputs.window import LEAST_WINDOW
from workflow.prepare.window_width import SAME, WIDEST
from workflow.verdicts import terms, validate

ROOT = Path(__file__).parents[3]


def test_a_pulse_is_clear_of_another_where_the_exact_wave_has_ended():
    assert f"{solitary_wave().velocity(APART):.0e}" == "8e-11"
    assert "1e-10" in terms.TERMS["clear of other pulses"]


def test_rounded_numbers_of_the_code_are_those_of_the_exact_wave():
    wave = solitary_wave()
    duration = wave.width / float(wave.speed_at(SINGLE_CHAIN))
    assert pytest.approx(math.pi / duration, abs=5e-3) == physics.PULSE_RATE


@pytest.mark.parametrize(
    ("page", "quoted"),
    [
        ("lammps_inputs/MODEL.md", ["0.6816", "0.8405", "1.58 beads"]),
        ("lammps_inputs/SCENES.md", ["1.67 / T"]),
        ("workflow/tutorials/first-hour.md", ["0.6816", "1.138"]),
        ("workflow/tutorials/steel-balls.md", ["0.6396"]),
    ],
)
def test_numbers_that_the_manual_quotes_are_those_of_the_theory(page, quoted):
    text = (ROOT / page).read_text(encoding="utf-8")
    for number in quoted:
        assert number in text
        value, _, unit = number.partition(" ")
        digits = len(value.partition(".")[2])
        assert any(
            f"{float(known.value.split()[0]):.{digits}f}" == value and unit in known.value for known in terms.numbers()
        )


def test_the_criterion_of_a_windows_width_is_that_of_the_program():
    section = (ROOT / "lammps_inputs" / "SCENES.md").read_text(encoding="utf-8")
    quoted = re.search(r"doubled from (\d+)\s+on.* to\s+(\S+)\s+V; at\s+most\s+(\d+)\.", section, re.S)
    assert tuple(map(float, quoted.groups())) == (LEAST_WINDOW, SAME, WIDEST)


def test_tolerances_of_a_validation_are_those_of_the_program():
    text = " ".join((ROOT / "workflow" / "README.md").read_text(encoding="utf-8").split())
    listed = re.search(r"in units of V, T and L: (.*?); (amplitude .*?) with dashpots in contacts", text)
    for quoted, limits in zip(listed.groups(), (validate.TOLERANCES, validate.FIRST_ORDER), strict=True):
        found = {
            name: float(value) for name, value in re.findall(r"(\w+) (\d\S*?)(?:[, (]|$)", quoted) if name in limits
        }
        assert found == limits
