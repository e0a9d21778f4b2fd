"""Blanes and Moan's six-stage symmetric splitting: order 4, symplectic, time-reversible, small error constant."""

from workflow.engines.reference.scheme import Scheme

_A1, _A2, _A3 = 0.0792036964311957, 0.353172906049774, -0.0420650803577195
_A4 = 1.0 - 2.0 * (_A1 + _A2 + _A3)
_B1, _B2 = 0.209515106613362, -0.143851773179818
_B3 = 0.5 - (_B1 + _B2)

BLANES_MOAN = Scheme(
    name="blanes-moan",
    order=4,
    kicks=(0.0, _B1, _B2, _B3, _B3, _B2, _B1, 0.0),
    drifts=(_A1, _A2, _A3, _A4, _A3, _A2, _A1),
    source="Blanes & Moan, J. Comput. Appl. Math. 142 (2002) 313, Table 2, S6 of order 4",
)
