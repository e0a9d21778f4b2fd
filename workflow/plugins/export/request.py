"""A request for files: what is exported, the options, and the frames to write."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from granchain.parts import RunDirectory, Trajectory, screen

Writers = dict[str, Callable[[Path], object]]
"""Name of each file, and what writes it to a path."""

PIECE_BYTES = 1 << 22
"""Largest size of displacements and velocities in a piece of the frames."""

LARGE = 100e6
"""Bytes from which on the size of a file is printed before it is written."""


@dataclass(frozen=True)
class Options:
    """Options of all formats.

    Attributes:
        every: every how many frames are written.
        seconds: duration of a film, in seconds.
        rate: pictures of a film a second.
        pixels: width of a film.
    """

    every: int = 1
    seconds: float = 12.0
    rate: int = 20
    pixels: int = 1000


@dataclass(frozen=True)
class ExportRequest:
    """A run or a sweep, and the options with which it is exported.

    Attributes:
        path: directory of the run or sweep.
        options: see `Options`.
        is_run: whether it is a run.
    """

    path: Path
    options: Options
    is_run: bool

    @cached_property
    def directory(self) -> RunDirectory:
        """The directory of the run."""
        return RunDirectory(self.path)

    def pieces(self, name: str, bytes_of_bead: float) -> Iterator[Trajectory]:
        """The frames to write, in pieces of bounded size, under a bar of progress.

        Args:
            name: of the file, for the bar.
            bytes_of_bead: bytes that a bead takes in a frame of the file; a large file is announced.
        """
        problem, every = self.directory.problem, self.options.every
        total = problem.frames // every + 1
        beads = problem.beads if problem.rows.follow else problem.rows.count
        expected = total * problem.chains * beads * bytes_of_bead
        if expected > LARGE:
            screen.hint(f"{name}: {total} frames of {problem.chains} x {beads} beads, {expected / 1e6:.0f} MB at most")
        frames = max(1, PIECE_BYTES // (16 * problem.chains * beads))
        done = 0
        with screen.count_bar(name) as progress:
            for block in self.directory.blocks_so_far(every):
                for start in range(0, block.frames, frames):
                    yield (piece := block[start : start + frames])
                    done += piece.frames
                    progress(done, total)
