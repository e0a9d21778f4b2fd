"""The measure of forces: what `analyze` prints, writes and draws of gauges."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from analysis import quantity
from analysis.figures import waves
from analysis.figures.panels import AxisUnit, Sheet, axis_unit, shown_chains, title
from analysis.gauges.gauge import PULSE, gauges
from analysis.sharing.survey import Survey
from lammps_inputs import physics
from lammps_inputs.facts import Fact
from workflow.measures.forces.force_meter import ForceMeter
from workflow.measures.forces.readings import ForceTable, Reading, Readings
from workflow.measures.forces.reflection import Reflection, reflections
from workflow.measures.measurement import MOST_CHAINS, Measurement, Recorded
from workflow.screen import PrintedTable

MOST_GAUGES = 8
"""Gauges that the figure shows."""

_WORDS = {"largest": "largest", "at": "at", "impulse": "impulse", "dwell": "dwell"}

_LOADED_WORDS = {
    "static": "static",
    "largest": "largest total",
    "dynamic": "largest dynamic",
    "at": "at",
    "impulse": "dynamic impulse",
    "dwell": "dwell above static",
}
"""Quantity -> heading of the printed table; under a static load."""


SMALLEST_UNCERTAINTY = 5e-4
"""Uncertainty of a largest force, in its excess over the static one, above which it is printed."""


@dataclass(frozen=True, repr=False)
class ForceMeasurement(Measurement):
    """Forces over time: an entry for each gauge and chain."""

    key, kind, figure = "forces", list[Reading], "forces"
    table = "forces.csv", ForceTable

    values: list[Reading]
    readings: Readings

    def lines(self) -> Iterator[str | PrintedTable]:
        """Largest force, impulse and dwell of every gauge; what is so far; forces on walls, and what they reflect."""
        problem, readings, scale = self.problem, self.readings, self.problem.scale
        chains = range(min(problem.chains, MOST_CHAINS))
        loaded = readings.loaded
        words = _LOADED_WORDS if loaded else _WORDS
        shown = [reading for reading in self.values if reading.chain <= MOST_CHAINS]
        rows = [
            [reading.name if reading.chain == 1 else "", str(reading.chain), *self._cells(reading, words)]
            for reading in shown
        ]
        head = ["force at", "chain", *quantity.headings(Reading, scale, words)]
        yield PrintedTable("forces", head, rows)
        yield from self._uncertain()
        yield from self._unfinished()
        kinds = [gauge.kind for gauge in readings.gauges]
        which = "dynamic force" if loaded else "force"
        for place, gauge in enumerate(readings.gauges):
            if gauge.kind != "wall":
                continue
            for chain in chains:
                where, largest = f"in chain {chain + 1} the", readings.dynamic[chain]
                contact = kinds.index("contact") if "contact" in kinds else None
                if contact is not None and np.isfinite(largest[place]) and largest[contact] > 0.0:
                    ratio, other = largest[place] / largest[contact], readings.gauges[contact].name
                    yield f"{where} largest {which} at the {gauge.name} is {ratio:.4f} times that at {other}"
                reflection = self.values[place * problem.chains + chain].reflected
                if reflection is not None:
                    coupled = physics.coupled(problem.system)
                    yield f"{where} {gauge.name} reflects {_reflected(reflection, coupled=coupled)}"

    def _cells(self, reading: Reading, names: Iterable[str]) -> list[str]:
        """Cells of the printed table, by the names of the quantities."""
        cells = {name: quantity.written(reading, name, self.problem.scale, ".6g") for name in names}
        cells["dwell"] = "-"
        if np.isfinite(reading.at) and np.isfinite(reading.dwell):
            lasted = quantity.written(reading, "dwell", self.problem.scale, ".4g")
            cells["dwell"] = lasted if reading.dwell_ended else f"{lasted} so far"
        return list(cells.values())

    def _uncertain(self) -> Iterator[str]:
        """Where frames are too far apart for the force between them; else the uncertainties, if they matter."""
        readings, scale = self.readings, self.problem.scale
        every = scale.written(self.problem.every, "time", ".3g")
        coarse = np.isnan(readings.largest) | np.isnan(readings.impulse)
        if np.any(coarse):
            yield (
                f"frames {every} apart do not show the force between them at {self._places(coarse)}; "
                "take a smaller `output.every`"
            )
        excess = np.abs(readings.dynamic) if readings.loaded else readings.largest
        relative = np.divide(readings.largest_error, excess, out=np.zeros_like(excess), where=excess > 0.0)
        if not np.nanmax(relative, initial=0.0) > SMALLEST_UNCERTAINTY:
            return
        chain, place = np.unravel_index(int(np.nanargmax(relative)), relative.shape)
        late = scale.written(float(readings.at_error[chain, place]), "time", ".1e")
        where = f"{readings.gauges[place].name}, chain {chain + 1}, its time to {late}"
        yield (
            f"the uncertainty of largest forces, by frames {every} apart and by the run, is up to "
            f"{relative[chain, place]:.1e} of the excess over rest ({where}); analysis.json has that of each force, "
            "impulse and dwell"
        )

    def _places(self, chosen: NDArray[np.bool_]) -> str:
        """Gauges and chains, of [chain, gauge], in words; the first few."""
        places = [
            f"{self.readings.gauges[place].name}, chain {chain + 1}" for place, chain in np.argwhere(chosen.T).tolist()
        ]
        return _first_few(places)

    def _unfinished(self) -> Iterator[str]:
        """A line on the gauges at which a force still differs from that at rest at the end of the record."""
        readings, scale = self.readings, self.problem.scale
        last = np.where(np.isfinite(readings.last), readings.last, 0.0)
        inside = [
            f"{readings.gauges[place].name}, chain {chain + 1} ({last[chain, place]:.1%})"
            for place, chain in np.argwhere(np.abs(last.T) >= PULSE).tolist()
        ]
        if not inside:
            return
        end = scale.written(readings.time[-1], "time")
        rest = "the static force" if readings.loaded else "0"
        yield (
            f"the record ends (t = {end}) inside a pulse: the force still differs from {rest} (by a share of "
            f"its largest difference) at {_first_few(inside)}; impulses and largest values "
            "there are those up to the end"
        )

    def rows(self) -> ForceTable:
        """Forces over time."""
        return self.readings.table()

    def sheet(self) -> Sheet:
        """One row a gauge (the first eight), a line for each chain that other figures show too.

        Left over the whole run, right the passages of its largest pulses, their time from the peak.
        """
        problem, readings = self.problem, self.readings
        force = axis_unit(problem, "force", float(np.max(readings.force)))
        count = min(len(readings.gauges), MOST_GAUGES)
        size = np.max(np.abs(readings.force - readings.static), axis=1)  # [frame, gauge]
        traces = []
        for place, gauge in enumerate(readings.gauges[:count]):
            passages = waves.pulses(readings.time, size[:, place])
            values = readings.force[:, shown_chains(problem), place] * force.worth
            traces.append(waves.Trace(gauge.name, values, passages, self._largest(place, force)))
        left_out = len(readings.gauges) - count
        rest = f"; {left_out} more gauges are in forces.csv" if left_out else ""
        heading = title(problem, each_chain=True, until=float(readings.time[-1])) + rest
        axis = force.axis(ForceTable, "force", "total force" if readings.loaded else "")
        sheet = waves.traces_sheet(problem, heading, readings.time, axis, traces, ("peak", "time after peak\n"))
        return replace(sheet, same_y="all")

    def _largest(self, place: int, force: AxisUnit) -> str:
        """Largest force at a gauge, in a unit, in words."""
        readings = self.readings
        if np.isnan(readings.largest[:, place]).any():
            return "largest unknown between frames"
        largest = f"largest {float(np.max(readings.largest[:, place])) * force.worth:.4g}"
        if not readings.loaded:
            return largest
        dynamic = float(np.fmax.reduce(readings.dynamic[:, place])) * force.worth
        return largest + (f", dynamic {dynamic:.4g}" if np.isfinite(dynamic) else ", never above the static force")

    @classmethod
    def meter(cls, run: Recorded) -> ForceMeter | None:
        """Forces at the gauges that the scene names; rigid beads feel none."""
        wanted, system = run.scene.output.forces, run.problem.system
        if wanted is None or not system.holds(Fact.OVERLAPS):
            return None
        places = gauges(system, wall=wanted.wall is True, contacts=wanted.contacts or (), sensors=wanted.sensors or ())
        return ForceMeter(run.problem, places)

    @classmethod
    def of_run(cls, run: Recorded, survey: Survey, measured: Readings | None) -> Self | None:
        """Forces of all frames, with uncertainties that cover the error of the run, and what walls reflect."""
        if measured is None:
            return None
        problem, passed = run.problem, (*survey.pulses, *survey.crests)
        sides = {gauge.side for gauge in measured.gauges if gauge.kind == "wall"}
        reflected = {side: reflections(passed, problem, right=side == "right") for side in sides}
        readings = measured.with_error(run.error, problem)
        return cls(problem, readings.entries(reflected), readings)


def _first_few(places: list[str]) -> str:
    """The first `MOST_CHAINS` of some places in words, and how many more there are."""
    more = f" and {len(places) - MOST_CHAINS} more" if len(places) > MOST_CHAINS else ""
    return ", ".join(places[:MOST_CHAINS]) + more


def _reflected(reflection: Reflection, *, coupled: bool) -> str:
    """The reflected pulse in words: its peak velocity over that of the incident one, and where these were measured."""
    exchange = "; chains exchange energy meanwhile" if coupled else ""
    beads = [f"{first} to {last}" for first, last in (reflection.incident_beads, reflection.reflected_beads)]
    return (
        f"the first pulse with {reflection.ratio:.4f} +- {reflection.uncertainty:.1g} of its peak velocity (incident: "
        f"beads {beads[0]}, reflected: {beads[1]}, extrapolated to the wall{exchange})"
    )
