"""A window that follows the pulse: only the rows near the front exist.

Nothing runs ahead of the front, and what is left far behind cannot catch up. So rows behind are taken, at rest, to
the head, with their springs. The number of the row that a bead stands for is its molecule and travels with it, into
the dump. The rows in the window are those of the whole chains to the last bit, but for the few at the tail, as long as
nothing behind the window would have come back. The LAMMPS lines stand beside the numbers.

A move needs new neighbours, which LAMMPS finds by where beads are. So they are found with the beads at rest, their
places parked in ``vy`` meanwhile. That loses the forces, so what these do first, the half kick that the next Verlet
step begins with, is done before. A move therefore belongs to the step that follows, and never ends a run.

Examples:
    >>> window.behind(window.LEAST_WINDOW)
    40
"""

import itertools

from lammps_inputs import scheme
from lammps_inputs.numbers import text
from lammps_inputs.problem import Problem

LEAST_WINDOW = 64
"""Rows; at least 40 of them are behind the front."""

HEADROOM = 8
"""Rows at rest ahead of the front below which the window moves on."""

OUTRUN = "the front has reached the head of the window: take shorter time steps"


def block(window: int) -> int:
    """Rows that are taken from the tail to the head at once."""
    return window // 4


def behind(window: int) -> int:
    """Rows behind the front that exist at the least, once the window has moved."""
    return window - block(window) - HEADROOM


def rows_for(rows: int) -> int:
    """Rows of the least window that has so many behind the front."""
    return next(width for width in itertools.count(LEAST_WINDOW) if behind(width) >= rows)


def setup_lines(problem: Problem, *, continued: bool = False) -> list[str]:
    """Variables and groups that know where the front is; ``tail`` and ``head`` are rows."""
    window, spacing = problem.rows.existing, text(problem.layout.spacing)
    tail = [f"variable tail equal $(bound(all,xmin)/{spacing}:%.0f)"] if continued else []
    return [
        "# a window that follows the pulse: rows at the tail are moved to the head, at rest; molecule = row",
        "variable tail equal 1",
        f"variable head equal v_tail+{window - 1}",
        "variable moves atom vx!=0.0",
        "group moving variable moves",
        f"variable front equal bound(moving,xmax)/{spacing}",
        f"variable ahead equal {problem.beads}-v_head",
        f"variable few equal v_ahead<{block(window)}",
        f"variable some equal v_few*v_ahead+(1-v_few)*{block(window)}   # rows to move",
        f"variable near equal (v_head-v_front<{HEADROOM})&&(v_ahead>0)",
        "variable outrun equal (v_head-v_front<0.5)&&(v_ahead>0)",
        "variable behind atom mol<v_tail+v_some",
        "group left variable behind",
        f"variable row atom mol+{window}",
        f"variable place atom mol*{spacing}",
        "variable parked atom x",
        "variable displaced atom vy",
        f"variable kicked atom vx+0.5*v_{scheme.step_variable(problem.scheme)}*fx   # after the first half of a step",
        *tail,
    ]


def look_lines() -> list[str]:
    """Find the beads that move, after which the variables ``front``, ``near`` and ``outrun`` hold."""
    return ["group moving clear", "group moving variable moves"]


def move_lines() -> list[str]:
    """Take the last rows to the head, and find neighbours and owners again; a step must follow."""
    return [
        "set group all vx v_kicked",
        "group left clear",
        "group left variable behind",
        "set group left mol v_row",
        "set group left x v_place",
        "set group left vx 0.0",
        "variable tail equal $(v_tail+v_some)",
        "set group all vy v_parked",
        "set group all x v_place",
        "run 0 post no",
        "set group all x v_displaced",
        "set group all vy 0.0",
    ]


def travel_lines(problem: Problem) -> list[str]:
    """Run to step ``steps`` with the window following; for the end of a deck.

    The variable ``stretch`` holds the steps to the next look at the front, or to the end of the run.
    """
    steps, verlet = problem.steps_between_stops, problem.scheme == "verlet"
    left, next_look = "(v_steps-step)", f"({steps}-step%{steps})"  # also of a run that is continued in between
    run = ["run $(v_stretch:%.0f) pre no post no"]
    if not verlet:
        run = ["variable goal equal $(step+v_stretch:%.0f)", *scheme.onward_lines(problem.scheme, "goal")]
    return [
        *(() if verlet else scheme.QUIET),
        f"variable stretch equal ({left}<{next_look})*{left}+({left}>={next_look})*{next_look}",
        "run 0 post no",
        "label travel",
        'if "$(v_stretch) == 0" then "jump SELF arrived"',
        *look_lines(),
        f'if "${{outrun}} == 1" then "print \'{OUTRUN}\'" "quit 1"',
        'if "${near} == 0" then "jump SELF stay"',
        *move_lines(),
        "label stay",
        *run,
        "jump SELF travel",
        "label arrived",
        *(() if verlet else scheme.LOUD),
    ]
