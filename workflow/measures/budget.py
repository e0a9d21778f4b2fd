"""Energy budget over time: energy input, where it is stored, what is dissipated, and how well the balance is closed."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Self

import numpy as np

from analysis.conservation import Account, Conservation, mass_of_resonators
from analysis.figures import averages
from analysis.figures.panels import Curve, FrameContent, Panel, Sheet, axis_unit, title
from analysis.quantity import declare, result
from workflow.measures.measurement import Measurement, Recorded

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
    in_resonators_error: float | None = declare(
        "uncertainty of ``in_resonators``: by the error e of velocities in the run (``run_error``), 2 e sqrt(M E) + "
        "M e^2 over the energy input, with mass M and energy E of the resonators; and that of the energy input",
        undefined="so is ``in_resonators``, or the run was not checked",
        default=None,
    )


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

    def sheet(self) -> Sheet | None:
        """Energy held, and above it energy dissipated, by where and by source, in layers; the energy input as a line.

        What is never large enough to be seen is left out. Where instants are too far apart to show how energy
        oscillates, the curves are moving means.
        """
        problem, account = self.problem, self.values
        if len(account.time) < 2:
            return None
        largest = account.most
        time, energy = axis_unit(problem, "time", float(account.time[-1])), axis_unit(problem, "energy", largest)
        width = averages.oscillations_to_average(account.kinetic, largest)
        t, colours = account.time * time.worth, iter(_LOST)  # there are five at most
        layers = []
        for name, part in (*account.stored.items(), *account.losses.items()):
            if np.max(np.abs(part)) > _NOTICED * largest:
                lost = name not in _STORED
                look = {"facecolor": next(colours) if lost else _STORED[name], "hatch": "////" if lost else ""}
                values = averages.moving_mean(part, width) * energy.worth
                layers.append(Curve(_WORDS.get(name, name), t, values, look=look))
        energy_input = averages.moving_mean(account.energy_input, width) * energy.worth
        # a drive may begin by taking up energy
        ends = 1.06 * min(0.0, float(np.min(energy_input))), 1.06 * float(np.max(energy_input))
        panel = Panel(
            time.axis(Account, "time", ends=(t[0], t[-1])),
            energy.axis(FrameContent, "energy", ends=ends),
            (Curve("energy input", t, energy_input, look={"color": "black"}),),
            remark=averages.averaged(averages.half_width(account.time, width), time),
            layers=tuple(layers),
        )
        return Sheet(title(problem, until=float(account.time[-1])), [[panel]], 4.2)

    @classmethod
    def of_energies(cls, run: Recorded, conservation: Conservation, between_frames: float) -> Self | None:
        """The budget of a run; None where nothing is exchanged, and where not all beads are recorded."""
        if conservation.budget is None:
            return None
        account = conservation.budget
        stated = run.job.check or run.job.uncertainty
        closed_account = ClosedAccount(
            **vars(account),
            closed=conservation.energy_drift,
            between_frames=between_frames / account.most,
            stated=None if stated is None else stated.velocity,
            in_resonators_error=_in_resonators_error(run, account, between_frames),
        )
        return cls(run.problem, closed_account)


def _in_resonators_error(run: Recorded, account: Account, of_input: float) -> float | None:
    """Uncertainty of the share of energy in resonators, by the run and an uncertainty of the energy input."""
    if not (run.error.measured and math.isfinite(account.in_resonators)):
        return None
    error = float(run.error.of_energy(account.resonators[-1], mass_of_resonators(run.problem.system)))
    return (error + account.in_resonators * of_input) / float(account.energy_input[-1])
