"""The pilot run: the reference's kernel with LAMMPS's table of coefficients, step for step what LAMMPS computes.

It costs a tenth of LAMMPS. So the error of a run is measured before the run, beside the certified reference.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from analysis.against.common_times import on_common_rows
from analysis.trajectory import Trajectory
from lammps_inputs import Problem, physics, scheme
from lammps_inputs.facts import Fact
from lammps_inputs.limits import rates, timestep
from workflow.engines.reference import engine
from workflow.engines.reference.blanes_moan import BLANES_MOAN
from workflow.engines.reference.certify import Certificate, Certifier
from workflow.engines.reference.suzuki import SUZUKI4
from workflow.engines.reference.verlet import VERLET
from workflow.prepare.instants import stride

TABLES = {"verlet": VERLET, "suzuki4": SUZUKI4}
"""By the name of the scheme in LAMMPS."""

SURE = 0.25
"""Part of the accuracy to which the reference is certified."""

CADENCE = 0.05
"""Time between the instants that are compared, if frames are not farther apart."""

_AIM, _HIGHEST, _LOWEST = 0.6, 0.75, 0.3
"""Parts of the accuracy: the error that is aimed at, and the range of errors that will do."""

_MOST_TRIALS = 12

RUNS = 1.5
"""Work of the reference at two steps over that at the shorter one."""

_LEAST_ORDER = 2.5
"""Of every scheme of higher order than 2, at small steps, for contacts open and close."""


CHAOS = (
    "in so long a run beads behind the front collide again and again, which amplifies any error; "
    "record beads near the front only, or follow them with `window: auto`"
)


KEPT_BYTES = 1 << 27
"""Of frames of the reference that are kept in memory, for the next trial and for the check of the run."""


@dataclass(frozen=True)
class Kept:
    """A certified reference run in memory."""

    frames: tuple[Trajectory, ...]
    certificate: Certificate

    def is_of(self, problem: Problem) -> bool:
        """Whether these are the frames of a problem: the same beads at the same times."""
        own = self.frames[0].problem
        same = (own.frames, own.recorded, own.window) == (problem.frames, problem.recorded, problem.window)
        return same and math.isclose(own.every, problem.every, rel_tol=1e-9)

    def blocks(self) -> Iterator[Trajectory]:
        """As `Certifier.blocks`."""
        return iter(self.frames)

    def of(self, problem: Problem) -> "Kept":
        """The same frames, of a problem with another time step."""
        return replace(self, frames=tuple(replace(block, problem=problem) for block in self.frames))


@dataclass(frozen=True)
class Found:
    """Steps that keep an accuracy in a problem; dimensionless.

    Attributes:
        timestep: mean Verlet step of LAMMPS.
        reference_timestep: step of the reference, whose uncertainty is `SURE` of the accuracy.
        error: largest error of any velocity that is to be expected.
        measured_error: error that was measured: the same, or a larger one from which it was carried over.
        measured: share of the run's time over which it was measured; 0 where the rule gave it.
        limited: whether the step could not be longer for the frames, the energy or the stability bound.
        reference: the run with the reference's step, where it fits into memory and is of the whole problem.
    """

    timestep: float
    reference_timestep: float
    error: float
    measured_error: float
    measured: float
    limited: bool
    reference: Kept | None = None


class UnreachableError(Exception):
    """No step keeps the accuracy; says why."""


def load(problem: Problem) -> None:
    """Compile what a pilot run of a problem needs, or find it compiled."""
    for table in (TABLES[problem.scheme], BLANES_MOAN):
        engine.run(replace(problem, frames=1), scheme=table, steps_per_frame=2)


def measure(problem: Problem, accuracy: float, most_work: float) -> Found | None:
    """Measure the error at a first guess of the step, carry that to the accuracy by the order, measure again.

    Args:
        problem: what is to be run; its own time step does not count.
        accuracy: largest error of any recorded velocity.
        most_work: forces on beads that this may take.

    Returns:
        Steps that keep the accuracy, with an error above 0.3 of it where that can be; None if it takes too much work.

    Raises:
        UnreachableError: the problem has no solution of that accuracy.
    """
    problem = _coarse(problem)
    cycle = scheme.cycle(problem.scheme)
    fewest, cycles = (
        max(1, math.ceil(problem.every / (cycle * step) * (1.0 - 1e-9)))
        for step in (largest_step(problem, accuracy), guessed_step(problem, accuracy))
    )
    steps = guessed_reference_steps(problem, accuracy)
    errors: dict[int, float] = {}
    certificates: dict[int, float] = {}
    good: dict[int, Found] = {}
    kept: dict[int, Kept] = {}
    spent = 0.0
    for _ in range(_MOST_TRIALS):
        spent += work(problem, cycles * cycle, 0 if steps in kept else steps)
        if spent > most_work:
            return None
        if steps not in kept and _bytes(problem) <= KEPT_BYTES:
            kept = {steps: _kept(problem, steps)}
        reference = kept[steps] if steps in kept else Certifier(problem, steps_per_frame=steps)
        error, certificates[steps] = _trial(problem, cycles, reference)
        sure = certificates[steps] <= SURE * accuracy
        if sure and error <= _HIGHEST * accuracy:
            limited = cycles == fewest
            step, own = problem.every / (cycles * cycle), problem.every / steps
            good[cycles] = Found(step, own, error, error, 1.0, limited, kept.get(steps))
            if error >= _LOWEST * accuracy or cycles == fewest:
                break
        if error > 2.0 * certificates[steps] or sure:
            errors[cycles] = error
            cycles = _better(cycles, error / accuracy, _order(errors, problem), fewest)
            if cycles in good:
                break
        if not sure:
            steps = _surer(certificates, accuracy)
    if not good:
        raise UnreachableError("contacts amplify errors too much")
    return good[min(good)]


def _coarse(problem: Problem) -> Problem:
    """With the frames that are compared."""
    return problem.coarser(stride(problem, CADENCE))


def work(problem: Problem, verlet_steps: int, reference_steps: int) -> float:
    """Forces on beads with so many steps a frame: of the pilot run, and of the reference at two steps."""
    forces = verlet_steps + RUNS * BLANES_MOAN.forces_per_step * reference_steps
    return problem.chains * _rows_by_time(problem) / problem.every * forces


def _rows_by_time(problem: Problem) -> float:
    """Integral over time of the number of rows that have moved, roughly: no pulse is faster than the system's pace."""
    first, last = (choose(bead for _, bead, _ in physics.excitations(problem.system)) for choose in (min, max))
    way = rates.pace(problem.system) * np.linspace(0.0, problem.duration, 101)
    rows = np.minimum(problem.beads, last + way) - np.maximum(1.0, first - way) + 1.0
    if problem.window is not None:
        rows = np.minimum(rows, engine.WIDER * problem.window)
    return float(np.mean(rows) * problem.duration)


