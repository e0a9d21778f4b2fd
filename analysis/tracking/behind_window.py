"""Residual motion of the beads that a window following the pulse has left, and whether it could catch up.

The higher a pulse, the faster it runs. So nothing that a window leaves reaches the leading waves as long as the beads
in it move more slowly than any of these waves is high.
"""

import math

from analysis.quantity import declare, derived, result
from analysis.tracking.leading_waves import Waves
from analysis.trajectory import Trajectory


@result
class Residual:
    """What the window has left."""

    rows: int | None = declare("rows of the window", "rows")
    residual_velocity: float = declare(
        "largest velocity along the chain of a bead when the window left it; 0 if it left none", "V"
    )
    bead: int = declare("number of that bead; 0 if the window left none")
    slowest_wave: float = declare(
        "amplitude of the lowest leading wave, which ``residual_velocity`` must not exceed",
        "V",
        "the window has not moved",
    )

    @property
    @derived()
    def sentence(self) -> str:
        """Whether anything could have caught up, in words."""
        if self.bead == 0:
            return "window: no residual motion behind it"
        found = f"window: residual velocity of the beads behind it {self.residual_velocity:.2g} V or less"
        if self.residual_velocity < self.slowest_wave:
            return f"{found}, every leading wave at {self.slowest_wave:.2g} V or more: nothing catches up"
        return (
            f"{found}, a leading wave at {self.slowest_wave:.2g} V only: what was left might catch up; take a wider "
            "window"
        )


class BehindWindow:
    """Collects what leaves the window of a run that is given block by block."""

    def __init__(self) -> None:
        self._velocity = 0.0
        self._bead = 0
        self._before: Trajectory | None = None

    def add(self, block: Trajectory) -> None:
        """Take the next frames."""
        before = self._before
        if before is not None and block.first > before.first:
            last = before.velocity[-1, :, : block.first - before.first].max(axis=0)
            if last.max() > self._velocity:
                self._velocity, self._bead = float(last.max()), int(before.beads[int(last.argmax())])
        self._before = block

    def result(self, waves: Waves) -> Residual:
        """Of the frames so far, against the leading waves."""
        window = self._before.problem.window if self._before is not None else None
        own = waves.peak_velocity[waves.bead > window // 2] if window is not None else waves.peak_velocity[:0]
        return Residual(window, self._velocity, self._bead, float(own.min()) if len(own) else math.nan)
