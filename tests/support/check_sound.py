"""Sound under a static load and its dispersion, from the matrices of small motions."""

import math
from typing import Any

import numpy as np
from case import Case
from comparing import About, Either, Given, Holds, Unknown, column
from scene_keys import hardest
from scenes_nature import Floats, Nature

LONGEST = 12
"""Beads of the longest cell that is looked for."""


def expected(case: Case) -> dict[str, Any]:
    """Keys of ``analysis.json``."""
    if not case.nature.loaded:
        return {}
    return {"sound": sound(case), "dispersion": dispersion(case)}


def tables(case: Case) -> dict[str, Any]:
    """Columns of the CSV tables."""
    if not case.nature.loaded or why_none(case) is not None:
        return {}
    return {"dispersion.csv": Given(lambda found: dispersion_table(case, found))}


def stiffness(own: Nature) -> Floats:
    """Of contacts at rest, [chain, contact]."""
    return np.asarray(own.exponent * own.strength * own.rest ** (own.exponent - 1.0))


def across(own: Nature) -> Floats:
    """Stiffness of springs within rows and to the ground, [bead, chain, chain]."""
    chains, beads = own.mass.shape
    found = np.zeros((beads, chains, chains))
    for one, other, k, _ in own.springs:
        for here, there in ((one, other), (other, one)):
            found[:, here, here] += k
            found[:, here, there] -= k
    found[:, range(chains), range(chains)] += own.ground[0].T
    return found


def period(own: Nature) -> int | None:
    """Beads after which all repeats, the outermost beads aside."""
    chains, beads = own.mass.shape
    along = np.concatenate([stiffness(own), np.zeros((chains, 1))], axis=1)
    rows = np.concatenate([own.mass, along, across(own).reshape(beads, -1).T])[:, 1:-1]
    return _repeats(rows)


