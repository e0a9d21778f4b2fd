"""The dispersion of small waves under a static load, exact and as the run shows it."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from analysis import quantity
from analysis.sharing.survey import Survey
from analysis.sound.dispersion import Bands, Branches, Map, NoDispersionError
from analysis.sound.dispersion import Dispersion as Collected
from lammps_inputs import physics
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.findings.finding import Finding, Measure

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Dispersion(Finding):
    """Bands, and the map that they are from; None where there is none."""

    key, kind, figures = "dispersion", Bands, ("dispersion",)
    table = "dispersion.csv", Branches

    found: Bands
    map: Map | None

    def said(self) -> Iterator[str]:
        """Why there is none."""
        if self.found.why is not None:
            yield f"no dispersion map: {self.found.why}"

    def columns(self) -> dict[str, Any]:
        """The branches."""
        return {} if self.map is None else quantity.table(self.map.branches(), self.problem.scale)

    def drawn(self) -> "dict[str, Callable[[], Figure]]":
        """The map with the branches."""
        from analysis.figures import dispersion_figure

        found = self.map
        return {} if found is None else {"dispersion": lambda: dispersion_figure(self.problem, found)}

    @classmethod
    def measure(cls, directory: RunDirectory) -> Measure | None:
        """Under a static load."""
        problem = directory.problem
        if not physics.loaded(problem.system):
            return None
        try:
            collected = Collected(problem)
        except NoDispersionError as error:
            why = Bands(str(error))
            return Measure(lambda _: cls(problem, why, None))

        def finish(_: Survey) -> Dispersion:
            try:
                found = collected.result()
            except NoDispersionError as error:
                return cls(problem, Bands(str(error)), None)
            return cls(problem, found.bands(), found)

        return Measure(finish, collected.add)
