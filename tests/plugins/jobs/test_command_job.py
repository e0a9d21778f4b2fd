"""Any command as a Slurm job, through a real Slurm."""

import pytest
from processes import wait_until

from workflow.plugins.jobs import site
from workflow.plugins.jobs.job import render_command

pytest_plugins = ("slurm",)


@pytest.mark.slow
def test_a_job_that_is_stopped_before_its_time_limit_submits_the_next_which_goes_on(slurm, tmp_path):
    """The command is one that does not end by itself the first time."""
    script = (
        "[ -f done ] && echo again && exit; trap 'kill $!; touch done; exit 130' TERM; touch up; sleep infinity & wait"
    )
    command = ["bash", "-c", script]
    text = render_command(site.options({"time": "00:10:00"}), "stopped", command, cores=1)
    (tmp_path / "job.sbatch").write_text(text)
    number = slurm.submit(tmp_path)
    assert wait_until((tmp_path / "up").is_file)
    slurm.call("scancel", "--batch", "--signal=TERM", number)
    slurm.wait()
    assert "again" in (tmp_path / "job.out").read_text()
