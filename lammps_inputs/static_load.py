"""A system under a static load: contacts and walls in incremental form, so that rest is rest to the last bit.

LAMMPS holds places as float64, of which it can distinguish only so much. Overlaps at rest are multiples of that, and
loads follow from them, so that neighbours overlap by exactly as much at any place.

A deck takes away, for good, the forces that it finds on the beads at rest. These are the load itself (forces on the
ends, gravity) and the rounding of what walls and unequal contacts do. So no force of ours has to match one of
LAMMPS's to its last bit, in any release.
"""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lammps_inputs import laws, physics
from lammps_inputs.deck_lines import PLACES
from lammps_inputs.facts import Fact
from lammps_inputs.laws.contact import under
from lammps_inputs.layout import layout_of
from lammps_inputs.links import Links
from lammps_inputs.numbers import power_of_two_at_least
from lammps_inputs.system import System

MOST = 1e6
"""Largest load, in units of m V / T; beyond it motion is lost in the rounding of places."""

_MORE = 1.01
"""Energy that is reckoned with, over that of the start: rest is rounded on a coarser grid."""

FINEST = 1e-4
"""Largest relative change of a load by the rounding of places."""


class LoadError(ValueError):
    """A load that LAMMPS cannot hold; says why."""


def under_load(system: System, force: NDArray[np.float64]) -> System:
    """System about the static state in which its contacts are loaded.

    Args:
        system: system without load.
        force: static force, [chain, bead + 1], in units of m V / T: before the first bead, in every contact, and behind
            the last bead.

    Raises:
        LoadError: the load is too large or too small.
    """
    if any(link.law.overlap_under is None for link in system.along):
        raise LoadError("the static overlap is known for powers of the overlap only; leave one of them out")
    if np.max(force) > MOST:
        raise LoadError(
            f"{np.max(force):.3g} times m V / T, the unit of the kick's forces; at most {MOST:.0e}: a faster kick or a "
            "smaller load is needed"
        )
    rest = max(float(np.max(link.law.overlap_under(force[:, 1:-1]))) for link in system.along)
    grid = _grid(system, rest, physics.energy(system))
    if system.start is not None:  # under the load displacements store other energies
        about_rest = replace(system, links=tuple(_loaded(link, force, grid) for link in system.links))
        grid = _grid(system, rest, _MORE * physics.energy(about_rest))
    links = tuple(_loaded(link, force, grid) for link in system.links)
    loaded = replace(system, links=links)
    loaded = replace(loaded, dampers=tuple(_damped(link, loaded) for link in system.dampers))
    wanted = force[:, 1:-1]
    for link in loaded.along:
        off = np.max(np.abs(link.law.load - wanted) / np.where(wanted > 0.0, wanted, np.inf))
        if off > FINEST:
            raise LoadError(
                f"{np.min(wanted[wanted > 0.0]):.3g} times m V / T, the unit of the kick's forces: so small that "
                "places in LAMMPS do not show how it presses the beads together; a larger load, or none, is needed"
            )
    return loaded


def _grid(system: System, rest: float, energy: float) -> float:
    """The difference of two numbers of LAMMPS as large as the last bead's place may be.

    Args:
        system: system without load.
        rest: largest overlap at rest, in units of L.
        energy: energy that one contact may hold beside it, in units of m V**2.
    """
    alone = max(laws.max_strain(link.law, energy) for link in (*system.along, *system.walls))
    diameter = power_of_two_at_least(max(layout_of(system).diameter, 4.0, 2.0 * (rest + alone)))
    return float(np.spacing(0.75 * power_of_two_at_least((system.beads + 1) * diameter)))


def _loaded(link: Links, force: NDArray[np.float64], grid: float) -> Links:
    if not link.touching:
        return link
    law: Any = link.law
    between = force[:, link.between]
    even = np.ndim(law.strength) == 0 and float(np.ptp(between)) == 0.0
    return replace(link, law=under(law, float(between[0, 0]) if even else between, grid))


def _damped(link: Links, system: System) -> Links:
    """Dashpots of contacts and walls, which know the overlap at rest."""
    if not link.touching:
        return link
    contacts = physics.beside(system.links, link)
    assert contacts is not None
    return replace(link, law=replace(link.law, rest=contacts.law.rest))  # type: ignore[call-arg]


def place_lines(system: System) -> list[str]:
    """Notes where beads rest, where that is no formula of their numbers."""
    return [] if physics.even(system) else [f"fix {PLACES} all store/state 0 x     # places at rest"]


def hold_lines(system: System) -> list[str]:
    """Counters the forces at rest; after all other fixes, and before anything moves or is pushed."""
    if not physics.loaded(system):
        return []
    load = [float(find(link.law.load)) for link in system.along for find in (np.min, np.max)]
    forces = f"{load[0]:.6g}" if load[0] == load[1] else f"{load[0]:.6g} to {load[1]:.6g}"
    lines = [
        f"# static load: contact forces at rest {forces}; the resultants found at rest are subtracted",
        "run 0 post no",
    ]
    if not system.holds(Fact.FRAMES):  # fix held stores them (`plastic_lines`): later frames give others at rest
        return lines
    if not physics.even(system):
        return [
            *lines,
            "fix found all store/state 0 fx",
            "variable load atom -f_found",
            "fix load all addforce v_load 0.0 0.0",
        ]
    atoms = system.chains * system.beads
    for name, bead in (("first", 1), ("last", system.beads)):  # the same in every chain
        lines += [
            f"group one id {bead}",
            f"group {name} id {bead}:{atoms}:{system.beads}",
            f"fix load_{name} {name} addforce $(-fcm(one,x):%.17g) 0.0 0.0",
            "group one delete",
        ]
    return lines


def stop_lines(system: System) -> list[str]:
    """Takes the velocities of a continued run away, for dashpots would be among the forces that `hold_lines` finds."""
    if not (physics.loaded(system) and system.dampers):
        return []
    return [
        "# no dashpots while the forces at rest are determined",
        "fix moving all store/state 0 vx vy vz",
        "set group all vx 0.0 vy 0.0 vz 0.0",
    ]


def go_on_lines(system: System) -> list[str]:
    """Gives the velocities back that `stop_lines` took."""
    if not (physics.loaded(system) and system.dampers):
        return []
    axes = list(enumerate("xyz", 1))
    return [
        *(f"variable moving{axis} atom f_moving[{column}]" for column, axis in axes),
        "set group all " + " ".join(f"v{axis} v_moving{axis}" for _, axis in axes),
        "unfix moving",
    ]
