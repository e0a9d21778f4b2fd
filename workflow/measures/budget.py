"""Energy budget over time: energy input, where it is stored, what is dissipated, and how well the balance is closed."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from analysis.conservation import Account, Conservation
from analysis.quantity import declare, result
from analysis.trajectory import Floats
from workflow.measures.measurement import Measurement, Recorded

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_STORED = {
    "kinetic": "#0072B2",
    "contacts": "#56B4E9",
    "springs": "#009E73",
    "ground": "#F0E442",
    "walls": "#332288",
    "resonators": "#882255",
}
"""Okabe and Ito's palette and two of Tol's, with a hatch for what is dissipated."""

_WORDS = {"ground": "foundation and weights", "springs": "springs between chains"}
"""Names in the legend, of those that differ from the account's."""

_LOST = ("#D55E00", "#E69F00", "#CC79A7", "#999999", "#661100")

_NOTICED = 1e-3
"""Share of all energy that a layer must once have to be drawn."""


@result
class ClosedAccount(Account):
    """The account, and how well it is known."""

    closed: float = declare("largest ``missing`` over the largest ``energy_input``", undefined="of a run that blew up")
    between_frames: float = declare(
        "uncertainty of what was exchanged between frames over the largest ``energy_input``"
    )
    stated: float | None = declare("error of the velocities that the run states", "V", "it states none")


class BudgetCurves(NamedTuple):
    """Energies of a budget, each [instant]; moving means over a duration in units of T, 0 where they are none."""

    stored: dict[str, Floats]
    losses: dict[str, Floats]
    energy_input: Floats
    mean_over: float

    @property
    def by_words(self) -> dict[str, Floats]:
        """Energies stored and dissipated, [instant] each, by their names in a legend."""
        return {_WORDS.get(name, name): part for name, part in (*self.stored.items(), *self.losses.items())}


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

    def curves(self) -> BudgetCurves:
        """Curves of the budget that are large enough to be drawn.

        Where instants are too far apart to show how energy oscillates, they are moving means.
        """
        from analysis.figures import averages  # matplotlib takes half a second to import

        account = self.values
        largest = account.most
        width = averages.oscillations_to_average(account.kinetic, largest)
        stored, losses = (
            {
                name: averages.moving_mean(part, width)
                for name, part in parts.items()
                if np.max(np.abs(part)) > _NOTICED * largest
            }
            for parts in (account.stored, account.losses)
        )
        return BudgetCurves(
            stored, losses, averages.moving_mean(account.energy_input, width), averages.half_width(account.time, width)
        )

    def draw(self) -> "Figure":
        """Energy held, and above it energy dissipated, by where and by source, in layers; the energy input as a line.

        Where instants are too far apart to show how energy oscillates, moving means are drawn.
        """
        from analysis.figures import averages, style  # matplotlib takes half a second to import

        problem, account = self.problem, self.values
        largest = account.most
        time, energy = (
            style.axis_unit(problem, "time", float(account.time[-1])),
            style.axis_unit(problem, "energy", largest),
        )
        colours = iter(_LOST)  # there are five at most
        stored, losses, energy_input, mean_over = self.curves()
        layers = [(_WORDS.get(name, name), part, _STORED[name], "") for name, part in stored.items()]
        layers += [(name, part, next(colours), "////") for name, part in losses.items()]
        with style.settings():
            figure = style.new_figure(4.2)
            axis = figure.subplots()
            below, t = np.zeros_like(account.time), account.time * time.worth
            for name, part, colour, hatch in layers:
                above = below + part * energy.worth
                axis.fill_between(
                    t, below, above, facecolor=colour, hatch=hatch, edgecolor="white", linewidth=0.0, label=name
                )
                below = above
            axis.plot(t, energy_input * energy.worth, color="black", label="energy input")
            axis.set_xlim(t[0], t[-1])
            least = min(0.0, float(np.min(energy_input)))  # a drive may begin by taking up energy
            axis.set_ylim(1.06 * least * energy.worth, 1.06 * float(np.max(energy_input)) * energy.worth)
            axis.set_xlabel(time.label(Account, "time"))
            axis.set_ylabel(energy.label(style.FrameContent, "energy") + averages.averaged(mean_over, time))
            style.head(figure, style.title(problem, until=float(account.time[-1])))
            handles, labels = axis.get_legend_handles_labels()
            style.legend_beside(figure, handles[::-1], labels[::-1], handleheight=1.4)  # as the layers lie
        return figure

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
