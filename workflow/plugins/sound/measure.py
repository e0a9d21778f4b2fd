"""Sound under a static load: its dispersion, and the leading pulse on it against the long-wave theory's."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from granchain import Scene
from granchain.parts import (
    Fact,
    Floats,
    FrameMeter,
    Measurement,
    NoDispersionError,
    Recorded,
    Survey,
    bands,
    laws,
    physics,
    sound_speed,
)
from workflow.plugins.sound.dispersion import Bands, Branches, Map
from workflow.plugins.sound.dispersion import Dispersion as Collected
from workflow.plugins.sound.loaded_pulse import LoadedPulse
from workflow.plugins.sound.loaded_pulse import Sound as Measured

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, repr=False)
class DispersionMeasurement(Measurement):
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
    def meter(cls, run: Recorded) -> FrameMeter | None:
        """Dispersion of chains under a static load."""
        problem = run.problem
        if not physics.loaded(problem.system):
            return None
        try:
            collected = Collected(problem)
        except NoDispersionError as error:
            why = Bands(str(error))
            return FrameMeter(lambda _: cls(problem, why, None))

        def finish(_: Survey) -> DispersionMeasurement:
            try:
                dispersion = collected.result()
            except NoDispersionError as error:
                return cls(problem, Bands(str(error)), None)
            return cls(problem, dispersion.bands(), dispersion)

        return FrameMeter(finish, collected.add)


@dataclass(frozen=True, repr=False)
class SoundMeasurement(Measurement):
    """Speed of sound, and the leading pulse."""

    key, kind = "sound", Measured

    values: Measured
    bead_length: float | None
    """Distance of neighbouring beads at rest, in m; None where there is no one such distance."""

    @property
    def local_speed(self) -> Floats:
        """Speed of sound at each bead, [chain, bead] in beads / T."""
        return sound_speed(self.problem.system)

    def lines(self) -> Iterator[str]:
        """Speed of sound, and the leading pulse against it."""
        scale, wave, frequencies = self.problem.scale, self.values.pulse, bands(self.problem.system)
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
    def meter(cls, run: Recorded) -> FrameMeter | None:
        """Sound under a static load; the pulse where it stays together and all beads are recorded."""
        problem = run.problem
        if not physics.loaded(problem.system):
            return None
        length = bead_length(run.scene)
        pulse = LoadedPulse(problem) if problem.whole and problem.system.holds(Fact.PULSE) else None

        def finish(survey: Survey) -> SoundMeasurement:
            wave = None if pulse is None else pulse.result()
            return cls(problem, Measured.of(problem, wave, survey.crests, length), length)

        return FrameMeter(finish) if pulse is None else FrameMeter(finish, pulse.add)


def bead_length(scene: Scene) -> float | None:
    """Distance of neighbouring beads at rest, in m; None without a material, and where it is not one."""
    system = scene.system
    if scene.material is None or not (physics.one_kind(system) and physics.even(system)):
        return None
    return 2.0 * scene.material.radius - float(laws.rest(system.along[0].law)) * scene.scale.length
