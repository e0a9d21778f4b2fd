"""How chains come to share a pulse: amplitudes, arrivals and beats of their leading waves over the distance run.

The amplitude of a wave at a bead is its peak velocity; where coupled chains have gaps, the impulse of the bead's first
contact over its mass (`analysis.sharing.impulses`).

Definitions, all over the chains at one bead: mismatch = (largest - smallest) / mean of the amplitudes;
lag = arrival behind that of the chain that was kicked; spread = (latest - earliest arrival) over the time in which the
exact wave passes at half its height. Agreement to a tolerance begins at the first bead from which on the mismatch stays
below it.
"""

import math
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from analysis.quantity import declare, derived, result
from analysis.shape.exact_wave import SolitaryWave, has_wave, solitary_wave, wave_of
from analysis.shape.long_waves import LoadedSpeed, period_of, repeats_between
from analysis.sharing.impulses import Impulses, compared_by_impulses
from analysis.tracking.leading_waves import Waves
from analysis.tracking.pulses import of_one_kind
from analysis.tracking.undisturbed import CLEAR
from analysis.trajectory import Flags, Floats, Integers, along_the_way
from lammps_inputs import Problem, System, physics
from lammps_inputs.facts import Fact
from lammps_inputs.limits import rates

AGREEMENTS = (0.1, 0.01, 0.001)
"""Tolerances for which the bead of agreement is stated."""

AGREEMENT = 0.01
"""Mismatch of amplitudes and of arrivals (in passages of the wave) below which chains count as equal."""

SETTLED = 1e-6
"""Relative change of an amplitude from one stretch of beads to the next that is none: time steps leave as much."""

LARGEST_DEVIATION = 0.5
"""Largest deviation from the mean amplitude, over that, at which the mean is one that amplitudes settle at."""

CONVERGES = 0.5
"""Largest ratio of such a change to the one before at which an amplitude approaches a limit."""

RESOLVED = 2.0
"""Beads between recorded ones, times the square root of kappa, up to which beats are seen as they are: a quarter of the
shortest, which is that of two chains. Unless the row is open, kappa is that of two chains of the same modal frequency.
"""

SMALLEST_BEAT = 1e-5
"""Relative deviation below which a change of sign is no beat."""

REGULAR = 0.5
"""Largest standard deviation of half beats, over their mean, at which they are alike."""

LEAST_TAIL = 5
"""Places over which the final amplitude is taken at least."""


@result
class Estimate:
    """A number and its uncertainty, in the unit of the number."""

    value: float = declare("the number")
    uncertainty: float = declare("its uncertainty")


@result
class Final(Estimate):
    """The asymptotic amplitude."""

    uncertainty: float = declare(
        "its uncertainty: largest deviation over the last half beat, or the change still to come where that is larger; "
        "and the error of these amplitudes by the time between frames and by the run",
        "V",
    )

    @property
    @derived()
    def reduction(self) -> float:
        """Reduction of the amplitude against V, 1 - value."""
        return 1.0 - self.value


@result
class AmplitudeRange:
    """Range of amplitudes over some beads."""

    first: int = declare("first bead of the second half of the compared beads")
    last: int = declare("last bead")
    least: float = declare("least amplitude of any chain between them", "V")
    largest: float = declare("largest amplitude of any chain between them", "V")


