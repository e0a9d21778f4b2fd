"""The developer's command that writes what a new ingredient owes beside its code."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from core_alone import copy_without
from processes import HANGS
from tree_metadata import write_metadata

CODE = '''"""A spring of each bead to its place."""

from typing import Annotated, ClassVar

from lammps_inputs import laws
from lammps_inputs.facts import Fact
from lammps_inputs.ingredients.base import Ingredient, Stiffness
from lammps_inputs.laws.spring import Linear
from lammps_inputs.links import Links
from lammps_inputs.units import Label


class Tether(Ingredient):
    """Springs of the beads to their places."""

    example: ClassVar[str] = "{stiffness: 0.1}"
    sources = ("starosvetsky2012",)
    takes_away = frozenset({Fact.MOMENTUM, Fact.PULSE, Fact.FRONT})

    stiffness: Annotated[Stiffness, Label("tether stiffness")]
    """Stiffness of the springs."""

    def links(self, scene):
        """Springs of all beads."""
        return (Links.ground("tether", laws.dimensionless(Linear(self.stiffness), scene.scale)),)
'''

OWED = (
    "tests/plugins/help/test_handbook.py",
    "tests/lammps_inputs/test_schema.py",
    "tests/lammps_inputs/test_library.py",
)
OWED += ("tests/test_readme.py", "tests/test_manual.py", "tests/test_every_ingredient.py")

MOTIONS = "examples_are_valid or any_value_of_any_key or any_positive or other_units or mirror or tends_to"
MOTIONS += " or states_its_error or the_reference or balanced or suzuki"
"""Tests that read or compile scenes of all ingredients, of which those of the new one are meant here."""

UNFILLED = {
    "test_no_text_is_left_to_be_filled",
    "test_a_scene_in_other_units_is_the_same_problem",  # the units of its keys are written by hand
    "test_every_picture_is_drawn_by_the_script_and_small",  # it is not drawn here
}


@pytest.mark.slow
def test_what_a_new_ingredient_owes_is_written_and_its_tests_fail_for_what_is_to_be_filled_alone(tmp_path, executable):
    executable("git")
    copy_without(set(), tmp_path)
    (tmp_path / "lammps_inputs/ingredients/tether.py").write_text(CODE)
    project = tmp_path / "pyproject.toml"
    walls = 'walls = "lammps_inputs.ingredients.walls:Walls"\n'
    tether = 'tether = "lammps_inputs.ingredients.tether:Tether"\n'
    project.write_text(project.read_text().replace(walls, walls + tether))
    write_metadata(project, tmp_path)
    path = os.pathsep.join(map(str, (tmp_path, tmp_path / "workflow/python", tmp_path / "tests/support")))

    def done(*words):
        environment = {**os.environ, "PYTHONPATH": path}
        command = [sys.executable, "-P", *map(str, words)]
        return subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=HANGS)

    assert done("tests/support/new_ingredient.py", "no-ingredient").returncode == 2
    written = done("tests/support/new_ingredient.py", "tether")
    assert written.returncode == 0, written.stderr
    assert "FILL" in (tmp_path / "lammps_inputs/SCENES.md").read_text()
    assert done("tests/support/new_ingredient.py", "tether").returncode == 2  # nothing is written twice
    schema = done("-m", "workflow", "schema")
    (tmp_path / "lammps_inputs/templates/scene.schema.json").write_text(schema.stdout)
    tests = done(
        "-m",
        "pytest",
        "-q",
        "-p",
        "no:cacheprovider",
        "-m",
        "not slow",
        "-k",
        f"tether or not ({MOTIONS})",
        *map(Path, OWED),
    )
    failed = set(re.findall(r"^FAILED \S+::(\w+)", tests.stdout, re.MULTILINE))
    assert failed == UNFILLED, tests.stdout[-3000:]
