"""Energy of the chains over time: the share of each, and where along the chain it is."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from analysis.figures import averages
from analysis.figures.panels import Axis, Curve, Panel, Sheet, axis_unit, curves_of, shown_chains, title
from analysis.sharing.energies import Flow, FlowMeter
from analysis.sharing.run_error import flow_with_error
from analysis.sharing.survey import Survey
from analysis.trajectory import Floats
from lammps_inputs.facts import Fact
from lammps_inputs.units import Label
from workflow.measures.measurement import MOST_CHAINS, Measurement, Recorded
from workflow.screen import PrintedTable

MOST_MODES = 6
"""That are drawn."""

_CONSTANT = 1e-9
"""Largest change of what is constant."""


def _varies(values: Floats) -> bool:
    """Whether any curve [instant, chain] changes over time."""
    finite = values[np.isfinite(values).all(axis=1)]
    return len(finite) > 1 and bool(np.max(np.ptp(finite, axis=0)) > _CONSTANT)


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

    def sheet(self) -> Sheet:
        """Share of the energy of each chain (those drawn in other figures too), its centre and its spread, over time.

        Of rows on springs that vary, also the share of the action of each mode. Shares that no instant resolves are
        moving means; what is constant, as the share of a single chain, is left out.
        """
        problem, flow = self.problem, self.values
        unit, chains = axis_unit(problem, "time", float(flow.time[-1])), shown_chains(problem)
        time, t = unit.axis(Flow, "time"), flow.time * unit.worth
        shares, centres = flow.share[:, chains], flow.centre[:, chains]
        shown = []
        if _varies(shares):
            width = max(averages.oscillations_to_average(share, 1.0) for share in shares.T)
            means = np.stack([averages.moving_mean(share, width) for share in shares.T], axis=1)
            ends = 0.0, max(1.0, 1.05 * float(np.nanmax(shares)))
            remark = averages.averaged(averages.half_width(flow.time, width), unit)
            share = Axis(Label("share of the energy"), ends=ends)
            shown.append(Panel(time, share, curves_of(chains, t, means), remark=remark))
        if _varies(centres) or not (shown or flow.action is not None):
            spreads = zip(curves_of(chains, t, centres), flow.spread[:, chains].T, strict=True)
            curves = tuple(replace(curve, spread=spread) for curve, spread in spreads)
            shown.append(Panel(time, Axis(Label("centre of the energy (bead),\nband: standard deviation")), curves))
        if flow.action is not None:
            actions = flow.action.T[:MOST_MODES]
            greys = np.linspace(0.0, 0.6, len(actions))  # colours are the chains'
            modes = enumerate(zip(actions, greys, strict=True))
            curves = tuple(Curve(f"mode {k + 1}", t, action, k, {"color": str(grey)}) for k, (action, grey) in modes)
            share = Axis(Label("share of the action"), ends=(0.0, 1.05))
            shown.append(Panel(time, share, curves, remark="slowest mode first"))
        heading = title(problem, each_chain=True, until=float(flow.time[-1]))
        return Sheet(heading, [[panel] for panel in shown], max(2.8, 0.8 + 2.2 * len(shown)))

    @classmethod
    def meter(cls, run: Recorded) -> FlowMeter | None:
        """Energies of runs of all beads in which no pulse keeps its shape."""
        problem = run.problem
        return FlowMeter(problem) if problem.rows.complete and not problem.system.holds(Fact.PULSE) else None

    @classmethod
    def of_run(cls, run: Recorded, survey: Survey, measured: Flow | None) -> Self | None:
        """Shares with the error of the run."""
        del survey
        return None if measured is None else cls(run.problem, flow_with_error(measured, run.error, run.problem))
