"""How the time step of a scene was chosen, and what a pilot run leaves for the check of the run."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, fields, replace
from typing import TYPE_CHECKING, Any

from analysis.compare.difference import Uncertainty
from lammps_inputs import Problem, physics
from workflow.processor_time import BEFORE_RUN

if TYPE_CHECKING:  # what the engine imports takes a third of a second
    from analysis.trajectory import Trajectory


@dataclass(frozen=True)
class ReferenceFrames:
    """An accurate run of the reference, in memory."""

    frames: tuple["Trajectory", ...]
    uncertainty: "Uncertainty"

    def is_of(self, problem: Problem) -> bool:
        """Whether these are the frames of a problem: the same beads at the same times."""
        mine = self.frames[0].problem
        same = (mine.frames, mine.rows) == (problem.frames, problem.rows)
        return same and math.isclose(mine.every, problem.every, rel_tol=1e-9)

    def blocks(self) -> Iterator["Trajectory"]:
        """Consecutive blocks of the frames, as `StepHalving.blocks` yields them."""
        return iter(self.frames)

    def of(self, problem: Problem) -> "ReferenceFrames":
        """The frames as those of a problem that differs in its time step alone."""
        return replace(self, frames=tuple(replace(block, problem=problem) for block in self.frames))


@dataclass(frozen=True)
class ChosenStep:
    """How the time step of a scene that names none was chosen, dimensionless.

    Attributes:
        accuracy: largest error of any recorded velocity, in units of V: of the scene, or the default.
        timestep: chosen time step, in units of T.
        steps_per_frame: chosen steps from frame to frame.
        reference_timestep: time step of a reference whose uncertainty is a fraction of the accuracy.
        expected_error: what the error is expected to be, in units of V.
        measured_error: error in the pilot run: the expected one, or a larger one from which that was carried over.
        measured: share of the run's time over which that was measured; 0 where the rule gave the step.
        limited: whether a longer step would have done, but for ``output.every``, the energy or the stability bound.
        seconds: processor time of the choice without compilation, in s.
        asked: whether the scene names the accuracy.
        unreached: why no step keeps the default accuracy, where none does.
        rule_timestep: step for the accuracy by the rule (`lammps_inputs.limits.rates.timestep_for`); NaN
            while a pilot run tries steps.
        reference: frames of the pilot run's reference, for the check of the run; not recorded.
    """

    accuracy: float
    timestep: float
    steps_per_frame: int
    reference_timestep: float
    expected_error: float
    measured_error: float
    measured: float
    limited: bool
    seconds: float = 0.0
    asked: bool = True
    unreached: str = ""
    rule_timestep: float = math.nan
    reference: ReferenceFrames | None = field(default=None, repr=False, compare=False)

    def plain(self) -> dict[str, Any]:
        """Plain data of the choice, for ``run.json``."""
        return {part.name: getattr(self, part.name) for part in fields(self) if part.name != "reference"}

    def sentence(self, problem: Problem) -> str:
        """What was chosen and why, in one line."""
        step = problem.scale.written(self.timestep, "time", ".3g")
        pilot = f"pilot run ({self.seconds:.1f} s of processor time)"
        if self.unreached:
            how = f"given by a rule, not measured, since {self.unreached}"
        elif self.measured == 0.0:
            how = (
                "given by a rule, not measured, since a pilot run would take more than "
                f"{BEFORE_RUN:.0f} s of processor time"
            )
        elif self.expected_error == self.measured_error:
            how = f"error {self.expected_error:.1e} V in a {pilot}"
        else:
            part = "" if self.measured == 1.0 else f" over 1/{1.0 / self.measured:.0f} of the time and beads"
            how = (
                f"error expected below {self.expected_error:.1e} V, extrapolated from {self.measured_error:.1e} V with "
                f"another time step{part} in a {pilot}"
            )
            if (
                self.measured < 1.0
                and not problem.rows.follow
                and (physics.coupled(problem.system) or physics.gap(problem.system) > 0.0)
            ):
                how += "; errors are larger behind the front in a long run, where repeated contacts amplify them"
        if not self.unreached and self.timestep < _USUAL * self.rule_timestep:
            how += (
                f"; it is {self.rule_timestep / self.timestep:.0f} times as short as where errors grow in proportion "
                "to time, as repeated contacts or growing oscillations amplify them; a larger `accuracy` allows a "
                "longer step"
            )
        longer = "; the frames, the energy or stability allow no longer one" if self.limited else ""
        accuracy = "accuracy of the scene" if self.asked else "default accuracy"
        return f"time step {step}, for an error of velocities up to {self.accuracy:g} V ({accuracy}): {how}{longer}"


_USUAL = 0.2
"""Part of the step by the rule, which is for errors that grow in proportion to time, that is rarely too long."""
