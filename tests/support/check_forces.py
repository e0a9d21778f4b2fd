"""Gauges, spectra and the hardest contact: from the true motion where they lie between frames, else from the frames."""

import math
from typing import Any

import numpy as np
from case import Case
from comparing import About, Either, Given, Holds, Unknown, column
from scenes_nature import Floats
from truth import Contact, force_of, wall_of

CLOSED = 1e-9
"""Force from which on a contact counts as closed."""


def expected(case: Case) -> dict[str, Any]:
    """Keys of ``analysis.json``."""
    found: dict[str, Any] = {}
    if case.scene.output.forces is not None:
        found["forces"] = [entry(case, *gauge, chain) for gauge in gauges(case) for chain in chains(case)]
    if case.scene.output.spectra is not None and (lines := spectra(case)) is not None:
        found["spectra"] = lines
    if case.scene.material is not None and case.nature.exponent == 1.5:
        found["contacts"] = contacts(case)
    return found


def tables(case: Case) -> dict[str, Any]:
    """Columns of the CSV tables."""
    found: dict[str, Any] = {}
    if case.scene.output.forces is not None:
        found["forces.csv"] = forces_table(case)
    if case.scene.output.spectra is not None and spectra(case) is not None:
        found["spectra.csv"] = spectra_table(case)
    return found


def chains(case: Case) -> range:
    return range(1, case.scene.chains + 1)


def gauges(case: Case) -> list[tuple[str, str, int]]:
    """(kind, name, bead) of what the scene names."""
    wanted, found = case.scene.output.forces, []
    for wall in case.nature.walls if wanted.wall else ():
        found.append(("wall", f"{'left' if wall.side < 0.0 else 'right'} wall", wall.bead + 1))
    found += [("contact", f"contact {bead}", bead) for bead in wanted.contacts or ()]
    return found + [("sensor", f"sensor {bead}", bead) for bead in wanted.sensors or ()]


def static(case: Case, kind: str, chain: int, bead: int) -> float:
    zero = np.zeros_like(case.nature.mass)
    return float(force_of(case.nature, kind, chain, bead)(zero, zero))


def forces_table(case: Case) -> list[dict[str, Any]]:
    frames, unit = case.frames, case.unit
    columns = {"time": frames.time * unit.time}
    totals = {}
    x, v = np.nan_to_num(frames.x), np.nan_to_num(frames.v)
    for kind, name, bead in gauges(case):
        for chain in chains(case):
            totals[f"{name} chain {chain}"] = (
                force_of(case.nature, kind, chain, bead)(x, v),
                static(case, kind, chain, bead),
            )
    columns |= {name: total * unit.force for name, (total, _) in totals.items()}
    if any(rest for _, rest in totals.values()):
        columns = {name if name == "time" else f"{name} total": values for name, values in columns.items()}
        columns |= {f"{name} dynamic": (total - rest) * unit.force for name, (total, rest) in totals.items()}
    within = 1e-10 * unit.force * (1.0 + max(rest for _, rest in totals.values()))
    bounds = {name: 1e-12 * unit.time if name == "time" else within for name in columns}
    return [
        {name: About(float(values[row]), bounds[name]) for name, values in columns.items()}
        for row in range(len(frames))
    ]


def entry(case: Case, kind: str, name: str, bead: int, chain: int) -> dict[str, Any]:
    """See `workflow.verdicts.findings.gauges`."""
    unit, truth = case.unit, case.truth
    force, rest = force_of(case.nature, kind, chain, bead), static(case, kind, chain, bead)
    when, most = truth.largest(force)
    off, span = case.force_off, case.directory.duration
    impulse = truth.integral(lambda x, v: force(x, v) - rest)
    loaded = any(static(case, k, c, b) for k, _, b in gauges(case) for c in chains(case))
    found = next(one for one in case.report["forces"] if (one["name"], one["chain"]) == (name, chain))
    risen = None if abs(most - rest) <= 2.0 * off + CLOSED else most > rest

    def unless_unknown(value: Any) -> Any:
        """Null where the force never exceeds that at rest; that may hang by a hair."""
        return Either((None, value)) if risen is None else value if risen else None

    answer: dict[str, Any] = {
        "kind": kind,
        "name": name,
        "chain": chain,
        "bead": bead,
        "largest": About(most * unit.force, off * unit.force),
        "at": unless_unknown(at(case, force, (when, most), found["at"])),
        "impulse": About(impulse * unit.momentum, off * span * unit.momentum),
        "last": last(case, force, rest, found),
        **intervals(case, kind, chain, bead, (when, most), found),
    }
    dynamic = unless_unknown(About((most - rest) * unit.force, off * unit.force))
    answer["static"] = About(rest * unit.force, 1e-6 * rest * unit.force) if loaded else None
    answer["dynamic"] = dynamic if loaded else None
    answer["reflected"] = None
    if kind == "wall":
        from check_pulses import reflected

        answer["reflected"] = Given(lambda told: reflected(case, chain, bead, told))
    return answer


