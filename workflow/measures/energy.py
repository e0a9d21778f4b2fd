"""Energy over time, where it stays in unlike beads, and motion behind a window."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from analysis.conservation import ClosedAccount, Conservation
from analysis.shape.long_waves import period_of
from analysis.sharing.cells import CellEnergies, FinalEnergy, left
from analysis.sharing.energies import EnergyFlow, Flow
from analysis.sharing.survey import Survey
from analysis.tracking.undisturbed import BehindWindow, Residual
from lammps_inputs import physics
from lammps_inputs.facts import Fact
from workflow.measures.base import MOST_CHAINS, FrameMeter, Measurement, Recorded
from workflow.screen import PrintedTable

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SMALLEST_LOSS = 1e-8
"""Smallest share of the energy per cell that is printed; below it frames and time steps decide."""


@dataclass(frozen=True, repr=False)
class BudgetMeasurement(Measurement):
    """The account, and how well it is known."""

    key, kind, figure = "budget", ClosedAccount, "budget"

    values: ClosedAccount

    @property
    def sentence(self) -> str:
        """How well it is closed, in one line."""
        account = self.values
        error = "" if account.stated is None else f", and the error of velocities in the run is {account.stated:.1e} V"
        return (
            f"the energy balance is closed to {account.closed:.1e} of the energy input; the uncertainty of what was "
            f"exchanged between frames is {account.between_frames:.1e} of it{error}"
        )

    def lines(self) -> Iterator[str]:
        """What went where, and how well that is known."""
        yield self.values.sentence(self.problem.scale)
        yield self.sentence

    @property
    def drawable(self) -> bool:
        """Whether there is more than one instant."""
        return len(self.values.time) > 1

    def draw(self) -> "Figure":
        """The account over time."""
        from analysis.figures.energy import budget_figure

        return budget_figure(self.problem, self.values)

    @classmethod
    def of_energies(
        cls, run: Recorded, conservation: Conservation, between_frames: float
    ) -> "BudgetMeasurement | None":
        """The budget of a run; None where nothing is exchanged, and where not all beads are recorded."""
        if conservation.budget is None:
            return None
        account = conservation.budget.result()
        stated = run.job.check or run.job.uncertainty
        closed_account = ClosedAccount(
            **vars(account),
            closed=conservation.energy_drift,
            between_frames=between_frames / account.most,
            stated=None if stated is None else stated.velocity,
        )
        return cls(run.problem, closed_account)


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
        """Shares of the chains over time."""
        from analysis.figures.energy import energy_figure

        return energy_figure(self.problem, self.values)

    @classmethod
    def meter(cls, run: Recorded) -> FrameMeter | None:
        """Energies of runs of all beads in which no pulse keeps its shape."""
        problem = run.problem
        if not problem.whole or problem.system.holds(Fact.PULSE):
            return None
        flow = EnergyFlow(problem)
        return FrameMeter(lambda _: cls(problem, flow.result()), flow.add)


@dataclass(frozen=True, repr=False)
class CellMeasurement(Measurement):
    """Energy of the pulses, what stays in cells, and what a replaced bead reflects."""

    key, kind = "cells", CellEnergies

    values: CellEnergies

    def lines(self) -> Iterator[str]:
        """The energy of the pulse of each chain, and where the energy is as seen from a replaced bead."""
        energies = self.values
        cell = "bead" if energies.beads == 1 else f"cell of {energies.beads} beads"
        for chain, (pulse, end) in enumerate(zip(energies.chains[:MOST_CHAINS], energies.last_bead, strict=False), 1):
            if pulse is not None:
                line = f"in chain {chain} the leading pulse carries {pulse.carried:.2%} of the energy input at bead "
                line += str(pulse.last)
                if math.isfinite(pulse.per_cell):
                    small = pulse.per_cell <= SMALLEST_LOSS
                    lost = f"less than {SMALLEST_LOSS:.0e}" if small else f"{pulse.per_cell:.1e}"
                    line += f"; from bead {pulse.first} on {lost} of the energy input remains in each {cell}"
                yield line
            if end is not None:
                yield f"in chain {chain} the kinetic energy of the last bead reaches {end:.2%} of the energy input"
        for split in energies.replaced[:MOST_CHAINS]:
            yield (
                f"at the end chain {split.chain} has {split.before:.2%} of the energy input in beads before bead "
                f"{split.bead}, {split.at:.2%} in it, {split.beyond:.2%} in beads beyond it"
            )
            if math.isfinite(split.reflected):
                yield (
                    f"bead {split.bead} of chain {split.chain} reflects {split.reflected:.2%} of the energy input, of "
                    f"{split.incident:.2%} that is incident"
                )

    @classmethod
    def meter(cls, run: Recorded) -> FrameMeter | None:
        """Energies of runs of all beads in which a pulse stays together and no sound runs."""
        problem, scene = run.problem, run.scene
        system = problem.system
        if (
            not problem.whole
            or physics.alike(system)
            or not (system.holds(Fact.PULSE) and system.holds(Fact.SONIC_VACUUM))
        ):
            return None
        final = FinalEnergy(problem)

        def finish(survey: Survey) -> CellMeasurement:
            chains, beads = range(1, problem.chains + 1), period_of(system)
            each = tuple(left(survey, chain, beads) for chain in chains)
            kicked = each[physics.largest_excitation(system)[0] - 1]
            energies = CellEnergies(
                beads=beads,
                residual_energy=math.nan if kicked is None else kicked.per_cell,
                chains=each,
                last_bead=tuple(final.end(survey, chain) for chain in chains),
                replaced=tuple(
                    final.split(survey, replacement.chain, replacement.bead) for replacement in scene.replace or ()
                ),
            )
            return cls(problem, energies)

        return FrameMeter(finish, final.add)


@dataclass(frozen=True, repr=False)
class WindowMeasurement(Measurement):
    """Whether it could catch up."""

    key, kind = "window", Residual

    values: Residual

    def lines(self) -> Iterator[str]:
        """The sentence."""
        yield self.values.sentence

    @classmethod
    def meter(cls, run: Recorded) -> FrameMeter | None:
        """Where there is a window."""
        problem = run.problem
        if problem.window is None:
            return None
        behind = BehindWindow()
        return FrameMeter(lambda survey: cls(problem, behind.result(survey.waves)), behind.add)
