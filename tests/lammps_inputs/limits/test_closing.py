"""A gap that no kick closes is refused; one that some kick closes is not."""

import contextlib

import numpy as np
import pytest
from small_problems import problem
from stock_lammps import scene

from lammps_inputs import Kick
from lammps_inputs.limits.closing import never_closes
from workflow.plugins.rigid import engine as collisions

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


def test_beads_of_a_refused_scene_never_meet():
    random = np.random.default_rng(0)
    refused = 0
    for _ in range(400):
        chains, kappa, gap = int(random.integers(1, 5)), random.choice([0.0, 0.1, 1.0]), random.choice([1e-3, 0.5, 3.0])
        kicks = {
            (int(random.integers(1, chains + 1)), bead): (bead - 2 or 1) * random.uniform(0.2, 1.0) for bead in (1, 3)
        }
        kicks[int(random.integers(1, chains + 1)), 2] = random.uniform(-0.3, 0.3)
        fastest = max(map(abs, kicks.values()))
        listed = tuple((chain, bead, float(velocity / fastest)) for (chain, bead), velocity in kicks.items())
        if never_closes(chains, kappa, gap, listed, 3):
            refused += 1
            times = {"timestep": 1e3, "steps_per_frame": 1, "frames": 1}
            apart = problem(chains=chains, beads=3, kicks=listed, kappa=kappa, gap=gap, **times)
            assert len(collisions.run(apart, max_events=1)) == 0
    assert 50 < refused < 400
