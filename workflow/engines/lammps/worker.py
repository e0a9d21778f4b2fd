"""The process in which LAMMPS lives: runs the deck of a directory in segments, checks each, reports on stdout.

Started as ``python -m workflow.engines.lammps.worker PART SECONDS PROBLEM`` in a run directory, alone or by mpiexec:
part 1 of the frames begins at the start, a later one at the restart there is; a restart is written every so many
seconds; the problem is in a file, pickled. Each
line of its output is a JSON object: ``{"step", "bead"}`` after a segment, and at the end one with ``"end"``: done,
stopped or failed. It stops, with a restart, when its standard input closes, so it never outlives the process that
started it.
"""

import contextlib
import errno
import importlib
import json
import os
import pickle
import select
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from analysis import motion
from analysis.trajectory import Floats
from lammps_inputs import Problem, file_names, physics
from lammps_inputs.decks import continuation
from lammps_inputs.facts import Fact
from lammps_inputs.limits.rates import stability_bound
from workflow.engines.lammps import files_on_disk, mpi
from workflow.engines.lammps.files_on_disk import FramesOnDisk
from workflow.engines.lammps.stepping import Travel
from workflow.errors import first_line

SEGMENT_BEAD_STEPS = 10_000_000
"""Length of a segment: some 0.2 s on one core. Not measured as the run goes, since all ranks must agree on it."""

OPTIONS = ["-log", file_names.LOG, "-screen", "none", "-nocite", "-var", "steps", "0"]
"""Options of LAMMPS, with which the deck's own run does no step."""

CONTINUED = ["-log", "none", "-screen", "none", "-nocite"]

FIRST_SEGMENT = 200
"""Steps of the first segment; each next one is twice as long, so that a hopeless run ends early."""


Line = dict[str, Any]
"""A message about a run, see above."""

STOP, SAVE = 1.0, 2.0
"""Messages of the first rank to the others."""


def main() -> int:
    """Run the deck in the current directory; exit code 0 if it came to its end."""
    part, every = int(sys.argv[1]), float(sys.argv[2])
    try:
        problem = _problem_in(Path(sys.argv[3]))
        mpi.end_with_launcher()
        lmp = instance(part)
        leads = lmp.extract_setting("world_rank") == 0
        end = segments(lmp, problem, say if leads else None, part=part, every=every)
    except Exception as error:  # LAMMPS raises nothing more specific
        # every rank speaks, since some errors are known to one of them only
        reason = f"LAMMPS: {first_line(error)}"
        say({"end": "failed", "reason": reason, "disk": os.strerror(errno.ENOSPC) in reason})
        os._exit(1)  # after an error a LAMMPS instance cannot be trusted, not even to close
    if leads:
        say(end)
    if end["end"] != "done" and leads and (end.get("disk") or lmp.extract_setting("world_size") > 1):
        lmp.flush_buffers()
        os._exit(1)  # the others may be in the next segment, where only the launcher can end them
    lmp.close()
    lmp.finalize()
    return 0 if end["end"] == "done" else 1


def _problem_in(path: Path) -> Problem:
    """The problem that was handed over in a file."""
    if os.environ.get("GRANCHAIN_INGREDIENTS"):  # modules with laws of a user's own import this, which imports them
        importlib.import_module("lammps_inputs.ingredients")
    problem: Problem = pickle.loads(path.read_bytes())
    return problem


def instance(part: int) -> Any:
    """An instance of LAMMPS that has read the deck or, for a later part, its continuation, and done no step."""
    mpi.preload()
    import lammps  # only now can it find its MPI library

    lmp: Any = lammps.lammps(cmdargs=OPTIONS if part == 1 else CONTINUED)
    deck = file_names.DECK
    if part > 1:
        lmp.command(f"log {file_names.LOG} append")
        lmp.command("variable steps equal step")
        lmp.command(f"variable dump index {continuation.dump_part(part)}")
        deck = file_names.CONTINUE
    lmp.file(deck)
    return lmp


