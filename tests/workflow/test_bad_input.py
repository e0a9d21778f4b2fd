"""What no command can use: one line that says what is wrong, exit code 2, and nothing written.

Bad scenes are in `bad_scenes`; here are command lines, and files of sweeps and designs.
"""

import shlex
from pathlib import Path
from typing import Any

import pytest
from bad_scenes import BAD_SCENES, scene_text
from refusals import refusal, tree
from sweeps import SMALL

from lammps_inputs import strict_yaml
from lammps_inputs.slurm import site
from workflow.engines.lammps import mpi

OF_OTHERS = [(command, case) for command in ("deck", "show") for case in BAD_SCENES[::20]]


@pytest.mark.parametrize(
    ("command", "case"),
    [*(("run", case) for case in BAD_SCENES), *OF_OTHERS],
    ids=lambda one: getattr(one, "kind", one),
)
def test_a_bad_scene_is_one_line_and_nothing_is_written(command, case, tmp_path, capsys):
    if not case.possible:
        pytest.skip("not possible for this user or on this system (root reads every file)")
    path = case.place(tmp_path)
    before = tree(tmp_path)
    output = [] if command == "show" else ["-o", tmp_path / "out"]
    message = refusal([command, path, *output], capsys)
    assert message.startswith(f"{path}: {case.key}")
    assert case.says in message
    assert tree(tmp_path) == before


# --- command lines ----------------------------------------------------------------------------------------------------

MASS = "threshold s.yaml -o out --where mass=1 --vary"
FIT = "fit walled.yaml --against data.csv -o out --free"
RUN = "run two-chains -o out"
DECK = "deck two-chains -o out"
NEEDS = "run: needs a SCENE and -o DIR, or --resume DIR"
RESUMED = "--resume: continues with the settings of the run; leave out"

COMMAND_LINES = [
    ("", "COMMAND; `granchain --help` lists the options"),
    ("simulate", "'simulate' is no command; `granchain --help` lists all"),
    ("analyzes run", "'analyzes' is no command (did you mean `analyze`?)"),
    ("run", f"{NEEDS}; `granchain run --help` lists the options"),
    ("run two-chains", NEEDS),
    ("run -o x", NEEDS),
    ("run two-chains -o", "expected one argument"),
    (f"{RUN} --rank two", "invalid int value: 'two'"),
    (f"{RUN} --fast", "unrecognized arguments: --fast"),
    ("run two-chains three-chains -o out", "unrecognized arguments: three-chains"),
    ("show two-chains '\x1b[31m\n'", r"unrecognized arguments: \x1b[31m"),
    (f"{RUN} --ranks 0", "--ranks: 0 given; at least 1"),
    (f"{RUN} --ranks -1", "--ranks: -1 given; at least 1"),
    (f"{RUN} --ranks {mpi.cores() + 1}", "cores are available"),
    (f"{RUN} --engine collisions", "--engine: `collisions` moves rigid beads, which need a gap"),
    ("run two-chains-gapped -o out --engine collisions --ranks 2", "--ranks"),
    *((f"run --resume here {words}", RESUMED) for words in ("two-chains", "-o x", "--engine lammps", "--overwrite")),
    ("run --resume here --force", RESUMED),
    ("analyze run --formats png,tiff", "'png,tiff' given; of png, pdf, svg, with commas between"),
    ("help coupliing", "did you mean `coupling`?"),
    ("view .", "neither a run nor a sweep"),
    ("collect .", "holds no run directories; `granchain sweep` makes some"),
    ("collect nowhere", "no such directory"),
    (f"{DECK} --nodes 2", "--nodes: is for a job; add --slurm"),
    (f"{DECK} --module gcc", "--module: is for a job; add --slurm"),
    (f"{DECK} --site x.yaml", "--site: is for a job; add --slurm"),
    (f"{DECK} --slurm --site nowhere.yaml", "nowhere.yaml: no such file"),
    (f"{DECK} --slurm --time 90", "--time: should be HH:MM:SS or D-HH:MM:SS, from a minute to a year ('90' given)"),
    (f"{DECK} --slurm --module 'a b'", "--module: a module should be one word such as lammps/2025.07"),
    ("deck quick.yaml -o out --slurm --nodes 100 --ranks-per-node 100", "--ranks-per-node: 10000 ranks in all"),
    ("sweep ref.yaml -o out --slurm", "engine: a Slurm job runs lammps"),
    ("sweep sweep.yaml -o out --nodes 2", "add --slurm"),
    ("sweep sweep.yaml -o out --slurm --partition 'a;ls'", "--partition"),
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
]