def guessed_step(problem: Problem, accuracy: float) -> float:
    """By the rule."""
    return timestep.timestep_for(accuracy, problem.duration, problem.system, problem.scheme)


def guessed_reference_steps(problem: Problem, accuracy: float) -> int:
    """Steps a frame of the reference that are usually sure enough: at its default, contacts leave it unsure by 1e-5."""
    usual = engine.default_steps_per_frame(problem)
    contacts, swings = (
        1e-5 / (SURE * accuracy),
        9e-8 * rates.swing(problem.system) * problem.duration / (SURE * accuracy),
    )
    return 2 * math.ceil(0.5 * usual * max(1.0, math.pow(contacts, 1.0 / _LEAST_ORDER), math.pow(swings, 0.25)))


def largest_step(problem: Problem, accuracy: float) -> float:
    """No step above this is tried."""
    return timestep.largest_timestep(accuracy, problem.system, problem.scheme)


def _bytes(problem: Problem) -> float:
    """Of the reference's frames."""
    wider = 1 if problem.window is None else engine.WIDER
    return 16.0 * problem.frames * problem.chains * problem.rows_a_frame * wider


def _kept(problem: Problem, steps: int) -> Kept:
    certifier = Certifier(problem, steps_per_frame=steps)
    return Kept(tuple(certifier.blocks()), certifier.certificate)


def _trial(problem: Problem, cycles: int, reference: Certifier | Kept) -> tuple[float, float]:
    """Largest difference of any velocity of the pilot run from the reference, and the reference's certificate."""
    runs = engine.blocks(problem, scheme=TABLES[problem.scheme], steps_per_frame=cycles)
    largest = 0.0
    with np.errstate(over="ignore", invalid="ignore"):
        for own, right in zip(runs, reference.blocks(), strict=True):
            largest = max(largest, _difference(*on_common_rows(own, right)))
    return largest, reference.certificate.velocity


def _difference(own: Trajectory, right: Trajectory) -> float:
    found = float(np.max(np.abs(own.velocity - right.velocity)))
    return found if found <= 2.0 else 2.0  # a run that blew up, or NaN


def _better(cycles: int, part: float, order: float, fewest: int) -> int:
    """Cycles a frame for the error that is aimed at, where so many leave an error of this part of the accuracy."""
    better = math.ceil(cycles * math.pow(part / _AIM, 1.0 / order))
    if cycles > 1 and part * math.pow(cycles / (cycles - 1), order) <= _HIGHEST:
        better = min(better, cycles - 1)
    return max(fewest, better)


def _order(errors: dict[int, float], problem: Problem) -> float:
    """Order of convergence as measured last, within what the scheme can have."""
    highest = float(TABLES[problem.scheme].order) if problem.system.holds(Fact.SECOND_ORDER) else 1.0
    if len(errors) < 2:
        return highest
    (few, large), (many, small) = sorted(list(errors.items())[-2:])
    if not large > small > 0.0:
        return highest
    lowest = 2.0 if problem.system.holds(Fact.SECOND_ORDER) else 1.0
    return min(highest, max(lowest, math.log(large / small) / math.log(many / few)))


def certificate(problem: Problem, steps: int) -> float:
    """How sure the reference is with so many steps a frame."""
    certifier = Certifier(problem, steps_per_frame=steps)
    for _ in certifier.blocks():
        pass
    return certifier.certificate.velocity


def _surer(certificates: dict[int, float], accuracy: float) -> int:
    """Steps of the reference, an even number, that should do, if those that were tried (steps -> certificate) do not.

    Raises:
        UnreachableError: six times as many steps have left the reference hardly surer.
    """
    steps, certificate = max(certificates.items())
    for fewer, before in certificates.items():
        if steps >= 6 * fewer and certificate > max(before / 3.0, accuracy * SURE):
            raise UnreachableError(f"the uncertainty of the reference itself is {certificate:.0e} V: {CHAOS}")
    ratio: float = 1.1 * (certificate / (SURE * accuracy)) ** (1.0 / _LEAST_ORDER)
    return 2 * math.ceil(0.5 * steps * min(6.0, max(1.25, ratio)))
