"""Collisions of rigid beads as a list, and as the table ``events.csv``."""

from pathlib import Path

import numpy as np

from granchain import InputError
from granchain.parts import Floats, Integers, Problem, impulses, quantity, units

EVENTS = "events.csv"
"""Name of the table in a run's directory."""


@quantity.result
class Collisions:
    """Collisions in the order in which they happen, [collision]; bead ``row`` of a chain strikes bead ``row + 1``."""

    time: Floats = quantity.declare("time of the collision", "time", symbol="t")
    chain: Integers = quantity.declare("number of the chain")
    row: Integers = quantity.declare("number of the striking bead, which strikes the next")
    striker: Floats = quantity.declare(
        "velocity of bead ``row`` before the collision, and of bead ``row + 1`` after it", "velocity"
    )
    target: Floats = quantity.declare(
        "velocity of bead ``row + 1`` before the collision, and of bead ``row`` after it", "velocity"
    )
    rounding: Integers = quantity.declare(
        "1 where rounding decides: from the collision on that ``rounding`` in ``analysis.json`` names, and at earlier "
        "ones of impulses below 0.001 m V that runs with a changed gap do not have; else 0",
        default=None,
    )

    def __post_init__(self) -> None:
        if self.rounding is None:
            object.__setattr__(self, "rounding", np.zeros(len(self.time), dtype=np.int64))

    def __len__(self) -> int:
        return len(self.time)

    @property
    def impulse(self) -> Floats:
        """[collision] momentum transferred, in units of m V; positive."""
        return self.striker - self.target

    def until(self, time: float) -> "Collisions":
        """The collisions up to a time, in units of T."""
        count = int(np.searchsorted(self.time, time, side="right"))
        return Collisions(*(getattr(self, name)[:count] for name in quantity.declared(Collisions)))


def from_csv(path: Path, scale: units.Scale) -> Collisions:
    """The collisions that a table in the scene's units holds.

    Raises:
        InputError: it cannot be read, or is not such a table.
    """
    try:
        with path.open(encoding="utf-8") as file:
            head = file.readline().strip()
            names = list(quantity.declared(Collisions))
            with_units = quantity.headings(Collisions, scale)
            # older tables have names without units, or do not mark rounding
            if head not in {",".join(heads) for heads in (with_units, with_units[:-1], names[:-1])}:
                raise InputError(f"{path}: is not a table of collisions; its columns should be {', '.join(names)}")
            lines = [line for line in file if line.strip()]
        values = np.loadtxt(lines, delimiter=",", ndmin=2) if lines else np.empty((0, len(names)))
        time, chain, row, striker, target, *marks = values.T
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from None
    except ValueError as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{path}: is not a table of collisions ({error})") from None
    velocity = scale.velocity
    chain, row, *marks = (column.astype(np.int64) for column in (chain, row, *marks))
    return Collisions(time / scale.time, chain, row, striker / velocity, target / velocity, *marks)


def from_events(problem: Problem, events: Collisions) -> impulses.Impulses:
    """Impulses of rigid beads, a contact being one collision.

    Args:
        problem: what was run.
        events: every collision.
    """
    chain, row = events.chain - 1, events.row - 1
    shape = (problem.chains, problem.beads - 1)
    first, total = np.zeros((2, *shape))
    contacts = np.zeros(shape, dtype=np.int64)
    time = np.full(shape, np.nan)
    np.add.at(total, (chain, row), events.impulse)
    np.add.at(contacts, (chain, row), 1)
    _, index = np.unique(chain * problem.beads + row, return_index=True)  # the first of each place
    first[chain[index], row[index]] = events.impulse[index]
    time[chain[index], row[index]] = events.time[index]
    return impulses.Impulses(np.arange(2, problem.beads + 1), first, total, contacts, time, 0.0)
