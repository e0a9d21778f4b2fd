"""The table of collisions."""

import numpy as np
import pytest

from analysis.quantity import csv_of, declared
from lammps_inputs.units import make_scale
from workflow.plugins.rigid import events
from workflow.plugins.rigid.events import Collisions

SI = make_scale(3.6e-3, 6.9e9, 0.7, si=True)


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


def test_a_table_is_in_the_units_of_the_scene():
    written = Collisions(np.array([2.0]), np.array([1]), np.array([3]), np.array([0.5]), np.array([0.25]))
    head, line = csv_of(written, SI).splitlines()
    assert head == "time (s),chain,row,striker (m/s),target (m/s),rounding"
    assert csv_of(written, make_scale(1.0, 1.0, 1.0, si=False)).startswith("time,chain,row,striker,target,rounding\n")
    assert [float(number) for number in line.split(",")] == [2.0 * SI.time, 1.0, 3.0, 0.5 * 0.7, 0.25 * 0.7, 0.0]
