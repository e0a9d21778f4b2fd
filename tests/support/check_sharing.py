"""How chains share a pulse, computed once more from the table of leading waves; and what is said about it."""

import itertools
import math
import re
from typing import Any

import numpy as np
from case import Case
from check_energy import work_input
from check_waves import CLEAR, Shared, exact_of, period, shared_of, tied
from comparing import About, Either, Holds
from own_wave import wave
from scene_keys import blows, hardest

TOLERANCES = (0.1, 0.01, 0.001)
EQUAL, BEATING, SHORT = "equipartitioned and synchronised", "beating", "too short"
ALONE, UNSURE, UNLIKE, NO_PULSE = "no energy exchange", "inconclusive", "of different beads", "does not apply"


def expected(case: Case) -> dict[str, Any]:
    """Key of ``analysis.json``."""
    return {"equipartition": equipartition(case)}


class Beats:
    """What the table of leading waves says of the chains: the definitions of `analysis.sharing.equipartition`."""

    def __init__(self, case: Case, shared: Shared) -> None:
        self.case, self.shared, self.bead = case, shared, shared.count
        amplitude = shared.of_tied(shared.amplitude)
        self.several = amplitude.shape[1] > 1
        self.mean = amplitude.mean(axis=1)
        self.mismatch = (amplitude.max(axis=1) - amplitude.min(axis=1)) / self.mean
        arrival = shared.of_tied(shared.arrival)
        self.passage = passage(case, shared, self.mean)
        self.spread = (arrival.max(axis=1) - arrival.min(axis=1)) / self.passage
        self.deviation = shared.amplitude[:, shared.kicked] / self.mean - 1.0
        self.crossings = self._crossings()

    def _crossings(self) -> Any:
        large = np.flatnonzero(np.abs(self.deviation) > 1e-5)
        found = []
        for before, after in itertools.pairwise(large):
            one, other = self.deviation[before], self.deviation[after]
            if np.sign(one) != np.sign(other):
                found.append(self.bead[before] + (self.bead[after] - self.bead[before]) * one / (one - other))
        return np.array(found)

    @property
    def half(self) -> float | None:
        """Beads in the last half beat."""
        return float(self.crossings[-1] - self.crossings[-2]) if len(self.crossings) > 1 else None

    @property
    def length(self) -> tuple[float, float] | None:
        """Of a beat, and its scatter."""
        half = np.diff(self.crossings)
        if len(half) == 0:
            return None
        return 2.0 * float(half.mean()), 2.0 * float(np.std(half, ddof=1)) if len(half) > 1 else float(half[0])

    def holds_from(self, good: Any) -> int | None:
        """First bead from which on something holds, for half a beat at least."""
        bad = np.flatnonzero(~good)
        start = int(bad[-1]) + 1 if len(bad) else 0
        if start >= len(self.bead) or not self.several or self.half is None:
            return None
        return int(self.bead[start]) if self.bead[-1] - self.bead[start] >= self.half else None

    @property
    def tail(self) -> int:
        """First place of the last half beat, or of the last tenth of the beads."""
        length = self.half if self.half is not None else 0.1 * (self.bead[-1] - self.bead[0])
        return min(int(np.searchsorted(self.bead, self.bead[-1] - length)), max(0, len(self.bead) - 5))

    def final(self) -> tuple[float, float] | None:
        """Mean amplitude over the tail, and the largest deviation from it or the change still to come; None without.

        Three stretches of as many places: the last change is small beside the deviation, or half the one before.
        """
        if changing(self.case, self):
            return None
        last, many = self.shared.of_tied(self.shared.amplitude)[self.tail :], len(self.bead) - self.tail
        value, off = float(last.mean()), float(np.max(np.abs(last - last.mean())))
        before = [float(self.mean[k : k + many].mean()) for k in (self.tail - many, self.tail - 2 * many) if k >= 0]
        changes = [a - b for a, b in itertools.pairwise([*before[::-1], value])][::-1]
        if changes and abs(changes[0]) <= max(1e-6 * value, 0.5 * off):
            return value, off
        ratio = changes[0] / changes[1] if len(changes) > 1 and changes[1] else math.inf
        if not 0.0 <= ratio <= 0.5:
            return None
        return value, max(off, abs(changes[0]) * ratio / (1.0 - ratio))


