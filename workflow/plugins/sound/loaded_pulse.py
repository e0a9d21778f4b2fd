"""The leading pulse on top of a static load: its speed, and the contact force in it over that at rest."""

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from granchain.parts import (
    Floats,
    Integers,
    Meter,
    Part,
    Problem,
    Survey,
    hermite,
    long_waves,
    motion,
    physics,
    quantity,
    rates,
    unit_cell,
)

CLEAR = 5
"""Contacts from the far end, nearer to which the pulse feels it, and as many that it must have passed at least."""

FRONT = 1.5
"""More of them, over the cube root of the contacts from the start on, for so fronts of sound spread: their speed
feels the end by less than a thousandth there."""

OVER = 10
"""Contacts over which speed and force are measured, as far as the pulse has come; more where whole cells are more."""

SMALLEST = 1e-3
"""Velocity, in units of V, of a pulse whose overlap counts."""


UNCERTAIN = "by the time between frames, the change by polynomials without second derivatives, and by the run"


@quantity.result
class LoadedWave:
    """The leading pulse of the kicked chain, where it was last clear of the ends."""

    chain: int = quantity.declare("number of the chain")
    first: int = quantity.declare("first contact between which speed and force were measured")
    last: int = quantity.declare("last contact between which speed and force were measured")
    force_ratio: float = quantity.declare(
        "mean of the largest total force of a contact over that at rest", symbol="F_m / F_0"
    )
    speed: float = quantity.declare("speed of the pulse", "speed", symbol="c")
    sound: float = quantity.declare("mean speed of sound there, as ``speed`` of the chains", "speed", symbol="c_0")
    theory: float = quantity.declare(
        "speed of the long-wave theory's solitary wave of this force ratio over that of sound (Nesterenko)",
        undefined="beads differ",
    )
    force_ratio_error: float = quantity.declare(f"uncertainty of ``force_ratio``: {UNCERTAIN}", default=math.nan)
    speed_error: float = quantity.declare(f"uncertainty of ``speed``: {UNCERTAIN}", "speed", default=math.nan)
    theory_error: float = quantity.declare(
        "uncertainty of ``theory`` by that of ``force_ratio``", undefined="beads differ", default=math.nan
    )

    @property
    @quantity.derived()
    def over_sound_error(self) -> float:
        """Uncertainty of ``over_sound``, relative to it as that of ``speed``."""
        return self.speed_error / self.sound

    @property
    @quantity.derived(undefined="beads differ")
    def over_theory_error(self) -> float:
        """Uncertainty of ``over_theory``: the sum of those of ``speed`` and ``theory``, relative to them."""
        return self.over_theory * (self.speed_error / self.speed + self.theory_error / self.theory)

    @property
    @quantity.derived(symbol="c / c_0")
    def over_sound(self) -> float:
        """Speed of the pulse over that of sound."""
        return self.speed / self.sound

    @property
    @quantity.derived(undefined="beads differ")
    def over_theory(self) -> float:
        """Speed of the pulse over that of the theory's wave."""
        return self.over_sound / self.theory


@quantity.result
class Sound:
    """Sound of chains under a static load, and the leading pulse."""

    load: Floats = quantity.declare("least and largest force of a contact at rest", "force", symbol="F_0")
    overlap: Floats = quantity.declare("least and largest overlap at rest", "length")
    speed: Floats | None = quantity.declare(
        "least and largest speed of sound of long waves, at each bead 1 / sqrt(m s): mean mass m of five beads "
        "(weights 1, 2, 2, 2, 1), mean compliance s of six contacts (1, 3, 4, 4, 3, 1), or whole cells",
        "speed",
        "a foundation holds beads, so that long waves do not run",
        "c_0",
    )
    metres: Floats | None = quantity.declare(
        "``speed`` in m/s",
        "m/s",
        "without a material, where beads or static loads differ along the chains, or no long waves run",
    )
    cutoff: float = quantity.declare(
        "highest angular frequency of small motions; an upper bound of it where beads, springs or loads do not repeat "
        "along the chains",
        "frequency",
    )
    crest: float | None = quantity.declare(
        "largest velocity of crests of sound, which are no pulses (analysis/README.md)", "velocity", "there is none"
    )
    pulse: LoadedWave | None = quantity.declare(
        "the leading pulse of the kicked chain", undefined="it did not run far enough, or does not keep its shape"
    )

    @classmethod
    def of(cls, problem: Problem, pulse: LoadedWave | None, survey: Survey, bead_length: float | None) -> "Sound":
        """Sound in the chains of a problem.

        Args:
            problem: what was run.
            pulse: the leading pulse; None where it did not run far enough.
            survey: crests of sound in the run.
            bead_length: distance of neighbouring beads at rest in m, or None.
        """
        system = problem.system
        load, rest = map(np.asarray, (system.along[0].law.load, system.along[0].law.rest))
        branches = unit_cell.bands(system)
        speed = None if system.ground else _ends(long_waves.sound_speed(system))
        return cls(
            load=_ends(load),
            overlap=_ends(rest),
            speed=speed,
            metres=None if bead_length is None or speed is None else speed / problem.scale.time * bead_length,
            cutoff=rates.modal_frequency(system) if branches is None else float(branches.max()),
            crest=max((float(crest.peak_velocity.max()) for crest in survey.crests), default=None),
            pulse=pulse,
        )


def _ends(values: Floats) -> Floats:
    return np.array([np.min(values), np.max(values)])


