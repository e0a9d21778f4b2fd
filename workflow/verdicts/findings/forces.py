"""What the gauges that a scene names have read: walls, contacts, sensors."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from analysis.gauges.forces import ForceMeter
from analysis.gauges.gauge import gauges
from analysis.gauges.readings import PULSE, Readings, to_csv
from analysis.gauges.reflection import Reflection, reflections
from analysis.sharing.survey import Survey
from lammps_inputs.numbers import known
from workflow.runs.engines import ENGINES
from workflow.runs.run_directory import RunDirectory
from workflow.screen import Table
from workflow.verdicts.findings.finding import MOST_CHAINS, Finding, Measure

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Forces(Finding):
    """Forces over time.

    Attributes:
        readings: of all gauges.
        reflected: of the walls among them, by side: what each reflects, chain by chain.
    """

    key = "forces"

    readings: Readings
    reflected: dict[str, list[Reflection | None]]

    def plain(self) -> list[dict[str, Any]]:
        """An entry for each gauge and chain, in the scene's units.

        | key           | what                                                                                      |
        |---------------|-------------------------------------------------------------------------------------------|
        | kind, name    | wall, contact or sensor; name of the column in ``forces.csv``                             |
        | chain, bead   | at a wall the bead that touches it; the first bead of a contact; the bead with the sensor |
        | largest, at   | largest total force, between frames too, and when; ``at`` is null where the force never   |
        |               | exceeds the static one                                                                    |
        | static        | only under a static load: force at rest, which ``largest`` includes                       |
        | dynamic       | likewise: largest force above the static one; null where it never exceeds it              |
        | impulse       | integral over time of the total force minus the static one                                |
        | dwell         | duration of the contact in which the force was largest; under a static load, of the time  |
        |               | around the maximum in which the force exceeded the static one by 1 % of its largest       |
        |               | excess. So far, where it had not ended by the end of the record                           |
        | dwell_ended   | whether it had; null where there was none                                                 |
        | last          | force above the static one at the end of the record, over the largest: from 0.01 on the   |
        |               | record ends inside a pulse, and ``impulse`` is so far; null where there was none          |
        | contacts      | how often the contact has closed; one that is closed at the start counts                  |
        | reflected     | walls only: of the first pulse that met the wall, the ``ratio`` of its peak velocity      |
        |               | after and before, both extrapolated to the wall, its ``uncertainty``, and first and last  |
        |               | of the beads that either is from, ``incident_beads`` and ``reflected_beads``; null where  |
        |               | no such ratio is defined or measured (`analysis.gauges.reflection`)                       |
        """
        readings, scale, entries = self.readings, self.problem.scale, []
        for place, gauge in enumerate(readings.gauges):
            for chain in range(self.problem.chains):
                there = bool(np.isfinite(readings.largest_at[chain, place]))
                entry: dict[str, Any] = {
                    "kind": gauge.kind,
                    "name": gauge.name,
                    "chain": chain + 1,
                    "bead": gauge.bead,
                    "largest": float(readings.largest[chain, place] * scale.force),
                    "at": known(float(readings.largest_at[chain, place] * scale.time)),
                    **self._above_rest(chain, place),
                    "impulse": float(readings.impulse[chain, place] * scale.momentum),
                    "dwell": known(float(readings.dwell[chain, place] * scale.time)),
                    "dwell_ended": bool(readings.ended[chain, place]) if there else None,
                    "last": known(float(readings.last[chain, place])),
                    "contacts": int(readings.contacts[chain, place]),
                }
                if gauge.kind == "wall":
                    found = self.reflected[gauge.side][chain]
                    entry["reflected"] = None if found is None else _plain(found)
                entries.append(entry)
        return entries

    def _above_rest(self, chain: int, place: int) -> dict[str, float | None]:
        readings, force = self.readings, self.problem.scale.force
        if not readings.loaded:
            return {}
        static, dynamic = readings.static[chain, place], readings.dynamic[chain, place]
        return {"static": float(static * force), "dynamic": known(float(dynamic * force))}

    def said(self) -> Iterator[str | Table]:
        """Largest force, impulse and dwell of every gauge; what is so far; what walls bear and reflect."""
        problem, readings, scale = self.problem, self.readings, self.problem.scale
        chains = range(min(problem.chains, MOST_CHAINS))
        names = ("force", "time", "momentum")
        force, time, momentum = (f" ({scale.symbol(name)})" if scale.si else "" for name in names)
        loaded = readings.loaded
        head = ["force at", "chain", f"largest{force}", f"at{time}", f"impulse{momentum}", f"dwell{time}"]
        if loaded:
            head[2:] = [
                f"static{force}",
                f"largest total{force}",
                f"largest dynamic{force}",
                f"at{time}",
                f"dynamic impulse{momentum}",
                f"dwell above static{time}",
            ]
        rows = []
        for place, gauge in enumerate(readings.gauges):
            for chain in chains:
                rows.append([gauge.name if chain == 0 else "", str(chain + 1), *self._cells(chain, place)])
        yield Table(f"{problem.name}: forces", head, rows)
        yield from self._unfinished()
        kinds = [gauge.kind for gauge in readings.gauges]
        which = "dynamic force" if loaded else "force"
        for place, gauge in enumerate(readings.gauges):
            if gauge.kind != "wall":
                continue
            for chain in chains:
                said = []
                most = readings.dynamic[chain]
                if "contact" in kinds and np.isfinite(most[place]) and (inside := most[kinds.index("contact")]) > 0.0:
                    other = readings.gauges[kinds.index("contact")].name
                    said.append(f"largest {which} {most[place] / inside:.4f} times that at {other}")
                if (found := self.reflected[gauge.side][chain]) is not None:
                    said.append(_said(found, coupled=problem.coupled))
                if said:
                    yield f"{gauge.name}, chain {chain + 1}: {', '.join(said)}"

    def _cells(self, chain: int, place: int) -> list[str]:
        """Of the printed table, from the largest force on."""
        readings, scale = self.readings, self.problem.scale
        largest, impulse = readings.largest[chain, place], readings.impulse[chain, place] * scale.momentum
        forces = [largest]
        if readings.loaded:
            forces = [readings.static[chain, place], largest, readings.dynamic[chain, place]]
        at, dwell = readings.largest_at[chain, place] * scale.time, readings.dwell[chain, place] * scale.time
        lasted = "-"
        if np.isfinite(at) and np.isfinite(dwell):
            lasted = f"{dwell:.4g}" if readings.ended[chain, place] else f"{dwell:.4g} so far"
        return [
            *(_written(value * scale.force) for value in forces),
            _written(at),
            _written(impulse),
            lasted,
        ]

    def _unfinished(self) -> Iterator[str]:
        """Of every gauge at which a force still differs from that at rest at the end of the record."""
        readings, scale = self.readings, self.problem.scale
        last = np.where(np.isfinite(readings.last), readings.last, 0.0)
        inside = [
            f"{readings.gauges[place].name}, chain {chain + 1} ({last[chain, place]:.1%})"
            for place, chain in np.argwhere(np.abs(last.T) >= PULSE).tolist()
        ]
        if not inside:
            return
        end, unit = readings.time[-1] * scale.time, f" {scale.symbol('time')}" if scale.si else ""
        more = f" and {len(inside) - MOST_CHAINS} more" if len(inside) > MOST_CHAINS else ""
        rest = "the static force" if readings.loaded else "0"
        yield (
            f"the record ends (t = {end:.6g}{unit}) inside a pulse: the force still differs from {rest} (by a share of "
            f"its largest difference) at {', '.join(inside[:MOST_CHAINS])}{more}; impulses there, and what is largest "
            "then, are so far"
        )

    def tables(self) -> dict[str, str]:
        """Over time."""
        return {"forces.csv": to_csv(self.readings, self.problem.scale)}

    def figures(self) -> "dict[str, Callable[[], Figure]]":
        """Over time."""
        from analysis.figures import force_figure

        return {"forces": lambda: force_figure(self.problem, self.readings)}


def _written(value: float) -> str:
    return f"{value:.6g}" if np.isfinite(value) else "-"


def _plain(found: Reflection) -> dict[str, Any]:
    return {
        "ratio": found.ratio,
        "uncertainty": found.uncertainty,
        "incident_beads": list(found.incident),
        "reflected_beads": list(found.reflected),
    }


def _said(found: Reflection, *, coupled: bool) -> str:
    among = "; chains exchange energy meanwhile" if coupled else ""
    return (
        f"the first pulse is reflected at {found.ratio:.4f} +- {found.uncertainty:.1g} of its peak velocity (incident: "
        f"beads {found.incident[0]} to {found.incident[1]}, reflected: {found.reflected[0]} to {found.reflected[1]}, "
        f"extrapolated to the wall{among})"
    )


def measure(directory: RunDirectory) -> Measure | None:
    """Of what the scene names; rigid beads feel none."""
    wanted, problem = directory.scene.output.forces, directory.problem
    if wanted is None or not ENGINES[directory.engine].deforms:
        return None
    places = gauges(problem, wall=wanted.wall is True, contacts=wanted.contacts or (), sensors=wanted.sensors or ())
    meter = ForceMeter(problem, places)
    sides = sorted({gauge.side for gauge in places if gauge.kind == "wall"})

    def finish(found: Survey) -> Forces:
        passed = (*found.pulses, *found.crests)
        error = (directory.record.get("check") or directory.record.get("certificate") or {}).get("amplitude") or 0.0
        reflected = {side: reflections(passed, problem, right=side == "right", error=error) for side in sides}
        return Forces(problem, meter.result(), reflected)

    return Measure(finish, meter.add)
