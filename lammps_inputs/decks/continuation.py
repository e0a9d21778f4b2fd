"""LAMMPS input that continues from a restart: ``in.continue``, and the lines that write the restart.

The continued run is bit for bit the uninterrupted one, on any number of ranks. Which beads are neighbours, which rank
owns them and in which order their forces are added up is settled once, with the beads at rest. So a restart holds the
beads at rest: each one's place is parked in its ``vy``, which is zero by construction, and is taken from there when
LAMMPS has settled everything as at the start. The forces at those places are computed by a step in which no bead moves.
With damping they are those of velocities of half a step before, and of contacts that yield those of overlaps before the
step, so they are kept, too, in ``vz``.

Frames of a continued run stand in ``chains.dump.bin``, ``chains.dump.2.bin``, ``chains.dump.3.bin`` and so on; the
first one that a step stands in counts.

Examples:
    >>> problem = granchain.load("one-chain").problem()
    >>> continuation.render_continuation(problem).splitlines()[0]
    '# one-chain, continued from a restart: bitwise the same result, on any number of ranks'
    >>> continuation.onward_lines(problem)
    ['run ${steps} upto pre no']
"""

from lammps_inputs import file_names, scheme, static_load, window
from lammps_inputs.decks import deck
from lammps_inputs.facts import Fact
from lammps_inputs.numbers import text
from lammps_inputs.problem import Problem
from lammps_inputs.system import System

_TIMED_SINCE = 20230802
"""Earlier releases know the time since the restart only."""


def dump_part(number: int) -> str:
    """Name of a part of the frames, counted from 1."""
    return file_names.DUMP if number == 1 else f"chains.dump.{number}.bin"


_FROM_REST = ("variable displaced atom vy", "set group all x v_displaced", "set group all vy 0.0")
"""Takes beads from rest to their places."""


def restart_lines(problem: Problem) -> list[str]:
    """Write a restart between two runs, and change nothing: the next one may continue with ``run ... pre no``.

    The caller renames `file_names.UNFINISHED` to `file_names.RESTART` when it is whole. In a scheme of several substeps
    the step must be one between two cycles.
    """
    forces, layout = _keeps_forces(problem.system), problem.layout
    return [
        "variable parked atom x",
        # where LAMMPS had a bead at rest, to the last bit
        f"variable rest atom {f'mol*{text(layout.spacing)}' if problem.rows.follow else layout.place_formula}",
        "set group all vy v_parked",
        *(["variable force atom fx", "set group all vz v_force"] if forces else []),
        "set group all x v_rest",
        f"write_restart {file_names.UNFINISHED} noinit",
        *_FROM_REST,
        *(["set group all vz 0.0"] if forces else []),
    ]


def render_continuation(problem: Problem) -> str:
    """The text of ``in.continue``.

    Variables to set: ``restart``, the file to read; ``dump``, the file to write frames to, of a new name each
    time; ``steps``, the last step of the whole run.
    """
    again = f"lmp -in {file_names.CONTINUE}"
    sections = [
        [
            f"# {problem.name}, continued from a restart: bitwise the same result, on any number of ranks",
            f"# {again}     or: {again} -var dump {dump_part(3)}, to continue again",
        ],
        [
            f"variable restart index {file_names.RESTART}",
            f"variable dump index {dump_part(2)}",
            *deck.number_lines(problem),
            *scheme.variable_lines(problem.scheme),
            deck.STATED,
        ],
        [
            *deck.START,
            *deck.neighbour_lines(problem),
            "read_restart ${restart}          # x: places at rest; vy: present places",
            *deck.number_fix(problem),
            *deck.group_lines(problem),
        ],
        *deck.interactions(problem),
        [
            *static_load.stop_lines(problem.system),
            "group free empty",
            "group free clear                 # the restart of a continued run holds this group",
            *deck.motion_lines(problem, "free"),
            *static_load.go_on_lines(problem.system),
        ],
        *([window.setup_lines(problem, continued=True)] if problem.rows.follow else []),
        [
            *deck.output_lines(problem, "${dump}"),
            "# no frame before the beads are at their present places",
            "dump_modify frames delay $(step)",
            f'if "$(version) < {_TIMED_SINCE}" then "dump_modify frames time no"',
        ],
        _setup_lines(problem),
        onward_lines(problem),
    ]
    return "\n\n".join("\n".join(lines) for lines in sections) + "\n"


def _setup_lines(problem: Problem) -> list[str]:
    """LAMMPS commands that set up a continued run with the beads at rest, and put them where they are."""
    forces = _keeps_forces(problem.system)
    return [
        "# setup with the beads at rest (neighbours, ranks, order); then forces at their present places",
        "timestep ${timestep}",
        *(_GIVEN_FORCES if forces else []),
        "variable before equal $(step-1)",
        "reset_timestep 0                 # resets the time, which the next line sets to that of the step",
        "reset_timestep ${before}",
        *deck.moved_lines(problem),
        "run 0 post no",
        *_FROM_REST,
        "run 1 pre no post no",
        *(["group given clear", "set group all vz 0.0"] if forces else []),
        "group free union all",
    ]


_GIVEN_FORCES = (
    "variable given atom vz           # forces, computed with the velocities half a step earlier",
    "group given union all",
    "fix given given setforce v_given 0.0 0.0",
)


def _keeps_forces(system: System) -> bool:
    """Whether forces at present places are not those that LAMMPS computes there: of velocities of half a step before,
    or of the largest overlaps before this step.
    """
    return bool(system.dampers or not system.holds(Fact.FRAMES))


def onward_lines(problem: Problem, *, timings: bool = True) -> list[str]:
    """LAMMPS commands of a run to the step ``steps`` without the setup that a run begins with.

    Args:
        problem: what is computed.
        timings: whether LAMMPS may end the run with a table of its timings in the log.
    """
    if problem.rows.follow:
        travel = window.travel_lines(problem)
        travel.remove("run 0 post no")  # the setup
        return [scheme.timestep_command(problem.scheme), *travel]
    if problem.scheme == "verlet":
        return ["run ${steps} upto pre no" + ("" if timings else " post no")]
    return [*scheme.QUIET, *scheme.onward_lines(problem.scheme, "steps"), *scheme.LOUD]
