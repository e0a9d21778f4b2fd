"""Everything that is found in a run by reading it twice: first its peaks, then the states around them.

A run is given as a function that reads it again, block by block, so that it need not fit into memory.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from analysis.columns import together
from analysis.compare.common_times import near_the_front
from analysis.conservation import energy_input
from analysis.shape.exact_wave import wave_of
from analysis.shape.long_waves import LoadedSpeed
from analysis.shape.waveforms import Passages, Shape, Waveforms, reach
from analysis.sharing.energies import EnergyShares
from analysis.sharing.equipartition import Sharing, sharing
from analysis.sharing.impulses import Impulses, meter_of
from analysis.sharing.is_solitary import Character, Tolerances, characterise, measured_at
from analysis.sharing.verdict import DecayFit, Verdict, fit_decay, verdict_on
from analysis.tracking.leading_waves import (
    Arrival,
    Waves,
    beyond_kicks,
    leading_waves,
    mirrored_waves,
    of_pulses,
    opposed,
    usual_arrival,
)
from analysis.tracking.peaks import PeakFinder, Peaks
from analysis.tracking.pulses import Pulse, ahead_of_sound, track_pulses
from analysis.tracking.succession import Change, changes
from analysis.tracking.undisturbed import clear_of_ends, clear_of_others, once_each, returns
from analysis.trajectory import (
    Flags,
    Integers,
    Trajectory,
    Watcher,
    direction_of,
    mirrored,
    mirrored_bead,
    mirrored_problem,
)
from lammps_inputs import Problem, physics

MAX_PASSAGES = 4000
"""Leading passages whose waveform is kept; beyond, every second bead, every third, ..."""

HALF = 2.0
"""Beads from its peak within which the exact wave has all but 1e-5 of its energy."""


@dataclass(frozen=True)
class Survey:
    """Waves, pulses and energies of a run.

    Attributes:
        problem: what was run.
        direction: 1 if the largest kick is towards higher bead numbers, else -1; the leading waves run that way, and in
            ``shared``, ``energies``, ``decay`` and ``verdict`` beads are counted along it (from the last bead if -1).
        arrival: what an arrival of ``waves`` is; the passages of ``pulses`` are always the maxima.
        waves: leading waves; beads as numbered in the scene. With kicks from both sides only what belongs to
            a pulse.
        succession: where one leading pulse ends and another one leads.
        waveforms: velocity over time around the passages of ``waves``, then of ``pulses``.
        shape: what those waveforms say of each wave, entry by entry of ``waves``; NaN where not measured, as energies
            are in chains of like beads.
        pulses: every pulse that was found, either way; under a static load the leading waves and what runs ahead of
            sound (`analysis.tracking.pulses.ahead_of_sound`).
        crests: of sound, under a static load; one may be taken for another on its way.
        clear: of each pulse, [passage] where the ends of its chain had not disturbed it.
        characters: of each pulse, at the last such passage that was recorded whole.
        shared, energies, decay, verdict: how the chains share the leading pulse; decay and verdict of the pulse that
            leads at the last bead (``shared.followed``).
    """

    problem: Problem
    direction: int
    arrival: Arrival
    waves: Waves
    succession: tuple[Change, ...]
    waveforms: Waveforms
    shape: Shape
    pulses: tuple[Pulse, ...]
    crests: tuple[Pulse, ...]
    clear: tuple[Flags, ...]
    characters: tuple[Character, ...]
    shared: Sharing
    energies: EnergyShares
    decay: DecayFit | None
    verdict: Verdict

    def leads(self, pulse: Pulse) -> bool:
        """Whether a pulse is the leading wave of its chain where it was last seen."""
        return _leads(pulse, self.waves, self.direction)


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
    watchers: Sequence[Watcher] = (),
    tolerances: Tolerances | None = None,
    arrival: Arrival | None = None,
    counted: Callable[[Trajectory], Trajectory] | None = None,
    impulses: Impulses | None = None,
) -> Survey:
    """Find everything in a run.

    Args:
        read: starts reading the run: consecutive blocks of frames, the first frame being the start.
        problem: what was run.
        watchers: shown every block once, as recorded.
        tolerances: within which a pulse counts as solitary.
        arrival: what counts as the arrival of a leading wave; by default `leading_waves.usual_arrival`.
        counted: gives frames of all beads their exchange (`analysis.trajectory.EXCHANGES`) where they have none.
        impulses: of rigid beads, along the way of the leading waves; else they are measured where chains are compared
            by them.

    Raises:
        ValueError: there was no frame.
    """
    first = _first_reading(read, problem, watchers, counted, impulses)
    direction = direction_of(problem)
    along = problem if direction > 0 else mirrored_problem(problem)
    arrival = usual_arrival(problem) if arrival is None else arrival
    ahead = _peaks_ahead(first.peaks[direction], first.tracks, problem)
    succession = changes(ahead, problem)
    waves = leading_waves(ahead, problem, arrival, succession, first.tracks)
    shared = _shared(first, waves, problem, along)
    pulses, crests = _distinct_from_sound(first.tracks, waves, direction, problem)
    clear = _clear_of_ends(pulses, waves, direction, problem)
    at = [measured_at(pulse, problem, first.last_time, mask) for pulse, mask in zip(pulses, clear, strict=True)]
    chosen = _with_waveforms(waves)
    passages = _passages(waves.where(chosen), direction, pulses, at)
    waveforms, energies = _second_reading(read, passages, len(chosen), shared, problem, along)
    shapes = _of_one_pulse(waveforms.shape(), passages, pulses, problem)
    mixed = _of_others(shared.bead[energies.place], waves, pulses, problem, direction)
    energies.wave[mixed] = energies.wave_error[mixed] = np.nan
    decay = fit_decay(shared.followed, along)
    return Survey(
        problem=problem,
        direction=direction,
        arrival=arrival,
        waves=waves,
        succession=succession,
        waveforms=waveforms,
        shape=_of_waves(shapes, chosen, np.isfinite(ahead.first().time_error)),
        pulses=pulses,
        crests=crests,
        clear=clear,
        characters=_characters(pulses, at, shapes, tolerances, problem),
        shared=shared,
        energies=energies,
        decay=decay,
        verdict=numbered(verdict_on(shared.followed, along, decay), direction),
    )


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


def _of_others(bead: Integers, waves: Waves, pulses: tuple[Pulse, ...], problem: Problem, direction: int) -> Flags:
    """[bead, chain] whether another pulse is near a leading wave, at beads counted along its way."""
    bead = bead if direction > 0 else mirrored_bead(problem, bead)
    time = np.full((problem.beads + 1, problem.chains), np.nan)
    time[waves.bead, waves.chain - 1] = waves.time
    apart = reach(problem) + HALF
    near = [
        ~clear_of_others(chain + 1, bead, time[bead, chain], pulses, problem.every, apart)
        for chain in range(problem.chains)
    ]
    return np.stack(near, axis=1)


class _Window:
    """First bead of the front half of a window over time."""

    def __init__(self) -> None:
        self._time: list[float] = []
        self._bead: list[int] = []

    def add(self, block: Trajectory) -> None:
        """Take the next frames."""
        self._time.append(float(block.time[0]))
        self._bead.append(int(near_the_front(block).beads[0]))

    def near_the_front(self, peaks: Peaks) -> Peaks:
        """The maxima in the front half of the window, which those of complete chains agree with."""
        since = np.searchsorted(self._time, peaks.time, side="right") - 1
        return peaks.where(peaks.bead >= np.array(self._bead)[since])


class _FirstReading(NamedTuple):
    """Peaks and pulses of a run.

    Attributes:
        peaks: peaks of the waves in each direction, 1 and -1.
        tracks: pulses in both directions, each once.
        impulses: impulses along the way of the leading waves; None where chains are not compared by them.
        last_time: time of the last frame, in units of T; NaN without frames.
        energy: energy input until then, in units of m V**2.
    """

    peaks: dict[int, Peaks]
    tracks: tuple[Pulse, ...]
    impulses: Impulses | None
    last_time: float
    energy: float


def _first_reading(
    read: Callable[[], Iterable[Trajectory]],
    problem: Problem,
    watchers: Sequence[Watcher],
    counted: Callable[[Trajectory], Trajectory] | None,
    impulses: Impulses | None,
) -> _FirstReading:
    """Show the run to all watchers, and find its peaks and pulses; see `survey` for the arguments."""
    finders = {sign: PeakFinder(direction=sign) for sign in (1, -1)}
    window = _Window()
    meter = meter_of(problem) if impulses is None else None
    watching = [*watchers, window, *finders.values(), *([] if meter is None else [meter])]
    counts = counted if physics.exchanges(problem.system) and problem.whole else None
    last_time = energy = float("nan")
    for block in read():
        if counts is not None and block.exchange is None:
            block = counts(block)
        for watcher in watching:
            watcher.add(block)
        last_time, energy = float(block.time[-1]), float(energy_input(block)[-1])
    peaks = {sign: finder.result() for sign, finder in finders.items()}
    near = {sign: window.near_the_front(peaks[sign]) for sign in finders}
    tracks = tuple(pulse for sign in finders for pulse in track_pulses(near[sign], problem))
    return _FirstReading(
        peaks=peaks,
        tracks=once_each(tracks, wave_of(problem.system)),
        impulses=impulses if meter is None else meter.result(),
        last_time=last_time,
        energy=energy,
    )


def _peaks_ahead(peaks: Peaks, tracks: tuple[Pulse, ...], problem: Problem) -> Peaks:
    """Peaks in the direction of the leading waves, beyond kicks; with kicks from both sides those of pulses alone."""
    return beyond_kicks(of_pulses(peaks, tracks) if opposed(problem) else peaks, problem)


def _shared(first: _FirstReading, waves: Waves, problem: Problem, along: Problem) -> Sharing:
    """Leading waves of all chains at the same beads, counted along their way, with the energy input of the run."""
    counted = waves if along is problem else mirrored_waves(waves, problem)
    return replace(sharing(counted, along, first.impulses), energy=first.energy)


def _characters(
    pulses: tuple[Pulse, ...], at: list[int], shapes: Shape, tolerances: Tolerances | None, problem: Problem
) -> tuple[Character, ...]:
    """Characters of pulses at one passage of each, whose shapes are the last entries."""
    before = len(shapes) - len(pulses)
    return tuple(
        characterise(pulse, place, shapes.entry(before + number), tolerances, problem=problem)
        for number, (pulse, place) in enumerate(zip(pulses, at, strict=True))
    )


def _second_reading(
    read: Callable[[], Iterable[Trajectory]],
    passages: Passages,
    leading: int,
    shared: Sharing,
    problem: Problem,
    along: Problem,
) -> tuple[Waveforms, EnergyShares]:
    """Waveforms of passages, of which the first are of leading waves, and shares of energy along the way of these.

    ``along`` is the problem as the leading waves run through it: mirrored, where they run towards bead 1.
    """
    weighed = np.arange(len(passages)) >= (leading if physics.alike(problem.system) else 0)
    waveforms = Waveforms(problem, passages, weighed)
    energies = EnergyShares(along, shared)
    for block in read():
        waveforms.add(block)
        energies.add(block if along is problem else mirrored(block))
    return waveforms, energies


def _with_waveforms(waves: Waves) -> Integers:
    """Positions of the leading waves whose waveforms are kept: `MAX_PASSAGES` at most."""
    stride = max(1, -(-len(waves) // MAX_PASSAGES))
    return np.flatnonzero(waves.bead % stride == 0)


def _clear_of_ends(pulses: tuple[Pulse, ...], waves: Waves, direction: int, problem: Problem) -> tuple[Flags, ...]:
    """Passages of each pulse, [passage], before which the ends of its chain had not disturbed it."""
    back = {direction: returns(waves, problem, direction), -direction: np.full((problem.chains, problem.beads), np.inf)}
    return tuple(clear_of_ends(pulse, problem, back[pulse.direction]) for pulse in pulses)


def _passages(waves: Waves, direction: int, pulses: tuple[Pulse, ...], at: list[int]) -> Passages:
    """Passages of leading waves, followed by one of each pulse, at its position in ``at``."""
    directions = np.full(len(waves), direction)
    leading = waves.chain, waves.bead, waves.time, waves.peak_velocity, waves.speed, directions, waves.arrival_error
    parts = [Passages(*leading)]
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
            )
        )
    return together(parts)
