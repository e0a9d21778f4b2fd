"""Help, versions, completion, and answers for scripts."""

import json
import shlex
import subprocess
import sys

import pytest
from processes import HANGS

from lammps_inputs import plugins
from workflow import cli
from workflow.cli import ALIASES, COMMANDS, main
from workflow.quantities.columns import QUANTITIES

SCENE = "name: tiny\nbeads: 4\nkick: {velocity: 1}\nduration: 2\n"


@pytest.fixture
def tiny(tmp_path, monkeypatch):
    """A directory with a scene, and a run of it."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "tiny.yaml").write_text(SCENE)
    assert main(["run", "tiny.yaml", "-o", "run", "--engine", "reference", "--quiet"]) == 0
    return tmp_path


def said(capsys, *words):
    assert main(list(words)) == 0
    return capsys.readouterr().out


def test_version_says_what_numbers_depend_on(capsys):
    with pytest.raises(SystemExit) as left:
        main(["--version"])
    assert left.value.code == 0
    out = capsys.readouterr().out
    assert all(name in out for name in ("granchain ", "lammps 20", "numba "))


@pytest.mark.parametrize("command", [*COMMANDS, *ALIASES])
def test_every_command_explains_itself_and_ends_with_examples_that_parse(command, capsys):
    with pytest.raises(SystemExit) as left:
        main([command, "--help"])
    assert left.value.code == 0
    name = ALIASES.get(command, command)
    usage, _, examples = capsys.readouterr().out.partition("\nexamples:\n")
    assert usage.startswith(f"usage: granchain {name}")
    lines = examples.splitlines()
    assert len(lines) >= 2
    for line in lines:
        words = shlex.split(line.partition("#")[0].partition(">")[0])
        assert words[:2] == ["granchain", name]
        cli.parser([name]).parse_args(words[1:])


@pytest.mark.usefixtures("tiny")
def test_quiet_says_nothing(capsys):
    assert main(["analyze", "run", "--no-figures", "--quiet"]) == 0
    assert capsys.readouterr() == ("", "")


def test_quiet_still_says_what_is_wrong(capsys):
    assert main(["show", "no-such", "--quiet"]) == 2
    assert capsys.readouterr().err.startswith("granchain: 'no-such'")


@pytest.mark.usefixtures("tiny")
@pytest.mark.parametrize(
    ("words", "key"),
    [
        ("scenes", "two-chains"),
        ("show tiny.yaml", "duration"),
        ("run tiny.yaml -o other --engine reference", "uncertainty"),
        ("analyze run --no-figures", "energy_drift"),
        ("validate run", "passed"),
    ],
)
def test_json_is_one_object_and_nothing_else(words, key, capsys):
    assert key in json.loads(said(capsys, *words.split(), "--json"))


@pytest.mark.usefixtures("tiny")
def test_json_of_status_is_a_list(capsys):
    assert [one["state"] for one in json.loads(said(capsys, "status", "run", "--json"))] == ["done"]


def test_help_explains_keys_and_commands(capsys):
    assert "Springs between" in said(capsys, "help", "coupling.rows")
    assert "Clear distance" in said(capsys, "help", "scene")
    assert all(f"in {key}:" in said(capsys, "help", "restitution") for key in ("contact", "damping"))
    assert all(f"in {key}:" in said(capsys, "help", "stiffness") for key in ("contact", "kinds", "coupling"))
    assert "COMMAND" in said(capsys, "help")
    with pytest.raises(SystemExit):
        main(["help", "run"])
    assert "usage: granchain run" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "explanation"),
    [
        ("leading pulse", "first pulse that reaches a bead of a chain"),
        ("beat length", "beat_length\n"),
        ("peak velocity", "analysis.json: waves > peak_velocity"),
        ("contact force", "Force as a formula of s"),
        ("budget", "analysis.json: budget holds time, energy_input, kinetic"),
        ("budget.closed", "largest missing over the largest energy_input"),
        ("notation", "kappa\n      dimensionless coupling stiffness"),
        ("Static load", "Static load. F_(0,n) is the force in contact n at rest"),
        ("contact constant", "A = 4/3 E^* sqrt(R^*), 1 / (E^*) = 1 / (E'_1)"),
        ("steady", "the variation is at most 1%"),
        ("too short", "no half beat was seen"),
        ("asymptotic amplitude", "mean over chains and the last half beat"),
    ],
)
def test_help_explains_phrases_keys_of_results_sections_of_the_model_and_terms_of_verdicts(words, explanation, capsys):
    assert explanation in said(capsys, "help", *words.split())


def test_help_refuses_a_phrase_that_no_page_has(capsys):
    assert main(["help", "leading", "elephant"]) == 2
    assert "'leading elephant' is no key of a scene" in capsys.readouterr().err


@pytest.mark.parametrize("name", QUANTITIES)
def test_help_says_where_a_quantity_stands(name, capsys):
    lines = said(capsys, "help", name).splitlines()
    assert name == lines[0]
    assert any(
        line.strip().startswith(QUANTITIES[name].file) and line.endswith(QUANTITIES[name].path[-1]) for line in lines
    )
    assert any(line.strip().startswith("granchain collect: column") and name in line for line in lines)


@pytest.mark.parametrize("kind", plugins.declared("schemas"))
def test_schema_prints_json(kind, capsys):
    assert json.loads(said(capsys, "schema", kind)) == plugins.load("schemas", kind)()


def test_new_writes_a_scene_and_never_over_a_file(tmp_path, capsys):
    path = tmp_path / "mine.yaml"
    said(capsys, "new", str(path))
    before = path.read_text()
    said(capsys, "show", str(path))
    assert main(["new", str(path)]) == 2
    assert "exists already" in capsys.readouterr().err
    assert path.read_text() == before


def test_bash_takes_the_completion_and_offers_commands(capsys):
    script = said(capsys, "completion", "bash")
    ask = "\nCOMP_WORDS=(granchain va); COMP_CWORD=1; _shtab_granchain; echo ${COMPREPLY[@]}"
    done = subprocess.run(["bash", "-c", script + ask], capture_output=True, text=True, timeout=HANGS, check=True)
    assert done.stdout.split() == ["validate"]


@pytest.mark.slow
def test_folders_called_as_the_packages_are_do_not_hide_them(tmp_path):
    for name in ("analysis", "workflow", "lammps_inputs"):
        (tmp_path / name).mkdir()
    (tmp_path / "analysis" / "__init__.py").write_text("raise SystemExit('the wrong one')")
    words = [sys.executable, "-m", "workflow", "show", "two-chains"]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, timeout=HANGS, check=True)
    assert done.stdout.startswith("name: two-chains")


def test_packages_of_others_over_ours_are_named_in_one_line(tmp_path):
    theirs = tmp_path / "workflow-2.1.6.dist-info"
    theirs.mkdir()
    (theirs / "METADATA").write_text("Metadata-Version: 2.1\nName: workflow\nVersion: 2.1.6\n")
    code = f"import sys; sys.path.append({str(tmp_path)!r}); sys.modules['workflow.errors'] = None; import workflow.cli"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=HANGS, check=False)
    assert done.returncode == 1
    assert done.stderr.splitlines() == [
        "granchain: other packages of the same name lie over its own: workflow; "
        "`pip uninstall workflow`, then `pip install --force-reinstall --no-deps granchain`"
    ]
