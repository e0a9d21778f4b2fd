"""Whether frames begin as their scene does: atoms at their places at rest, with the velocities of kicks and drives."""

import numpy as np

from analysis.trajectory import Floats, Integers, Trajectory
from lammps_inputs import physics

SAME = 1e-6
"""Largest difference, in units of L and V, that counts as none: files hold seven digits or more."""

MOST = 3
"""Beads that are named."""


def differences(frames: Trajectory) -> list[str]:
    """Sentences on the atoms that do not start as the scene says, in the scene's units; none where all do.

    Args:
        frames: [frame, chain, bead] from the start of a run on, with further lines of atoms where they are recorded.
    """
    problem = frames.problem
    scale, system = problem.scale, problem.system
    displacement, velocity = (values[0] for values in frames.atoms)
    right = physics.initial_state(system)[:, : len(velocity), frames.beads - 1]

    def name(line: int, place: int) -> str:
        bead = f"bead {frames.beads[place]} of chain {system.chain_of_line[line] + 1}"
        noun, _ = system.atom_at_bead(line)
        return f"the {noun} at {bead}" if noun else bead

    moved = _largest(np.abs(displacement - right[0]))
    if len(moved):
        line, place = moved[0]
        off = scale.written(displacement[line, place], "length")
        if system.start is not None:
            wanted = scale.written(right[0, line, place], "length")
            return [f"{name(line, place)} starts {off} from its place at rest instead of {wanted}"]
        return [f"{name(line, place)} starts {off} from its place at rest (another gap or static load?)"]
    texts = []
    for line, place in _largest(np.abs(velocity - right[1])):
        actual, wanted = (scale.written(values[line, place], "velocity") for values in (velocity, right[1]))
        texts.append(f"{name(line, place)} starts with velocity {actual} instead of {wanted}")
    return texts


def _largest(off: Floats) -> Integers:
    """[atom, line or place] of the atoms that differ most, at most `MOST` of them."""
    wrong = np.argwhere(off > SAME)
    return wrong[np.argsort(-off[wrong[:, 0], wrong[:, 1]], kind="stable")][:MOST]
