import pytest
from bad_scenes import assert_one_line
from hypothesis import example, given
from hypothesis import strategies as st
from strategies import YAML_LIKE

from lammps_inputs import InputError, strict_yaml

TEXT = st.text(st.characters(exclude_categories=["Cs"]), max_size=40)
KEYS = st.from_regex(r"[a-z_]{1,9}", fullmatch=True)
PLAIN = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | TEXT,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(KEYS, inner, max_size=3),
    max_leaves=8,
)


@pytest.mark.parametrize(
    ("written", "value"),
    [
        ("1e5", 1e5),
        ("1e-5", 1e-5),
        ("-2.5", -2.5),
        (".5", 0.5),
        ("7", 7),
        ("true", True),
        ("", None),
        ("yes", "yes"),
        ("1:30", "1:30"),
        ("010", "010"),
        ("1_000", "1_000"),
        ("2020-01-01", "2020-01-01"),
        ("'1e5'", "1e5"),
    ],
)
def test_a_scalar_is_what_an_engineer_takes_it_for(written, value):
    read = strict_yaml.parse(f"key: {written}", "here")["key"]
    assert (type(read), read) == (type(value), value)


@pytest.mark.slow
@given(TEXT | YAML_LIKE)
@example("a: !!bool x")
@example('a: !!int ""')
@example("!!map [[a, b]]")
@example("a: !!timestamp x")
@example('"\\UFFFFFFFF"')
@example("{a: " * 5000)
def test_any_text_gives_a_mapping_or_one_line(text):
    try:
        data = strict_yaml.parse(text, "here")
    except InputError as error:
        assert_one_line(error, "here: ")
    else:
        assert isinstance(data, dict)


@pytest.mark.slow
@given(st.dictionaries(KEYS, PLAIN, min_size=1, max_size=4))
@example({"name": "1e5"})
@example({"name": "a\x85b"})
@example({"name": "12E3", "velocity": 1e16})
def test_what_is_dumped_reads_back_exactly(data):
    assert repr(strict_yaml.parse(strict_yaml.dump(data), "here")) == repr(data)


def test_a_byte_order_mark_is_no_part_of_the_first_key_and_windows_line_ends_are_line_ends(tmp_path):
    path = tmp_path / "bom.yaml"
    path.write_bytes(b"\xef\xbb\xbfname: a\r\nbeads: 2\r\n")
    assert strict_yaml.load(path) == {"name": "a", "beads": 2}
