"""What a process of a sweep is told to do, as one line."""

import json
from dataclasses import asdict, dataclass

from workflow.sweep.directory import Asked


@dataclass(frozen=True)
class Job:
    """What to do in one directory.

    Attributes:
        directory: of the case, an absolute path.
        case: what to run first; None to analyse only what is there.
        check: whether to measure the error of a LAMMPS run.
        figures: formats of the figures to draw; none without any.
    """

    directory: str
    case: Asked | None
    check: bool
    figures: tuple[str, ...]

    def line(self) -> str:
        """As `from_line` reads it."""
        return json.dumps(asdict(self)) + "\n"

    @classmethod
    def from_line(cls, line: str) -> "Job":
        """From one line of input."""
        data = json.loads(line)
        case = data.pop("case")
        figures = tuple(data.pop("figures"))
        return cls(case=None if case is None else Asked(**case), figures=figures, **data)
