"""Compare a run with an accurate reference, quantity by quantity.

Plug-ins take this module for comparisons: a `Validation` is the result of one, `TOLERANCES` are the largest errors let
pass.

Examples:
    >>> problem = granchain.load("one-chain", {"beads": 20, "duration": 30.0}).problem()
    >>> frames = engine.run(problem)
    >>> errors = difference.errors_of(frames.blocks(), frames.blocks())
    >>> validate.Validation(problem, "itself", errors, validate.TOLERANCES, frames.frames, frames.frames)
    <validation of one-chain against itself: passed>
"""

import math
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from analysis.compare.common_times import OtherFramesError, paired, paired_parts
from analysis.compare.difference import Deviation, Difference, DifferenceMeter, Uncertainty
from analysis.meters import Part
from analysis.sharing.chain_differences import ChainDifference
from analysis.trajectory import Trajectory, joined
from lammps_inputs import InputError, Problem, System, html, physics
from lammps_inputs.facts import Fact
from workflow.engines.reference.step_halving import StepHalving
from workflow.formats import figure_files
from workflow.runs.exchange import accountant
from workflow.runs.figures import write_figure
from workflow.runs.files import write_json
from workflow.runs.output_directory import record_files
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.diagnose import Diagnosis, diagnose, rounded

TOLERANCES = {
    "velocity": 5e-4,
    "displacement": 2e-3,
    "amplitude": 5e-5,
    "arrival": 2e-3,
    "force": 2e-3,
    "energy": 1e-4,
    "momentum": 1e-9,
    "impulse": 0.1,
    "share": 0.1,
}
"""Some three times what velocity Verlet leaves in the paper's scenes at the default time step of 0.01; dimensionless,
energy and momentum relative to the kick's, for contacts of strength 1 (`of_pulses`). Forces are those of measured
traces; impulses and shares of the energy are compared between rigid and elastic beads
(`analysis.sharing.chain_differences`).
"""

FIRST_ORDER = {"amplitude": 2.5e-4, "arrival": 1e-2}
"""Where LAMMPS's error is of first order in the time step: a peak is no more accurate than any velocity."""

REPORT = "validation.json"
FIGURE = "validation"
"""Report, and stem of the files, of the comparison with the reference."""

AGAINST = "validation-against"
"""Stem of the files of a comparison with a file or another run, which leave those of the reference as they are."""

_DIAGNOSED_BYTES = 64 << 20


@dataclass(frozen=True)
class RunDifference:
    """How a run differs from another one of the same scene, beside the quantities.

    Attributes:
        identical: whether all frames that both hold are bitwise the same.
        sha256: fingerprint of these frames of the run, and of the other one.
        since: time of the first frame that differs; None if none does.
        changes: what was computed or recorded with something else: its name -> (of the run, of the other one).
        chains: impulses and energy of each chain, where one of the two runs has rigid beads; else empty.
    """

    identical: bool
    sha256: tuple[str, str]
    since: float | None
    changes: dict[str, tuple[str, str]]
    chains: tuple[ChainDifference, ...] = ()


