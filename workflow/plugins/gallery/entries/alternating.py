"""Two alternating kinds of beads: dimers with and without residual motion, and small beads between large ones."""

import math
from collections.abc import Iterable

import numpy as np
from matplotlib.axes import Axes

from granchain.parts import Floats, exact_wave
from workflow.plugins.gallery.criteria import MeasuredQuantity, at_most, near, state
from workflow.plugins.gallery.entry import COLOURS, PUBLISHED, Entry, Ran, Results, Statements, chain, each, line

# --- anti-resonances of dimers ----------------------------------------------------------------------------------------

ANTI_RESONANCES = (0.3428, 0.1548, 0.0901)
AROUND = (0.98, 0.99, 1.01, 1.02)


def _dimer(ratio: float, beads: int) -> dict[str, object]:
    """A chain of dimers whose light beads have this mass."""
    kinds = {"heavy": {"mass": 1}, "light": {"mass": float(f"{ratio:.6g}")}}
    return chain(beads, 1.07 * beads, kinds=kinds, pattern=[*kinds])


def _residuals(results: Results, ratio: float, factors: Iterable[float]) -> list[float]:
    """Share of the energy that stays in a cell, by the reference, at a mass ratio times factors, [factor]."""
    return [results[f"ratio-{ratio * factor:.4f}"]["reference"].residual for factor in factors]


def _least(results: Results, ratio: float) -> float:
    """Mass ratio at which no energy stays in a cell: the energy grows as the square of the distance from it."""
    ratios = np.array([ratio * factor for factor in AROUND])
    left = np.array(_residuals(results, ratio, AROUND))
    roots = np.roots(np.polyfit(ratios / ratio - 1.0, np.copysign(np.sqrt(left), ratios - ratio), 2))
    return float(ratio * (1.0 + roots[np.argmin(np.abs(roots))].real))


def _anti_resonances(results: Results) -> Statements:
    """Mass ratios of the minima, and residual energies there."""
    for ratio in ANTI_RESONANCES:
        least, left = (
            {"reference": _least(results, ratio)},
            each(lambda run: run.residual, results[f"ratio-{ratio:.4f}"]),
        )
        yield state(
            MeasuredQuantity("mass ratio of the smallest residual energy", least, near(ratio, 1e-4, 2e-3)),
            published=f"There is no residual motion at a mass ratio of {ratio}.",
            source="jayaprakash2011, as quoted",
            derived="Required within one unit of the last digit.",
        )
        yield state(
            MeasuredQuantity("share of the pulse's energy that stays in a cell", left, at_most(2e-7), "1e"),
            published=f"At {ratio} a solitary wave propagates.",
            source="jayaprakash2011, as quoted",
        )


def _draw_anti_resonances(axis: Axes, results: Results) -> None:
    """Residual energy over the ratio."""
    for place, ratio in enumerate(ANTI_RESONANCES):
        cases = sorted((*AROUND, 1.0))
        look = {"color": COLOURS[place], "marker": "os^"[place], "linestyle": "none", "markersize": 5}
        axis.semilogy(cases, _residuals(results, ratio, cases), label=f"near {ratio}", **look)
    axis.axvline(1.0, label="published ratio", **PUBLISHED)


DIMERS = Entry(
    title="Anti-resonances of dimers",
    introduction="Alternating heavy and light beads, all contacts alike. In general light beads oscillate behind "
    "the pulse, which decays; at some mass ratios there is no residual motion.",
    sources={"jayaprakash2011": "as quoted in the literature; the paper could not be read"},
    scenes={f"ratio-{ratio:.4f}": _dimer(ratio, 90) for ratio in ANTI_RESONANCES},
    swept={f"ratio-{ratio * factor:.4f}": _dimer(ratio * factor, 90) for ratio in ANTI_RESONANCES for factor in AROUND},
    statements=_anti_resonances,
    axes=("mass ratio / published ratio", "energy that stays in a cell /\nenergy of the pulse"),
    draw=_draw_anti_resonances,
    caption="Residual energy of a cell around the published mass ratios (reference).",
)

# --- the resonance of dimers ------------------------------------------------------------------------------------------

RESONANCE, OTHER = 0.59, 0.3428
CELLS = (10, 60)
SWEPT = (0.2, 0.24, 0.28, OTHER, 0.4, 0.44, 0.48, 0.52, 0.55, 0.57, 0.61, 0.63, 0.67, 0.75, 0.85)


def _curve(results: Results, cell: int) -> tuple[Floats, Floats]:
    """Mass ratios, [ratio], and peak velocities (V) of the heavy bead of a cell, [ratio]."""
    ratio = sorted((*SWEPT, RESONANCE))
    peak = [results[f"ratio-{mass_ratio:g}"]["reference"].peak(2 * cell + 1) for mass_ratio in ratio]
    return np.array(ratio), np.array(peak)


def _weakest(results: Results, cell: int) -> float:
    """Mass ratio of the smallest peak velocity in a cell, by a parabola through the lowest value and its neighbours."""
    ratio, peak = _curve(results, cell)
    at = int(np.argmin(peak))
    square, slope, _ = np.polyfit(ratio[at - 1 : at + 2], peak[at - 1 : at + 2], 2)
    return float(-slope / (2.0 * square))


