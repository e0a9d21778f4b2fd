"""Directory of a case of a sweep: the request in it, and whether its run was analysed.

The ``run.json`` of a case also holds what was asked for, under ``request``:

| key      | what                                                        |
|----------|-------------------------------------------------------------|
| swept    | field -> value                                              |
| scene    | the scene as asked: its ending at a bead, say, is not found yet |
| engine   | what computes                                               |
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic_core import from_json

from workflow import formats
from workflow.runs import job
from workflow.verdicts.analysis_report import REPORT
from workflow.workers.pool import Task


@dataclass(frozen=True)
class CaseRequest:
    """Request of a case.

    Attributes:
        swept: field -> value.
        scene: plain data of the scene.
        engine: what computes.
    """

    swept: dict[str, Any]
    scene: dict[str, Any]
    engine: str

    def plain(self) -> dict[str, Any]:
        """Plain data of the request, for ``run.json``."""
        return {"swept": self.swept, "scene": self.scene, "engine": self.engine}


def read_json(path: Path) -> dict[str, Any]:
    """A JSON object from a file; empty if there is none or it is not one."""
    try:
        data = from_json(path.read_bytes(), allow_inf_nan=False)
    except (OSError, ValueError):
        return {}
    return data if isinstance(data, dict) else {}


def request_of(path: Path) -> CaseRequest | None:
    """Request of the case in a directory; None if it is no case's directory."""
    data = job.account(path).request or {}
    swept, scene, engine = data.get("swept"), data.get("scene"), data.get("engine")
    if isinstance(swept, dict) and isinstance(scene, dict) and isinstance(engine, str):
        return CaseRequest(swept, scene, engine)
    return None


def is_analysed(path: Path, *, figures: bool = False) -> bool:
    """Whether a run that is done was analysed when it was, and drawn where that is asked for."""
    drawn = not figures or all((path / file).is_file() for file in formats.figure_files("spacetime"))
    return drawn and read_json(path / REPORT).get("complete") is True


def task(directory: Path, case: CaseRequest | None, *, check: bool, figures: tuple[str, ...] = ()) -> Task:
    """The task of a case, for the worker pool.

    Args:
        directory: of the case, an absolute path.
        case: what to run first; None to analyse only what is there.
        check: whether to measure the error of a LAMMPS run.
        figures: formats of the figures to draw, of the width that is asked for now; none without any.
    """
    plain = None if case is None else case.plain()
    drawn = {"figures": list(figures), "width": formats.width_asked()}
    return Task(
        "workflow.sweep.run_sweep:compute", {"directory": str(directory), "case": plain, "check": check, **drawn}
    )
