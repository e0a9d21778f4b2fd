"""LAMMPS commands for contacts that yield: pairs of beads as chunks, and a fix that stores their largest overlaps.

Every bead has two contacts: one in the first pairs (beads 1 and 2, 3 and 4, ...), one in the second (2 and 3, ...). A
chunk holds the beads of a pair, the sum of their places with alternating sign is their overlap, and each bead takes it
from there. Where a bead at the end is in no pair, a wall takes that place. At the end of a step the states are
updated, and what follows from them; each number is computed once, for LAMMPS evaluates a variable wherever it is named.
Under a static load the forces found at rest, with the largest overlaps then, are stored and subtracted, in a continued
run as well, so that rest is exactly rest.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from lammps_inputs import engine_limits, laws
from lammps_inputs.deck_lines import BeadLayout, DeckLines, WallLinks
from lammps_inputs.laws.contact_lines import faces
from lammps_inputs.numbers import text

COLUMNS = ("d_strength1", "d_strength2", "d_onset1", "d_onset2")
"""Per-atom numbers of the first and of the second pairs, where contacts differ."""


def contacts(law: Any, name: str, layout: BeadLayout) -> DeckLines:
    """Contacts along chains, and with walls, that yield by Thornton's law.

    Raises:
        EngineLimitError: more beads than are worth while, or walls that are not at one place for all chains.
    """
    walls, loaded = _walls(layout), bool(np.any(law.load))
    if layout.closed:
        raise engine_limits.YIELDING_RINGS.error(name)
    engine_limits.YIELDING_BEADS.check(name, layout.chains * layout.beads)
    if any(len({face for _, face in faces(wall, layout)}) > 1 for wall in walls):
        raise engine_limits.YIELDING_WALLS.error(name)
    differ = laws.differs(law) or bool(walls)
    numbers = [["v_strength"] * 2, ["v_onset"] * 2]
    variables: tuple[str, ...] = (
        f"variable strength index {text(float(np.max(law.strength)))}   # force per overlap^1.5",
        f"variable onset index {text(float(np.max(law.onset)))}   # overlap at which contacts yield",
    )
    if differ:
        numbers, variables = [["c_contacts[1]", "c_contacts[2]"], ["c_contacts[3]", "c_contacts[4]"]], ()
    lines = _overlaps(walls, layout, differ=differ)
    for n, a, y in zip((1, 2), *numbers, strict=True):
        lines += _of_pair(n, a, y)
    lines += [
        "fix memory all store/state 1 " + " ".join(f"v_{stored}{n}" for stored in _STORED for n in (1, 2)),
        "variable push atom f_pairs[1]*(v_force2-v_force1)",
        *(_HELD if loaded else ()),
        f"fix contacts all addforce v_{'free' if loaded else 'push'} 0.0 0.0",
        "variable memory atom f_memory[1]*(1-f_pairs[1])/2+f_memory[2]*(1+f_pairs[1])/2",
        "variable memory_ahead atom f_memory[1]*(1+f_pairs[1])/2+f_memory[2]*(1-f_pairs[1])/2",
    ]
    return DeckLines(
        variables=variables,
        interactions=_no_forces(layout),
        motion=tuple(lines),
        numbers=_columns(law, layout) if differ else None,
    )


_HELD = (
    "# static load: forces at rest, stored once",
    "variable stored atom 1",
    "variable rest_push atom f_held[1]*f_held[2]+v_push*(1-f_held[2])",
    "fix held all store/state 0 v_rest_push v_stored",
    "variable free atom v_push-f_held[1]",
)
"""LAMMPS evaluates a fix store/state again in a continued run, where the largest overlaps are others: its second column
is 1 where the first holds a force already.
"""


def _overlaps(walls: list[WallLinks], layout: BeadLayout, *, differ: bool) -> list[str]:
    """The pairs, and variables of the two overlaps of each bead."""
    beads = layout.beads
    pairs = beads // 2 + 1
    place, chain = f"((id-1)%{beads})", f"floor((id-1)/{beads})*{pairs}"
    lines = [
        "# contacts that yield: overlaps of the pairs of beads 1 and 2, 3 and 4, ..., and of 2 and 3, 4 and 5, ...",
        f"variable pair1 atom {chain}+floor({place}/2)+1",
        f"variable pair2 atom {chain}+floor(({place}+1)/2)+1",
        f"variable sign atom 1-2*({place}%2)",
        f"variable paired1 atom ({place}-{place}%2<{beads - 1})",
        f"variable paired2 atom ({place}>0)*({place}+{place}%2<{beads})",
        "fix pairs all store/state 0 v_sign v_paired1 v_paired2",
        *(["compute contacts all property/atom " + " ".join(COLUMNS)] if differ else []),
        "variable signed atom x*f_pairs[1]",
    ]
    for n, sign in ((1, "+"), (2, "-")):
        lines += [
            f"compute pair{n} all chunk/atom v_pair{n} nchunk once ids once compress no",
            f"compute sum{n} all reduce/chunk pair{n} sum v_signed",
            f"compute apart{n} all chunk/spread/atom pair{n} c_sum{n}",
            f"variable overlap{n} atom f_pairs[{n + 1}]*({text(layout.diameter)}{sign}c_apart{n})"
            + "".join(_at_wall(wall, n, layout) for wall in walls),
        ]
    return lines


_STORED = ("most", "top", "z", "permanent")
"""Largest overlaps so far and what follows from them, of the first and the second pairs each: columns of the fix."""


def _of_pair(n: int, strength: str, onset: str) -> list[str]:
    """Variables of the first or the second pairs."""
    largest, top, z, permanent = (f"f_memory[{2 * place + n}]" for place in range(len(_STORED)))
    d = f"v_overlap{n}"
    return [
        f"variable most{n} atom {largest}*({largest}>={d})+{d}*({d}>{largest})",
        f"variable top{n} atom {largest}*({largest}>={onset})+{onset}*({largest}<{onset})",
        f"variable z{n} atom sqrt({onset}/{top})*(1.5-0.5*{onset}/{top})",
        f"variable permanent{n} atom {top}*(1-{z})",
        f"variable first{n} atom sqrt({onset})*(1.5*{d}-0.5*{onset})",
        f"variable again{n} atom (({d}-{permanent})*({d}>{permanent}))^1.5/sqrt({z})",
        f"variable force{n} atom {strength}*(({d}>{top})*v_first{n}+({d}<={top})*v_again{n})",
    ]


def _at_wall(wall: WallLinks, n: int, layout: BeadLayout) -> str:
    """Overlap with a wall, of the beads at it whose place in the first or second pairs is free."""
    right, beads = wall.side > 0.0, layout.beads
    if n != (2 if not right or beads % 2 == 0 else 1):
        return ""
    end = beads if right else 1
    (face,) = {face for _, face in faces(wall, layout)}
    touched = text(face - wall.side * layout.diameter / 2.0)
    strain = f"(x-{touched})" if right else f"({touched}-x)"
    return f"+((id-1)%{beads}=={end - 1})*{strain}"


def _no_forces(layout: BeadLayout) -> tuple[str, ...]:
    return (
        "# contacts: no forces of LAMMPS's own, but neighbours; see fix contacts",
        f"pair_style zero {text(layout.diameter)} nocoeff",
        "pair_coeff * *",
    )


def _walls(layout: BeadLayout) -> list[WallLinks]:
    """The walls that yield."""
    return [wall for wall in layout.walls if laws.has_state(wall.law)]


def _columns(law: Any, layout: BeadLayout) -> dict[str, NDArray[np.float64]]:
    """Numbers of `COLUMNS`, each [chain, bead]; a strength of 0 where there is no contact."""
    table = _strength_and_onset(law, layout)
    odd, before, behind = np.arange(layout.beads) % 2 == 1, table[..., :-1], table[..., 1:]
    pairs = np.stack([np.where(odd, before, behind), np.where(odd, behind, before)], axis=1)
    return dict(zip(COLUMNS, pairs.reshape(4, layout.chains, layout.beads), strict=True))


def _strength_and_onset(law: Any, layout: BeadLayout) -> NDArray[np.float64]:
    """Strength and onset of each contact, [strength or onset, chain, contact], the first and the last with walls.

    A strength of 0 stands where there is no contact.
    """
    numbers = np.zeros((2, layout.chains, layout.beads + 1))
    numbers[1] = 1.0
    for row, value in zip(numbers, (law.strength, law.onset), strict=True):
        row[:, 1:-1] = value
    for wall in _walls(layout):
        end = -1 if wall.side > 0.0 else 0
        for row, value in zip(numbers, (wall.law.strength, wall.law.onset), strict=True):
            row[:, [end]] = value
    return numbers
