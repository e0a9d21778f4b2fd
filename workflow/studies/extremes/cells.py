"""What a cell of the report is, and the scene that all of them start from."""

from dataclasses import dataclass
from typing import Any

Plain = dict[str, Any]

BASE: Plain = {
    "name": "extreme",
    "chains": 2,
    "beads": 30,
    "coupling": {"stiffness": 0.1},
    "kick": {"velocity": 1.0},
    "duration": 30.0,
}


@dataclass(frozen=True)
class Cell:
    """One run of the report.

    Attributes:
        axis, value: its name.
        scene: what a scene file would say.
        ranks: MPI ranks; more than one must compute bit for bit what one computes.
        diameter: of the beads in LAMMPS, in place of the scene's own.
        scaling: whether the run must be a scaled copy of that at another V, 1 in reduced units.
        drift: whether the energy must stay as near to the kick's in the second half as in the first.
        force: whether a time step above the stability bound is let pass.
    """

    axis: str
    value: str
    scene: Plain
    ranks: int = 1
    diameter: float | None = None
    scaling: bool = False
    drift: bool = False
    force: bool = False


def changed(scene: Plain, **changes: Any) -> Plain:
    """A scene with some keys changed, added, or (None) left out."""
    return {key: value for key, value in {**scene, **changes}.items() if value is not None}


def scaled(scene: Plain, factor: float) -> Plain:
    """The same motion with all kicks times a positive factor: the equations have no scale of their own.

    Displacements go as V**0.8, times as V**-0.2, springs as V**0.4. For scenes with a duration and default output.
    """
    kicks = scene["kick"] if isinstance(scene["kick"], list) else [scene["kick"]]
    changes: Plain = {
        "kick": [{**kick, "velocity": kick["velocity"] * factor} for kick in kicks],
        "duration": scene["duration"] * factor**-0.2,
    }
    if "gap" in scene:
        changes["gap"] = scene["gap"] * factor**0.8
    if "coupling" in scene:
        changes["coupling"] = {"stiffness": scene["coupling"]["stiffness"] * factor**0.4}
    return {**scene, **changes}


def springs(stiffness: float) -> Plain | None:
    """The coupling of a scene; none for 0."""
    return {"stiffness": stiffness} if stiffness else None


def decades(first: int, last: int, by: int) -> tuple[float, ...]:
    """Powers of ten, both ends among them."""
    return tuple(float(f"1e{power}") for power in range(first, last + 1, by))
