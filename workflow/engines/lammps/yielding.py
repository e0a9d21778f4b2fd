"""Forces of contacts that yield, computed here for LAMMPS's `fix external` (see `lammps_inputs.laws.plastic_lines`)."""

from pathlib import Path
from typing import Any

import numpy as np

from lammps_inputs import Problem
from lammps_inputs.laws import plastic_lines
from lammps_inputs.laws.plastic import Thornton
from workflow.compiled import ieee, inlined

_force: Any = inlined(Thornton.force)


def read(lmp: Any, problem: Problem, deck: str) -> None:
    """Have LAMMPS carry out a deck, with the forces of its contacts from here."""
    for line in Path(deck).read_text(encoding="utf-8").splitlines():
        lmp.command(line)
        if line == plastic_lines.EXTERNAL:
            _attach(lmp, problem)


def _attach(lmp: Any, problem: Problem) -> None:
    law, touched = plastic_lines.table_of_host(problem.layout)

    def forces(_: Any, step: int, atoms: int, tag: Any, x: Any, f: Any) -> None:  # noqa: ARG001  as LAMMPS calls it
        f[:] = np.nan  # LAMMPS goes on after an exception: the run then fails
        memory = tuple(lmp.numpy.extract_atom(name) for name in (plastic_lines.MEMORY, plastic_lines.AHEAD))
        _contacts(x, f, memory, tag, law, touched, problem.layout.diameter)

    lmp.set_fix_external_callback(plastic_lines.FIX, forces)


@ieee
def _contacts(x: Any, f: Any, memory: Any, tag: Any, law: Any, touched: Any, diameter: float) -> None:
    """Forces and memories at places.

    Args:
        x: [atom, axis] places, atoms in any order.
        f: likewise, the forces to compute.
        memory: [atom] of the contact with the bead, or the wall, before, and of the last beads with the wall behind.
        tag: numbers of the atoms.
        law: [strength or onset, chain, contact]; a strength of 0 where there is no contact.
        touched: [chain, side] where the beads at the ends touch walls.
        diameter: of beads.
    """
    strength, onset = law
    chains, contacts = strength.shape
    beads = contacts - 1
    place = np.empty(chains * beads, dtype=np.int64)
    for atom in range(len(tag)):
        place[tag.flat[atom] - 1] = atom
    for chain in range(chains):
        before, last = 0.0, place[chain * beads]
        for contact in range(contacts):
            here = place[chain * beads + contact] if contact < beads else last
            largest, force = (memory[0] if contact < beads else memory[1]).flat, 0.0
            if strength[chain, contact] > 0.0:
                if contact == 0:
                    overlap = touched[chain, 0] - x[here, 0]
                elif contact < beads:
                    overlap = diameter - (x[here, 0] - x[last, 0])
                else:
                    overlap = x[here, 0] - touched[chain, 1]
                if overlap > largest[here]:
                    largest[here] = overlap
                if overlap > 0.0:
                    force = _force(overlap, strength[chain, contact], onset[chain, contact], largest[here], 0.0, 0.0)
            if contact > 0:
                f[last, 0] = before - force
                f[last, 1] = f[last, 2] = 0.0
            before, last = force, here