def _repeats(rows: Floats) -> int | None:
    size = np.maximum(np.abs(rows).max(axis=1, keepdims=True, initial=0.0), 1e-300)
    longest = min(LONGEST, rows.shape[1] // 3)
    fits = (p for p in range(1, longest + 1) if np.all(np.abs(rows[:, p:] - rows[:, :-p]) <= 1e-8 * size))
    return next(fits, None)


def branches(own: Nature, cell: int, wavenumber: Floats) -> Floats:
    """Angular frequencies [wavenumber, branch], by Bloch's theorem."""
    chains = own.mass.shape[0]
    k, rows = stiffness(own)[:, 1 : cell + 1], across(own)[1 : cell + 1]
    mass = own.mass[:, 1 : cell + 1].T.ravel()  # bead by bead, its chains together
    found = []
    for q in np.asarray(wavenumber).tolist():
        matrix = np.zeros((cell * chains, cell * chains), dtype=complex)
        for bead in range(cell):
            here = np.arange(chains) + bead * chains
            there = np.arange(chains) + (bead + 1) % cell * chains
            turn = np.exp(1j * q)
            np.add.at(matrix, (here, here), k[:, bead])
            np.add.at(matrix, (there, there), k[:, bead])
            np.add.at(matrix, (here, there), -k[:, bead] * turn)
            np.add.at(matrix, (there, here), -k[:, bead] / turn)
            matrix[np.ix_(here, here)] += rows[bead]
        values = np.linalg.eigvals(matrix / mass[:, np.newaxis])
        found.append(np.sqrt(np.maximum(np.sort(values.real), 0.0)))
    return np.array(found)


def bands_of(case: Case) -> Floats | None:
    """Lowest and highest of each branch, [branch, 2]; None where there is none."""
    own = case.nature
    cell = period(own) if own.loaded else None
    if cell is None or cell * case.scene.chains > 60:
        return None
    found = branches(own, cell, np.linspace(0.0, math.pi / cell, 201))
    return np.stack([found.min(axis=0), found.max(axis=0)], axis=1)


def cell_beads(own: Nature) -> int:
    """After how many beads masses and contacts repeat, whatever load they bear; 1 where they do not."""
    if np.all(own.mass == 1.0) and np.ptp(own.strength) == 0.0:
        return 1
    return _repeats(np.concatenate([own.mass[:, 1:-1], own.strength[:, 1:]])) or 1


def local(own: Nature, values: Floats) -> Floats:
    """Means over two beads (or whole cells) on either side, the outermost with half their weight."""
    cell = cell_beads(own)
    near = min(cell * -(-2 // cell), (values.shape[1] - 1) // 2)
    if near == 0:
        return values
    weight = np.r_[0.5, np.ones(2 * near - 1), 0.5] / (2.0 * near)
    inner = np.stack([np.convolve(row, weight, "valid") for row in values])
    return np.pad(inner, ((0, 0), (near, near)), mode="edge")


def speed(own: Nature) -> Floats:
    """Of long waves at every bead, [chain, bead] in beads / T."""
    with np.errstate(divide="ignore"):
        soft = np.pad(local(own, 1.0 / stiffness(own)), ((0, 0), (1, 1)), mode="edge")
    return np.asarray(1.0 / np.sqrt(local(own, own.mass) * 0.5 * (soft[:, 1:] + soft[:, :-1])))


def sound(case: Case) -> dict[str, Any]:
    """See `workflow.verdicts.findings.sound`."""
    own, unit, ball = case.nature, case.unit, case.scene.material
    ends, bands = (np.min, np.max), bands_of(case)
    held = bool(np.any(own.ground))
    speeds = None if held else [float(find(speed(own))) / unit.time for find in ends]
    one = np.all(own.mass == 1.0) and np.ptp(own.strength) == 0.0 and np.ptp(own.rest) < 1e-9
    metres = None
    if ball is not None and one and speeds is not None:
        length = 2.0 * ball.radius - float(own.rest[0, 0]) * unit.length
        metres = column([value * length for value in speeds], 1e-7 * max(speeds) * length)
    return {
        "load": column(
            [float(find(own.load)) * unit.force for find in ends], 1e-4 * float(own.load.max()) * unit.force
        ),
        "overlap": column([float(find(own.rest)) * unit.length for find in ends], 1e-7 * own.rest.max() * unit.length),
        "speed": None if speeds is None else column(speeds, 1e-6 * max(speeds)),
        "metres": metres,
        "cutoff": cutoff(case, bands),
        "crest": Holds("a velocity", lambda found: found is None or 0.0 < found <= 1.5 * unit.velocity * largest(case)),
        "pulse": Given(lambda found: pulse(case, found)),
    }


def largest(case: Case) -> float:
    return float(np.max(np.abs(case.truth.fine[1])))


def cutoff(case: Case, bands: Floats | None) -> Any:
    unit = case.unit
    if bands is not None:
        return About(float(bands.max()) / unit.time, 1e-6 * float(bands.max()) / unit.time)
    highest = math.sqrt(float(np.max(np.linalg.eigvals(whole(case.nature)).real)))
    return Holds(f"at least {highest / unit.time:.8g}", lambda found: found * unit.time >= highest * (1.0 - 1e-9))


def whole(own: Nature) -> Floats:
    """Stiffness over mass of the whole array about rest, with its walls."""
    chains, beads = own.mass.shape
    matrix, place = np.zeros((chains * beads, chains * beads)), np.arange(chains * beads).reshape(chains, beads)
    k = stiffness(own)
    for here, there in ((place[:, :-1], place[:, 1:]), (place[:, 1:], place[:, :-1])):
        matrix[here, here] += k
        matrix[here, there] -= k
    for bead, row in enumerate(across(own)):
        matrix[np.ix_(place[:, bead], place[:, bead])] += row
    for wall in own.walls:
        end = place[:, wall.bead]
        matrix[end, end] += own.exponent * wall.strength * wall.rest ** (own.exponent - 1.0)
    return np.asarray(matrix / own.mass.reshape(-1, 1))


def theory(ratio: float, p: float) -> float:
    """Nesterenko's speed over that of sound."""
    root = ratio ** (1.0 / p)
    return math.sqrt(2.0 / (p * (p + 1.0)) * (p + ratio * root - (p + 1.0) * root)) / (root - 1.0)


def pulse(case: Case, found: Any) -> Any:
    """The leading pulse between the contacts that it names: first maxima of true overlaps."""
    if found is None:
        return None if not case.pulse or not case.directory.whole else Unknown("how far it came")
    own, unit, truth = case.nature, case.unit, case.truth
    chain, first, last = found["chain"], found["first"], found["last"]
    x, v = truth.fine
    arrivals, ratios = {}, []
    for contact in range(min(first, last), max(first, last) + 1):
        strain = x[:, chain - 1, contact - 1] - x[:, chain - 1, contact]
        rate = v[:, chain - 1, contact - 1] - v[:, chain - 1, contact]
        fallen = np.flatnonzero((rate[:-1] > 0.0) & (rate[1:] <= 0.0) & (strain[1:] > 1e-3))
        if len(fallen) == 0:
            return Unknown("a maximum is not seen")
        k = fallen[0]
        share = rate[k] / (rate[k] - rate[k + 1])
        arrivals[contact] = truth.times[k] + share * truth.times[1]
        top = own.rest[chain - 1, contact - 1] + max(strain[k], strain[k + 1])
        total = own.strength[chain - 1, contact - 1] * top**own.exponent
        ratios.append(total / own.load[chain - 1, contact - 1])
    taken = abs(arrivals[last] - arrivals[first])
    runs = abs(last - first) / taken
    c0 = float(np.mean(speed(own)[chain - 1, min(first, last) - 1 : max(first, last)]))
    ratio = float(np.mean(ratios))
    one = np.all(own.mass == 1.0) and np.ptp(own.strength) == 0.0
    wave = theory(ratio, own.exponent) if one else None
    late = 2.0 * (case.off[1] / 0.05 + 1e-4) / taken
    off = case.force_off / float(own.load[chain - 1, min(first, last) - 1 : max(first, last)].min()) + 1e-4 * ratio
    return {
        "chain": hardest(case.scene)[0],
        "first": first,
        "last": last,
        "force_ratio": About(ratio, off),
        "speed": About(runs / unit.time, late * runs / unit.time),
        "sound": About(c0 / unit.time, 1e-6 * c0 / unit.time),
        "theory": About(wave, 0.0 if wave is None else off),
        "over_sound": About(runs / c0, late * runs / c0),
        "over_theory": About(None if wave is None else runs / c0 / wave, (late + off) * runs / c0),
    }


# --- dispersion -------------------------------------------------------------------------------------------------------


def why_none(case: Case) -> str | None:
    """A word of why there is no map."""
    bands = bands_of(case)
    if bands is None:
        return "repeat" if period(case.nature) is None else "branches"
    if not case.directory.whole:
        return "all beads"
    if case.every * float(bands.max()) > math.pi:
        return "farther apart"
    return "few" if len(range(0, len(case.frames), stride(case))) < 16 else None


def stride(case: Case) -> int:
    bands = bands_of(case)
    assert bands is not None
    return max(1, int(0.7 * math.pi / (case.every * float(bands.max()))))


def dispersion(case: Case) -> Any:
    """See `workflow.verdicts.findings.sound`."""
    why = why_none(case)
    if why is not None:
        none = dict.fromkeys(("beads", "bands", "measured", "bin"))
        return none | {"why": Holds(f"names {why}", lambda found: found is not None and why in found)}
    bands, unit, cell = bands_of(case), case.unit, period(case.nature)
    assert bands is not None
    _, frequency, _ = power(case)

    def measured(_: Any) -> Any:
        rows = case.directory.table("dispersion.csv")
        seen = [[row["measured"] for row in rows if row["branch"] == k + 1] for k in range(len(bands))]
        return [
            [About(end([one for one in branch if one is not None], default=None)) for end in (min, max)]
            for branch in seen
        ]

    return {
        "why": None,
        "beads": cell,
        "bands": [column(band / unit.time, 1e-6 * float(bands.max()) / unit.time) for band in bands],
        "measured": Given(measured),
        "bin": About(float(frequency[1]) / unit.time),
    }


def power(case: Case) -> tuple[Floats, Floats, Floats]:
    """Wavenumbers from 0 to the zone's edge, frequencies, and power over both, [wavenumber, frequency]."""
    chain, (beads, cell) = hardest(case.scene)[0] - 1, (case.scene.beads, period(case.nature))
    assert cell is not None
    signal = case.frames.v[:: stride(case), chain]
    count = len(signal)
    for axis, size in enumerate(signal.shape):
        weight = np.sin(np.pi * np.arange(1, size + 1) / (size + 1)) ** 2
        signal = signal * (weight[:, np.newaxis] if axis == 0 else weight)
    transform = np.abs(np.fft.fft2(signal)[: count // 2 + 1]) ** 2
    step, zone = 2.0 * math.pi / beads, 2.0 * math.pi / cell
    q = np.fft.fftfreq(beads) * 2.0 * math.pi
    place = np.rint(np.abs(q - zone * np.rint(q / zone)) / step).astype(int)
    found = np.zeros((place.max() + 1, count // 2 + 1))
    for k in range(beads):
        found[place[k]] += transform[:, k]
    frequency = 2.0 * math.pi * np.arange(count // 2 + 1) / (count * case.every * stride(case))
    return np.minimum(np.arange(place.max() + 1) * step, 0.5 * zone), frequency, found / transform.max()


def dispersion_table(case: Case, _: Any) -> Any:
    wavenumber, frequency, strength = power(case)
    cell, unit = period(case.nature), case.unit
    assert cell is not None
    exact, rows = branches(case.nature, cell, wavenumber), []
    for q, value in enumerate(wavenumber):
        ends = np.r_[0.0, 0.5 * (exact[q, 1:] + exact[q, :-1]), frequency[-1]]
        for branch, omega in enumerate(exact[q]):
            inside = np.flatnonzero((frequency > ends[branch]) & (frequency <= ends[branch + 1]))
            seen = ridge(frequency, strength[q], inside)
            within = 1e-5 * frequency[1] / unit.time
            about = Either((About(None if seen is None else seen / unit.time, within), *edge(strength[q], inside)))
            rows.append(
                {
                    "wavenumber": About(float(value), 1e-12),
                    "branch": branch + 1,
                    "frequency": About(float(omega) / unit.time, 1e-6 * float(exact.max()) / unit.time),
                    "measured": about,
                }
            )
    return rows


def edge(strength: Floats, inside: Any) -> tuple[Any, ...]:
    """Where rounding decides whether there is a ridge: of power at the limit, or at the border of what is looked at."""
    if len(inside) == 0:
        return ()
    top = float(strength[inside].max())
    near = np.count_nonzero(strength[inside] > top * (1.0 - 1e-9)) > 1 or abs(top / 1e-9 - 1.0) < 1e-3
    return (Holds("decided by rounding", lambda _: True),) if near else ()


def ridge(frequency: Floats, strength: Floats, inside: Any) -> float | None:
    """Where the power is largest, by a parabola through its logarithm; None at the border of what is looked at."""
    if len(inside) == 0:
        return None
    top = int(inside[np.argmax(strength[inside])])
    if not 0 < top < len(frequency) - 1 or strength[top] < max(1e-9, strength[top - 1], strength[top + 1]):
        return None
    a, b, c = np.log(np.maximum(strength[top - 1 : top + 2], 1e-300))
    return float(frequency[top] + 0.5 * (a - c) / min(a - 2.0 * b + c, -1e-300) * frequency[1])
