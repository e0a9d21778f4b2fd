"""Files of oscilloscopes: heads, separators, units and gains, as programs write them, and what is refused of them."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from analysis.files import traces
from analysis.files.traces import Channel, TraceFile
from lammps_inputs import InputError

COLUMNS = {"time": "TIME", "force_wall_right": "CH1"}


def written(tmp_path, text, **more):
    path = tmp_path / "scope.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return TraceFile(path, **{"columns": COLUMNS, **more})


def complaint_of(file):
    """Text of the error with which a file is refused; empty where it is read."""
    try:
        traces.load(file)
    except InputError as error:
        return str(error)
    return ""


@pytest.mark.slow
@given(st.text(max_size=200))
@settings(deadline=None, max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_any_other_text_is_refused_in_one_line_or_read(tmp_path, text):
    for file in (written(tmp_path, text), written(tmp_path, "TIME,CH1\n" + text)):
        complaint = complaint_of(file)
        assert complaint == "" or complaint.startswith(str(file.path))
        assert "\n" not in complaint


@pytest.mark.parametrize(
    ("text", "columns", "time", "values"),
    [
        ("x-axis,1\nsecond,Volt\n-1e-3,0.6\n0,0.8\n", {"time": "x-axis", "force_wall_right": "1"}, [-1e-3, 0], [1, 3]),
        ("Length,2,,0.1,0.7,\nStep,1,,0.2,0.9,\n,,,0.3,1.1,\n", {"time (ms)": "#4", "force_wall_right (V)": "#5"},
         [1e-4, 2e-4, 3e-4], [2, 4, 6]),
        ("Time,Channel A\n(ms),(mV)\n\n1,5.5\n", {"time": "time", "force_wall_right": "channel_a"}, [1e-3], [50]),
        ("A,TIME,CH1 (V),TIME,CH2\n0,1,2.5,3,4\n", {"time (s)": "#4", "force_wall_right": "CH1"}, [3], [20]),
        ('\N{BYTE ORDER MARK}Model;X\r\n,\r\n"7";"TIME(us)";"CH1";\r\n7;1e3;"0.6";\r\n  \r\n7;2e3;"-0.5";\r\n\r\n',
         COLUMNS, [1e-3, 2e-3], [1, -10]),
        ("other\tTIME\tCH1\n-\tus\tV\n7\t1\t0.5\n7\t2\t\n7\t3\t1e6", COLUMNS, [1e-6, 2e-6, 3e-6], [0, np.nan, 9999995]),
        ("Vertical 1\nother  TIME(us)  CH1\n7  1  -1e6\n", COLUMNS, [1e-6], [-10000005]),
    ],
    ids=["units in letters", "no line of names", "units in brackets", "a name twice, by its number",
         "all around numbers", "tabs, holes and no last end of line", "spaces"],
)  # fmt: skip
def test_layouts_of_makers_are_read(text, columns, time, values, tmp_path):
    own = {"gain": {"force_wall_right": 10.0}, "baseline": {"force_wall_right": 0.5}}
    loaded = traces.load(written(tmp_path, text, columns=columns, **own))
    assert loaded.channels == (Channel("wall", 1, right=True),)
    assert loaded.time == pytest.approx(time)
    assert loaded.values[:, 0] == pytest.approx(values, nan_ok=True)


def test_a_signal_whose_gain_or_baseline_is_free_remains_as_it_is(tmp_path):
    text = "TIME (us),CH1 (mV),CH2\n1,5,3\n"
    columns = {**COLUMNS, "force_contact_3 (kN)": "CH2"}
    free = {"gain": {"CH1": "free"}, "baseline": {"CH2": "free"}}
    loaded = traces.load(written(tmp_path, text, columns=columns, **free))
    assert loaded.values.tolist() == [[5.0, 3.0]]
    assert loaded.signals == {0: traces.Calibration(None, 0.0, "mV"), 1: traces.Calibration(1e3, None, "kN")}


@pytest.mark.parametrize(
    ("text", "more", "says"),
    [
        ("Zeit;CH1\n0,1;2\n", {}, "has no column 'TIME'; line 1 names Zeit, CH1"),
        ("TIME;CH1\n0,001;1,5\n", {}, "line 2: column 'TIME' holds '0,001', which is no number; decimal commas"),
        ("TIME,CH1\n0,001,1,5\n", {}, "2 names in the first line, but 4 columns in line 2; decimal commas"),
        ("a\nTIME,CH1\n0,1\n\n2,1\n1,1\n", {}, "column 'TIME' holds 1 in line 6, after 2"),
        ("TIME,CH1\n0,1\ns,V\n", {}, "line 3: column 'TIME' holds 's', which is no number"),
        ("TIME,CH1\nmin,V\n0,1\n", {"gain": {"CH1": 1.0}}, "column 'TIME': the unit 'min' is not known; s, ms, us, ns"),
        ("TIME,CH1 (V)\n0,1\n", {}, "the unit 'V' is not known; N, mN, kN; of a sensor's signal give the gain"),
        ("a\nTIME,CH1\n0,1\n", {"skip": 0}, "line 1 does not name TIME, CH1; line 2 does: --skip 1"),
        ("TIME,CH1\n0,1\n", {"gain": {"CH1": 0.0}}, "--gain: CH1: 0.0 given; a number such as 20.5 or free"),
        ("TIME,CH1\n0,1\n", {"columns": {"time": "TIME", "force": "CH1"}}, "--columns: 'force': not known, or names"),
        ("TIME,CH1\n0,1\n", {"columns": {"force_wall_right": "CH1"}}, "--columns: names no time, such as time=TIME"),
        ("\n\n", {}, "is empty"),
        ("TIME,CH1\n0,1\n".encode("utf-16"), {}, "is not text in UTF-8"),
    ],
)  # fmt: skip
def test_what_is_wrong_with_a_scopes_file_is_said_with_its_line_and_column(text, more, says, tmp_path):
    file = written(tmp_path, text, **more)
    complaint = complaint_of(file)
    assert says in complaint
    assert complaint.startswith((str(file.path), "--"))
