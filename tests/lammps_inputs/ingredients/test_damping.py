"""Damping: restitution, reach of dashpots, stability; the motion is in `test_every_ingredient`."""

import math
import re

import numpy as np
import pytest
from plain_scene import one_chain, scene
from stock_lammps import run

from lammps_inputs import laws, physics
from lammps_inputs.decks import deck
from lammps_inputs.laws.dashpot import alpha
from lammps_inputs.limits import rates
from lammps_inputs.limits.rates import stability_bound
from workflow.engines.reference import engine


def losing(share, **keys):
    """Two beads of a chain whose contacts have a restitution."""
    damping = {"contact": share, "law": "restitution"}
    return one_chain(**{"beads": 2, "output": None, "damping": damping, **keys})


@pytest.mark.parametrize("load", [None, 4.94])
def test_dashpots_between_chains_reach_as_far_as_their_springs_and_not_to_the_next_row(load):
    """Both beads of one chain are kicked, and the spring is so weak that it may take nearly half of their spacing."""
    kicks, pressed = [{"velocity": 1.0}, {"bead": 2, "velocity": 1.0}], load and {"force": load}
    tied = {"coupling": {"stiffness": 0.31}, "damping": {"coupling": 0.1}}
    problem = scene(beads=2, kick=kicks, precompression=pressed, timestep=0.01, **tied).problem()
    cutoff = float(re.findall(r"dpd/ext/tstat 0 0 (\S+)", deck.render_deck(problem))[0])
    beside = 2.0 * problem.layout.diameter
    reach = float(laws.max_strain(problem.system.across[0].law, physics.energy(problem.system)))
    assert reach > 0.45 * problem.layout.spacing or load is None
    assert math.hypot(beside, reach) < cutoff < math.hypot(beside, problem.layout.spacing - reach)


@pytest.mark.slow
@pytest.mark.parametrize(("share", "exponent"), [(0.5, 1.5), (0.7, 1.0), (0.7, 2.0)])
def test_two_beads_part_with_their_restitution(share, exponent, tmp_path):
    step = 0.002 if exponent > 1.0 else 0.0002  # where linear contacts open, their dashpots' force jumps
    asked = losing(share, contact={"exponent": exponent}, duration=10.0, timestep=step, output={"every": 10.0})
    first, second = run(asked, tmp_path / "run").velocity[-1, 0]
    assert second - first == pytest.approx(share, abs=5e-5)


@pytest.mark.slow
@pytest.mark.parametrize("exponent", [1.2, 2.5, 3.0])
@pytest.mark.parametrize("wall", [False, True])
def test_by_the_reference_beads_of_any_exponent_part_with_their_restitution(exponent, wall):
    own = {"kick": {"bead": 2, "velocity": 1.0}, "walls": {"right": {"stiffness": 2.0}}, "duration": 4.5}
    other = {"kick": {"velocity": 1.0}, "duration": 10.0}
    asked = losing(0.7, gap=0.97, contact={"exponent": exponent}, output={"every": 0.1}, **(own if wall else other))
    first, second = engine.run(asked.problem()).velocity[-1, 0]
    assert (-second if wall else second - first) == pytest.approx(0.7, abs=1e-6)


UNEQUAL = {
    "masses": {"kinds": {"light": {"mass": 0.3}, "plain": {"mass": 1.0}}, "pattern": ["light", "plain"]},
    "strengths": {"contact": {"exponent": 1.0, "strength": [2.0, 1.0]}, "beads": 3},
}


@pytest.mark.slow
@pytest.mark.parametrize("name", UNEQUAL)
def test_each_of_linear_contacts_that_differ_has_the_restitution(name, tmp_path):
    """Seen after the first collision, before the next."""
    keys = {"contact": {"exponent": 1.0}, "gap": 0.97, "duration": 2.7, "output": {"every": 2.7}, **UNEQUAL[name]}
    motion = run(losing(0.7, timestep=0.0001, **keys), tmp_path / "run").velocity[-1, 0]
    assert motion[1] - motion[0] == pytest.approx(0.7, abs=5e-5)
    assert not np.any(motion[2:])


