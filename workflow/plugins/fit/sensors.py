"""Signals of sensors with a gain or a baseline to be estimated: linear functions of a trace.

    signal = baseline + trace / gain

Residuals are those of the signal, whose noise is of one size whatever the gain. Parameters are the inverse gain and the
baseline, in which the model is linear, so that a gain may have either sign.
"""

from dataclasses import dataclass

import numpy as np

from granchain.parts import Floats, traces

AT_REST = 1e-6
"""Largest dimensionless trace that no gain is fitted to."""


@dataclass(frozen=True)
class Sensors:
    """Signals of the channels of a table, by parameters [parameter]: those of the first channel first.

    Attributes:
        calibrations: [channel] what is given; of a channel without a signal gain 1 and baseline 0.
        size: [channel] largest distance of the data from their middle, in the channel's unit.
        middle: [channel] signal from which a free baseline is counted, in the channel's unit.
        worth: [channel] unit of the dimensionless trace, in the scene's unit.
    """

    calibrations: tuple[traces.Calibration, ...]
    size: Floats
    middle: Floats
    worth: Floats

    @classmethod
    def of(cls, measured: traces.Traces, worth: Floats) -> "Sensors":
        """Sensors of a table.

        Args:
            measured: the table.
            worth: [channel] see `Sensors`.
        """
        plain = traces.Calibration()
        calibrations = tuple(measured.signals.get(place, plain) for place in range(len(measured.channels)))
        free = np.array([calibration.baseline is None for calibration in calibrations])
        middle = np.where(free, np.nanmedian(measured.values, axis=0), 0.0)
        return cls(calibrations, np.nanmax(np.abs(measured.values - middle), axis=0), middle, worth)

    @property
    def free(self) -> tuple[tuple[int, str], ...]:
        """Channel, from 0, and ``gain`` or ``baseline``, of each parameter."""
        return tuple(
            (place, name)
            for place, calibration in enumerate(self.calibrations)
            for name in ("gain", "baseline")
            if getattr(calibration, name) is None
        )

    def lines(self, parameters: Floats) -> tuple[Floats, Floats]:
        """Inverse gains and baselines, [channel] each, at parameters [parameter]."""
        inverse = np.array([1.0 / (calibration.gain or 1.0) for calibration in self.calibrations])
        baseline = np.array([calibration.baseline or 0.0 for calibration in self.calibrations])
        for (place, name), parameter in zip(self.free, parameters, strict=True):
            if name == "gain":
                inverse[place] = parameter * self.size[place] / self.worth[place]
            else:
                baseline[place] = self.middle[place] + parameter * self.size[place]
        return inverse, baseline

    def signals(self, values: Floats, parameters: Floats) -> Floats:
        """Signals of traces [row, channel] in the scene's units, at parameters [parameter]."""
        inverse, baseline = self.lines(parameters)
        return np.asarray(baseline + inverse * values)

    def values(self, signals: Floats, parameters: Floats) -> Floats:
        """Traces of signals [row, channel], in the scene's units, at parameters [parameter]; NaN without a gain."""
        inverse, baseline = self.lines(parameters)
        return np.asarray((signals - baseline) / np.where(inverse == 0.0, np.nan, inverse))

    def slopes(self, values: Floats) -> Floats:
        """Derivatives of the signals of traces [row, channel], [row, channel, parameter]."""
        slopes = np.zeros((*values.shape, len(self.free)))
        for number, (place, name) in enumerate(self.free):
            factor = values[:, place] / self.worth[place] if name == "gain" else 1.0
            slopes[:, place, number] = factor * self.size[place]
        return slopes

    def best(self, values: Floats, data: Floats) -> Floats:
        """Parameters [parameter] with which signals of traces [row, channel] are nearest to data [row, channel]."""
        parameters = np.zeros(len(self.free))
        slopes = self.slopes(values)
        rest = data - self.signals(values, parameters)
        for place in {place for place, _ in self.free}:
            numbers = [number for number, (channel, _) in enumerate(self.free) if channel == place]
            measured = np.isfinite(data[:, place])
            columns = slopes[measured, place][:, numbers]
            columns[:, np.abs(columns).max(axis=0, initial=0.0) < AT_REST * self.size[place]] = 0.0
            parameters[numbers] = np.linalg.lstsq(columns, rest[measured, place], rcond=None)[0]
        return parameters

    def reported(self, parameters: Floats) -> list[float]:
        """Gains, in the scene's unit per unit of the signal, and baselines, of parameters [parameter]."""
        inverse, baseline = self.lines(parameters)
        with np.errstate(divide="ignore"):
            gain = 1.0 / inverse
        return [float(gain[place] if name == "gain" else baseline[place]) for place, name in self.free]
