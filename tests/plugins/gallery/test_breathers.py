"""What the gallery says of breathers, of the chain that rectifies and of foundations in time, against theory."""

import math

import numpy as np
import pytest

from lammps_inputs import library
from workflow.plugins.derivatives import tangent
from workflow.plugins.gallery.entries import breathers, mode_beats, rectifier
from workflow.plugins.gallery.entry import Ran, chain
from workflow.plugins.modes.linear import linear_modes
from workflow.study_kit.kept_run import kept_run

pytestmark = pytest.mark.usefixtures("lammps_here", "pool_here")


def test_alternating_motion_softens_as_a_duffing_oscillator():
    # x'' = -6 x + x^3 + order 5, so that omega = omega_0 - 3 a^2 / (8 omega_0) + order 4
    for amplitude in (0.02, 0.04):
        expected = breathers.EDGE - 0.375 * amplitude**2 / breathers.EDGE
        assert breathers._alternating(amplitude) == pytest.approx(expected, abs=amplitude**4)


def test_the_light_beads_mode_is_the_highest_of_a_chain_beside_a_bead_at_rest():
    light = {"kinds": {"light": {"mass": rectifier.DEFECT}}, "replace": [{"bead": 1, "kind": "light"}]}
    plain = chain(
        30, 1.0, precompression=rectifier.LOAD, walls={"left": "bead", "right": "rigid"}, name="light", **light
    )
    highest = linear_modes(tangent.problem_of(plain, "light"), "light").frequency[-1]
    assert rectifier._defect_frequency() == pytest.approx(highest, rel=1e-9)
    assert rectifier.CUT_OFF < rectifier.DRIVE < highest


@pytest.mark.slow
@pytest.mark.parametrize(("beads", "heavy"), [(13, True), (15, False)])
def test_in_shorter_chains_too_the_heavy_centred_breather_alone_is_unstable_wherever_it_is_narrow(beads, heavy):
    family = breathers.lowest_optical(beads, 5.0)
    narrow = family.participation < 4.0
    assert np.count_nonzero(narrow) > 5
    assert np.any(family.stable[narrow]) != heavy
    assert len(family.changes("fold")) == (0 if heavy else 2)
    assert family.frequency.min() > breathers.ACOUSTIC


def test_the_exchange_of_coupled_oscillators_becomes_slow_near_the_threshold():
    # averaging: pi / (2 K(k)) is 1 - k^2 / 4 for small k, and 0 at k = 1
    threshold = 2.0 * mode_beats._threshold()
    weak = mode_beats._slowing(0.1)
    assert weak == pytest.approx(1.0 - 0.25 * (0.01 / threshold) ** 2, abs=1e-7)
    assert mode_beats._slowing(math.sqrt(0.999999 * threshold)) < 0.25
    # first order in the coupling: the mode loses its stability at a^2 = 4 kappa / 3, of energy 2 omega^2 a^2
    assert mode_beats._threshold() == pytest.approx(2.0 * 7.0 * 4.0 * mode_beats.KAPPA / 3.0, rel=0.05)


@pytest.mark.slow
def test_power_passes_from_the_side_of_the_light_bead_only(tmp_path):
    forces = {}
    for side in rectifier.SIDES:
        scene = library.from_plain({"name": side, **rectifier._driven(side, rectifier.ABOVE), "duration": 300.0}, side)
        forces[side] = rectifier._rms(Ran(kept_run(scene, "reference", tmp_path / side).path))
    assert (forces["near"] / forces["far"]) ** 2 > 1e4
