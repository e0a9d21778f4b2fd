"""A scheduler that another distribution declares, as the page on how to add one shows, is one of ``--scheduler``."""

import subprocess

import pytest
from extending import apply, granchain, python
from sweeps import SMALL

from lammps_inputs import strict_yaml

CODE = r"""if True:
    from workflow.plugins.jobs import job
    from workflow.plugins.jobs.lsf import LSF
    from workflow.plugins.jobs.schedulers import ListedJob
    from workflow.plugins.jobs.site import JobOptions
    answers = {"lsid": "IBM LSF\nMy cluster name is hpc\n", "bjobs": "17|0|RUN|/a b\n18|2|PEND|/c\n"}
    expected = [ListedJob("17", False, None, "/a b"), ListedJob("18.2", True, 1, "/c")]
    assert LSF.queue(lambda command, *_: answers[command]) == ("hpc", expected)
    assert LSF.queue(lambda *_: None) is None
    print(job.render_array(JobOptions(scheduler="lsf", array_limit=3), ["a", "b"])["job.lsf"])"""


@pytest.mark.slow
def test_the_scheduler_writes_its_scripts_and_reads_its_queue(executable, tmp_path):
    executable("git")
    tree, environment = tmp_path, {**apply("A scheduler", tmp_path), "HOME": str(tmp_path)}
    (tree / "s.yaml").write_text(strict_yaml.dump({**SMALL, "timestep": 0.01}))
    words = ("--scheduler", "lsf", "--nodes", "2", "--ranks-per-node", "4", "--time", "1-12:30:01")
    printed = granchain(environment, tree, "deck", "s.yaml", "-o", "job", *words, "--partition", "long")
    assert "`bsub < job.lsf` there submits the job" in printed
    assert "`bsub < job.lsf` there starts it" in granchain(environment, tree, "status", "job")
    script = (tree / "job" / "job.lsf").read_text()
    assert [line for line in script.splitlines() if line.startswith("#BSUB")] == [
        '#BSUB -J "small" -L /bin/bash -o /dev/null',
        '#BSUB -W 36:31 -n 8 -R "span[ptile=4]"',
        "#BSUB -q long",
    ]
    array = python(environment, tree, "-c", CODE)
    assert '#BSUB -J "sweep[1-2]%3" ' in array
    for text in (script, array):
        subprocess.run(["bash", "-n"], input=text, text=True, check=True)
