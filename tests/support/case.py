"""A run with all that it is compared with: its frames, its own statement of its error, and the true motion."""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from own_frames import Directory, Frames
from scene_keys import hardest, kicks
from scenes_nature import Floats, Nature, Units
from truth import Truth

from lammps_inputs import Scene

FLOOR = 1e-5
"""Of V, and of T: below it nothing counts."""


@dataclass(frozen=True)
class Stated:
    """What a run says of itself, dimensionless: bounds on its velocities, peaks and arrivals."""

    velocity: float
    peak: float
    arrival: float

    @classmethod
    def of(cls, record: dict[str, Any]) -> "Stated":
        """From ``run.json``; a null is not known."""
        check, sure = record["check"], record["check"]["reference"]
        late = [number for number in (check["arrival"], sure["arrival"]) if number is not None]
        peak = max(number for number in (check["velocity"], check["amplitude"]) if number is not None)
        own = float(sure["velocity"])
        return cls(check["velocity"] + own, peak + own, float(sum(late)))


@dataclass(eq=False)
class Case:
    """One run."""

    directory: Directory
    rtol: float = 1e-9
    printed: dict[str, str] = field(default_factory=dict)
    """What commands have printed, by their names."""
    kept: dict[str, Any] = field(default_factory=dict)
    """What several topics need."""

    @cached_property
    def truth(self) -> Truth:
        return Truth(self.scene, self.directory.duration, self.rtol)

    @cached_property
    def stated(self) -> Stated:
        return Stated.of(self.directory.record)

    @cached_property
    def report(self) -> dict[str, Any]:
        return self.directory.report

    @property
    def scene(self) -> Scene:
        return self.directory.scene

    @property
    def nature(self) -> Nature:
        return self.directory.nature

    @property
    def unit(self) -> Units:
        return self.directory.unit

    @property
    def frames(self) -> Frames:
        return self.directory.frames

    @property
    def every(self) -> float:
        return self.directory.every

    @property
    def windowed(self) -> bool:
        return self.scene.window is not None and self.scene.window < self.scene.beads

    @cached_property
    def of_all(self) -> Frames | None:
        """Frames of all beads: the run's, or its snapshots; None if there are none."""
        if self.directory.snapshots is not None:
            return self.directory.snapshots
        return self.frames if self.directory.whole else None

    # --- what kind of scene -------------------------------------------------------------------------------------------

    @property
    def acted_on(self) -> bool:
        return bool(self.nature.pushes or self.nature.moved)

    @property
    def driven(self) -> bool:
        return bool(self.scene.drive)

    @property
    def exchanges(self) -> bool:
        return self.acted_on or self.nature.lossy

    @property
    def pulse(self) -> bool:
        """Whether a pulse leads: not on a foundation, with a drive, or in contacts of an exponent near 1."""
        return not (self.scene.foundation or self.scene.drive or self.nature.exponent < 1.05)

    @property
    def alike(self) -> bool:
        own = self.nature
        return bool(np.all(own.mass == 1.0) and np.ptp(own.strength) == 0.0 and np.ptp(own.load) == 0.0)

    @property
    def one_kind(self) -> bool:
        """Whether all beads and contacts are the same, whatever load they bear evenly."""
        return self.alike

    @property
    def way(self) -> int:
        return 1 if hardest(self.scene)[2] > 0.0 else -1

    @property
    def opposed(self) -> bool:
        from scene_keys import blows

        return any(blow * self.way < 0.0 for *_, blow in blows(self.scene))

    @property
    def kicked(self) -> bool:
        return bool(kicks(self.scene))

    # --- how far off --------------------------------------------------------------------------------------------------

    @cached_property
    def off(self) -> tuple[float, float]:
        """Largest differences of displacements and velocities in the frames from the true ones."""
        worst = np.zeros(2)
        for frames in (self.frames, self.directory.snapshots):
            if frames is None:
                continue
            for start in range(0, len(frames), 500):
                part = slice(start, start + 500)
                true = self.truth.states(frames.time[part])
                for k, (own, exact) in enumerate(zip((frames.x[part], frames.v[part]), true, strict=True)):
                    worst[k] = max(worst[k], float(np.nanmax(np.where(self._near(own), np.abs(own - exact), 0.0))))
        return float(worst[0]), float(worst[1])

    def _near(self, values: Floats) -> Any:
        """Which are there; of a window that has moved its half near the head."""
        there = np.isfinite(values)
        if not self.windowed:
            return there
        tail = np.argmax(there[:, 0], axis=-1)
        place = np.arange(self.scene.beads)
        return (
            there
            & ((place >= tail[:, np.newaxis] + self.scene.window // 2) | (tail[:, np.newaxis] == 0))[:, np.newaxis]
        )

    @cached_property
    def energy_off(self) -> float:
        """Error of an energy that follows from errors of states so large, dimensionless."""
        x, v = self.truth.fine
        own, (off_x, off_v) = self.nature, self.off
        momenta = float(np.max(np.sum(own.mass * np.abs(v), axis=(-2, -1))))
        along = np.abs(own.elastic(x) - own.load)
        forces = float(np.max(np.sum(along, axis=(-2, -1)))) + float(
            np.max(np.sum(np.abs(own.ground[0] * x), (-2, -1)))
        )
        for one, other, k, c in own.springs:
            apart = np.abs(x[:, other] - x[:, one])
            forces += float(np.max(np.sum(k * apart + c * apart**3, axis=-1)))
        return 2.0 * momenta * off_v + 4.0 * forces * off_x + own.mass.size * off_v**2

    @cached_property
    def force_off(self) -> float:
        """Error of a contact's force likewise, and by what a polynomial between frames leaves of it."""
        x, _ = self.truth.fine
        own, (off_x, off_v) = self.nature, self.off
        p, most = own.exponent, float(np.max(own.overlap(x), initial=0.0))
        hard = float(np.max(own.strength))
        for wall in own.walls:
            reach = float(np.max(wall.rest + wall.side * x[:, :, wall.bead] - own.gap))
            most, hard = max(most, reach), max(hard, float(np.max(wall.strength)))
        stiff = p * hard * max(most, 1e-9) ** (p - 1.0)
        lossy = float(np.max(own.loss[0])) * max(most, 1e-9) ** own.loss[1]
        lossy = max([lossy, *(float(np.max(wall.loss)) * max(most, 1e-9) ** own.loss[1] for wall in own.walls)])
        # displacements rise as (t - t0)**3.5 where a contact closes, faster in stiffer contacts of lighter beads
        quick = self.every * (hard / float(np.min(own.mass))) ** 0.5
        return 2.0 * (stiff * (off_x + 1e-3 * quick**3.5) + lossy * (off_v + 1e-2 * quick**2.5)) + 1e-9


def instants(frames: Frames, most: int = 500, *, last: bool = False) -> Any:
    """Positions of at most so many frames, evenly spaced from the first on; and the last."""
    chosen = np.arange(0, len(frames), -(-len(frames) // most))
    return np.append(chosen, len(frames) - 1) if last and chosen[-1] != len(frames) - 1 else chosen


def summed(parts: dict[str, Floats]) -> Floats:
    return np.asarray(sum(parts.values()))
