"""Contacts that yield: largest force and overlap of each, permanent overlap, and the energy dissipated.

A `YieldMeter` gives what the contacts of a run keep at the end, and a table of them.

Examples:
    >>> problem = granchain.load("plastic-contacts").problem()
    >>> frames = engine.run(problem)
    >>> yielded, contacts = plastic.YieldMeter().read(frames.blocks())
    >>> yielded.contacts, contacts.permanent[:3].round(4)  # permanent overlaps in units of L
    (54, array([0.9495, 0.6259, 0.4491]))
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from analysis import motion
from analysis.figures.panels import Axis, Curve, Panel, Sheet, axis_unit, shown_chains, title
from analysis.meters import Meter, Part
from analysis.quantity import declare, result
from analysis.sharing.survey import Survey
from analysis.trajectory import Flags, Floats, Integers, Trajectory
from lammps_inputs import Problem, laws, physics
from lammps_inputs.units import Label
from workflow.measures.measurement import Measurement, Recorded

LEAST_CONTACTS = 10
"""Contacts along a chain from which on an exponent is fitted."""


@result
class Yielded:
    """The contacts of all chains at the end of the run, without walls."""

    contacts: int = declare("number of contacts with a permanent overlap", column="contacts with a permanent overlap")
    permanent: float = declare(
        "largest permanent overlap", "length", symbol="\\delta_r", column="largest permanent overlap"
    )
    dissipated: float = declare(
        "energy dissipated in contacts of beads over the energy input of the kicks",
        undefined="a push or drive supplies energy",
        column="energy dissipated in plastic contacts / energy input",
    )
    decay: float = declare(
        "exponent of the largest force of the contacts of the kicked chain over their number, fitted over the second "
        "half of those that have begun to open",
        undefined=f"fewer than {LEAST_CONTACTS} of these",
        column="decay exponent of the largest contact forces",
    )
    decay_error: float | None = declare(
        "standard error of ``decay``, and what the error of forces by the run (``run_error``) changes",
        undefined="so is ``decay``",
        default=None,
    )


@result
class YieldTable:
    """Table of the contacts of all chains at the end of the run."""

    chain: Integers = declare("number of the chain")
    contact: Integers = declare("number of the contact, that of the bead behind it")
    overlap: Floats = declare("largest overlap so far", "length", symbol="\\delta_m")
    force: Floats = declare("largest force so far: that of first loading at this overlap", "force", symbol="F_m")
    permanent: Floats = declare("permanent overlap", "length", symbol="\\delta_r")
    opened: Integers = declare(
        "whether it has begun to open, 0 or 1; of one that has not the record ends before its largest overlap"
    )
    dissipated: Floats = declare("energy dissipated by yielding", "energy")

    def decay(self, problem: Problem, force_error: float = 0.0) -> "PowerLaw | None":
        """Law of the largest forces in the kicked chain; see `power_law`."""
        kicked = self.chain == physics.largest_excitation(problem.system)[0]
        return power_law(self.force[kicked], self.opened[kicked] == 1, force_error)


class YieldMeter(Meter[Trajectory | None, tuple[Yielded, YieldTable] | None]):
    """Contacts in the last frame of a run of all beads."""

    def of_part(self, part: Part) -> Trajectory | None:
        """The last frame of the run; None in other parts."""
        return part.frames.last() if part.is_last else None

    def result(self, pieces: list[Trajectory | None]) -> tuple[Yielded, YieldTable] | None:
        """Permanent overlaps at the last frame, and their table; None if no frame has states of contacts."""
        last = pieces[-1]
        if last is None or last.contact_state is None:
            return None
        system = last.system_at(-1)
        law = physics.law_of_contacts(system)
        shape = (system.chains, system.beads - (not system.closing))
        largest = laws.turning_overlap(law)
        force = np.broadcast_to(laws.whole_force(law, largest), shape)
        permanent, dissipated = (np.broadcast_to(find(*law), shape) for find in (law.permanent, law.dissipated))
        chain, contact = np.indices(shape)
        opened = (motion.overlaps(system, last.displacement[-1]) < largest) & (largest > 0.0)
        table = YieldTable(
            chain=chain.ravel() + 1,
            contact=contact.ravel() + 1,
            overlap=largest.ravel(),
            force=force.ravel(),
            permanent=permanent.ravel(),
            opened=opened.ravel().astype(np.int64),
            dissipated=dissipated.ravel(),
        )
        acted_on = physics.acted_on(system)
        decay = table.decay(last.problem)
        return (
            Yielded(
                contacts=int(np.count_nonzero(permanent > 0.0)),
                permanent=float(np.max(permanent)),
                dissipated=float("nan") if acted_on else float(np.sum(dissipated)) / physics.energy(system),
                decay=float("nan") if decay is None else decay.exponent,
                decay_error=None if decay is None else decay.exponent_error,
            ),
            table,
        )


@dataclass(frozen=True)
class PowerLaw:
    """Largest force of contacts as ``factor * contact**exponent``.

    Attributes:
        contact: [contact] numbers of the fitted contacts, the second half of those that have begun to open.
        factor: dimensionless force of contact 1.
        exponent: slope of the logarithms.
        exponent_error: its standard error, and what errors of the forces change.
    """

    contact: Floats
    factor: float
    exponent: float
    exponent_error: float


def power_law(force: Floats, opened: Flags, force_error: float = 0.0) -> PowerLaw | None:
    """Law of the forces [contact] of one chain, by least squares of logarithms; None for too few contacts that opened.

    Args:
        force: [contact] largest force so far, dimensionless.
        opened: [contact] whether the contact has begun to open.
        force_error: bound on the error of each force.
    """
    count = int(np.argmin(opened)) if not np.all(opened) else len(opened)
    if count < 2 * LEAST_CONTACTS:
        return None
    contact = np.arange(count // 2, count, dtype=np.float64) + 1.0
    place, force = np.log(contact), force[count // 2 : count]
    (exponent, logarithm), covariance = np.polyfit(place, np.log(force), 1, cov=True)
    offset = place - np.mean(place)
    error = math.sqrt(covariance[0, 0]) + float(np.sum(np.abs(offset) * force_error / force) / np.sum(offset**2))
    return PowerLaw(np.asarray(contact), math.exp(logarithm), float(exponent), error)


LEAST_DRAWN = 1e-4
"""Share of the largest value below which none is drawn."""


def _most(values: Floats) -> float:
    """Largest of some values; 1 where there is none above 0."""
    return float(np.max(values, initial=0.0)) or 1.0


@dataclass(frozen=True, repr=False)
class PlasticMeasurement(Measurement):
    """What the contacts keep at the end."""

    key, kind, figure = "plastic", Yielded, "plastic"
    table = "plastic.csv", YieldTable

    values: Yielded
    contacts: YieldTable

    def lines(self) -> Iterator[str]:
        """How many have yielded, by how much, and how the largest force falls along the kicked chain."""
        yielded, scale = self.values, self.problem.scale
        line = (
            f"{yielded.contacts} of {len(self.contacts.contact)} contacts have a permanent overlap, of at most "
            f"{scale.written(yielded.permanent, 'length')}"
        )
        if math.isfinite(yielded.decay):
            line += (
                f"; the largest force falls as n^b with the number n of the contact, b = {yielded.decay:.3f} +- "
                f"{yielded.decay_error:.1g}"
            )
        yield line

    def rows(self) -> YieldTable:
        """Each contact."""
        return self.contacts

    def sheet(self) -> Sheet | None:
        """Largest force and permanent overlap over the number of the contact, on logarithmic axes.

        Contacts that have not begun to open are left out: their numbers are those of the end of the record. The power
        law of `Yielded` is drawn over the contacts that it was fitted to.
        """
        problem, table = self.problem, self.contacts
        if not (table.permanent > 0.0).any():  # logarithmic axes would show nothing
            return None
        final, x = table.opened == 1, Axis(Label("contact", "n"), log=True)
        shown = []
        for kind, name, words in (("force", "force", "largest force"), ("length", "permanent", "permanent overlap")):
            values = table.force if name == "force" else table.permanent
            largest = _most(values[final])
            unit, curves = axis_unit(problem, kind, largest), []
            for place, chain in enumerate(shown_chains(problem)):
                of_chain = (table.chain == chain + 1) & final
                noticed = values[of_chain] > LEAST_DRAWN * largest
                drawn = np.where(noticed, values[of_chain] * unit.worth, np.nan)
                curves.append(Curve(f"chain {chain + 1}", table.contact[of_chain], drawn, place))
            shown.append(Panel(x, unit.axis(YieldTable, name, words, log=True), tuple(curves)))
        if (law := table.decay(problem)) is not None:
            fitted = law.factor * law.contact**law.exponent * shown[0].y.worth
            look = {"color": "black", "linestyle": (0, (1, 1)), "linewidth": 2.0}
            line = Curve(rf"$\propto n^{{{law.exponent:.3f}}}$", law.contact, fitted, look=look)
            shown[0] = replace(shown[0], curves=(*shown[0].curves, line))
        return Sheet(title(problem, each_chain=True), [[panel] for panel in shown], 5.6)

    @classmethod
    def meter(cls, run: Recorded) -> YieldMeter | None:
        """Contacts that yield, of runs of all beads: frames hold their states."""
        return YieldMeter() if run.problem.state_columns else None

    @classmethod
    def of_run(cls, run: Recorded, survey: Survey, measured: tuple[Yielded, YieldTable] | None) -> Self | None:
        """What the contacts keep; None if no frame has states of contacts."""
        del survey
        if measured is None:
            return None
        yielded, table = measured
        if (decay := table.decay(run.problem, run.error.of_force(run.problem))) is not None:
            yielded = replace(yielded, decay_error=decay.exponent_error)
        return cls(run.problem, yielded, table)