def _resonance(results: Results) -> Statements:
    """Mass ratio of the weakest pulse, its dependence on the distance, and the attenuation."""
    source, (close, far) = "jayaprakash2013, as quoted", (_weakest(results, cell) for cell in CELLS)
    resonant, other = (results[f"ratio-{ratio:g}"] for ratio in (RESONANCE, OTHER))
    bead = 2 * CELLS[1] + 1
    weaker = each(lambda run, other_run: run.peak(bead) / other_run.peak(bead), resonant, other)
    yield state(
        MeasuredQuantity(
            f"mass ratio of the weakest pulse in cell {CELLS[1]}", {"reference": far}, near(RESONANCE, 0.01), "3"
        ),
        published=f"The pulse is attenuated most at a mass ratio of {RESONANCE}.",
        source=source,
        derived="Required within one unit of the last digit.",
    )
    drift = {"reference": abs(close - far)}
    yield state(
        MeasuredQuantity(f"its change between cells {CELLS[0]} and {CELLS[1]}", drift, at_most(0.01, math.inf), "3"),
        published="The ratio is quoted without a distance.",
        source=source,
        correction=f"It depends on the distance: after {CELLS[0]} cells it is {close:.2f}.",
    )
    yield state(
        MeasuredQuantity(
            f"velocity in cell {CELLS[1]} over that at the anti-resonance {OTHER}", weaker, at_most(0.5), "4"
        ),
        published="At the resonance the pulse is attenuated strongly.",
        source=source,
    )


def _draw_resonance(axis: Axes, results: Results) -> None:
    """Velocity after some cells over the mass ratio."""
    for place, cell in enumerate(CELLS):
        axis.plot(*_curve(results, cell), marker="os"[place], ms=4, label=f"cell {cell}", **line(place))
    axis.axvline(RESONANCE, label=f"published: {RESONANCE}", **PUBLISHED)


DIMER_RESONANCE = Entry(
    title="Resonance of dimers",
    introduction="The same chains of heavy and light beads, at the mass ratios at which the pulse loses most energy "
    "to the light beads behind it.",
    sources={"jayaprakash2013": "as quoted in the literature; the paper could not be read"},
    scenes={f"ratio-{ratio:g}": _dimer(ratio, 150) for ratio in (RESONANCE, OTHER)},
    swept={f"ratio-{ratio:g}": _dimer(ratio, 150) for ratio in SWEPT if ratio != OTHER},
    statements=_resonance,
    axes=("mass of the light beads / mass of the heavy ones", r"peak velocity of a heavy bead $v_\mathrm{max} / V$"),
    draw=_draw_resonance,
    caption="Peak velocity of a heavy bead in two cells over the mass of the light beads (reference).",
)

# --- decorated chains -------------------------------------------------------------------------------------------------

RADII = {f"radius-{radius:g}": radius for radius in (0.2, 0.3, 0.4)}
PLAIN = 0.68163
"""Velocity of the wave of a plain kicked chain, V."""


def _decorated_chain(radius: float) -> dict[str, object]:
    kinds = {"big": {"radius": 1}, "small": {"radius": radius}}
    return chain(141, 140, timestep=0.002, kinds=kinds, pattern=[*kinds])


def _cells(run: Ran) -> float:
    """Speed in cells per unit time."""
    return 0.5 * run.speed(61, 101)


def _effective(radius: float, velocity: float) -> float:
    """Cells per unit time of the solitary wave of the plain chain that a decorated one acts as.

    A small bead between two large ones is light: its two contacts feel the same force and share the overlap.
    """
    contact, mass = (2.0 * radius / (1.0 + radius)) ** 0.5 / math.sqrt(8.0), 1.0 + radius**3
    return float((contact / mass) ** 0.4 * exact_wave.solitary_wave().speed_at(velocity))


def _decorated(results: Results) -> Statements:
    """Speed and amplitude of the effective chain."""
    claim = "A decorated chain acts as a plain chain of renormalised mass and interaction."
    for name, radius in RADII.items():
        peak = each(lambda run: run.peak(81), results[name])
        expected = _effective(radius, peak["reference"])
        required = near(expected, 2e-3 * expected)
        yield state(
            MeasuredQuantity("speed, cells per unit time", each(_cells, results[name]), required, "4"),
            published=claim,
            source="harbola2009decorated, abstract",
            derived=f"Radius {radius:g}: the light bead, between its two contacts in series, gives the contact "
            f"constant and mass of a plain chain whose wave of {peak['reference']:.4f} V has the speed {expected:.4f}; "
            "required within 0.2%.",
        )
        yield state(
            MeasuredQuantity("velocity of the leading pulse at bead 81", peak, near(PLAIN, 2e-3, 0.01), "4 V"),
            published=claim,
            source="harbola2009decorated, abstract",
            derived=f"Radius {radius:g}: the wave of a plain kicked chain has {PLAIN} V.",
        )


def _draw_decorated(axis: Axes, results: Results) -> None:
    """Draw the speed of the pulse over the radius of the small beads: effective chain as a line, LAMMPS as dots."""
    every = np.linspace(0.15, 0.45, 50)
    axis.plot(every, [_effective(radius, PLAIN) for radius in every], label="effective chain", **PUBLISHED)
    speeds = [_cells(results[name]["lammps"]) for name in RADII]
    axis.plot([*RADII.values()], speeds, "o", color=COLOURS[0], label="LAMMPS")


DECORATED = Entry(
    title="Decorated chains",
    introduction="Small beads between large ones, all of the same material.",
    sources={"harbola2009decorated": "abstract read; the paper's own effective constants could not be read"},
    scenes={name: _decorated_chain(radius) for name, radius in RADII.items()},
    statements=_decorated,
    axes=("radius of the small beads / radius of the large ones", "speed $c\\,T$ (cells)"),
    draw=_draw_decorated,
    caption="Speed of the pulse over the radius of the small beads; the line is the effective chain's.",
)
