"""Python writes the bytecode of what it imports, even where PYTHONDONTWRITEBYTECODE is set.

Each of the hundreds of processes that the tests start would otherwise compile every module it imports, numpy and scipy
among them: 4 s of processor time for the first command of a process, 1.6 s from bytecode.
"""

import os
import sys

os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False
