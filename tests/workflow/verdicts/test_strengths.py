"""What is said of a run does not depend on the strength of the contacts, but for the time in which pulses pass."""

import numpy as np
import pytest

import granchain
from workflow.cli import main
from workflow.verdicts.validate import TOLERANCES, limits_of


def of_strength(strength, **changes):
    """Two chains whose pulses are those of contacts of strength 1 at another time."""
    factor = strength**0.4
    scene = {
        "name": "strong",
        "chains": 2,
        "beads": 30,
        "contact": {"strength": strength},
        "coupling": {"stiffness": 0.3 * factor**2},
        "kick": {"velocity": 1.0},
        "duration": 42.0 / factor,
        "output": {"every": 0.1 / factor},
    }
    return granchain.load({**scene, **changes})


@pytest.mark.parametrize("strength", [1e-3, 1e4])
def test_a_run_at_the_default_accuracy_passes_and_has_the_amplitudes_of_strength_1(strength, tmp_path, capsys):
    runs = [granchain.run(of_strength(each), tmp_path / f"{each:g}") for each in (1.0, strength)]
    first, other = (granchain.analyze(run).waves for run in runs)
    np.testing.assert_allclose(other.peak_velocity, first.peak_velocity, rtol=0.0, atol=1e-4)
    assert main(["analyze", str(tmp_path / f"{strength:g}"), "--no-figures"]) == 0
    assert "frames are more than" not in capsys.readouterr().out
    assert granchain.validate(runs[1]).passed
    limits = limits_of(of_strength(strength).problem(), None)
    for name, power in (("arrival", -0.4), ("displacement", -0.4), ("force", 0.4), ("velocity", 0.0)):
        assert limits[name] == pytest.approx(TOLERANCES[name] * strength**power), name
