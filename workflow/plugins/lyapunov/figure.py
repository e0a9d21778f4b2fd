"""Figure of Lyapunov exponents: their convergence over time, and where there are several, all of them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from matplotlib.figure import Figure

from granchain.parts import Floats, style, units


@dataclass(frozen=True)
class Convergence:
    """Estimate of an exponent by one run.

    Attributes:
        name: in the legend.
        time: [record].
        exponent: growth until then over the time, [record].
    """

    name: str
    time: Floats
    exponent: Floats


@style.styled
def draw(
    runs: Sequence[Convergence],
    exponents: Floats,
    errors: Floats,
    bounds: Floats,
    labels: tuple[units.Label, units.Label],
    title: str,
) -> Figure:
    """Estimates of the largest exponent over time, with the result; beside them all exponents where there are several.

    Args:
        runs: estimates of the runs.
        exponents: results, [exponent]; NaN where undefined, or where they cannot be distinguished from 0.
        errors: their uncertainties, [exponent].
        bounds: on the sizes of those that cannot be distinguished from 0, [exponent]; NaN of the others.
        labels: of an exponent and of time.
        title: for the top.
    """
    several = len(exponents) > 1
    figure = style.new_figure(3.2, 7.0 if several else 5.5)
    axes = np.ravel(figure.subplots(1, 2 if several else 1, squeeze=False))
    for place, run in enumerate(runs):
        axes[0].plot(
            run.time,
            run.exponent,
            color=style.CHAIN_COLOURS[place],
            linestyle=style.CHAIN_DASHES[place],
            label=run.name,
        )
    if np.isfinite(exponents[0]):
        axes[0].axhspan(
            exponents[0] - errors[0], exponents[0] + errors[0], color="0.8", label="result, with its uncertainty"
        )
    elif np.isfinite(bounds[0]):
        axes[0].axhspan(-bounds[0], bounds[0], color="0.9", label="result: cannot be distinguished from 0")
    axes[0].set_xscale("log")
    style.label_axis(axes[0].xaxis, labels[1])
    style.label_axis(axes[0].yaxis, replace(labels[0], words=f"largest {labels[0].words}"))
    if several:
        number = np.arange(1, len(exponents) + 1)
        axes[1].vlines(number, -bounds, bounds, color="0.8", linewidth=3.0)
        axes[1].errorbar(number, exponents, yerr=errors, fmt="o", markersize=3, color="black")
        axes[1].axhline(0.0, color="0.6", linewidth=0.8)
        axes[1].set_xlabel("number of\nthe exponent" if style.is_narrow() else "number of the exponent")
        axes[1].locator_params(axis="x", integer=True)
        style.label_axis(axes[1].yaxis, labels[0])
        style.letter(axes)
    style.head(figure, title)
    style.legend_below(figure, *axes[0].get_legend_handles_labels())
    return figure
