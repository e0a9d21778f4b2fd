"""The dispersion of small waves under a static load, exact and as the run shows it."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from analysis.sharing.survey import Survey
from analysis.sound.dispersion import Dispersion as Collected
from analysis.sound.dispersion import Map, NoDispersionError, to_csv
from lammps_inputs.numbers import known
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.findings.finding import Finding, Measure

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Dispersion(Finding):
    """A map, or why there is none, in words."""

    key = "dispersion"

    map: Map | str

    def plain(self) -> dict[str, Any]:
        """In the scene's units.

        | key      | what                                                                                |
        |----------|-------------------------------------------------------------------------------------|
        | why      | why there is no map; else null, and:                                                |
        | beads    | of a cell, what repeats along the chains                                            |
        | bands    | lowest and highest angular frequency of every branch, exact                         |
        | measured | the same as the run shows them; null where it does not                              |
        | bin      | of frequency: as sure as those are                                                  |
        """
        if isinstance(self.map, str):
            return {"why": self.map}
        unit = self.problem.scale.time
        measured = (self.map.measured_bands() / unit).tolist()
        return {
            "why": None,
            "beads": self.map.cell.beads,
            "bands": (self.map.cell.bands() / unit).tolist(),
            "measured": [[known(edge) for edge in band] for band in measured],
            "bin": self.map.bin / unit,
        }

    def said(self) -> Iterator[str]:
        """Why there is none."""
        if isinstance(self.map, str):
            yield f"no dispersion map: {self.map}"

    def tables(self) -> dict[str, str]:
        """The branches."""
        return {} if isinstance(self.map, str) else {"dispersion.csv": to_csv(self.map, self.problem.scale)}

    def figures(self) -> "dict[str, Callable[[], Figure]]":
        """The map with the branches."""
        from analysis.figures import dispersion_figure

        found = self.map
        return {} if isinstance(found, str) else {"dispersion": lambda: dispersion_figure(self.problem, found)}


def measure(directory: RunDirectory) -> Measure | None:
    """Under a static load."""
    problem = directory.problem
    if not problem.loaded:
        return None
    try:
        collected = Collected(problem)
    except NoDispersionError as error:
        why = str(error)
        return Measure(lambda _: Dispersion(problem, why))

    def finish(_: Survey) -> Dispersion:
        try:
            return Dispersion(problem, collected.result())
        except NoDispersionError as error:
            return Dispersion(problem, str(error))

    return Measure(finish, collected.add)
