"""What a window that follows the pulse has left behind, and whether it could have come back.

A pulse runs the faster the higher it is. So nothing that a window leaves reaches the leading waves as long as the beads
in it move more slowly than any of these waves is high.
"""

import math

from analysis.tracking.leading_waves import Waves
from analysis.trajectory import Trajectory


class LeftBehind:
    """Collects what leaves the window of a run that is given block by block.

    Attributes:
        velocity: largest velocity along the chain of a bead when it was last seen, in units of V.
        bead: which bead that was; 0 if none has left.
    """

    def __init__(self) -> None:
        self.velocity = 0.0
        self.bead = 0
        self._before: Trajectory | None = None

    def add(self, block: Trajectory) -> None:
        """Take the next frames."""
        before = self._before
        if before is not None and block.first > before.first:
            last = before.velocity[-1, :, : block.first - before.first].max(axis=0)
            if last.max() > self.velocity:
                self.velocity, self.bead = float(last.max()), int(before.beads[int(last.argmax())])
        self._before = block

    def slowest_wave(self, waves: Waves) -> float:
        """Height of the lowest leading wave, in units of V, once the window has moved."""
        window = self._before.problem.window if self._before is not None else None
        own = waves.peak_velocity[waves.bead > window // 2] if window is not None else waves.peak_velocity[:0]
        return float(own.min()) if len(own) else math.nan

    def sentence(self, waves: Waves) -> str:
        """Whether anything could have come back, in words."""
        if self.bead == 0:
            return "window: nothing was left behind"
        slowest = self.slowest_wave(waves)
        found = f"window: beads left behind move at {self.velocity:.2g} V or less"
        if self.velocity < slowest:
            return f"{found}, every leading wave at {slowest:.2g} V or more: nothing comes back"
        return f"{found}, a leading wave at {slowest:.2g} V only: what was left might catch up; take a wider window"
