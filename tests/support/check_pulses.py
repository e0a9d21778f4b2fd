"""Trains and reflections: pulses of the kicked chain one behind the other, and what walls reflect of them."""

import itertools
import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from case import FLOOR, Case
from check_waves import grid, sound, walk
from comparing import About, Given, Holds, Unknown, column
from scene_keys import hardest

STEADY = 0.01


def expected(case: Case) -> dict[str, Any]:
    """Key of ``analysis.json``."""
    return {"train": Given(lambda found: train(case, found))}


def train(case: Case, found: Any) -> Any:
    """See `workflow.verdicts.analysis_report.train`; each a true maximum, steady over the ten beads before."""
    if found is None:
        return None
    unit, chain, bead, way = case.unit, hardest(case.scene)[0], found["bead"], case.way
    peaks = [peak / unit.velocity for peak in found["peak_velocity"]]
    times = [time / unit.time for time in found["arrival"]]

    def there(time: float, peak: float) -> Holds:
        near = sorted(case.truth.maxima(chain, bead, way), key=lambda one: abs(one.time - time))[:2]
        allowed = max(FLOOR, case.stated.velocity) + grid(case, peak)
        good = any(abs(one.velocity - peak) <= allowed and one.since - 0.05 <= time <= one.until + 0.05 for one in near)
        return Holds(f"one of {', '.join(f'{one.velocity:.6g} at {one.time:.6g}' for one in near)}", lambda _: good)

    true = [there(*one) for one in zip(times, peaks, strict=True)]
    return {
        "chain": chain,
        "bead": Holds("clear of the ends", lambda value: case.scene.beads < 11 or 5 < value <= case.scene.beads - 5),
        "pulses": len(peaks),
        "arrival": true,
        "peak_velocity": true,
        **(
            {}
            if "uncertainty" not in found
            else {
                "uncertainty": [
                    steady(case, chain, bead, *one) for one in zip(times, peaks, found["uncertainty"], strict=True)
                ]
            }
        ),
        "ratio": column([peak / peaks[0] for peak in peaks]),
        "spacing": column([(b - a) * unit.time for a, b in itertools.pairwise(times)], 1e-12 * unit.time),
    }


def steady(case: Case, chain: int, bead: int, time: float, peak: float, told: float | None) -> Any:
    """Largest difference of the true maxima over the ten beads before; at most a hundredth."""
    if told is None:
        return Holds("known", lambda _: len(case.directory.recorded) < case.scene.beads)
    unit, way = case.unit.velocity, case.way
    until = min(max(bead - 10 * way, 1), case.scene.beads)
    before = list(walk(case, chain, way, (bead, time, peak), until))
    if None in before or sound(case):
        return Holds("at most a hundredth", lambda value: value <= STEADY * peak * unit * (1.0 + 1e-9))
    most = max((abs(one[1] - peak) for one in before if one is not None), default=math.nan)
    return About(most * unit, 3.0 * (max(FLOOR, case.stated.velocity) + grid(case, peak)) * unit)


# --- walls ------------------------------------------------------------------------------------------------------------


def reflected(case: Case, chain: int, bead: int, found: Any) -> Any:
    """See `analysis.gauges.reflection`: lines through the logarithm of true maxima at the beads that it names."""
    plain = case.alike and case.pulse and not case.nature.loaded
    if found is None or not plain:
        return None
    towards = -1 if bead == 1 else 1
    values = [
        list(_at_wall(case, chain, way, found[name], bead))
        for way, name in ((towards, "incident_beads"), (-towards, "reflected_beads"))
    ]
    ratios = np.array([math.exp(back - there) for t, there in values[0] for s, back in values[1] if s > t])
    if len(ratios) == 0:
        return Unknown("which maxima") if not any(values) else {}
    within = 20.0 * (max(FLOOR, case.stated.velocity) + grid(case, 1.0)) / 0.2 + found["uncertainty"] * 1e-6
    beads = range(1, case.scene.beads + 1)
    inside = Holds("a bead", lambda value: value in beads)
    return {
        "ratio": Holds(
            f"one of {', '.join(f'{one:.6g}' for one in ratios)} (to {within:.1e})",
            lambda value: (
                bool(np.any(np.abs(ratios - value) <= within))
                and (case.nature.lossy or bool(case.nature.springs) or value <= 1.0 + found["uncertainty"] + within)
            ),
        ),
        "uncertainty": Holds("at most 0.05", lambda value: 0.0 < value <= 0.05),
        "incident_beads": [inside, inside],
        "reflected_beads": [inside, inside],
    }


def _at_wall(case: Case, chain: int, way: int, beads: list[int], wall: int) -> Iterator[tuple[float, float]]:
    """Times at the last of some beads, and logarithms of peaks extrapolated to the wall, of true pulses past them."""
    for one in case.truth.maxima(chain, beads[1], way):
        if one.velocity < 0.02:
            continue
        before = list(walk(case, chain, way, (beads[1], one.time, one.velocity), beads[0]))
        if None in before or len(before) < 2:
            continue
        passed = [(beads[1], one.velocity), *(item for item in before if item is not None)]
        distance, peak = np.abs(np.array([bead for bead, _ in passed]) - wall), np.array([v for _, v in passed])
        yield one.time, float(np.polynomial.Polynomial.fit(distance, np.log(peak), 1)(0.0))
