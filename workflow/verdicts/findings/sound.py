"""Sound under a static load, and the leading pulse on it against the long-wave theory's."""

import math
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from analysis.shape.loaded_wave import sound_speed
from analysis.sharing.survey import Survey
from analysis.sound.dispersion import NoDispersionError, cell_of
from analysis.sound.loaded_pulse import LoadedPulse, LoadedWave
from analysis.tracking.pulses import Pulse
from analysis.trajectory import Floats
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
        | speed     | of sound of long waves, beads per unit time, least and largest along the chains; null where |
        |           | springs to the ground hold beads, which long waves then do not move                         |
        | metres    | the same in m/s where all beads are of one material and size; else null                     |
        | cutoff    | highest angular frequency of small motions; where beads, springs or loads do not repeat     |
        |           | along the chains, an upper bound of it                                                      |
        | crest     | largest velocity of crests of sound, which are no pulses (analysis/README.md); null without |
        | pulse     | the leading pulse of the chain that was hit hardest, between the contacts ``first`` and     |
        |           | ``last``: ``force_ratio`` f of the largest force to that at rest, ``speed``, ``over_sound``,|
        |           | ``theory``: that of the long-wave theory (Nesterenko), and ``over_theory``: the quotient;   |
        |           | null: too short                                                                             |
        """
        problem, scale, wave, metres = self.problem, self.problem.scale, self.wave, self.bead_length
        load, rest = (np.asarray(find(problem.along[0].law)) for find in (laws.load, laws.rest))
        ends, bands = (np.min, np.max), self.bands
        speed = None if problem.held else [float(find(sound_speed(problem)) / scale.time) for find in ends]
        return {
            "load": [float(find(load) * scale.force) for find in ends],
            "overlap": [float(find(rest) * scale.length) for find in ends],
            "speed": speed,
            "metres": None if metres is None or speed is None else [one * metres for one in speed],
            "cutoff": (rates.swing(problem) if bands is None else float(bands.max())) / scale.time,
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

    @property
    def bands(self) -> Floats | None:
        """Lowest and highest angular frequency of every branch of small waves; None where nothing repeats."""
        try:
            return cell_of(self.problem).bands()
        except NoDispersionError:
            return None

    def said(self) -> Iterator[str]:
        """In one line."""
        scale, wave, bands = self.problem.scale, self.wave, self.bands
        if self.problem.held:
            line = "sound: long waves do not run, for springs to the ground hold the beads"
            if bands is not None:
                unit = "rad/s" if scale.si else "rad per unit time"
                line += f"; small ones have frequencies from {bands.min() / scale.time:.6g} to "
                line += f"{bands.max() / scale.time:.6g} {unit}"
            yield line
            return
        speeds = sound_speed(self.problem) if wave is None else np.array([wave.sound])
        unit = "beads/s" if scale.si else "beads per unit time"
        said = dict.fromkeys(f"{speed / scale.time:.6g}" for speed in (float(speeds.min()), float(speeds.max())))
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