def changing(case: Case, beats: Beats) -> bool:
    """Whether the leading waves have no steady amplitude: decay, beads that differ, or an exchange not over."""
    own, chains, cell = case.nature, tied(case), period(case)
    if not case.pulse or dissipates(case):
        return True
    first, last = int(beats.bead[beats.tail]), int(beats.bead[-1])
    for table in (own.mass[chains, :-1], own.strength[chains], own.load[chains]):
        part = (table if case.way > 0 else table[:, ::-1])[:, max(first - CLEAR - 1, 0) : last + CLEAR]
        size = np.maximum(np.abs(part).max(axis=1, keepdims=True), 1e-300)
        if np.any(np.abs(part[:, cell:] - part[:, :-cell]) > 1e-9 * size):
            return True
    if not beats.several or beats.mismatch[beats.tail :].max() < 0.01:
        return False
    return unlike(case) or springs_end(case) < first or not resolved(case) or beats.half is None


def dissipates(case: Case) -> bool:
    """Whether contacts or beads lose energy."""
    return bool(np.any(case.nature.loss[0]) or case.nature.drag)


def springs_end(case: Case) -> int:
    """Last row, along the way, in which springs tie the chains; 0 without."""
    rows = [
        np.flatnonzero(np.abs(k) + np.abs(c) * np.ones_like(k)) for a, _, k, c in case.nature.springs if a in tied(case)
    ]
    found = np.concatenate([*rows, np.zeros(0, int)]) + 1
    return int(np.max(found if case.way > 0 else case.scene.beads + 1 - found, initial=0))


def passage(case: Case, shared: Shared, amplitude: Any) -> Any:
    """Time in which the wave passes at half its height; on a load that of the long-wave theory."""
    exact = exact_of(case)
    if not case.nature.loaded:
        return exact.width / exact.speed_at(amplitude)
    from check_sound import local, speed, theory

    own, p = case.nature, case.nature.exponent
    sound = speed(own)[shared.kicked, shared.bead - 1]
    rest = np.pad(local(own, own.rest), ((0, 0), (1, 1)), mode="edge")
    rest = (0.5 * (rest[:, 1:] + rest[:, :-1]))[shared.kicked, shared.bead - 1]
    ratios = 1.0 + np.logspace(-4.0, 13.0, 4000)
    over = np.array([theory(f, p) for f in ratios])
    high = over * (ratios ** (1.0 / p) - 1.0)  # amplitude over c0 times the overlap at rest
    return exact.width / (sound * np.interp(np.log(amplitude / (sound * rest)), np.log(high), over))


def near(case: Case) -> float:
    """Relative tolerance: of what goes by the table of the theory's speeds on a load."""
    return 1e-3 if case.nature.loaded else 1e-9


def estimate(found: tuple[float, float] | None, rounded: float = 1e-9) -> Any:
    if found is None:
        return None
    return {"value": About(found[0], rounded * abs(found[0])), "uncertainty": About(found[1], rounded * abs(found[0]))}


def equipartition(case: Case) -> dict[str, Any]:
    """See `workflow.verdicts.analysis_report.equipartition`."""
    shared = shared_of(case)
    none = dict.fromkeys(map(str, TOLERANCES))
    amplitudes, arrivals, final, beat = none, none, None, None
    if len(shared):
        beats = Beats(case, shared)
        amplitudes = {str(one): beats.holds_from(beats.mismatch < one) for one in TOLERANCES}
        rounded = near(case)
        arrivals = {
            str(one): Either(tuple(beats.holds_from(beats.spread < one * (1.0 + e)) for e in (-rounded, 0.0, rounded)))
            for one in TOLERANCES
        }
        beat = estimate(beats.length)
        if (settled := beats.final()) is not None:
            value, off = settled
            final = {"value": About(value), "uncertainty": About(off, 1e-12), "reduction": About(1.0 - value, 1e-12)}
    if not case.pulse or not resolved(case):
        amplitudes, arrivals, beat = none, none, None
    return {
        "verdict": Holds("the sentence for its state", lambda found: sentence_fits(case, found)),
        "state": state(case),
        "since": since(case),
        "expected": ahead(case),
        "amplitudes": amplitudes,
        "arrivals": arrivals,
        "final": final,
        "range": span(case),
        "energy_share": share(case),
        "beat_length": beat,
        "decay_law": decay(case),
    }


