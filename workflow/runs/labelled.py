"""The run of a directory as an `xarray.Dataset`, with its error and its origin as attributes.

Examples:
    >>> labelled.need("export", "numpy")
    >>> labelled.need("export", "no_such_module")
    Traceback (most recent call last):
        ...
    lammps_inputs.errors.InputError: export: needs no_such_module, not installed here; `pip install 'granchain[export]'`
"""

import importlib.util
import json
from collections.abc import Iterator
from typing import Any

from analysis import labelled
from analysis.trajectory import Trajectory
from lammps_inputs import InputError, strict_yaml
from workflow.runs.run_directory import RunDirectory

EXTRA = "granchain[export]"
"""Installs all that exports need."""


def need(purpose: str, *packages: str) -> None:
    """See that packages are installed.

    Args:
        purpose: what needs them, for the message.
        *packages: names of modules.

    Raises:
        InputError: one is not.
    """
    absent = [name for name in packages if importlib.util.find_spec(name) is None]
    if absent:
        raise InputError(f"{purpose}: needs {' and '.join(absent)}, not installed here; `pip install '{EXTRA}'`")


def dataset(directory: RunDirectory, block: Trajectory) -> Any:
    """Frames of a run as an ``xarray.Dataset``; see `analysis.labelled.dataset`.

    Args:
        directory: the run.
        block: all of its frames, or some.

    Returns:
        The dataset in the scene's units, with the attributes of `attributes`.

    Raises:
        InputError: xarray is not installed.
    """
    need("dataset", "xarray")
    return labelled.dataset(block, attributes(directory))


def attributes(directory: RunDirectory) -> dict[str, Any]:
    """Attributes of a dataset: what was run, with what, and its error; those that are not known are left out."""
    scene, problem, job = directory.scene, directory.problem, directory.account
    values: dict[str, Any] = {
        "title": scene.name,
        "comment": scene.description,
        "units": "SI" if problem.scale.si else "reduced",
        "scene": strict_yaml.dump(scene.plain()),
        "engine": directory.engine,
        "outcome": job.outcome,
        "source": ", ".join(f"{name} {version}" for name, version in (job.versions or {}).items()),
        "history": "" if job.started is None else f"{job.started}: {' '.join(job.command or ())}",
        "machine": job.machine,
        "frames_sha256": directory.fingerprint,
    }
    scale = problem.scale
    values |= {f"{name}_scale": getattr(scale, name) for name in ("mass", "length", "velocity", "time")}
    values |= dict(_errors(directory))
    return {name: value for name, value in values.items() if value not in (None, "")}


def _errors(directory: RunDirectory) -> Iterator[tuple[str, Any]]:
    """Name and value of the errors of a run, in the scene's units; of the reference's own run its uncertainty."""
    job, scale = directory.account, directory.problem.scale
    check = job.check
    uncertainty = job.uncertainty if check is None else check.reference
    if check is not None and check.velocity is not None:
        yield "velocity_error", check.velocity * scale.velocity
        yield "velocity_error_meaning", "largest distance of a velocity from the reference integrator"
    if check is not None and check.where is not None:
        yield "velocity_error_where", json.dumps(check.where.plain())
    if uncertainty is not None and uncertainty.velocity is not None:
        yield "velocity_uncertainty", uncertainty.velocity * scale.velocity
        yield "velocity_uncertainty_meaning", "uncertainty of velocities of the reference integrator, by step halving"
