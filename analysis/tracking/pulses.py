"""Compressive pulses: passages at single beads linked into what runs along a chain.

A maximum of a bead's velocity is a passage; it belongs to the pulse whose speed brings it there at that time. A maximum
without contact pressure, such as that of a bead that oscillates on its spring, is no passage. Where beads differ by
turns, a pulse is followed on those of one kind, whose maxima can be compared.

Under a static load sound has crests, too, without number. A pulse is what runs ahead of sound, by as much as the
solitary wave of its amplitude would (`ahead_of_sound`): sound of any wavelength is slower than that of long waves, and
crests of it that were taken for one pulse by chance run at any speed.

A train is of pulses that follow each other past a bead, as when several beads are kicked or one is pushed for long.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np

from analysis.columns import Columns
from analysis.quantity import declare, derived, result
from analysis.shape.exact_wave import SolitaryWave, solitary_wave, wave_of
from analysis.shape.long_waves import LoadedSpeed
from analysis.tracking.peaks import Peaks
from analysis.trajectory import Flags, Floats, Integers
from lammps_inputs import Problem, physics

SMALLEST = 0.02
"""Largest velocity that a pulse must have somewhere, in units of V."""

LEAST_BEADS = 5
"""Recorded beads at which a pulse must be seen (or all, where fewer are recorded)."""

LONGEST_GAP = 3
"""Recorded beads in a row at which a pulse may be missing, as where two pulses cross."""

PRESSED = 0.2
"""Overlap that a passage must show at its peak, as a share of that of the exact wave of the contact's strength."""

LATEST, EARLIEST = 1.8, 0.3
"""Bounds on a passage's delay from the bead before, over the delay of the exact wave of this amplitude."""

UNSTEADIEST = 0.7
"""Bound on the change of that quotient from one passage to the next."""

CONSTANT_OVER = 10
"""Beads over which an amplitude is compared with itself."""

FAINTEST = 0.35
"""Bound on the ratio of amplitudes of two passages that follow each other."""

LEAST_AHEAD, MOST_AHEAD = 0.5, 2.0
"""Bounds on how much faster than sound a pulse on a static load is, over how much faster the solitary wave of its
amplitude is in the long-wave theory; over the second half of the way on which it was seen.
"""

NEAR_SOUND = 2e-3
"""How much faster that solitary wave must be, over sound, to be distinguished from it."""


@dataclass(frozen=True)
class Pulse(Columns):
    """One pulse, bead by bead in the order in which it meets them.

    Attributes:
        chain: counted from 1.
        direction: 1 towards higher bead numbers, -1 towards lower ones.
        bead: [passage], counted from 1; at most `LONGEST_GAP` recorded beads are left out in a row.
        arrival: [passage] time at which the bead is fastest, in units of T.
        peak_velocity: [passage] that velocity along ``direction``, in units of V.
        speed: [passage] beads per unit time from the passages on either side (at an end: one side), positive.
        arrival_error, peak_velocity_error: [passage] bounds, see `analysis.tracking.peaks.Peaks`.
        speed_error: [passage] bound by the errors of the arrivals, see `local_speed_error`.
    """

    chain: int
    direction: int
    bead: Integers
    arrival: Floats
    peak_velocity: Floats
    speed: Floats
    arrival_error: Floats
    peak_velocity_error: Floats
    speed_error: Floats

    def recent(self, at: int) -> Integers:
        """Positions, [passage], of the passages at the last `CONSTANT_OVER` beads up to one, that one included."""
        return np.flatnonzero(np.abs(self.bead[: at + 1] - self.bead[at]) <= CONSTANT_OVER)

    def variation(self, at: int) -> float:
        """Largest difference of recent amplitudes from that at a passage; NaN where they span too few beads."""
        recent = self.recent(at)
        if 2 * abs(self.bead[at] - self.bead[recent[0]]) <= CONSTANT_OVER:
            return np.nan
        return float(np.max(np.abs(self.peak_velocity[recent] - self.peak_velocity[at])))


