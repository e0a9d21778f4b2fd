"""Designs and fits as Slurm jobs, through a real Slurm."""

import json

import measured
import pytest
from plug_ins import needs

from lammps_inputs import strict_yaml
from workflow.cli import main

pytest_plugins = ("slurm",)

DESIGN = {
    "scene": {
        "name": "small",
        "beads": 10,
        "walls": {"right": "rigid"},
        "kick": {"velocity": 1},
        "duration": 20,
    },
    "vary": {"beads": [10, 11]},
    "minimize": "wall_force",
    "manufacture": {"members": 2},
    "verify": 1,
}


def design_file(directory):
    path = directory / "design.yaml"
    path.write_text(strict_yaml.dump(DESIGN))
    return path


@needs("design")
def test_a_design_and_a_fit_are_jobs_on_one_node_that_say_what_they_ask_for(tmp_path, capsys):
    path = design_file(tmp_path)
    options = ["--slurm", "--time", "00:10:00", "--partition", "main"]
    assert main(["design", str(path), "-o", str(tmp_path / "d"), "--jobs", "2", *options]) == 0
    assert "sbatch job.sbatch" in capsys.readouterr().out
    text = (tmp_path / "d" / "job.sbatch").read_text()
    assert " --cpus-per-task=2\n" in text
    assert " --signal=B:TERM@60\n" in text
    assert main(["design", str(path), "-o", str(tmp_path / "d"), *options, "--nodes", "2"]) == 2
    assert "--nodes: 2 given" in capsys.readouterr().err


@pytest.mark.slow
@needs("design", "fit")
def test_slurm_carries_out_a_design_and_a_fit(slurm, tmp_path):
    path = design_file(tmp_path)
    assert main(["design", str(path), "-o", str(tmp_path / "d"), "--slurm", "--time", "00:10:00"]) == 0
    scene, data = tmp_path / "scene.yaml", measured.table(tmp_path / "data.csv", names=measured.NAMES[:1])
    scene.write_text(strict_yaml.dump(measured.scene(modulus=1.05)))
    words = ["fit", str(scene), "--against", str(data), "--free", "material.youngs_modulus", "-o", str(tmp_path / "f")]
    assert main([*words, "--slurm", "--time", "00:10:00"]) == 0
    for name in ("d", "f"):
        slurm.submit(tmp_path / name)
    slurm.wait()
    said = (tmp_path / "d" / "job.out").read_text() + (tmp_path / "f" / "job.out").read_text()
    assert (tmp_path / "d" / "index.html").is_file(), said
    found = json.loads((tmp_path / "f" / "fit.json").read_text())
    assert found["free"]["material.youngs_modulus"]["value"] == pytest.approx(measured.MODULUS, rel=0.02)
