"""Everything that is found in a run by reading it twice: first its peaks, then the states around them; or parts of it.

A run is given as a function that reads it again, block by block, so that it need not fit into memory.
"""

import copy
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from analysis.columns import together
from analysis.compare.common_times import near_the_front
from analysis.conservation import energy_input
from analysis.meters import Meter, Part, measured
from analysis.shape.exact_wave import wave_of
from analysis.shape.long_waves import LoadedSpeed
from analysis.shape.waveforms import Passages, Shape, WaveformMeter, Waveforms, reach
from analysis.sharing.energies import EnergyShares, ShareMeter
from analysis.sharing.equipartition import Sharing, runs_exact_waves, sharing
from analysis.sharing.impulses import Impulses, meter_of
from analysis.sharing.is_solitary import Character, Tolerances, characterise, measured_at
from analysis.sharing.verdict import DecayFit, Verdict, fit_decay, verdict_on
from analysis.tracking.leading_passages import beyond_kicks, of_pulses, opposed
from analysis.tracking.leading_waves import (
    Arrival,
    Lags,
    Waves,
    lags,
    leading_waves,
    speeds_of_pulses,
    usual_arrival,
)
from analysis.tracking.peaks import PeakMeter, Peaks
from analysis.tracking.pulses import Pulse, Train, ahead_of_sound, track_pulses, train_of
from analysis.tracking.succession import Change, changes
from analysis.tracking.undisturbed import CLEAR, clear_of_ends, clear_of_others, once_each, returns
from analysis.trajectory import Flags, Floats, Integers, Trajectory, along_the_way
from lammps_inputs import Problem, physics

MAX_PASSAGES = 4000
"""Leading passages whose waveform is kept; beyond, every second bead, every third, ..."""

HALF = 2.0
"""Beads from its peak within which the exact wave has all but 1e-5 of its energy."""