def span(case: Case) -> Any:
    """Least and largest amplitude over the second half of the way."""
    shared = shared_of(case)
    if not case.pulse or len(shared) == 0:
        return None
    late = shared.count >= 0.5 * (shared.count[0] + shared.count[-1])
    amplitude = shared.of_tied(shared.amplitude)[late]
    first = int(shared.count[late][0])
    return {
        "first": first,
        "last": int(shared.count[-1]),
        "least": About(amplitude.min()),
        "largest": About(amplitude.max()),
    }


def energy_input(case: Case) -> tuple[float, float]:
    """Energy of the kicks, and work of pushes and drives until the end; and its error."""
    if not case.acted_on:
        return case.nature.kick_energy, 0.0
    if not case.directory.whole:
        return math.nan, 0.0
    return float(work_input(case, case.frames.time[-1:])[0]), case.energy_off


def share(case: Case) -> dict[str, Any]:
    """Of the exact waves of the last amplitudes, and of what the frames hold within three beads of the peaks."""
    shared, (energy, off) = shared_of(case), energy_input(case)
    exact = None
    plain = case.alike and case.pulse and not (case.nature.loaded or case.nature.gap or dissipates(case))
    if len(shared) and plain and np.isfinite(energy):
        exact = float(np.nansum(exact_of(case).energy * shared.amplitude[-1] ** 2)) / energy
    measured = None
    passed = np.flatnonzero(np.all(np.isfinite(shared.of_tied(shared.arrival)), axis=1))
    if len(passed) and case.pulse and case.scene.output.beads == "all":
        rows = [row for row in case.directory.table("waves.csv") if row["bead"] == shared.bead[passed[-1]]]
        if all(row["wave_energy"] is not None for row in rows):  # null where another pulse is as near
            measured = sum(row["wave_energy"] or 0.0 for row in rows) / case.unit.energy / energy
    within = 1e-9 + 2.0 * off / energy if energy > off else math.inf
    return {"exact": About(exact, within), "measured": About(measured, within)}


def decay(case: Case) -> Any:
    """The law v = v0 (1 - n / n*)**2.5, by a straight line through v**0.4."""
    shared, chain = shared_of(case), hardest(case.scene)[0] - 1
    springs = [(a, b, k, c) for a, b, k, c in case.nature.springs]
    linear = all(not np.any(c) and np.ptp(k) == 0.0 for _, _, k, c in springs)
    total = sum(float(k[0]) for a, b, k, _ in springs if chain in (a, b))
    one = len(blows(case.scene)) == 1 and case.nature.exponent == 1.5 and case.alike and not case.exchanges
    if not (one and case.pulse and not case.nature.loaded and linear and total and len(shared)):
        return None
    start = hardest(case.scene)[1] if case.way > 0 else case.scene.beads + 1 - hardest(case.scene)[1]
    own = shared.amplitude[:, chain]
    others = np.nanmax(np.delete(shared.amplitude, chain, axis=1), axis=1)
    used = []
    for k in np.flatnonzero(shared.count >= start + 10).tolist():
        if not others[k] < 0.3 * own[k]:
            break
        used.append(k)
    if len(used) < 10:
        return None
    way = (shared.count[used] - start).astype(float)
    matrix = np.stack([way, np.ones_like(way)], axis=1)
    solution, _, _, _ = np.linalg.lstsq(matrix, own[used] ** 0.4, rcond=None)
    if solution[0] >= 0.0:
        return None
    n_star, line = -solution[1] / solution[0], matrix @ solution
    residual = own[used] ** 0.4 - line
    covariance = np.linalg.inv(matrix.T @ matrix) * float(residual @ residual) / (len(used) - 2)
    gradient = np.array([solution[1] / solution[0] ** 2, -1.0 / solution[0]])
    exact = wave(1.5)
    return {
        "v0": About(float(solution[1] ** 2.5), 1e-8),
        "n_star": About(float(n_star), 1e-7 * float(n_star)),
        "n_star_error": About(float(np.sqrt(gradient @ covariance @ gradient)), 1e-6 * float(n_star)),
        "n_star_expected": About(10.0 * exact.energy / (exact.shift**2 * total) * 0.6816315**0.4, 1e-6)
        if start == 1
        else None,
        "first": int(shared.count[used[0]]),
        "last": int(shared.count[used[-1]]),
        "deviation": About(float(np.max(np.abs(line**2.5 / own[used] - 1.0))), 1e-8),
    }


