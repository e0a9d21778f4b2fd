"""The table of collisions, and impulses of rigid beads, a contact being one collision."""

import math

import numpy as np
import pytest
from small_problems import problem

from analysis.quantity import csv_of, declared
from lammps_inputs.units import make_scale
from workflow.plugins.rigid import engine, events
from workflow.plugins.rigid.events import Collisions, from_events

SI = make_scale(3.6e-3, 6.9e9, 0.7, si=True)


@pytest.mark.slow
@pytest.mark.parametrize("count", [0, 500])
def test_a_table_of_collisions_reads_back(count, tmp_path):
    random = np.random.default_rng(count)
    time, striker = np.cumsum(random.random(count)), random.uniform(0.1, 1.0, count)
    chain, row = random.integers(1, 4, count), random.integers(1, 99, count)
    written = Collisions(time, chain, row, striker, striker - random.random(count))
    (tmp_path / "events.csv").write_text(csv_of(written, SI))
    read = events.from_csv(tmp_path / "events.csv", SI)
    assert len(read) == count
    for name in declared(Collisions):
        # the scale is multiplied in and divided out: two roundings
        np.testing.assert_allclose(getattr(read, name), getattr(written, name), rtol=5e-16)


@pytest.mark.slow
def test_a_table_is_in_the_units_of_the_scene():
    written = Collisions(np.array([2.0]), np.array([1]), np.array([3]), np.array([0.5]), np.array([0.25]))
    head, line = csv_of(written, SI).splitlines()
    assert head == "time (s),chain,row,striker (m/s),target (m/s),rounding"
    assert csv_of(written, make_scale(1.0, 1.0, 1.0, si=False)).startswith("time,chain,row,striker,target,rounding\n")
    assert [float(number) for number in line.split(",")] == [2.0 * SI.time, 1.0, 3.0, 0.5 * 0.7, 0.25 * 0.7, 0.0]


TWICE = ((1, 1, 1.0), (1, 2, 0.2))
"""Bead 1 hands 0.8 on to bead 2, which loses all to bead 3, and later the 0.2 that it was left with."""


def impulses(duration=10.0, **keys):
    keys = {"chains": 1, "beads": 2, "kicks": ((1, 1, 1.0),), "kappa": 0.0, "gap": 1.0, **keys}
    times = {"timestep": 0.1, "steps_per_frame": 1, "frames": math.ceil(duration / 0.1 - 1e-9)}
    case = problem(**keys, **times)
    run = engine.run(case)
    return from_events(case, Collisions(run.time, run.chain, run.row, run.striker, run.target))


@pytest.mark.slow
def test_first_and_later_contacts_are_told_apart():
    found = impulses(beads=3, kicks=TWICE, gap=5.0, duration=60.0)
    np.testing.assert_allclose(found.first[0], [0.8, 1.0], rtol=0, atol=1e-15)
    np.testing.assert_allclose(found.total[0], [1.0, 1.0], rtol=0, atol=1e-15)
    assert found.contacts.tolist() == [[2, 1]]


@pytest.mark.slow
def test_what_was_never_struck_has_no_impulse_and_no_time():
    found = impulses(beads=5, duration=2.5)
    assert found.contacts[0].tolist() in ([1, 1, 0, 0], [1, 0, 0, 0])
    assert found.first[0, -1] == found.total[0, -1] == 0.0
    assert math.isnan(found.time[0, -1])
    assert not impulses(duration=0.5).first.any()
