"""What entries ask of a finished run, read when first asked for; dimensionless."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from analysis.gauges.forces import ForceMeter
from analysis.gauges.gauge import gauges
from analysis.gauges.readings import Readings
from analysis.sharing.cells import left
from analysis.sharing.energy_flow import EnergyFlow, Flow
from analysis.sharing.survey import survey
from analysis.tracking.leading_waves import Waves, leading_waves
from analysis.tracking.peaks import PeakFinder, Peaks
from analysis.tracking.pulses import Pulse, track_pulses
from analysis.tracking.train import Train, train_of
from analysis.trajectory import Floats, Trajectory
from lammps_inputs import Problem
from workflow.runs.run_directory import RunDirectory
from workflow.studies.kept_runs import errors


@dataclass(frozen=True)
class Ran:
    """A run of one scene by one engine."""

    directory: RunDirectory

    @property
    def problem(self) -> Problem:
        """What was run."""
        return self.directory.problem

    @property
    def errors(self) -> tuple[float, float]:
        """Bounds on the errors of peak velocities (V) and of arrivals (T)."""
        return errors(self.directory)

    @cached_property
    def trajectory(self) -> Trajectory:
        """All frames."""
        return self.directory.trajectory

    @cached_property
    def _forwards(self) -> Peaks:
        return self._peaks(1)

    @cached_property
    def _backwards(self) -> Peaks:
        return self._peaks(-1)

    def _peaks(self, direction: int) -> Peaks:
        finder = PeakFinder(direction=direction)
        for block in self.directory.blocks():
            finder.add(block)
        return finder.result()

    @cached_property
    def waves(self) -> Waves:
        """Leading pulse at every bead."""
        return leading_waves(self._forwards)

    def peak(self, bead: int, chain: int = 1) -> float:
        """Velocity of the leading pulse at a bead."""
        return float(self.waves.of_chain(chain).at(bead).peak_velocity[0])

    def passages(self, bead: int) -> Floats:
        """Times of all maxima of the velocity of a bead of chain 1."""
        peaks = self._forwards
        return np.asarray(peaks.time[(peaks.bead == bead) & (peaks.chain == 1)])

    def speed(self, first: int, last: int) -> float:
        """Beads per unit time of the leading pulse of chain 1 between two beads."""
        arrival = [float(self.waves.of_chain(1).at(bead).arrival[0]) for bead in (first, last)]
        return (last - first) / (arrival[1] - arrival[0])

    def pulses(self, direction: int = 1, smallest: float = 0.01) -> tuple[Pulse, ...]:
        """Every pulse that runs one way and reaches a velocity."""
        return track_pulses(self._forwards if direction > 0 else self._backwards, self.problem, smallest=smallest)

    def train(self, bead: int, smallest: float = 0.01) -> Train:
        """Pulses that pass a bead of chain 1 one behind the other."""
        return train_of(self.pulses(1, smallest), 1, 1, bead)

    def forces(self, *, contacts: Iterable[int] = (), wall: bool = False) -> Readings:
        """What gauges at walls and in contacts (between bead n and the next) read."""
        meter = ForceMeter(self.problem, gauges(self.problem, wall=wall, contacts=tuple(contacts), sensors=()))
        for block in self.directory.blocks():
            meter.add(block)
        return meter.result()

    def left_behind(self, period: int) -> float:
        """Share of the energy that chain 1's pulse loses from one cell to the next; NaN where it ran none."""
        found = left(survey(self.directory.blocks, self.problem), 1, period)
        return float("nan") if found is None else found.per_cell

    @cached_property
    def flow(self) -> Flow:
        """Energy of the chains over time."""
        flow = EnergyFlow(self.problem)
        for block in self.directory.blocks():
            flow.add(block)
        return flow.result()

    def width(self, bead: int) -> float:
        """Full width at half maximum of the leading pulse at a bead of chain 1, in beads: time there times speed."""
        run = self.trajectory
        place = int(np.flatnonzero(run.beads == bead)[0])
        velocity, time = run.velocity[:, 0, place], run.time
        half = 0.5 * self.peak(bead)
        above = np.flatnonzero(velocity > half)
        first = int(above[0])
        last = first + int(np.argmin(velocity[first:] > half)) - 1
        rise = np.interp(half, velocity[first - 1 : first + 1], time[first - 1 : first + 1])
        fall = np.interp(-half, -velocity[last : last + 2], time[last : last + 2])
        return float(fall - rise) * self.speed(bead - 5, bead + 5)
