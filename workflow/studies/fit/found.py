"""What a fit found: values, intervals and test of fit, as a table, as words and as plain data."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from analysis.files.traces import Channel
from lammps_inputs import html
from lammps_inputs.numbers import known
from workflow.runs.check import Check
from workflow.studies.fit.estimate import Estimate
from workflow.studies.fit.goodness import Goodness


@dataclass(frozen=True)
class Fit:
    """What was found.

    Attributes:
        names: of what was free, in order; the last is the time offset, where that was free.
        units: of each, such as ``N/m``.
        start, value: of each, in these units.
        low, high: ends of the 95% confidence interval of each; None where the fit is rejected or not tested, or the
            data do not determine the value.
        found: in logarithms (the offset in units of T), and the noise.
        channels: of the data.
        channel_units: of each.
        share: [channel] noise over the largest value of the data.
        goodness: test of fit.
        fixed: names of the fixed fields that it tests.
        fits: whether it is passed; None where it cannot be made.
        assumed: fixed fields any change of which the free ones compensate, so that no data can test them.
        verdict: the outcome of the test of fit in one sentence.
        warnings: likely causes of a rejected fit, clipped traces, and what the data do not determine.
        check: error of the LAMMPS run against the reference.
        lammps: largest difference of a trace of LAMMPS from that of the reference, over the noise; None if LAMMPS did
            not run.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    start: tuple[float, ...]
    value: tuple[float, ...]
    low: tuple[float | None, ...]
    high: tuple[float | None, ...]
    found: Estimate
    channels: tuple[Channel, ...]
    channel_units: tuple[str, ...]
    share: tuple[float, ...]
    goodness: Goodness
    fixed: tuple[str, ...]
    fits: bool | None
    assumed: tuple[str, ...]
    verdict: str = ""
    warnings: tuple[str, ...] = ()
    check: Check | None = None
    lammps: float | None = None

    HEAD = ("field", "unit", "start", "found", "95% from", "to")
    """Of `rows`."""

    def _columns(self) -> Iterator[tuple[Any, ...]]:
        return zip(self.names, self.units, self.start, self.value, self.low, self.high, strict=True)

    def rows(self) -> list[tuple[str, ...]]:
        """Table of the fields, with so many digits that the interval shows two."""
        rows = []
        for name, unit, start, value, low, high in self._columns():
            digits = 6
            if low is not None and high is not None and high > low:
                digits = max(digits, 2 + math.ceil(math.log10(max(abs(low), abs(high)) / (high - low))))
            numbers = ("-" if number is None else f"{number:.{min(digits, 17)}g}" for number in (value, low, high))
            rows.append((name, unit or "-", f"{start:.6g}", *numbers))
        return rows

    def __repr__(self) -> str:
        found = ", ".join(f"{name} = {value:.6g}" for name, value in zip(self.names, self.value, strict=True))
        return f"<fit{' (rejected)' if self.fits is False else ''}: {found[:150]}>"

    def _repr_html_(self) -> str:
        notes = "".join(html.text(note) for note in self.notes())
        return html.text(self.verdict) + html.table("fit", self.HEAD, self.rows()) + notes

    def notes(self) -> list[str]:
        """Warnings, and what intervals assume."""
        said = [f"warning: {warning}" for warning in self.warnings]
        if self.fits and self.assumed:
            fixed = ", ".join(self.assumed)
            said.append(f"intervals assume the given {fixed}: free fields compensate any change, so no data test them")
        return said

    def plain(self) -> dict[str, Any]:
        """For ``fit.json``.

        | key         | what                                                                           |
        |-------------|--------------------------------------------------------------------------------|
        | fits        | whether the test of fit is passed; null where it cannot be made                |
        | verdict     | the same in words                                                              |
        | p           | smallest p-value of its tests, times their number; rejected below 0.01         |
        | assumed     | fixed fields that no data can test, since the free ones compensate any change  |
        | free        | per field: unit, start, value, low and high (95%); the last two null where the |
        |             | test is not passed, or the data do not determine the field                     |
        | correlation | of the logarithms, in the order of ``free``; null where undefined              |
        | channels    | per channel: unit; noise (standard deviation of the residuals), over the       |
        |             | largest value; chi_square, autocorrelation, runs: see `Goodness`, and their p  |
        | rows        | values fitted                                                                  |
        | warnings    | likely causes of a rejected fit, clipped traces, what the data do not determine |
        | lammps      | error of its run in V; largest difference from the reference's traces / noise  |
        """
        test = self.goodness
        return {
            "fits": self.fits,
            "verdict": self.verdict,
            "p": known(test.joint),
            "assumed": list(self.assumed),
            "free": {
                n: {"unit": u, "start": s, "value": v, "low": a, "high": b} for n, u, s, v, a, b in self._columns()
            },
            "correlation": [[known(value) for value in row] for row in self.found.correlation.tolist()],
            "channels": {
                channel.name: {
                    "unit": unit,
                    "noise": float(self.found.noise[place]),
                    "over_largest": self.share[place],
                    "chi_square": known(float(test.chi_square[place])),
                    "autocorrelation": known(float(test.autocorrelation[place])),
                    "runs": known(float(test.runs[place])),
                    "p": [known(p) for p in test.p[:, place].tolist()],
                }
                for place, (channel, unit) in enumerate(zip(self.channels, self.channel_units, strict=True))
            },
            "rows": self.found.rows,
            "converged": self.found.converged,
            "warnings": list(self.warnings),
            "lammps": {
                "error_velocity": None if self.check is None else self.check.velocity,
                "difference": self.lammps,
            },
        }
