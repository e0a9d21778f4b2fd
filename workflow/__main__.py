"""``python -m workflow`` is the command ``granchain``, also beside folders that are called as its packages are."""

import sys
from pathlib import Path

working_directory, root = Path.cwd(), Path(__file__).parents[1]
if working_directory != root:
    sys.path[:] = [entry for entry in sys.path if Path(entry) != working_directory]

from workflow.cli import command  # noqa: E402  what lies in the current directory must not be imported

sys.exit(command())
