"""Numbers that the scene reference states of beads with flat ends and of bars."""

import re
from pathlib import Path

import pytest

import granchain
import lammps_inputs
from lammps_inputs import strict_yaml

PAGE = Path(lammps_inputs.__file__).parent / "SCENES.md"


def test_cylinders_with_flat_ends_have_the_stated_pulse(tmp_path):
    section = PAGE.read_text(encoding="utf-8").partition("**Flat ends.**")[2]
    text = " ".join(re.split(r"\n\n(?=<!--|An entry)", section)[0].split())
    keys = strict_yaml.parse("\n".join(re.findall(r"`([a-z]+: [^`]+)`", text)), "Flat ends")
    case = {"name": "case", **keys, "beads": 60, "kick": {"velocity": 0.3}, "until_bead": 55}
    waves = granchain.run(case, tmp_path / "run", engine="reference").analysis.waves
    pulse = waves.where(waves.bead == 40)
    assert pulse.peak_velocity == pytest.approx(0.20438, abs=5e-6)
    assert pulse.speed == pytest.approx(61_971, rel=3e-5)
    assert "0.20438 m/s" in text
    assert "61,971 beads/s" in text


@pytest.mark.slow
def test_a_bead_of_a_linear_chain_sees_the_far_end_when_the_manual_says(tmp_path):
    # strains travel at sqrt(k / m) = 1 at most
    def run(beads):
        scene = {"name": "bar", "beads": beads, "contact": {"force": "k*s", "k": 1, "tension": "allowed"}}
        scene |= {
            "push": {"peak": 0.01, "duration": 20, "shape": "half-sine"},
            "duration": 130.0,
            "output": {"every": 0.5},
        }
        return granchain.run(scene, tmp_path / str(beads), engine="reference").si

    short, long = run(50), run(120)
    apart = abs(short.velocity[:, 0, 24] - long.velocity[:, 0, 24])
    largest = abs(long.velocity[:, 0, 24]).max()
    reflected = 2 * 50 - 25
    assert apart[short.time < reflected - 5].max() < 0.02 * largest
    assert apart[short.time > reflected + 5].max() > 0.5 * largest
