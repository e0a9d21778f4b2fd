"""Golden texts: what counts as the same text, and that no file of them is left over."""

from pathlib import Path

import pytest
from golden import RELATIVE, agree, compare

HERE = Path(__file__).parent


@pytest.mark.parametrize(
    ("expected", "given", "same"),
    [
        ("chain 1 at 0.25 V", "chain  1 at 0.250001 V", True),
        ("chain 1 at 0.25 V", "chain 1 at 0.2501 V", False),
        ("chain 1", "chain 2", False),
        ("100000 points", "100001 points", False),
        ("from -1e-07 to 3.5", "from -1.000001e-07 to 3.5", True),
        ("from -1e-07", "from 1e-07", False),
        ("velocity", "speed", False),
        ("1, 2", "1, 2, 3", False),
    ],
)
def test_texts_agree_by_words_and_whole_numbers_and_others_within_a_share(expected, given, same):
    assert agree(expected, given) == same


def test_a_text_is_compared_with_its_file_line_by_line_and_written_only_where_that_is_asked_for(tmp_path):
    file = tmp_path / "golden" / "text.txt"
    options = {"masks": {"pid [0-9]+": "PID"}, "relative": RELATIVE}
    with pytest.raises(AssertionError, match="--update-golden"):
        compare(file, "a 0.5", update=False, **options)
    assert not file.exists()
    compare(file, "a 0.5\n2026-11-28 23:10 in 3.2 s, pid 77", update=True, **options)
    assert file.read_text() == "a 0.5\nDATE in SECONDS, PID\n"
    compare(file, "a 0.500001\n2027-01-01 00:00:00 in 4 s, pid 9", update=False, **options)
    with pytest.raises(AssertionError, match=r"-a 0\.5\n\+a 0\.6"):
        compare(file, "a 0.6\nDATE in SECONDS, PID", update=False, **options)


def test_every_golden_text_is_named_by_a_test_beside_it():
    for file in HERE.rglob("golden/*.txt"):
        beside = "".join(path.read_text(encoding="utf-8") for path in file.parents[1].glob("*.py"))
        assert f'"{file.stem}"' in beside, file
