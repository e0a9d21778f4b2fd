"""The file of frames while LAMMPS writes it: LAMMPS itself may not notice that the disk took only a part of it."""

from pathlib import Path

from lammps_inputs import Problem


class FramesOnDisk:
    """Compares the size of a file with what it must be. All its frames have one size, which the first ones tell.

    Args:
        path: the file.
        problem: whose frames.
        begun: step that the file begins with; a frame falls on it, or is the next one after it.
    """

    def __init__(self, path: Path, problem: Problem, begun: int) -> None:
        self._path = path
        self._every = problem.steps_per_frame
        self._first = -(-begun // self._every)
        self._size = 0
        self._least = 8 * 3 * problem.chains * problem.rows_a_frame

    def whole(self, step: int) -> bool:
        """Whether the file holds every frame until a step."""
        frames = step // self._every - self._first + 1
        if frames < 1:
            return True
        found = self._path.stat().st_size
        if self._size == 0:
            self._size = found // frames
        return self._size > self._least and found == self._size * frames