def track_pulses(peaks: Peaks, problem: Problem, *, smallest: float = SMALLEST) -> tuple[Pulse, ...]:
    """Every pulse in a table of passages, by chain, then by time of its first passage.

    Args:
        peaks: maxima of velocity along the way of the pulses.
        problem: what was run.
        smallest: largest velocity that a pulse must reach, in units of V; a quarter of it continues one.
    """
    beads = problem.rows.numbers[of_one_kind(problem)[problem.rows.numbers - 1]]
    if len(beads) == 0:
        beads = problem.rows.numbers
    least = max(2, min(LEAST_BEADS, len(beads)))
    exact, speed_at = wave_of(problem.system), speed_of_pulses(problem)
    pressing = exact.strength * (PRESSED * exact.overlap(0.5)) ** (exact.exponent + 1.0) * peaks.velocity**2
    fast, pressed = peaks.velocity > 0.25 * smallest, ~(peaks.pressing < pressing)
    passages = peaks.where(fast & pressed & np.isin(peaks.bead, beads))
    pulses = []
    for chain in np.unique(passages.chain):
        in_chain = passages.where(passages.chain == chain)
        for track in _linked(in_chain, beads, partial(speed_at, int(chain))):
            if len(track) >= least and np.max(in_chain.velocity[track]) >= smallest:
                tracked = in_chain.where(track)
                bead, time, error = tracked.bead, tracked.time, tracked.time_error
                speed = peaks.direction * local_speed(bead, time)
                errors = error, tracked.velocity_error, local_speed_error(bead, time, error)
                pulses.append(Pulse(int(chain), peaks.direction, bead, time, tracked.velocity, speed, *errors))
    return tuple(sorted(pulses, key=lambda pulse: (pulse.chain, pulse.arrival[0])))


def speed_of_pulses(problem: Problem) -> Callable[[int, Integers, Floats], Floats]:
    """Speed, [...] in beads / T, of a pulse as a function of chain, beads [...] from 1 and peak velocities [...] in V.

    It is that of the exact wave; on a static load that of the long-wave theory.
    """
    if physics.loaded(problem.system):
        return LoadedSpeed(problem.system).at
    exact = wave_of(problem.system)
    return lambda chain, bead, peak_velocity: exact.speed_at(peak_velocity)  # noqa: ARG005  the same everywhere