@dataclass(frozen=True)
class Sharing:
    """The leading waves side by side, at every recorded bead that all chains' waves passed clear of the free end.

    Where some chains are tied to each other, only those tied to the kicked one count, directly or by others; the
    rest hold NaN.

    Attributes:
        kicked: position of the chain with the largest excitation.
        bead: [place], counted from 1 along the way of the leading waves, ascending.
        arrival: [place, chain], in units of T; NaN where it is undefined.
        amplitude: [place, chain] peak velocity, or impulse of the first contact over the mass, in units of V.
        energy: input by kicks, pushes and drives, in units of m V**2; NaN where that is not known.
        arrival_error, amplitude_error: [place, chain] bounds on what the time between frames leaves; NaN if unknown.
        exact: the exact wave of the contacts.
    """

    kicked: int
    bead: Integers
    arrival: Floats
    amplitude: Floats
    energy: float
    arrival_error: Floats | None = None
    amplitude_error: Floats | None = None
    exact: SolitaryWave = field(default_factory=solitary_wave)
    loaded: LoadedSpeed | None = None
    """Speed of waves on a static load, at beads counted along their way; None without one."""
    changing: str = ""
    """Reason why amplitudes have no limit; empty where they may have one."""
    of_impulses: bool = False
    """Whether amplitudes are those of impulses."""
    pulse: Floats | None = None
    """[place, chain] number of the pulse that leads; None where one pulse leads in each chain."""

    def __len__(self) -> int:
        return len(self.bead)

    @property
    def compared(self) -> str:
        """Kind of the compared amplitudes, in words."""
        return "impulses of first contacts" if self.of_impulses else "amplitudes"

    @cached_property
    def _mean(self) -> Floats:
        """[place] mean amplitude of the chains."""
        return np.asarray(np.mean(self.of_tied(self.amplitude), axis=1))

    def _over_mean(self, values: Floats) -> Floats:
        """Values [place] over the mean amplitude of the chains; not finite where that is 0."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(values / self._mean)

    def of_tied(self, values: Floats) -> Floats:
        """Columns of a table [place, chain] for the chains that count, [place, counting chain]."""
        counts = np.isfinite(self.amplitude).any(axis=0)
        return values if counts.all() or not counts.any() else values[:, counts]

    @property
    def changes(self) -> Integers:
        """Places, [change], at which another pulse leads than at the place before, in a chain that counts."""
        if self.pulse is None:
            return np.zeros(0, dtype=np.int64)
        return np.flatnonzero(np.any(np.diff(self.of_tied(self.pulse), axis=0) != 0, axis=1)) + 1

    @property
    def followed(self) -> "Sharing":
        """The places from the last change on: one pulse in each chain, which verdicts are about."""
        if len(self.changes) == 0:
            return self
        tables = {name: vars(self)[name] for name in _AT_PLACES if vars(self)[name] is not None}
        return replace(self, **{name: values[self.changes[-1] :] for name, values in tables.items()})

    @cached_property
    def mismatch(self) -> Floats:
        """[place] (largest - smallest) / mean of the amplitudes; 0 for a single chain, NaN where all of them are 0."""
        return self._over_mean(np.ptp(self.of_tied(self.amplitude), axis=1))

    @cached_property
    def lag(self) -> Floats:
        """[place, chain] arrival behind that in the kicked chain, in units of T; positive for a later wave."""
        return self.arrival - self.arrival[:, [self.kicked]]

    @cached_property
    def spread(self) -> Floats:
        """[place] time between the first and the last chain, in passages of the exact wave of the mean amplitude."""
        return np.asarray(np.ptp(self.of_tied(self.arrival), axis=1) / self._passage)

    @property
    def _passage(self) -> Floats:
        """[place] time in which the exact wave of the mean amplitude passes at half its height."""
        speed = self.exact.speed_at(self._mean)
        if self.loaded is not None:  # a wave on a static load is about as long, and faster
            speed = self.loaded.at(self.kicked + 1, self.bead, self._mean)
        with np.errstate(divide="ignore"):  # a wave of amplitude 0 passes in no time that is finite
            return np.asarray(self.exact.width / speed)

    def at_last(self) -> "tuple[Estimate, Estimate] | None":
        """Mismatch and spread at the last place, with what errors of amplitudes and arrivals change; None of one chain.

        An amplitude a off makes the mismatch m ``(2 + m) a`` off over the mean, and a passage ``a`` over it at most.
        """
        if len(self) == 0 or self.of_tied(self.amplitude).shape[1] < 2:
            return None
        mismatch, spread, passage = (float(of[-1]) for of in (self.mismatch, self.spread, self._passage))
        relative = float(self._over_mean(self.largest_error)[-1])
        late = 0.0 if self.arrival_error is None else float(np.max(self.of_tied(self.arrival_error)[-1]))
        return (
            Estimate(mismatch, (2.0 + mismatch) * relative),
            Estimate(spread, 2.0 * late / passage + spread * relative),
        )

    def uncertainties(self) -> tuple[float, float]:
        """Largest uncertainty of amplitudes (relative) and of arrivals (in passages) over the last half beat.

        Infinite where an arrival is not defined; errors that are not known count as 0.
        """
        if len(self) == 0 or self.arrival_error is None or self.amplitude_error is None:  # given by hand
            return 0.0, 0.0
        late = self.bead >= self.bead[-1] - (self.half_beat or 0.0)
        arrival_error = np.where(np.isfinite(self.arrival), np.nan_to_num(self.arrival_error), np.inf)
        with np.errstate(divide="ignore", invalid="ignore"):  # a bead may have received no impulse
            arrival, relative = (
                self.of_tied(arrival_error),
                self.of_tied(np.nan_to_num(self.amplitude_error) / self.amplitude),
            )
        return float(np.max(relative[late])), float(np.max(arrival[late] / self._passage[late, np.newaxis]))

    @cached_property
    def wave_share(self) -> Floats:
        """[place, chain] energy of the exact wave of this amplitude, over the energy input; 0 where no wave counts."""
        return np.nan_to_num(self.exact.energy_at(self.amplitude)) / self.energy

    @property
    def beats(self) -> Floats:
        """Beads, [beat] in fractions, at which the amplitude of the kicked chain crosses the chains' mean."""
        return self._crossings[0]

    @cached_property
    def _crossings(self) -> tuple[Floats, Floats]:
        """Beads of the beats, and how far the errors of the amplitudes move them, each [beat].

        Changes of sign after which the deviation stays below `SMALLEST_BEAT` are left out, and
        so are two that are less than the distance of two places apart.
        """
        none = np.zeros(0), np.zeros(0)
        if len(self) < 2:
            return none
        deviation = self._over_mean(self.amplitude[:, self.kicked]) - 1.0
        large = np.flatnonzero(np.abs(deviation) > SMALLEST_BEAT)
        if len(large) < 2:
            return none
        bead, deviation, error = self.bead[large], deviation[large], 2.0 * self._over_mean(self.largest_error)[large]
        change = np.flatnonzero(np.sign(deviation[1:]) != np.sign(deviation[:-1]))
        before, after = deviation[change], deviation[change + 1]
        apart = (bead[change + 1] - bead[change]) / np.abs(before - after)
        crossings = bead[change] + apart * np.abs(before)
        errors = apart * np.maximum(error[change], error[change + 1])
        while len(crossings) > 1 and np.min(np.diff(crossings)) < np.min(np.diff(self.bead)):
            nearest = int(np.argmin(np.diff(crossings)))
            crossings, errors = (np.delete(array, [nearest, nearest + 1]) for array in (crossings, errors))
        return np.asarray(crossings), np.asarray(errors)

    @property
    def largest_error(self) -> Floats:
        """[place] largest error of an amplitude, in units of V; errors that are not known count as 0."""
        if self.amplitude_error is None or len(self) == 0:
            return np.zeros(len(self))
        return np.asarray(np.max(np.nan_to_num(self.of_tied(self.amplitude_error)), axis=1))

    @cached_property
    def beat_length(self) -> Estimate | None:
        """Beads from one excess of a chain to its next; None before half a beat was seen.

        Mean over the half beats seen, with the standard deviation from one to another (one alone: half of it), and
        with what the errors of the amplitudes change: by at most half a half beat at either end.
        """
        half = np.diff(self.beats)
        if len(half) == 0:
            return None
        mean = float(np.mean(half))
        errors = np.minimum(self._crossings[1][[0, -1]], 0.5 * mean)
        return Estimate(2.0 * mean, 2.0 * (self._scatter + float(np.sum(errors)) / len(half)))

    @property
    def _scatter(self) -> float:
        """Standard deviation of the half beats, in beads; half of one alone."""
        half = np.diff(self.beats)
        return float(np.std(half, ddof=1)) if len(half) > 1 else 0.5 * float(half[0])

    @property
    def regular_beat(self) -> Estimate | None:
        """The beat length where half beats are alike; None before half a beat was seen."""
        beat = self.beat_length
        return beat if beat is not None and 2.0 * self._scatter <= REGULAR * beat.value else None

    @cached_property
    def half_beat(self) -> float | None:
        """Beads in the last half beat seen; None before there was one."""
        half = np.diff(self.beats)
        return float(half[-1]) if len(half) else None

    def agrees_from(self, tolerance: float) -> int | None:
        """First bead from which on the amplitudes agree; None if they do not, or not for as long as half a beat."""
        return self._holds_from(self.mismatch < tolerance)

    def in_step_from(self, tolerance: float) -> int | None:
        """First bead from which on the arrivals agree to a share of the wave's passage; None as in `agrees_from`."""
        return self._holds_from(self.spread < tolerance)

    def _holds_from(self, good: Flags) -> int | None:
        bad = np.flatnonzero(~good)
        start = int(bad[-1]) + 1 if len(bad) else 0
        if start >= len(self) or self.of_tied(self.amplitude).shape[1] < 2:
            return None
        if self.half_beat is None or self.bead[-1] - self.bead[start] < self.half_beat:
            return None
        return int(self.bead[start])

    @cached_property
    def tail(self) -> int:
        """First place of the last half beat, or where there is none of the last tenth of the beads."""
        length = self.half_beat if self.half_beat is not None else 0.1 * (self.bead[-1] - self.bead[0])
        return min(int(np.searchsorted(self.bead, self.bead[-1] - length)), max(0, len(self) - LEAST_TAIL))

    @cached_property
    def final(self) -> Final | None:
        """Amplitude that the leading waves settle at, in V: mean over chains and the last half beat.

        The uncertainty is the largest deviation from it, or what is still to come where that is more, and the largest
        error of these amplitudes. None where
        amplitudes have no limit, or do not show one: they deviate by more than half of the mean, or the mean changes
        from stretch to stretch of as many beads, by more than half the deviation, and not ever less.
        """
        if len(self) == 0 or self.changing:
            return None
        amplitude = self.of_tied(self.amplitude)[self.tail :]
        mean, count = float(np.mean(amplitude)), len(amplitude)
        varies = float(np.max(np.abs(amplitude - mean)))
        if varies > LARGEST_DEVIATION * mean:
            return None
        starts = [start for start in (self.tail - count, self.tail - 2 * count) if start >= 0]
        means = [mean, *(float(np.mean(self._mean[start : start + count])) for start in starts)]
        change, *before = -np.diff(means) if len(means) > 1 else [math.inf]
        errors = 0.0 if self.amplitude_error is None else np.nan_to_num(self.of_tied(self.amplitude_error)[self.tail :])
        error = float(np.max(errors))
        if abs(change) <= max(SETTLED * mean, 0.5 * varies):
            return Final(mean, varies + error)
        ratio = change / before[0] if before and before[0] != 0.0 else math.inf
        if not 0.0 <= ratio <= CONVERGES:
            return None
        return Final(mean, max(varies, abs(change) * ratio / (1.0 - ratio)) + error)

    @cached_property
    def span(self) -> AmplitudeRange | None:
        """Range of amplitudes over the second half of the way; None without any."""
        if len(self) == 0:
            return None
        half = int(np.searchsorted(self.bead, 0.5 * (self.bead[0] + self.bead[-1])))
        amplitude = self.of_tied(self.amplitude)[half:]
        first, last = int(self.bead[half]), int(self.bead[-1])
        return AmplitudeRange(first, last, float(np.min(amplitude)), float(np.max(amplitude)))

    def expected_agreement(self, tolerance: float) -> Estimate | None:
        """Bead from which on the amplitudes may be expected to agree, by the decay of the last few beats' mismatch.

        The uncertainty is the difference to what the last two half beats alone say, or, if only two were seen, half the
        distance still to go; at least half a beat and 5% of that distance, and what follows from a top that lies up to
        half a bead beside a recorded one; beside that, what the errors of the amplitudes change. None without two whole
        half beats, or if the beats do not decay.
        """
        tops = self._tops()
        if len(tops) < 2:
            return None
        estimates = [_extrapolated(tops[-count:], tolerance) for count in (2, 3)]
        if estimates[0] is None or estimates[1] is None:
            return None
        value = max(estimates[1], float(tops[-1, 0]))
        other = abs(estimates[0] - value) if len(tops) > 2 else 0.5 * abs(value - float(tops[-1, 0]))
        ahead, span = value - float(tops[-1, 0]), float(np.ptp(tops[-3:, 0]))
        half = float(self.half_beat or 0.0)
        missed = 1.0 - math.cos(0.5 * math.pi / max(1.0, half))
        decay = span / max(math.log(tops[-3:, 1].max() / tops[-1, 1]), 1e-9)
        beside = missed * min(decay, value) * (1.0 + ahead / span)
        errors = np.interp(tops[-3:, 0], self.bead, self._over_mean(self.largest_error)) * (2.0 / tops[-3:, 1] + 1.0)
        of_run = error_of_crossing(tops[-3:, 0], np.log(tops[-3:, 1]), math.log(tolerance), errors)
        return Estimate(value, max(other, 0.05 * ahead + half + beside) + of_run)

    def _tops(self) -> Floats:
        """[half beat, (bead, mismatch)] where the mismatch is largest between two changes of sign."""
        rows = []
        for low, high in zip(self.beats[:-1], self.beats[1:], strict=True):
            inside = np.flatnonzero((self.bead >= low) & (self.bead <= high))
            if len(inside):
                top = inside[np.argmax(self.mismatch[inside])]
                rows.append((float(self.bead[top]), float(self.mismatch[top])))
        return np.array(rows).reshape(-1, 2)


