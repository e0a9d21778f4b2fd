"""How LAMMPS holds beads under a static load: it takes away, for good, the forces that it finds on them at rest.

These are the load itself (forces on the ends, gravity) and the rounding of what walls and unequal contacts do. So rest
is exactly rest, in any release: no force of ours has to match one of LAMMPS's to its last bit.
"""

import numpy as np

from lammps_inputs import laws, physics
from lammps_inputs.layout import PLACES
from lammps_inputs.system import System


def place_lines(system: System) -> list[str]:
    """Notes where beads rest, where that is no formula of their numbers."""
    return [] if physics.even(system) else [f"fix {PLACES} all store/state 0 x     # where the beads rest"]


def hold_lines(system: System) -> list[str]:
    """Counters the forces at rest; after all other fixes, and before anything moves or is pushed."""
    if not physics.loaded(system):
        return []
    load = [float(find(laws.load(link.law))) for link in system.along for find in (np.min, np.max)]
    said = f"{load[0]:.6g}" if load[0] == load[1] else f"{load[0]:.6g} to {load[1]:.6g}"
    lines = [
        f"# static load: contacts carry {said} at rest; the forces found there are subtracted",
        "run 0 post no",
    ]
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
        "# no dashpot acts while the forces at rest are found",
        "fix moving all store/state 0 vx vy vz",
        "set group all vx 0.0 vy 0.0 vz 0.0",
    ]


def go_on_lines(system: System) -> list[str]:
    """Gives them back."""
    if not (physics.loaded(system) and system.dampers):
        return []
    axes = list(enumerate("xyz", 1))
    return [
        *(f"variable moving{axis} atom f_moving[{column}]" for column, axis in axes),
        "set group all " + " ".join(f"v{axis} v_moving{axis}" for _, axis in axes),
        "unfix moving",
    ]