@dataclass(frozen=True, repr=False, eq=False)
class Survey:
    """Waves, pulses and energies of a run: each part is computed when it is first needed, from what it needs alone.

    `survey` computes all of them in two readings. Else every part that needs frames reads them, as is best where they
    are in memory.

    Attributes:
        problem: what was run.
        read: starts reading the run: consecutive blocks of frames, the first frame being the start. They are frames
            with their exchange (`analysis.trajectory.EXCHANGES`) where forces from outside act on the beads.
        arrival: what an arrival of ``waves`` is; the passages of ``pulses`` are always the maxima.
        tolerances: within which a pulse counts as solitary.

    Examples:
        >>> problem = granchain.load("one-chain", {"beads": 20, "duration": 30.0}).problem()
        >>> frames = engine.run(problem)
        >>> survey = Survey(problem, frames.blocks, arrival="maximum")
        >>> survey.waves.at(15).arrival.round(2), survey.waves.at(15).peak_velocity.round(3)  # in units of T and V
        (array([17.43]), array([0.682]))
        >>> len(survey.pulses), survey.pulses[0].direction
        (1, 1)
    """

    problem: Problem
    read: Callable[[], Iterable[Trajectory]]
    arrival: Arrival
    tolerances: Tolerances | None = None

    def replaced(self, **parts: Any) -> "Survey":
        """A survey with other parts, in which the parts that have been computed stay as they are."""
        other = copy.copy(self)
        vars(other).update(parts)
        return other

    @property
    def direction(self) -> int:
        """1 if the largest kick is towards higher bead numbers, else -1.

        The leading waves run that way, and in ``shared``, ``energies``, ``decay`` and ``verdict`` beads are counted
        along it (from the last bead if -1).
        """
        return self.problem.direction

    @cached_property
    def peaks_upwards(self) -> Peaks:
        """Peaks of the waves towards higher bead numbers."""
        peaks_upwards: Peaks = self._read_alone("peaks_upwards")
        return peaks_upwards

    @cached_property
    def peaks_downwards(self) -> Peaks:
        """Peaks of the waves towards lower bead numbers."""
        peaks_downwards: Peaks = self._read_alone("peaks_downwards")
        return peaks_downwards

    @cached_property
    def impulses(self) -> Impulses | None:
        """Impulses of contacts; None where chains are not compared by them."""
        impulses: Impulses | None = self._read_alone("impulses")
        return impulses

    @cached_property
    def front(self) -> "Front":
        """First bead of the front half of a window over time."""
        front: Front = self._read_alone("front")
        return front

    @cached_property
    def end(self) -> "End":
        """Time of the last frame, and energy input until then."""
        end: End = self._read_alone("end")
        return end

    def _read_alone(self, part: str) -> Any:
        """A part of a first reading, for itself; None where there is none."""
        meter = _first_meters(self.problem).get(part)
        return None if meter is None else meter.read(self.read())

    @cached_property
    def tracks(self) -> tuple[Pulse, ...]:
        """Pulses and crests of sound in both directions, each once."""
        peaks = [self.front.near(peaks) for peaks in (self.peaks_upwards, self.peaks_downwards)]
        tracks = tuple(pulse for each in peaks for pulse in track_pulses(each, self.problem))
        return once_each(tracks, wave_of(self.problem.system))

    @cached_property
    def ahead(self) -> Peaks:
        """Peaks along the way of the leading waves, beyond kicks; with kicks from both sides those of pulses alone."""
        peaks = self.peaks_upwards if self.direction > 0 else self.peaks_downwards
        return beyond_kicks(of_pulses(peaks, self.tracks) if opposed(self.problem) else peaks, self.problem)

    @cached_property
    def succession(self) -> tuple[Change, ...]:
        """Where one leading pulse ends and another one leads."""
        return changes(self.ahead, self.problem)

    @cached_property
    def passages(self) -> Waves:
        """Leading waves, ``waves``, with speeds also between passages of two pulses."""
        return leading_waves(self.ahead, self.problem, self.arrival, self.succession)

    @cached_property
    def waves(self) -> Waves:
        """Leading waves; beads as numbered in the scene. With kicks from both sides only what belongs to a pulse."""
        return speeds_of_pulses(self.passages, self.tracks, self.direction)

    @cached_property
    def lags(self) -> Lags:
        """Arrivals of ``waves`` behind those in the kicked chain."""
        return lags(self.waves, self.shared.kicked + 1)

    @cached_property
    def shared(self) -> Sharing:
        """Leading waves of all chains at the same beads, counted along their way, with the energy input of the run."""
        shared = sharing(self.passages, self.problem, self.impulses)
        return replace(shared, energy=self.end.energy) if physics.acted_on(self.problem.system) else shared

    @cached_property
    def decay(self) -> DecayFit | None:
        """Law of the pulse that leads at the last bead (``shared.followed``)."""
        return fit_decay(self.shared.followed, self.problem)

    @cached_property
    def verdict(self) -> Verdict:
        """Verdict on the pulse that leads at the last bead (``shared.followed``)."""
        return numbered(verdict_on(self.shared.followed, self.problem, self.decay), self.direction)

    @cached_property
    def _distinct(self) -> tuple[tuple[Pulse, ...], tuple[Pulse, ...]]:
        """Pulses, and the crests of sound that there are under a static load."""
        return _distinct_from_sound(self.tracks, self.waves, self.direction, self.problem)

    @cached_property
    def pulses(self) -> tuple[Pulse, ...]:
        """Every pulse, in either direction.

        Under a static load the leading waves and what runs ahead of sound (`analysis.tracking.pulses.ahead_of_sound`).
        """
        return self._distinct[0]

    @cached_property
    def crests(self) -> tuple[Pulse, ...]:
        """Crests of sound, under a static load; one may be taken for another on its way."""
        return self._distinct[1]

    @cached_property
    def clear(self) -> tuple[Flags, ...]:
        """Mask of each pulse, [passage]: where the ends of its chain had not disturbed it."""
        return _clear_of_ends(self.pulses, self.waves, self.direction, self.problem)

    @cached_property
    def _measured_at(self) -> list[int]:
        """Position of the passage of each pulse at which its character is measured."""
        pulses = zip(self.pulses, self.clear, strict=True)
        return [measured_at(pulse, self.problem, self.end.time, mask) for pulse, mask in pulses]

    @cached_property
    def _chosen(self) -> Integers:
        """Positions of the leading waves whose waveforms are kept: `MAX_PASSAGES` at most."""
        stride = max(1, -(-len(self.waves) // MAX_PASSAGES))
        return np.flatnonzero(self.waves.bead % stride == 0)

    @cached_property
    def _passages(self) -> Passages:
        """Passages of leading waves and of pulses whose waveforms are kept."""
        return _passages(self.waves.where(self._chosen), self.direction, self.pulses, self._measured_at)

    def _waveform_meter(self) -> WaveformMeter:
        """Meter of the waveforms; energies are for pulses alone where beads are alike."""
        leading = len(self._chosen) if physics.alike(self.problem.system) else 0
        return WaveformMeter(self.problem, self._passages, np.arange(len(self._passages)) >= leading)

    @cached_property
    def waveforms(self) -> Waveforms:
        """Velocity over time around the passages of ``waves``, then of ``pulses``."""
        return self._waveform_meter().read(self.read())

    @cached_property
    def _shapes(self) -> Shape:
        """Shape of every waveform."""
        return _of_one_pulse(self.waveforms.shape(), self._passages, self.pulses, self.problem)

    @cached_property
    def shape(self) -> Shape:
        """Shapes of the waves, entry by entry of ``waves``; NaN where not measured, as energies of like beads are."""
        return _of_waves(self._shapes, self._chosen, np.isfinite(self.ahead.first().time_error))

    @cached_property
    def characters(self) -> tuple[Character, ...]:
        """Character of each pulse, at the last clear passage that was recorded completely."""
        return _characters(self.pulses, self._measured_at, self._shapes, self.tolerances, self.problem)

    @cached_property
    def energies(self) -> EnergyShares:
        """Shares of energy of the chains and their leading waves."""
        return self._of_waves_alone(self._share_meter().read(self.read()))

    def _share_meter(self) -> ShareMeter:
        return ShareMeter(self.problem, self.shared)

    def _of_waves_alone(self, energies: EnergyShares) -> EnergyShares:
        """Energies of waves where no other pulse is near."""
        bead = self.shared.bead[energies.place]
        mixed = _of_others(along_the_way(self.problem, bead), self.waves, self.pulses, self.problem)
        wave, error = (np.where(mixed, np.nan, values) for values in (energies.wave, energies.wave_error))
        return replace(energies, wave=wave, wave_error=error)

    def pulses_towards(self, direction: int, smallest: float) -> tuple[Pulse, ...]:
        """Pulses and crests of sound in one direction (1 or -1) that reach a velocity, in units of V."""
        peaks = self.peaks_upwards if direction > 0 else self.peaks_downwards
        return track_pulses(peaks, self.problem, smallest=smallest)

    def train(self, chain: int, bead: int, smallest: float) -> Train:
        """Pulses towards higher bead numbers that pass a bead in succession and reach a velocity, in units of V."""
        return train_of(self.pulses_towards(1, smallest), chain, 1, bead)

    def leads(self, pulse: Pulse) -> bool:
        """Whether a pulse is the leading wave of its chain where it was last seen."""
        return _leads(pulse, self.waves, self.direction)

    def last_clear_bead(self, waves: Waves) -> int:
        """Position of the last bead that waves passed undisturbed by the end that they run to, five beads before it.

        That of the first bead passed, where they passed none so far from that end.
        """
        passed = along_the_way(self.problem, waves.bead)
        clear = np.where(passed <= max(self.problem.beads - CLEAR, 1), passed, 0)
        return int(np.argmax(clear)) if clear.any() else int(np.argmin(passed))

    @property
    def exact_speed(self) -> float | None:
        """Speed of the exact solitary wave of the asymptotic amplitude, in beads / T; None where none can run."""
        final, system = self.shared.followed.final, self.problem.system
        if final is None or not runs_exact_waves(system):
            return None
        return float(wave_of(system).speed_at(final.value))

    def completed(self) -> "Survey":
        """Survey all of whose parts have been computed, which needs no frames any more."""
        return self.replaced(**{name: getattr(self, name) for name in PARTS}, read=tuple)


PARTS = tuple(name for name, value in vars(Survey).items() if isinstance(value, cached_property))
"""Names of all parts of a survey."""


def _leads(pulse: Pulse, waves: Waves, direction: int) -> bool:
    in_chain = waves.of_chain(pulse.chain)
    is_end = (in_chain.bead == pulse.bead[-1]) & (in_chain.time == pulse.arrival[-1])
    return pulse.direction == direction and bool(np.any(is_end))


def numbered(verdict: Verdict, direction: int) -> Verdict:
    """A verdict whose sentence says how it counts beads, where that is not by their numbers."""
    if direction > 0 or " bead " not in verdict.sentence:
        return verdict
    counted = "(beads are counted along the pulse's way, from the last bead)"
    return replace(verdict, sentence=f"{verdict.sentence} {counted}")


def _distinct_from_sound(
    tracks: tuple[Pulse, ...], waves: Waves, direction: int, problem: Problem
) -> tuple[tuple[Pulse, ...], tuple[Pulse, ...]]:
    """Pulses, and the crests of sound that there are under a static load."""
    if not physics.loaded(problem.system):
        return tracks, ()
    loaded = LoadedSpeed(problem.system)
    keep = [_leads(track, waves, direction) or ahead_of_sound(track, loaded) for track in tracks]
    pulses, crests = (
        tuple(track for track, is_pulse in zip(tracks, keep, strict=True) if is_pulse == wanted)
        for wanted in (True, False)
    )
    return pulses, crests


def survey(
    read: Callable[[], Iterable[Trajectory]],
    problem: Problem,
    *,
    tolerances: Tolerances | None = None,
    arrival: Arrival | None = None,
) -> Survey:
    """All parts of a survey, in two readings of a run.

    Args:
        read: starts reading the run: consecutive blocks of frames, the first frame being the start.
        problem: what was run.
        tolerances: within which a pulse counts as solitary.
        arrival: what counts as the arrival of a leading wave; by default `leading_waves.usual_arrival`.

    Raises:
        ValueError: there was no frame.
    """
    return surveyed(read, problem, {}, tolerances=tolerances, arrival=arrival)[0]


def surveyed(
    read: Callable[[], Iterable[Trajectory]],
    problem: Problem,
    meters: Mapping[str, Meter[Any, Any]],
    *,
    tolerances: Tolerances | None = None,
    arrival: Arrival | None = None,
    counted: Callable[[Iterable[Trajectory]], Iterable[Trajectory]] | None = None,
    impulses: Impulses | None = None,
) -> tuple[Survey, dict[str, Any]]:
    """All parts of a survey, and results of other meters by their names, in two readings of a run.

    Args:
        read, problem, tolerances, arrival: as for `survey`.
        meters: what else to measure in the first reading.
        counted: gives the frames of the first reading their exchange (`analysis.trajectory.EXCHANGES`).
        impulses: of rigid beads; else they are measured where chains are compared by them.

    Raises:
        ValueError: there was no frame.
    """
    made = Survey(problem, read, usual_arrival(problem) if arrival is None else arrival, tolerances)
    first = _first_meters(problem)
    if impulses is not None:
        vars(made)["impulses"] = impulses
        first.pop("impulses", None)
    blocks = made.read() if counted is None else counted(made.read())
    results = measured({**first, **meters}, blocks)
    vars(made).update({name: results.pop(name) for name in first})
    of_waves = measured({"waveforms": made._waveform_meter(), "energies": made._share_meter()}, made.read())
    vars(made).update(waveforms=of_waves["waveforms"], energies=made._of_waves_alone(of_waves["energies"]))
    return made.completed(), results


def _of_waves(shapes: Shape, chosen: Integers, sharp: Flags) -> Shape:
    """Shapes of all waves: NaN where not measured, and but for the energy where the time is not known."""
    columns = {name: np.full(len(sharp), np.nan) for name in shapes.arrays()}
    for name, column in columns.items():
        column[chosen] = getattr(shapes, name)[: len(chosen)]
        if name not in ("energy", "energy_error"):
            column[~sharp] = np.nan
    return Shape(**columns)


def _of_one_pulse(shapes: Shape, passages: Passages, pulses: tuple[Pulse, ...], problem: Problem) -> Shape:
    """Shapes with the energy NaN where another pulse has part of the energy near the peak."""
    energy, error = shapes.energy.copy(), shapes.energy_error.copy()
    for chain in range(1, problem.chains + 1):
        in_chain = passages.chain == chain
        bead, time = passages.bead[in_chain], passages.arrival[in_chain]
        clear = clear_of_others(chain, bead, time, pulses, problem.every, reach(problem) + HALF)
        energy[in_chain], error[in_chain] = np.where(clear, [energy[in_chain], error[in_chain]], np.nan)
    return replace(shapes, energy=energy, energy_error=error)


def _of_others(bead: Integers, waves: Waves, pulses: tuple[Pulse, ...], problem: Problem) -> Flags:
    """[bead, chain] whether another pulse is near a leading wave."""
    time = np.full((problem.beads + 1, problem.chains), np.nan)
    time[waves.bead, waves.chain - 1] = waves.time
    apart = reach(problem) + HALF
    near = [
        ~clear_of_others(chain + 1, bead, time[bead, chain], pulses, problem.every, apart)
        for chain in range(problem.chains)
    ]
    return np.stack(near, axis=1)


@dataclass(frozen=True)
class Front:
    """First bead of the front half of a window over time.

    Attributes:
        time: [part] time from which on it is there, in units of T.
        bead: [part] number of the bead.
    """

    time: Floats
    bead: Integers

    def near(self, peaks: Peaks) -> Peaks:
        """The maxima in the front half of the window, which those of complete chains agree with."""
        since = np.searchsorted(self.time, peaks.time, side="right") - 1
        return peaks.where(peaks.bead >= self.bead[since])


class _FrontMeter(Meter[tuple[float, int], Front]):
    """First bead of the front half of a window over time."""

    def of_part(self, part: Part) -> tuple[float, int]:
        """Time of the first frame, and the bead."""
        return float(part.frames.time[0]), int(near_the_front(part.frames).beads[0])

    def result(self, pieces: list[tuple[float, int]]) -> Front:
        """All of them."""
        time, bead = zip(*pieces, strict=True)
        return Front(np.array(time), np.array(bead))


class End(NamedTuple):
    """Time of the last frame, in units of T, and energy input until then, in units of m V**2."""

    time: float
    energy: float


class _EndMeter(Meter[End, End]):
    """Time of the last frame, and energy input until then."""

    def of_part(self, part: Part) -> End:
        """That of the part."""
        return End(float(part.frames.time[-1]), float(energy_input(part.frames)[-1]))

    def result(self, pieces: list[End]) -> End:
        """That of the last part."""
        return pieces[-1]


def _first_meters(problem: Problem) -> dict[str, Meter[Any, Any]]:
    """Part of a survey -> what measures it in a first reading of the frames."""
    meters: dict[str, Meter[Any, Any]] = {
        "peaks_upwards": PeakMeter(direction=1),
        "peaks_downwards": PeakMeter(direction=-1),
        "front": _FrontMeter(),
        "end": _EndMeter(),
    }
    impulses = meter_of(problem)
    return meters if impulses is None else meters | {"impulses": impulses}


def _characters(
    pulses: tuple[Pulse, ...], at: list[int], shapes: Shape, tolerances: Tolerances | None, problem: Problem
) -> tuple[Character, ...]:
    """Characters of pulses at one passage of each, whose shapes are the last entries."""
    before = len(shapes) - len(pulses)
    return tuple(
        characterise(pulse, place, shapes.entry(before + number), tolerances, problem=problem)
        for number, (pulse, place) in enumerate(zip(pulses, at, strict=True))
    )


def _clear_of_ends(pulses: tuple[Pulse, ...], waves: Waves, direction: int, problem: Problem) -> tuple[Flags, ...]:
    """Passages of each pulse, [passage], before which the ends of its chain had not disturbed it."""
    back = {direction: returns(waves, problem, direction), -direction: np.full((problem.chains, problem.beads), np.inf)}
    return tuple(clear_of_ends(pulse, problem, back[pulse.direction]) for pulse in pulses)


def _passages(waves: Waves, direction: int, pulses: tuple[Pulse, ...], at: list[int]) -> Passages:
    """Passages of leading waves, followed by one of each pulse, at its position in ``at``."""
    directions = np.full(len(waves), direction)
    leading = waves.chain, waves.bead, waves.time, waves.peak_velocity, waves.speed, directions
    parts = [Passages(*leading, waves.arrival_error, waves.peak_velocity_error, waves.speed_error)]
    for pulse, k in zip(pulses, at, strict=True):
        passage = pulse.where([k])
        parts.append(
            Passages(
                chain=np.array([pulse.chain]),
                bead=passage.bead,
                arrival=passage.arrival,
                peak_velocity=passage.peak_velocity,
                speed=passage.speed,
                direction=np.array([pulse.direction]),
                arrival_error=passage.arrival_error,
                peak_velocity_error=passage.peak_velocity_error,
                speed_error=passage.speed_error,
            )
        )
    return together(parts)
