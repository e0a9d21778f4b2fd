"""What is said of a run does not depend on the strength of the contacts, but for the time in which pulses pass."""

import numpy as np
import pytest

import granchain
from analysis.contacts import shown_by_frames
from lammps_inputs import physics
from lammps_inputs.output import too_far_apart
from workflow.cli import main
from workflow.engines.reference.engine import usual_timestep
from workflow.prepare.duration import with_duration
from workflow.prepare.window_width import with_window
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


@pytest.mark.parametrize("strength", [1e-4, 1e4])
def test_durations_windows_and_times_between_frames_are_those_of_pulses(strength):
    factor = strength**0.4
    changes = {"beads": 120, "duration": None, "until_bead": 60, "window": "auto", "output": {}}
    plain, other = (with_window(with_duration(of_strength(each, **changes))) for each in (1.0, strength))
    assert plain.window == other.window
    first, second = plain.problem(), other.problem()
    assert second.every * factor == pytest.approx(first.every)
    assert second.duration * factor == pytest.approx(first.duration, abs=1.01 * first.every)  # in whole frames
    assert usual_timestep(second) * factor == pytest.approx(usual_timestep(first))
    for apart, shown in ((0.25, True), (0.26, False)):
        assert shown_by_frames(of_strength(strength, output={"every": apart / factor}).problem()) is shown
    for apart, refused in ((1.9, False), (2.1, True)):
        assert bool(too_far_apart(apart / factor, second.scale, physics.pulse_time(second.system))) is refused


def test_the_bead_from_which_chains_should_agree_is_that_of_strength_1(tmp_path, capsys):
    sentences = []
    for strength in (1.0, 1e4):
        scene = of_strength(strength, duration=30.0 / strength**0.4)
        granchain.analyze(granchain.run(scene, tmp_path / f"{strength:g}"))
        assert main(["analyze", str(tmp_path / f"{strength:g}"), "--no-figures"]) == 0
        sentences.append([line for line in capsys.readouterr().out.splitlines() if "should agree" in line])
    assert sentences[0] == sentences[1] != []
