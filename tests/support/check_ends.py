"""What comes through to the far end, what a window leaves, from frames and the true motion."""

import re
from typing import Any

import numpy as np
from case import Case
from check_energy import work_input
from check_waves import quickest
from comparing import About, Given, Holds
from scenes_nature import Floats
from truth import force_of

FAINT = 1e-9
"""Force above the static one from which something has arrived."""


def expected(case: Case) -> dict[str, Any]:
    """Keys of ``analysis.json``."""
    found: dict[str, Any] = {}
    if case.directory.whole:
        found["far_end"] = far_end(case)
    if case.windowed:
        found["window"] = window(case)
    return found


def far_end(case: Case) -> dict[str, Any]:
    """See `analysis.gauges.far_end`."""
    wall = next((wall for wall in case.nature.walls if wall.side == case.way), None)
    found = {"transmitted_energy": Given(lambda value: transmitted(case, value)[0])}
    if wall is None:
        found |= {"wall_force": None, "wall_force_chain": None}
        return found | {
            "delay": Given(lambda value: transmitted(case, case.report["far_end"]["transmitted_energy"], value)[1])
        }
    bead, unit = wall.bead + 1, case.unit
    forces = [force_of(case.nature, "wall", chain, bead) for chain in range(1, case.scene.chains + 1)]

    def total(x: Floats, v: Floats) -> Floats:
        return np.asarray(sum(force(x, v) for force in forces))

    whole = top(case, total)
    each = [one for one in (top(case, force) for force in forces) if one is not None]
    off = (case.force_off + 0.3 * case.every**4) * unit.force * len(forces)
    most = None if whole is None else whole[1]
    one = max((value for _, value in each), default=None)

    def delay(value: Any) -> Any:
        if whole is None or value is None:
            return About(None if whole is None else whole[0] * unit.time)
        there = float(total(*case.truth.states(np.array([value / unit.time])))[0])
        return Holds(f"about {whole[0] * unit.time:.6g}", lambda _: there >= whole[1] - 2.0 * off / unit.force)

    return found | {
        "wall_force": About(None if most is None else most * unit.force, off),
        "wall_force_chain": About(None if one is None else one * unit.force, off),
        "delay": Given(delay),
    }


def top(case: Case, force: Any) -> tuple[float, float] | None:
    """Time and size of a force's largest value; None where it has not risen, or is largest at an end of the record."""
    at_frames = force(case.frames.x, case.frames.v)
    rest = float(force(np.zeros_like(case.nature.mass), np.zeros_like(case.nature.mass)))
    k = int(np.argmax(at_frames))
    if not 0 < k < len(at_frames) - 1 or at_frames[k] - rest <= FAINT * max(1.0, rest):
        return None
    near = case.truth.times
    low, high = np.searchsorted(near, (case.frames.time[k - 1], case.frames.time[k + 1]))
    x, v = (part[low : high + 1] for part in case.truth.fine)
    values = force(x, v)
    best = int(np.argmax(values))
    return float(near[low + best]), float(values[best])


def transmitted(case: Case, value: Any, delay: Any = None) -> tuple[Any, Any]:
    """Most energy in the last tenth of the beads, over that put in, and when it has first reached half of that."""
    many = max(1, case.scene.beads // 10)
    part = slice(case.scene.beads - many, None) if case.way > 0 else slice(0, many)
    own, unit = case.nature, case.unit

    def at_end(x: Floats, v: Floats) -> Floats:
        energy = own.kinetic(v)[..., part].sum(axis=(-2, -1)) + own.in_ground(x)[..., part].sum(axis=(-2, -1))
        energy = energy + own.in_contacts(x)[..., part.start : None if case.way > 0 else many - 1].sum(axis=(-2, -1))
        walls = [wall for wall in own.walls if wall.bead in range(case.scene.beads)[part]]
        return np.asarray(energy + sum(own.in_wall(wall, x).sum(axis=-1) for wall in walls))

    if any(one.bead in range(case.scene.beads)[part] for one in (*own.pushes, *own.moved)):
        return None, None  # energy is input there
    series = at_end(case.frames.x, case.frames.v)
    energy_input = work_input(case, case.frames.time)
    share, most = (
        np.divide(series, energy_input, out=0.0 * energy_input, where=energy_input > 1e-9),
        float(series.max()),
    )
    if value is None:
        return Holds("known", lambda _: unsettled(share)), Holds(
            "known", lambda found: found is None or unsettled(share)
        )
    top = int(np.argmax(share))
    near = case.truth.times[
        slice(*np.searchsorted(case.truth.times, case.frames.time[[top - 1, min(top + 1, len(share) - 1)]]))
    ]
    exact = float(np.max(at_end(*case.truth.states(near)) / work_input(case, near), initial=share.max()))
    # of a quintic through energies and rates; of a quartic through the work, which pulses of a driven bead bend
    coarse = 0.03 * quickest(case) ** 4 + case.energy_off
    bend = 0.003 * float(np.abs(np.diff(share[top - 1 : top + 2], 2)).max(initial=0.0)) if case.acted_on else 0.0
    off = coarse * float(share.max()) + 3.0 * case.energy_off / float(energy_input[np.argmax(share)]) + 1e-9
    if delay is None and unsettled(series):
        return About(exact, off + bend), About(None)
    true = at_end(*case.truth.fine)
    half = int(np.argmax(true >= 0.5 * true.max()))
    ends, step = true[half - 1 : half + 1], case.truth.times[1]
    when = case.truth.times[half - 1] + step * (0.5 * true.max() - ends[0]) / (ends[1] - ends[0])
    late = (coarse * most + 1e-9) / float(ends[1] - ends[0]) * step + step**2
    return About(exact, off + bend), About(float(when) * unit.time, min(late, case.every) * unit.time)


def unsettled(series: Floats) -> bool:
    """Whether nothing has arrived, it was there from the start, or it may still be rising at the end."""
    most = float(series.max())
    last = int(np.argmax(series)) >= len(series) - 1 or series[-1] > (1.0 - 1e-3) * most
    return bool(most < 1e-14 or series[0] >= 0.5 * most or last)


def window(case: Case) -> dict[str, Any]:
    """See `workflow.verdicts.findings.pulses`."""
    rows, frames = case.scene.window, case.frames
    tails = [int(np.flatnonzero(np.isfinite(v[0]))[0]) for v in frames.v]
    worst, bead = 0.0, 0
    for k in range(1, len(tails)):
        left = frames.v[k - 1][:, tails[k - 1] : tails[k]]
        if left.size and left.max() > worst:
            worst, bead = float(left.max()), tails[k - 1] + int(left.max(axis=0).argmax()) + 1
    waves = case.directory.table("waves.csv")
    high = [row["peak_velocity"] / case.unit.velocity for row in waves if row["bead"] > rows // 2]
    slowest = min(high, default=None)

    def fits(text: str) -> bool:
        if bead == 0:
            return text == "window: no residual motion behind it"
        numbers = [float(one) for one in re.findall(r"\d[\d.e+-]*", text)]
        near = all(abs(a / b - 1.0) < 0.051 for a, b in zip(numbers, (worst, slowest), strict=True))
        return near and ("nothing catches up" in text) == (worst < slowest)

    return {
        "rows": rows,
        "residual_velocity": About(worst, 1e-12),
        "bead": bead,
        "slowest_wave": About(slowest),
        "sentence": Holds("what the numbers say", fits),
    }
