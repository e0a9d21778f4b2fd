"""What contacts that yield keep of a run: the largest force and overlap of each, the permanent overlap, energy lost."""

import numpy as np

from analysis import motion
from analysis.quantity import declare, result
from analysis.trajectory import Floats, Integers, Trajectory
from lammps_inputs import laws, physics

LEAST_CONTACTS = 10
"""Contacts along a chain from which on an exponent is fitted."""


@result
class Yielded:
    """The contacts of all chains at the end of the run, without walls."""

    contacts: int = declare("number of contacts with a permanent overlap", column="contacts with a permanent overlap")
    permanent: float = declare("largest permanent overlap", "length", symbol="d_r", column="largest permanent overlap")
    lost: float = declare(
        "energy lost in contacts of beads over the energy input of the kicks",
        undefined="a push or drive supplies energy",
        column="energy lost in plastic contacts / energy input",
    )
    decay: float = declare(
        "exponent of the largest force of the contacts of the kicked chain over their number, fitted over the second "
        "half of those that have begun to open",
        undefined=f"fewer than {LEAST_CONTACTS} of these",
        column="decay exponent of the largest contact forces",
    )


@result
class YieldTable:
    """Table of the contacts of all chains at the end of the run."""

    chain: Integers = declare("number of the chain")
    contact: Integers = declare("number of the contact, that of the bead behind it")
    overlap: Floats = declare("largest overlap so far", "length", symbol="d_m")
    force: Floats = declare("largest force so far: that of first loading at this overlap", "force", symbol="F_m")
    permanent: Floats = declare("permanent overlap", "length", symbol="d_r")
    lost: Floats = declare("energy lost by yielding", "energy")


class YieldMeter:
    """Reads the last frame of a run of all beads."""

    def __init__(self) -> None:
        self._last: Trajectory | None = None

    def add(self, block: Trajectory) -> None:
        """Take the next frames."""
        self._last = block.last()

    def result(self) -> tuple[Yielded, YieldTable] | None:
        """Of the frames so far; None where there was none."""
        last = self._last
        if last is None or last.memory is None:
            return None
        system = last.system_at(-1)
        link = system.along[0]
        law = link.law
        shape = (system.chains, system.beads - 1)
        memory = last.memory[-1, :, 1:-1]
        force = np.broadcast_to(laws.whole_force(law, memory), shape)
        permanent, lost = (
            np.broadcast_to(find(*law), shape)
            for find in (law.permanent, law.lost)  # type: ignore[attr-defined]
        )
        chain, contact = np.indices(shape)
        table = YieldTable(
            chain.ravel() + 1, contact.ravel() + 1, *(one.ravel() for one in (memory, force, permanent, lost))
        )
        kicked = physics.largest_excitation(system)[0] - 1
        opened = motion.overlaps(system, last.displacement[-1])[kicked] < memory[kicked]
        acted_on = physics.acted_on(system)
        return (
            Yielded(
                contacts=int(np.count_nonzero(permanent > 0.0)),
                permanent=float(np.max(permanent)),
                lost=float("nan") if acted_on else float(np.sum(lost)) / physics.energy(system),
                decay=_decay(force[kicked], opened & (memory[kicked] > 0.0)),
            ),
            table,
        )


def _decay(force: Floats, opened: Floats) -> float:
    """Slope of the logarithm of forces over that of their numbers, in the second half of those up to the last."""
    count = int(np.argmin(opened)) if not np.all(opened) else len(opened)
    if count < 2 * LEAST_CONTACTS:
        return float("nan")
    number = np.arange(count // 2, count)
    return float(np.polyfit(np.log(number + 1.0), np.log(force[number]), 1)[0])
