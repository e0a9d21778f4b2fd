"""What no command of a plug-in can use: one line that says what is wrong, exit code 2, and nothing written."""

import pytest
from plug_ins import needs
from refusals import assert_command_line_is_refused
from sweeps import SMALL

from lammps_inputs import strict_yaml

MASS = "threshold s.yaml -o out --where mass=1 --vary"
FIT = "fit walled.yaml --against data.csv -o out --free"

COMMAND_LINES = [
    ("threshold s.yaml -o out --where agre_1=3 --vary gap=0:1", "did you mean"),
    ("threshold s.yaml -o out --where agree_1 --vary gap=0:1", "--where: 'agree_1' given; such as agree_1=50"),
    ("threshold s.yaml -o out --where mass=much --vary gap=0:1", "--where: 'much' is no number"),
    (f"{MASS} gap=1:0", "--vary: 1:0 given; the smaller number first"),
    (f"{MASS} gap=0:1 --log", "both above 0 with --log"),
    (f"{MASS} beads=4.5:9", "--vary: beads takes whole numbers"),
    (f"{MASS} gaps=0:1", "a scene has no field 'gaps'"),
    (f"{MASS} gap=0:1 --over gap=1,2", "--over gap: is the field"),
    (f"{MASS} gap=0:1 --over beads=9,9", "--over: '9,9' given; different values"),
    (f"{MASS} gap=0:1 --points 1", "--points: 1 given"),
    (f"{MASS} gap=0:1 --tolerance 0", "--tolerance: 0 given"),
    (f"{FIT} coupling.stifness", "did you mean `coupling.stiffness`?"),
    (f"{FIT} beads", "counts something"),
    (f"{FIT} gap", "gap: is not there"),
    (f"{FIT} walls.right", "walls.right: is 'rigid'"),
    (f"{FIT} kick.velocity,kick.velocity", "named twice"),
    (f"{FIT} kick[1].velocity,kick.velocity", "named twice"),
    (f"{FIT} kick.velocity --offset nan", "--offset: nan given"),
    (f"{FIT} kick.velocity --offset=-1e9", "too long to fit"),
    (f"{FIT} ,", "name at least one field"),
    ("trade s.yaml -o out --budget 0", "above 0"),
    ("trade s.yaml -o out --budget nan", "above 0"),
    ("gallery dimer -o out", "did you mean `dimers`?"),
    ("extremes exponent -o out", "extremes: 'exponent' given (did you mean `exponents`?)"),
    ("help coupliing", "did you mean `coupling`?"),
    ("view .", "neither a run nor a sweep"),
]
CASES = [
    pytest.param(words, says, id=words, marks=needs("pages" if command == "view" else command))
    for words, says in COMMAND_LINES
    for command in words.split()[:1]
]

FILES = {
    "s.yaml": strict_yaml.dump(SMALL),
    "walled.yaml": strict_yaml.dump({**SMALL, "walls": {"right": "rigid"}}),
    "data.csv": "time,force_contact_5_chain_1\n0,0\n1,0.1\n2,0\n",
}


@pytest.mark.parametrize(("words", "says"), CASES)
def test_a_command_line_that_makes_no_sense_is_one_line_and_nothing_is_written(words, says, tmp_path, capsys):
    assert_command_line_is_refused(words, says, FILES, tmp_path, capsys)
