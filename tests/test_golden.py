"""Golden texts: what counts as the same text, and that no file of them is left over."""

from pathlib import Path

import pytest
from golden import agree

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


def test_every_golden_text_is_named_by_a_test_beside_it():
    for file in HERE.rglob("golden/*.txt"):
        beside = "".join(path.read_text(encoding="utf-8") for path in file.parents[1].glob("*.py"))
        assert f'"{file.stem}"' in beside, file
