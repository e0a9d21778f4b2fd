"""Heavy and light alternating beads: mass ratios without residual motion."""

import numpy as np
from matplotlib.axes import Axes

from workflow.studies.gallery.entry import (
    COLOURS,
    PUBLISHED,
    Entry,
    Results,
    Statement,
    chain,
    claim,
    each,
    engines,
    number,
)

PUBLISHED_RATIOS = (0.3428, 0.1548, 0.0901)
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
    left = np.array([results[_name(one)]["reference"].left_behind(2) for one in ratios])
    roots = np.roots(np.polyfit(ratios / ratio - 1.0, np.copysign(np.sqrt(left), ratios - ratio), 2))
    return float(ratio * (1.0 + roots[np.argmin(np.abs(roots))].real))


def statements(results: Results) -> list[Statement]:
    """Where the minima lie, and how deep they are."""
    found = []
    for ratio in PUBLISHED_RATIOS:
        runs = results[_name(ratio)]
        left = each(runs, lambda run: run.left_behind(2))
        found.append(
            number(
                f"No residual energy at a mass ratio of {ratio}.",
                ratio,
                {"reference": _least(results, ratio)},
                within=1e-4,
                roughly=2e-3,
            )
        )
        found.append(
            claim(
                f"There a genuine solitary wave runs ({ratio}).",
                engines(left, digits=10, label="share of the energy left in a cell: "),
                max(left.values()) < 2e-7,
            )
        )
    return found


def draw(axis: Axes, results: Results) -> None:
    """Residual energy over the ratio."""
    for place, ratio in enumerate(PUBLISHED_RATIOS):
        cases = sorted((*AROUND, 1.0))
        left = [results[_name(ratio * factor)]["reference"].left_behind(2) for factor in cases]
        axis.semilogy(cases, left, "o-", ms=4, color=COLOURS[place], label=f"near {ratio}")
    axis.axvline(1.0, **PUBLISHED)


ENTRY = Entry(
    title="Anti-resonances of dimers",
    introduction="Alternating heavy and light beads, all contacts alike. In general light beads oscillate behind the "
    "pulse, which decays; at some mass ratios there is no residual motion.",
    sources={
        "jayaprakash2011": "as quoted in the literature; the paper could not be read",
    },
    scenes={_name(ratio): dimer(ratio) for ratio in PUBLISHED_RATIOS},
    swept={_name(ratio * factor): dimer(ratio * factor) for ratio in PUBLISHED_RATIOS for factor in AROUND},
    statements=statements,
    axes=("mass ratio over the published one", "energy left in a cell (share)"),
    draw=draw,
    caption="Residual energy of a cell around the published mass ratios (reference).",
)
