"""Tables of leading waves, and every pulse, against the true maxima of the beads' velocities."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from case import FLOOR, Case
from comparing import About, Either, Given, Holds, Tally, Unknown
from own_wave import wave
from scene_keys import hardest, kicks
from truth import Maximum

SMALLEST = 2e-3
"""Of V: maxima that a table must have; twice those that it may have."""

CLEAR = 5
"""Beads from the free end that feel it."""

Row = dict[str, Any]


def numbers(case: Case, row: Row) -> tuple[float, float, float, float]:
    """Peak, its error, arrival and its error of a row, dimensionless."""
    unit = case.unit

    def of(name: str, worth: float, otherwise: float) -> float:
        return otherwise if row[name] is None else row[name] / worth

    return (
        of("peak_velocity", unit.velocity, math.nan),
        of("peak_velocity_error", unit.velocity, math.inf),
        of("arrival", unit.time, math.nan),
        of("arrival_error", unit.time, math.inf),
    )


def seen_at(case: Case) -> list[int]:
    """Beads of which a table knows: `analyze` takes over that which LAMMPS wrote of all."""
    return list(range(1, case.scene.beads + 1)) if case.scene.output.peaks else case.directory.recorded


def table(case: Case, name: str) -> Any:
    """Of ``waves.csv`` and ``peaks.csv``."""
    rows = case.directory.table(name)
    return Given(lambda _: [expected_row(case, rows, row) for row in rows])


def sound(case: Case) -> bool:
    """Whether maxima are of sound or a drive, so that which of them comes first hangs by a hair."""
    return bool(case.driven or case.nature.loaded)


def expected_row(case: Case, rows: list[Row], row: Row) -> dict[str, Any]:
    """One row from what the integrator here says, and from the rows beside it."""
    chain, bead = int(row["chain"]), int(row["bead"])
    due = fits(case, chain, bead, row)
    found: dict[str, Any] = {
        "chain": Holds("a chain", lambda value: value in range(1, case.scene.chains + 1)),
        "bead": Holds("a bead that was seen", lambda value: value in seen_at(case)),
        "arrival": due if not sound(case) else Unknown("sound"),
        "peak_velocity": due if not sound(case) else Unknown("sound"),
        "speed": About(speed(case, rows, row)),
        "arrival_error": Holds("not negative", lambda value: value is None or value >= 0.0),
        "peak_velocity_error": Holds("not negative", lambda value: value is None or value >= 0.0),
    }
    if "lag" in row:
        late = 1e-14 * case.directory.duration * case.unit.time  # rounding of the arrivals
        found |= {"lag": About(lag(case, rows, row), late), **shape(case, row), **energies(case, row)}
    return found


def speed(case: Case, rows: list[Row], row: Row) -> float | None:
    """Beads per unit time along the way, from the rows on either side."""
    own = [one for one in rows if one["chain"] == row["chain"]]
    k = own.index(row)
    before, after = own[max(k - 1, 0)], own[min(k + 1, len(own) - 1)]
    if None in (before["arrival"], after["arrival"]) or before["arrival"] == after["arrival"]:
        return None
    return case.way * (after["bead"] - before["bead"]) / (after["arrival"] - before["arrival"])


def lag(case: Case, rows: list[Row], row: Row) -> float | None:
    """Behind the wave of the chain that was hit hardest."""
    chain = hardest(case.scene)[0]
    at = [one["arrival"] for one in rows if (one["chain"], one["bead"]) == (chain, row["bead"])]
    return None if not at or at[0] is None or row["arrival"] is None else row["arrival"] - at[0]


def fits(case: Case, chain: int, bead: int, row: Row) -> Holds:
    """Whether a row may be the first maximum of its bead, or with kicks both ways any."""
    true, stated = case.truth, case.stated
    peak, off, arrival, late = numbers(case, row)
    # the run's own check leaves out the bead that the pulse ends at
    end = 3.0 if bead in (1, case.scene.beads) else 1.0
    allowed = max(FLOOR, stated.peak) * end + off
    late += max(FLOOR, stated.arrival) * end
    maxima = [one for one in true.maxima(chain, bead) if one.velocity > SMALLEST / 2 - stated.peak]
    first = true.levels(chain, bead) + [
        one
        for k, one in enumerate(maxima)
        if case.opposed
        or all(
            before.prominence < 2.0 * allowed or before.velocity < SMALLEST or not shown(case, before, chain, bead)
            for before in maxima[:k]
        )
    ]
    near = ", ".join(f"{one.velocity:.6g} at {one.time:.5g} ({one.centre:.5g})" for one in first[:3])
    good = any(fit(case, one, peak, arrival, allowed, late) for one in first)
    claim = f"{near} (this: {peak:.6g} to {allowed:.1e} at {arrival:.5g} to {late:.1e})"
    return Holds(claim, lambda _: good)


def fit(case: Case, one: Maximum, peak: float, arrival: float, allowed: float, late: float) -> bool:
    """Whether a row may be this maximum."""
    if not abs(one.velocity - peak) <= allowed:
        return False
    if math.isnan(arrival):
        return True
    if case.nature.gap > 0.0:
        # an error of velocity adds up to one of displacement
        more = allowed * (one.time + abs(one.time - one.centre)) / peak
        return abs(one.centre - arrival) <= late + more
    return one.since - late <= arrival <= one.until + late


def shown(case: Case, one: Maximum, chain: int, bead: int) -> bool:
    """Whether the frames alone show that there is a maximum near it, and no higher one as near."""
    true, every = case.truth, case.every
    v = true.way * true.fine[1][:, chain - 1, bead - 1]
    frames = np.interp(np.arange(0.0, true.end + 1e-9, every), true.times, v)
    k = int(one.time / every)
    # of two maxima less than two frames apart, a largest frame shows the higher one
    higher = [other.time / every for other in true.maxima(chain, bead) if other.velocity > one.velocity]
    return any(
        0 < j < len(frames) - 1
        and frames[j] > SMALLEST / 2
        and frames[j - 1] < frames[j] >= frames[j + 1]
        and not any(abs(place - j) < 1.0 for place in higher)
        for j in (k, k + 1)
    ) or (one.time == 0.0 and frames[0] >= frames[1])


def lacking(case: Case, name: str) -> Iterator[str]:
    """Beads that a pulse passed, and a table does not have."""
    if sound(case):
        return
    true, stated, scene = case.truth, case.stated, case.scene
    there = {(int(row["chain"]), int(row["bead"])) for row in case.directory.table(name)}
    needed = plain_pulses(case) if case.opposed else None
    speed_of = np.abs(true.fine[1]).max(axis=1)
    ahead = [true.way * bead for _, bead, velocity in kicks(scene) if true.way * velocity > 0.0]
    start = min(ahead, default=-math.inf)
    for chain in range(1, scene.chains + 1):
        for bead in seen_at(case):
            if (chain, bead) in there or (needed is not None and (chain, bead) not in needed):
                continue
            if scene.walls and true.way * bead < start:
                continue  # comes from the wall behind
            for one in true.maxima(chain, bead):
                enough = one.velocity > SMALLEST + stated.peak and one.prominence > FLOOR + stated.peak
                if not (enough and one.since < true.end - 2.0 * case.every and shown(case, one, chain, bead)):
                    continue
                front = int(np.flatnonzero(speed_of[round(one.time / true.times[1])] > SMALLEST)[-1]) + 1
                if not case.windowed or bead >= front - 8:  # what is far behind the front may be gone
                    yield f"lacks bead {bead} of chain {chain}: {one.velocity:.3g} V at {one.time:.4g}"
                    break


def plain_pulses(case: Case) -> set[tuple[int, int]]:
    """Beads (chain, bead) that a pulse passes which nobody could miss, though there are kicks both ways.

    At six beads in a row or more, pressed against a neighbour, at nearly the speed of the exact wave, which hardly
    changes.
    """
    true, found = case.truth, set()
    order = range(1, case.scene.beads + 1)[:: true.way]
    for chain in range(1, case.scene.chains + 1):
        run: list[tuple[int, Maximum]] = []
        for bead in [*order, 0]:
            pressed = [
                one
                for one in (true.maxima(chain, bead) if bead else [])
                if one.pressed > 0.4 * max(one.velocity, 0.0) ** 0.8
            ]
            best = max(pressed, key=lambda one: one.velocity, default=None)
            steady = best is not None and best.velocity > 0.2
            if steady and best is not None and run:
                before = run[-1][1]
                delay = (best.time - before.time) * 0.907 * (best.velocity * before.velocity) ** 0.1
                steady = 0.8 < delay < 1.25 and 0.8 < best.velocity / before.velocity < 1.25
            if not steady:
                if len(run) >= 6:
                    found |= {(chain, number) for number, _ in run}
                run = []
            if best is not None and best.velocity > 0.2:
                run.append((bead, best))
    return found


# --- what a waveform says ---------------------------------------------------------------------------------------------


def exact_of(case: Case) -> Any:
    """The exact wave; that of spheres where there is none."""
    whole = case.pulse and not case.nature.loaded
    return wave(case.nature.exponent if whole else 1.5)


def watched(case: Case, arrival: float, peak: float, speed: float | None) -> Any:
    """Frames within four beads of travel of a passage, at most 128; None where the record ends before."""
    own = speed if speed is not None and speed > 0.0 else float(exact_of(case).speed_at(peak))
    frames = math.ceil(4.0 / own / case.every)
    stride = max(1, math.ceil(2.0 * frames / 128))
    half = min(math.ceil(frames / stride), 64)
    chosen = round(arrival / case.every) + np.arange(-half, half + 1) * stride
    chosen = chosen[chosen >= 0]  # before the start nothing moves
    return None if chosen[-1] >= len(case.frames) else chosen


def shape(case: Case, row: Row) -> dict[str, Any]:
    """Width and residual; where they are given."""
    chain, bead, arrival = int(row["chain"]), int(row["bead"]), row["arrival"]
    if bead not in case.directory.recorded or arrival is None:
        return {"width": None, "residual": None}
    peak = row["peak_velocity"] / case.unit.velocity
    speed = None if row["speed"] is None else row["speed"] * case.unit.time
    if case.nature.gap > 0.0:  # an arrival is the centre of the impulse, and the wave is about its maximum
        near = case.truth.maxima(chain, bead)
        # by its centre: pulses that follow each other may be of one velocity
        best = min(near, key=lambda one: abs(one.centre - arrival / case.unit.time), default=None)
        if best is None or best.until - best.since > 0.1 or best.bend < 0.1 or abs(best.velocity - peak) > 1e-3:
            return {"width": Unknown("flies freely"), "residual": Unknown("flies freely")}
        found = {
            "width": width(case, chain, bead, best.time, peak, speed, case.way, row["width"]),
            "residual": residual(case, chain, bead, best.time, peak, speed, case.way, late=0.01),
        }
        return {name: Either((value, None)) for name, value in found.items()}  # null where the maximum is not sharp
    return {
        "width": width(case, chain, bead, arrival / case.unit.time, peak, speed, case.way, row["width"]),
        "residual": residual(case, chain, bead, arrival / case.unit.time, peak, speed, case.way),
    }


def residual(
    case: Case, chain: int, bead: int, arrival: float, peak: float, speed: float | None, way: int, late: float = 0.0
) -> Any:
    """Largest difference of velocity from the exact wave of the same peak within three beads of it, over the peak."""
    chosen = watched(case, arrival, peak, speed)
    if chosen is None or np.isnan(case.frames.v[chosen, chain - 1, bead - 1]).any():
        return None
    exact = exact_of(case)
    xi = exact.speed_at(peak) * (case.frames.time[chosen] - arrival)
    difference = np.abs(way * case.frames.v[chosen, chain - 1, bead - 1] / peak - exact.velocity(xi))
    near = [float(np.max(difference[np.abs(xi) <= reach], initial=0.0)) for reach in (3.0 - 1e-9, 3.0 + 1e-9)]
    return Either(tuple(About(value, 1e-8 + late) for value in near))


def width(
    case: Case, chain: int, bead: int, arrival: float, peak: float, speed: float | None, way: int, found: float | None
) -> Any:
    """Time above half of the peak, times the local speed."""
    chosen = watched(case, arrival, peak, speed)
    if chosen is None or not (speed or 0.0) > 0.0 or np.isnan(case.frames.v[chosen, chain - 1, bead - 1]).any():
        return None
    near, v = case.truth.velocity(chain, bead, case.frames.time[chosen[0]], case.frames.time[chosen[-1]])
    v, top = way * v, int(np.argmin(np.abs(near - arrival)))
    # frames do not show whether the velocity passes half of the peak by less than it bends between two of them
    seen = way * case.frames.v[chosen, chain - 1, bead - 1]
    bends = 0.125 * np.abs(np.diff(seen, 2))[np.abs(seen[1:-1] - 0.5 * peak) < 0.1 * peak]
    hidden = case.off[1] + case.stated.peak + float(np.max(bends, initial=0.0))
    step = float(case.frames.time[chosen[1]] - case.frames.time[chosen[0]])
    options = [_width_at(case, near, v, top, 0.5 * peak, off, speed, found, step) for off in (0.0, -hidden, hidden)]
    return Either(tuple(options))


def _width_at(
    case: Case, near: Any, v: Any, top: int, half: float, off: float, speed: float, found: float | None, step: float
) -> Any:
    """Time around one of many times, near, at which a velocity is above about half of its peak, times the speed."""
    level = half + off
    above = v > level
    left, right = np.flatnonzero(~above[:top]), np.flatnonzero(~above[top:])
    if len(left) == 0 or len(right) == 0:
        grazes = bool(v[0] < 1.02 * level or v[-1] < 1.02 * level)
        return Either((None, Holds("where the velocity is just half of the peak", lambda _: grazes)))
    ends, slopes = [], []
    for k in (left[-1], top + right[0] - 1):
        share = (v[k] - level) / (v[k] - v[k + 1]) if v[k] != v[k + 1] else 0.5
        ends.append(near[k] + share * (near[1] - near[0]))
        slopes.append(abs(v[k + 1] - v[k]) / (near[1] - near[0]))
    value = (ends[1] - ends[0]) * speed
    # a polynomial of degree 5 through six frames, finer in short pulses
    quick = case.every * max(1.0, 2.1 / max(ends[1] - ends[0], 1e-9))
    late = (4.0 * (case.off[1] + case.stated.peak) + 2.0 * abs(off)) / max(min(slopes), 1e-9)
    kinked = 10.0 if sound(case) else 1.0  # contacts that bear a load open all at once
    within = 4e-6 + 0.2 * kinked * quick**5 + late / max(ends[1] - ends[0], 1e-9)
    if found is None:
        # of the six frames around the crossing
        edge = ends[0] - near[0] < 3.0 * step or near[-1] - ends[1] < 3.0 * step
        return Holds("known", lambda _: quick > 0.7 or edge or max(v[0], v[-1]) > 0.98 * level)
    return Unknown("few frames within") if quick > 0.7 else About(value, within * abs(value))


# --- energies at a passage --------------------------------------------------------------------------------------------


def tied(case: Case) -> list[int]:
    """Chains, from 0, that the one that was hit is tied to, with itself; all where none is tied to any other."""
    pairs = [(one, other) for one, other, *_ in case.nature.springs]
    if not pairs:
        return list(range(case.scene.chains))
    group = {hardest(case.scene)[0] - 1}
    for _ in pairs:
        group |= {b for pair in pairs for a, b in (pair, pair[::-1]) if a in group}
    return sorted(group)


def of_one_kind(case: Case) -> Any:
    """Beads, [bead], of the masses that most rows have, the heavier of equally many; all where hardly two are alike."""
    mass = np.round(case.nature.mass, 14)
    if np.all(mass == 1.0):
        return np.ones(case.scene.beads, dtype=bool)
    kinds, which, count = np.unique(mass, axis=1, return_inverse=True, return_counts=True)
    if count.max() < max(2.0, 0.1 * case.scene.beads):
        return np.ones(case.scene.beads, dtype=bool)
    most = np.flatnonzero(count >= count.max() - 1)
    return which.reshape(-1) == most[np.argmax(kinds[:, most].sum(axis=0))]


def tracked(case: Case) -> Any:
    """Those of them among the recorded beads, [bead]; all recorded ones where none is."""
    recorded = np.isin(np.arange(1, case.scene.beads + 1), case.directory.recorded)
    like = recorded & of_one_kind(case)
    return like if like.any() else recorded


class Shared:
    """The leading waves at every bead that those of all tied chains passed clear of the far end.

    Attributes:
        bead: [place] as numbered in the scene, along the way.
        count: [place] the same, counted along the way.
        arrival, amplitude: [place, chain]; NaN in chains that are not tied.
    """

    def __init__(self, case: Case, rows: list[Row]) -> None:
        scene = case.scene
        self.case, self.tied, self.kicked = case, tied(case), hardest(scene)[0] - 1
        tables = np.full((4, scene.beads + 1, scene.chains), np.nan)
        for row in rows:
            peak, off, arrival, late = numbers(case, row)
            tables[:, int(row["bead"]), int(row["chain"]) - 1] = peak, arrival, off, late
        beads = np.array(seen_at(case))[:: case.way]
        count = beads if case.way > 0 else scene.beads + 1 - beads
        start = hardest(scene)[1] if case.way > 0 else scene.beads + 1 - hardest(scene)[1]
        good = np.all(np.isfinite(tables[0][beads][:, self.tied]), axis=1)
        good &= (count > start) & (count <= scene.beads - CLEAR) & of_one_kind(case)[beads - 1]
        self.bead, self.count = beads[good], count[good]
        self.amplitude, self.arrival, self.amplitude_error, self.arrival_error = (part[self.bead] for part in tables)
        for part in (self.amplitude, self.arrival):
            part[:, [chain for chain in range(scene.chains) if chain not in self.tied]] = np.nan

    def __len__(self) -> int:
        return len(self.bead)

    def of_tied(self, values: Any) -> Any:
        return values[:, self.tied]


def shared_of(case: Case) -> Shared:
    """Of ``waves.csv``."""
    if "shared" not in case.kept:
        case.kept["shared"] = Shared(case, case.directory.table("waves.csv"))
    return case.kept["shared"]


def energies(case: Case, row: Row) -> dict[str, Any]:
    """Of the chain, and within three beads of the wave's peak, when the waves on average pass the bead."""
    none = {"chain_energy": None, "wave_energy": None}
    if case.scene.output.beads != "all":
        return none
    shared = shared_of(case)
    known = np.flatnonzero(np.all(np.isfinite(shared.of_tied(shared.arrival)), axis=1))
    if len(known) > 400:
        return {"chain_energy": Unknown("of some places"), "wave_energy": Unknown("of some places")}
    place = np.flatnonzero(shared.bead[known] == row["bead"])
    if len(place) == 0:
        return none
    k = known[place[0]]
    mean = float(np.mean(shared.of_tied(shared.arrival)[k])) / case.every
    options = []
    for frame in {round(mean - 1e-7), round(mean + 1e-7)}:
        if frame < len(case.frames):
            options.append(_energies(case, shared, known, frame, int(row["chain"]) - 1))
    return {name: Either(tuple(option[name] for option in options)) if options else None for name in none}


