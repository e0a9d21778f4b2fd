"""What no command can use: one line that says what is wrong, exit code 2, and nothing written.

Bad scenes are in `bad_scenes`; here are command lines, and files of sweeps. Those of studies are with their tests.
"""

import pytest
from bad_scenes import BAD_SCENES, scene_text
from refusals import assert_command_line_is_refused, assert_file_is_refused, refusal, tree
from sweeps import SMALL

from lammps_inputs import strict_yaml
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

RUN = "run two-chains -o out"
NEEDS = "run: needs a SCENE and -o DIR, or --resume DIR"
RESUMED = "--resume: continues with the settings of the run; leave out"

COMMAND_LINES = [
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
    ("run two-chains-gapped -o out --engine reference --ranks 2", "--ranks"),
    *((f"run --resume here {words}", RESUMED) for words in ("two-chains", "-o x", "--engine lammps", "--overwrite")),
    ("run --resume here --force", RESUMED),
    ("analyze run --formats png,tiff", "'png,tiff' given; of png, pdf, svg, with commas between"),
    ("collect .", "holds no run directories; `granchain sweep` makes some"),
    ("collect nowhere", "no such directory"),
]


FILES = {
    "sweep.yaml": {"scene": SMALL, "vary": {"beads": [12]}},
}


@pytest.mark.parametrize(("words", "says"), COMMAND_LINES, ids=[words for words, _ in COMMAND_LINES])
def test_a_command_line_that_makes_no_sense_is_one_line_and_nothing_is_written(words, says, tmp_path, capsys):
    files = {name: strict_yaml.dump(content) for name, content in FILES.items()}
    assert_command_line_is_refused(words, says, files, tmp_path, capsys)


def test_more_ranks_than_rows_are_refused(tmp_path, capsys):
    if mpi.cores() < 3:
        pytest.skip("two rows and three ranks need three cores")
    short = tmp_path / "short.yaml"
    short.write_text(scene_text(beads="2"))
    assert "ranks divide the 2 rows" in refusal(["run", short, "-o", tmp_path / "out", "--ranks", 3], capsys)


# --- files of sweeps --------------------------------------------------------------------------------------------------

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
    (T + "vary: {output.every: [3.0]}", "too far to find waves between them; at most 2"),
    (T + "vary: {timestep: [2.0], output.every: [2.0]}", "timestep: 2 is unstable"),
    (T + "vary: !!python/object/apply:os.system [ls]", "tags"),
]


@pytest.mark.parametrize(("text", "says"), SWEEPS, ids=[says for _, says in SWEEPS])
def test_a_bad_sweep_is_one_line_that_names_its_file_and_nothing_is_written(text, says, tmp_path, capsys):
    assert_file_is_refused("sweep", text, says, tmp_path, capsys)
