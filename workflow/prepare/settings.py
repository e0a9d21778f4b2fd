"""The duration and the time step of a scene, found and judged before anything is written or run."""

from dataclasses import asdict, dataclass
from typing import Any

from lammps_inputs import InputError, Problem, Scene
from lammps_inputs.limits.timestep import stability_bound
from lammps_inputs.numbers import memory


@dataclass(frozen=True)
class Settings:
    """How the time step of a scene that asks for an accuracy was chosen, dimensionless.

    Attributes:
        accuracy: asked for: largest error of any recorded velocity, in units of V.
        timestep: chosen.
        steps_per_frame: the same.
        reference_timestep: of a reference that is surer than the accuracy.
        expected_error: what the error is expected to be, in units of V.
        measured_error: what was measured beforehand: the same, or a larger one from which it was carried over.
        measured: share of the run's time over which that was measured; 0 where a law told it.
        limited: whether a longer step would have done, but for ``output.every`` or the stability bound.
        seconds: what the choice cost.
    """

    accuracy: float
    timestep: float
    steps_per_frame: int
    reference_timestep: float
    expected_error: float
    measured_error: float
    measured: float
    limited: bool
    seconds: float

    def plain(self) -> dict[str, Any]:
        """For ``run.json``."""
        return asdict(self)

    def sentence(self, problem: Problem) -> str:
        """What was chosen and why, in one line."""
        step = f"{self.timestep * problem.scale.time:.3g}"
        unit = f" {problem.scale.symbol('time')}" if problem.scale.si else ""
        if self.measured == 0.0:
            how = "from a law, for the scene is too large to measure beforehand"
        elif self.expected_error == self.measured_error:
            how = f"it leaves {self.expected_error:.1e} V, measured beforehand in {self.seconds:.1f} s"
        else:
            part = "" if self.measured == 1.0 else f" over 1/{1.0 / self.measured:.0f} of the time and beads"
            how = (
                f"it should leave less than {self.expected_error:.1e} V, by {self.measured_error:.1e} V measured "
                f"beforehand with another step{part} in {self.seconds:.1f} s"
            )
            if self.measured < 1.0 and problem.window is None and (problem.coupled or problem.gap > 0.0):
                how += "; beads left far behind may be off by more, for in long runs they amplify any error"
        longer = "; frames or stability allow no longer one" if self.limited else ""
        return f"accuracy {self.accuracy:g}: timestep {step}{unit}; {how}{longer}"


_DECK_BYTES = 250
"""Of memory, a bead that exists, to write a deck; measured."""


def refuse_too_large(scene: Scene, source: str, bytes_a_bead: float, what: str = "the deck") -> None:
    """Refuse what this machine's memory does not hold, before it is tried.

    Raises:
        InputError: naming the number of beads and what they need.
    """
    rows = scene.beads if not isinstance(scene.window, int) else min(scene.window, scene.beads)
    needed = bytes_a_bead * scene.chains * rows
    if scene.window != "auto" and needed > memory():
        raise InputError(
            f"{source}: beads: {scene.chains} x {rows:,} beads need {needed / 1e9:.3g} GB of memory for {what}, and "
            f"this machine has {memory() / 1e9:.3g}; take fewer, or a `window`"
        )


def settle(scene: Scene, *, source: str = "", force: bool = False) -> tuple[Scene, Settings | None]:
    """The scene with duration, window and time step written out, and how the step was chosen for an accuracy.

    Args:
        scene: as the user gave it.
        source: what the user calls the scene, for messages.
        force: whether a time step above the stability bound may pass.

    Raises:
        InputError: the end is not reached, the time step is unstable, or no step keeps the accuracy.
    """
    refuse_too_large(scene, source, _DECK_BYTES)
    if not force:
        refuse_unstable(scene, source)
    # what only some scenes ask for is loaded for those: numba alone takes a third of a second
    if scene.until_bead is not None:
        from workflow.prepare.duration import with_duration

        scene = with_duration(scene)
    if scene.window == "auto":
        from workflow.prepare.window import with_window

        scene = with_window(scene)
    if scene.accuracy is None:
        return scene, None
    from workflow.prepare.accuracy import with_timestep

    return with_timestep(scene, scene.accuracy, source)


def refuse_unstable(scene: Scene, source: str = "") -> None:
    """Say so before LAMMPS runs with a time step at which it blows up.

    Raises:
        InputError: the scene names a time step above the stability bound.
    """
    if scene.timestep is None:
        return
    scale = scene.scale
    problem = scene.model_copy(update={"until_bead": None, "duration": scale.time, "window": None}).problem()
    bound = stability_bound(problem, problem.scheme)
    if problem.timestep > bound * (1.0 + 1e-9):
        unit = f" {scale.symbol('time')}" if scale.si else ""
        raise InputError(
            f"{f'{source}: ' if source else ''}timestep: {scene.timestep:g}{unit} is unstable, above the bound of "
            f"{bound * scale.time:.3g}{unit}; take a tenth of that, or `accuracy: 1e-4` instead; "
            "--force of run and deck allows it, for study"
        )
