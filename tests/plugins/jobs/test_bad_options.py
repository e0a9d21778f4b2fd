"""Options of jobs that cannot be used: one line that says what is wrong, exit code 2, and nothing written."""

import pytest
from refusals import assert_command_line_is_refused
from sweeps import SMALL

from lammps_inputs import strict_yaml
from workflow.plugins.jobs.registry import SCHEDULERS

DECK = "deck two-chains -o out"

COMMAND_LINES = [
    (f"{DECK} --nodes 2", "--nodes: is for a job; add --slurm"),
    (f"{DECK} --module gcc", "--module: is for a job; add --slurm"),
    (f"{DECK} --site x.yaml", "--site: is for a job; add --slurm"),
    (f"{DECK} --scheduler cron", f"--scheduler: invalid choice: 'cron' (choose from {str([*SCHEDULERS])[1:-1]})"),
    (f"{DECK} --scheduler pbs --partition a,b", "--partition: PBS Professional takes one queue, 'a,b' given"),
    (f"{DECK} --slurm --site nowhere.yaml", "nowhere.yaml: no such file"),
    (f"{DECK} --slurm --time 90", "--time: should be HH:MM:SS or D-HH:MM:SS, from a minute to a year ('90' given)"),
    (f"{DECK} --slurm --module 'a b'", "--module: a module should be one word such as lammps/2025.07"),
    ("deck quick.yaml -o out --slurm --nodes 100 --ranks-per-node 100", "--ranks-per-node: 10000 ranks in all"),
    ("sweep ref.yaml -o out --slurm", "engine: a job runs lammps"),
    ("sweep sweep.yaml -o out --nodes 2", "add --slurm"),
    ("sweep sweep.yaml -o out --slurm --partition 'a;ls'", "--partition"),
]

FILES = {
    "quick.yaml": {**SMALL, "timestep": 0.01},  # for which no pilot run is compiled
    "sweep.yaml": {"scene": SMALL, "vary": {"beads": [12]}},
    "ref.yaml": {"scene": SMALL, "vary": {"beads": [12]}, "engine": "reference"},
}


@pytest.mark.parametrize(("words", "says"), COMMAND_LINES, ids=[words for words, _ in COMMAND_LINES])
def test_a_command_line_that_makes_no_sense_is_one_line_and_nothing_is_written(words, says, tmp_path, capsys):
    files = {name: strict_yaml.dump(content) for name, content in FILES.items()}
    assert_command_line_is_refused(words, says, files, tmp_path, capsys)
