"""Numbers of quantities of a scene, run by the reference in memory, or of any frames: only what is asked is computed.

They come from the declarations that ``analysis.json`` is written from. An uncertainty covers the time between frames
alone, as the error of such a run is not measured.

Plug-ins take this module for numbers by name: `of_scene` runs a scene, `of_frames` measures frames, `case` is a
computation of a study in a worker process.

Examples:
    >>> scene = granchain.load("one-chain", {"beads": 20, "duration": 30.0})
    >>> numbers = evaluate.of_scene(scene.plain(), ("peak_velocity@10", "speed", "beat_length"), "scene")
    >>> {name: value if value is None else round(value, 3) for name, value in numbers.items()}
    {'peak_velocity@10': 0.682, 'speed': 0.841, 'beat_length': None}
"""

import json
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from analysis.conservation import Conservation, ConservationMeter
from analysis.quantity import in_units, plain_at
from analysis.sharing.is_solitary import Tolerances
from analysis.sharing.survey import Survey
from analysis.tracking.leading_waves import usual_arrival
from analysis.trajectory import Floats, Trajectory, joined
from lammps_inputs import InputError, Problem, Scene, library, physics
from lammps_inputs.numbers import known
from workflow.measures.measurement import Measurement, Recorded
from workflow.prepare.duration import with_duration
from workflow.quantities.columns import AT_THE_END, MASS, MEASURED, QUANTITIES, at_bead, kicked_chain
from workflow.runs.engines import engine_called
from workflow.verdicts.analysis_report import WAVES, LeadingWave, Report
from workflow.workers.computations import Computation
from workflow.workers.computations import case as computation

Measured = dict[str, float | None]
"""Numbers by name, in the scene's units; None where there is none."""

Masses = tuple[float | None, float | None]
"""The least and the largest mass; None for any."""

NO_LIMIT: Masses = (None, None)

_OF_FRAMES = ("every", "beads")
"""Keys of ``output`` that say which frames, and which beads in them, are written: these do not count here."""


def mass_of(scene: Scene) -> float:
    """Mass of all beads, in the scene's units."""
    system, scale = scene.system, scene.scale
    return float(np.sum(np.broadcast_to(system.mass, (system.chains, system.beads)))) * scale.mass


def scene_to_run(plain: dict[str, Any], names: tuple[str, ...], source: str) -> Scene:
    """A scene with its end, all of whose beads are recorded; one that ends at a bead waits for the objective.

    Args:
        plain: plain data of the scene.
        names: names of the quantities that are wanted of its run.
        source: what to call the scene in messages.

    Returns:
        The scene.

    Raises:
        InputError: it is none, or its end is not reached.
    """
    at_the_end = any(name in AT_THE_END for name in names)
    output = {key: part for key, part in plain.get("output", {}).items() if key not in _OF_FRAMES}
    scene = with_duration(library.from_plain({**plain, "output": output}, source), wall=at_the_end)
    if scene.window is not None:
        raise InputError(f"{source}: window: rows behind it count here; leave it out")
    for name in names:
        if at_bead(name)[1] > scene.beads:
            raise InputError(f"{source}: {name}: the chains have {scene.beads} beads")
    return scene


def of_scene(plain: dict[str, Any], names: tuple[str, ...], source: str) -> Measured:
    """Quantities of a scene, run by the reference.

    Args:
        plain: plain data of the scene.
        names: names of the quantities, such as ``peak_velocity@100``.
        source: what to call the scene in messages.

    Returns:
        Name -> number in the unit of its declaration, V and T those of the scene; None where it is undefined.

    Raises:
        InputError: as `scene_to_run`.
    """
    scene = scene_to_run(plain, names, source)
    problem = scene.model_copy(update={"accuracy": None}).problem()
    trajectory = joined(engine_called("reference").blocks(problem))
    return of_frames(problem, trajectory.blocks, scene, names)


def of_frames(
    problem: Problem, frames: Callable[[], Iterable[Trajectory]], scene: Scene, names: tuple[str, ...]
) -> Measured:
    """Quantities of a run.

    Args:
        problem: what was run.
        frames: starts reading its frames, of all beads; called for each quantity that needs them.
        scene: scene of the problem.
        names: names of the quantities, such as ``peak_velocity@100``.

    Returns:
        Name -> number in the scene's units; None where it is undefined.
    """
    run = _MeasuredRun(scene, problem, frames)
    values = {name: run.value(name) for name in names}
    return {name: None if value is None else float(value) for name, value in values.items()}