_AT_PLACES = ("bead", "arrival", "amplitude", "arrival_error", "amplitude_error", "pulse")
"""Fields of `Sharing` that are arrays [place, ...]."""


def sharing(waves: Waves, problem: Problem, impulses: Impulses | None = None) -> Sharing:
    """The leading waves of a run side by side, ahead of the kicked bead.

    Args:
        waves: leading waves.
        problem: what was run.
        impulses: by which the chains are compared, where `compared_by_impulses`; None where they are not known.
    """
    system = problem.system
    kicked, kicked_bead, _ = physics.largest_excitation(system)
    numbers = problem.rows.numbers[:: problem.direction]
    beads = along_the_way(problem, numbers)
    rows = np.searchsorted(beads, along_the_way(problem, waves.bead))

    def side_by_side(values: Floats) -> Floats:
        """Table [place, chain] of values [wave]; NaN in chains that do not count."""
        table = np.full((len(beads), problem.chains), np.nan)
        table[rows, waves.chain - 1] = values
        table[:, apart] = np.nan
        return table[clear]

    apart = np.zeros(problem.chains, dtype=bool)
    if physics.coupled(system):
        apart[:] = True
        apart[physics.tied_to(system, kicked - 1)] = False
    clear = np.ones(len(beads), dtype=bool)
    clear = np.all(np.isfinite(side_by_side(waves.peak_velocity)[:, ~apart]), axis=1)
    clear &= (beads > along_the_way(problem, kicked_bead)) & (beads <= problem.beads - CLEAR)
    clear &= of_one_kind(problem)[numbers - 1]
    shared = Sharing(
        kicked - 1,
        beads[clear],
        side_by_side(waves.arrival),
        side_by_side(waves.peak_velocity),
        math.nan if physics.acted_on(system) else physics.energy(system),
        side_by_side(waves.arrival_error),
        side_by_side(waves.peak_velocity_error),
        wave_of(system),
        LoadedSpeed(system, problem.direction) if physics.loaded(system) else None,
        pulse=side_by_side(waves.pulse.astype(np.float64)),
    )
    if impulses is not None:
        shared = _with_impulses(shared, impulses, problem)
    return replace(shared, changing=_changing(shared.followed, problem))


