"""Is a run right? Compared with the certified reference, or with a user's own trajectory, quantity by quantity."""

import io
import math
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from analysis import diagnosis, motion, resample, table
from analysis.comparison import QUANTITIES, Comparison, Deviation
from analysis.pairing import paired
from analysis.trajectory import Floats, Trajectory, joined
from lammps_inputs import InputError, Problem
from workflow.engines.reference.certify import Certificate, Certifier
from workflow.run_directory import RunDirectory, write_bytes, write_json

TOLERANCES = {
    "velocity": 5e-4,
    "displacement": 2e-3,
    "amplitude": 5e-5,
    "arrival": 2e-3,
    "energy": 1e-4,
    "momentum": 1e-9,
}
"""Some three times what velocity Verlet leaves at the default time step of 0.01; dimensionless, energy and momentum
relative to the kick's.
"""

REPORT = "validation.json"
FIGURES = ("validation.png", "validation.pdf")

_DIAGNOSED_BYTES = 64 << 20


@dataclass(frozen=True)
class Validation:
    """What a comparison found.

    Attributes:
        against: what it was compared with.
        deviations: per quantity of `analysis.comparison.QUANTITIES`; some may be missing for a user's table.
        tolerances: what was let pass.
        causes: what seems to be wrong, in words; empty if nothing does.
        certificate: how sure the reference is of itself; None for a user's table.
        interpolation: estimated error of (displacement, velocity) from interpolating between frames; None if not needed.
        frames: number of frames compared.
    """

    problem: Problem
    against: str
    deviations: dict[str, Deviation]
    tolerances: dict[str, float]
    causes: tuple[str, ...]
    certificate: Certificate | None
    interpolation: tuple[float, float] | None
    frames: int
    complete: bool

    def exceeded(self, quantity: str) -> bool:
        """Whether a quantity is further off than its tolerance (NaN is)."""
        return not self.deviations[quantity].largest <= self.tolerances[quantity]

    @property
    def passed(self) -> bool:
        """Whether all quantities are within their tolerances and nothing seems wrong."""
        return self.complete and not self.causes and not any(map(self.exceeded, self.deviations))

    def plain(self) -> dict[str, Any]:
        """The contents of ``validation.json``: dimensionless; ``first`` is where a tolerance is first exceeded."""
        return {
            "passed": self.passed,
            "against": self.against,
            "complete": self.complete,
            "frames": self.frames,
            "quantities": {
                name: {"tolerance": self.tolerances[name], "exceeded": self.exceeded(name), **_json(asdict(deviation))}
                for name, deviation in self.deviations.items()
            },
            "causes": list(self.causes),
            "reference": None if self.certificate is None else _json(asdict(self.certificate)),
            "interpolation_error": None if self.interpolation is None else list(self.interpolation),
        }


def _json(data: dict[str, Any]) -> dict[str, Any]:
    return {
        key: None if isinstance(value, float) and not math.isfinite(value) else value for key, value in data.items()
    }


def validate(directory: RunDirectory, tolerances: dict[str, float] | None = None) -> Validation:
    """Compare a run with the certified reference, and write ``validation.json`` and a figure beside it.

    Raises:
        InputError: the run has no frames.
    """
    limits = {**TOLERANCES, **(tolerances or {})}
    problem = directory.problem
    certifier = Certifier(problem)
    comparison = Comparison(limits)
    kept: list[tuple[Trajectory, Trajectory]] = []
    kept_bytes = 0
    for block, reference in paired(directory.blocks(), certifier.blocks()):
        comparison.add(block, reference)
        if kept_bytes < _DIAGNOSED_BYTES:
            kept.append((block, reference))
            kept_bytes += block.velocity.nbytes * 4
    if comparison.frames == 0:
        raise InputError(f"{directory.dump}: holds no frame to compare")
    deviations = comparison.deviations()
    if problem.recorded is not None:
        deviations = {name: deviations[name] for name in QUANTITIES if name not in ("energy", "momentum")}
    own, other = (joined(pair[side] for pair in kept) for side in (0, 1))
    exceeded = any(not found.largest <= limits[name] for name, found in deviations.items())
    result = Validation(
        problem,
        "reference",
        deviations,
        limits,
        tuple(causes(own, other, look_for_physics=exceeded)),
        certifier.certificate if comparison.frames == problem.frames + 1 else None,
        None,
        comparison.frames,
        comparison.frames == problem.frames + 1,
    )
    _write(directory.path, result, comparison)
    return result


