"""``python -m workflow`` is the command ``granchain``, also beside folders that are called as its packages are."""

import sys
from pathlib import Path

here, ours = Path.cwd(), Path(__file__).parents[1]
if here != ours:
    sys.path[:] = [entry for entry in sys.path if Path(entry) != here]

from workflow.cli import command  # noqa: E402  what lies in the current directory must not be imported

sys.exit(command())