# --- the verdict ------------------------------------------------------------------------------------------------------


def unlike(case: Case) -> bool:
    """Whether beads or contacts of one row differ among the tied chains."""
    own, chains = case.nature, tied(case)
    return any(bool(np.any(np.ptp(table[chains], axis=0) > 1e-12)) for table in (own.mass, own.strength, own.rest))


def swing(case: Case) -> float:
    """Half the square of the fastest mode of a row over that of two chains: kappa of two that are as fast."""
    chains, most = case.scene.chains, 0.0
    for bead in range(case.scene.beads):
        matrix = np.zeros((chains, chains))
        for a, b, k, _ in case.nature.springs:
            matrix[[a, b], [a, b]] += k[bead]
            matrix[[a, b], [b, a]] -= k[bead]
        most = max(most, float(np.linalg.eigvals(matrix / case.nature.mass[:, bead, np.newaxis]).real.max()))
    return 0.5 * most


def open_row(case: Case) -> bool:
    """Whether each chain is tied to the next by equal linear springs, and no others are."""
    own = case.nature.springs
    linear = all(not np.any(c) and np.ptp(k) == 0.0 and k[0] == own[0][2][0] for _, _, k, c in own)
    return linear and [(a, b) for a, b, *_ in own] == [(a, a + 1) for a in range(case.scene.chains - 1)]


def resolved(case: Case) -> bool:
    """Whether recorded beads lie near enough together to show beats."""
    apart = int(np.diff(shared_of(case).count).max(initial=1))
    if apart == 1 or not case.nature.springs:
        return True
    kappa = float(case.nature.springs[0][2][0]) if open_row(case) else swing(case)
    return bool(case.nature.gap == 0.0 and apart <= 2.0 / math.sqrt(kappa))


def doubtful(case: Case) -> bool:
    """Whether single waves are known less well than 1% over the last half beat."""
    shared = shared_of(case)
    beats = Beats(case, shared)
    late = beats.bead >= beats.bead[-1] - (beats.half or 0.0)
    arrival, error = shared.of_tied(shared.arrival), np.nan_to_num(shared.of_tied(shared.arrival_error))
    if np.any(np.isnan(arrival[late])):
        return True
    off = shared.of_tied(np.nan_to_num(shared.amplitude_error) / shared.amplitude)[late]
    return bool(max(off.max(), (error[late] / beats.passage[late, np.newaxis]).max()) > 0.01)


def state(case: Case) -> Any:
    """In one word."""
    if not case.pulse:
        return NO_PULSE
    if case.scene.chains == 1 or not case.nature.springs or len(tied(case)) == 1:
        return ALONE
    shared = shared_of(case)
    if len(shared) == 0:
        return SHORT
    beats, other = Beats(case, shared), UNLIKE if unlike(case) else None
    if not resolved(case):
        return other or SHORT
    level, step = beats.holds_from(beats.mismatch < 0.01), beats.holds_from(beats.spread < 0.01)
    if level is not None and doubtful(case):
        return UNSURE
    if level is not None and step is not None:
        return EQUAL
    if springs_end(case) + CLEAR < beats.bead[-1]:
        return ALONE
    if beats.length is None:
        return other or SHORT
    return other or BEATING


def since(case: Case) -> Any:
    if state(case) != EQUAL:
        return None
    beats = Beats(case, shared_of(case))
    level, step = beats.holds_from(beats.mismatch < 0.01), beats.holds_from(beats.spread < 0.01)
    assert level is not None
    assert step is not None
    return max(level, step)


def ahead(case: Case) -> Any:
    """Where chains should agree: beyond the last bead seen, and only of chains that have not come to."""
    if state(case) not in (BEATING, SHORT):
        return None
    last = int(shared_of(case).count[-1]) if len(shared_of(case)) else 0
    return Holds(
        f"null, or a bead beyond {last}",
        lambda found: found is None or (found["value"] > last and found["uncertainty"] > 0.0),
    )


