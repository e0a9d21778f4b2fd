"""Heavy and light alternating beads: mass ratios without residual motion."""

import numpy as np
from matplotlib.axes import Axes

from workflow.studies.gallery.criteria import Measured, at_most, near, state
from workflow.studies.gallery.entry import COLOURS, PUBLISHED, Entry, Results, chain, each
from workflow.studies.page import Statement

PUBLISHED_RATIOS = (0.3428, 0.1548, 0.0901)
SOURCE = "jayaprakash2011, as quoted"
AROUND = (0.98, 0.99, 1.01, 1.02)
BEADS = 90


def dimer(ratio: float, beads: int = BEADS) -> dict[str, object]:
    """A chain of dimers whose light beads have this mass."""
    kinds = {"heavy": {"mass": 1}, "light": {"mass": float(f"{ratio:.6g}")}}
    return chain(beads, 1.07 * beads, kinds=kinds, pattern=["heavy", "light"])


def _name(ratio: float) -> str:
    return f"ratio-{ratio:.4f}"


def _least(results: Results, ratio: float) -> float:
    """Where no energy stays in a cell: near it, the energy grows as the square of the distance, its root linearly."""
    ratios = np.array([ratio * factor for factor in AROUND])
    left = np.array([results[_name(one)]["reference"].residual(2) for one in ratios])
    roots = np.roots(np.polyfit(ratios / ratio - 1.0, np.copysign(np.sqrt(left), ratios - ratio), 2))
    return float(ratio * (1.0 + roots[np.argmin(np.abs(roots))].real))


def statements(results: Results) -> list[Statement]:
    """Where the minima lie, and how deep they are."""
    found = []
    for ratio in PUBLISHED_RATIOS:
        runs = results[_name(ratio)]
        left = each(runs, lambda run: run.residual(2))
        least = {"reference": _least(results, ratio)}
        found.append(
            state(
                Measured("mass ratio of the smallest residual energy", least, near(ratio, 1e-4, 2e-3)),
                published=f"There is no residual motion at a mass ratio of {ratio}.",
                source=SOURCE,
                derived="Required within one unit of the last digit.",
            )
        )
        found.append(
            state(
                Measured("share of the pulse's energy that stays in a cell", left, at_most(2e-7), "1e"),
                published=f"At {ratio} a solitary wave propagates.",
                source=SOURCE,
            )
        )
    return found


def draw(axis: Axes, results: Results) -> None:
    """Residual energy over the ratio."""
    for place, ratio in enumerate(PUBLISHED_RATIOS):
        cases = sorted((*AROUND, 1.0))
        left = [results[_name(ratio * factor)]["reference"].residual(2) for factor in cases]
        axis.semilogy(cases, left, "o-", ms=4, color=COLOURS[place], label=f"near {ratio}")
    axis.axvline(1.0, **PUBLISHED)


ENTRY = Entry(
    title="Anti-resonances of dimers",
    introduction="Alternating heavy and light beads, all contacts alike. In general light beads oscillate behind "
    "the pulse, which decays; at some mass ratios there is no residual motion.",
    sources={
        "jayaprakash2011": "as quoted in the literature; the paper could not be read",
    },
    scenes={_name(ratio): dimer(ratio) for ratio in PUBLISHED_RATIOS},
    swept={_name(ratio * factor): dimer(ratio * factor) for ratio in PUBLISHED_RATIOS for factor in AROUND},
    statements=statements,
    axes=("mass ratio (published ratio)", "share of the energy that stays in a cell"),
    draw=draw,
    caption="Residual energy of a cell around the published mass ratios (reference).",
)
