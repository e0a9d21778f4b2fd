"""The time offset at which traces and data agree best on a raster, to begin a search, and channels of reversed sign."""

import numpy as np

from analysis.files.traces import Channel
from analysis.gauges.channels import read
from analysis.trajectory import Floats
from lammps_inputs import InputError
from workflow.studies.fit.search import Search


def squares(residuals: Floats) -> float:
    """Sum of squares, of what is known."""
    return float(np.nansum(residuals**2))


def aligned(search: Search, logarithms: Floats, size: Floats, *, flipped: bool = False) -> tuple[float, Floats] | None:
    """Sum of squares, weighed by size, and parameters with the offset at which it is least on a raster.

    With ``flipped`` the offset is that at which it is least where the sign of each channel is free. None where the
    scene is refused.
    """
    given = search.model.given
    if not search.finds_offset:
        return squares(search.residuals(logarithms) / size), logarithms
    span = float(given.time[-1] - given.time[0])
    try:
        run = search.model.run(search.what.put(search.scene, search.what.values(logarithms)), span)
    except (InputError, OverflowError):
        return None
    # with traces at the frames, since thousands of offsets are tried
    frames, unit = run.time * run.problem.scale.time, search.model.unit_time
    shown = read(run, given.channels) * [getattr(run.problem.scale, channel.quantity) for channel in given.channels]

    def cost(offset: float) -> float:
        traces = np.stack([np.interp(given.time - offset, frames, column, left=0.0) for column in shown.T], axis=1)
        found = np.nansum(((given.values - traces) / size) ** 2, axis=0)
        if flipped:
            found = np.minimum(found, np.nansum(((given.values + traces) / size) ** 2, axis=0))
        return float(np.sum(found))

    rough = given.time[0] - span / 2.0 + np.arange(0.0, 1.5 * span, max(0.5 * unit, span / 2000.0))
    best = min(rough, key=cost)
    best = min(best + np.linspace(-1.0, 1.0, 41) * (rough[1] - rough[0] if len(rough) > 1 else unit), key=cost)
    parameters = np.append(logarithms, best / unit)
    return squares(search.residuals(parameters) / size), parameters


def reversed_channels(search: Search, parameters: Floats, size: Floats) -> tuple[Channel, ...]:
    """Channels whose opposite sign at least halves the sum of squares, near these parameters or the start."""
    given = search.model.given
    count = len(search.what.names)
    found: tuple[Channel, ...] = ()
    least = 0.5 * squares(search.residuals(parameters) / size)
    for point in (parameters[:count], np.zeros(count)):
        best = aligned(search, point, size, flipped=True)
        traces = None if best is None else search.traces(best[1])
        if traces is None:
            continue
        signs = np.where(np.nansum(given.values * traces, axis=0) < 0.0, -1.0, 1.0)
        cost = squares((given.values - signs * traces) / size)
        if cost < least:
            least = cost
            found = tuple(channel for channel, sign in zip(given.channels, signs, strict=True) if sign < 0.0)
    return found
