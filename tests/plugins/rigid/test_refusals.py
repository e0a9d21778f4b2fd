"""What the engine of rigid beads refuses, and what their runs do not have."""

import pytest
from ingredient_scenes import scene
from refusals import assert_command_line_is_refused
from sweeps import SMALL

from lammps_inputs import InputError, strict_yaml
from lammps_inputs.library import from_plain
from workflow.runs.run import run
from workflow.verdicts.analysis_files import analyse


@pytest.mark.parametrize("name", ["foundation", "walls", "dimer", "ring", "damping viscoelastic, cut"])
def test_rigid_beads_refuse_what_they_cannot_have(name, tmp_path):
    with pytest.raises(InputError, match="collisions"):
        run(scene(name, gap=1.0), tmp_path / "run", engine="collisions")


def test_rigid_beads_have_no_hertzian_contacts(tmp_path):
    steel = {"radius": 4.76e-3, "density": 8000.0, "youngs_modulus": 193e9, "poisson_ratio": 0.3}
    plain = {"name": "rigid", "beads": 4, "gap": 1e-5, "material": steel, "kick": {"velocity": 1.0}, "duration": 1e-4}
    result = run(from_plain(plain, "rigid"), tmp_path / "run", engine="collisions")
    assert result.directory.job.contacts is None
    assert "contacts" not in analyse(result.directory, figures=False).measurements


FILES = {"sweep.yaml": strict_yaml.dump({"scene": SMALL, "vary": {"beads": [20]}, "engine": "collisions"})}


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (
            "run two-chains -o out --engine collisions",
            "--engine: `collisions` moves rigid beads, which need a gap",
        ),
        ("run two-chains-gapped -o out --engine collisions --ranks 2", "--ranks"),
        ("sweep sweep.yaml -o out", "rigid beads"),
    ],
)
def test_a_command_that_asks_for_what_rigid_beads_cannot_do_is_refused_in_one_line(words, says, tmp_path, capsys):
    assert_command_line_is_refused(words, says, FILES, tmp_path, capsys)
