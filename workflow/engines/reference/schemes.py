"""Splitting schemes: two rows of numbers each, with order and source.

`VERLET` and `SUZUKI4` are step for step what LAMMPS does: with ``fix nve``, and with the decks' ``suzuki4``, Suzuki's
composition of five velocity Verlet steps. `BLANES_MOAN` is the reference's own: a six-stage symmetric splitting of
order 4, symplectic and time-reversible as all of them, with a small error constant.

Examples:
    >>> schemes.BLANES_MOAN.order, schemes.BLANES_MOAN.forces_per_step
    (4, 6)
    >>> schemes.VERLET.kicks, schemes.VERLET.drifts
    ((0.5, 0.5), (1.0,))
"""

from dataclasses import dataclass
from itertools import pairwise

from lammps_inputs.scheme import WEIGHTS


@dataclass(frozen=True)
class Scheme:
    """One time step h as kicks (v += kick * h * a) and drifts (x += drift * h * v), taken in turn, a kick first.

    A leading or trailing kick of 0 makes the scheme start or end with a drift.
    """

    name: str
    order: int
    """Order for smooth forces; contacts that open and close limit every scheme to 2.5 at small steps."""
    kicks: tuple[float, ...]
    drifts: tuple[float, ...]

    @property
    def forces_per_step(self) -> int:
        """Force evaluations a step costs; a last kick shares its forces with the next step's first."""
        return len(self.drifts) if self.kicks[0] else len(self.drifts) - 1


VERLET = Scheme(name="verlet", order=2, kicks=(0.5, 0.5), drifts=(1.0,))
"""Swope, Andersen, Berens & Wilson, J. Chem. Phys. 76 (1982) 637."""


_STEPS = WEIGHTS["suzuki4"]

SUZUKI4 = Scheme(
    name="suzuki4",
    order=4,
    kicks=(
        0.5 * _STEPS[0],
        *(0.5 * (before + after) for before, after in pairwise(_STEPS)),
        0.5 * _STEPS[-1],
    ),
    drifts=_STEPS,
)
"""Suzuki, Phys. Lett. A 146 (1990) 319, eq. 15."""


_A1, _A2, _A3 = 0.0792036964311957, 0.353172906049774, -0.0420650803577195
_A4 = 1.0 - 2.0 * (_A1 + _A2 + _A3)
_B1, _B2 = 0.209515106613362, -0.143851773179818
_B3 = 0.5 - (_B1 + _B2)

BLANES_MOAN = Scheme(
    name="blanes-moan",
    order=4,
    kicks=(0.0, _B1, _B2, _B3, _B3, _B2, _B1, 0.0),
    drifts=(_A1, _A2, _A3, _A4, _A3, _A2, _A1),
)
"""Blanes & Moan, J. Comput. Appl. Math. 142 (2002) 313, Table 2, S6 of order 4."""