def _with_impulses(shared: Sharing, impulses: Impulses, problem: Problem) -> Sharing:
    """Waves with the impulses of first contacts as amplitudes; 0 where a bead received none."""
    mass = np.broadcast_to(problem.system.mass, (problem.chains, problem.beads))
    table, bead = np.full((problem.beads + 1, problem.chains), np.nan), impulses.pushed(problem.direction)
    table[along_the_way(problem, bead)] = (impulses.first / mass[:, bead - 1]).T
    amplitude = np.where(np.isfinite(shared.amplitude), table[shared.bead], np.nan)
    error = np.full_like(amplitude, impulses.imbalance)
    return replace(shared, amplitude=amplitude, amplitude_error=error, of_impulses=True)


def _changing(shared: Sharing, problem: Problem) -> str:
    """Reason why amplitudes have no limit; empty where they may have one."""
    system = problem.system
    if not system.holds(Fact.PULSE):
        return "no pulse keeps its shape"
    if dissipates(system):
        return "energy is dissipated"
    if len(shared) == 0:
        return ""
    tied, period = physics.tied_to(system, shared.kicked), period_of(system)
    first, last = int(shared.bead[shared.tail]), int(shared.bead[-1])
    low, high = sorted(along_the_way(problem, bead) for bead in (first, last))
    if not all(repeats_between(system, chain, low - CLEAR, high + CLEAR, period) for chain in tied):
        return "beads, contacts or loads differ along the chain"
    alone = shared.of_tied(shared.amplitude).shape[1] == 1
    if alone or np.max(shared.mismatch[shared.tail :]) < AGREEMENT:
        return ""
    if unlike(system, shared.kicked):
        return "chains of unlike beads are coupled"
    if last_springs(problem, shared.kicked) < first:
        return "the chains are not coupled there"
    if not resolved(shared, system):
        return "recorded beads are too far apart to show beats"
    return "" if shared.half_beat is not None else "the chains have exchanged energy for less than half a beat"