HEAVY = {"kinds": {"heavy": {"mass": 3.0}}, "pattern": ["heavy"]}
WALLS = {
    "flat": {"walls": {"right": "flat"}},
    "left, hard": {"walls": {"left": {"stiffness": 20.0}}},
    "heavy bead": {"walls": {"right": {"stiffness": 5.0}}, **HEAVY},
    "linear": {"walls": {"right": {"stiffness": 2.0}}, "contact": {"exponent": 1.0}},
    "square": {"walls": {"right": {"stiffness": 2.0}}, "contact": {"exponent": 2.0}},
}


@pytest.mark.parametrize(
    ("share", "name"),
    [(0.9, "flat"), *(pytest.param(0.7, name, marks=pytest.mark.slow) for name in list(WALLS)[1:])],
)
def test_a_bead_comes_back_from_a_wall_with_its_restitution(share, name, tmp_path):
    """Seen on its way back; steps are short where the dashpot's force jumps, or is quick."""
    keys, left = WALLS[name], "left" in WALLS[name]["walls"]
    kick = {"bead": 1, "velocity": -1.0} if left else {"bead": 2, "velocity": 1.0}
    step = 0.0002 if name in ("linear", "left, hard") else 0.001
    asked = losing(share, gap=0.97, kick=kick, timestep=step, duration=4.5, output={"every": 4.5}, **keys)
    first, last = run(asked, tmp_path / "run").velocity[-1, 0]
    assert (first if left else -last) == pytest.approx(share, abs=5e-5)
    assert (last if left else first) == 0.0


TIED = {
    "cubic": {"stiffness": 0.1, "cubic": 0.2},
    "unequal": {"topology": {"edges": [[1, 2, 0.1], [2, 3, 0.4]]}},
}


@pytest.mark.slow
@pytest.mark.parametrize("coupling", TIED.values(), ids=TIED)
def test_lammps_damps_springs_between_each_chain_and_the_next_whatever_their_law(coupling, tmp_path):
    free, damped = (
        scene(chains=3, beads=8, duration=12.0, timestep=0.002, coupling=coupling, damping=damping)
        for damping in (None, {"coupling": 0.05})
    )
    reference = engine.run(damped.problem()).velocity
    assert np.max(np.abs(run(damped, tmp_path / "run").velocity - reference)) < 5e-4
    assert np.max(np.abs(engine.run(free.problem()).velocity - reference)) > 5e-3


def test_a_restitution_is_that_of_the_reduced_mass_and_the_strength_of_each_contact():
    kinds = {"light": {"mass": 0.25}, "hard": {"stiffness": 3.0}}
    (link,) = losing(0.7, beads=3, kinds=kinds, pattern=["light", "hard", "hard"]).system.dampers
    right = [alpha(0.7) * math.sqrt(0.25 / 1.25 * 1.5), alpha(0.7) * math.sqrt(0.5 * 3.0)]
    np.testing.assert_allclose(link.law.coefficient, [right], rtol=1e-14)


def test_strong_dashpots_shorten_the_stable_step():
    free, stuck, dragged = (
        one_chain(beads=4, damping=damping).system for damping in (None, {"contact": 100.0}, {"beads": 100.0})
    )
    assert stability_bound(stuck) == pytest.approx(2.0 / rates.drag(stuck), rel=0.01)
    assert stability_bound(dragged) == stability_bound(free)


@pytest.mark.slow
def test_lammps_is_stable_below_the_bound_and_not_above(tmp_path):
    keys = {"beads": 2, "coupling": {"stiffness": 0.5}, "duration": 4.0, "output": {"every": 1.0}}
    bound = stability_bound(scene(**keys, damping={"coupling": 20.0}).system)
    within, beyond = (
        run(scene(**keys, damping={"coupling": 20.0}, timestep=1.0 / np.ceil(1.0 / (factor * bound))), tmp_path / name)
        for factor, name in ((0.9, "within"), (1.2, "beyond"))
    )
    assert np.max(np.abs(within.velocity)) <= 1.0 < np.max(np.abs(beyond.velocity))
