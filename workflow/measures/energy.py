"""Energy of the chains over time: the share of each, and where along the chain it is."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from analysis.sharing.energies import EnergyFlow, Flow
from analysis.sharing.survey import Survey
from analysis.trajectory import Floats, Trajectory
from lammps_inputs import Problem
from lammps_inputs.facts import Fact
from workflow.measures.measurement import MOST_CHAINS, Measurement, Meter, Recorded
from workflow.screen import PrintedTable

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MOST_MODES = 6
"""That are drawn."""

_CONSTANT = 1e-9
"""Largest change of what is constant."""


def _varies(values: Floats) -> bool:
    """Whether any curve [instant, chain] changes over time."""
    finite = values[np.isfinite(values).all(axis=1)]
    return len(finite) > 1 and bool(np.max(np.ptp(finite, axis=0)) > _CONSTANT)


class EnergyMeter(Meter):
    """Energies of the chains at some frames."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self._flow = EnergyFlow(problem)

    def add(self, block: Trajectory) -> None:
        """Take the next frames."""
        self._flow.add(block)

    def finish(self, survey: Survey) -> "EnergyMeasurement":
        """Shares of the chains in all frames."""
        del survey
        return EnergyMeasurement(self.problem, self._flow.result())


@dataclass(frozen=True, repr=False)
class EnergyMeasurement(Measurement):
    """Shares of the chains."""

    key, kind, figure = "energy", Flow, "energy"

    values: Flow

    def lines(self) -> Iterator[PrintedTable | str]:
        """How much of it each chain had, at the least, most and last, and where along the chain at the end."""
        flow, chains, scale = self.values, self.problem.chains, self.problem.scale
        if chains == 1:
            yield (
                f"the energy at the end is distributed around bead {flow.centre[-1, 0]:.1f} with a standard deviation "
                f"of {flow.spread[-1, 0]:.1f} beads"
            )
            return
        rows = []
        for chain in range(min(chains, MOST_CHAINS)):
            smallest, largest = flow.extremes(chain)
            ends = [f"{share:.4f} at {when * scale.time:.5g}" for share, when in (smallest, largest)]
            place = f"{flow.centre[-1, chain]:.1f} +- {flow.spread[-1, chain]:.1f}"
            rows.append([str(chain + 1), *ends, f"{flow.share[-1, chain]:.4f}", place])
        if chains > MOST_CHAINS:
            rows.append([f"of {chains}", "", "", "", ""])
        when = [scale.heading(f"{which} at time", "time") for which in ("least", "most")]
        head = ["chain", *when, "at the end", "mean bead at the end"]
        yield PrintedTable("share of the energy", head, rows)
        if flow.fastest_mode_action is not None:
            yield f"at the end the fastest mode of the rows has a share of {flow.fastest_mode_action:.6f} of the action"

    def draw(self) -> "Figure":
        """Share of the energy of each chain (those drawn in other figures too), its centre and its spread, over time.

        Of rows on springs that vary, also the share of the action of each mode. Shares that no instant resolves are
        moving means; what is constant, as the share of a single chain, is left out.
        """
        from analysis.figures import averages, style  # matplotlib takes half a second to import

        problem, flow = self.problem, self.values
        time, chains = style.axis_unit(problem, "time", float(flow.time[-1])), style.shown_chains(problem)
        shares, centres = flow.share[:, chains], flow.centre[:, chains]
        kinds = [kind for kind, values in (("share", shares), ("centre", centres)) if _varies(values)]
        kinds += ["action"] * (flow.action is not None)
        kinds = kinds or ["centre"]
        with style.settings():
            figure = style.new_figure(max(2.8, 0.8 + 2.2 * len(kinds)))
            panels = figure.subplots(len(kinds), 1, sharex=True, squeeze=False)[:, 0]
            t = flow.time * time.worth
            for kind, panel in zip(kinds, panels, strict=True):
                if kind == "share":
                    width = max(averages.oscillations_to_average(share, 1.0) for share in shares.T)
                    style.draw_chains(
                        panel, chains, t, np.stack([averages.moving_mean(share, width) for share in shares.T], axis=1)
                    )
                    panel.set_ylabel(
                        "share of the energy" + averages.averaged(averages.half_width(flow.time, width), time)
                    )
                    panel.set_ylim(0.0, max(1.0, 1.05 * float(np.nanmax(shares))))
                elif kind == "centre":
                    style.draw_chains(panel, chains, t, centres)
                    for line, chain in zip(panel.lines[: len(chains)], chains, strict=True):
                        centre, spread = flow.centre[:, chain], flow.spread[:, chain]
                        panel.fill_between(
                            t, centre - spread, centre + spread, alpha=0.15, color=line.get_color(), linewidth=0
                        )
                    panel.set_ylabel("centre of the energy (bead),\nband: standard deviation")
                elif flow.action is not None:
                    actions = flow.action.T[:MOST_MODES]
                    greys = np.linspace(0.0, 0.6, len(actions))  # colours are the chains'
                    for mode, (action, grey) in enumerate(zip(actions, greys, strict=True), 1):
                        panel.plot(
                            t, action, label=f"mode {mode}", linestyle=style.CHAIN_DASHES[mode - 1], color=str(grey)
                        )
                    panel.set_ylabel("share of the action")
                    panel.set_ylim(0.0, 1.05)
                    panel.legend(title="slowest first", fontsize="small", title_fontsize="small")
            panels[-1].set_xlabel(time.label(Flow, "time"))
            style.finish(figure, problem, panels, until=float(flow.time[-1]))
        return figure

    @classmethod
    def meter(cls, run: Recorded) -> EnergyMeter | None:
        """Energies of runs of all beads in which no pulse keeps its shape."""
        problem = run.problem
        return EnergyMeter(problem) if problem.rows.complete and not problem.system.holds(Fact.PULSE) else None
