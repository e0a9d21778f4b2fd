"""The states that a directory may be in."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

State = Literal["none", "written", "waiting", "running", "done", "failed", "incomplete"]

MEANING: dict[State, str] = {
    "none": "holds no run",
    "written": "a deck that has not been run",
    "waiting": "in the queue",
    "running": "computes",
    "done": "came to its end",
    "failed": "ended with an error",
    "incomplete": "was cut short, and can go on",
}


@dataclass(frozen=True)
class Status:
    """State of a directory.

    Attributes:
        directory: as it was given.
        state: one of `MEANING`.
        step: how far it is; None where nobody knows.
        steps: how far it is to go; likewise.
        why: the reason, and what to do next.
    """

    directory: Path
    state: State
    step: int | None = None
    steps: int | None = None
    why: str = ""

    def plain(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "directory": str(self.directory),
            "state": self.state,
            "step": self.step,
            "steps": self.steps,
            "why": self.why,
        }
