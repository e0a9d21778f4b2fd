"""What every state of a run must satisfy. LAMMPS itself reports none of these: it computes on with wrong numbers."""

import numpy as np

from analysis import motion
from analysis.trajectory import Floats
from lammps_inputs import Problem, physics
from lammps_inputs.facts import Fact
from lammps_inputs.limits.rates import stability_bound

ENERGY_TOLERANCE = 0.02
"""Relative deviation of the energy beyond which a run is stopped; at the default step it stays near 1e-5."""


def fault(
    problem: Problem, displacement: Floats, velocity: Floats, *, first: int = 1, elsewhere: float = 0.0
) -> str | None:
    """What is wrong with a state, and what to do; None if nothing is.

    Args:
        problem: what is computed.
        displacement: [line, row] of the chains and of inner atoms after them.
        velocity: likewise.
        first: bead that the rows begin with.
        elsewhere: energy of the beads that are not in these rows.
    """
    system = problem.system
    if not (np.all(np.isfinite(displacement)) and np.all(np.isfinite(velocity))):
        return f"a bead's position or velocity is no longer a finite number; {_remedy(problem)}"
    overlap = motion.overlaps(system, displacement[: problem.chains], first)
    worst = np.unravel_index(np.argmax(overlap), overlap.shape)
    where = f"beads {worst[1] + first} and {worst[1] + first + 1} of chain {worst[0] + 1}"
    if overlap[worst] >= problem.layout.diameter + physics.gap(system):
        return f"{where} have passed through each other; {_remedy(problem)}"
    if overlap[worst] >= problem.layout.diameter / 2.0:
        return (
            f"{where} overlap by {overlap[worst]:.3g}, more than half a diameter ({problem.layout.diameter / 2.0:g}); "
            f"{_remedy(problem)}"
        )
    if physics.driven(system):  # which puts in energy without end
        return None
    energy = float(motion.energy(system, displacement, velocity, first)) + elsewhere
    change = energy / physics.energy(system) - 1.0
    if system.loads and change > ENERGY_TOLERANCE:
        return f"the energy is {100.0 * change:.3g}% above the largest possible work of the pushes; {_remedy(problem)}"
    if (system.dampers or physics.remembering(system)) and change > ENERGY_TOLERANCE:
        return f"the energy is {100.0 * change:.3g}% above the energy input; {_remedy(problem)}"
    if system.holds(Fact.ENERGY) and not system.loads and abs(change) > ENERGY_TOLERANCE:
        return f"the energy has changed by {100.0 * change:.3g}%; {_remedy(problem)}"
    return None


def _remedy(problem: Problem) -> str:
    bound = stability_bound(problem.system) * problem.scale.time
    step = problem.timestep * problem.scale.time
    smaller = f"take a smaller timestep (it is {step:.3g}, unstable above {bound:.3g})"
    if not physics.varying(problem.system):
        return smaller
    return f"if the oscillations grow on the foundation, run for a shorter time or modulate less; else {smaller}"
