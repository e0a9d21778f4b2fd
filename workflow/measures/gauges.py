"""What gauges have read: those that a scene names, spectra of beads, the far end of the chains; and contacts."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from analysis import quantity
from analysis.contacts import LargestOverlap, Yielded, YieldMeter, YieldTable, shown_by_frames
from analysis.gauges.far_end import FarEnd as Collected
from analysis.gauges.far_end import Transmitted
from analysis.gauges.forces import ForceMeter, ForceTable, Reading, Readings
from analysis.gauges.gauge import PULSE, gauges
from analysis.gauges.reflection import Reflection, reflections
from analysis.gauges.spectra import HighestLine, SpectralLines, SpectrumMeter, SpectrumTable
from analysis.gauges.spectra import VelocitySpectra as Measured
from analysis.sharing.survey import Survey
from lammps_inputs import physics
from lammps_inputs.facts import Fact
from workflow.measures.base import MOST_CHAINS, FrameMeter, Measurement, Recorded
from workflow.runs.contacts import LargestContactForce as ContactOverlaps
from workflow.runs.contacts import has_contacts, of_overlap
from workflow.screen import PrintedTable

if TYPE_CHECKING:
    from matplotlib.figure import Figure

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

    def draw(self) -> "Figure":
        """Forces over time."""
        from analysis.figures.forces import force_figure

        return force_figure(self.problem, self.readings)

    @classmethod
    def meter(cls, run: Recorded) -> FrameMeter | None:
        """Forces at the gauges that the scene names; rigid beads feel none."""
        wanted, problem = run.scene.output.forces, run.problem
        if wanted is None or not run.problem.system.holds(Fact.OVERLAPS):
            return None
        places = gauges(
            problem.system, wall=wanted.wall is True, contacts=wanted.contacts or (), sensors=wanted.sensors or ()
        )
        meter = ForceMeter(problem, places)

        def finish(survey: Survey) -> ForceMeasurement:
            passed = (*survey.pulses, *survey.crests)
            sides = {gauge.side for gauge in places if gauge.kind == "wall"}
            reflected = {side: reflections(passed, problem, right=side == "right") for side in sides}
            readings = meter.result().with_error(run.error, problem)
            return cls(problem, readings.entries(reflected), readings)

        return FrameMeter(finish, meter.add)


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


@dataclass(frozen=True, repr=False)
class SpectrumMeasurement(Measurement):
    """Spectra of the velocities of chosen beads."""

    key, kind, figure = "spectra", SpectralLines, "spectra"
    table = "spectra.csv", SpectrumTable

    values: SpectralLines
    spectra: Measured

    def lines(self) -> Iterator[PrintedTable]:
        """The highest line of every bead, and what it has of the drives."""
        spectra, highest, scale = self.spectra, self.values, self.problem.scale
        words = {"frequency": "highest line at", "amplitude": "its velocity"}
        head = ["bead", "chain", *quantity.headings(HighestLine, scale, words)]
        for frequency in spectra.drive:
            at = scale.heading(f"at {frequency / scale.time:.5g}", "cycles")
            head.append(f"{at}, over bead {spectra.beads[0]}")
        rows = []
        for peak in sorted(highest.beads, key=lambda line: (spectra.beads.index(line.bead), line.chain)):
            if peak.chain <= MOST_CHAINS:
                line = [quantity.written(peak, name, scale, ".5g") for name in words]
                passed_on = [quantity.cell(drive.transmissibility, ".5g") for drive in peak.at_drive]
                rows.append([str(peak.bead) if peak.chain == 1 else "", str(peak.chain), *line, *passed_on])
        start = scale.written(highest.after, "time", ".5g")
        yield PrintedTable(f"spectra from t = {start} on", head, rows)

    def rows(self) -> SpectrumTable:
        """All lines."""
        return self.spectra.table()

    def draw(self) -> "Figure":
        """All lines."""
        from analysis.figures.spectra import spectra_figure

        return spectra_figure(self.problem, self.spectra)

    @classmethod
    def meter(cls, run: Recorded) -> FrameMeter | None:
        """Spectra of the beads that the scene names."""
        wanted, problem = run.scene.output.spectra, run.problem
        if wanted is None:
            return None
        after = None if wanted.after is None else wanted.after / problem.scale.time
        meter = SpectrumMeter(problem, wanted.beads, after)

        def finish(_: Survey) -> SpectrumMeasurement | None:
            spectra = meter.result()
            return None if spectra is None else cls(problem, spectra.found(problem), spectra)

        return FrameMeter(finish, meter.add)


@dataclass(frozen=True, repr=False)
class FarEndMeasurement(Measurement):
    """Force, delay and energy."""

    key, kind = "far_end", Transmitted
    at_the_end = True

    values: Transmitted

    @classmethod
    def meter(cls, run: Recorded) -> FrameMeter | None:
        """The far end of runs of all beads, if these are elastic."""
        problem = run.problem
        if not problem.whole or not run.problem.system.holds(Fact.OVERLAPS):
            return None
        end = Collected(problem)
        return FrameMeter(lambda _: cls(problem, end.result()), end.add)


@dataclass(frozen=True, repr=False)
class ContactMeasurement(Measurement):
    """The largest contact force."""

    key, kind = "contacts", ContactOverlaps

    values: ContactOverlaps

    def lines(self) -> Iterator[str]:
        """The largest force, with a warning where Hertz's law ends."""
        yield from self.values.lines()

    @classmethod
    def meter(cls, run: Recorded) -> FrameMeter | None:
        """Contacts of elastic spheres with a material; where frames show no overlaps, what they may be at most."""
        problem = run.problem
        if not has_contacts(run.scene, run.problem):
            return None
        overlap = LargestOverlap()

        def finish(_: Survey) -> ContactMeasurement | None:
            largest = of_overlap(run.scene, overlap)
            return None if largest is None else cls(problem, largest)

        return FrameMeter(finish, overlap.add) if shown_by_frames(problem) else FrameMeter(finish)


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
            line += f"; the largest force falls as n^{yielded.decay:.3f} with the number n of the contact"
        yield line

    def rows(self) -> YieldTable:
        """Each contact."""
        return self.contacts

    @property
    def drawable(self) -> bool:
        """Whether any contact has kept a permanent overlap, which logarithmic axes can show."""
        return bool((self.contacts.permanent > 0.0).any())

    def draw(self) -> "Figure":
        """Along the chains."""
        from analysis.figures.forces import yield_figure

        return yield_figure(self.problem, self.contacts)

    @classmethod
    def meter(cls, run: Recorded) -> FrameMeter | None:
        """Contacts of runs of all beads."""
        problem = run.problem
        if not YieldMeter.applies(problem):
            return None
        meter = YieldMeter()

        def finish(_: Survey) -> PlasticMeasurement | None:
            yielded = meter.result()
            return None if yielded is None else cls(problem, *yielded)

        return FrameMeter(finish, meter.add)
