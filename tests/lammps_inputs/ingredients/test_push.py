"""Forces over time: units, tables and their files; the motion is in `test_every_ingredient`."""

import math

import pytest
import yaml

from lammps_inputs import InputError, file_names, library, physics
from lammps_inputs.decks import deck
from lammps_inputs.scene import DEFAULT_ACCURACY
from workflow.runs.run import run

HALF_SINE = "{peak: 1.0, duration: 2.0, shape: half-sine}"


def scene(push=HALF_SINE, more=""):
    return library.from_plain(yaml.safe_load(f"name: pushed\nbeads: 20\nduration: 10\npush: {push}\n{more}"), "x")


def test_without_a_kick_v_is_what_the_push_gives_a_free_bead():
    one = scene()
    assert one.scale.velocity == pytest.approx(4.0 / math.pi, rel=1e-15)
    assert physics.excitations(one.system) == ((1, 1, pytest.approx(1.0, rel=1e-15)),)
    assert physics.energy(one.system) == pytest.approx(0.5, rel=1e-15)


def test_in_si_the_numbers_are_newtons_and_seconds():
    steel = "material: {radius: 4.76e-3, density: 8000, youngs_modulus: 193.0e+9, poisson_ratio: 0.3}"
    one = library.from_plain(
        yaml.safe_load(
            "name: hammer\nbeads: 20\nduration: 1.0e-3\n"
            f"push: {{peak: 100, duration: 1.0e-4, shape: half-sine}}\n{steel}"
        ),
        "x",
    )
    impulse = 2.0 * 100.0 * 1e-4 / math.pi
    assert one.scale.velocity == pytest.approx(impulse / one.scale.mass, rel=1e-15)
    (load,) = one.problem().system.loads
    assert load.law.peak * one.scale.force == pytest.approx(100.0, rel=1e-14)


def test_a_scene_with_pushes_survives_being_written_down():
    one = scene(f"[{HALF_SINE}, {{bead: 3, table: [[0, 1], [1, 0]]}}]", "kick: {velocity: 1.0}")
    assert library.from_plain(yaml.safe_load(yaml.safe_dump(one.plain())), "x") == one
    assert scene().plain()["push"]["peak"] == 1.0
    assert "kick" not in scene().plain()


def test_a_table_is_read_from_beside_the_scene_and_written_into_it(tmp_path):
    (tmp_path / "force.csv").write_text("time,force\n0,0\n1.5; 2\n3,0\n\n")
    (tmp_path / "a.yaml").write_text("name: a\nbeads: 20\nduration: 10\npush: {table: force.csv}\n")
    one = library.find(str(tmp_path / "a.yaml"))
    assert one.plain()["push"]["table"] == [[0.0, 0.0], [1.5, 2.0], [3.0, 0.0]]
    assert one.scale.velocity == pytest.approx(3.0, rel=1e-15)


@pytest.mark.parametrize(
    ("content", "complaint"),
    [
        ("0,0\n1,x\n", "force.csv:2: '1,x' found; two numbers are needed, time and force"),
        ("0,0\n1,2,3\n", "force.csv:2: '1,2,3' found"),
        ("0,0\n", "push.table: has 1 points"),
        ("0,0\n2,1\n1,0\n", "push.table: times must increase; 1 follows 2"),
        ("0,0\n2,1\n", "push.table: must begin (unless at time 0) and end with a force of 0"),
        ("1,1\n2,0\n", "push.table: must begin (unless at time 0) and end with a force of 0"),
        ("0,0\n2,0\n", "push.table: has no force"),
        ("none.csv", "none.csv: the table of a push cannot be read: No such file"),
        ("/dev/zero", "/dev/zero: the table of a push cannot be read: it is larger than 16 MiB"),
    ],
)
def test_a_table_that_is_none_is_one_line(content, complaint, tmp_path):
    name = "force.csv" if "\n" in content else content
    if name != content:
        (tmp_path / name).write_text(content)
    (tmp_path / "a.yaml").write_text(f"name: a\nbeads: 20\nduration: 10\npush: {{table: {name}}}\n")
    with pytest.raises(InputError) as caught:
        library.find(str(tmp_path / "a.yaml"))
    assert complaint in str(caught.value)
    assert "\n" not in str(caught.value)


def test_lammps_is_not_given_long_tables():
    points = [[0.1 * k, float(k % 2)] for k in range(60)] + [[6.0, 0.0]]
    with pytest.raises(ValueError, match=r"push\.table: 61 points; LAMMPS takes 50 at most"):
        deck.render(scene(f"{{table: {points}}}"))


def test_the_formula_of_a_table_names_steps_not_variables_that_lammps_reads_again_at_each_place():
    deck_text = deck.render(scene("{table: [[0, 0], [1, 1], [2, 0.5], [3, 0]]}"))[file_names.DECK]
    (line,) = [line for line in deck_text.splitlines() if line.startswith("variable push1 equal")]
    assert "v_push1" not in line


@pytest.mark.slow
def test_steps_of_short_pushes_keep_the_default_accuracy(tmp_path):
    case = scene("{peak: 1.0, duration: 0.1, shape: half-sine}")
    assert case.problem().system.loads[0].end < case.problem().every
    assert run(case, tmp_path / "run").check.velocity <= DEFAULT_ACCURACY
