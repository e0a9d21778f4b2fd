"""Runs that a study keeps in its directory."""

from pathlib import Path

from lammps_inputs import InputError, Scene, file_names
from lammps_inputs.scene import DEFAULT_ACCURACY
from workflow.runs.engines import engine_called
from workflow.runs.run import run
from workflow.runs.run_directory import RunDirectory


def kept_run(scene: Scene, engine: str, path: Path) -> RunDirectory:
    """Run a scene, or take the run that an earlier start finished.

    Args:
        scene: the scene.
        engine: name of the engine.
        path: run directory.

    Returns:
        The run directory.

    Raises:
        RunError: the run failed.

    Examples:
        >>> scene = granchain.load("one-chain", {"beads": 20, "duration": 30.0})
        >>> first = kept_run(scene, "reference", tmp / "run")
        >>> kept_run(scene, "reference", tmp / "run").job.started == first.job.started  # it was not run again
        True
    """
    finished = _finished(path, scene, engine)
    if finished is not None:
        return finished
    done = run(scene, path, engine=engine, overwrite=True)
    if done.outcome != "done":
        raise KeyboardInterrupt
    return done.directory


def _finished(path: Path, scene: Scene, engine: str) -> RunDirectory | None:
    """An earlier run of just this scene that came to its end."""
    if not (path / file_names.SCENE).is_file():
        return None
    directory = RunDirectory(path)
    job = directory.job
    done = job.engine == engine and engine_called(engine).is_complete(job)
    return directory if done and _is_of(directory, scene) else None


def _is_of(directory: RunDirectory, scene: Scene) -> bool:
    """Whether a run is of this scene, with a time step for the same accuracy where the scene names none."""
    settings, chosen_keys = directory.job.settings, set()
    if scene.timestep is None and engine_called(directory.engine).own_step:
        if settings is None or settings.accuracy != (scene.accuracy or DEFAULT_ACCURACY):
            return False
        chosen_keys = {"accuracy", "timestep"}
    try:
        run_keys, scene_keys = (either.resolved().plain() for either in (directory.scene, scene))
    except InputError:  # damaged
        return False
    return all(run_keys.get(key) == scene_keys.get(key) for key in {*run_keys, *scene_keys} - chosen_keys)
