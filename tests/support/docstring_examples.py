"""Examples in docstrings: the names that they use without importing them, and what of them fails."""

import doctest
import re

import numpy as np

import granchain
from granchain import parts
from workflow import lazy_names

PARTS = lazy_names.sources(parts.__file__)
"""Name of `granchain.parts` -> module that has it, and its name there."""


def failures(text, tmp):
    """What the examples in a docstring print that is not written there, in words; empty if nothing.

    They use `granchain`, `np`, any name of `granchain.parts`, and `tmp`, the path of an empty directory.
    """
    names = {name: getattr(parts, name) for name in PARTS if re.search(rf"\b{name}\b", text)}
    test = doctest.DocTestParser().get_doctest(
        text, {"granchain": granchain, "np": np, "tmp": tmp, **names}, "", None, 0
    )
    lines = []
    runner = doctest.DocTestRunner(verbose=False, optionflags=doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS)
    runner.run(test, out=lines.append)
    return "".join(lines)