def _energies(case: Case, shared: Shared, known: Any, frame: int, chain: int) -> dict[str, Any]:
    own, x, v = case.nature, case.frames.x[frame], case.frames.v[frame]
    energy = case.unit.energy
    kinetic, contacts = own.kinetic(v)[chain], own.in_contacts(x)[chain]
    total = float(np.sum(kinetic) + np.sum(contacts) + np.sum(own.in_ground(x)[chain]))
    total += sum(float(own.in_wall(wall, x)[chain]) for wall in own.walls)
    for (one, other, *_), part in zip(own.springs, own.in_springs(x), strict=True):
        total += 0.5 * float(np.sum(part)) * (chain in (one, other))
    if chain not in shared.tied:
        inside: tuple[float, ...] = (0.0,)
    else:
        arrivals = np.maximum.accumulate(shared.arrival[known, chain])
        peak = np.interp(case.frames.time[frame], arrivals, shared.count[known])
        beads = np.arange(1, case.scene.beads + 1)
        along = beads if case.way > 0 else case.scene.beads + 1 - beads
        near = [np.abs(along - bead) <= reach(case) for bead in {round(peak - 1e-6), round(peak + 1e-6)}]
        inside = tuple(float(np.nansum(kinetic[n]) + np.nansum(contacts[n[1:] & n[:-1]])) for n in near)
    missing = case.windowed
    return {
        "chain_energy": None if missing else About(total * energy, 1e-11 * energy),
        # null where another pulse is as near
        "wave_energy": Either((*(About(value * energy, 1e-11 * energy) for value in inside), None)),
    }


