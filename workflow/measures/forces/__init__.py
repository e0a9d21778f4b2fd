"""Forces on walls, in contacts and inside beads, as gauges would measure them, and what walls reflect.

Plug-ins take this module to measure forces in runs whose scenes do not ask for them: `read` gives the `Readings`.

Examples:
    >>> problem = granchain.load("one-chain", {"beads": 20, "duration": 30.0}).problem()
    >>> frames = engine.run(problem)
    >>> readings = forces.read(frames.blocks(), problem, contacts=(10,))
    >>> readings.impulse.round(3)  # [chain, gauge] in m V
    array([[1.138]])
"""

from collections.abc import Iterable

from analysis.gauges.gauge import gauges
from analysis.trajectory import Trajectory
from lammps_inputs import Problem
from workflow.measures.forces.force_meter import ForceMeter
from workflow.measures.forces.readings import Readings as Readings


def read(
    blocks: Iterable[Trajectory], problem: Problem, *, contacts: tuple[int, ...] = (), wall: bool = False
) -> Readings:
    """Readings of gauges in a run: at its walls, and in contacts (contact n is between bead n and the next).

    Args:
        blocks: consecutive frames of the run, [frame, chain, bead] each, the first frame being the start.
        problem: what was run.
        contacts: numbers of contacts.
        wall: whether walls have gauges, too.
    """
    return ForceMeter(problem, gauges(problem.system, wall=wall, contacts=contacts)).read(blocks)
