"""Spectra of the beads that a scene names, and how much of a drive they pass on."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from analysis import quantity
from analysis.gauges.spectra import HighestLine, Lines, SpectrumMeter, SpectrumTable
from analysis.gauges.spectra import Spectra as Measured
from analysis.sharing.survey import Survey
from workflow.runs.run_directory import RunDirectory
from workflow.screen import Table
from workflow.verdicts.findings.finding import MOST_CHAINS, Finding, Measure

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Spectra(Finding):
    """Of the velocity."""

    key, kind, figures = "spectra", Lines, ("spectra",)
    table = "spectra.csv", SpectrumTable

    found: Lines
    spectra: Measured

    def said(self) -> Iterator[Table]:
        """The highest line of every bead, and what it has of the drives."""
        spectra, found, scale = self.spectra, self.found, self.problem.scale
        words = {"frequency": "highest line at", "amplitude": "its velocity"}
        head = ["bead", "chain", *quantity.headings(HighestLine, scale, words)]
        for frequency in spectra.drive:
            at = scale.heading(f"at {frequency / scale.time:.5g}", "cycles")
            head.append(f"{at}, over bead {spectra.beads[0]}")
        rows = []
        for one in sorted(found.beads, key=lambda line: (spectra.beads.index(line.bead), line.chain)):
            if one.chain <= MOST_CHAINS:
                line = [quantity.written(one, name, scale, ".5g") for name in words]
                passed_on = [quantity.cell(drive.transmissibility, ".5g") for drive in one.at_drive]
                rows.append([str(one.bead) if one.chain == 1 else "", str(one.chain), *line, *passed_on])
        start = scale.written(found.after, "time", ".5g")
        yield Table(f"{self.problem.name}: spectra from t = {start} on", head, rows)

    def columns(self) -> dict[str, Any]:
        """All lines."""
        return self.spectra.columns(self.problem.scale)

    def drawn(self) -> "dict[str, Callable[[], Figure]]":
        """All lines."""
        from analysis.figures import spectra_figure

        return {"spectra": lambda: spectra_figure(self.problem, self.spectra)}

    @classmethod
    def measure(cls, directory: RunDirectory) -> Measure | None:
        """Of what the scene names."""
        wanted, problem = directory.scene.output.spectra, directory.problem
        if wanted is None:
            return None
        after = None if wanted.after is None else wanted.after / problem.scale.time
        meter = SpectrumMeter(problem, wanted.beads, after)

        def finish(_: Survey) -> Spectra | None:
            spectra = meter.result()
            return None if spectra is None else cls(problem, spectra.found(problem), spectra)

        return Measure(finish, meter.add)
