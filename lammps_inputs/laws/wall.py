"""How LAMMPS spells walls: contacts of the last bead of each chain, or the first, with something at rest."""

from typing import TYPE_CHECKING, Any

import numpy as np

from lammps_inputs import laws
from lammps_inputs.deck_lines import Lines
from lammps_inputs.numbers import text

if TYPE_CHECKING:
    from lammps_inputs.layout import Layout
    from lammps_inputs.links import Wall


def faces(link: "Wall", layout: "Layout") -> list[tuple[float, float]]:
    """Strength of the wall of every chain, and where it stands in LAMMPS: nearer by an overlap at rest."""
    radius, right = layout.diameter / 2.0, link.side > 0.0
    end, law = -1 if right else 0, link.law
    place, clear = layout.places[:, end], np.broadcast_to(link.gap - laws.rest(law), laws.strength(law).shape)[:, end]
    face = place + radius + clear if right else place - radius - clear
    return list(zip(np.max(laws.strength(law), axis=1).tolist(), face.tolist(), strict=True))


def wall_lines(link: "Wall", layout: "Layout") -> Lines:
    """Walls of the ends of the chains, with their dashpots.

    Only the beads that can reach them are asked, for the others cost as much. All have one radius in LAMMPS, so chains
    whose walls are not equally hard, or equally far along, have walls of their own.
    """
    name, exponent, loss = link.name, getattr(link.law, "exponent", None), layout.wall_loss(link.side)
    lost, model = ([0.0] * layout.chains, "damping velocity") if loss is None else loss.granular(layout)
    push = _of_spheres if exponent == 1.5 else _by_formula
    end = layout.beads if link.side > 0.0 else 1
    walls = [(*face, g) for face, g in zip(faces(link, layout), lost, strict=True)]
    if len(set(walls)) == 1:
        hard, face, g = walls[0]
        strength = f"variable {name} index {text(hard)}   # {_unit(exponent)}"
        dashpot = f"variable {name}_damping index {text(g)}   # {model}"
        coefficient = "0" if loss is None else f"${{{name}_damping}}"
        return Lines(
            variables=(strength,) if loss is None else (strength, dashpot),
            motion=(
                f"group {name} id {end}:{layout.chains * layout.beads}:{layout.beads}",
                *push(name, f"v_{name}", face, coefficient, model, link, layout),
            ),
        )
    lines = []
    for number, wall in enumerate(sorted(set(walls)), 1):
        own, (hard, face, g) = f"{name}{number}", wall
        atoms = " ".join(str(chain * layout.beads + end) for chain, other in enumerate(walls) if other == wall)
        coefficient = "0" if loss is None else text(g)
        lines += [f"group {own} id {atoms}", *push(own, text(hard), face, coefficient, model, link, layout)]
    return Lines(motion=tuple(lines))


def _unit(exponent: float | None) -> str:
    return "over the force of a contact" if exponent is None else f"force per overlap^{text(exponent)}"


def _of_spheres(name: str, hard: str, face: float, g: str, model: str, link: Any, layout: "Layout") -> tuple[str, ...]:
    """LAMMPS's force of a flat wall is ``K * sqrt(radius) * overlap**1.5``."""
    root = text(float(np.sqrt(layout.diameter / 2.0)))
    return (f"fix {name} {name} {_granular(f'hertz $({hard}/{root}:%.17g)', g, model, face, link)}",)


def _by_formula(name: str, hard: str, face: float, g: str, model: str, link: Any, layout: "Layout") -> tuple[str, ...]:
    """A force from outside on the beads of a group: LAMMPS's walls of any potential take ten times as long.

    A dashpot is that of a sphere of no stiffness.
    """
    touched = text(face - link.side * layout.diameter / 2.0)
    sign, overlap = ("-", f"(x-{touched})*(x>{touched})") if link.side > 0.0 else ("", f"({touched}-x)*(x<{touched})")
    if hasattr(link.law, "wall"):
        if not link.law.kind.cut:
            overlap = f"(x-{touched})" if link.side > 0.0 else f"({touched}-x)"
        force = link.law.wall(f"({overlap})", hard)
    else:
        force = f"{hard}*({overlap})^{text(link.law.exponent)}"
    push = (
        f"variable {name}_push atom {sign}{force}",
        f"fix {name} {name} addforce v_{name}_push 0.0 0.0",
    )
    return push if g == "0" else (*push, f"fix {name}_damping {name} {_granular('hertz 0', g, model, face, link)}")


def _granular(normal: str, g: str, model: str, face: float, link: Any) -> str:
    faces = f"NULL {text(face)}" if link.side > 0.0 else f"{text(face)} NULL"
    return f"wall/gran granular {normal} {g} tangential linear_nohistory 0 0 {model} xplane {faces}"