def ahead_of_sound(pulse: Pulse, loaded: LoadedSpeed) -> bool:
    """Whether what runs along a chain under a static load is a pulse, not a crest of sound.

    Args:
        pulse: seen at two beads or more.
        loaded: speeds in that chain.
    """
    half = slice(len(pulse) // 2 - 1 if len(pulse) > 3 else 0, None)
    bead, arrival = pulse.bead[half], pulse.arrival[half]
    distance = np.abs(np.diff(bead))

    def takes(speed: Floats) -> float:
        """Time over the distance at speeds at its beads, [passage]."""
        return float(np.sum(2.0 * distance / (speed[1:] + speed[:-1])))

    sound = takes(loaded.sound[pulse.chain - 1, bead - 1])
    expected = sound / takes(loaded.at(pulse.chain, bead, pulse.peak_velocity[half])) - 1.0
    taken = arrival[-1] - arrival[0]
    ahead = sound / taken - 1.0 if taken > 0.0 else np.inf
    return bool(expected > NEAR_SOUND and LEAST_AHEAD * expected < ahead < MOST_AHEAD * expected)


def of_one_kind(problem: Problem) -> Flags:
    """Rows, [bead], that can be compared: those of the masses that most rows have, the heavier ones of equally many.

    All rows, if hardly two rows are of the same masses, as in tapered and disordered chains.
    """
    if isinstance(problem.system.mass, float):
        return np.ones(problem.beads, dtype=bool)
    kinds, which, count = np.unique(problem.system.mass, axis=1, return_inverse=True, return_counts=True)
    if count.max() < max(2.0, 0.1 * problem.beads):
        return np.ones(problem.beads, dtype=bool)
    frequent = np.flatnonzero(count >= count.max() - 1)
    heaviest = frequent[np.argmax(kinds[:, frequent].sum(axis=0))]
    return np.asarray(which.reshape(-1) == heaviest)


def local_speed(bead: Integers, arrival: Floats) -> Floats:
    """Beads per unit time from the arrivals on either side, [passage]; at an end one side.

    NaN for a single one, and for beads that were kicked at once: nothing runs from one to the other.
    """
    ahead, behind = _either_side(len(bead))
    delay = arrival[ahead] - arrival[behind]
    return np.asarray((bead[ahead] - bead[behind]) / np.where(delay == 0.0, np.nan, delay))


def local_speed_error(bead: Integers, arrival: Floats, error: Floats) -> Floats:
    """Bound on the error of `local_speed`, [passage], by bounds on the errors of the arrivals, [passage].

    The time t in which the pulse runs n beads is known to the sum e of two of these: ``n e / (t (t - e))``. NaN where
    the speed is, or e is not below t.
    """
    ahead, behind = _either_side(len(bead))
    delay, late = np.abs(arrival[ahead] - arrival[behind]), error[ahead] + error[behind]
    with np.errstate(divide="ignore", invalid="ignore"):
        bound = np.abs(bead[ahead] - bead[behind]) * late / (delay * (delay - late))
    return np.where(late < delay, bound, np.nan)


def _either_side(count: int) -> tuple[Integers, Integers]:
    """Positions of the next and of the last passage, each [passage]; at an end the passage itself."""
    place = np.arange(count)
    return np.minimum(place + 1, count - 1), np.maximum(place - 1, 0)


@dataclass
class _Track:
    """A pulse while it is followed.

    Attributes:
        passages: positions in the table.
        usual_delay: the last delay over the exact wave's.
        bound: how far the next may be from it.
    """

    passages: list[int]
    usual_delay: float = 1.0
    bound: float = np.inf


def _linked(peaks: Peaks, beads: Integers, speed_at: Callable[[Integers, Floats], Floats]) -> Iterator[list[int]]:
    """Positions in the table of the passages of one chain, pulse by pulse; beads ascend, whichever way these run."""
    starts = np.searchsorted(peaks.bead, beads)
    ends = np.searchsorted(peaks.bead, beads, side="right")
    place = np.searchsorted(beads, peaks.bead)
    open_tracks: list[_Track] = []
    for number in range(len(beads))[:: peaks.direction]:
        start, end = starts[number], ends[number]
        taken: set[int] = set()
        if start < end and open_tracks:
            last = np.array([track.passages[-1] for track in open_tracks])
            usual_delay = np.array([[track.usual_delay] for track in open_tracks])
            bound = np.array([[track.bound] for track in open_tracks])
            candidates = np.arange(start, end)
            amplitude = np.sqrt(peaks.velocity[last][:, np.newaxis] * peaks.velocity[candidates])
            distance = np.abs(beads[number] - peaks.bead[last])[:, np.newaxis]
            delay = (
                (peaks.time[candidates] - peaks.time[last][:, np.newaxis])
                * speed_at(peaks.bead[candidates], amplitude)
                / distance
            )
            ratio = peaks.velocity[candidates] / peaks.velocity[last][:, np.newaxis]
            ratio = np.minimum(ratio, 1.0 / ratio)
            cost = (delay - usual_delay) ** 2 + 0.1 * np.log(ratio) ** 2
            far = (np.abs(delay - usual_delay) > bound) | (delay < EARLIEST) | (delay > LATEST)
            cost[far | (ratio < FAINTEST)] = np.inf
            for row, column in _cheapest_pairs(cost):
                track = open_tracks[row]
                track.passages.append(int(candidates[column]))
                track.usual_delay = float(delay[row, column])
                track.bound = UNSTEADIEST
                taken.add(column)
        open_tracks += [_Track([k]) for k in range(int(start), int(end)) if k - start not in taken]
        for track in [track for track in open_tracks if abs(number - place[track.passages[-1]]) > LONGEST_GAP]:
            open_tracks.remove(track)
            yield track.passages
    for track in open_tracks:
        yield track.passages


def _cheapest_pairs(cost: Floats) -> Iterator[tuple[int, int]]:
    """Pairs (row, column) of finite cost, the cheapest first, each row and column once."""
    rows, columns = np.nonzero(np.isfinite(cost))
    used_rows, used_columns = set(), set()
    for k in np.argsort(cost[rows, columns], kind="stable"):
        row, column = int(rows[k]), int(columns[k])
        if row not in used_rows and column not in used_columns:
            used_rows.add(row)
            used_columns.add(column)
            yield row, column


@result
class Train(Columns):
    """Pulses at one bead of one chain, in the order of their arrival."""

    chain: int = declare("number of the chain")
    bead: int = declare("bead at which the pulses were measured")
    arrival: Floats = declare("arrival of each pulse", "time", symbol="t")
    peak_velocity: Floats = declare("peak velocity of each pulse, positive in its direction", "velocity", symbol="v")
    uncertainty: Floats = declare(
        "of each peak velocity: largest difference from it over the ten beads before, and its error by the time "
        "between frames and by the run (``run_error``)",
        "velocity",
        "none of them was recorded",
    )
    arrival_error: Floats = declare(
        "bound on the error of each arrival by the time between frames and by the run (``run_error``)", "time"
    )

    @property
    @derived()
    def pulses(self) -> int:
        """Number of pulses, from the first on, that are steady there (see `granchain help steady`)."""
        return len(self)

    @property
    @derived()
    def ratio(self) -> Floats:
        """Peak velocity of each pulse over that of the first, [pulse]."""
        return np.asarray(self.peak_velocity / self.peak_velocity[0])

    @property
    @derived(undefined="as ``uncertainty``, or that of the first exceeds its peak velocity")
    def ratio_error(self) -> Floats:
        """Uncertainty of each ratio by those of both peak velocities, [pulse]; 0 of the first."""
        first, off = self.peak_velocity[0], self.uncertainty[0]
        error = (self.uncertainty + self.ratio * off) / (first - off if off < first else np.nan)
        return np.where(np.arange(len(self)) == 0, 0.0, error)

    @property
    @derived("time")
    def spacing(self) -> Floats:
        """Time from each pulse to the next, [pulse - 1]."""
        return np.diff(self.arrival)

    @property
    @derived("time")
    def spacing_error(self) -> Floats:
        """Bound on the error of each spacing by those of both arrivals, [pulse - 1]."""
        return np.asarray(self.arrival_error[1:] + self.arrival_error[:-1])


def train_of(
    pulses: Iterable[Pulse], chain: int, direction: int, bead: int, exact: SolitaryWave | None = None
) -> Train:
    """Pulses of a chain in one direction that were found at a bead.

    Of those that are nearer to each other than the exact wave passes at half its height, as light and heavy beads see
    one and the same, the highest counts.
    """
    at_bead: list[tuple[float, float, float, float]] = []
    for pulse in pulses:
        at: Integers = np.flatnonzero(pulse.bead == bead)
        if (pulse.chain, pulse.direction) == (chain, direction) and len(at):
            arrival, peak = float(pulse.arrival[at[0]]), float(pulse.peak_velocity[at[0]])
            uncertainty = pulse.variation(int(at[0])) + float(pulse.peak_velocity_error[at[0]])
            at_bead.append((arrival, peak, uncertainty, float(pulse.arrival_error[at[0]])))
    exact = exact or solitary_wave()
    apart: list[tuple[float, float, float, float]] = []
    for pulse_at in sorted(at_bead):
        if apart and pulse_at[0] - apart[-1][0] < float(exact.width / exact.speed_at(pulse_at[1])):
            apart[-1] = max(apart[-1], pulse_at, key=lambda passage: passage[1])
        else:
            apart.append(pulse_at)
    return Train(chain, bead, *np.array(apart).reshape(-1, 4).T)