def unlike(system: System, kicked: int) -> bool:
    """Whether beads of one row differ between the kicked chain, from 0, and those it is tied to."""
    tied = physics.tied_to(system, kicked)
    tables = [np.asarray(system.mass), *(np.asarray(value) for link in system.along for value in link.law)]
    return any(table.ndim == 2 and bool(np.any(np.ptp(table[tied], axis=0))) for table in tables)


def last_springs(problem: Problem, kicked: int) -> int:
    """Last row along the way in which springs tie the kicked chain, from 0, and others to each other; 0 without any."""
    system = problem.system
    tied, rows = physics.tied_to(system, kicked), along_the_way(problem, np.arange(1, system.beads + 1))
    last = 0
    for link in system.couplings:
        edges = [edge for edge, (chain, _) in enumerate(link.edges) if chain in tied]
        for value in link.law:
            coupled = np.any(np.broadcast_to(value, (len(link.edges), system.beads))[edges] != 0.0, axis=0)
            last = max(last, int(np.max(rows[coupled], initial=0)))
    return last


def resolved(shared: Sharing, system: System) -> bool:
    """Whether the places show beats: they lie near enough together, or impulses are known where they are compared."""
    if compared_by_impulses(system):
        return shared.of_impulses
    apart = int(np.diff(shared.bead).max(initial=1))
    if apart == 1 or not physics.coupled(system):
        return True
    of_modes = 1.0 if physics.open_row(system) else 0.5 * rates.modal_frequency(system) ** 2 / physics.kappa(system)
    return bool(apart <= RESOLVED / math.sqrt(of_modes * physics.kappa_of_pulses(system)))


