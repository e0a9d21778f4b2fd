"""Jobs of Slurm, byte for byte as they were before other schedulers were served: the files are of that version."""

from pathlib import Path

import pytest
from stock_lammps import scene

from workflow.plugins.jobs import job
from workflow.plugins.jobs.schedulers import SLURM
from workflow.plugins.jobs.site import JobOptions

ALL = JobOptions(
    nodes=2,
    ranks_per_node=4,
    time="1-12:30:00",
    partition="long,short",
    account="grains",
    qos="high",
    constraint="milan",
    array_limit=3,
    modules=("gcc/12", "lammps"),
    launcher="srun --mpi=pmi2",
    max_jobs=7,
    checkpoint=60,
)


def written(kind):
    directory = Path("/a/b")
    if kind == "deck":
        return job.render_job(JobOptions(), scene(beads=8).problem(), directory)[SLURM.script]
    if kind == "array":
        files = job.render_array(ALL, ["a", ("b", "c"), "d"], tasks=[0, 2], directory=directory)
        return files[SLURM.script]
    options = JobOptions(modules=("gcc",))
    return job.render_command(options, "granchain-fit", ["granchain", "fit", "a b"], cores=4, directory=directory)


@pytest.mark.parametrize("kind", ["deck", "array", "command"])
def test_a_job_of_slurm_is_byte_for_byte_as_it_was(kind):
    assert written(kind) == (Path(__file__).parent / "jobs_of_slurm" / f"{kind}.sbatch").read_text()
