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
OWED += ("tests/test_readme.py", "tests/test_manual.py")

OF_EVERY_SCENE = "examples_are_valid or any_value_of_any_key"
"""Tests of many scenes, of which those of the new ingredient are meant here."""

KEPT = {
    "test_examples_are_valid_scenes",
    "test_the_class_of_an_ingredient_tells_its_keys_and_which_are_required",
    "test_the_section_of_a_model_has_example_exclusions_spelling_sources_and_a_picture",
    "test_an_installed_scene_names_the_schema_and_fits_it",
    "test_every_scene_of_an_ingredient_stands_in_the_gallery",
    "test_the_reference_with_the_scheme_of_lammps_is_lammps_to_rounding",
    "test_energy_and_momentum_are_balanced",
}
"""Tests that have a case of the new ingredient and pass."""

UNFILLED = {
    "test_no_text_is_left_to_be_filled",
    "test_every_picture_is_drawn_by_the_script_and_small",  # it is not drawn here
}
BY_HAND = {
    "test_a_scene_in_other_units_is_the_same_problem",  # the units of its keys
    # the exact motion
    "test_lammps_tends_to_the_exact_motion_with_its_order",
    "test_a_run_states_its_error",
    "test_the_reference_is_within_its_stated_uncertainty_of_the_exact_motion",
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
    tests = ["-m", "pytest", "-q", "-rA", "-p", "no:cacheprovider", "-m"]
    owed = done(*tests, "not slow", "-k", f"tether or not ({OF_EVERY_SCENE})", *map(Path, OWED))
    motions = done(*tests, "", "-k", "tether", Path("tests/test_every_ingredient.py"))
    for found, unfilled in ((owed, UNFILLED), (motions, BY_HAND)):
        assert set(re.findall(r"^FAILED \S+::(\w+)", found.stdout, re.MULTILINE)) == unfilled, found.stdout[-3000:]
    passed = re.findall(r"^PASSED \S+::(\w+)\[tether", owed.stdout + motions.stdout, re.MULTILINE)
    assert set(passed) == KEPT
