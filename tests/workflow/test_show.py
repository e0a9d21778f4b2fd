"""`granchain show` prints at once: without `--pilot` it computes nothing but the scene."""

import resource
import subprocess
import sys

import pytest
from processes import HANGS

from lammps_inputs import strict_yaml

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
