"""A run that came to an end, and its measured error."""

import math
from dataclasses import asdict, dataclass

from analysis.compare.difference import DeviationPlace, Uncertainty
from analysis.trajectory import FramesInUnits, Trajectory
from lammps_inputs import html
from workflow.runs.run_directory import RunDirectory


@dataclass(frozen=True)
class Check:
    """Measured error of a run, dimensionless.

    Attributes:
        velocity: largest error of any velocity, of beads and other atoms, in the frames that are compared: all of a
            little run, else those that `workflow.prepare.pilot` chooses.
        where: at which bead or other atom, and time.
        arrival: largest error of an arrival of the leading pulse, where `analysis.tracking.peaks.sharp`; NaN where none
            is.
        amplitude: largest error of a peak velocity of the leading pulse; NaN where none was seen.
        reference: uncertainty of the reference.
        seconds: what the check cost.
    """

    velocity: float
    where: DeviationPlace | None
    arrival: float
    amplitude: float
    reference: Uncertainty
    seconds: float

    def __repr__(self) -> str:
        return (
            f"<error: velocities {self.velocity:.1e} V, uncertainty of the reference {self.reference.velocity:.1e} V>"
        )

    def _repr_html_(self) -> str:
        errors = {"velocities (V)": self.velocity, "peaks (V)": self.amplitude, "arrivals (T)": self.arrival}
        uncertainty = {"velocities (V)": self.reference.velocity, "arrivals (T)": self.reference.arrival}
        rows = [
            (name, f"{error:.1e}", f"{uncertainty[name]:.1e}" if name in uncertainty else "")
            for name, error in errors.items()
            if math.isfinite(error)
        ]
        return html.table("error against the reference", ("", "largest", "uncertainty of the reference"), rows)

    def plain(self) -> dict[str, object]:
        """Plain data of the check, for ``run.json``."""
        return asdict(self) | {"where": self.where and self.where.plain()}


@dataclass(frozen=True)
class CompletedRun:
    """A run that came to an end.

    Attributes:
        directory: everything that it left.
        outcome: "done", or "interrupted" with the frames until then.
        check: its error against the reference; None if that was not asked for, or another engine than LAMMPS ran.
    """

    directory: RunDirectory
    outcome: str
    check: Check | None = None

    @property
    def trajectory(self) -> Trajectory:
        """All frames, in units of V, T and L, read from the disk when they are asked for.

        Its arrays are ``time`` [frame], ``displacement`` and ``velocity`` [frame, chain, bead], float64.

        Examples:
            >>> frames = granchain.run("one-chain", "frames", engine="reference").trajectory
            >>> frames.velocity[0, 0, :3]  # the kick
            array([1., 0., 0.])
        """
        return self.directory.trajectory

    @property
    def si(self) -> FramesInUnits:
        """All frames in the scene's units: SI where it has a material, else reduced units; arrays as `trajectory`'s.

        Examples:
            >>> frames = granchain.run("one-chain", "in-units", engine="reference").si
            >>> frames.velocity.ndim, len(frames.time) == len(frames.velocity)
            (3, True)
        """
        return self.trajectory.measured()

    def __repr__(self) -> str:
        problem = self.directory.problem
        error = "" if self.check is None else f", error of velocities {self.check.velocity:.1e} V"
        engine = self.directory.engine
        return f"<run of {problem.name} in {self.directory.path}: {self.outcome}, computed by {engine}{error}>"

    def _repr_html_(self) -> str:
        record = self.directory.account.plain()
        shown = {"outcome": "outcome", "engine": "engine", "steps": "time steps", "ranks": "MPI ranks"}
        shown["engine_seconds"] = "time of the engine (s)"
        rows = [(words, record[key]) for key, words in shown.items() if key in record]
        return html.table(repr(self)[1:-1], (), rows) + ("" if self.check is None else self.check._repr_html_())
