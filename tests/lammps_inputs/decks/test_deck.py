"""The deck, run by stock LAMMPS: every way to a silent wrong answer that applies to it is closed."""

import math
import re
import subprocess

import numpy as np
import pytest
from executables import RELEASES
from stock_lammps import run, scene, table

from lammps_inputs import Kick, file_names, find, installed_scenes, physics
from lammps_inputs.decks import deck, scene_files
from workflow.engines.lammps import worker

CONTACT_TIME = 2 * (5 / 8) ** 0.4 * math.sqrt(math.pi) * math.gamma(1.4) / math.gamma(0.9)
"""Of two beads of mass 1 that meet at V = 1: r'^2 = 1 - 8/5 r^2.5 integrated; 2.438838."""

EXACT = "dump_modify exact format float %.17g"
FIVE_KICKS = tuple(Kick(bead=bead, velocity=1.0) for bead in range(1, 6))


def coupled_pair(**changes):
    """Two rows so far apart that they never meet; bead 1 of chain 1 is hit: one free spring with two beads."""
    return scene(chains=2, gap=60.0, timestep=0.125, every=0.125, duration=50.0, **changes)


# --- the coupling -----------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_coupled_chains_stay_on_their_lines_to_the_last_bit(tmp_path):
    text = f"dump exact all custom 1 y.txt id y z\n{EXACT}"
    result = run(scene(chains=3, beads=9, kappa=0.5, duration=5.0), tmp_path / "run", before_run=text)
    sideways = table(result.directory / "y.txt")[:, :, 1:]
    assert (sideways == sideways[0]).all()
    assert (np.unique(sideways[0, :, 0]) == [0.0, 8.0, 16.0]).all()


# --- the beads --------------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(
    ("chains", "kicks", "diameter"),
    [(2, FIVE_KICKS[:1], 4.0), (1, FIVE_KICKS, 8.0)],
    ids=["coupled, one kick", "five kicks"],
)
def test_touching_beads_at_rest_have_mass_exactly_1_and_their_radius_and_feel_exactly_nothing(
    chains, kicks, diameter, tmp_path
):
    text = f"dump exact all custom 1 beads.txt id mass radius fx fy fz\n{EXACT}"
    still = [word for number in range(1, len(kicks) + 1) for word in ("-var", f"kick{number}", 0)]
    case = scene(chains=chains, beads=60, kappa=0.1, kick=kicks, duration=0.5)
    result = run(case, tmp_path / "run", *still, before_run=text)
    assert (table(result.directory / "beads.txt")[:, :, 1:] == [1.0, diameter / 2, 0.0, 0.0, 0.0]).all()
    assert (result.displacement == 0.0).all()
    assert (result.velocity == 0.0).all()


@pytest.mark.slow
@pytest.mark.parametrize("kicks", [FIVE_KICKS[:1], FIVE_KICKS], ids=["diameter 4", "diameter 8"])
def test_touching_beads_repel_each_other_by_the_overlap_to_the_power_3_over_2_from_its_first_bit(kicks, tmp_path):
    """One step of 2^-20 at V = 1 closes the contact ahead of the last bead hit by exactly 2^-20."""
    step, last = 2.0**-20, len(kicks)
    text = f"dump exact all custom 1 forces.txt id fx\n{EXACT}"
    case = scene(beads=last + 1, kick=kicks, timestep=step, every=step, duration=step)
    result = run(case, tmp_path / "run", before_run=text)
    forces = np.zeros(last + 1)
    forces[-2:] = -(step**1.5), step**1.5
    np.testing.assert_allclose(table(result.directory / "forces.txt")[1, :, 1], forces, rtol=1e-14)


# --- the motion -------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def two_beads(tmp_path_factory):
    return [
        run(scene(timestep=step, every=step, duration=4.0), tmp_path_factory.mktemp("two") / "run")
        for step in (0.01, 0.005)
    ]


@pytest.mark.slow
def test_two_beads_touch_for_the_published_time_and_exchange_velocity(two_beads):
    """Afterwards bead 2 moves at 1 from where they parted, so that x2 - x1 = t - contact time."""
    assert pytest.approx(2.438838, abs=5e-7) == CONTACT_TIME
    ends = [(result.displacement[-1, 0], result.velocity[-1, 0]) for result in two_beads]
    late = [abs(4.0 - (x[1] - x[0]) - CONTACT_TIME) for x, _ in ends]
    slow = [np.abs(v - [0.0, 1.0]).max() for _, v in ends]
    assert all(fine < min(1e-5, coarse / 3) for coarse, fine in (late, slow))


def test_two_beads_overlap_at_most_by_the_published_amount(two_beads):
    """A sample is at most h/2 from the largest overlap, where it is (5/8)^0.4 - overlap'' (h/2)^2 / 2."""
    fine = two_beads[1]
    largest = (fine.displacement[:, 0, 0] - fine.displacement[:, 0, 1]).max()
    bend = 2 * (5 / 8) ** 0.6
    assert largest == pytest.approx((5 / 8) ** 0.4, abs=bend * 0.005**2 / 8 + 1e-5)