def validate_against(
    directory: RunDirectory, path: Path, *, dimensionless: bool = False, tolerances: dict[str, float] | None = None
) -> Validation:
    """Compare a run with a user's own trajectory in a file (see `analysis.table`).

    The run is interpolated to the table's times. Peaks and arrivals are compared where the table has displacement and
    velocity at evenly spaced times.

    Args:
        directory: the run.
        path: the table.
        dimensionless: whether the table is in units of V = 1; else it is in the scene's own units.
        tolerances: quantity -> largest difference let pass, dimensionless.

    Raises:
        InputError: the table cannot be read, or has chains, beads or times that the run has not.
    """
    limits = {**TOLERANCES, **(tolerances or {})}
    problem = directory.problem
    given = table.load(path)
    scale = problem.scale
    units = (1.0, 1.0, 1.0) if dimensionless else (scale.time, scale.length, scale.velocity)
    _check_places(path, given, problem)
    columns = [int(np.flatnonzero(problem.recorded_beads == bead)[0]) for bead in given.beads]
    part = replace(problem, recorded=tuple(int(bead) for bead in given.beads))
    own = joined(
        Trajectory(part, block.time, block.displacement[:, :, columns], block.velocity[:, :, columns])
        for block in directory.blocks()
    )
    times = given.time / units[0]
    try:
        resampled = resample.at_times(own, times)
    except ValueError as error:
        raise InputError(f"{path}: {error}; is it in other units? (see --units)") from None
    reference = Trajectory(
        part,
        times,
        _on_all_chains(given.displacement, given, problem) / units[1],
        _on_all_chains(given.velocity, given, problem) / units[2],
    )
    resampled = Trajectory(
        part,
        times,
        np.where(np.isnan(reference.displacement), 0.0, resampled.displacement),
        np.where(np.isnan(reference.velocity), 0.0, resampled.velocity),
    )
    reference = Trajectory(part, times, np.nan_to_num(reference.displacement), np.nan_to_num(reference.velocity))
    comparison = Comparison(limits)
    comparison.add(resampled, reference)
    deviations = comparison.deviations()
    wanted = [name for name in table.VALUES if getattr(given, name) is not None]
    steps = np.diff(times)
    if len(wanted) == 2 and len(times) > 8 and np.allclose(steps, steps[0], rtol=1e-6):
        wanted += ["amplitude", "arrival"]
    result = Validation(
        problem,
        str(path),
        {name: deviations[name] for name in wanted},
        limits,
        (),
        None,
        resample.interpolation_error(own),
        len(times),
        complete=True,
    )
    _write(directory.path, result, comparison)
    return result


def _check_places(path: Path, given: table.Table, problem: Problem) -> None:
    chains = np.setdiff1d(given.chains, np.arange(1, problem.chains + 1))
    if len(chains):
        raise InputError(f"{path}: has chain {chains[0]}, but the scene has chains 1 to {problem.chains}")
    beads = np.setdiff1d(given.beads, problem.recorded_beads)
    if len(beads):
        raise InputError(f"{path}: has bead {beads[0]}, which the run did not record")


def _on_all_chains(values: Floats | None, given: table.Table, problem: Problem) -> Floats:
    """[frame, chain, bead] for every chain of the scene; NaN where the table has nothing."""
    result = np.full((len(given.time), problem.chains, len(given.beads)), np.nan)
    if values is not None:
        result[:, given.chains - 1] = values
    return result


def causes(own: Trajectory, reference: Trajectory, *, look_for_physics: bool) -> list[str]:
    """What seems to be wrong with a trajectory, in words.

    Args:
        own: consecutive frames of it.
        reference: the same frames, right.
        look_for_physics: whether to look beyond the number of digits.
    """
    found = []
    positions = own.displacement + own.beads * own.problem.spacing
    for name, values in (("positions", positions), ("velocities", own.velocity)):
        precision = diagnosis.digits(values)
        if precision is not None:
            found.append(f"{name} have only {precision}; write them with %.17g or in binary")
    if look_for_physics and own.problem.recorded is None:
        found += _time_causes(own, reference) or _spring_causes(own)
    return found


_CLEAR = 0.97
"""Share of the squared difference that a cause must explain."""


def _time_causes(own: Trajectory, reference: Trajectory) -> list[str]:
    problem = own.problem
    later = diagnosis.time_shift(
        own.velocity - reference.velocity, motion.acceleration(problem, reference.displacement)
    )
    moved = diagnosis.time_shift(own.displacement - reference.displacement, reference.velocity)
    unit = problem.scale.time
    if later.explained < _CLEAR:
        return []
    if moved.explained > _CLEAR and abs(moved.time / later.time - 1.0) < 0.1:
        word = "earlier" if moved.time > 0.0 else "later"
        return [f"all frames are shown {abs(moved.time) * unit:.4g} {word} than they are"]
    if abs(moved.time) < 0.1 * abs(later.time):
        steps = later.time / problem.timestep
        return [f"velocities belong to {steps:+.2g} time steps beside the positions (half-step velocities?)"]
    return []


def _spring_causes(own: Trajectory) -> list[str]:
    problem = own.problem
    springs = diagnosis.identify_springs(own)
    if springs is None:
        return []
    if springs.cubic:
        return [f"the coupling is cubic ({springs.cubic:.4g} times the cube), not linear: is r0 of the bonds 0?"]
    typical = float(np.nanmedian(springs.linear))
    if problem.kappa == 0.0:
        return [f"the chains are coupled ({typical:.4g}), though the scene has no coupling"] if typical > 1e-6 else []
    missing = np.argwhere(springs.linear < 0.5 * typical)
    if 0 < len(missing) <= 10:
        rows = ", ".join(f"row {row + 1} between chains {chain + 1} and {chain + 2}" for chain, row in missing)
        return [f"no spring in {rows}"]
    if abs(typical / problem.kappa - 1.0) > 5e-4:
        return [
            f"the coupling is {typical * problem.scale.stiffness:.6g} instead of "
            f"{problem.kappa * problem.scale.stiffness:.6g}"
        ]
    return []


def _write(path: Path, result: Validation, comparison: Comparison) -> None:
    from analysis.error_figure import validation_figure

    write_json(path / REPORT, result.plain())
    figure = validation_figure(result.problem, comparison.error_map, result.deviations, result.tolerances)
    for name in FIGURES:
        out = io.BytesIO()
        figure.savefig(out, format=Path(name).suffix[1:])
        write_bytes(path / name, out.getvalue())
