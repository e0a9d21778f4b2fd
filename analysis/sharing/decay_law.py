"""The decay of a pulse in a weakly coupled chain, before its neighbours have taken their share.

Each row that the pulse leaves behind keeps ``kappa / 2 * shift**2`` in every spring of the chain; the exact wave has
the shift ``1.840249 v**0.8`` and the energy ``1.069323 v**2``. Equating the loss per bead gives::

    v(n) = v0 * (1 - n / n*)**2.5        n* = 10 * energy / (shift**2 * kappa * springs) * v0**0.4

with v0 = 0.6816315 V, the amplitude in a single chain: n* = 2.709 V**0.4 / kappa for a chain with one neighbour.
"""

import numpy as np

from analysis.quantity import declare, result
from analysis.shape.exact_wave import HERTZ, solitary_wave
from analysis.sharing.equipartition import Sharing
from lammps_inputs import Problem, laws, physics
from lammps_inputs.facts import Fact
from lammps_inputs.laws.linear import Linear

SINGLE_CHAIN = 0.6816315
"""Amplitude far down a single chain whose first bead was hit with V = 1."""

FIRST = 10
"""Beads after which the wave has formed."""

LARGEST_NEIGHBOUR = 0.3
"""Largest amplitude of another chain, in that of the chain that was hit, for which the law is fitted."""

LEAST_BEADS = 10
"""Recorded beads needed for a fit."""


@result
class DecayFit:
    """The law fitted to the leading wave of the kicked chain, v0 and n* free."""

    first: int = declare("first bead of the fit")
    last: int = declare("last bead of the fit")
    v0: float = declare("amplitude at the kick; 0.6816315 expected", "V", symbol="v_0")
    n_star: float = declare("beads from the kicked one at which the pulse would end", "beads", symbol="n^*")
    n_star_error: float = declare("standard error of ``n_star``", "beads")
    n_star_expected: float = declare(
        "``n_star`` of theory, for a kick of the first bead", "beads", "another bead was kicked"
    )
    deviation: float = declare("largest relative difference of an amplitude from the fitted law")


def expected_n_star(kappa: float, springs: int = 1) -> float:
    """Beads at which the law ends for V = 1 and a chain with this many springs of stiffness kappa."""
    exact = solitary_wave()
    return float(10.0 * exact.energy / (exact.shift**2 * kappa * springs) * SINGLE_CHAIN**0.4)


def stiffness_of_springs(problem: Problem, chain: int) -> float | None:
    """Of all springs of a chain (from 0) together; None where they are not linear, or not the same in all rows."""
    total = 0.0
    for link in problem.system.across:
        if not isinstance(link.law, Linear):
            return None
        for edge, ends in enumerate(link.edges):
            spring = laws.at(link.law, edge).spring
            if np.ptp(spring) != 0.0:
                return None
            total += float(np.max(spring)) if chain in ends else 0.0
    return total


def fit_decay(shared: Sharing, problem: Problem) -> DecayFit | None:
    """The law fitted where it holds; None if it does not for ten recorded beads, or unless one bead was kicked.

    It is one of linear springs that are the same in all rows, of the contacts of spheres, and of chains without losses.

    ``(v / v0)**0.4 = 1 - n / n*`` is a straight line.
    """
    system = problem.system
    if (
        physics.exponent(system) != HERTZ
        or not (physics.alike(system) and system.holds(Fact.PULSE) and system.holds(Fact.SONIC_VACUUM))
        or len(physics.excitations(system)) != 1
        or physics.exchanges(system)
        or len(shared) == 0
    ):
        return None
    chain, hit = shared.kicked, physics.excitations(system)[0][1]
    springs = stiffness_of_springs(problem, chain)
    if not springs:
        return None
    others = np.nanmax(np.delete(shared.amplitude, chain, axis=1), axis=1)
    regime = others < LARGEST_NEIGHBOUR * shared.amplitude[:, chain]
    ahead = shared.bead >= hit + FIRST
    ended = np.flatnonzero(ahead & ~regime)
    used = np.flatnonzero(ahead)[: None if len(ended) == 0 else int(ended[0] - np.argmax(ahead))]
    if len(used) < LEAST_BEADS:
        return None
    way, amplitude = (shared.bead[used] - hit).astype(float), shared.amplitude[used, chain]
    (slope, intercept), covariance = np.polyfit(way, amplitude**0.4, 1, cov=True)
    if slope >= 0.0:
        return None
    n_star = float(-intercept / slope)
    law = (intercept + slope * way) ** 2.5
    relative = covariance[0, 0] / slope**2 + covariance[1, 1] / intercept**2
    relative -= 2.0 * covariance[0, 1] / (slope * intercept)
    return DecayFit(
        first=int(shared.bead[used[0]]),
        last=int(shared.bead[used[-1]]),
        v0=float(intercept**2.5),
        n_star=n_star,
        n_star_error=n_star * float(np.sqrt(max(relative, 0.0))),
        n_star_expected=expected_n_star(springs) if hit == 1 else float("nan"),
        deviation=float(np.max(np.abs(law / amplitude - 1.0))),
    )
