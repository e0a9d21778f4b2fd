"""What the gauges that a scene names have read: walls, contacts, sensors."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from analysis.gauges.forces import ForceMeter
from analysis.gauges.gauge import gauges
from analysis.gauges.readings import Readings, to_csv
from analysis.gauges.restitution import restitution
from analysis.sharing.survey import Survey
from analysis.trajectory import Floats
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
        given_back: of the walls among them, by side: velocity of the pulse thrown back over that which came, [chain].
    """

    key = "forces"

    readings: Readings
    given_back: dict[str, Floats]

    def plain(self) -> list[dict[str, Any]]:
        """An entry for each gauge and chain, in the scene's units.

        | key           | what                                                                                      |
        |---------------|-------------------------------------------------------------------------------------------|
        | kind, name    | wall, contact or sensor; name of the column in ``forces.csv``                             |
        | chain, bead   | at a wall the bead that touches it; the first bead of a contact; the bead with the sensor |
        | largest, at   | largest force, between frames too, and when; null where there was none                    |
        | static        | only under a static load: force at rest, which ``largest`` includes                       |
        | dynamic       | likewise: ``largest`` without it                                                          |
        | impulse       | integral of the force, but for that at rest, over time; what a wall takes of the momentum |
        | dwell         | how long the contact lasted in which the force was largest                                |
        | contacts      | how many contacts there were                                                              |
        | restitution   | walls only: peak velocity of the first pulse thrown back over that of the one that came,  |
        |               | at one bead (`analysis.gauges.restitution`); null where one of them was not seen          |
        """
        readings, scale, entries = self.readings, self.problem.scale, []
        for place, gauge in enumerate(readings.gauges):
            for chain in range(self.problem.chains):
                entry: dict[str, Any] = {
                    "kind": gauge.kind,
                    "name": gauge.name,
                    "chain": chain + 1,
                    "bead": gauge.bead,
                    "largest": float(readings.largest[chain, place] * scale.force),
                    "at": known(float(readings.largest_at[chain, place] * scale.time)),
                    **self._above_rest(chain, place),
                    "impulse": float(readings.impulse[chain, place] * scale.momentum),
                    "dwell": float(readings.dwell[chain, place] * scale.time),
                    "contacts": int(readings.contacts[chain, place]),
                }
                if gauge.kind == "wall":
                    entry["restitution"] = known(float(self.given_back[gauge.side][chain]))
                entries.append(entry)
        return entries

    def _above_rest(self, chain: int, place: int) -> dict[str, float]:
        readings, force = self.readings, self.problem.scale.force
        if not np.any(readings.static):
            return {}
        static, largest = readings.static[chain, place], readings.largest[chain, place]
        return {"static": float(static * force), "dynamic": float((largest - static) * force)}

    def said(self) -> Iterator[str | Table]:
        """The largest force, impulse and dwell of every gauge; what walls felt and threw back."""
        problem, readings, scale = self.problem, self.readings, self.problem.scale
        chains = range(min(problem.chains, MOST_CHAINS))
        names = ("force", "time", "momentum")
        force, time, momentum = (f" ({scale.symbol(name)})" if scale.si else "" for name in names)
        rows = []
        for place, gauge in enumerate(readings.gauges):
            for chain in chains:
                numbers = ["0", "-", "0", "-"]
                if readings.largest[chain, place] > 0.0:
                    numbers = [
                        f"{readings.largest[chain, place] * scale.force:.6g}",
                        f"{readings.largest_at[chain, place] * scale.time:.6g}",
                        f"{readings.impulse[chain, place] * scale.momentum:.6g}",
                        f"{readings.dwell[chain, place] * scale.time:.4g}",
                    ]
                rows.append([gauge.name if chain == 0 else "", str(chain + 1), *numbers])
        head = ["force at", "chain", f"largest{force}", f"at{time}", f"impulse{momentum}", f"dwell{time}"]
        yield Table(f"{problem.name}: forces", head, rows)
        kinds = [gauge.kind for gauge in readings.gauges]
        for place, gauge in enumerate(readings.gauges):
            if gauge.kind != "wall":
                continue
            for chain in chains:
                said = []
                if "contact" in kinds and (inside := readings.largest[chain, kinds.index("contact")]) > 0.0:
                    other = readings.gauges[kinds.index("contact")].name
                    said.append(f"largest force {readings.largest[chain, place] / inside:.4f} times that at {other}")
                if math.isfinite(back := self.given_back[gauge.side][chain]):
                    among = " (and chains have exchanged energy meanwhile)" if problem.coupled else ""
                    said.append(f"the first pulse is thrown back at {back:.4f} of its velocity{among}")
                if said:
                    yield f"{gauge.name}, chain {chain + 1}: {', '.join(said)}"

    def tables(self) -> dict[str, str]:
        """Over time."""
        return {"forces.csv": to_csv(self.readings, self.problem.scale)}

    def figures(self) -> "dict[str, Callable[[], Figure]]":
        """Over time."""
        from analysis.figures import force_figure

        return {"forces": lambda: force_figure(self.problem, self.readings)}


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
        given_back = {side: restitution(passed, problem, right=side == "right") for side in sides}
        return Forces(problem, meter.result(), given_back)

    return Measure(finish, meter.add)