@dataclass(frozen=True)
class _MeasuredRun:
    """A run whose quantities are computed one by one.

    Attributes:
        scene: what was run.
        problem: the dimensionless problem that it stands for.
        frames: starts reading the run.
    """

    scene: Scene
    problem: Problem
    frames: Callable[[], Iterable[Trajectory]]

    @cached_property
    def exchange(self) -> list[Floats | None]:
        """Exchange of each block of frames, [frame, entry]."""
        accountant = engine_called("reference").accountant(self.problem)
        return [block.exchange for block in accountant.counted(self.frames())]

    def read(self) -> Iterator[Trajectory]:
        """Frames, with their exchange where forces from outside act."""
        counts = physics.acted_on(self.problem.system)
        for number, block in enumerate(self.frames()):
            needs = counts and block.exchange is None
            yield replace(block, exchange=self.exchange[number]) if needs else block

    @cached_property
    def report(self) -> Report:
        """Quantities of every run."""
        survey = Survey(self.problem, self.read, usual_arrival(self.problem))
        return Report(survey, self._conservation, Tolerances())

    def _conservation(self) -> Conservation:
        accountant = engine_called("reference").accountant(self.problem)
        return ConservationMeter(self.problem).read(accountant.counted(self.read()))

    @cached_property
    def _measurements(self) -> dict[str, Measurement | None]:
        return {}

    def measurement(self, key: str) -> Measurement | None:
        """Measurement of this key; None where the run has none."""
        if key not in self._measurements:
            kind, run = MEASURED[key], Recorded(self.scene, self.problem)
            meter = kind.meter(run)
            measured = None if meter is None else meter.read(self.read())
            self._measurements[key] = kind.of_run(run, self.report.survey, measured)
        return self._measurements[key]

    def value(self, name: str) -> Any:
        """Number of a quantity in the scene's units; None where it is undefined."""
        if name == MASS:
            return mass_of(self.scene)
        base, bead = at_bead(name)
        column, scale = QUANTITIES[base or name], self.problem.scale
        first, *keys = column.path
        if first in MEASURED:
            measurement = self.measurement(first)
            return None if measurement is None else plain_at(measurement.values, keys, scale)
        wave = LeadingWave(self.report.survey, kicked_chain(self.scene.plain()), bead or None)
        if column.file == WAVES:
            number = wave.column(first)
            return None if number is None else known(in_units(number, column.place.quantity.unit, scale))
        return plain_at(wave, keys, scale) if first == "kicked" else plain_at(self.report, column.path, scale)


def case(plain: dict[str, Any], names: Sequence[str], source: str, masses: Masses = NO_LIMIT) -> Computation:
    """Computation of quantities of a scene, for a worker process, under the key of what it computes.

    Args:
        plain: plain data of the scene.
        names: names of the quantities.
        source: what to call the scene in messages.
        masses: least and largest mass of all beads, in the scene's units; beyond them nothing is run.

    Returns:
        The computation; its value is that of `evaluated`.

    Examples:
        >>> computation = case(granchain.load("one-chain").plain(), ["speed"], "scene")
        >>> computation.task.function
        'workflow.quantities.evaluate:evaluated'
    """
    limits = {} if masses == NO_LIMIT else {"masses": masses}
    return computation(f"{__name__}:evaluated", {"plain": plain, "names": tuple(names), "source": source, **limits})


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
            measured = of_scene(plain, names, source) if outside is None else {MASS: outside}
            answer = {"quantities": json.loads(json.dumps(measured))}
    except (InputError, ValueError, ArithmeticError) as error:
        answer = {"refused": str(error)}
    return {**answer, "seconds": time.process_time() - started}


def _mass_outside(masses: Masses, plain: dict[str, Any], source: str) -> float | None:
    """The mass of a scene that is outside its limits; else None."""
    low, high = masses
    mass = mass_of(library.from_plain(plain, source))
    return None if (low is None or low <= mass) and (high is None or mass <= high) else mass
