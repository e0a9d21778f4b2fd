"""Ingredients in any mixture: LAMMPS keeps the error it states, symmetries hold, and neutral values leave no trace.

The laws are those of a few fixed mixtures, for each new one takes the compiler a while; only numbers are drawn.
"""

import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from mirror import mirrored_problem
from plain_scene import BEADS, scene

from analysis import motion
from lammps_inputs.decks import deck
from workflow.engines.reference import engine
from workflow.runs.run import run

pytestmark = pytest.mark.usefixtures("lammps_here")

_FOUND = (Phase.explicit, Phase.generate)  # no search for a simpler example, which takes minutes
MIXED = settings(max_examples=2, derandomize=True, database=None, phases=_FOUND)

NAMES = st.lists(st.sampled_from(["a", "b"]), min_size=2, max_size=4)


@st.composite
def unequal(draw):
    """Two coupled chains of two kinds of bead, tapered, disordered."""
    kind = {"mass": draw(st.floats(0.2, 5.0)), "radius": draw(st.floats(0.5, 2.0)), "stiffness": 1.5}
    return {
        "kinds": {"a": {}, "b": kind},
        "pattern": [["a", "b", *draw(NAMES)], ["b", *draw(NAMES)]],
        "taper": draw(st.floats(0.0, 0.05)),
        "disorder": {"mass": draw(st.floats(0.0, 0.2)), "seed": draw(st.integers(1, 9))},
        "coupling": {"stiffness": draw(st.floats(0.01, 1.0))},
        "duration": 10.0,
    }


@st.composite
def walled_and_pushed(draw):
    """The same between walls, pushed."""
    walls = st.sampled_from(["bead", "flat", "rigid"]) | st.fixed_dictionaries({"stiffness": st.floats(0.1, 10.0)})
    push = {"chain": draw(st.integers(1, 2)), "bead": draw(st.integers(1, BEADS)), "shape": "half-sine"}
    push = {**push, "peak": draw(st.floats(0.2, 2.0) | st.floats(-2.0, -0.2)), "duration": draw(st.floats(0.5, 5.0))}
    return {**draw(unequal()), "walls": {"left": draw(walls), "right": draw(walls)}, "push": push, "kick": None}


def keeps_the_error_it_states(changes):
    case = scene(**changes)
    problem = case.problem()
    with tempfile.TemporaryDirectory() as folder:
        found = run(case, Path(folder) / "run")
        velocity = found.trajectory.velocity
    exact = engine.run(problem, steps_per_frame=4 * engine.default_steps_per_frame(problem)).velocity
    assert np.abs(velocity - exact).max() <= found.check.velocity + found.check.reference.velocity


def is_the_same_in_the_mirror_and_with_chains_in_another_order(changes):
    case = scene(**changes)
    problem = case.problem()
    usual = engine.run(problem)
    seen = engine.run(mirrored_problem(problem))
    np.testing.assert_allclose(seen.velocity, -usual.velocity[..., ::-1], rtol=0.0, atol=1e-10)
    hit = "kick" if case.kick else "push"
    swapped = {"pattern": changes["pattern"][::-1], hit: {**case.plain()[hit], "chain": 3 - case.plain()[hit]["chain"]}}
    other = engine.run(scene(**{**changes, "disorder": None, **swapped}).problem())
    same = engine.run(scene(**{**changes, "disorder": None}).problem())
    np.testing.assert_allclose(other.velocity, same.velocity[:, ::-1], rtol=0.0, atol=1e-10)


def closes_its_budget(changes):
    problem = scene(**changes).problem()
    found = engine.run(problem, steps_per_frame=2 * engine.default_steps_per_frame(problem))
    energy = motion.energy(problem.system, found.displacement, found.velocity)
    after = found.time > max((load.end for load in problem.system.loads), default=0.0)
    assert np.ptp(energy[after]) < 1e-5 * energy[after].max()


@pytest.mark.slow
@MIXED
@given(unequal(), walled_and_pushed())
def test_mixtures_keep_their_stated_error_have_symmetries_and_conserve_energy_once_a_push_is_over(free, pushed):
    for changes in (free, pushed):
        keeps_the_error_it_states(changes)
        is_the_same_in_the_mirror_and_with_chains_in_another_order(changes)
        closes_its_budget(changes)


LIKE = {"a": {"mass": 1.0}, "b": {"radius": 1.0}}
NEUTRAL = {
    "kinds": {"kinds": LIKE, "pattern": ["a", "b"]},
    "taper": {"taper": 0.0},
    "disorder": {"disorder": {"mass": 0.0, "radius": 0.0, "seed": 7}},
    "striker": {"striker": {"mass": 1.0, "velocity": 1.0}, "kick": None},
    "foundation": {"foundation": {"stiffness": 0.0}},
    "a flat ramp": {"coupling": {"stiffness": {"from": 0.1, "to": 0.1, "rows": [1, BEADS]}}},
    "all rows": {"coupling": {"stiffness": 0.1, "rows": [1, BEADS]}},
    "open": {"coupling": {"stiffness": 0.1, "topology": "open", "cubic": 0.0}},
    "edges": {"coupling": {"topology": {"edges": [[1, 2, 0.1]]}}},
    "replaced by its like": {"kinds": LIKE, "replace": [{"bead": 3, "kind": "b"}]},
    "spheres": {"contact": {"exponent": 1.5}},
    "strength": {"contact": {"strength": 1}},
    "strengths": {"contact": {"strength": [[1] * (BEADS - 1)]}},
    "a flat ramp of strengths": {"contact": {"strength": {"from": 1, "to": 1, "contacts": [2, 5]}}},
    "random strengths": {"contact": {"strength": {"spread": 0}}},
    "resonators without mass": {"resonators": {"mass": 0.0, "stiffness": 1.0}},
    "resonators without springs": {"resonators": {"mass": 0.1, "stiffness": 0.0}},
    "no resonators": {"resonators": []},
    "no dashpots": {"damping": {"contact": 0.0}},
    "no drag": {"damping": {"beads": 0.0}},
    "whole restitution": {"damping": {"contact": 1.0, "law": "restitution"}},
}


@pytest.mark.parametrize("names", [*([name] for name in NEUTRAL), list(NEUTRAL)], ids=" ".join)
def test_neutral_values_leave_the_deck_and_the_problem_of_a_plain_scene(names):
    changes = {key: value for name in names for key, value in NEUTRAL[name].items()}
    like, plain = scene(**changes).problem(), scene().problem()
    assert like == plain
    assert (deck.render_deck(like), deck.render_data(like)) == (deck.render_deck(plain), deck.render_data(plain))
