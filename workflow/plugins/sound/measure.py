"""Sound under a static load: its dispersion, and the leading pulse on it against the long-wave theory's."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Self

import numpy as np

from granchain import Scene
from granchain.parts import Fact, Floats, Survey, long_waves, measurement, panels, physics, unit_cell
from workflow.plugins.sound.dispersion import Bands, Branches, DispersionMeter, Map
from workflow.plugins.sound.figure import dispersion_sheet
from workflow.plugins.sound.loaded_pulse import LoadedPulseMeter, LoadedWave, Sound, with_errors


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

    def sheet(self) -> panels.Sheet | None:
        """The map with the branches."""
        return None if self.map is None else dispersion_sheet(self.problem, self.map)

    @classmethod
    def meter(cls, run: measurement.Recorded) -> DispersionMeter | None:
        """Dispersion of chains under a static load."""
        return DispersionMeter(run.problem) if physics.loaded(run.problem.system) else None

    @classmethod
    def of_run(cls, run: measurement.Recorded, survey: Survey, measured: Map | str | None) -> Self | None:
        """Map and bands, or the reason why there are none."""
        del survey
        if measured is None:
            return None
        if isinstance(measured, str):
            return cls(run.problem, Bands(measured), None)
        return cls(run.problem, measured.bands(), measured)


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
        if self.problem.system.ground:
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
                f"the leading pulse runs at ({wave.over_sound:.5f} +- {wave.over_sound_error:.1g}) c0 past beads "
                f"{wave.first} to {wave.last}, with a largest force of {wave.force_ratio:.4g} +- "
                f"{wave.force_ratio_error:.1g} times the static one"
            )
            if math.isfinite(wave.theory):
                of_theory = f"{wave.over_theory:.5f} +- {wave.over_theory_error:.1g}"
                line += f"; its speed is {of_theory} of that of the long-wave theory (Nesterenko 2001)"
            yield line

    @classmethod
    def meter(cls, run: measurement.Recorded) -> LoadedPulseMeter | None:
        """The pulse under a static load, where it stays together and all beads are recorded."""
        problem = run.problem
        pulses = problem.rows.complete and problem.system.holds(Fact.PULSE)
        return LoadedPulseMeter(problem) if physics.loaded(problem.system) and pulses else None

    @classmethod
    def of_run(cls, run: measurement.Recorded, survey: Survey, measured: LoadedWave | None) -> Self | None:
        """Sound under a static load, and the leading pulse."""
        if not physics.loaded(run.problem.system):
            return None
        if measured is not None and run.error.measured:
            of_ratio = run.error.of_force(run.problem) / float(np.min(run.problem.system.along[0].law.load))
            of_speed = 2.0 * run.error.arrival * measured.speed**2 / abs(measured.last - measured.first)
            measured = with_errors(measured, run.problem, of_ratio, of_speed)
        length = bead_length(run.scene)
        return cls(run.problem, Sound.of(run.problem, measured, survey, length), length)


def bead_length(scene: Scene) -> float | None:
    """Distance of neighbouring beads at rest, in m; None without a material, and where it is not one."""
    system = scene.system
    if scene.material is None or not (physics.one_kind(system) and physics.even(system)):
        return None
    return 2.0 * scene.material.radius - float(system.along[0].law.rest) * scene.scale.length