def segments(lmp: Any, problem: Problem, tell: Callable[[Line], None] | None, *, part: int, every: float) -> Line:
    """Segments of the run until its end, a fault, or a closed standard input.

    Args:
        lmp: has read the deck.
        problem: the deck's problem.
        tell: called after each segment; None on a rank that leaves that to another.
        part: number of the file of frames.
        every: seconds from restart to restart.
    """
    leads = tell is not None
    largest = max(1, SEGMENT_BEAD_STEPS // (problem.chains * problem.rows.existing))
    # a restart falls between two cycles of the scheme, and where the window may follow
    stride = problem.steps_between_stops
    begun = done = int(lmp.extract_global("ntimestep"))
    frames = Path(continuation.dump_part(part))
    travel = Travel(lmp, problem)
    saved = files_on_disk.Restarts(lmp, continuation.restart_lines(problem), frames, every=every, leads=leads)
    on_disk = FramesOnDisk(frames, problem, begun)
    computing, size = 0.0, min(FIRST_SEGMENT, largest)
    while done < problem.steps:
        goal = min(done + max(1, size // stride) * stride - done % stride, problem.steps)
        started = time.perf_counter()
        travel.advance(goal - done)
        computing += time.perf_counter() - started
        done = goal
        reached = int(lmp.extract_global("ntimestep"))
        if reached != done:
            return {"end": "failed", "reason": f"LAMMPS stopped at step {reached} instead of {done}"}
        word = 0.0
        if leads:
            word = STOP if _abandoned() else SAVE if saved.due() else 0.0
        displacement, velocity = travel.state(word)
        if leads and not on_disk.whole(done):
            reason = f"{frames} does not hold all frames until step {done}; is the disk full?"
            return {"end": "failed", "reason": reason, "disk": True}
        wrong = fault(problem, displacement, velocity, first=travel.first, elsewhere=travel.energy_behind)
        if wrong is not None:
            return {"end": "failed", "reason": f"by step {done}, {wrong}", "step": done}
        moving = np.flatnonzero(np.any(np.abs(velocity) > 1e-3, axis=0))
        if tell is not None:
            tell({"step": done, "bead": int(moving[-1]) + travel.first if len(moving) else 1})
        if travel.heard and done < problem.steps:
            try:
                saved.write()
            except OSError as error:
                return {"end": "failed", "reason": f"at step {done}, {error}", "step": done, "disk": True}
            if travel.heard == STOP:
                return {"end": "stopped", "step": done, "seconds": computing, "lammps": lmp.version()}
        size = min(2 * size, largest)
    return {"end": "done", "step": done, "seconds": computing, "lammps": lmp.version()}


def say(line: Line) -> None:
    """Print one message as a line on standard output."""
    with contextlib.suppress(BrokenPipeError):  # nobody listens any more: the run stops soon
        # a line break on either side, since mpiexec may join what two ranks say at once
        sys.stdout.write(f"\n{json.dumps(line)}\n")
        sys.stdout.flush()


def _abandoned() -> bool:
    ready, _, _ = select.select([sys.stdin], [], [], 0.0)
    return bool(ready) and not os.read(sys.stdin.fileno(), 1)


# --- what every state of a run must satisfy: LAMMPS itself reports none of it, and computes on with wrong numbers -----

ENERGY_TOLERANCE = 0.02
"""Relative deviation of the energy beyond which a run is stopped; at the default step it stays near 1e-5."""


def fault(
    problem: Problem, displacement: Floats, velocity: Floats, *, first: int = 1, elsewhere: float = 0.0
) -> str | None:
    """What is wrong with a state, and what to do; None if nothing is.

    Args:
        problem: what is computed.
        displacement: [line, row] of the chains and of further lines of atoms, in units of L.
        velocity: [line, row], in units of V.
        first: bead that the rows begin with.
        elsewhere: energy of the beads that are not in these rows, in units of m V**2.
    """
    system = problem.system
    if not (np.all(np.isfinite(displacement)) and np.all(np.isfinite(velocity))):
        return f"a bead's position or velocity is no longer a finite number; {_remedy(problem)}"
    overlap = motion.overlaps(system, displacement[: problem.chains], first)
    worst = np.unravel_index(np.argmax(overlap), overlap.shape)
    bead = int(worst[1]) + first
    where = f"beads {bead} and {bead % problem.beads + 1} of chain {worst[0] + 1}"
    if overlap[worst] >= problem.layout.diameter:
        return f"{where} have passed through each other; {_remedy(problem)}"
    if overlap[worst] >= problem.layout.diameter / 2.0:
        return (
            f"{where} overlap by {overlap[worst]:.3g}, more than half a diameter ({problem.layout.diameter / 2.0:g}); "
            f"{_remedy(problem)}"
        )
    if physics.driven(system):  # which puts in energy without end
        return None
    energy = float(motion.energy(system, displacement, velocity, first)) + elsewhere
    if system.weights:  # whose work is no part of the energy at the start, and has no bound where all fall
        kinetic = float(np.sum(motion.kinetic_energy(system, velocity, first)))
        energy += float(physics.weight_energy(system, physics.initial_state(system)[0])) - physics.energy_at_start(
            system
        )
        change = energy / max(physics.energy(system), kinetic)
    else:
        change = energy / physics.energy(system) - 1.0
    if change > ENERGY_TOLERANCE and (system.loads or system.dampers or not system.holds(Fact.FRAMES)):
        bound = "the largest possible work of the pushes" if system.loads else "the energy input"
        return f"the energy is {100.0 * change:.3g}% above {bound}; {_remedy(problem)}"
    if system.holds(Fact.ENERGY) and not system.loads and abs(change) > ENERGY_TOLERANCE:
        return f"the energy has changed by {100.0 * change:.3g}%; {_remedy(problem)}"
    return None


def _remedy(problem: Problem) -> str:
    bound = stability_bound(problem.system) * problem.scale.time
    step = problem.timestep * problem.scale.time
    smaller = f"take a smaller timestep (it is {step:.3g}, unstable above {bound:.3g})"
    if not physics.varying(problem.system):
        return smaller
    return f"if the oscillations grow on the foundation, run for a shorter time or modulate less; else {smaller}"


if __name__ == "__main__":
    sys.exit(main())
