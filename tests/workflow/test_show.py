"""`granchain show` prints at once: without `--pilot` it computes nothing but the scene."""

import resource
import subprocess
import sys

import pytest
from processes import HANGS

from lammps_inputs import library, strict_yaml
from workflow.cli import main
from workflow.prepare.settings import settle

BALL = {"name": "steel-52100", "radius": 0.015}
CRADLE = {"name": "a", "beads": 5, "gap": 5e-4, "material": BALL, "kick": {"velocity": 0.3}, "duration": 0.6}
SLOW = {
    "cradle": {**CRADLE, "damping": {"contact": 0.95, "law": "restitution"}},
    "until a bead": {"name": "a", "chains": 9, "beads": 5000, "kick": {"velocity": 1}, "until_bead": 5000},
}


def processor_seconds(words):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(words, capture_output=True, timeout=HANGS, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


@pytest.mark.slow
@pytest.mark.parametrize("kind", SLOW)
def test_show_takes_less_than_a_second_more_than_its_imports(kind, tmp_path):
    """It takes less than a second with them on a quiet machine; the first use of a formula derives it, once."""
    path = tmp_path / "scene.yaml"
    path.write_text(strict_yaml.dump(SLOW[kind]))
    words = [sys.executable, "-m", "workflow", "show", str(path)]
    processor_seconds(words)
    imports = processor_seconds([sys.executable, "-c", "import workflow.cli, workflow.commands.show"])
    assert processor_seconds(words) < 1.0 + imports


def printed(text, directory, capsys, *options):
    path = directory / "scene.yaml"
    path.write_text(text, encoding="utf-8")
    assert main(["show", str(path), *options]) == 0
    return capsys.readouterr().out


@pytest.mark.slow
@pytest.mark.parametrize("end", [{"until_bead": 7}, {"duration": 10.0}], ids=str)
def test_with_trials_show_prints_a_scene_that_is_the_problem_that_runs_and_prints_again(end, tmp_path, capsys):
    text = strict_yaml.dump({"name": "a", "beads": 12, "kick": {"velocity": 1.0}, **end})
    found = printed(text, tmp_path, capsys, "--pilot")
    scene, settled = (library.from_plain(strict_yaml.parse(each, "here"), "here") for each in (text, found))
    assert settle(scene)[0].problem() == settled.problem()
    assert settled.resolved() == settled
    chosen = [line for line in found.splitlines() if not line.startswith("# time step ")]
    assert printed(found, tmp_path, capsys).splitlines() == chosen
