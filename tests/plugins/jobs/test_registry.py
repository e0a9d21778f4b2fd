"""A scheduler that another distribution declares is one of ``--scheduler``, and `granchain status` knows its jobs."""

import os
import subprocess
import sys

import pytest
from sweeps import SMALL

from lammps_inputs import strict_yaml

MODULE = """
from dataclasses import replace
from workflow.plugins.jobs.schedulers import PBS

OAR = replace(PBS, title="OAR", submit="oarsub -S", script="job.oar", queue=lambda ask: None)
"""


@pytest.fixture
def granchain(tmp_path):
    """The command beside a distribution that declares the scheduler `oar`."""
    metadata = tmp_path / "site" / "oar_jobs-1.0.dist-info"
    metadata.mkdir(parents=True)
    (metadata / "METADATA").write_text("Metadata-Version: 2.3\nName: oar-jobs\nVersion: 1.0\n")
    (metadata / "entry_points.txt").write_text("[granchain.schedulers]\noar = oar_jobs:OAR\n")
    (tmp_path / "site" / "oar_jobs.py").write_text(MODULE)
    paths = [str(tmp_path / "site"), *filter(None, [os.environ.get("PYTHONPATH")])]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(paths), "HOME": str(tmp_path)}

    def run(*words):
        command = [sys.executable, "-P", "-m", "workflow", *words]
        return subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=True).stdout

    return run


@pytest.mark.slow
def test_a_scheduler_of_another_distribution_writes_its_script_and_its_jobs_have_states(granchain, tmp_path):
    (tmp_path / "s.yaml").write_text(strict_yaml.dump({**SMALL, "timestep": 0.01}))
    assert "`oarsub -S job.oar` there submits the job" in granchain("deck", "s.yaml", "-o", "job", "--scheduler", "oar")
    assert (tmp_path / "job" / "job.oar").is_file()
    assert granchain("status", "job") == "job: written: `oarsub -S job.oar` there starts it\n"
