"""The time step that LAMMPS needs for an accuracy, by a pilot run: the reference's kernel with LAMMPS's coefficients.

Step for step that is what LAMMPS computes, at a tenth of the cost. So the error of a run is measured before the run,
beside a reference of known uncertainty. What costs too much to measure is measured at a larger error, or on a shorter
problem, and carried over: errors fall as the step to the order of the scheme, and grow in proportion to time. All
trials together take at most `processor_time.BEFORE_RUN` seconds; where that is too little, the rule gives the step.
"""

import itertools
import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationError

from analysis.compare.common_times import on_common_rows, velocity_error
from lammps_inputs import InputError, Problem, Scene, complaints, physics
from lammps_inputs.facts import Fact
from lammps_inputs.limits import rates
from lammps_inputs.rows import Rows
from lammps_inputs.scene import DEFAULT_ACCURACY
from workflow import screen
from workflow.engines.reference import engine
from workflow.engines.reference.schemes import BLANES_MOAN, SUZUKI4, VERLET
from workflow.engines.reference.step_halving import StepHalving
from workflow.prepare.step_choice import ChosenStep, ReferenceFrames
from workflow.processor_time import BEFORE_RUN, LimitReachedError, clock, leave_out, left, limited

SPACING = 0.4
"""Time between the frames that are compared, in units of T: waves are found between them to 1e-5."""

FEW = 100
"""Number of frames up to which all are compared: an error can grow much from one to the next."""