@dataclass(frozen=True)
class Validation:
    """Result of a comparison.

    Attributes:
        problem: what was run.
        against: what it was compared with.
        deviations: per quantity of `analysis.compare.difference.QUANTITIES`; those that cannot be had are missing.
        tolerances: largest error let pass, by quantity.
        frames: number of frames that the run has, as far as the scene asks for them.
        compared: number of instants at which the two were compared.
        causes: what seems to be wrong, in words; empty if nothing does.
        remarks: what else is worth knowing, in words; does not count against the run.
        uncertainty: uncertainty of the reference; None for a user's table and for another run.
        interpolation: bounds on the errors of (displacement, velocity) that interpolating between frames added; None if
            that was not needed.
        runs: how the run differs from another one; None where it was not compared with one.

    Examples:
        >>> comparison = granchain.validate("out")
        >>> comparison.deviations["velocity"].largest < comparison.tolerances["velocity"], comparison.causes
        (True, ())
    """

    problem: Problem
    against: str
    deviations: dict[str, Deviation]
    tolerances: dict[str, float]
    frames: int
    compared: int
    causes: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()
    uncertainty: Uncertainty | None = None
    interpolation: tuple[float, float] | None = None
    runs: RunDifference | None = None

    @property
    def stem(self) -> str:
        """Name of the files of this comparison without their endings.

        Returns:
            ``validation`` against the reference, else ``validation-against``.

        Examples:
            >>> granchain.validate("out").stem
            'validation'
        """
        return AGAINST if self.uncertainty is None else FIGURE

    @property
    def report(self) -> str:
        """Name of the JSON file of this comparison.

        Returns:
            The name.

        Examples:
            >>> granchain.validate("out").report
            'validation.json'
        """
        return f"{self.stem}.json"

    @property
    def page(self) -> str:
        """Name of the page of this comparison, which is written on request.

        Returns:
            The name.

        Examples:
            >>> granchain.validate("out").page
            'validation.html'
        """
        return f"{self.stem}.html"

    @property
    def complete(self) -> bool:
        """Whether every frame is there that the scene, or both scenes, ask for.

        Returns:
            Whether the run was not cut short.

        Examples:
            >>> comparison = granchain.validate("out")
            >>> comparison.complete
            True
        """
        return self.frames == self.problem.frames + 1

    def exceeded(self, quantity: str) -> bool:
        """Whether a quantity is further off than its tolerance (NaN is).

        Args:
            quantity: name of a quantity in ``deviations``.

        Returns:
            Whether the largest difference is above the tolerance.

        Examples:
            >>> comparison = granchain.validate("out")
            >>> comparison.exceeded("velocity")
            False
        """
        return not self.deviations[quantity].largest <= self.tolerances[quantity]

    def verdict(self, quantity: str) -> str:
        """Whether a quantity is within its tolerance, in a word; empty where the tolerance is infinite.

        Args:
            quantity: name of a quantity in ``deviations``.

        Returns:
            "ok", "EXCEEDED", or nothing.

        Examples:
            >>> comparison = granchain.validate("out")
            >>> comparison.verdict("velocity")
            'ok'
        """
        if self.exceeded(quantity):
            return "EXCEEDED"
        return "ok" if math.isfinite(self.tolerances[quantity]) else ""

    @property
    def passed(self) -> bool:
        """Whether the run is complete and within the tolerances, and the uncertainty of the reference suffices.

        A run that is bitwise another one need not be within them.

        Returns:
            Whether the run passes.

        Examples:
            >>> comparison = granchain.validate("out")
            >>> comparison.passed
            True
        """
        if self.runs is not None and self.runs.identical:
            return self.complete
        certain = self.uncertainty is None or not _doubts(self.uncertainty, self.tolerances)
        return self.complete and certain and not self.causes and not any_exceeded(self.deviations, self.tolerances)

    def __repr__(self) -> str:
        return (
            f"<validation of {self.problem.name} against {self.against}: {'passed' if self.passed else 'NOT passed'}>"
        )

    def _repr_html_(self) -> str:
        rows = [
            (name, f"{deviation.largest:.2e}", f"{self.tolerances[name]:.1e}", self.verdict(name))
            for name, deviation in self.deviations.items()
        ]
        words = html.text("\n".join((*self.causes, *self.remarks))) if self.causes or self.remarks else ""
        head = ("quantity", "largest (in V, L, T)", "tolerance (in V, L, T)", "")
        return html.table(repr(self)[1:-1], head, rows) + words

    def plain(self) -> dict[str, Any]:
        """The contents of the JSON file, dimensionless; what is not a finite number is null there.

        | key                 | what                                                                         |
        |---------------------|------------------------------------------------------------------------------|
        | passed              | as on the screen                                                             |
        | against             | ``reference``, the file, or the other run's directory                        |
        | complete, frames    | whether every frame is there; found, and asked for                           |
        | compared            | number of instants compared                                                  |
        | quantities          | of each: tolerance, exceeded, largest, rms, where the largest is, and first, |
        |                     | the first place in time where the tolerance is exceeded                      |
        | causes, remarks     | in words                                                                     |
        | reference           | the uncertainty; null against a file                                         |
        | interpolation_error | bounds for [displacement, velocity]; null if nothing was interpolated        |
        | runs                | `RunDifference`; null where the run was not compared with another one         |

        Returns:
            The contents, of mappings, lists, numbers and text.

        Examples:
            >>> comparison = granchain.validate("out")
            >>> comparison.plain()["passed"]
            True
        """
        return {
            "passed": self.passed,
            "against": self.against,
            "complete": self.complete,
            "frames": [self.frames, self.problem.frames + 1],
            "compared": self.compared,
            "quantities": {
                name: {"tolerance": self.tolerances[name], "exceeded": self.exceeded(name), **deviation.plain()}
                for name, deviation in self.deviations.items()
            },
            "causes": list(self.causes),
            "remarks": list(self.remarks),
            "reference": None if self.uncertainty is None else asdict(self.uncertainty),
            "interpolation_error": None if self.interpolation is None else list(self.interpolation),
            "runs": None if self.runs is None else asdict(self.runs),
        }


HALF_WINDOW = "the front half of the window is compared; the rows behind it lack the influence of the removed rows"


