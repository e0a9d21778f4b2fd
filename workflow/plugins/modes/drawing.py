"""Figures of modes and periodic states, from the results of the study."""

from typing import TYPE_CHECKING

import numpy as np

from granchain.parts import panels, unit_cell, units
from workflow.plugins.modes.tables import BranchOfMode, ModesResult

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from workflow.plugins.modes.branch_figures import BranchCurve

FIGURES = ("frequency", "shapes", "multipliers", "motion")

MOST_BRANCHES = 4
"""Branches that figures show, the first ones."""


def figures(result: ModesResult) -> "dict[str, Figure]":
    """Figures of the first branches; none without branches."""
    from workflow.plugins.modes import branch_figures

    curves = [_curve(result, branch) for branch in result.branches if branch.states][:MOST_BRANCHES]
    if not curves:
        return {}
    scale, name = result.problem.scale, panels.title(result.problem)
    energy, frequency = (
        units.Label("energy", "E", scale.symbol("energy")),
        units.Label("angular frequency", "\\omega", scale.symbol("frequency")),
    )
    displacement, time = (
        units.Label("displacement", "x", scale.symbol("length")),
        units.Label("time", "t", scale.symbol("time")),
    )
    edges = unit_cell.bands(result.problem.system)
    measured = scale.measured(np.zeros(0) if edges is None else np.unique(edges), "frequency")
    return {
        FIGURES[0]: branch_figures.frequency_figure(curves, measured, (energy, frequency), name),
        FIGURES[1]: branch_figures.shape_figure(curves, name),
        FIGURES[2]: branch_figures.multiplier_figure(curves, name),
        FIGURES[3]: branch_figures.motion_figure(curves, (displacement, time), name),
    }


def _curve(result: ModesResult, branch: BranchOfMode) -> "BranchCurve":
    from workflow.plugins.modes.branch_figures import BranchCurve

    scale, states = result.problem.scale, branch.states
    last = [state for state in states if state["role"] == "branch"][-1]
    pairs = np.array(last["multipliers"]).reshape(-1, 2)
    half = np.array(branch.data["motion"])
    changes: list[tuple[float, float]] = [
        (scale.measured(line.energy, "energy"), scale.measured(line.frequency, "frequency"))
        for line in result.bifurcations()
        if line.mode == branch.mode + 1
    ]
    return BranchCurve(
        name=f"mode {branch.mode + 1}",
        last_state=f"state {states.index(last) + 1}, energy {scale.written(last['energy'], 'energy', '.3g')}",
        energy=scale.measured(branch.values("energy"), "energy"),
        frequency=scale.measured(2.0 * np.pi / branch.values("period"), "frequency"),
        stable=np.array([state["stable"] for state in states]),
        bifurcations=np.array(changes).reshape(-1, 2),
        linear=result.linear.shapes[branch.mode],
        last=np.array(last["x"]),
        multipliers=pairs[:, 0] + 1j * pairs[:, 1],
        motion=scale.measured(np.concatenate([half, half[-2::-1]]), "length"),
        period=scale.measured(float(last["period"]), "time"),
        chains=result.problem.chains,
    )