SENTENCES = {
    NO_PULSE: r"does not apply: no pulse keeps its shape in this scene",
    ALONE: r"no energy exchange(: a single chain|: no chain is coupled to another|: the kicked chain is coupled to no "
    r"other| beyond row (?P<end>\d+), where springs end; at bead (?P<last>\d+) amplitudes differ by "
    r"(?P<last_mismatch>[\d.]+)%)",
    SHORT: r"too short: .*",
    EQUAL: r"equipartitioned and synchronised: amplitudes agree to 1% from bead (?P<level>\d+) on, arrivals to 1% of "
    r"the passage time from bead (?P<step>\d+) on \(observed to bead (?P<last>\d+)\)",
    UNSURE: r"inconclusive: .*",
    BEATING: r"beating: .*",
    UNLIKE: r"the chains are of different beads: at bead (?P<last>\d+) amplitudes differ by "
    r"(?P<last_mismatch>[\d.]+)%, and no agreement to 1% has lasted for half a beat",
}
"""Of each state; numbers by name."""

PARTS = (
    r"amplitudes differ by up to (?P<recent>[\d.]+)% over the last half beat to bead (?P<last>\d+)",
    r"at bead (?P<last>\d+) amplitudes differ by (?P<last_mismatch>[\d.]+)%",
    r"no complete half beat is observed to bead (?P<last>\d+), where amplitudes differ by (?P<last_mismatch>[\d.]+)%",
    r"no beat is seen from bead (?P<first>\d+) to (?P<last>\d+), where amplitudes agree to (?P<largest>[\d.]+)%",
    r"beats of (?P<beat>[\d.]+) \+- (?P<beat_off>[\d.]+) beads",
    r"amplitudes agree to 1% from bead (?P<level>\d+) on",
    r"arrivals differ by up to (?P<recent_step>[\d.]+)% of the wave's passage",
    r"they should agree to 1% from bead (?P<expected>\d+) \+- (?P<expected_off>\d+) on",
    r"towards zero (?P<n_star>\d+) beads from the kick",
    r"recorded beads lie up to (?P<apart>\d+) apart",
)


def sentence_fits(case: Case, text: str) -> bool:
    """Whether a verdict is that of its state, and its numbers are those of the tables, as far as they are printed."""
    pattern = SENTENCES[state(case)]
    whole = re.fullmatch(pattern, text)
    if whole is None:
        return False
    named = {name: value for name, value in whole.groupdict().items() if value is not None}
    for part in PARTS:
        if (found := re.search(part, text)) is not None:
            named |= found.groupdict()
    if len(shared_of(case)) == 0:
        return (
            f"bead {case.scene.beads - CLEAR} was passed in every chain" in text if state(case) == SHORT else not named
        )
    due = said_numbers(case)
    return all(abs(float(value) - due[name]) <= printed(value) for name, value in named.items())


def printed(value: str) -> float:
    """Half a unit of the last digit, and a little."""
    digits = len(value.partition(".")[2])
    return 0.501 * 10.0**-digits


def said_numbers(case: Case) -> dict[str, float]:
    """What a verdict may say."""
    shared = shared_of(case)
    beats, told = Beats(case, shared), case.report["equipartition"]
    found: dict[str, Any] = {
        "level": beats.holds_from(beats.mismatch < 0.01),
        "step": beats.holds_from(beats.spread < 0.01),
        "first": int(beats.bead[0]),
        "last": int(beats.bead[-1]),
        "largest": 100.0 * float(beats.mismatch.max()),
        "end": springs_end(case),
        "last_mismatch": 100.0 * beats.mismatch[-1],
        "apart": int(np.diff(beats.bead).max(initial=0)),
    }
    if (length := beats.length) is not None:
        late = beats.bead >= beats.bead[-1] - 0.5 * length[0]
        found |= {"beat": length[0], "beat_off": length[1], "recent": 100.0 * beats.mismatch[late].max()}
        found["recent_step"] = 100.0 * np.nanmax(beats.spread[late])
    if told["expected"] is not None:
        found |= {"expected": told["expected"]["value"], "expected_off": math.ceil(told["expected"]["uncertainty"])}
    if told["decay_law"] is not None:
        found["n_star"] = told["decay_law"]["n_star"]
    return {name: math.nan if value is None else float(value) for name, value in found.items()}
