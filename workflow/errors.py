"""Failures that are nobody's typing mistake."""


class RunError(RuntimeError):
    """A run that could not be finished or a result that is not right; its text is one line (exit code 1)."""

    def __init__(self, message: str) -> None:
        super().__init__(" ".join(message.split()))


class EndedError(RunError):
    """A run that was ended from outside, by a signal or a full disk, and may go on."""
