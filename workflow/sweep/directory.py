"""The directory of one case, and its computation: a run directory that also holds ``case.json``, what was asked for.

| key      | what                                                        |
|----------|-------------------------------------------------------------|
| swept    | field -> value                                              |
| scene    | the scene as asked: its ending at a bead, say, is not found yet |
| engine   | what computes                                               |
"""

import contextlib
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic_core import from_json

from lammps_inputs import InputError, Scene, file_names, library, strict_yaml
from workflow.engines.lammps import hosted
from workflow.formats import figure_files, written_as
from workflow.prepare.settings import found_beforehand
from workflow.runs import job
from workflow.runs.files import RECORD, write_json, write_text
from workflow.runs.own_files import claim, others, remove_leftovers
from workflow.runs.resume import resume
from workflow.runs.run import Run, run
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.analyse import analyse
from workflow.verdicts.analysis_report import REPORT
from workflow.workers.pool import Task

# --- directory --------------------------------------------------------------------------------------------------------

EARLIER = "case.json"
"""Where the request stood before ``run.json`` held it."""


@dataclass(frozen=True)
class Asked:
    """What a case was asked to be.

    Attributes:
        swept: field -> value.
        scene: plain data of the scene.
        engine: what computes.
    """

    swept: dict[str, Any]
    scene: dict[str, Any]
    engine: str

    def plain(self) -> dict[str, Any]:
        """For ``run.json``."""
        return {"swept": self.swept, "scene": self.scene, "engine": self.engine}


def read_json(path: Path) -> dict[str, Any]:
    """A JSON object from a file; empty if there is none or it is not one."""
    try:
        data = from_json(path.read_bytes(), allow_inf_nan=False)
    except (OSError, ValueError):
        return {}
    return data if isinstance(data, dict) else {}


def asked(path: Path) -> Asked | None:
    """What the case in a directory was asked to be; None if it is no case's directory."""
    data = job.account(path).request or read_json(path / EARLIER)
    swept, scene, engine = data.get("swept"), data.get("scene"), data.get("engine")
    if isinstance(swept, dict) and isinstance(scene, dict) and isinstance(engine, str):
        return Asked(swept, scene, engine)
    return None


def begin(path: Path, wanted: Asked, scene: Scene) -> None:
    """Make a case's directory; from then on it is a run directory that may be overwritten."""
    path.mkdir(parents=True, exist_ok=True)
    remove_leftovers(path)  # of a sweep that was killed
    claim(path, (file_names.SCENE,))
    job.update(path, request=wanted.plain())
    write_text(path / file_names.SCENE, strict_yaml.dump(scene.resolved().plain()))


def refuse_another(path: Path, wanted: Asked, scene: Scene) -> None:
    """See that a directory is not there, or this case's.

    Raises:
        InputError: it holds something else, or the same case of another scene or engine.
    """
    found = asked(path)
    if found is None:
        if path.is_dir() and (not (rest := others(path)) or (rest == {RECORD} and RECORD in job.account(path).files)):
            return  # interrupted before anything was written
        if path.exists() or path.is_symlink():
            raise InputError(f"{path}: exists and is not a case of a sweep; choose another -o")
        return
    advice = "choose another -o, or remove this directory"
    if found.engine != wanted.engine:
        raise InputError(f"{path}: is the same case computed by {found.engine}, not {wanted.engine}; {advice}")
    key = _first_difference(found.scene, wanted.scene)
    if key is None and (path / file_names.SCENE).is_file():
        try:
            written = library.load(path / file_names.SCENE).plain()
        except InputError:  # damaged: it is rewritten
            return
        resolved = scene.resolved().plain()
        key = _first_difference(written, resolved, found_beforehand(scene))
    if key is not None:
        raise InputError(f"{path}: holds this case of another scene ({key} differs); {advice}")


def _first_difference(one: dict[str, Any], other: dict[str, Any], ignored: Iterable[str] = ()) -> str | None:
    keys = [key for key in {**one, **other} if key not in ("limits", *ignored) and one.get(key) != other.get(key)]
    return keys[0] if keys else None


def is_analysed(path: Path, *, figures: bool = False) -> bool:
    """Whether a run that is done was analysed when it was, and drawn where that is asked for."""
    drawn = not figures or all((path / file).is_file() for file in figure_files("spacetime"))
    return drawn and read_json(path / REPORT).get("complete") is True


def note_failure(path: Path, reason: str) -> None:
    """Let ``run.json`` say why a case failed, where the run could not do so itself."""
    record = job.account(path)
    if path.is_dir() and record.outcome not in ("done", "failed"):
        write_json(path / RECORD, {**record.plain(), "outcome": "failed", "reason": reason})


# --- computation ------------------------------------------------------------------------------------------------------


def task(directory: Path, case: Asked | None, *, check: bool, figures: tuple[str, ...] = ()) -> Task:
    """For the worker pool.

    Args:
        directory: of the case, an absolute path.
        case: what to run first; None to analyse only what is there.
        check: whether to measure the error of a LAMMPS run.
        figures: formats of the figures to draw; none without any.
    """
    plain = None if case is None else case.plain()
    return Task(
        f"{__name__}:compute", {"directory": str(directory), "case": plain, "check": check, "figures": list(figures)}
    )


def compute(directory: str, case: dict[str, Any] | None, check: bool, figures: list[str]) -> str:
    """Run and analyse a case; "done" or "stopped"."""
    path = Path(directory)
    if case is not None:
        done = _run(path, Asked(**case), check=check)
        if done.outcome != "done":
            return "stopped"
        analysed = done.directory  # with the frames that were read for the check
    else:
        if check and (path / RECORD).is_file():
            resume(path)  # it is done, but perhaps its error was not measured any more
        analysed = RunDirectory(path)
    with written_as(tuple(figures)):
        analyse(analysed, figures=bool(figures))
    return "done"


def _run(directory: Path, case: Asked, *, check: bool) -> Run:
    """From the last restart if there is one; most cases take less time than passes until one is written."""
    if (directory / file_names.RESTART).is_file():
        with contextlib.suppress(InputError):  # not one to resume from
            resumed = resume(directory, check=check, lammps=hosted.run)
            if resumed is not None:
                return resumed
    scene = library.from_plain(case.scene, str(directory))
    begin(directory, case, scene)
    return run(scene, directory, engine=case.engine, overwrite=True, check=check, lammps=hosted.run)
