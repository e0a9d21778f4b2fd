"""Sound under a static load, and the leading pulse on it against the long-wave theory's."""

import math
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from analysis.shape.loaded_wave import sound_speed
from analysis.sharing.survey import Survey
from analysis.sound.loaded_pulse import LoadedPulse, LoadedWave
from analysis.tracking.pulses import Pulse
from lammps_inputs import Scene, laws
from lammps_inputs.facts import Fact
from lammps_inputs.limits import rates
from lammps_inputs.numbers import known
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.findings.finding import Finding, Measure


@dataclass(frozen=True)
class Sound(Finding):
    """Its speed.

    Attributes:
        wave: the leading pulse; None where it did not come far enough.
        crests: of sound.
        bead_length: distance of neighbouring beads at rest, in m; None where there is no one such distance.
    """

    key = "sound"

    wave: LoadedWave | None
    crests: tuple[Pulse, ...]
    bead_length: float | None

    def plain(self) -> dict[str, Any]:
        """In the scene's units.

        | key       | what                                                                                        |
        |-----------|---------------------------------------------------------------------------------------------|
        | load      | least and largest force of a contact at rest                                                |
        | overlap   | at rest, of those                                                                           |
        | speed     | of sound of long waves, beads per unit time, least and largest along the chains             |
        | metres    | the same in m/s where all beads are of one material and size; else null                     |
        | cutoff    | highest angular frequency of small motions, springs between chains left out                 |
        | crest     | largest velocity of crests of sound, which are no pulses (analysis/README.md); null without |
        | pulse     | the leading pulse of the chain that was hit hardest, between the contacts ``first`` and     |
        |           | ``last``: ``force_ratio`` f of the largest force to that at rest, ``speed``, ``over_sound``,|
        |           | ``theory``: that of the long-wave theory (Nesterenko), and ``over_theory``: the quotient;   |
        |           | null: too short                                                                             |
        """
        problem, scale, wave, metres = self.problem, self.problem.scale, self.wave, self.bead_length
        load, rest = (np.asarray(find(problem.along[0].law)) for find in (laws.load, laws.rest))
        speed, ends = sound_speed(problem), (np.min, np.max)
        return {
            "load": [float(find(load) * scale.force) for find in ends],
            "overlap": [float(find(rest) * scale.length) for find in ends],
            "speed": [float(find(speed) / scale.time) for find in ends],
            "metres": None if metres is None else [float(find(speed) * metres / scale.time) for find in ends],
            "cutoff": rates.sound_frequency(problem) / scale.time,
            "crest": max((float(one.peak_velocity.max()) * scale.velocity for one in self.crests), default=None),
            "pulse": None
            if wave is None
            else {
                **asdict(wave),
                "speed": wave.speed / scale.time,
                "sound": wave.sound / scale.time,
                "theory": known(wave.theory),
                "over_sound": wave.over_sound,
                "over_theory": known(wave.over_theory),
            },
        }

    def said(self) -> Iterator[str]:
        """In one line."""
        scale, wave = self.problem.scale, self.wave
        speeds = sound_speed(self.problem) if wave is None else np.array([wave.sound])
        unit = "beads/s" if scale.si else "beads per unit time"
        said = [f"{speed / scale.time:.6g}" for speed in dict.fromkeys((float(speeds.min()), float(speeds.max())))]
        line = f"sound: c0 = {' to '.join(said)} {unit}"
        if self.bead_length is not None:
            line += f" ({float(speeds.max()) * self.bead_length / scale.time:.5g} m/s)"
        if wave is not None:
            line += (
                f"; the leading pulse runs at {wave.over_sound:.5f} c0 past beads {wave.first} to {wave.last}, "
                f"F_m/F_0 = {wave.force_ratio:.4g}"
            )
            if math.isfinite(wave.theory):
                line += f": {wave.over_theory:.5f} of what the long-wave theory says (Nesterenko)"
        yield line


def measure(directory: RunDirectory) -> Measure | None:
    """Under a static load; the pulse where it stays together, of all beads."""
    problem, scene = directory.problem, directory.scene
    if not problem.loaded:
        return None
    length = bead_length(scene)
    if not problem.whole or not problem.holds(Fact.PULSE):
        return Measure(lambda found: Sound(problem, None, found.crests, length))
    pulse = LoadedPulse(problem)

    def finish(found: Survey) -> Sound:
        return Sound(problem, pulse.result(), found.crests, length)

    return Measure(finish, pulse.add)


def bead_length(scene: Scene) -> float | None:
    """Distance of neighbouring beads at rest, in m; None without a material, and where it is not one."""
    system = scene.system
    if scene.material is None or not (system.one_kind and system.even):
        return None
    return 2.0 * scene.material.radius - float(laws.rest(system.along[0].law)) * scene.scale.length