@pytest.mark.parametrize(("words", "says"), COMMAND_LINES, ids=[words for words, _ in COMMAND_LINES])
def test_a_command_line_that_makes_no_sense_is_one_line_and_nothing_is_written(
    words, says, tmp_path, tmp_path_factory, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HOME", str(tmp_path_factory.mktemp("home")))  # no defaults of whoever runs the tests
    monkeypatch.delenv(site.VARIABLE, raising=False)
    files = {
        "s.yaml": SMALL,
        "quick.yaml": {**SMALL, "timestep": 0.01},  # for which no pilot run is compiled
        "walled.yaml": {**SMALL, "walls": {"right": "rigid"}},
        "sweep.yaml": {"scene": SMALL, "vary": {"beads": [12]}},
        "ref.yaml": {"scene": SMALL, "vary": {"beads": [12]}, "engine": "reference"},
    }
    for name in files.keys() & set(words.split()):
        Path(name).write_text(strict_yaml.dump(files[name]))
    if "data.csv" in words:
        Path("data.csv").write_text("time,force_contact_5_chain_1\n0,0\n1,0.1\n2,0\n")
    before = tree(tmp_path)
    assert says in refusal(shlex.split(words), capsys)
    assert tree(tmp_path) == before


def test_more_ranks_than_rows_are_refused(tmp_path, capsys):
    if mpi.cores() < 3:
        pytest.skip("two rows and three ranks need three cores")
    short = tmp_path / "short.yaml"
    short.write_text(scene_text(beads="2"))
    assert "ranks divide the 2 rows" in refusal(["run", short, "-o", tmp_path / "out", "--ranks", 3], capsys)


# --- files of sweeps and designs --------------------------------------------------------------------------------------

T = "scene: two-chains\n"

SWEEPS = [
    ("", "is empty; a sweep needs a `scene` and what to `vary`"),
    ("name: a\nbeads: 9\nkick: {velocity: 1}", "looks like a scene, not a sweep; `granchain run FILE -o DIR`"),
    (T + "vary: {gap: [1, 2]}\nminimize: delay", "looks like a design, not a sweep;"),
    ("vary: {gap: [1]}", "scene: is missing"),
    (T + "vary: {}", "vary: names no field"),
    (T + "varry: {gap: [1]}", "did you mean `vary`?"),
    ("scene: two-chain\nvary: {gap: [1]}", "did you mean `two-chains`?"),
    ("scene: /dev/zero\nvary: {gap: [1]}", "neither a file nor an installed scene"),
    ("scene: two-chains-steel\nvary: {youngs_modulus: [1]}", "`material.youngs_modulus`?"),
    (T + "vary: {kick.velocty: [1]}", "did you mean `kick.velocity`?"),
    (T + "vary: {colour: [1]}", "a scene has no field 'colour'"),
    (T + 'vary: {"beads[2]": [1]}', "`beads` is not a list"),
    (T + 'vary: {"kick[2].velocity": [1]}', "no `kick[2]`"),
    (T + "vary: {kick: [1], kick.velocity: [2]}", "lies within `kick`"),
    (T + 'vary: {kick.velocity: [1], "kick[1].velocity": [2]}', "is the same field"),
    (T + "vary: {gap: 3}", "vary.gap: should be a list, or a range"),
    (T + "vary: {gap: []}", "vary.gap: is an empty list"),
    (T + "vary: {beads: [10, 20, 10]}", "beads=10 is there twice"),
    (T + "vary: {gap: {from: 1, count: 3}}", "vary.gap.to: is missing"),
    (T + "vary: {gap: {from: a, to: 1, count: 3}}", "vary.gap.from: should be a number"),
    (T + "vary: {gap: {from: 1, to: .inf, count: 3}}", "vary.gap.to: should be a fin"),
    (T + "vary: {gap: {from: 1, to: 1, count: 3}}", "same as from"),
    (T + "vary: {gap: {from: 1, to: 2.5}}", "count: is missing"),
    (T + "vary: {beads: {from: 2, to: 900000}}", "to: too far"),
    (T + "vary: {gap: {from: 0, to: 1, count: 3, spacing: log}}", "above 0"),
    (T + "vary: {gap: [1, 2], beads: [9]}\ncombine: zip", "gap has 2"),
    (T + "vary: {beads: [10, 20.5]}", "case beads=20.5: beads: should be a whole"),
    (T + "vary: {gap: [.nan]}", "case gap=nan: gap: should be a finite number"),
    (T + "vary: {output.every: [3.0]}", "waves between frames are missed"),
    (T + "vary: {timestep: [2.0], output.every: [2.0]}", "timestep: 2 is unstable"),
    (T + "vary: {beads: [20]}\nengine: collisions", "rigid beads"),
    (T + "vary: !!python/object/apply:os.system [ls]", "tags"),
]

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

FILES = [
    *(("sweep", text, says) for text, says in SWEEPS),
    *(("design", one if isinstance(one, str) else strict_yaml.dump({**DESIGN, **one}), says) for one, says in DESIGNS),
]


@pytest.mark.parametrize(("command", "text", "says"), FILES, ids=[f"{command}: {says}" for command, _, says in FILES])
def test_a_bad_file_is_one_line_that_names_it_and_nothing_is_written(command, text, says, tmp_path, capsys):
    path = tmp_path / f"{command}.yaml"
    path.write_text(text)
    message = refusal([command, path, "-o", tmp_path / "out"], capsys)
    assert message.startswith(f"{path}: ")
    assert says in message
    assert list(tree(tmp_path)) == [Path(path.name)]
