"""A small scene file, for tests that change its lines; and what a message about a bad one must be like."""

from lammps_inputs import InputError

_GOOD = {"name": "test", "beads": "10", "kick": "{bead: 1, velocity: 1.0}", "duration": "5"}


def scene_text(**lines: str | None) -> str:
    """YAML of a small good scene with some lines changed, added, or (None) left out."""
    return "".join(f"{key}: {value}\n" for key, value in {**_GOOD, **lines}.items() if value is not None)


def assert_one_line(error: InputError, start: str) -> None:
    """The message begins with what it is about, and prints as one line of readable length on any terminal."""
    message = str(error)
    assert message.startswith(start)
    assert len(message.splitlines()) == 1
    assert message.isprintable()
    assert len(message) < len(start) + 250