def at(case: Case, force: Any, top: tuple[float, float], found: float | None) -> Holds:
    """Where the true force is its largest, but for the error of forces."""
    due = f"about {top[0] * case.unit.time:.6g}, where it is largest"
    if found is None:
        return Holds(due, lambda _: False)
    near = np.linspace(-1.0, 1.0, 21) * 1e-3 * case.every + found / case.unit.time
    there = float(np.max(force(*case.truth.states(np.clip(near, 0.0, case.directory.duration)))))
    return Holds(due, lambda _: there >= top[1] - 2.0 * case.force_off - 1e-6 * abs(top[1]))


def last(case: Case, force: Any, rest: float, found: dict[str, Any]) -> Any:
    """Force above that at rest in the last frame, over the largest."""
    if found["at"] is None:
        return None
    largest = found["largest"] / case.unit.force - rest
    x, v = (np.nan_to_num(part[-1:]) for part in (case.frames.x, case.frames.v))
    within = 1e-9 * (1.0 + rest) / largest
    return About(float(force(x, v)[0] - rest) / largest, within)


def overlaps(case: Case, kind: str, chain: int, bead: int) -> Any:
    """x -> the elastic force of a gauge's contacts."""
    own = case.nature
    if kind == "wall":
        wall = wall_of(own, bead)
        return lambda x: own.at_wall(wall, x)[..., chain - 1]
    if kind == "contact":
        return lambda x: own.elastic(x)[..., chain - 1, bead - 1]
    return lambda x: own.elastic(x)[..., chain - 1, bead - 2 : bead].mean(axis=-1)


def intervals(
    case: Case, kind: str, chain: int, bead: int, top: tuple[float, float], found: dict[str, Any]
) -> dict[str, Any]:
    """Number of contacts, and how long that of the largest force lasted; under a load, its excess of 1%."""
    elastic, truth, off = overlaps(case, kind, chain, bead), case.truth, case.force_off
    several = [truth.closed(elastic, level) for level in (CLOSED, off + CLOSED, 10.0 * off + CLOSED)]
    plain = len({len(one) for one in several}) == 1
    rest = static(case, kind, chain, bead)
    if rest > 0.0:
        force = force_of(case.nature, kind, chain, bead)
        high = top[1] - rest
        levels = [rest + 0.01 * high + shift for shift in (-2.0 * off, 0.0, 2.0 * off)]
        several = [truth.closed(lambda x, v: force(x, v), level, both=True) for level in levels]
    found_at = None if found["at"] is None else found["at"] / case.unit.time
    if found_at is None:
        more: dict[str, Any] = {"dwell": About(0.0), "dwell_ended": None}
    else:
        which = [_lasting(one, found_at) for one in several]
        dwell = [0.0 if one is None else one.end - one.start for one in which]
        spread = 2.0 * (max(dwell) - min(dwell)) + 1e-6 + (0.3 * case.every**3 if rest > 0.0 else 0.0)
        hair = any(one is None or abs(one.end - truth.end) < spread + case.every for one in which)
        ends = {one is not None and one.over for one in which}
        more = {
            "dwell": Unknown("lasts a frame")
            if max(dwell) < 3.0 * case.every
            else About(dwell[1] * case.unit.time, spread * case.unit.time),
            "dwell_ended": Unknown("hangs by a hair") if hair or len(ends) > 1 else ends.pop(),
        }
    return {"contacts": len(truth.closed(elastic, CLOSED)) if plain else Unknown("touches lightly"), **more}


def _lasting(found: list[Contact], when: float) -> Contact | None:
    return next((one for one in found if one.start - 0.01 <= when <= one.end + 0.01), None)


# --- spectra ----------------------------------------------------------------------------------------------------------


def lines_of(case: Case) -> tuple[Floats, Floats, Floats]:
    """Frequencies [line], amplitudes [line, chain, bead] by Hann's window, and the velocities they are of."""
    wanted, frames = case.scene.output.spectra, case.frames
    after = 0.5 * case.directory.duration if wanted.after is None else wanted.after / case.unit.time
    velocity = frames.v[frames.time >= after * (1.0 - 1e-12)][:, :, np.array(wanted.beads) - 1]
    count = len(velocity)
    weight = np.sin(np.pi * np.arange(count) / count) ** 2 * 2.0 / max(count, 1)
    signal = (velocity - velocity.mean(axis=0)) * weight[:, np.newaxis, np.newaxis] if count else velocity
    return (
        np.fft.rfftfreq(max(count, 1), case.every),
        2.0 * np.abs(np.fft.rfft(signal, axis=0)) if count else signal,
        velocity,
    )


