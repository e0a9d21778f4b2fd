"""What is known of a scene once it has run, by the names of a sweep's table; from the reference, or from any frames."""

import dataclasses
import json
import time
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np

from analysis import quantity
from analysis.conservation import Conservation
from analysis.motion import bead_energy, participation
from analysis.sharing.equipartition import sharing
from analysis.sharing.impulses import meter_of
from analysis.sharing.is_solitary import Tolerances
from analysis.sharing.survey import survey
from analysis.tracking.leading_waves import Waves, leading_waves, opposed
from analysis.tracking.peaks import PeakFinder
from analysis.trajectory import Trajectory, blocks, direction_of
from lammps_inputs import InputError, Problem, Scene, complaints, library, physics
from lammps_inputs.units import REDUCED, SI, Label
from workflow.engines.reference import engine
from workflow.engines.reference.energy_exchange import Accountant
from workflow.measures import MEASUREMENTS
from workflow.measures.base import Recorded
from workflow.prepare.extent import with_duration
from workflow.sweep import fields
from workflow.sweep.collect import AT_BEAD, QUANTITIES, at_bead, column_called, quantities
from workflow.verdicts.analysis_report import REPORT, ChainSummary, Report, report
from workflow.workers import evaluate

MASS = "mass"
"""Of all beads, in the scene's units: known before anything runs."""

_METERED = {kind.key: kind for kind in MEASUREMENTS if "meter" in vars(kind)}
"""Key of a measurement that only some runs have -> its type, where a meter takes it from the frames."""

_MEASURED = {name: _METERED[q.path[0]] for name, q in QUANTITIES.items() if q.path[0] in _METERED}
_AT_THE_END = tuple(name for name, kind in _MEASURED.items() if kind.key == "far_end")

_REPORTED = {"kicked", *(field.name for field in dataclasses.fields(Report))}
"""Parts of a report of every run."""

KNOWN = (
    MASS,
    *_AT_THE_END,
    *(
        name
        for name, q in QUANTITIES.items()
        if q.file == REPORT and q.label and name not in _AT_THE_END and q.path[0] in {*_METERED, *_REPORTED}
    ),
)
"""Quantities that a design may be about."""

_OF_SHARING = ("amplitude", "agree_10", "agree_1", "synchronised_1", "beat_length")

PARTICIPATION = "participation"

Measured = dict[str, float | None]
"""By name, in the scene's units; None where there is none."""


Masses = tuple[float | None, float | None]
"""The least and the largest; None for any."""

NO_LIMIT: Masses = (None, None)


def refuse_unknown(name: str, where: str, kind: str) -> None:
    """See that a quantity is one of `KNOWN`, or one of `AT_BEAD` at a bead.

    Raises:
        InputError: it is not; says where it was given and what it is not.
    """
    base, bead = at_bead(name)
    if base in AT_BEAD and not bead:
        raise InputError(f"{where}: {name[:60]!r} should end in the number of a bead, such as {base}@100")
    if not base and name not in KNOWN:
        hint = complaints.suggestion(name, KNOWN) or f"; known are {', '.join(KNOWN)}"
        raise InputError(f"{where}: {name[:60]!r} is no {kind}{hint}")


def heading(name: str, scene: dict[str, Any]) -> str:
    """A field of a scene, given as plain data, or a quantity, with its unit if it has one."""
    si = "material" in scene
    if name == MASS:
        unit = SI["mass"] if si else REDUCED
    else:
        column = column_called(name)
        unit = fields.unit(fields.parse(name, scene), scene) if column is None else column.unit(si=si)
    return name if unit in ("", REDUCED) else f"{name} ({unit})"


def label(name: str, scene: dict[str, Any]) -> Label:
    """Words, symbol and unit of a field of a scene, given as plain data, or of a quantity, for a figure or page."""
    si = "material" in scene
    if name == MASS:
        return Label("mass of all beads", "", SI["mass"] if si else REDUCED)
    column = column_called(name)
    return fields.label(fields.parse(name, scene), scene) if column is None else column.axis(si=si)


def mass_of(scene: Scene) -> float:
    """Mass of all beads, in the scene's units."""
    system, scale = scene.system, scene.scale
    return float(np.sum(np.broadcast_to(system.mass, (system.chains, system.beads)))) * scale.mass


