"""Spectra of the beads that a scene names, and how much of a drive they pass on."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from analysis.gauges.spectra import Spectra as Lines
from analysis.gauges.spectra import SpectrumMeter, drives, to_csv
from analysis.sharing.survey import Survey
from analysis.sound.dispersion import NoDispersionError, cell_of
from lammps_inputs import Problem
from lammps_inputs.numbers import known
from workflow.runs.run_directory import RunDirectory
from workflow.screen import Table
from workflow.verdicts.findings.finding import MOST_CHAINS, Finding, Measure

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Spectra(Finding):
    """Of the velocity."""

    key = "spectra"

    lines: Lines

    def plain(self) -> dict[str, Any]:
        """In the scene's units; all spectra are in ``spectra.csv``.

        | key              | what                                                                                  |
        |------------------|---------------------------------------------------------------------------------------|
        | after            | time from which on frames were taken                                                  |
        | resolution       | distance of two lines; swings nearer than two of it are not told apart                |
        | beads            | entries: chain, bead, frequency and amplitude of the highest line of the velocity,    |
        |                  | and of each drive ``at_drive``: frequency, amplitude, transmissibility (over that of  |
        |                  | the chain's first bead; null where that does not move)                                |
        | transmissibility | of the last bead named, in the chain of the first drive, at its frequency             |
        | bands            | lowest and highest frequency of every branch of small waves, exact; null where the    |
        |                  | chains pass on no sound, or nothing repeats along them                                |
        """
        spectra, problem, scale = self.lines, self.problem, self.problem.scale
        passed_on, entries = spectra.transmissibility, []
        for chain in range(problem.chains):
            for place, bead in enumerate(spectra.beads):
                top = int(np.argmax(spectra.amplitude[:, chain, place]))
                entries.append(
                    {
                        "chain": chain + 1,
                        "bead": bead,
                        "frequency": float(spectra.frequency[top] / scale.time),
                        "amplitude": float(spectra.amplitude[top, chain, place] * scale.velocity),
                        "at_drive": [
                            {
                                "frequency": float(frequency / scale.time),
                                "amplitude": known(float(spectra.at_drive[k, chain, place] * scale.velocity)),
                                "transmissibility": known(float(passed_on[k, chain, place])),
                            }
                            for k, frequency in enumerate(spectra.drive)
                        ],
                    }
                )
        found = None
        for chain, _, frequency in drives(problem)[:1]:
            found = known(float(passed_on[np.searchsorted(spectra.drive, frequency), chain - 1, -1]))
        return {
            "after": spectra.after * scale.time,
            "resolution": float((spectra.frequency[1] - spectra.frequency[0]) / scale.time),
            "transmissibility": found,
            "bands": _bands(problem),
            "beads": entries,
        }

    def said(self) -> Iterator[Table]:
        """The highest line of every bead, and what it has of the drives."""
        spectra, scale = self.lines, self.problem.scale
        hertz, velocity = (" (Hz)", f" ({scale.symbol('velocity')})") if scale.si else ("", "")
        head = ["bead", "chain", f"highest line at{hertz}", f"its velocity{velocity}"]
        head += [f"at {frequency / scale.time:.5g}{hertz}, over bead {spectra.beads[0]}" for frequency in spectra.drive]
        rows = []
        for place, bead in enumerate(spectra.beads):
            for chain in range(min(self.problem.chains, MOST_CHAINS)):
                top = int(np.argmax(spectra.amplitude[:, chain, place]))
                height = float(spectra.amplitude[top, chain, place] * scale.velocity)
                line = [f"{spectra.frequency[top] / scale.time:.5g}", f"{height:.5g}"]
                passed_on = [f"{share:.5g}" for share in spectra.transmissibility[:, chain, place]]
                rows.append([str(bead) if chain == 0 else "", str(chain + 1), *line, *passed_on])
        start = scale.written(spectra.after, "time", ".5g")
        yield Table(f"{self.problem.name}: spectra from t = {start} on", head, rows)

    def tables(self) -> dict[str, str]:
        """All lines."""
        return {"spectra.csv": to_csv(self.lines, self.problem.scale)}

    def figures(self) -> "dict[str, Callable[[], Figure]]":
        """All lines."""
        from analysis.figures import spectra_figure

        return {"spectra": lambda: spectra_figure(self.problem, self.lines)}


def measure(directory: RunDirectory) -> Measure | None:
    """Of what the scene names."""
    wanted, problem = directory.scene.output.spectra, directory.problem
    if wanted is None:
        return None
    meter = SpectrumMeter(problem, wanted.beads, None if wanted.after is None else wanted.after / problem.scale.time)

    def finish(_: Survey) -> Spectra | None:
        lines = meter.result()
        return None if lines is None else Spectra(problem, lines)

    return Measure(finish, meter.add)


def _bands(problem: Problem) -> list[list[float]] | None:
    try:
        bands = cell_of(problem).bands() / (2.0 * np.pi * problem.scale.time)
    except NoDispersionError:
        return None
    return [[float(edge) for edge in band] for band in bands]
