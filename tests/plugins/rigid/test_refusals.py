"""What the engine of rigid beads refuses, and what their runs do not have."""

import pytest
from ingredient_scenes import scene

from lammps_inputs import InputError, from_plain
from workflow.runs.run import run
from workflow.verdicts.analyse import analyse


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
