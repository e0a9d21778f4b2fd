"""Tables of measured traces: names of columns, units, holes, and what is wrong with one."""

import numpy as np
import pytest

from analysis.files import traces
from analysis.files.traces import Channel


def table(directory, text):
    path = directory / "t.csv"
    path.write_text(text)
    return path


@pytest.mark.parametrize(
    ("name", "channel"),
    [
        ("force_wall_right", Channel("wall", 1, right=True)),
        ("force_wall_left_chain_2", Channel("wall", 2)),
        ("right wall chain 3 (N)", Channel("wall", 3, right=True)),
        ("right wall chain 3 total (N)", Channel("wall", 3, right=True)),
        ("force_contact_10", Channel("contact", 1, 10)),
        ("contact 10 chain 2", Channel("contact", 2, 10)),
        ("force_sensor_20_chain_4", Channel("sensor", 4, 20)),
        ("contact 10 chain 2 dynamic (N)", Channel("contact", 2, 10, dynamic=True)),
        ("left wall chain 1 dynamic", Channel("wall", 1, dynamic=True)),
        ("velocity_1_55", Channel("velocity", 1, 55)),
        ("Velocity chain 2 bead 5", Channel("velocity", 2, 5)),
        ("displacement_2_7", Channel("displacement", 2, 7)),
    ],
)
def test_columns_are_known_by_single_words_and_as_forces_csv_has_them(name, channel, tmp_path):
    path = table(tmp_path, f"time,other,{name}\n0,7,1\n1,8,2\n")
    assert traces.are_in(path)
    found = traces.load(path)
    assert found.channels == (channel,)
    assert found.values.tolist() == [[1.0], [2.0]]


def test_units_are_made_si_and_holes_stay_holes(tmp_path):
    found = traces.load(table(tmp_path, "time (\N{MICRO SIGN}s),contact 3 (mN),velocity_1_2 (mm/S)\n1,500,\n2,nan,3\n"))
    assert found.time == pytest.approx([1e-6, 2e-6])
    assert found.values == pytest.approx(np.array([[0.5, np.nan], [np.nan, 0.003]]), nan_ok=True)
    assert found.units


def test_a_table_of_beads_is_a_trace_for_every_bead_that_it_has(tmp_path):
    text = "time,chain,bead,velocity\n0,1,3,1\n0,2,5,2\n1,1,3,4\n"
    path = table(tmp_path, text)
    assert not traces.are_in(path)
    found = traces.load(path)
    assert found.channels == (Channel("velocity", 1, 3), Channel("velocity", 2, 5))
    assert found.values == pytest.approx(np.array([[1.0, 2.0], [4.0, np.nan]]), nan_ok=True)
