"""Impulses of rigid beads, a contact being one collision."""

import math

import numpy as np
from small_problems import problem

from workflow.plugins.rigid import engine
from workflow.plugins.rigid.events import Collisions, from_events

TWICE = ((1, 1, 1.0), (1, 2, 0.2))
"""Bead 1 hands 0.8 on to bead 2, which loses all to bead 3, and later the 0.2 that it was left with."""


def impulses(duration=10.0, **keys):
    keys = {"chains": 1, "beads": 2, "kicks": ((1, 1, 1.0),), "kappa": 0.0, "gap": 1.0, **keys}
    times = {"timestep": 0.1, "steps_per_frame": 1, "frames": math.ceil(duration / 0.1 - 1e-9)}
    case = problem(**keys, **times)
    run = engine.run(case)
    return from_events(case, Collisions(run.time, run.chain, run.row, run.striker, run.target))


def test_first_and_later_contacts_are_told_apart():
    found = impulses(beads=3, kicks=TWICE, gap=5.0, duration=60.0)
    np.testing.assert_allclose(found.first[0], [0.8, 1.0], rtol=0, atol=1e-15)
    np.testing.assert_allclose(found.total[0], [1.0, 1.0], rtol=0, atol=1e-15)
    assert found.contacts.tolist() == [[2, 1]]


def test_what_was_never_struck_has_no_impulse_and_no_time():
    found = impulses(beads=5, duration=2.5)
    assert found.contacts[0].tolist() in ([1, 1, 0, 0], [1, 0, 0, 0])
    assert found.first[0, -1] == found.total[0, -1] == 0.0
    assert math.isnan(found.time[0, -1])
    assert not impulses(duration=0.5).first.any()
