"""Beads of a scene that is refused since no kick closes its gap never meet."""

import numpy as np
from small_problems import problem

from lammps_inputs.limits.closing import never_closes
from workflow.plugins.rigid import engine as collisions


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
