"""Designs and fits as Slurm jobs, through a real Slurm."""

import json

import measured
import pytest
from plug_ins import needs

from lammps_inputs import strict_yaml
from workflow.cli import main

pytest_plugins = ("slurm",)

DESIGN = {
    "scene": {"name": "small", "beads": 10, "walls": {"right": "rigid"}, "kick": {"velocity": 1}, "duration": 20},
    "vary": {"beads": [10, 11]},
    "minimize": "wall_force",
    "manufacture": {"members": 2},
    "verify": 1,
}


@pytest.mark.slow
@needs("design", "fit")
def test_a_design_and_a_fit_are_jobs_on_one_node_that_slurm_carries_out(slurm, tmp_path, capsys):
    design, scene, data = (tmp_path / name for name in ("design.yaml", "scene.yaml", "data.csv"))
    design.write_text(strict_yaml.dump(DESIGN))
    scene.write_text(strict_yaml.dump(measured.scene(modulus=1.05)))
    measured.table(data, names=measured.NAMES[:1])
    options = ["--slurm", "--time", "00:10:00", "--jobs", "2"]
    words = ["design", str(design), "-o", str(tmp_path / "d"), *options]
    assert main([*words, "--nodes", "2"]) == 2
    assert "--nodes: 2 given" in capsys.readouterr().err
    assert main(words) == 0
    assert "sbatch job.sbatch" in capsys.readouterr().out
    assert " --cpus-per-task=2\n" in (tmp_path / "d" / "job.sbatch").read_text()
    words = ["fit", str(scene), "--against", str(data), "--free", "material.youngs_modulus", "-o", str(tmp_path / "f")]
    assert main([*words, *options]) == 0
    for name in ("d", "f"):
        slurm.submit(tmp_path / name)
    slurm.wait()
    said = (tmp_path / "d" / "job.out").read_text() + (tmp_path / "f" / "job.out").read_text()
    assert (tmp_path / "d" / "index.html").is_file(), said
    found = json.loads((tmp_path / "f" / "fit.json").read_text())
    assert found["free"]["material.youngs_modulus"]["value"] == pytest.approx(measured.MODULUS, rel=0.02)
