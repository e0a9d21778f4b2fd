"""A gap that no kick closes is refused; one that some kick closes is not."""

import contextlib

import pytest
from stock_lammps import scene

from lammps_inputs import Kick

OPEN = [
    (1, None, [Kick(bead=1, velocity=-1.0)]),
    (1, None, [Kick(bead=4, velocity=1.0)]),
    (2, 0.1, [Kick(bead=1, velocity=-1.0)]),
    (2, 0.1, [Kick(bead=4, velocity=1.0)]),
    (3, 0.1, [Kick(bead=1, velocity=-1.0)]),
    (7, 0.5, [Kick(chain=4, bead=4, velocity=1.0)]),
    (2, None, [Kick(chain=1, bead=1, velocity=-1.0), Kick(chain=2, bead=4, velocity=1.0)]),
    (1, None, [Kick(bead=3, velocity=0.5), Kick(bead=4, velocity=1.0)]),
    (2, 1.0, [Kick(bead=2, chain=chain, velocity=sign) for chain, sign in ((1, 1.0), (2, -1.0))]),
]
CLOSED = [
    (1, None, [Kick(bead=1, velocity=1.0)]),
    (1, None, [Kick(bead=4, velocity=-1.0)]),
    (1, None, [Kick(bead=3, velocity=1.0), Kick(bead=4, velocity=0.5)]),
    (2, 0.1, [Kick(chain=2, bead=1, velocity=1.0)]),
    (2, 1e-320, [Kick(bead=1, velocity=-0.6), Kick(bead=1, chain=2, velocity=0.1)]),
    (2, 0.1, [Kick(bead=2, chain=chain, velocity=sign) for chain, sign in ((1, 1.0), (2, -1.0))]),
]


@pytest.mark.parametrize(("chains", "kappa", "kicks"), [*OPEN, *CLOSED], ids=str)
def test_a_gap_is_refused_exactly_if_no_kick_closes_it(chains, kappa, kicks):
    refused = pytest.raises(ValueError, match=r"kick: none ever closes the gap of 1, .* kick a bead towards another")
    with refused if (chains, kappa, kicks) in OPEN else contextlib.nullcontext():
        scene(chains=chains, beads=4, gap=1.0, kappa=kappa, kick=tuple(kicks))


def test_beads_that_touch_may_be_kicked_apart():
    assert scene(beads=4, kick=(Kick(bead=1, velocity=-1.0),)).gap == 0.0
