"""What `design` cannot use: one line that names the file, exit code 2, and nothing written."""

from typing import Any

import pytest
from refusals import assert_file_is_refused
from sweeps import SMALL

from lammps_inputs import strict_yaml

DESIGN = {
    "scene": {**SMALL, "walls": {"right": "rigid"}},
    "vary": {"coupling.stiffness": [0.02, 0.1], "beads": {"from": 8, "to": 14}},
    "minimize": "wall_force",
    "where": {"mass": {"from": 20}},
}

DESIGNS: list[tuple[Any, str]] = [
    ("", "is empty; a design needs a `scene`, what may `vary`, and what to `minimize` or `maximize`"),
    ("name: a\nbeads: 9\n", "looks like a scene, not a design; `granchain run FILE -o DIR` takes it"),
    ("scene: two-chains\nvary: {gap: [1, 2]}\nminimise: delay\n", "did you mean `minimize`?"),
    ({"minimize": "wall_farce"}, "minimize: 'wall_farce' is no quantity (did you mean `wall_force`?)"),
    ({"maximize": "delay"}, "give either minimize or maximize"),
    ({"vary": {"couplng.stiffness": [1, 2]}}, "did you mean `coupling.stiffness`?"),
    ({"vary": {"beads": {"from": 8, "to": 10.5}}}, "vary.beads: takes whole numbers"),
    ({"vary": {"beads": {"from": 9, "to": 8}}}, "the smaller first"),
    ({"vary": {"beads": [9]}}, "two choices or more"),
    ({"vary": {"pattern": {"of": ["a", "b"]}}}, "vary.pattern.places: is missing"),
    (
        {"vary": {"coupling.rows": {"from": 1, "to": 4, "places": 0}}},
        "places: should be greater than or equal to 1",
    ),
    ({"where": {"mass": {}}}, "where.mass: give from, to or both"),
    ({"where": {"mass": {"from": 160, "to": 152}}}, "where.mass: goes from 160 to 152; the smaller first"),
    ({"where": {"weight": {"to": 1}}}, "where: 'weight' is no quantity"),
    ({"scene": "two-chain"}, "did you mean `two-chains`?"),
]


@pytest.mark.parametrize(("content", "says"), DESIGNS, ids=[says for _, says in DESIGNS])
def test_a_bad_design_is_one_line_that_names_its_file_and_nothing_is_written(content, says, tmp_path, capsys):
    text = content if isinstance(content, str) else strict_yaml.dump({**DESIGN, **content})
    assert_file_is_refused("design", text, says, tmp_path, capsys)
