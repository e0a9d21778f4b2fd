"""What is known of a scene once it has run, by the names of a sweep's table; from the reference, or from any frames."""

import json
import time
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from analysis import quantity
from analysis.conservation import Conservation
from analysis.gauges.far_end import FarEnd
from analysis.mirror import direction_of
from analysis.sharing.equipartition import sharing
from analysis.sharing.is_solitary import Tolerances
from analysis.sharing.survey import survey
from analysis.tracking.leading_waves import beyond_kicks, leading_waves, opposed, usual_arrival
from analysis.tracking.peaks import PeakFinder
from analysis.trajectory import Trajectory, blocks
from lammps_inputs import InputError, Problem, Scene, library, physics
from lammps_inputs.units import REDUCED, SI
from workflow.engines.reference import engine
from workflow.engines.reference.energy_exchange import Accountant
from workflow.prepare.extent import with_duration
from workflow.sweep import fields
from workflow.sweep.collect import quantities
from workflow.sweep.table import QUANTITIES
from workflow.verdicts.analysis_report import REPORT, report

MASS = "mass"
"""Of all beads, in the scene's units: known before anything runs."""

_AT_THE_END = tuple(name for name, quantity in QUANTITIES.items() if quantity.path[0] == "far_end")

KNOWN = (
    MASS,
    *_AT_THE_END,
    *(
        name
        for name, q in QUANTITIES.items()
        if q.file == REPORT and q.label and name not in _AT_THE_END and q.path[0] != "spectra"
    ),
)
"""Quantities that a design may be about."""

_OF_SHARING = ("amplitude", "agree_10", "agree_1", "in_step_1", "beat_length")

Measured = dict[str, float | None]
"""By name, in the scene's units; None where there is none."""


def refuse_unknown(name: str, where: str, what: str) -> None:
    """See that a quantity is one of `KNOWN`.

    Raises:
        InputError: it is not; says where it was given and what it is not.
    """
    if name not in KNOWN:
        hint = library.suggestion(name, KNOWN) or f"; known are {', '.join(KNOWN)}"
        raise InputError(f"{where}: {name[:60]!r} is no {what}{hint}")


def heading(name: str, scene: dict[str, Any]) -> str:
    """A field of a scene, given as plain data, or a quantity, with its unit if it has one."""
    si = "material" in scene
    if name == MASS:
        unit = SI["mass"] if si else REDUCED
    else:
        unit = QUANTITIES[name].unit(si=si) if name in QUANTITIES else fields.unit(fields.parse(name), scene)
    return name if unit in ("", REDUCED) else f"{name} ({unit})"


def mass_of(scene: Scene) -> float:
    """Of all beads, in the scene's units."""
    system, scale = scene.system, scene.scale
    return float(np.sum(np.broadcast_to(system.mass, (system.chains, system.beads)))) * scale.mass


def scene_to_run(plain: dict[str, Any], names: tuple[str, ...], source: str) -> Scene:
    """A scene with its end, all of whose beads are recorded; one that ends at a bead waits for the objective.

    Raises:
        InputError: it is none, or its end is not reached.
    """
    at_the_end = any(name in _AT_THE_END for name in names)
    scene = with_duration(library.from_plain({**plain, "output": {}}, source), wall=at_the_end)
    if scene.window is not None:
        raise InputError(f"{source}: window: rows behind it count here; leave it out")
    return scene


def by_reference(plain: dict[str, Any], names: tuple[str, ...], source: str) -> Measured:
    """Quantities of a scene, run by the reference.

    Raises:
        InputError: as `scene_to_run`.
    """
    scene = scene_to_run(plain, names, source)
    problem = scene.model_copy(update={"accuracy": None}).problem()
    trajectory = engine.run(problem)
    return of_frames(problem, lambda: blocks(trajectory), scene, names)


def of_frames(
    problem: Problem, frames: Callable[[], Iterable[Trajectory]], scene: Scene, names: tuple[str, ...]
) -> Measured:
    """Quantities of a run; ``frames`` reads it again."""
    found: dict[str, Any] = {}
    quick = _shared(problem, frames) if set(names) & set(_OF_SHARING) and _is_plain(problem) else {}
    if any(name in _AT_THE_END for name in names):
        end, count = FarEnd(problem), Accountant(problem).of
        for block in frames():
            end.add(count(block) if physics.acted_on(problem.system) and block.exchange is None else block)
        found["far_end"] = quantity.plain(end.result(), problem.scale)
    if any(name not in (MASS, *_AT_THE_END, *quick) for name in names):
        seen, allowed, count = Conservation(), Tolerances(), Accountant(problem).of
        surveyed = survey(frames, problem, watchers=[seen], tolerances=allowed, counted=count)
        found |= quantity.plain(report(surveyed, seen, allowed), problem.scale)
    known = {**quantities(found, {}, scene.plain()), **quick, MASS: mass_of(scene)}
    return {name: None if known[name] is None else float(known[name]) for name in names}


def _is_plain(problem: Problem) -> bool:
    """Whether one pulse leads, away from bead 1, so that its waves need not be distinguished from others."""
    return direction_of(problem) > 0 and not opposed(problem) and not problem.system.loads


def _shared(problem: Problem, frames: Callable[[], Iterable[Trajectory]]) -> dict[str, float | None]:
    """What an analysis finds of how the chains share the pulse, without all else that it looks for."""
    finder = PeakFinder()
    for block in frames():
        finder.add(block)
    found = sharing(leading_waves(beyond_kicks(finder.result(), problem), usual_arrival(problem)), problem)
    final, beat = found.final, found.beat_length
    values = (
        None if final is None else final.value,
        found.agrees_from(0.1),
        found.agrees_from(0.01),
        found.in_step_from(0.01),
        None if beat is None else beat.value,
    )
    return dict(zip(_OF_SHARING, values, strict=True))


def evaluated(plain: dict[str, Any], names: tuple[str, ...], source: str) -> dict[str, Any]:
    """What a process answers: ``quantities`` or ``refused``, and ``seconds`` of processor time."""
    started = time.process_time()
    answer: dict[str, Any]
    try:
        with np.errstate(all="ignore"):
            answer = {"quantities": json.loads(json.dumps(by_reference(plain, names, source)))}
    except (InputError, ValueError, ArithmeticError) as error:
        answer = {"refused": str(error)}
    return {**answer, "seconds": time.process_time() - started}
