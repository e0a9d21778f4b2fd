import numpy as np
import pytest

from analysis.quantity import csv_of, declared
from lammps_inputs import InputError
from lammps_inputs.units import make_scale
from workflow.plugins.rigid import events
from workflow.plugins.rigid.events import Collisions

SI = make_scale(3.6e-3, 6.9e9, 0.7, si=True)


def some(count):
    random = np.random.default_rng(count)
    time, striker = np.cumsum(random.random(count)), random.uniform(0.1, 1.0, count)
    return Collisions(
        time, random.integers(1, 4, count), random.integers(1, 99, count), striker, striker - random.random(count)
    )


@pytest.mark.parametrize("count", [0, 1, 500])
def test_a_table_of_collisions_reads_back(count, tmp_path):
    path = tmp_path / "events.csv"
    written = some(count)
    path.write_text(csv_of(written, SI))
    read = events.from_csv(path, SI)
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


@pytest.mark.parametrize("unit", [("", ""), (" (s)", " (m/s)")])
def test_a_table_of_before_units_were_named_or_rounding_was_marked_is_read_too(unit, tmp_path):
    path = tmp_path / "events.csv"
    path.write_text(f"time{unit[0]},chain,row,striker{unit[1]},target{unit[1]}\n1.0,1,2,0.5,0.25\n")
    read = events.from_csv(path, SI)
    assert read.time == 1.0 / SI.time
    assert read.rounding.tolist() == [0]


def test_the_impulse_is_what_is_handed_on():
    assert Collisions(*(np.array([value]) for value in (0.0, 1, 1, 0.75, 0.25))).impulse == 0.5


@pytest.mark.parametrize(
    ("text", "says"),
    [("a,b\n1,2\n", "its columns should be time"), ("time,chain,row,striker,target\n1,x\n", "not a table")],
)
def test_another_table_is_refused(text, says, tmp_path):
    path = tmp_path / "events.csv"
    path.write_text(text)
    with pytest.raises(InputError, match=says):
        events.from_csv(path, SI)


def test_a_missing_table_is_refused(tmp_path):
    with pytest.raises(InputError, match="cannot be read"):
        events.from_csv(tmp_path / "events.csv", SI)
