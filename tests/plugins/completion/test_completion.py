"""The script of `granchain completion` completes in bash."""

import subprocess

from processes import HANGS

from workflow.cli import main


def test_bash_takes_the_completion_and_offers_commands(capsys):
    assert main(["completion", "bash"]) == 0
    script = capsys.readouterr().out
    ask = "\nCOMP_WORDS=(granchain va); COMP_CWORD=1; _shtab_granchain; echo ${COMPREPLY[@]}"
    done = subprocess.run(["bash", "-c", script + ask], capture_output=True, text=True, timeout=HANGS, check=True)
    assert done.stdout.split() == ["validate"]