def stride(problem: Problem, spacing: float = SPACING) -> int:
    """Frames from one that is compared to the next, so that the last is among them or nearly; 1 if there are few.

    In a period of stiff springs four are compared, so that not all show one phase of it; and four in the time in which
    dashpots stop a bead, for the error is largest when they begin to.
    """
    if problem.frames <= FEW:
        return 1
    modal_frequency, drag = rates.modal_frequency(problem.system), rates.drag(problem.system)
    if modal_frequency > 0.0:
        spacing = min(spacing, 0.5 * math.pi / modal_frequency)
    if drag > 0.0:
        spacing = min(spacing, 0.25 / drag)
    largest = max(1, min(math.floor(spacing / problem.every * (1.0 + 1e-9)), problem.frames))
    return min(range(largest, largest // 2, -1), key=lambda step: problem.frames % step)


TABLES = {"verlet": VERLET, "suzuki4": SUZUKI4}
"""Scheme of the reference by the name of LAMMPS's."""

UNCERTAINTY_PART = 0.25
"""Part of the requested accuracy that the uncertainty of the reference may have."""

CADENCE = 0.05
"""Time between the instants that are compared, if frames are not farther apart."""

_AIM, _HIGHEST, _LOWEST = 0.6, 0.75, 0.3
"""Parts of the accuracy: the error that is aimed at, and the range of errors that will do."""

_MOST_TRIALS = 12

RUNS = 1.5
"""Work of the reference at two steps over that at the shorter one."""

_LEAST_ORDER = 2.5
"""Least order of convergence of schemes of order above 2, at small steps, as contacts open and close."""


CHAOS = (
    "in so long a run beads behind the front collide again and again, which amplifies any error; "
    "record beads near the front only, or follow them with `window: auto` (`granchain lyapunov` measures the growth)"
)


KEPT_BYTES = 1 << 27
"""Largest size of frames of the reference that stay in memory for the next trial and the check of the run."""


class UnreachableError(Exception):
    """No step keeps the accuracy; says why."""


def load(problem: Problem) -> None:
    """Compile what a pilot run of a problem needs, or find it compiled; no processor time that counts."""
    started = clock()
    for table in (TABLES[problem.scheme], BLANES_MOAN):
        engine.run(replace(problem, frames=1), scheme=table, steps_per_frame=2)
    leave_out(clock() - started)


def measure(problem: Problem, accuracy: float, most_work: float) -> ChosenStep | None:
    """Measure the error at a first guess of the step, carry that to the accuracy by the order, measure again.

    Args:
        problem: what is to be run; its own time step does not count.
        accuracy: largest error of any recorded velocity, of beads and resonators.
        most_work: forces on beads that this may take.

    Returns:
        Steps that keep the accuracy, with an error above 0.3 of it where that can be; None if it takes too much work.

    Raises:
        UnreachableError: the problem has no solution of that accuracy.
    """
    problem = problem.coarser(stride(problem, CADENCE))  # the frames that are compared
    cycle = problem.cycle
    fewest, cycles = (
        max(1, math.ceil(problem.every / (cycle * step) * (1.0 - 1e-9)))
        for step in (largest_step(problem, accuracy), guessed_step(problem, accuracy))
    )
    steps = guessed_reference_steps(problem, accuracy)
    errors: dict[int, float] = {}
    uncertainties: dict[int, float] = {}
    good: dict[int, ChosenStep] = {}
    references: dict[int, ReferenceFrames] = {}
    spent = 0.0
    for _ in range(_MOST_TRIALS):
        spent += work(problem, cycles * cycle, 0 if steps in references else steps)
        if spent > most_work:
            return None
        reference = references.get(steps) or _reference(problem, steps)
        if isinstance(reference, ReferenceFrames):
            references = {steps: reference}
        error, uncertainties[steps] = _error(problem, cycles, reference), reference.uncertainty.velocity
        accurate = uncertainties[steps] <= UNCERTAINTY_PART * accuracy
        if accurate and error <= _HIGHEST * accuracy:
            limited = cycles == fewest
            step, reference_step = problem.every / (cycles * cycle), problem.every / steps
            chosen = accuracy, step, cycles * cycle, reference_step, error, error
            good[cycles] = ChosenStep(*chosen, measured=1.0, limited=limited, reference=references.get(steps))
            if error >= _LOWEST * accuracy or cycles == fewest:
                break
        if error > 2.0 * uncertainties[steps] or accurate:
            errors[cycles] = error
            cycles = _better(cycles, error / accuracy, _measured_order(errors, problem), fewest)
            if cycles in good:
                break
        if not accurate:
            steps = _steps_for(uncertainties, accuracy)
    if not good:
        raise UnreachableError("contacts amplify errors too much")
    return good[min(good)]


def work(problem: Problem, verlet_steps: int, reference_steps: int) -> float:
    """Number of forces on beads, by steps a frame of the pilot run and of the reference, which runs at two steps."""
    forces = verlet_steps + RUNS * BLANES_MOAN.forces_per_step * reference_steps
    return problem.chains * _rows_by_time(problem) / problem.every * forces


def _rows_by_time(problem: Problem) -> float:
    """Integral over time of the number of rows that have moved, roughly: no pulse exceeds `rates.front_speed`."""
    first, last = physics.span_at_start(problem.system)
    distance = rates.front_speed(problem.system) * np.linspace(0.0, problem.duration, 101)
    rows = np.minimum(problem.beads, last + distance) - np.maximum(1.0, first - distance) + 1.0
    if problem.rows.follow:
        rows = np.minimum(rows, engine.WIDER * problem.rows.existing)
    return float(np.mean(rows) * problem.duration)


def guessed_step(problem: Problem, accuracy: float) -> float:
    """Time step for an accuracy by the rule, in units of T."""
    return rates.timestep_for(accuracy, problem.duration, problem.system, problem.scheme)


def guessed_reference_steps(problem: Problem, accuracy: float) -> int:
    """Steps a frame that usually suffice: with the default number, contacts leave an uncertainty of 1e-5 V."""
    usual = engine.default_steps_per_frame(problem)
    contacts, oscillations = (
        1e-5 / (UNCERTAINTY_PART * accuracy),
        9e-8 * rates.modal_frequency(problem.system) * problem.duration / (UNCERTAINTY_PART * accuracy),
    )
    return 2 * math.ceil(0.5 * usual * max(1.0, math.pow(contacts, 1.0 / _LEAST_ORDER), math.pow(oscillations, 0.25)))


def largest_step(problem: Problem, accuracy: float) -> float:
    """Time step above which none is tried, in units of T."""
    return rates.largest_timestep(accuracy, problem.system, problem.scheme)


def _reference(problem: Problem, steps: int) -> StepHalving | ReferenceFrames:
    """The reference with so many steps a frame, in memory where that holds its frames."""
    halving, wider = StepHalving(problem, steps_per_frame=steps), engine.WIDER if problem.rows.follow else 1
    if 16.0 * problem.frames * problem.chains * problem.rows.count * wider > KEPT_BYTES:
        return halving
    return ReferenceFrames(tuple(halving.blocks()), halving.uncertainty)


def _error(problem: Problem, cycles: int, reference: StepHalving | ReferenceFrames) -> float:
    """Largest difference of any velocity, of beads and resonators, of the pilot run from the reference, at most 2."""
    runs = engine.blocks(problem, scheme=TABLES[problem.scheme], steps_per_frame=cycles)
    largest = 0.0
    with np.errstate(over="ignore", invalid="ignore"):
        for blocks in zip(runs, reference.blocks(), strict=True):
            pilot, right = on_common_rows(*blocks)
            difference = velocity_error(pilot, right)
            largest = max(largest, difference if difference <= 2.0 else 2.0)  # a run that blew up, or NaN
    return largest


def _better(cycles: int, part: float, order: float, fewest: int) -> int:
    """Cycles a frame for the error that is aimed at, where so many leave an error of this part of the accuracy."""
    better = math.ceil(cycles * math.pow(part / _AIM, 1.0 / order))
    if cycles > 1 and part * math.pow(cycles / (cycles - 1), order) <= _HIGHEST:
        better = min(better, cycles - 1)
    return max(fewest, better)


def _measured_order(errors: dict[int, float], problem: Problem) -> float:
    """Order of convergence as measured last, within what the scheme can have."""
    highest = float(TABLES[problem.scheme].order) if problem.system.holds(Fact.SECOND_ORDER) else 1.0
    if len(errors) < 2:
        return highest
    (few, large), (many, small) = sorted(list(errors.items())[-2:])
    if not large > small > 0.0:
        return highest
    lowest = 2.0 if problem.system.holds(Fact.SECOND_ORDER) else 1.0
    return min(highest, max(lowest, math.log(large / small) / math.log(many / few)))


def _steps_for(uncertainties: dict[int, float], accuracy: float) -> int:
    """Steps of the reference, an even number, that should do, if those that were tried (steps -> uncertainty) do not.

    Raises:
        UnreachableError: six times as many steps have hardly reduced the uncertainty of the reference.
    """
    steps, uncertainty = max(uncertainties.items())
    for fewer, before in uncertainties.items():
        if steps >= 6 * fewer and uncertainty > max(before / 3.0, accuracy * UNCERTAINTY_PART):
            raise UnreachableError(f"the uncertainty of the reference itself is {uncertainty:.0e} V: {CHAOS}")
    ratio: float = 1.1 * (uncertainty / (UNCERTAINTY_PART * accuracy)) ** (1.0 / _LEAST_ORDER)
    return 2 * math.ceil(0.5 * steps * min(6.0, max(1.25, ratio)))


_PART = 0.5
"""Part of the processor time that is left which one measurement may take; so something is left for cheaper ones."""

_LONG = 1.0
"""Processor time in s from which on a measurement is announced."""

_LEAST_FORCE = 3e-10
"""Processor time in s of the forces on a bead at the least: what takes too long even so is not timed."""

_TIMED = 0.02
"""Processor time in s over which forces are timed."""

_MARGIN = 2.0
"""Error that is reckoned with, over what is carried over. Over a shorter problem's in proportion to time, the true one
was 0.5 to 1.5 (2.5 with a gap); over that at a larger step, by the order, 0.97 to 1.03 (0.5 to 2 with a gap).
"""

_STEADY = 4.0
"""Growth of the reference's uncertainty, over that in proportion to time, that still counts as proportional."""

_COARSEST = 1e-3
"""Largest error from which a smaller one is extrapolated by the order."""

_SHORTEST = 60.0
"""Time from which on a shorter problem stands for a longer one."""

_FEWEST = 20
"""Beads left between two kicks, and beyond the last, in a shorter problem."""

_TRIALS = 2.0
"""Work of a measurement over that of its first trial, about."""


def search(problem: Problem, accuracy: float, *, most_work: float = math.inf) -> ChosenStep:
    """The longest time step, within a factor of about two, that keeps every velocity within an accuracy.

    Args:
        problem: what is to be run; its own time step does not count.
        accuracy: in units of V.
        most_work: forces on beads that a measurement may take at most, beside the limit on processor time.

    Raises:
        UnreachableError: no step does.
    """
    _refuse_rounding(rounding(problem, guessed_step(problem, accuracy)), 0.5 * accuracy)
    choice = _affordable_choice(problem, accuracy, most_work)
    _refuse_rounding(rounding(problem, choice.timestep), 0.25 * accuracy)
    return choice


def _affordable_choice(problem: Problem, accuracy: float, most_work: float) -> ChosenStep:
    """The choice by the dearest measurement that costs little enough; by the rule where all cost too much."""
    limit, force, announced = most_work, _LEAST_FORCE, False
    for share, trial_accuracy in _measurements(accuracy, problem.duration):
        trial = _shorter(problem, share)
        expected = _TRIALS * _first_work(trial, trial_accuracy)
        if not _affordable(expected, limit, force):
            continue
        if force == _LEAST_FORCE:
            force = force_seconds(trial)
            if not _affordable(expected, limit, force):
                continue
        if expected * force > _LONG and not announced:
            announced = True
            screen.hint(
                f"choosing the time step by a pilot run: about {expected * force:.0f} s of processor time, "
                f"{BEFORE_RUN:.0f} s at most; a `timestep` avoids it"
            )
        measured = _measured_within(_PART * left(), trial, trial_accuracy, min(most_work, _PART * left() / force))
        if measured is None:
            limit, most_work = expected / 4.0, most_work / 2.0  # what is hardly cheaper would not do either
        elif (share, trial_accuracy) == (1.0, accuracy):
            return measured
        elif share < 1.0:
            _refuse_chaos(problem, trial, share, accuracy, min(most_work, left() / force))
            return _carried_over(measured, problem, share, trial_accuracy, accuracy)
        elif _can_be_accurate(problem, accuracy, min(most_work, left() / force)):
            return _carried_over(measured, problem, share, trial_accuracy, accuracy)
    return by_rule(problem, accuracy)


def _affordable(work: float, most_work: float, force: float) -> bool:
    """Whether work is within a limit, and within its part of the processor time at so many seconds a force."""
    return work <= most_work and work * force <= _PART * left()


def _measured_within(seconds: float, problem: Problem, accuracy: float, most_work: float) -> ChosenStep | None:
    """The choice of `measure`; None if it takes more processor time, in s, or more work."""
    try:
        with limited(seconds):
            return measure(problem, accuracy, most_work)
    except LimitReachedError:
        return None


def force_seconds(problem: Problem) -> float:
    """Processor time of the forces on a bead, in s, measured over steps of the reference of all rows that can move."""
    state = engine.make_state(problem, engine.WIDER * problem.rows.existing if problem.rows.follow else None)
    reach = math.ceil(min(rates.front_speed(problem.system) * problem.duration, problem.beads))
    first = max(1, int(state.span[0]) - reach)
    rows = min(problem.beads - first + 1, int(state.span[1]) + reach, int(state.span[2]))
    state.span[:2] = first, first + rows - 1
    step, done, steps = problem.every / engine.default_steps_per_frame(problem), 0, 1
    frames, first_bead = state.frame_arrays(1, problem.lines, 1), np.array([1])
    while True:
        started = clock()
        state.advance(BLANES_MOAN, step, done, steps, first_bead, frames)
        seconds, done = clock() - started, done + steps
        if seconds > _TIMED:
            return seconds / (steps * BLANES_MOAN.forces_per_step * rows * problem.chains)
        steps *= 4


def by_rule(problem: Problem, accuracy: float) -> ChosenStep:
    """The step for an accuracy where nothing is measured."""
    step = guessed_step(problem, accuracy)
    reference = problem.every / guessed_reference_steps(problem, accuracy)
    chosen = accuracy, step, math.ceil(problem.every / step), reference, accuracy, accuracy
    return ChosenStep(*chosen, measured=0.0, limited=step == largest_step(problem, accuracy))


def _measurements(accuracy: float, duration: float) -> Iterator[tuple[float, float]]:
    """Share of the time and accuracy in it of ever cheaper measurements, the run itself first."""
    yield 1.0, accuracy
    share = 1.0
    while share == 1.0 or share * duration >= _SHORTEST:
        trial_accuracy = accuracy * share / _MARGIN
        yield share, trial_accuracy
        while (trial_accuracy := 4.0 * trial_accuracy) <= _COARSEST:
            yield share, trial_accuracy
        share *= 0.5


def _first_work(problem: Problem, accuracy: float) -> float:
    """Work of the first trial of a measurement."""
    verlet = math.ceil(problem.every / guessed_step(problem, accuracy))
    return work(problem, verlet, guessed_reference_steps(problem, accuracy))


def _can_be_accurate(problem: Problem, accuracy: float, most_work: float) -> bool:
    """Whether the uncertainty of the reference with the usual number of steps suffices, where that can be afforded."""
    steps = guessed_reference_steps(problem, accuracy)
    if work(problem, 0, steps) > most_work:
        return True
    try:
        return StepHalving(problem, steps_per_frame=steps).run().velocity <= accuracy
    except LimitReachedError:
        return True


def _refuse_chaos(problem: Problem, shorter: Problem, share: float, accuracy: float, most_work: float) -> None:
    """Give up where errors grow much faster than in proportion to time, as far as that can be afforded to be known.

    Raises:
        UnreachableError: they do.
    """
    steps = engine.default_steps_per_frame(problem)
    if work(problem, 0, steps) > most_work:
        return
    try:
        uncertainty = StepHalving(problem).run().velocity
        usual = StepHalving(shorter).run().velocity / share
    except LimitReachedError:
        return
    if uncertainty > max(_STEADY * usual, UNCERTAINTY_PART * accuracy):
        raise UnreachableError(f"errors grow {uncertainty / usual:.0f} times as much as they usually do: {CHAOS}")


def _carried_over(
    measured: ChosenStep, problem: Problem, share: float, trial_accuracy: float, accuracy: float
) -> ChosenStep:
    """The choice for the run itself, carried over from a cheaper measurement."""
    ratio = accuracy * share / _MARGIN / trial_accuracy
    order = _LEAST_ORDER if problem.scheme != "verlet" else 2.0 if problem.system.holds(Fact.SECOND_ORDER) else 1.0
    largest = largest_step(problem, accuracy)
    step = min(largest, measured.timestep * ratio ** (1.0 / order))
    return replace(
        measured,
        timestep=step,
        reference_timestep=measured.reference_timestep * ratio ** (1.0 / _LEAST_ORDER),
        expected_error=measured.expected_error * accuracy / trial_accuracy,
        measured=share,
        limited=measured.limited or step == largest,
        reference=None,
    )


def _shorter(problem: Problem, share: float) -> Problem:
    """The chains over a share of the time, with the kicks and the ends of the chains as much closer together."""
    system = problem.system
    if share == 1.0:
        return problem
    first, last = physics.span_at_start(system)
    started = range(first, last + 1) if system.start is not None else ()
    marks = sorted({0, problem.beads + 1, *(bead for _, bead, _ in physics.excitations(system)), *started})
    place = {0: 0}
    for before, after in itertools.pairwise(marks):
        distance = after - before
        place[after] = place[before] + min(distance, max(_FEWEST, math.ceil(distance * share)))
    beads = place[problem.beads + 1] - 1
    rows = _kept_rows(marks, place)
    apart = math.ceil(problem.every)  # frames at most 1 apart, so that there are some
    return replace(
        problem,
        system=replace(
            system.on(rows),
            kicks=tuple((chain, place[bead], velocity) for chain, bead, velocity in system.kicks),
            loads=tuple(replace(load, bead=place[load.bead]) for load in system.loads),
            motions=tuple(replace(motion, bead=place[motion.bead]) for motion in system.motions),
        ),
        timestep=problem.every / apart,
        steps_per_frame=1,
        frames=max(1, math.ceil(problem.frames * apart * share)),
        rows=Rows(beads).near_front(problem.rows.width),
    )


def _kept_rows(marks: list[int], place: dict[int, int]) -> NDArray[np.int64]:
    """Rows of the longer chains, from 0, that the beads of the shorter ones stand for: those near a kick or an end."""
    rows: list[int] = []
    for before, after in itertools.pairwise(marks):
        count = place[after] - place[before]
        near = count // 2
        rows += [*range(before + 1, before + near + 1), *range(after - (count - near) + 1, after + 1)]
    return np.array(rows[:-1], dtype=np.int64) - 1  # the last mark is beyond the last bead


def _refuse_rounding(floor: float, limit: float) -> None:
    if floor > limit:
        raise UnreachableError(f"rounding of the positions in LAMMPS leaves up to {floor:.0e} V")


def rounding(problem: Problem, step: float) -> float:
    """What rounding leaves in LAMMPS's velocities, at most: positions grow with the beads, and each step rounds them.

    Measured in chains of 40 and 1000 beads with 6e4 to 3e6 steps: a ninth of this to a third.
    """
    return 3.0 * float(np.spacing(problem.beads * problem.layout.spacing)) * math.sqrt(problem.duration / step)


def with_timestep(scene: Scene, source: str = "") -> tuple[Scene, ChosenStep]:
    """The scene with a time step that keeps its accuracy, or the default, and how it was chosen.

    Where no step keeps the default accuracy, the step is that of the rule.

    Args:
        scene: with its duration.
        source: what the user calls the scene, for messages.

    Raises:
        InputError: no step keeps the accuracy that the scene asks for.
    """
    named, accuracy = scene.accuracy is not None, scene.accuracy or DEFAULT_ACCURACY
    problem = scene.model_copy(update={"timestep": None, "accuracy": None}).problem()
    where, unreached = f"{source}: accuracy" if source else "accuracy", ""
    started = clock()
    try:
        with limited():
            load(problem)
            choice = search(problem, accuracy)
    except LimitReachedError:
        choice = by_rule(problem, accuracy)
    except UnreachableError as error:
        if named:
            raise InputError(
                f"{where}: {accuracy:g} is not reached with any time step, since {error}; "
                "take a larger one, or give a timestep"
            ) from None
        choice, unreached = by_rule(problem, accuracy), str(error)
    cycle = problem.cycle
    steps = cycle * math.ceil(problem.every / (cycle * choice.timestep) * (1.0 - 1e-9))
    every = problem.every * scene.scale.time if scene.output.every is None else scene.output.every
    fields = {name: getattr(scene, name) for name in Scene.model_fields}
    try:
        settled = Scene.model_validate({**fields, "accuracy": None, "timestep": every / steps})
    except ValidationError as error:
        wrong = complaints.describe(error, Scene)
        raise InputError(f"{where}: {accuracy:g} needs a time step of {every / steps:.3g}; {wrong}") from None
    return settled, replace(
        choice,
        accuracy=accuracy,
        timestep=problem.every / steps,
        steps_per_frame=steps,
        seconds=clock() - started,
        asked=named,
        unreached=unreached,
        rule_timestep=guessed_step(problem, accuracy),
    )


def better_timestep(scene: Scene) -> str:
    """What to change in a scene whose time step left too large an error, in words."""
    better, settings = with_timestep(scene.model_copy(update={"timestep": None}))
    if settings.unreached:
        return f"no time step is known to leave less, since {settings.unreached}"
    if settings.measured < 1.0:
        return "leave `timestep` out, and a pilot run chooses a shorter one"
    return f"`timestep: {better.timestep:.12g}` leaves {settings.expected_error:.1e} V, measured by a pilot run"
