"""The duration and the time step of a scene, determined and checked before anything is written or run."""

from lammps_inputs import InputError, Scene, physics
from lammps_inputs.limits.rates import stability_bound
from lammps_inputs.numbers import machine_memory
from lammps_inputs.output import too_far_apart
from lammps_inputs.scene import DEFAULT_ACCURACY
from workflow.prepare.step_choice import ChosenStep
from workflow.processor_time import limited

_DECK_BYTES = 250
"""Memory in bytes to write a deck, for each bead that exists; measured."""


def refuse_too_large(scene: Scene, source: str, bytes_a_bead: float = _DECK_BYTES, purpose: str = "the deck") -> None:
    """Refuse what this machine's memory does not hold, before it is tried.

    Raises:
        InputError: naming the number of beads and what they need.
    """
    rows = scene.beads if not isinstance(scene.window, int) else min(scene.window, scene.beads)
    needed = bytes_a_bead * scene.chains * rows
    if scene.window != "auto" and needed > machine_memory():
        raise InputError(
            f"{source}: beads: {scene.chains} x {rows:,} beads need {needed / 1e9:.3g} GB of memory for {purpose}, and "
            f"this machine has {machine_memory() / 1e9:.3g}; take fewer, or a `window`"
        )


def refuse_unanalysable(scene: Scene, source: str = "") -> None:
    """Refuse a scene whose run `granchain analyze` could not analyse.

    Raises:
        InputError: its frames are too far apart to find waves between them.
    """
    every = (scene.output.every or 0.0) / scene.scale.time
    if why := too_far_apart(every, scene.scale, physics.pulse_time(scene.system)):
        raise InputError(f"{f'{source}: ' if source else ''}output.every: {why}")


def found_beforehand(scene: Scene) -> set[str]:
    """Keys that `settle` writes, so that the ``scene.yaml`` of a run has others than the scene that was given."""
    keys = set() if scene.until_bead is None else {"until_bead", "duration"}
    keys |= set() if scene.timestep is not None else {"accuracy", "timestep"}
    return keys | ({"window"} if scene.window == "auto" else set())


def settle(
    scene: Scene, *, source: str = "", force: bool = False, own_step: bool = True
) -> tuple[Scene, ChosenStep | None]:
    """The scene with duration, window and time step written out, and how the step was chosen where none is named.

    Args:
        scene: as the user gave it.
        source: what the user calls the scene, for messages.
        force: whether a time step above the stability bound may pass.
        own_step: whether the engine that is to run takes the scene's time step.

    Returns:
        The scene, and the choice of its step; None where the scene names one.

    Raises:
        InputError: the end is not reached, the time step is unstable, or no step keeps the accuracy.

    Examples:
        >>> scene, chosen = settle(granchain.load("one-chain", {"beads": 20, "duration": 30.0}))
        >>> round(scene.timestep, 4), chosen.accuracy
        (0.0111, 0.0002)
    """
    refuse_too_large(scene, source)
    if own_step and not force:
        refuse_unstable(scene, source)
    with limited():  # all trials together
        return _tried(scene, source, own_step=own_step)


def _tried(scene: Scene, source: str, *, own_step: bool) -> tuple[Scene, ChosenStep | None]:
    """The scene with what it leaves open, found by trials."""
    # what only some scenes ask for is loaded for those: numba alone takes a third of a second
    if scene.until_bead is not None:
        from workflow.prepare.duration import with_duration

        scene = with_duration(scene)
    if scene.window == "auto":
        from workflow.prepare.window_width import with_window

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
