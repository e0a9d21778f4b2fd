"""LAMMPS commands of a force or motion that is tabulated at many points, as vectors that a deck includes from a file.

A formula that holds all points is read again at every step; a vector is read once, and costs the same at any length.
The points may be at any distances: cells of equal width give the points among which a time lies, and a search by
halves, of one or two stages where the distances are equal, the last one before it. A vector-style variable is evaluated
once a step, so each stage is one, though the next names it twice.
"""

import numpy as np
from numpy.typing import NDArray

from lammps_inputs.laws.in_time import Table
from lammps_inputs.numbers import text

Floats = NDArray[np.float64]

SINCE = (
    'if "$(version) < 20240417" then '
    '"print \'tables of more than 50 points need LAMMPS of 17Apr2024 or later\'" "quit 1"'
)
"""Releases of 2023 have vectors of given values, too, but a variable that is deleted, as by a job, spoils them."""

HEAD = (
    "echo none                        # not into the log",
    "# forces over time, dimensionless; at each point: time, force, impulse until then, half of the slope behind it;",
    "# last: number of the last point before each cell of time",
    "variable number vector [0]       # added to a number, it makes a vector, which is evaluated once a step",
)
"""First lines of the file with the vectors."""

TAIL = ("echo log",)
"""Last line of that file: LAMMPS's default."""

_BEYOND = 1e300
"""Time of points that are never reached."""

CELLS_A_POINT = 2
"""Cells at most, over the number of points."""

_ROUNDING = 1e-6
"""Part of a cell by which a time may fall into the cell beside its own."""


def _cells(time: Floats) -> tuple[float, NDArray[np.int64], int]:
    """Width of the cells, index of the last point before each, and stages of the search from there on.

    The first cell is centred at the first point, so that with equal distances each point is in the middle of a cell.
    """
    span = float(time[-1] - time[0])
    width = max(float(np.min(np.diff(time))), span / (CELLS_A_POINT * len(time)))
    edges = time[0] + width * (np.arange(int(span / width) + 3) - 0.5)
    slack = _ROUNDING * width
    before = np.maximum(np.searchsorted(time, edges - slack, side="left") - 1, 0)
    within = np.searchsorted(time, edges + width + slack, side="right") - 1 - before
    return width, before, int(np.max(within)).bit_length()


def vectors(law: Table, name: str, *, moves: bool) -> tuple[str, ...]:
    """Lines of the file with the vectors of a table; those of a motion have the travel, and the slope over 6."""
    _, before, stages = _cells(law.time)
    columns = {
        "time": np.concatenate([law.time, np.full(2**stages, _BEYOND)]),
        "force": law.value,
        "impulse": law.gained,
        "half_slope": 0.5 * law.slope,
        **({"travel": law.gone} if moves else {}),
        "last": before + 1.0,
    }
    return tuple(f"variable {name}{key} vector [{','.join(map(text, values))}]" for key, values in columns.items())


def lines(law: Table, name: str) -> tuple[str, ...]:
    """LAMMPS variables with the impulse until the times ``v_NAMEfrom`` and ``v_NAMEto``."""
    return tuple(
        line
        for at in (f"{name}from", f"{name}to")
        for line in (*_search(law, name, at), f"variable {at}_gained equal {_gained(name, at)}")
    )


def moved_lines(law: Table, name: str) -> tuple[str, ...]:
    """LAMMPS variables with displacement and velocity at a time step, ``v_NAMEnow_gone`` and ``v_NAMEnow_gained``."""
    at, time, last = f"{name}now", f"v_{name}now_time[1]", text(float(law.time[-1]))
    since, point = f"v_{at}_since[1]", f"[v_{at}_point]"
    return (
        f"variable {at} equal step*v_timestep",
        *_search(law, name, at, f"({time}*({time}<{last})+{last}*({time}>={last}))"),
        f"variable {at}_gained equal {_gained(name, at)}",
        f"variable {at}_gone equal v_{name}travel{point}+{since}*(v_{name}impulse{point}+{since}*"
        f"(v_{name}force{point}/2+v_{name}half_slope{point}*{since}/3))",
    )


def _gained(name: str, at: str) -> str:
    """Impulse until a time, from that at the last point before it."""
    since, point = f"v_{at}_since[1]", f"[v_{at}_point]"
    return f"v_{name}impulse{point}+{since}*(v_{name}force{point}+v_{name}half_slope{point}*{since})"


def _search(law: Table, name: str, at: str, within: str = "") -> list[str]:
    """LAMMPS variables with the last point before a time ``v_AT``, and the time since.

    Args:
        law: the table.
        name: name of its vectors.
        at: name of the variable of the time.
        within: formula of the time, or of that of the last point where that is earlier; by default it never is.
    """
    width, _, stages = _cells(law.time)
    time = f"v_{at}_time[1]"
    commands = [
        f"variable {at}_time vector v_number+v_{at}",
        f"variable {at}_cell equal floor(({within or time}-{text(float(law.time[0]))})/{text(width)}+0.5)+1",
        f"variable {at}_stage0 vector v_number+v_{name}last[v_{at}_cell]",
    ]
    for stage in range(1, stages + 1):
        half, last = 2 ** (stages - stage), f"v_{at}_stage{stage - 1}[1]"
        commands += [
            f"variable {at}_next{stage} equal {last}+{half}",
            f"variable {at}_stage{stage} vector v_number+{last}+{half}*({time}>=v_{name}time[v_{at}_next{stage}])",
        ]
    return [
        *commands,
        f"variable {at}_point equal v_{at}_stage{stages}[1]",
        f"variable {at}_since vector v_number+{time}-v_{name}time[v_{at}_point]",
    ]
