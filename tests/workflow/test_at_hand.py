"""Help of commands, versions, and answers for scripts."""

import json
import shlex
import subprocess
import sys

import pytest
from plug_ins import WITHOUT
from processes import HANGS

from workflow import cli
from workflow.cli import ALIASES, COMMANDS, main


def said(capsys, *words):
    assert main(list(words)) == 0
    return capsys.readouterr().out


@pytest.mark.parametrize("command", [*COMMANDS, *ALIASES])
def test_every_command_explains_itself_and_ends_with_examples_that_parse(command, capsys):
    with pytest.raises(SystemExit) as left:
        main([command, "--help"])
    assert left.value.code == 0
    name = ALIASES.get(command, command)
    usage, _, examples = capsys.readouterr().out.partition("\nexamples:\n")
    assert usage.startswith(f"usage: granchain {name}")
    lines = examples.splitlines()
    assert len(lines) >= (1 if "jobs" in WITHOUT else 2)
    for line in lines:
        words = shlex.split(line.partition("#")[0].partition(">")[0])
        assert words[:2] == ["granchain", name]
        cli.parser([name]).parse_args(words[1:])


@pytest.mark.slow
def test_json_is_one_object_and_nothing_else(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "tiny.yaml").write_text("name: tiny\nbeads: 4\nkick: {velocity: 1}\nduration: 2\n")
    for words, key in (
        ("scenes", "two-chains"),
        ("show tiny.yaml", "duration"),
        ("run tiny.yaml -o run --engine reference", "uncertainty"),
        ("analyze run --no-figures", "energy_drift"),
        ("validate run", "passed"),
    ):
        assert key in json.loads(said(capsys, *words.split(), "--json"))
    assert [one["state"] for one in json.loads(said(capsys, "status", "run", "--json"))] == ["done"]


def test_new_writes_a_scene_and_never_over_a_file(tmp_path, capsys):
    path = tmp_path / "mine.yaml"
    said(capsys, "new", str(path))
    before = path.read_text()
    said(capsys, "show", str(path))
    assert main(["new", str(path)]) == 2
    assert "exists already" in capsys.readouterr().err
    assert path.read_text() == before


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
