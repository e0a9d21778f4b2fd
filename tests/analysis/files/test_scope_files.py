"""Files of oscilloscopes: heads, separators, units and gains, as programs write them, and what is refused of them."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from analysis.files import traces
from analysis.files.traces import Channel, TraceFile
from lammps_inputs import InputError

WALL = Channel("wall", 1, right=True)
COLUMNS = {"time": "TIME", "force_wall_right": "CH1"}
NUMBER = st.floats(-1e6, 1e6)
HEAD_LINE = st.text(st.characters(codec="ascii", exclude_characters="\r\n#"), max_size=20)


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


@st.composite
def scope_texts(draw):
    """Text of a scope, lines before its names, and what it holds: times in us and signals, NaN where empty."""
    delimiter = draw(st.sampled_from([",", ";", "\t", "  "]))
    count = draw(st.integers(1, 8))
    times = np.cumsum(draw(st.lists(st.floats(1e-3, 1e3), min_size=count, max_size=count)))
    missing = st.just(np.nan) if delimiter != "  " else NUMBER
    signals = [draw(NUMBER), *draw(st.lists(NUMBER | missing, min_size=count - 1, max_size=count - 1))]
    quote, end = draw(st.sampled_from(["", '"'])), draw(st.sampled_from(["\n", "\r\n"]))
    trailing = draw(st.sampled_from(["", delimiter])) if delimiter.strip() else ""
    head = draw(st.lists(HEAD_LINE.filter(lambda line: "CH1" not in line), max_size=4))
    unit_row = draw(st.booleans())
    names = ["other", "TIME" if unit_row else "TIME(us)", "CH1"]
    rows = [[f"{quote}{cell}{quote}" for cell in names], ["-", "us", "V"]] if unit_row else [names]
    rows += [
        ["7", repr(float(time)), "" if np.isnan(signal) else f"{quote}{signal!r}{quote}"]
        for time, signal in zip(times, signals, strict=True)
    ]
    lines = [delimiter.join(row) + trailing for row in rows]
    for place in sorted(draw(st.lists(st.integers(2, len(lines)), max_size=3)), reverse=True):
        lines.insert(place, draw(st.sampled_from(["", "   "])))
    mark = draw(st.sampled_from(["", "\N{BYTE ORDER MARK}"]))
    return mark + end.join([*head, *lines]) + draw(st.sampled_from(["", end])), len(head), times, np.array(signals)


@pytest.mark.slow
@given(scope_texts(), st.booleans())
@settings(deadline=None, max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_every_number_of_a_scopes_file_is_read_whatever_stands_around_it(tmp_path, drawn, is_said):
    text, skip, times, signals = drawn
    file = written(tmp_path, text, gain={"CH1": 2.0}, baseline={"CH1": 0.5}, skip=skip if is_said else None)
    loaded = traces.load(file)
    assert loaded.channels == (WALL,)
    assert loaded.time.tolist() == (times * 1e-6).tolist()
    np.testing.assert_array_equal(loaded.values[:, 0], 2.0 * (signals - 0.5))


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
        ("x-axis,1\nsecond,Volt\n-1e-3,0.1\n0,0.3\n", {"time": "x-axis", "force_wall_right": "1"}, [-1e-3, 0], [1, 3]),
        ("Length,2,,0.1,0.2,\nStep,1,,0.2,0.4,\n,,,0.3,0.6,\n", {"time (ms)": "#4", "force_wall_right (V)": "#5"},
         [1e-4, 2e-4, 3e-4], [2, 4, 6]),
        ("Time,Channel A\n(ms),(mV)\n\n1,5\n", {"time": "time", "force_wall_right": "channel_a"}, [1e-3], [50]),
        ("A,TIME,CH1 (V),TIME,CH2\n0,1,2,3,4\n", {"time (s)": "#4", "force_wall_right": "CH1"}, [3], [20]),
    ],
    ids=["units in letters", "no line of names", "units in brackets", "a name twice, by its number"],
)  # fmt: skip
def test_layouts_of_makers_are_read(text, columns, time, values, tmp_path):
    loaded = traces.load(written(tmp_path, text, columns=columns, gain={"force_wall_right": 10.0}))
    assert loaded.time == pytest.approx(time)
    assert loaded.values[:, 0] == pytest.approx(values)


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