def period(case: Case) -> int:
    """Beads after which masses and contacts repeat, but for one in ten; 1 where they do not."""
    own = case.nature
    rows = np.concatenate([own.mass[:, :-1], own.strength, own.load])
    size = np.maximum(np.abs(rows).max(axis=1, keepdims=True), 1e-300)
    for many in range(1, min(12, case.scene.beads // 3) + 1):
        if np.mean(np.all(np.abs(rows[:, many:] - rows[:, :-many]) <= 1e-9 * size, axis=0)) > 0.9:
            return many
    return 1


def reach(case: Case) -> int:
    """Beads on either side of a peak that hold a pulse's energy: three, and more in cells of long dispersion."""
    if "reach" in case.kept:
        return int(case.kept["reach"])
    cell, longest = period(case), 1.0
    if cell > 1:
        for mass, strength in zip(case.nature.mass[:, :-1], case.nature.strength, strict=True):
            whole = len(strength) // cell * cell
            typical = [np.median(values[:whole].reshape(-1, cell), axis=0) for values in (mass, strength)]
            longest = max(longest, math.sqrt(12.0 * dispersion(*typical)))
    case.kept["reach"] = math.ceil(3.0 * longest - 1e-6)
    return int(case.kept["reach"])


def dispersion(mass: Any, stiffness: Any) -> float:
    """beta of ``omega**2 = c**2 q**2 (1 - beta q**2)`` for long waves in a chain of such cells."""
    cell, squares = len(mass), []
    wavenumbers = np.array([0.1, 0.2]) / cell
    for q in wavenumbers:
        matrix = np.zeros((cell, cell), dtype=complex)
        for bead in range(cell):
            after = (bead + 1) % cell
            matrix[bead, bead] += stiffness[bead]
            matrix[after, after] += stiffness[bead]
            matrix[bead, after] -= stiffness[bead] * np.exp(1j * q)
            matrix[after, bead] -= stiffness[bead] * np.exp(-1j * q)
        squares.append(float(np.min(np.linalg.eigvals(matrix / mass[:, np.newaxis]).real)) / q**2)
    one, other = wavenumbers**2
    fall = (squares[0] - squares[1]) / (other - one)
    return fall / (squares[0] + fall * one)


def near_energy(case: Case, chain: int, bead: int, time: float) -> float:
    """Energy of the beads within reach of one (from 1), and of their contacts, at the frame nearest to a time."""
    frame, far = round(time / case.every), reach(case)
    low, high = max(bead - 1 - far, 0), min(bead + far, case.scene.beads)
    x, v, own = np.nan_to_num(case.frames.x[frame]), np.nan_to_num(case.frames.v[frame]), case.nature
    return float(own.kinetic(v)[chain - 1, low:high].sum() + own.in_contacts(x)[chain - 1, low : high - 1].sum())


# --- keys of analysis.json --------------------------------------------------------------------------------------------


def expected(case: Case) -> dict[str, Any]:
    """Of the leading waves and all pulses."""
    rows = case.directory.table("waves.csv")
    return {
        "arrival": "impulse" if case.nature.gap > 0.0 else "maximum",
        "waves": [summary(case, rows, chain) for chain in range(1, case.scene.chains + 1)],
        "pulses": Given(lambda found: [pulse(case, rows, entry) for entry in found]),
    }


def summary(case: Case, rows: list[Row], chain: int) -> dict[str, Any]:
    """The last bead that the wave of a chain passed clear of the end that it runs to, or its first."""
    own = [row for row in rows if row["chain"] == chain]
    if not own:
        names = ("bead", "arrival", "peak_velocity", "speed", "peak_velocity_reduced", "arrival_reduced")
        nothing = dict.fromkeys((*names, "peak_velocity_error", "arrival_error"))
        return {"chain": chain, "beads_reached": 0, **nothing}
    along = own[:: case.way]
    far = case.scene.beads - CLEAR
    clear = [row for row in along if (row["bead"] if case.way > 0 else case.scene.beads + 1 - row["bead"]) <= far]
    last = clear[-1] if clear else along[0]
    unit = case.unit
    return {
        "chain": chain,
        "beads_reached": len(own),
        "bead": int(last["bead"]),
        "arrival": About(last["arrival"]),
        "peak_velocity": About(last["peak_velocity"]),
        "speed": About(last["speed"]),
        "peak_velocity_reduced": About(last["peak_velocity"] / unit.velocity),
        "arrival_reduced": About(None if last["arrival"] is None else last["arrival"] / unit.time),
        "peak_velocity_error": About(last["peak_velocity_error"]),
        "arrival_error": About(last["arrival_error"]),
    }


def pulse(case: Case, rows: list[Row], entry: Row) -> dict[str, Any]:
    """See `workflow.verdicts.analysis_report.pulse_entry`."""
    unit, stated = case.unit, case.stated
    chain, bead, way = entry["chain"], entry["bead"], entry["direction"]
    arrival, peak = entry["arrival"] / unit.time, entry["peak_velocity"] / unit.velocity
    exact = exact_of(case)
    end = 3.0 if bead in (1, case.scene.beads) else 1.0
    allowed = max(FLOOR, stated.velocity) * end + entry["peak_velocity_error"] / unit.velocity
    late = max(FLOOR, stated.arrival) * end
    late += math.inf if entry["arrival_error"] is None else entry["arrival_error"] / unit.time
    maxima = case.truth.maxima(chain, bead, way)
    mine = [
        one
        for one in maxima
        if abs(one.velocity - peak) <= allowed
        and one.since - late - one.late(case.off[1]) <= arrival <= one.until + late + one.late(case.off[1])
    ]
    if not mine:  # a bead that begins to fly reaches a level
        mine = [one for one in case.truth.levels(chain, bead) if abs(one.velocity - peak) <= allowed]
    best = min(mine, key=lambda one: abs(one.time - arrival), default=None)
    near = sorted(maxima, key=lambda one: abs(one.time - arrival))[:2]
    claim = ", ".join(f"{one.velocity * unit.velocity:.6g} at {one.time * unit.time:.6g}" for one in near)
    there = Holds(f"a true maximum (to {allowed:.1e}): {claim}", lambda _: best is not None)
    run = None if entry["speed"] is None else entry["speed"] * unit.time
    as_reference = reference_beads(case, chain, bead)
    fails = [
        name
        for name, key in (("shape", "residual"), ("speed", "speed_excess"), ("amplitude", "variation"))
        if judged(as_reference, key, entry[key]) and not (entry[key] is not None and abs(entry[key]) <= 0.01)
    ] + ["decay"] * bool(np.any(case.nature.loss[0]) or case.nature.drag)
    excess = None if run is None or not as_reference else run / float(exact.speed_at(peak)) - 1.0
    leads = any((row["chain"], row["bead"]) == (chain, entry["last"]) and way == case.way for row in rows)
    return {
        "chain": Holds("a chain", lambda value: value in range(1, case.scene.chains + 1)),
        "direction": Holds("a way", lambda value: value in (-1, 1)),
        "leading": Holds("leading only where a wave leads", lambda value: leads or not value),
        "beads": Holds("as many as there are", lambda n: 2 <= n <= 1 + abs(entry["last"] - entry["first"])),
        "first": Holds("before the last", lambda value: way * value <= way * bead),
        "last": Holds("behind the first", lambda value: way * value >= way * bead),
        "bead": Holds("one that was recorded", lambda value: value in case.directory.recorded),
        "arrival": there,
        "peak_velocity": there,
        "arrival_error": Holds("not negative", lambda value: value is None or value >= 0.0),
        "peak_velocity_error": Holds("not negative", lambda value: value >= 0.0),
        "speed": speed_of(case, entry, way, arrival),
        **inside(case, chain, bead, arrival, peak, run, way, entry),
        "residual": residual(case, chain, bead, arrival, peak, run, way) if as_reference else None,
        "speed_excess": About(excess, 1e-9),
        "variation": variation(case, entry, way, arrival, allowed),
        "solitary": fails == [],
        "fails": fails,
    }


def judged(as_reference: bool, key: str, value: float | None) -> bool:
    """Whether a quantity counts: the shape and speed of reference beads, the constancy where it is known."""
    return value is not None or not as_reference if key == "variation" else as_reference


def quickest(case: Case) -> float:
    """Time between frames, in that of the stiffest contact and the lightest bead."""
    own = case.nature
    hard = max([1.0, float(np.max(own.strength)), *(float(np.max(wall.strength)) for wall in own.walls)])
    return case.every * math.sqrt(hard / min(float(np.min(own.mass)), 1.0))


def grid(case: Case, peak: float) -> float:
    """Error of a maximum between frames, as documented for the exact wave: falls as the fifth power of their distance.

    Of shorter pulses, in stiffer contacts of lighter beads, it is larger; so it is where some beads are recorded.
    """
    quick = quickest(case)
    order = 4 if case.scene.output.beads == "all" else 2  # without accelerations
    return 4e-3 * peak * quick**order + 1e-6


def reference_beads(case: Case, chain: int, bead: int) -> bool:
    """Whether all beads within the exact wave's length are like the reference bead, and there is an exact wave."""
    if not case.pulse or case.nature.loaded:
        return False
    near = slice(max(0, bead - 5), bead + 4)
    own = case.nature
    return bool(
        np.all(own.mass[chain - 1, near] == 1.0) and np.all(np.abs(own.strength[chain - 1, near] - 1.0) < 1e-12)
    )


def walk(
    case: Case, chain: int, way: int, start: tuple[int, float, float], until: int
) -> Iterator[tuple[int, float] | None]:
    """(bead, peak) of the true maxima of a pulse, from a bead, time and peak backwards; None where it is not plain which.

    Plain is one maximum within 0.4 of the time that the exact wave takes from bead to bead of its own, and no other.
    """  # noqa: E501
    exact, there = exact_of(case), tracked(case)
    bead, time, peak = start
    for other in range(bead - way, until - way, -way):
        if not there[other - 1]:
            continue
        takes = abs(other - bead) / float(exact.speed_at(peak))
        near = [
            one
            for one in case.truth.maxima(chain, other, way)
            if abs(one.time - time + takes) < 0.7 * takes and one.velocity > 2e-3
        ]
        if len(near) != 1 or abs(near[0].time - time + takes) > 0.4 * takes or not 0.4 < near[0].velocity / peak < 2.5:
            yield None
            return
        yield other, near[0].velocity
        bead, time, peak = other, near[0].time, near[0].velocity


def passages(case: Case, entry: Row, way: int, arrival: float) -> list[tuple[int, float] | None]:
    """Those of a pulse over the ten beads up to where it was measured."""
    last = entry["first"] if abs(entry["bead"] - entry["first"]) <= 10 else entry["bead"] - 10 * way
    start = entry["bead"], arrival, entry["peak_velocity"] / case.unit.velocity
    return list(walk(case, entry["chain"], way, start, last))


def speed_of(case: Case, entry: Row, way: int, arrival: float) -> Any:
    """From the true maxima at the beads on either side: any of those that may be the pulse's."""
    unit, there = case.unit, tracked(case)
    if quickest(case) >= 0.5 and case.scene.output.beads != "all":
        return Unknown("few frames within, without accelerations")

    least = 4.0 * (max(case.stated.arrival, FLOOR) + grid(case, 1.0))
    # weak pulses are slow in contacts of high exponents; a pulse may fade to a quarter from bead to bead
    slowest = max(12.0, 3.0 / float(exact_of(case).speed_at(0.25 * entry["peak_velocity"] / unit.velocity)))

    def times(sign: int) -> list[tuple[int, float, float]]:
        """(bead, time, error of it): a flat maximum shifts by more."""
        limit = entry["last"] if sign > 0 else entry["first"]
        found = []
        for far in range(1, 1 + abs(limit - entry["bead"])):
            other = entry["bead"] + sign * way * far
            if there[other - 1]:
                found += [
                    (other, one.time, least + one.late(case.off[1]))
                    for one in case.truth.maxima(entry["chain"], other, way)
                    if 0.0 <= sign * (one.time - arrival) + 0.3 <= slowest * far
                ]
                if len({bead for bead, *_ in found}) >= 4:
                    break
        return found

    here = [(entry["bead"], arrival, 0.0)]
    ahead = here if entry["bead"] == entry["last"] else times(1)
    behind = here if entry["bead"] == entry["first"] else times(-1)
    pairs = [(abs(a - b), s - t, d + e) for a, s, d in ahead for b, t, e in behind if a != b]
    if not pairs:
        return Holds("unknown", lambda found: found is None)
    way_run, taken, off = np.array(pairs).T
    return Holds(
        "between true maxima",
        lambda found: found is None or bool(np.any(np.abs(way_run / (found * unit.time) - taken) <= off)),
    )


def variation(case: Case, entry: Row, way: int, arrival: float, allowed: float) -> Any:
    """Spread of the true maxima over the ten beads up to this one, over their mean."""
    if entry["variation"] is None:
        short = abs(entry["bead"] - entry["first"])
        return Holds(
            "known", lambda _: short <= 10 or not case.alike or len(case.directory.recorded) < case.scene.beads
        )
    peaks = [entry["peak_velocity"] / case.unit.velocity]
    mass = case.nature.mass[entry["chain"] - 1]
    found = passages(case, entry, way, arrival)
    low, high = sorted((entry["first"], entry["last"]))
    if sound(case) or None in found or entry["beads"] < tracked(case)[low - 1 : high].sum():
        return Unknown("which maxima")
    for passage in found:
        assert passage is not None
        if reference_beads(case, entry["chain"], entry["bead"]) or mass[passage[0] - 1] == mass[entry["bead"] - 1]:
            peaks.append(passage[1])
    value = float(np.ptp(peaks) / np.mean(peaks))
    return About(value, 4.0 * allowed / float(np.mean(peaks)))


def inside(
    case: Case, chain: int, bead: int, arrival: float, peak: float, speed: float | None, way: int, entry: Row
) -> dict[str, Any]:
    """Width, momentum and energy from the frames around the passage."""
    chosen = watched(case, arrival, peak, speed)
    v = None if chosen is None else case.frames.v[chosen]
    if chosen is None or v is None or np.isnan(v[:, chain - 1, bead - 1]).any() or not (speed or 0.0) > 0.0:
        return {"width": None, "momentum": None, "energy": energy(case, chain, bead, arrival, None, 1.5)}
    own, unit, step = case.nature, case.unit, (chosen[1] - chosen[0]) * case.every
    mass, exponent = own.mass[chain - 1, bead - 1], exact_of(case).exponent
    moved = way * v[:, chain - 1, bead - 1]
    small = 1e-10 * abs(speed) * step * len(chosen)
    momentum = About(float(np.sum(mass * moved)) * speed * step * unit.momentum, small * unit.momentum)
    return {
        "width": width(case, chain, bead, arrival, peak, speed, way, entry["width"]),
        "momentum": momentum if case.one_kind else None,
        "energy": energy(case, chain, bead, arrival, float(np.sum(0.5 * mass * moved**2)) * speed * step, exponent),
    }


def energy(case: Case, chain: int, bead: int, arrival: float, kinetic: float | None, exponent: float) -> Any:
    """Of the beads near the peak, null where another pulse is as near; of some beads that of the exact wave."""
    unit = case.unit.energy
    if case.scene.output.beads == "all":
        return Either((None, About(near_energy(case, chain, bead, arrival) * unit, 1e-10 * unit)))
    if kinetic is None or not case.one_kind:
        return None
    return Either((None, About(kinetic * (exponent + 3.0) / (exponent + 1.0) * unit, 1e-10 * unit)))


def claims(case: Case, tally: Tally) -> None:
    """Nothing is missing."""
    for name in ("waves.csv", *(["peaks.csv"] if case.scene.output.peaks else [])):
        missing = list(lacking(case, name))
        tally.claim(f"{name} has every bead that a pulse passed", holds=not missing, what="; ".join(missing[:4]))