def dissipates(system: System) -> bool:
    """Whether contacts or beads lose energy, or contacts yield, so that every pulse decays as long as it runs."""
    along, _, ground, _, contacts = physics.dissipation_names(system)
    return any(name is not None for name in (along, ground, contacts))


def runs_exact_waves(system: System) -> bool:
    """Whether the exact solitary wave of the contacts can run in every chain: beads alike, touching, and undamped."""
    return has_wave(system) and physics.alike(system) and not physics.gap(system) and not dissipates(system)


def _extrapolated(tops: Floats, tolerance: float) -> float | None:
    """Bead at which an exponential through (bead, mismatch) rows reaches a tolerance; None if it does not fall."""
    slope, intercept = np.polyfit(tops[:, 0], np.log(tops[:, 1]), 1)
    return float((np.log(tolerance) - intercept) / slope) if slope < 0.0 else None


def error_of_crossing(places: Floats, values: Floats, level: float, errors: Floats) -> float:
    """Bound on the error of where the line fitted to values crosses a level, by errors of the values.

    Args:
        places: where the values are, [value].
        values: what the line is fitted to, [value].
        level: value of the line that is asked for.
        errors: bounds on the errors of the values, small against their range, [value].
    """
    slope, intercept = np.polyfit(places, values, 1)
    return error_of_line(places, errors, (level - intercept) / slope) / abs(float(slope))


def error_of_line(places: Floats, errors: Floats, at: float) -> float:
    """Bound on the error of the line fitted to values, at a place, by errors of the values.

    Args:
        places: where the values are, [value].
        errors: bounds on the errors of the values, [value].
        at: place.
    """
    offset = places - np.mean(places)
    weights = 1.0 / len(places) + (at - np.mean(places)) * offset / np.sum(offset**2)
    return float(np.sum(np.abs(weights) * errors))