def scene_to_run(plain: dict[str, Any], names: tuple[str, ...], source: str) -> Scene:
    """A scene with its end, all of whose beads are recorded; one that ends at a bead waits for the objective.

    Raises:
        InputError: it is none, or its end is not reached.
    """
    at_the_end = any(name in _AT_THE_END for name in names)
    output = {key: part for key, part in plain.get("output", {}).items() if key in ("forces", "spectra")}
    scene = with_duration(library.from_plain({**plain, "output": output}, source), wall=at_the_end)
    if scene.window is not None:
        raise InputError(f"{source}: window: rows behind it count here; leave it out")
    for name in names:
        if at_bead(name)[1] > scene.beads:
            raise InputError(f"{source}: {name}: the chains have {scene.beads} beads")
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
    values: dict[str, Any] = {}
    at_beads: dict[str, Any] = {}
    quick = _quick(problem, frames, scene, names) if _is_plain(problem) else {}
    run, asked_for = Recorded(scene, problem), {_MEASURED[name] for name in names if name in _MEASURED}
    meters = [meter for kind in MEASUREMENTS if kind in asked_for and (meter := kind.meter(run)) is not None]
    exchange = Accountant(problem)
    surveyed = None
    if any(kind.needs_survey for kind in asked_for) or any(name not in (MASS, *_MEASURED, *quick) for name in names):
        conservation, allowed = Conservation(), Tolerances()
        surveyed = survey(frames, problem, watchers=[conservation, *meters], tolerances=allowed, counted=exchange.of)
        values |= quantity.plain(report(surveyed, conservation, allowed), problem.scale)
        at_beads = _at_beads(surveyed.waves, problem, scene, names)
    elif meters:
        for block in frames():
            counted = physics.acted_on(problem.system) and block.exchange is None
            for meter in meters:
                meter.add(exchange.of(block) if counted else block)
    for measurement in filter(None, (meter.finish(surveyed) for meter in meters)):
        values[measurement.key] = measurement.plain()
    quantities_of_run = {**quantities(values, {}, scene.plain()), **quick, **at_beads, MASS: mass_of(scene)}
    return {name: None if quantities_of_run[name] is None else float(quantities_of_run[name]) for name in names}


def _at_beads(waves: Waves, problem: Problem, scene: Scene, names: tuple[str, ...]) -> dict[str, Any]:
    """Quantities of the kicked chain's leading wave at chosen beads."""
    by_name = {}
    for name, (base, bead) in ((name, at_bead(name)) for name in names if at_bead(name)[0]):
        summaries = [ChainSummary.of(waves.at(bead), problem, 1 + chain) for chain in range(problem.chains)]
        by_name[name] = quantities({"waves": quantity.plain(summaries, problem.scale)}, {}, scene.plain())[base]
    return by_name


def _is_plain(problem: Problem) -> bool:
    """Whether one pulse leads, away from bead 1, so that its waves need not be distinguished from others."""
    return direction_of(problem) > 0 and not opposed(problem) and not problem.system.loads


def _quick(
    problem: Problem, frames: Callable[[], Iterable[Trajectory]], scene: Scene, names: tuple[str, ...]
) -> dict[str, float | None]:
    """What an analysis finds of the leading waves and of the last frame, without all else that it looks for."""
    if not any(name in (*_OF_SHARING, PARTICIPATION) or at_bead(name)[0] for name in names):
        return {}
    finder, meter, last = PeakFinder(), meter_of(problem), None
    for last in frames():
        finder.add(last)
        if meter is not None:
            meter.add(last)
    waves = leading_waves(finder.result(), problem)
    quick: dict[str, float | None] = dict(_at_beads(waves, problem, scene, names))
    if set(names) & set(_OF_SHARING):
        shares = sharing(waves, problem, impulses=None if meter is None else meter.result())
        final, beat = shares.final, shares.regular_beat
        quick |= {
            "amplitude": None if final is None else final.value,
            "agree_10": shares.agrees_from(0.1),
            "agree_1": shares.agrees_from(0.01),
            "synchronised_1": shares.in_step_from(0.01),
            "beat_length": None if beat is None else beat.value,
        }
    if last is not None and problem.whole:
        energy = bead_energy(last.system_at(-1), last.displacement[-1], last.velocity[-1])
        quick[PARTICIPATION] = quantity.plain(participation(energy), problem.scale)
    return quick


def case(plain: dict[str, Any], names: Sequence[str], source: str, masses: Masses = NO_LIMIT) -> evaluate.Computation:
    """`evaluated` for the worker pool, under the key of what it computes."""
    limits = {} if masses == NO_LIMIT else {"masses": masses}
    return evaluate.case(f"{__name__}:evaluated", {"plain": plain, "names": tuple(names), "source": source, **limits})


def evaluated(plain: dict[str, Any], names: tuple[str, ...], source: str, masses: Masses = NO_LIMIT) -> dict[str, Any]:
    """What a process answers: ``quantities`` or ``refused``, and ``seconds`` of processor time.

    Args:
        plain: the scene.
        names: of the quantities.
        source: what to call the scene in messages.
        masses: of a scene whose mass is beyond them only that is measured, and nothing is run.
    """
    started = time.process_time()
    answer: dict[str, Any]
    try:
        outside = None if tuple(masses) == NO_LIMIT else _mass_outside(masses, plain, source)
        with np.errstate(all="ignore"):
            measured = by_reference(plain, names, source) if outside is None else {MASS: outside}
            answer = {"quantities": json.loads(json.dumps(measured))}
    except (InputError, ValueError, ArithmeticError) as error:
        answer = {"refused": str(error)}
    return {**answer, "seconds": time.process_time() - started}


def _mass_outside(masses: Masses, plain: dict[str, Any], source: str) -> float | None:
    """The mass of a scene that is outside its limits; else None."""
    low, high = masses
    mass = mass_of(library.from_plain(plain, source))
    return None if (low is None or low <= mass) and (high is None or mass <= high) else mass
