"""Beads, contacts and pushes that are not the scene's: what `validate` says of them."""

from dataclasses import replace

import pytest
from plain_scene import scene
from wrong_runs import causes, deck_run, substituted, without_uncertainties

from lammps_inputs import file_names
from workflow.engines.reference import engine
from workflow.verdicts.validate import validate

FRAMES = {"output": {"every": 0.1}, "duration": 16.0}
SIZES = {"kinds": {"big": {}, "small": {"radius": 0.7}}, "pattern": ["big", "big", "small"], **FRAMES}
PUSH = {"peak": 0.8, "duration": 2.0, "shape": "half-sine", "bead": 2}
PUSHED = {"push": PUSH, "kick": None, "walls": {"right": "flat"}, **SIZES}


def heavier(atoms, factor):
    """The densities of some atoms of a coupled scene, times a factor."""

    def edit(path):
        head, body = (path / file_names.DATA).read_text().split("bond\n\n", 1)
        rows, rest = body.split("\n\n", 1)
        words = [row.split() for row in rows.splitlines()]
        changed = [[*w[:6], repr(float(w[6]) * factor), w[7]] if int(w[0]) in atoms else w for w in words]
        (path / file_names.DATA).write_text("\n".join([head + "bond\n", *map(" ".join, changed)]) + "\n\n" + rest)

    return edit


WRONG = {
    "a kind of bead": (SIZES, heavier(range(3, 25, 3), 1.1), "beads of mass 0.343 are 1.1 times as heavy as"),
    "one bead": (SIZES, heavier([18], 1.3), "bead 6 of chain 2 is 1.3 times as heavy as"),
    "one bead of a plain scene": (
        FRAMES,
        substituted(r"(set group all mass 1.0.*\n)", r"\1set atom 6 mass 1.2\n"),
        "bead 6 of chain 1 is 1.2 times as heavy as",
    ),
    "a kind of contact": (
        SIZES,
        substituted(r"(pair_coeff 1 2 hertz) \S+", r"\1 1.0"),
        "the contacts of strength 0.9075 are 1.102 times as strong as",
    ),
    "the push's peak": (
        PUSHED,
        substituted(r"(push1peak index) (\S+)", r"\1 0.9"),
        "the push on bead 2 of chain 1 is 1.15 times as strong as",
    ),
    "the push's duration": (
        PUSHED,
        substituted(r"(push1duration index) (\S+)", r"\1 3.0"),
        "the duration of the push on bead 2 of chain 1 is 1.494 times that of the scene",
    ),
    "no push": (PUSHED, substituted(r"fix push1 .*\n", ""), "the push on bead 2 of chain 1 is missing"),
}


@pytest.mark.slow
@pytest.mark.parametrize(("changes", "edit", "said"), WRONG.values(), ids=WRONG)
def test_validate_names_what_is_not_the_scenes(tmp_path, changes, edit, said):
    found = validate(deck_run(scene(**changes), tmp_path / "run", edit))
    assert not found.passed
    (cause,) = without_uncertainties(found.causes)
    assert cause in (said, f"{said} the scene says")


def test_of_a_right_run_nothing_is_said(tmp_path):
    found = validate(deck_run(scene(**SIZES), tmp_path / "run"))
    assert found.passed
    assert found.causes == ()


COUPLED = {"chains": 2, "beads": 8, "duration": 12.0, "output": {"every": 0.1}}
OTHER = {
    "springs of pushed chains": (
        {"kick": None, "push": [{"peak": 1.0, "duration": 2.0, "shape": "half-sine"}], "coupling": {"stiffness": 0.3}},
        {"coupling": {"stiffness": 0.306}},
        ["the coupling is 1.02 times as strong as the scene says"],
    ),
    "drag beside dashpots of contacts": (
        {"damping": {"contact": 0.05, "beads": 0.01}, "output": {"every": 0.2}},
        {"damping": {"contact": 0.05, "beads": 0.011}},
        ["the bead damping is 1.1 times as strong as the scene says"],
    ),
    "a static load": (
        {"precompression": {"force": 1.0}},
        {"precompression": {"force": 1.05}},
        ["the static load of the contacts is 1.05 times as strong as the scene says"],
    ),
    "a wall under a load": (
        {"precompression": {"force": 0.3}, "walls": {"left": "rigid", "right": {"stiffness": 2.0}}},
        {"walls": {"left": "rigid", "right": {"stiffness": 2.1}}},
        [],
    ),
}


@pytest.mark.parametrize(("right", "wrong", "said"), OTHER.values(), ids=OTHER)
def test_what_does_not_explain_a_difference_is_not_named_as_its_cause(right, wrong, said):
    keys = {**COUPLED, **right}
    own, reference = (engine.run(scene(**one).problem()) for one in ({**keys, **wrong}, keys))
    found = causes(replace(own, problem=reference.problem), reference)
    assert found == said


def test_beads_that_start_elsewhere_are_named_before_forces():
    reference = engine.run(scene(**COUPLED, precompression={"force": 1.0}).problem())
    (cause,) = causes(replace(reference, displacement=reference.displacement + 0.1), reference)
    assert cause == "bead 1 of chain 1 starts 0.1 from its place at rest (another gap or static load?)"
