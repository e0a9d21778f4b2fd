"""Sound under a static load: its dispersion, and the leading pulse on it against the long-wave theory's."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from granchain import Scene
from granchain.parts import Fact, Floats, Problem, Survey, Trajectory, laws, long_waves, measurement, physics, unit_cell
from workflow.plugins.sound.dispersion import Bands, Branches, Dispersion, Map
from workflow.plugins.sound.loaded_pulse import LoadedPulse, Sound

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, repr=False)
class DispersionMeasurement(measurement.Measurement):
    """Bands, and the map that they are from; None where there is none."""

    key, kind, figure = "dispersion", Bands, "dispersion"
    table = "dispersion.csv", Branches

    values: Bands
    map: Map | None

    def lines(self) -> Iterator[str]:
        """Why there is none."""
        if self.values.why is not None:
            yield f"there is no dispersion map: {self.values.why}"

    def rows(self) -> Branches | None:
        """The branches."""
        return None if self.map is None else self.map.branches()

    @property
    def drawable(self) -> bool:
        """Where there is a map."""
        return self.map is not None

    def draw(self) -> "Figure":
        """The map with the branches."""
        from workflow.plugins.sound.figure import dispersion_figure

        assert self.map is not None
        return dispersion_figure(self.problem, self.map)

    @classmethod
    def meter(cls, run: measurement.Recorded) -> "DispersionMeter | None":
        """Dispersion of chains under a static load."""
        return DispersionMeter(run.problem) if physics.loaded(run.problem.system) else None


class DispersionMeter(measurement.Meter):
    """The map of velocities, or the reason why there is none."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self._collected, self._why = None, ""
        try:
            self._collected = Dispersion(problem)
        except unit_cell.NoDispersionError as error:
            self._why = str(error)

    def add(self, block: Trajectory) -> None:
        """Take the next frames."""
        if self._collected is not None:
            self._collected.add(block)

    def finish(self, survey: Survey) -> DispersionMeasurement:
        """Map and bands of all frames."""
        del survey
        if self._collected is None:
            return DispersionMeasurement(self.problem, Bands(self._why), None)
        try:
            dispersion = self._collected.result()
        except unit_cell.NoDispersionError as error:
            return DispersionMeasurement(self.problem, Bands(str(error)), None)
        return DispersionMeasurement(self.problem, dispersion.bands(), dispersion)


@dataclass(frozen=True, repr=False)
class SoundMeasurement(measurement.Measurement):
    """Speed of sound, and the leading pulse."""

    key, kind = "sound", Sound

    values: Sound
    bead_length: float | None
    """Distance of neighbouring beads at rest, in m; None where there is no one such distance."""

    @property
    def local_speed(self) -> Floats:
        """Speed of sound at each bead, [chain, bead] in beads / T."""
        return long_waves.sound_speed(self.problem.system)

    def lines(self) -> Iterator[str]:
        """Speed of sound, and the leading pulse against it."""
        scale, wave, frequencies = self.problem.scale, self.values.pulse, unit_cell.bands(self.problem.system)
        if physics.ground_springs(self.problem.system):
            line = "long waves of sound do not run, as springs to the ground hold the beads"
            if frequencies is not None:
                low, high = (
                    f"{scale.measured(end, 'frequency'):.6g}" for end in (frequencies.min(), frequencies.max())
                )
                line += f"; small waves have frequencies from {low} to {high}{scale.each('rad')}"
            yield line
            return
        speeds = self.local_speed if wave is None else np.array([wave.sound])
        numbers = dict.fromkeys(f"{speed / scale.time:.6g}" for speed in (float(speeds.min()), float(speeds.max())))
        line = f"the speed of sound is c0 = {' to '.join(numbers)}{scale.each('beads')}"
        if self.bead_length is not None:
            line += f" ({float(speeds.max()) * self.bead_length / scale.time:.5g} m/s)"
        yield line
        if wave is not None:
            line = (
                f"the leading pulse runs at {wave.over_sound:.5f} c0 past beads {wave.first} to {wave.last}, with a "
                f"largest force of {wave.force_ratio:.4g} times the static one"
            )
            if math.isfinite(wave.theory):
                line += f"; its speed is {wave.over_theory:.5f} of that of the long-wave theory (Nesterenko 2001)"
            yield line

    @classmethod
    def meter(cls, run: measurement.Recorded) -> "SoundMeter | None":
        """Sound under a static load; the pulse where it stays together and all beads are recorded."""
        return SoundMeter(run) if physics.loaded(run.problem.system) else None


class SoundMeter(measurement.Meter):
    """Speed of sound, and the leading pulse on it."""

    def __init__(self, run: measurement.Recorded) -> None:
        self.problem = run.problem
        self._length = bead_length(run.scene)
        pulses = run.problem.rows.complete and run.problem.system.holds(Fact.PULSE)
        self._pulse = LoadedPulse(run.problem) if pulses else None

    def add(self, block: Trajectory) -> None:
        """Take the next frames."""
        if self._pulse is not None:
            self._pulse.add(block)

    def finish(self, survey: Survey) -> SoundMeasurement:
        """Sound and the leading pulse of all frames."""
        wave = None if self._pulse is None else self._pulse.result()
        sound = Sound.of(self.problem, wave, survey, self._length)
        return SoundMeasurement(self.problem, sound, self._length)


def bead_length(scene: Scene) -> float | None:
    """Distance of neighbouring beads at rest, in m; None without a material, and where it is not one."""
    system = scene.system
    if scene.material is None or not (physics.one_kind(system) and physics.even(system)):
        return None
    return 2.0 * scene.material.radius - float(laws.rest(system.along[0].law)) * scene.scale.length