# --- nothing is lost --------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(("bead", "sign"), [(1, -1.0), (4, 1.0)], ids=["backwards", "forwards"])
def test_a_bead_thrown_off_the_end_is_followed_however_far(bead, sign, tmp_path):
    case = scene(beads=4, kick=(Kick(bead=bead, velocity=sign),), timestep=0.5, every=500.0, duration=1e5)
    result = run(case, tmp_path / "run")
    assert result.id.tolist() == [[1, 2, 3, 4]] * 201
    expected = np.zeros((201, 4))
    expected[:, bead - 1] = sign * 500.0 * np.arange(201)
    assert (result.displacement[:, 0] == expected).all()  # every number is a multiple of 1/2: no rounding


@pytest.mark.slow
def test_the_list_of_neighbours_built_once_gives_bit_for_bit_what_one_built_each_step_gives(tmp_path):
    case = scene(chains=2, beads=12, kappa=0.1, gap=0.5, duration=40.0, kick=FIVE_KICKS[:1])
    once = run(case, tmp_path / "once")
    always = run(case, tmp_path / "always", replace=("modify once yes", "modify every 1 delay 0 check no"))
    assert "Neighbor list builds = 0" in once.log
    assert (always.x == once.x).all()
    assert (always.vx == once.vx).all()


@pytest.mark.slow
@pytest.mark.parametrize("gap", [0.0, 0.909, 50.0])
def test_every_contact_of_a_chain_is_a_neighbour_and_nothing_else_nor_an_image(gap, tmp_path):
    result = run(scene(chains=3, beads=12, kappa=0.1, gap=gap, duration=0.1), tmp_path / "run")
    assert f"Total # of neighbors = {3 * 11}\n" in result.log
    assert re.search(r"^Nghost: +0 ave", result.log, flags=re.MULTILINE)


# --- variables and output ---------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(
    ("asked", "other", "option"),
    [
        (coupled_pair(kappa=0.4), coupled_pair(kappa=0.1), ("kappa", 0.4)),
        (
            scene(timestep=0.005, every=0.05, duration=2.0),
            scene(timestep=0.01, every=0.1, duration=4.0),
            ("timestep", 0.005),
        ),
    ],
    ids=["kappa", "timestep"],
)
def test_a_number_given_on_the_command_line_is_one_given_in_the_scene(asked, other, option, tmp_path):
    here, there = run(asked, tmp_path / "scene"), run(other, tmp_path / "option", "-var", *option)
    assert (here.x == there.x).all()
    assert (here.vx == there.vx).all()


@pytest.mark.slow
def test_each_kick_goes_to_its_own_chain_and_bead_also_from_the_command_line(tmp_path):
    kicks = (Kick(chain=2, bead=3, velocity=1.0), Kick(chain=3, bead=1, velocity=-0.5))
    expected = np.zeros((3, 4))
    expected[1, 2], expected[2, 0] = 1.0, -0.5
    case = scene(chains=3, beads=4, kick=kicks, duration=0.1)
    assert (physics.initial_velocity(case.problem().system) == expected).all()
    expected[2, 0] = 0.25
    assert (run(case, tmp_path / "run", "-var", "kick2", 0.25).velocity[0] == expected).all()


@pytest.mark.slow
@pytest.mark.parametrize("release", RELEASES)
def test_the_longest_run_that_a_scene_may_ask_for_fits_the_integers_of_lammps(release, lmp_of, tmp_path):
    longest = scene(timestep=0.01, every=1e6, duration=1e10)
    assert (longest.problem().steps, longest.problem().steps_per_frame) == (10**12, 10**8)
    scene_files.write(longest, tmp_path)
    words = [lmp_of(release), "-in", file_names.DECK, "-skiprun"]
    subprocess.run(words, cwd=tmp_path, check=True, capture_output=True)


# --- the text ---------------------------------------------------------------------------------------------------------


OF_SCENES = ("two-chains-steel", "precompressed", "resonators", "magnets", "driven-chain", "damped-contacts", "dimer")
OF_SCENES += ("landau-zener", "plastic-contacts", "lattice-of-nine", "wall-reflection", "half-sine-push")


@pytest.mark.parametrize("name", OF_SCENES)
def test_the_deck_of_an_installed_scene_is_the_golden_text(name, golden):
    golden(name, deck.render_deck(find(name).problem()))


@pytest.mark.parametrize("name", installed_scenes.installed())
def test_the_decks_of_installed_scenes_are_read_by_lammps(name, tmp_path, monkeypatch):
    scene_files.write(find(name), tmp_path)
    monkeypatch.chdir(tmp_path)
    worker.instance(part=1).close()
    warnings = [line for line in (tmp_path / file_names.LOG).read_text().splitlines() if "WARNING" in line]
    # of `hybrid sphere bond`, of beads whose motion is given, and of a box that follows displaced beads later: as meant
    meant = "only per-atom masses will be used|are time integrated more than once|sub-domain size < neighbor skin"
    assert [line for line in warnings if not re.search(meant, line)] == []
