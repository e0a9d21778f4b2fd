"""What LAMMPS cannot compute is refused by `run`, `deck` and a sweep before anything runs, and said by `show`."""

from typing import Any

import pytest
from refusals import refusal, tree

from lammps_inputs import engine_limits, strict_yaml
from lammps_inputs.decks import deck
from lammps_inputs.library import from_plain
from workflow.cli import main
from workflow.runs.engines import engine_called
from workflow.runs.run import run

PUSH = {"peak": 0.5, "duration": 3.0, "shape": "half-sine"}
STEEL = {"radius": 4.76e-3, "density": 8000.0, "youngs_modulus": 193e9, "poisson_ratio": 0.3}
LIMITED: dict[str, tuple[dict[str, Any], engine_limits.EngineLimit]] = {
    "pushes": ({"push": [{**PUSH, "bead": bead} for bead in range(1, 26)], "kick": None}, engine_limits.GROUPS),
    "pushes beside foundations": (
        {
            "chains": 13,
            "push": [{**PUSH, "bead": bead} for bead in range(1, 13)],
            "foundation": {"stiffness": [0.1 * k for k in range(1, 14)]},
        },
        engine_limits.GROUPS,
    ),
    "foundations": ({"chains": 25, "foundation": {"stiffness": [0.1 * k for k in range(1, 26)]}}, engine_limits.GROUPS),
    "walls": (
        {"chains": 25, "material": STEEL, "disorder": {"radius": 0.1}, "walls": {"right": "flat"}, "duration": 1e-4},
        engine_limits.GROUPS,
    ),
    "strengths": ({"contact": {"exponent": 2.0, "strength": [1.0, 2.0] * 19 + [1.0]}}, engine_limits.STRENGTHS),
    "exponents": ({"contact": {"exponent": [1.5] * 20 + [2.5] * 19}}, engine_limits.EXPONENTS),
    "formula": (
        {"contact": {"force": "A*s^1.5*(1+s)", "A": 1.0, "strength": [1.0, 2.0] * 19 + [1.0]}},
        engine_limits.FORMULAS,
    ),
    "restitution": (
        {"contact": {"exponent": 2.5}, "damping": {"contact": 0.8, "law": "restitution"}},
        engine_limits.RESTITUTIONS,
    ),
    "viscoelastic": (
        {"damping": {"contact": 0.1, "law": "viscoelastic"}, "disorder": {"mass": 0.1}},
        engine_limits.VISCOELASTIC,
    ),
    "dashpots in some rows": (
        {"chains": 2, "coupling": {"stiffness": 0.1, "rows": [3, 9]}, "damping": {"coupling": 0.1}},
        engine_limits.COUPLING_DASHPOTS,
    ),
    "dashpots of a ring": (
        {"chains": 3, "coupling": {"stiffness": 0.1, "topology": "ring"}, "damping": {"coupling": 0.1}},
        engine_limits.COUPLING_DASHPOTS,
    ),
    "cubic springs": ({"chains": 2, "coupling": {"cubic": 1e6}}, engine_limits.CUBIC_SPRINGS),
    "bonds": ({"chains": 2, "coupling": {"force": "k*s*abs(s)", "k": 0.1}}, engine_limits.EVEN_ENERGY),
}


def plain(name: str) -> dict[str, Any]:
    keys = {"name": "limited", "beads": 40, "kick": {"velocity": 1.0}, "duration": 5.0, **LIMITED[name][0]}
    return {key: value for key, value in keys.items() if value is not None}


def words_of(limit: engine_limits.EngineLimit) -> str:
    """The longest part of a limit's words that is the same for all scenes."""
    return max(limit.words.replace("{bound}", str(limit.bound)).split("{number}"), key=len)


SYMPY = {"formula", "bonds"}


@pytest.mark.parametrize("name", [pytest.param(n, marks=[pytest.mark.slow] if n in SYMPY else []) for n in LIMITED])
def test_run_and_deck_refuse_it_and_write_nothing(name, tmp_path, capsys):
    (tmp_path / "scene.yaml").write_text(strict_yaml.dump(plain(name)))
    before, words = tree(tmp_path), words_of(LIMITED[name][1])
    for command in ("run", "deck"):
        line = refusal([command, tmp_path / "scene.yaml", "-o", tmp_path / "out"], capsys)
        assert words in line
        assert line.endswith("; use the reference engine")
    assert tree(tmp_path) == before
    assert engine_called("reference").refusal(from_plain(plain(name), "test")) == ""


def test_a_sweep_refuses_it_before_its_first_case(tmp_path, capsys):
    file = {"scene": plain("strengths") | {"contact": {"strength": [1.0, 2.0] * 19 + [1.0]}}}
    (tmp_path / "sweep.yaml").write_text(strict_yaml.dump(file | {"vary": {"contact.exponent": [1.5, 2.0]}}))
    before = tree(tmp_path)
    line = refusal(["sweep", tmp_path / "sweep.yaml", "-o", tmp_path / "out"], capsys)
    assert words_of(engine_limits.STRENGTHS) in line
    assert tree(tmp_path) == before


def test_show_says_that_lammps_cannot_and_how_large_a_run_of_the_reference_is(tmp_path, capsys):
    (tmp_path / "scene.yaml").write_text(strict_yaml.dump(plain("exponents") | {"timestep": 0.01}))
    assert main(["show", str(tmp_path / "scene.yaml")]) == 0
    shown = capsys.readouterr().out
    assert f"# warning: LAMMPS cannot compute it: contacts: {words_of(engine_limits.EXPONENTS)}" in shown
    assert "a run by the reference integrator has" in shown


@pytest.mark.parametrize(("kind", "count"), [("push", 24), ("drive", 24)])
def test_lammps_reads_a_deck_with_as_many_groups_as_the_limit_allows(kind, count, tmp_path, lammps_here):  # noqa: ARG001
    acts = {"push": PUSH, "drive": {"force": 0.1, "frequency": 0.1}}[kind]
    keys = {"name": "most", "beads": 40, kind: [{**acts, "bead": bead} for bead in range(1, count + 1)]}
    output = {"beads": [1, 2], "every": 1.0}
    case = from_plain({**keys, "duration": 2.0, "timestep": 0.02, "output": output}, "test")
    assert deck.refusal(case.system) == ""
    assert run(case, tmp_path / "run", check=False).outcome == "done"


@pytest.mark.parametrize("command", ["show", "run", "deck"])
def test_frames_too_far_apart_to_be_analysed_are_refused(command, tmp_path, capsys):
    keys = {"name": "far", "beads": 40, "kick": {"velocity": 1.0}, "duration": 50.0, "output": {"every": 5.0}}
    (tmp_path / "scene.yaml").write_text(strict_yaml.dump(keys))
    before = tree(tmp_path)
    out = [] if command == "show" else ["-o", tmp_path / "out"]
    words = "output.every: frames are 5 apart, too far to find waves between them; at most 2"
    assert words in refusal([command, tmp_path / "scene.yaml", *out], capsys)
    assert tree(tmp_path) == before