def spectra(case: Case) -> dict[str, Any] | None:
    """See `workflow.verdicts.findings.gauges`."""
    wanted, unit = case.scene.output.spectra, case.unit
    frequency, amplitude, velocity = lines_of(case)
    count = len(velocity)
    if count < 16:
        return None
    drives = [
        (drive.displacement is None, drive.chain, drive.frequency * unit.time) for drive in case.scene.drive or ()
    ]
    at: dict[float, Floats] = {}
    for drive in sorted({frequency for *_, frequency in drives}):
        wave = np.exp(-2j * np.pi * drive * case.every * np.arange(count))
        weight = np.sin(np.pi * np.arange(count) / count) ** 2 * 2.0 / count
        found = 2.0 * np.abs(np.einsum("f,fcb->cb", wave * weight, velocity - velocity.mean(axis=0)))
        at[drive] = found if drive < 0.5 / case.every else np.full_like(found, math.nan)
    tiny = 1e-12

    def passed(values: Floats, chain: int, place: int) -> Any:
        first = float(values[chain, 0])
        if not first > tiny:
            return Holds("of next to nothing", lambda _: True)
        return About(float(values[chain, place]) / first, tiny / first)

    entries = []
    for chain in range(case.scene.chains):
        for place, bead in enumerate(wanted.beads):
            line = amplitude[:, chain, place]
            tops = tuple(About(float(f / unit.time)) for f in frequency[line >= line.max() - tiny])
            entries.append(
                {
                    "chain": chain + 1,
                    "bead": bead,
                    "frequency": Either(tops),
                    "amplitude": About(float(line.max()) * unit.velocity, tiny * unit.velocity),
                    "at_drive": [
                        {
                            "frequency": About(f / unit.time),
                            "amplitude": About(float(values[chain, place]) * unit.velocity, tiny * unit.velocity),
                            "transmissibility": passed(values, chain, place),
                        }
                        for f, values in at.items()
                    ],
                }
            )
    first = next(((chain, f) for _, chain, f in sorted(drives, key=lambda one: one[0])), None)
    from check_sound import bands_of

    bands = bands_of(case)
    return {
        "after": About((0.5 * case.directory.duration * unit.time) if wanted.after is None else wanted.after),
        "resolution": About(1.0 / (count * case.every * unit.time)),
        "transmissibility": None if first is None else passed(at[first[1]], first[0] - 1, len(wanted.beads) - 1),
        "bands": None if bands is None else [column(b / (2.0 * np.pi * unit.time), 1e-7 / unit.time) for b in bands],
        "beads": entries,
    }


def spectra_table(case: Case) -> list[dict[str, Any]]:
    frequency, amplitude, _ = lines_of(case)
    unit, wanted = case.unit, case.scene.output.spectra
    return [
        {
            "frequency": About(float(frequency[k]) / unit.time),
            **{
                f"chain {chain} bead {bead}": About(
                    float(amplitude[k, chain - 1, place]) * unit.velocity, 1e-12 * unit.velocity
                )
                for chain in chains(case)
                for place, bead in enumerate(wanted.beads)
            },
        }
        for k in range(len(frequency))
    ]


# --- the hardest contact ----------------------------------------------------------------------------------------------


def contacts(case: Case) -> dict[str, Any]:
    """See `workflow.runs.contacts.Contacts`; Hertz's pressure in the middle of a contact."""
    ball, unit, own = case.scene.material, case.unit, case.nature
    quicker = min(1.0, math.sqrt(float(np.min(own.mass)) / float(np.max(own.strength))))
    alike = bool(np.all(own.mass == 1.0) and np.ptp(own.strength) == 0.0)
    shown = case.directory.whole and case.every <= 0.25 * (1.0 if alike else quicker) * (1.0 + 1e-9)
    base: dict[str, Any] = {
        "measured": shown,
        "radius": About(ball.radius),
        "yield_strength": Given(lambda _: About(case.report["contacts"]["pressure"] / 1.6)),
    }
    states = (case.frames.x,) if shown else (case.truth.fine[0],)
    overlap = np.maximum(np.max(own.overlap(states[0]), axis=0), 0.0)
    from scene_keys import beads_of

    _, radius, modulus = beads_of(case.scene)
    size = 2.0 * radius[:, 1:] * radius[:, :-1] / (radius[:, 1:] + radius[:, :-1])
    stiff = 2.0 / (1.0 / modulus[:, 1:] + 1.0 / modulus[:, :-1])
    metres = overlap * unit.length
    plane = ball.youngs_modulus / (1.0 - ball.poisson_ratio**2)
    # two spheres: E* = plane / 2, R* = R / 2, p0 = (2 E* / pi) sqrt(overlap / R*)
    pressure = stiff * plane / math.pi * np.sqrt(2.0 * metres / (size * ball.radius))
    force = own.strength * overlap**1.5 * unit.force
    numbers = {"overlap": metres / (size * ball.radius), "force": force, "pressure": pressure}
    if shown:
        return base | {
            name: About(float(np.max(values)), 1e-9 * float(np.max(values))) for name, values in numbers.items()
        }
    return base | {
        name: Holds(
            f"at least {np.max(values):.6g}",
            lambda found, most=float(np.max(values)): found >= most * (1 - 1e-3),  # noqa: B008
        )
        for name, values in numbers.items()
    }
