"""Beads, contacts and pushes that are not the scene's: what `validate` says of them."""

from dataclasses import replace

import pytest
from plain_scene import scene
from wrong_runs import causes

from workflow.engines.reference import engine

COUPLED = {"chains": 2, "beads": 8, "duration": 12.0, "output": {"every": 0.1}}
OTHER = {
    "drag beside dashpots of contacts": (
        {"damping": {"contact": 0.05, "beads": 0.01}, "output": {"every": 0.2}},
        {"damping": {"contact": 0.05, "beads": 0.011}},
        ["the bead damping is 1.1 times as strong as the scene says"],
    ),
    "a kind of bead": (
        {"kinds": {"big": {}, "small": {"mass": 0.5}}, "pattern": ["big", "big", "small"]},
        {"kinds": {"big": {}, "small": {"mass": 0.55}}},
        ["beads of mass 0.5 are 1.1 times as heavy as the scene says"],
    ),
    "a wall under a load": (
        {"precompression": {"force": 0.3}, "walls": {"left": "rigid", "right": {"stiffness": 2.0}}},
        {"walls": {"left": "rigid", "right": {"stiffness": 2.1}}},
        [],
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize(("right", "wrong", "said"), OTHER.values(), ids=OTHER)
def test_what_is_not_the_scenes_is_named_and_nothing_that_does_not_explain_the_difference(right, wrong, said):
    keys = {**COUPLED, **right}
    own, reference = (engine.run(scene(**one).problem()) for one in ({**keys, **wrong}, keys))
    found = causes(replace(own, problem=reference.problem), reference)
    assert found == said


def test_beads_that_start_elsewhere_are_named_before_forces():
    reference = engine.run(scene(**COUPLED, precompression={"force": 1.0}).problem())
    (cause,) = causes(replace(reference, displacement=reference.displacement + 0.1), reference)
    assert cause == "bead 1 of chain 1 starts 0.1 from its place at rest (another gap or static load?)"
