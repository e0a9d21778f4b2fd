"""The one exception for what a user typed wrongly."""


class InputError(ValueError):
    """A scene, file or option that cannot be used; its text is one line that states what to do (exit code 2).

    Examples:
        >>> granchain.load("one-chain", {"beads": 1})
        Traceback (most recent call last):
            ...
        lammps_inputs.errors.InputError: one-chain: beads: should be greater than or equal to 2, 1 given
        >>> raise granchain.InputError("--rows: 0 given; 1 to 100")
        Traceback (most recent call last):
            ...
        lammps_inputs.errors.InputError: --rows: 0 given; 1 to 100
    """

    def __init__(self, message: str) -> None:
        one_line = " ".join(message.split())
        super().__init__("".join(c if c.isprintable() else ascii(c)[1:-1] for c in one_line))  # no terminal controls
