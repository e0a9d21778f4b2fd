"""The runs that a study needs, each in a directory of its own, kept from an earlier start if it came to its end."""

from pathlib import Path

from lammps_inputs import InputError, Scene, file_names
from lammps_inputs.scene import DEFAULT_ACCURACY
from workflow.prepare.settings import Settings
from workflow.runs.engines import ENGINES
from workflow.runs.run import run
from workflow.runs.run_directory import RunDirectory


def kept_run(scene: Scene, engine: str, path: Path, settings: Settings | None = None) -> RunDirectory:
    """Run a scene, or take the run that an earlier start finished.

    Args:
        scene: what to run.
        engine: its name.
        path: of its run directory.
        settings: how the scene's time step was chosen, where it was before.

    Raises:
        RunError: the run failed.
    """
    kept = _finished(path, scene, engine)
    if kept is not None:
        return kept
    done = run(scene, path, engine=engine, overwrite=True, settings=settings)
    if done.outcome != "done":
        raise KeyboardInterrupt
    return done.directory


def _finished(path: Path, scene: Scene, engine: str) -> RunDirectory | None:
    """An earlier run of just this scene that came to its end."""
    if not (path / file_names.SCENE).is_file():
        return None
    directory = RunDirectory(path)
    job = directory.job
    checked = ENGINES[engine].errors(job) is not None or not ENGINES[engine].deforms
    done = checked and job.outcome == "done" and job.engine == engine
    return directory if done and _is_of(directory, scene) else None


def _is_of(directory: RunDirectory, scene: Scene) -> bool:
    """Whether a run is of this scene, with a time step for the same accuracy where the scene names none."""
    settings, found = directory.job.settings, set()
    if scene.timestep is None and ENGINES[directory.engine].own_step:
        if settings is None or settings.accuracy != (scene.accuracy or DEFAULT_ACCURACY):
            return False
        found = {"accuracy", "timestep"}
    try:
        own, asked = (one.resolved().plain() for one in (directory.scene, scene))
    except InputError:  # damaged
        return False
    return all(own.get(key) == asked.get(key) for key in {*own, *asked} - found)
