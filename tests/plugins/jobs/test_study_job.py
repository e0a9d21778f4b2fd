"""Designs and fits as jobs; ``test_clusters.py`` runs jobs of commands."""

import shlex

import pytest
from plug_ins import needs

from workflow.cli import main


@pytest.mark.parametrize(
    "words",
    [
        pytest.param(["design", "design.yaml"], marks=needs("design")),
        pytest.param(["fit", "one-chain", "--against", "data.csv", "--free", "kick.velocity"], marks=needs("fit")),
    ],
    ids=["design", "fit"],
)
def test_a_design_and_a_fit_are_jobs_on_one_node_that_type_the_command(words, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "design.yaml").write_text("scene: two-chains\nvary: {beads: [10, 11]}\nminimize: front\n")
    (tmp_path / "data.csv").write_text("time,velocity_1_3\n0,0\n1,0.1\n2,0\n")
    options = ["--slurm", "--time", "00:10:00", "--jobs", "2"]
    assert main([*words, "-o", "out", *options, "--nodes", "2"]) == 2
    assert "--nodes: 2 given" in capsys.readouterr().err
    assert main([*words, "-o", "out", *options]) == 0
    assert "sbatch job.sbatch" in capsys.readouterr().out
    script = (tmp_path / "out" / "job.sbatch").read_text()
    assert " --cpus-per-task=2\n" in script
    assert shlex.join(words[:1]) in script
