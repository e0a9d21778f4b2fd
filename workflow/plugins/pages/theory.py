"""Lines of theory on the maps and on the plot of peaks, of scenes to which the theory applies."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
from bokeh.models import CheckboxGroup, CustomJS

from granchain.parts import Fact, Floats, Integers, Problem, Survey, physics
from workflow.plugins.pages.downsample import Thinned
from workflow.plugins.pages.units import Units

_COLOURS = ("#2fc774", "#d85cf0", "#ff9f1c")
"""Green, purple and orange, which on a black rim are seen on all colours of the maps."""

_DASH = [6, 9]
"""Pixels of dashes and of the gaps between them, in which the wave is seen that the line lies on."""


@dataclass(frozen=True)
class TheoryLine:
    """A line of theory on the maps.

    Attributes:
        name: in the legend.
        of_chains: chain -> beads and times of the points of its line, in units of T.
    """

    name: str
    of_chains: Mapping[int, tuple[Floats, Floats]]


Number = TypeVar("Number", int, Integers)


def along(survey: Survey, bead: Number) -> Number:
    """Number of a bead counted along the way of the leading pulse, or in the scene of one that is counted so."""
    return bead if survey.direction > 0 else survey.problem.beads + 1 - bead


def lines_of(
    problem: Problem, chains: Sequence[int], survey: Survey, measurements: Mapping[str, Any]
) -> list[TheoryLine]:
    """Exact solitary wave of the asymptotic amplitude; under a static load sound, and the theory's solitary wave.

    Args:
        problem: what was run.
        chains: that are shown.
        survey: the waves of the run.
        measurements: what else was measured, by its key.
    """
    if not problem.system.holds(Fact.PULSE):
        return []
    final = survey.shared.followed.final
    lines, per_time = [], problem.scale.each("beads")
    speed = survey.exact_speed
    if final is not None and speed is not None:
        name = f"exact solitary wave of {final.value:.5f} V: {speed / problem.scale.time:.6g}{per_time}"
        lines.append(TheoryLine(name, _through_waves(problem, chains, survey, speed)))
    sound = measurements.get("sound")
    if sound is not None and sound.values.speed is not None:
        speeds = dict.fromkeys(f"{speed / problem.scale.time:.6g}" for speed in sound.values.speed)
        points = _sound(problem, chains, survey, sound.local_speed)
        lines.append(TheoryLine(f"sound: c0 = {' to '.join(speeds)}{per_time}", points))
        pulse = sound.values.pulse
        if pulse is not None and math.isfinite(pulse.theory) and len(speeds) == 1:
            name = f"solitary wave of the long-wave theory: {pulse.theory:.5f} c0"
            points = _through_waves(problem, [pulse.chain], survey, pulse.theory * pulse.sound)
            lines.append(TheoryLine(name, {chain: line for chain, line in points.items() if chain in chains}))
    return [line for line in lines if line.of_chains]


def _through_waves(
    problem: Problem, chains: Sequence[int], survey: Survey, speed: float
) -> dict[int, tuple[Floats, Floats]]:
    """Chain -> points of a wave of a constant speed, in beads / T, through the arrival at the last clear bead."""
    lines = {}
    for chain in chains:
        waves = survey.waves.of_chain(chain)
        if len(waves) == 0:
            continue
        last = survey.last_clear_bead(waves)
        distance = along(survey, np.array([1, problem.beads]))
        time = waves.arrival[last] + (distance - along(survey, int(waves.bead[last]))) / speed
        if not np.isfinite(time).all():
            continue
        beads = np.array([1.0, problem.beads])
        if time[np.argmin(distance)] < 0.0:  # the wave is exact only later; its line begins where it meets the start
            early, late = np.argmin(time), np.argmax(time)
            beads[early] = np.interp(0.0, time[[early, late]], beads[[early, late]])
            time = np.maximum(time, 0.0)
        lines[chain] = (beads, time)
    return lines


def _sound(problem: Problem, chains: Sequence[int], survey: Survey, speed: Floats) -> dict[int, tuple[Floats, Floats]]:
    """Chain -> points of sound that leaves the kicked bead at the start, along the way of the pulse.

    Args:
        problem: what was run.
        chains: that are shown.
        survey: the waves of the run.
        speed: of sound, [chain, bead] in beads / T.
    """
    kicked = along(survey, physics.largest_excitation(problem.system)[1])
    distance = np.arange(kicked, problem.beads + 1)
    beads = along(survey, distance)
    slowness = 1.0 / speed[:, beads - 1]
    time = np.cumsum(np.insert(0.5 * (slowness[:, 1:] + slowness[:, :-1]), 0, 0.0, axis=1), axis=1)
    return {chain: (beads.astype(float), time[chain - 1]) for chain in chains}


def draw_lines(lines: Sequence[TheoryLine], part: Thinned, maps: Sequence[Any], units: Units) -> CheckboxGroup:
    """Draw lines on the maps; the legend, whose boxes hide them.

    Args:
        lines: to draw.
        part: of a run's frames, in units of the page.
        maps: of the chains.
        units: of the page.
    """
    drawn = []
    for line, colour in zip(lines, _COLOURS, strict=False):
        glyphs = []
        for chain, plot in zip(part.chains, maps, strict=True):
            if chain not in line.of_chains:
                continue
            beads, time = line.of_chains[chain]
            places = beads if part.even else np.interp(beads, part.beads, part.places)
            for look in ({"line_color": "#000000", "line_width": 4}, {"line_color": colour, "line_width": 2}):
                glyphs.append(plot.line(places, time * units["time"].worth, line_dash=_DASH, name="theory", **look))
        drawn.append(glyphs)
    swatches = [
        f".bk-input-group label:nth-child({k}) span::before {{ border-top-color: {colour}; }}"
        for k, colour in enumerate(_COLOURS, 1)
    ]
    legend = CheckboxGroup(
        name="theory",
        labels=[line.name for line in lines],
        active=list(range(len(lines))),
        stylesheets=[_SWATCH, *swatches],
        sizing_mode="stretch_width",
    )
    code = "drawn.forEach((lines, k) => lines.forEach(line => line.visible = legend.active.includes(k)))"
    legend.js_on_change("active", CustomJS(args={"drawn": drawn, "legend": legend}, code=code))
    return legend


_SWATCH = """
.bk-input-group span::before {
  content: ''; display: inline-block; width: 2.2em; border-top: 2px dashed; vertical-align: middle; margin: 0 .5em;
}
"""


def peaks_of(problem: Problem, survey: Survey) -> dict[str, tuple[Floats, Floats]]:
    """Asymptotic amplitude and law of decay in the plot of peak velocities: beads and velocities [point] in V, by name.

    Where chains are compared by impulses, there are none.
    """
    shared, decay = survey.shared.followed, survey.decay
    if shared.of_impulses or not problem.system.holds(Fact.PULSE):
        return {}
    lines = {}
    if shared.final is not None:
        name = "asymptotic amplitude"
        lines[name] = (np.array([1.0, problem.beads]), np.full(2, shared.final.value))
    if decay is not None:
        kicked = along(survey, physics.largest_excitation(problem.system)[1])
        distance = np.arange(decay.first, decay.last + 1)
        law = decay.v0 * np.maximum(1.0 - (distance - kicked) / decay.n_star, 0.0) ** 2.5
        lines["decay as (1 - n / n*)^2.5"] = (along(survey, distance).astype(float), law)
    return lines
