"""Runs the deck of a directory through the LAMMPS Python module, in a process of its own."""

import json
import os
import pickle
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lammps_inputs import Problem
from workflow.engines.lammps import files_on_disk, mpi
from workflow.errors import EndedError, RunError, complaint, how_it_ended

RESTART_EVERY = files_on_disk.EVERY

Progress = Callable[[int, int], None]
"""Called with the steps done and the bead that the front has reached."""

_STOP_SECONDS = 20.0

_HUNG_SECONDS = 60.0
"""Seconds from Ctrl-C until LAMMPS is killed: a segment and a restart of what fits a machine take less."""


@dataclass(frozen=True)
class LammpsOutcome:
    """How LAMMPS ended.

    Attributes:
        end: "done" or "stopped".
        steps: steps done.
        seconds: wall time inside LAMMPS's time loop, output included.
        version: LAMMPS's version as a date, e.g. 20250722.
    """

    end: str
    steps: int
    seconds: float
    version: int


def refused_ranks(ranks: int, beads: int) -> str:
    """Why this machine, or chains of so many beads, cannot use a number of ranks; empty where they can.

    More ranks than cores slow MPI down a thousandfold.
    """
    if ranks < 1:
        return f"{ranks} given; at least 1"
    if ranks > mpi.cores():
        return f"{ranks} given, but {mpi.cores()} cores are available; more only slow a run down"
    if ranks > beads:
        return f"{ranks} given, but ranks divide the {beads} rows of beads"
    if ranks > 1 and mpi.launcher() is None:
        return "no mpiexec found beside Python or on the PATH; run with one rank"
    return ""


def run_deck(
    directory: Path,
    *,
    problem: Problem,
    ranks: int = 1,
    progress: Progress | None = None,
    part: int = 1,
    restart_every: float = RESTART_EVERY,
    lock: int | None = None,
) -> LammpsOutcome:
    """Run the deck in a directory to its end; Ctrl-C ends it at the next segment, with frames and a restart on disk.

    Args:
        directory: holds the deck; frames and log are written there.
        problem: the deck's problem.
        ranks: MPI ranks.
        progress: called after every segment.
        part: number of the file of frames; 1 begins at the start, a later one at the restart in the directory.
        restart_every: seconds of work that a kill may cost.
        lock: file descriptor that keeps others out of the directory, until LAMMPS has ended, too.

    Raises:
        EndedError: LAMMPS was killed, or the disk is full.
        RunError: LAMMPS failed, or a state of the run is none that there can be (`worker.fault`).

    Examples:
        >>> run_deck(Path("deck"), problem=granchain.load("one-chain").problem()).end  # doctest: +SKIP
        'done'
    """
    command = [sys.executable, "-P", "-m", "workflow.engines.lammps.worker", str(part), repr(float(restart_every))]
    if ranks > 1:
        command = [str(mpi.launcher()), "-n", str(ranks), *command]
    with tempfile.TemporaryFile("w+") as errors, tempfile.NamedTemporaryFile(prefix="granchain-problem-") as handed:
        pickle.dump(problem, handed)
        handed.flush()
        # a session of its own: Ctrl-C reaches this process, which then asks the other to stop
        process = subprocess.Popen(
            [*command, handed.name],
            cwd=directory,
            env=mpi.environment(),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=errors,
            text=True,
            start_new_session=True,
            pass_fds=() if lock is None else (lock,),
        )
        last, stopped = _followed(process, progress)
        errors.seek(0)
        reason = complaint(errors)
    if last.get("end") == "done":
        return LammpsOutcome("done", last["step"], last["seconds"], last["lammps"])
    if last.get("end") == "failed" and last.get("disk"):
        raise EndedError(last["reason"])
    if stopped or last.get("end") == "stopped":
        return LammpsOutcome("stopped", int(last.get("step", 0)), last.get("seconds", 0.0), last.get("lammps", 0))
    if last.get("end") == "failed":
        raise RunError(last["reason"])
    raise EndedError(f"LAMMPS {how_it_ended(process.returncode)} after step {last.get('step', 0)}. {reason}")


def _followed(process: "subprocess.Popen[str]", progress: Progress | None) -> tuple[dict[str, Any], bool]:
    """Last message of a process, once it has ended, and whether Ctrl-C stopped it."""
    assert process.stdin is not None
    assert process.stdout is not None
    last: dict[str, Any] = {}
    stopped = False
    patience = threading.Timer(_HUNG_SECONDS, os.killpg, (process.pid, signal.SIGKILL))
    patience.daemon = True
    try:
        while True:
            try:
                line = process.stdout.readline()
                if not line:
                    process.wait()
                    break
                last = _message(line) or last
                if progress is not None and "bead" in last:
                    progress(last["step"], last["bead"])
            except KeyboardInterrupt:
                if not stopped:  # a second one changes nothing: it stops already, or is killed if it hangs
                    stopped = True
                    process.stdin.close()
                    patience.start()
    finally:
        patience.cancel()
        _end(process)
        if stopped:
            patience.join()
    return last, stopped


def _message(line: str) -> dict[str, Any] | None:
    try:
        message = json.loads(line)
    except ValueError:
        return None
    return message if isinstance(message, dict) else None


def _end(process: "subprocess.Popen[str]") -> None:
    """End the process, by force if need be, and close its streams."""
    if process.poll() is None:
        if process.stdin is not None and not process.stdin.closed:
            process.stdin.close()
        try:
            process.wait(_STOP_SECONDS)
        except (subprocess.TimeoutExpired, KeyboardInterrupt):
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
    for stream in (process.stdin, process.stdout):
        if stream is not None:
            stream.close()
