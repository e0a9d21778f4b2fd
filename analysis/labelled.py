"""Frames of a run as an `xarray.Dataset`: displacement, velocity and forces with dimensions, units and names."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from analysis import motion
from analysis.trajectory import Floats, Integers, Trajectory
from lammps_inputs import laws, physics
from lammps_inputs.facts import Fact
from lammps_inputs.system import Noun


class LabelledArray(NamedTuple):
    """Array with the names of its dimensions, what it holds, and its unit."""

    dimensions: tuple[str, ...]
    values: Floats | Integers
    long_name: str
    quantity: str = ""
    """Key of `lammps_inputs.units.SI`; empty for numbers without a unit."""


def dataset(block: Trajectory, attributes: Mapping[str, Any] | None = None) -> Any:
    """Frames as an ``xarray.Dataset`` in the scene's units: SI, or reduced units.

    Args:
        block: frames, dimensionless.
        attributes: attributes of the dataset.

    Returns:
        The dataset, with the dimensions ``time``, ``chain`` and ``bead``; see `labelled` for its variables.

    Raises:
        ImportError: xarray is not installed.
    """
    import xarray

    scale = block.problem.scale
    variables: dict[str, Any] = {}
    for name, (dimensions, values, long_name, quantity) in labelled(block).items():
        labels = {"long_name": long_name}
        if quantity:
            values, labels["units"] = scale.measured(values, quantity), scale.symbol(quantity)
        variables[name] = dimensions, values, labels
    coordinates = {name: variables.pop(name) for name, (along, *_) in list(variables.items()) if along == (name,)}
    return xarray.Dataset(variables, coordinates, dict(attributes or {}))


def labelled(block: Trajectory) -> dict[str, LabelledArray]:
    """Coordinates and variables of frames by their names, dimensionless.

    - ``displacement`` and ``velocity`` [time, chain, bead]; of a window at all beads: NaN at those that it has left, 0
      at those that it has not reached;
    - ``overlap``, 0 of beads that are apart, and ``contact_force`` [time, chain, contact], where all beads are recorded
      and deform;
    - ``contact_state`` [time, chain, end], where contacts yield;
    - ``resonator_displacement`` and ``resonator_velocity`` [time, resonator, bead], where there are resonators; with
      the noun of other atoms beside the beads, where there are any.

    Args:
        block: frames.
    """
    problem = block.problem
    if problem.rows.follow:
        block = block.on(1, problem.beads, behind=np.nan)
    beads = block.beads
    at_beads = ("time", "chain", "bead")
    arrays = {
        "time": LabelledArray(("time",), block.time, "time", "time"),
        "chain": LabelledArray(("chain",), np.arange(1, problem.chains + 1), "number of the chain"),
        "bead": LabelledArray(("bead",), beads, "number of the bead"),
        "displacement": LabelledArray(at_beads, block.displacement, "displacement along the chain", "length"),
        "velocity": LabelledArray(at_beads, block.velocity, "velocity along the chain", "velocity"),
    }
    if problem.rows.neighbours and problem.system.holds(Fact.OVERLAPS):
        arrays |= _of_contacts(block)
    ends = np.arange(problem.beads + 1)
    if (states := block.states_of_contacts(ends)) is not None:
        meaning, unit = laws.state_meaning(physics.contacts_with_state(problem.system)[0].law)
        words = f"{meaning} of the contact between beads n and n + 1, or with a wall"
        quantity = "" if unit == "one" else unit
        arrays["end"] = LabelledArray(("end",), ends, "number n of the bead before the contact, 0 at the left wall")
        arrays["contact_state"] = LabelledArray(("time", "chain", "end"), states, words, quantity)
    for noun, lines in problem.system.lines_by_noun.items() if block.all_lines else ():
        arrays |= _of_others(block, noun, lines)
    return arrays


def _of_contacts(block: Trajectory) -> dict[str, LabelledArray]:
    """Overlaps and forces of contacts, those of dashpots included, at frames of all beads."""
    system = block.system
    overlap = motion.overlaps(system, block.displacement)
    force = motion.contact_force(system, overlap)
    dashpots = [link for link in system.dampers if link.kind in ("along", "closing")]
    if dashpots:
        drag = [link.damping(block.displacement, block.velocity) for link in dashpots]
        force = force + np.concatenate(drag, axis=-1)
    at_contacts = ("time", "chain", "contact")
    contacts = np.arange(1, 1 + overlap.shape[-1])
    return {
        "contact": LabelledArray(("contact",), contacts, "number n of the contact between beads n and n + 1"),
        "overlap": LabelledArray(
            at_contacts, np.maximum(overlap, 0.0), "overlap of beads n and n + 1, 0 where apart", "length"
        ),
        "contact_force": LabelledArray(at_contacts, force, "force between beads n and n + 1", "force"),
    }


def _of_others(block: Trajectory, noun: Noun, lines: Integers) -> dict[str, LabelledArray]:
    """Motion of atoms of a noun, which are no beads, on their lines [line] from 0; NaN where a line has none."""
    present = np.asarray(physics.masses(block.problem.system))[lines] > 0.0
    x, v = (np.where(present, values[:, lines], np.nan) for values in block.atoms)
    name = noun.singular.replace(" ", "_")
    at_lines = ("time", name, "bead")
    return {
        name: LabelledArray(
            (name,),
            np.arange(1, len(lines) + 1),
            f"number of the line of {noun.plural}: those of each chain in turn, and again of each further kind",
        ),
        f"{name}_displacement": LabelledArray(
            at_lines, x, f"displacement of the {noun.singular} at the bead", "length"
        ),
        f"{name}_velocity": LabelledArray(at_lines, v, f"velocity of the {noun.singular} at the bead", "velocity"),
    }