class Maxima(NamedTuple):
    """First maximum of the overlap of each of some contacts in a part of a run, each [contact].

    Attributes:
        chain, contact: positions, from 0.
        arrival: time of the maximum, in units of T.
        strain: the maximum above the overlap at rest, in units of L.
        arrival_error, strain_error: changes of both by a polynomial through values and first derivatives alone.
    """

    chain: Integers
    contact: Integers
    arrival: Floats
    strain: Floats
    arrival_error: Floats
    strain_error: Floats


@dataclass(frozen=True)
class LoadedPulseMeter(Meter[Maxima, LoadedWave | None]):
    """Leading pulse of the kicked chain in a run of all beads, by the first maximum of every overlap.

    Between two frames an overlap is the polynomial of degree five through its value and two derivatives there.

    Attributes:
        problem: what was run.
    """

    problem: Problem

    def of_part(self, part: Part) -> Maxima:
        """First maxima between the frames of a part, to the first frame of the next."""
        block = part.to_next
        x, v = block.displacement, block.velocity
        strain, rate = x[..., :-1] - x[..., 1:], v[..., :-1] - v[..., 1:]
        high = np.maximum(strain[:-1], strain[1:]) > SMALLEST / rates.front_speed(self.problem.system)
        frame, chain, contact = np.nonzero(high & (rate[:-1] > 0.0) & (rate[1:] <= 0.0))
        _, earliest = np.unique(chain * strain.shape[2] + contact, return_index=True)  # first maximum of each contact
        frame, chain, contact = frame[earliest], chain[earliest], contact[earliest]
        if len(frame) == 0:
            return Maxima(chain, contact, *np.zeros((4, 0)))
        data = np.stack([motion.strain_and_rates(block, at, chain, contact) for at in (frame, frame + 1)])

        def maximum(derivatives: int) -> Floats:
            """Time since the frame and largest strain, [time or strain, contact], by the first of the derivatives."""
            polynomial = hermite.coefficients((0, 1), data[:, :derivatives], block.spacing)
            at = hermite.falling_zero(hermite.derivative(polynomial), np.zeros(len(frame)), np.ones(len(frame)))
            return np.array([at * block.spacing, hermite.value(polynomial, at)])

        since, strain = maximum(3)
        return Maxima(chain, contact, block.time[frame] + since, strain, *np.abs(maximum(2) - [since, strain]))

    def result(self, pieces: list[Maxima]) -> LoadedWave | None:
        """Leading pulse of the kicked chain; None where it did not come far enough."""
        problem = self.problem
        arrival, largest, late, off = np.full((4, problem.chains, problem.beads - 1), np.nan)
        for chains, contacts, *maxima in reversed(pieces):  # the earliest stay
            for table, values in zip((arrival, largest, late, off), maxima, strict=True):
                table[chains, contacts] = values
        system = problem.system
        direction = problem.direction
        number, bead, _ = physics.largest_excitation(system)
        chain, count = number - 1, problem.beads - 1
        contact = np.arange(count)
        distance = contact - (bead - 1) if direction > 0 else (bead - 2) - contact
        ahead = count - contact if direction > 0 else contact + 1
        clear = (distance >= 0) & (ahead > CLEAR + FRONT * np.cbrt(distance))
        reached = contact[clear & np.isfinite(arrival[chain])]
        if len(reached) < CLEAR:
            return None
        cell = long_waves.cell_beads(system)
        over = cell * min(-(-OVER // cell), max(1, (len(reached) - 1) // cell))
        used = reached[-over - 1 :] if direction > 0 else reached[: over + 1]
        first, last = (int(used[0]), int(used[-1])) if direction > 0 else (int(used[-1]), int(used[0]))
        overlap = system.along[0].law.rest + np.where(np.isfinite(largest), largest, 0.0)
        force = motion.contact_force(system, overlap)
        load = np.broadcast_to(system.along[0].law.load, force.shape)
        if not np.all(load[chain, used] > 0.0):
            return None
        ratio = float(np.mean(force[chain, used] / load[chain, used]))
        taken = float(arrival[chain, last] - arrival[chain, first])
        sound = float(np.mean(long_waves.sound_speed(system)[chain, used]))
        speed = abs(last - first) / taken
        wave = LoadedWave(number, first + 1, last + 1, ratio, speed, sound, _theory(problem, ratio))
        higher = motion.contact_force(system, overlap + np.nan_to_num(off))
        of_ratio = float(np.mean((higher - force)[chain, used] / load[chain, used]))
        return with_errors(wave, problem, of_ratio, speed * float(late[chain, first] + late[chain, last]) / taken)


def _theory(problem: Problem, ratio: float) -> float:
    """Speed of the theory's wave of a force ratio over that of sound; NaN where beads differ."""
    if not physics.one_kind(problem.system):
        return np.nan
    return float(long_waves.speed_over_sound(ratio, physics.exponent(problem.system) or 1.5))


def with_errors(wave: LoadedWave, problem: Problem, of_ratio: float, of_speed: float) -> LoadedWave:
    """A wave with uncertainties of its force ratio and speed; more of them where it has some."""
    of_ratio += float(np.nan_to_num(wave.force_ratio_error))
    of_speed += float(np.nan_to_num(wave.speed_error))
    of_theory = _theory(problem, wave.force_ratio + of_ratio) - wave.theory
    return replace(wave, force_ratio_error=of_ratio, speed_error=of_speed, theory_error=abs(of_theory))
