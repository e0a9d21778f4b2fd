"""The duration and the time step of a scene, determined and checked before anything is written or run."""

from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any

from lammps_inputs import InputError, Problem, Scene, physics
from lammps_inputs.limits.rates import stability_bound
from lammps_inputs.numbers import memory
from lammps_inputs.scene import DEFAULT_ACCURACY

if TYPE_CHECKING:
    from workflow.prepare.pilot import Kept


@dataclass(frozen=True)
class Settings:
    """How the time step of a scene that names none was chosen, dimensionless.

    Attributes:
        accuracy: largest error of any recorded velocity, in units of V: of the scene, or the default.
        timestep: chosen.
        steps_per_frame: the same.
        reference_timestep: of a reference whose uncertainty is a fraction of the accuracy.
        expected_error: what the error is expected to be, in units of V.
        measured_error: of the pilot run: the same, or a larger one from which it was carried over.
        measured: share of the run's time over which that was measured; 0 where the rule gave the step.
        limited: whether a longer step would have done, but for ``output.every``, the energy or the stability bound.
        seconds: what the choice cost, the compiler apart.
        asked: whether the scene names the accuracy.
        unreached: why no step keeps the default accuracy, where none does.
        rule_timestep: step for the accuracy by the rule (`lammps_inputs.limits.rates.timestep_for`); None in records
            of earlier versions.
        reference: the pilot run's, for the check of the run; not recorded.
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
    rule_timestep: float | None = None
    reference: "Kept | None" = field(default=None, repr=False, compare=False)

    def plain(self) -> dict[str, Any]:
        """For ``run.json``."""
        return {part.name: getattr(self, part.name) for part in fields(self) if part.name != "reference"}

    def sentence(self, problem: Problem) -> str:
        """What was chosen and why, in one line."""
        step = problem.scale.written(self.timestep, "time", ".3g")
        pilot = f"pilot run ({self.seconds:.1f} s of wall time)"
        if self.unreached:
            how = f"by a rule, not measured, since {self.unreached}"
        elif self.measured == 0.0:
            how = "by a rule, not measured: the scene is too large for a pilot run"
        elif self.expected_error == self.measured_error:
            how = f"error {self.expected_error:.1e} V in a {pilot}"
        else:
            part = "" if self.measured == 1.0 else f" over 1/{1.0 / self.measured:.0f} of the time and beads"
            how = (
                f"error expected below {self.expected_error:.1e} V, from {self.measured_error:.1e} V with another "
                f"step{part} in a {pilot}"
            )
            if (
                self.measured < 1.0
                and problem.window is None
                and (physics.coupled(problem.system) or physics.gap(problem.system) > 0.0)
            ):
                how += "; larger behind the front in a long run, where repeated contacts amplify errors"
        if not self.unreached and self.rule_timestep is not None and self.timestep < _USUAL * self.rule_timestep:
            how += (
                f"; {self.rule_timestep / self.timestep:.0f} times as short as where errors grow in proportion to "
                "time: repeated contacts or growing oscillations amplify them; a larger `accuracy` allows a longer step"
            )
        longer = "; frames, energy or stability allow no longer step" if self.limited else ""
        default = "" if self.asked else " (default)"
        return f"accuracy {self.accuracy:g} V{default}: timestep {step}, {how}{longer}"


_USUAL = 0.2
"""Part of the step by the rule, which is for errors that grow in proportion to time, that is rarely too long."""

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


def found_beforehand(scene: Scene) -> set[str]:
    """Keys that `settle` writes, so that the ``scene.yaml`` of a run has others than the scene that was given."""
    found = set() if scene.until_bead is None else {"until_bead", "duration"}
    found |= set() if scene.timestep is not None else {"accuracy", "timestep"}
    return found | ({"window"} if scene.window == "auto" else set())


def settle(
    scene: Scene, *, source: str = "", force: bool = False, own_step: bool = True
) -> tuple[Scene, Settings | None]:
    """The scene with duration, window and time step written out, and how the step was chosen where none is named.

    Args:
        scene: as the user gave it.
        source: what the user calls the scene, for messages.
        force: whether a time step above the stability bound may pass.
        own_step: whether the engine that is to run takes the scene's time step.

    Raises:
        InputError: the end is not reached, the time step is unstable, or no step keeps the accuracy.
    """
    refuse_too_large(scene, source, _DECK_BYTES)
    if own_step and not force:
        refuse_unstable(scene, source)
    # what only some scenes ask for is loaded for those: numba alone takes a third of a second
    if scene.until_bead is not None:
        from workflow.prepare.extent import with_duration

        scene = with_duration(scene)
    if scene.window == "auto":
        from workflow.prepare.extent import with_window

        scene = with_window(scene)
    if scene.timestep is not None or (scene.accuracy is None and not own_step):
        return scene, None
    from workflow.prepare.pilot import with_timestep

    return with_timestep(scene, source)


def refuse_unstable(scene: Scene, source: str = "") -> None:
    """Say so before LAMMPS runs with a time step at which it blows up.

    Raises:
        InputError: the scene names a time step above the stability bound.
    """
    if why := unstable(scene):
        raise InputError(f"{f'{source}: ' if source else ''}{why}")


def unstable(scene: Scene) -> str:
    """Why the time step that a scene names is unstable; empty where it is stable or none is named."""
    if scene.timestep is None:
        return ""
    scale = scene.scale
    problem = scene.model_copy(update={"until_bead": None, "duration": scale.time, "window": None}).problem()
    bound = stability_bound(problem.system, problem.scheme)
    if problem.timestep <= bound * (1.0 + 1e-9):
        return ""
    return (
        f"timestep: {scene.timestep:g}{scale.after('time')} is unstable, "
        f"above the bound of {scale.written(bound, 'time', '.3g')}; leave it out for an accuracy of "
        f"{DEFAULT_ACCURACY:g} V; --force of run and deck allows it, for study"
    )