def validate(directory: RunDirectory, tolerances: dict[str, float] | None = None) -> Validation:
    """Compare a run with an accurate reference, and write ``validation.json`` and a figure beside it.

    Args:
        directory: the run.
        tolerances: quantity -> largest difference let pass, in place of the one in `TOLERANCES`.

    Returns:
        The comparison, also written to ``validation.json``.

    Raises:
        InputError: the run has no frames, or not those that its scene asks for.
    """
    problem = directory.problem
    limits = limits_of(problem, tolerances)
    halving = _accurate_enough(problem, limits)
    run = accountant(directory, problem).counted(directory.blocks_so_far())
    try:
        difference, diagnosed = _compared(limits, paired_parts(paired(run, halving.blocks())))
    except OtherFramesError as error:
        raise InputError(
            f"{directory.dump}: {error}; was the deck run with another -var every or timestep? Change the scene instead"
        ) from None
    deviations = difference.deviations
    run_frames, reference_frames = (joined(pair[side] for pair in diagnosed) for side in (0, 1))
    few_digits = rounded(run_frames, reference_frames)
    diagnosable = any_exceeded(deviations, limits) and problem.rows.complete and not directory.failure
    diagnosis = diagnose(run_frames, reference_frames) if diagnosable else Diagnosis()
    result = Validation(
        problem=problem,
        against="reference",
        deviations=deviations,
        tolerances=limits,
        causes=(*few_digits, *diagnosis.causes),
        remarks=(
            *filter(None, [directory.failure]),
            *([HALF_WINDOW] if problem.rows.follow else []),
            *_doubts(halving.uncertainty, limits),
            *([diagnosis.remark] if diagnosis.remark and not few_digits else []),
        ),
        uncertainty=halving.uncertainty,
        frames=difference.frames,
        compared=difference.frames,
    )
    write(directory.path, result, error_figure(result, difference, "the reference"))
    return result


def _compared(
    limits: dict[str, float], pairs: Iterable[tuple[Part, Part]]
) -> tuple[Difference, list[tuple[Trajectory, Trajectory]]]:
    """Difference of two runs, and the first frames of both, of bounded size, in which a cause may be looked for."""
    meter = DifferenceMeter(limits)
    pieces: list[Any] = []
    first: list[tuple[Trajectory, Trajectory]] = []
    bytes_held = 0
    for pair in pairs:
        pieces.append(meter.of_parts(*pair))
        if bytes_held < _DIAGNOSED_BYTES:
            frames, reference_frames = (part.frames for part in pair)
            first.append((frames, reference_frames))
            bytes_held += frames.velocity.nbytes * 4
    return meter.result(pieces), first


def limits_of(problem: Problem, tolerances: dict[str, float] | None) -> dict[str, float]:
    """The given tolerances, or the usual ones: of an energy budget with exchange, that of the velocities."""
    system = problem.system
    exchanged = {"energy": TOLERANCES["velocity"]} if physics.exchanges(system) else {}
    first_order = {} if system.holds(Fact.SECOND_ORDER) else FIRST_ORDER
    return {**of_pulses({**TOLERANCES, **exchanged, **first_order}, system), **(tolerances or {})}


def of_pulses(tolerances: dict[str, float], system: System) -> dict[str, float]:
    """Tolerances in contacts of another strength: times and overlaps of pulses change by a factor, forces inversely."""
    factor = physics.pulse_time(system)
    powers = {"displacement": 1, "arrival": 1, "force": -1}
    return {name: value * factor ** powers.get(name, 0) for name, value in tolerances.items()}


def _doubts(uncertainty: Uncertainty, limits: dict[str, float]) -> tuple[str, ...]:
    return tuple(
        f"the uncertainty of the reference, {size:.1e} in {name}, is too large for this tolerance"
        for name in ("velocity", "arrival")
        if not (size := getattr(uncertainty, name)) <= limits[name]
    )


_MORE_ACCURATE = 4.0
"""Ratio of a tolerance to the largest uncertainty of the reference that decides on it."""

_MOST_DOUBLINGS = 5


def _accurate_enough(problem: Problem, limits: dict[str, float]) -> StepHalving:
    """A reference whose uncertainty is well below the tolerances, as far as some doublings of its steps allow."""
    steps = None
    for _ in range(_MOST_DOUBLINGS):
        trial = StepHalving(problem, steps_per_frame=steps)
        uncertainty = trial.run()
        if all(_MORE_ACCURATE * getattr(uncertainty, name) <= limits[name] for name in ("velocity", "arrival")):
            break
        steps = 2 * uncertainty.steps_per_frame
    return StepHalving(problem, steps_per_frame=steps)


def any_exceeded(deviations: dict[str, Deviation], limits: dict[str, float]) -> bool:
    """Whether any quantity is further off than its tolerance (NaN is)."""
    return any(not deviation.largest <= limits[name] for name, deviation in deviations.items())


def write(path: Path, result: Validation, figure: Any) -> None:
    """Write the report and a figure into a run directory; remove the page of an earlier comparison of this kind."""
    record_files(path, (result.report, *figure_files(result.stem)), outdated=(result.page,))
    write_json(path / result.report, result.plain())
    write_figure(path, result.stem, figure)


def error_figure(result: Validation, difference: Difference, against: str) -> Any:
    """Errors over space and time, and each quantity that has a tolerance against it."""
    from analysis.figures.errors import validation_figure  # matplotlib takes half a second to import

    judged = {
        name: deviation for name, deviation in result.deviations.items() if math.isfinite(result.tolerances[name])
    }
    return validation_figure(result.problem, difference.error_map, judged, result.tolerances, against)
