"""LAMMPS commands of contacts and walls whose force is a power of the overlap, or a formula of it, with dashpots."""

from typing import Any

import numpy as np

from lammps_inputs import engine_limits, laws
from lammps_inputs.deck_lines import AtomTypes, BeadLayout, DeckLines, WallLinks, types_by_contact
from lammps_inputs.laws import Law, Parameter
from lammps_inputs.numbers import text


def wall_of_power(law: Law, overlap: str, closed: str, strength: str) -> str:
    """Force of a wall at an overlap, which counts where the wall is touched, in LAMMPS's variables."""
    return f"{strength}*({overlap}*{closed})^{text(float(law.exponent))}"


def granular(law: str, unit: float, strength: Parameter, power: str, layout: BeadLayout) -> DeckLines:
    """A pair style that has dashpots beside contacts of one law, and distinguishes these by the types of their beads.

    Args:
        law: name of the law in LAMMPS.
        unit: LAMMPS's constant of a contact of strength 1.
        strength: a number, or [chain, contact].
        power: power of the overlap, for the comment.
        layout: positions of the beads in LAMMPS.
    """
    if np.ndim(strength) == 0:
        return of_types(f"{law} {text(unit * float(strength))}", None, power, layout)
    types = types_by_contact(np.asarray(strength), closed=layout.closed)
    models = {pair: f"{law} {text(unit * a)}" for pair, a in types.strength.items()}
    return of_types(f"{law} {text(unit)}", (types, models), f"{power}, strength by the bead types", layout)


def of_types(
    general: str, by_type: tuple[AtomTypes, dict[tuple[int, int], str]] | None, power: str, layout: BeadLayout
) -> DeckLines:
    """Contacts in LAMMPS's words, in general and of pairs of types, with the dashpots of the layout."""
    loss, model, says = "0", "damping velocity", f"{power}{';' if by_type else ','} no friction, no loss"
    variables: tuple[str, ...] = ()
    if layout.contact_loss is not None:
        coefficient, model = layout.contact_loss.granular(layout)
        loss, says = "${contact_damping}", f"{power} and a dashpot, no friction"
        variables = (f"variable contact_damping index {text(coefficient)}   # {model}", *_since(model))
    model = f"{loss} tangential linear_nohistory 0 0 {model}"
    return DeckLines(
        types=None if by_type is None else by_type[0],
        variables=variables,
        interactions=(
            f"# contacts: force = strength * {says}",
            "pair_style granular",
            f"pair_coeff * * {general} {model}",
            *(
                f"pair_coeff {first} {second} {law} {model}"
                for (first, second), law in ({} if by_type is None else by_type[1]).items()
            ),
        ),
        damped=bool(variables),
    )


def _since(model: str) -> tuple[str, ...]:
    if "restitution" not in model:
        return ()
    old = "damping by restitution needs LAMMPS of 27Jun2024 or later"
    return (f'if "$(version) < {_RESTITUTION_SINCE}" then "print \'{old}\'" "quit 1"',)


_RESTITUTION_SINCE = 20240627
"""Release that has ``damping coeff_restitution``."""


def faces(link: WallLinks, layout: BeadLayout) -> list[tuple[float, float]]:
    """Strength of the wall of every chain, and where it stands in LAMMPS: nearer by an overlap at rest."""
    radius, right = layout.diameter / 2.0, link.side > 0.0
    end, law = -1 if right else 0, link.law
    clear, strength = (
        np.broadcast_to(values, (layout.chains, 1))[:, 0] for values in (link.gap - law.rest, laws.strength(law))
    )
    place = layout.places[:, end]
    face = place + radius + clear if right else place - radius - clear
    return list(zip(strength.tolist(), face.tolist(), strict=True))


def wall_lines(link: WallLinks, layout: BeadLayout) -> DeckLines:
    """Walls of the ends of the chains, with their dashpots.

    The fixes act only on the beads that can reach the walls, for every bead of a group costs time. All beads have the
    same radius in LAMMPS, so chains whose walls differ in strength or position have separate fixes.
    """
    name, exponent, loss = link.name, link.law.exponent, link.loss
    lost, model = ([0.0] * layout.chains, "damping velocity") if loss is None else loss.at_walls(layout)
    end = layout.beads if link.side > 0.0 else 1
    walls = [(*face, g) for face, g in zip(faces(link, layout), lost, strict=True)]
    engine_limits.GROUPS.check(name, len(set(walls)))
    if len(set(walls)) == 1:
        hard, face, g = walls[0]
        unit = "over the force of a contact" if exponent is None else f"force per overlap^{text(exponent)}"
        strength = f"variable {name} index {text(hard)}   # {unit}"
        dashpot = f"variable {name}_damping index {text(g)}   # {model}"
        coefficient = "0" if loss is None else f"${{{name}_damping}}"
        return DeckLines(
            variables=(strength,) if loss is None else (strength, dashpot),
            motion=(
                f"group {name} id {end}:{layout.chains * layout.beads}:{layout.beads}",
                *_push(name, f"v_{name}", face, coefficient, model, link, layout),
            ),
        )
    lines = []
    for number, wall in enumerate(sorted(set(walls)), 1):
        group, (hard, face, g) = f"{name}{number}", wall
        atoms = " ".join(str(chain * layout.beads + end) for chain, other in enumerate(walls) if other == wall)
        coefficient = "0" if loss is None else text(g)
        lines += [f"group {group} id {atoms}", *_push(group, text(hard), face, coefficient, model, link, layout)]
    return DeckLines(motion=tuple(lines))


def _push(name: str, hard: str, face: float, g: str, model: str, link: Any, layout: BeadLayout) -> list[str]:
    """Force of a wall on the beads of a group; LAMMPS's force of a flat wall is ``K * sqrt(radius) * overlap**1.5``.

    Other powers are forces by `fix addforce`, for LAMMPS's walls of any potential take ten times as long. Their dashpot
    is that of a contact whose stiffness is 0.
    """
    right, law, radius = link.side > 0.0, link.law, layout.diameter / 2.0
    planes = f"NULL {text(face)}" if right else f"{text(face)} NULL"

    def granular(normal: str) -> str:
        return f"wall/gran granular {normal} {g} tangential linear_nohistory 0 0 {model} xplane {planes}"

    if law.exponent == 1.5:
        return [f"fix {name} {name} {granular(f'hertz $({hard}/{text(float(np.sqrt(radius)))}:%.17g)')}"]
    touched = text(face - link.side * radius)
    overlap, closed = (f"(x-{touched})", f"(x>{touched})") if right else (f"({touched}-x)", f"(x<{touched})")
    force = law.wall(overlap, closed, hard)
    return [
        f"variable {name}_push atom {'-' * right}{force}",
        f"fix {name} {name} addforce v_{name}_push 0.0 0.0",
        *([] if g == "0" else [f"fix {name}_damping {name} {granular('hertz 0')}"]),
    ]
