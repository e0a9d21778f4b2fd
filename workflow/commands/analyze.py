"""Find the waves in a run and draw them."""

import argparse
import json
import math
from pathlib import Path

import numpy as np

from analysis.gauges.forces import Readings
from analysis.sharing.cells import CellEnergy
from analysis.sharing.energy_flow import Flow
from analysis.sharing.equipartition import CLEAR
from analysis.sharing.is_solitary import Character
from analysis.sharing.survey import Survey
from analysis.tracking.leading_waves import ARRIVALS
from lammps_inputs import InputError, Problem
from lammps_inputs.facts import Fact
from workflow.engines.lammps.invariants import ENERGY_TOLERANCE
from workflow.runs.run_directory import REPORT, RunDirectory
from workflow.screen import Answer, one_line, print_table
from workflow.verdicts.analyse import Analysis, analyse, last_clear_bead
from workflow.verdicts.analysis_report import train

MOST_CHAINS = 8
"""Chains that a table shows."""

MOST_PULSES = 6
"""Of a train, that are told."""

DOCUMENTED = 1e-4
"""Error of a peak velocity, in V, above which the user is told."""

FAR = 1.4
"""Time between frames, in T, from which on small maxima beside larger ones were seen to be missed."""


ANSWERS = "what analysis.json holds"
EXAMPLES = (
    "analyze demo",
    "analyze demo --beads 10,55,90 --no-figures",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The directory and what to draw."""
    parser.add_argument("directory", metavar="DIR", type=Path, help="a run directory, also from a cluster")
    parser.add_argument("--beads", metavar="N,N,...", help="beads whose velocity over time is drawn")
    parser.add_argument(
        "--arrival",
        choices=ARRIVALS,
        help="a wave arrives when the bead is fastest, or at the centre of the impulse that made it so; by default "
        "the latter where beads have gaps",
    )
    parser.add_argument("--no-figures", action="store_true", help="write the tables only")


def execute(arguments: argparse.Namespace) -> Answer:
    """Print a short table; write waves.csv, analysis.json and figures."""
    found = analyse(
        RunDirectory(arguments.directory),
        beads=_beads(arguments.beads),
        figures=not arguments.no_figures,
        arrival=arguments.arrival,
    )
    _print(found)
    tables = ["waves.csv", *([] if found.forces is None else ["forces.csv"]), REPORT]
    names = [*tables, *(path.name for path in found.figures)]
    print(f"{one_line(arguments.directory)}: {', '.join(names)}")
    return Answer(0, json.loads((arguments.directory / REPORT).read_text(encoding="utf-8")))


def _beads(text: str | None) -> tuple[int, ...] | None:
    if text is None:
        return None
    try:
        return tuple(int(part) for part in text.split(","))
    except ValueError:
        raise InputError(f"--beads: {text!r} given; bead numbers with commas between, such as 10,55,90") from None


def _print(found: Analysis) -> None:
    problem, waves, seen = found.problem, found.waves, found.conservation
    scale = problem.scale
    if not found.complete:
        print(
            f"incomplete: {seen.frames} of {problem.frames + 1} frames, to t = {seen.last_time * scale.time:.6g}; "
            "what there is was analysed"
        )
    if found.altered:
        print(
            "the frames are not those that the run wrote, by the fingerprint in run.json: a file is damaged or changed"
        )
    if found.energy is not None:
        _print_energy(problem, found.energy)
    shown = [bead for bead in _rows(found) if len(waves.at(bead))] if problem.holds(Fact.PULSE) else []
    unit = {name: f" ({scale.symbol(name)})" if scale.si else "" for name in ("time", "velocity", "speed")}
    head = ["bead", "chain", f"arrival{unit['time']}", f"peak velocity{unit['velocity']}", f"speed{unit['speed']}"]
    if scale.si:
        head.append("peak velocity / V")
    rows = []
    for bead in shown:
        at = waves.at(bead)
        for k in range(min(len(at), 8)):
            row = [
                str(bead) if k == 0 else "",
                str(at.chain[k]),
                f"{at.arrival[k] * scale.time:.7g}",
                f"{at.peak_velocity[k] * scale.velocity:.5g}",
                f"{at.speed[k] / scale.time:.5g}",
            ]
            rows.append([*row, f"{at.peak_velocity[k]:.5f}"] if scale.si else row)
        if len(at) > 8:
            rows.append(["", f"... {len(at)}", "", "", ""])
    if problem.holds(Fact.PULSE):
        print_table(f"{problem.name}: leading pulse", head, rows)
        _print_accuracy(found)
    _print_pulses(found.survey)
    if found.cells is not None:
        _print_cells(problem, found.cells)
    if found.forces is not None:
        _print_forces(problem, found.forces)
    if found.left is not None:
        print(found.left.sentence(waves))
    drifts = {"energy": seen.energy_drift, "momentum": seen.momentum_drift}
    known = {name: drift for name, drift in drifts.items() if np.isfinite(drift)}
    if known:
        right = "what was put in" if problem.loads else "the kick's"
        print(", ".join(f"{name} within {drift:.1e}" for name, drift in known.items()) + f" of {right}")
        if max(known.values()) > ENERGY_TOLERANCE:
            print(found.failure or "that is not this scene: was the deck run with another kappa or kick?")
    if found.contacts is not None:
        print("\n".join(found.contacts.lines()))


def _print_cells(problem: Problem, cells: CellEnergy) -> None:
    """What the pulse of each chain leaves behind, and where the energy is as seen from a replaced bead."""
    cell = "bead" if cells.period == 1 else f"cell of {cells.period} beads"
    for chain in range(1, min(problem.chains, MOST_CHAINS) + 1):
        left = cells.left(chain)
        if left is not None and math.isfinite(left.per_cell):
            print(
                f"chain {chain}: the pulse carries {left.carried:.4%} of the kick's energy at bead {left.last}; "
                f"from bead {left.first} on it has left {left.per_cell:.2e} of the kick's in every {cell}"
            )
    for split in cells.splits()[:MOST_CHAINS]:
        print(
            f"bead {split.bead} of chain {split.chain}: at the end {split.before:.2%} of the energy is before it, "
            f"{split.at:.2%} in it, {split.beyond:.2%} beyond"
        )


def _print_forces(problem: Problem, readings: Readings) -> None:
    """The largest force, impulse and dwell of every gauge."""
    scale = problem.scale
    names = ("force", "time", "momentum")
    force, time, momentum = (f" ({scale.symbol(name)})" if scale.si else "" for name in names)
    rows = []
    for place, gauge in enumerate(readings.gauges):
        for chain in range(min(problem.chains, MOST_CHAINS)):
            numbers = ["0", "-", "0", "-"]
            if readings.largest[chain, place] > 0.0:
                numbers = [
                    f"{readings.largest[chain, place] * scale.force:.6g}",
                    f"{readings.largest_at[chain, place] * scale.time:.6g}",
                    f"{readings.impulse[chain, place] * scale.momentum:.6g}",
                    f"{readings.dwell[chain, place] * scale.time:.4g}",
                ]
            rows.append([gauge.name if chain == 0 else "", str(chain + 1), *numbers])
    head = ["force at", "chain", f"largest{force}", f"at{time}", f"impulse{momentum}", f"dwell{time}"]
    print_table(f"{problem.name}: forces", head, rows)


def _print_energy(problem: Problem, flow: Flow) -> None:
    """Where the energy was: how much of it each chain had, and where along the chain, at the least, most and last."""
    time = problem.scale.time
    unit = f" ({problem.scale.symbol('time')})" if problem.scale.si else ""
    rows = []
    for chain in range(min(problem.chains, MOST_CHAINS)):
        least, most = flow.extremes(chain)
        ends = [f"{share:.4f} at {when * time:.5g}" for share, when in (least, most)]
        place = f"{flow.centre[-1, chain]:.1f} +- {flow.spread[-1, chain]:.1f}"
        rows.append([str(chain + 1), *ends, f"{flow.share[-1, chain]:.4f}", place])
    if problem.chains > MOST_CHAINS:
        rows.append([f"... {problem.chains}", "", "", "", ""])
    head = ["chain", f"least at time{unit}", f"most at time{unit}", "at the end", "there, around bead"]
    print_table(f"{problem.name}: share of the energy", head, rows)


def _print_accuracy(found: Analysis) -> None:
    """What arrivals are, if not the maxima; and how sure the table is, if less than to `DOCUMENTED`."""
    problem, waves = found.problem, found.waves
    scale = problem.scale
    if found.survey.arrival == "impulse":
        print("arrival: centre of the impulse until the bead is fastest")
    elif not np.all(np.isfinite(waves.arrival[waves.bead <= problem.beads - CLEAR])):
        print("arrivals at the maximum are not defined where beads fly freely; --arrival impulse is")
    if len(waves) and waves.velocity_error.max() > DOCUMENTED:
        worst = int(np.argmax(waves.velocity_error))
        late = waves.arrival_error[np.isfinite(waves.arrival_error)].max(initial=0.0)
        why = "the noise" if found.survey.noise else f"frames {problem.every * scale.time:.3g} apart"
        print(
            f"{why}: peak velocities are sure to {waves.velocity_error[worst]:.1e} V only (bead {waves.bead[worst]} of "
            f"chain {waves.chain[worst]}), arrivals to {late:.1e} T; each one's error is in waves.csv"
        )
    if problem.every > FAR:
        print(f"frames are more than {FAR * scale.time:.3g} apart: small pulses may be missed between them")


def _print_pulses(found: Survey) -> None:
    """The verdict, the decay law where it was fitted, what the leading waves and other pulses are."""
    print(found.verdict.sentence)
    if not found.problem.holds(Fact.PULSE):
        return
    final, decay = found.shared.final, found.decay
    if final is not None:
        # the energy of exact waves; beads with gaps, or that differ, carry none of that kind
        energy = np.sum(found.shared.wave_share[-1])
        known = np.isfinite(energy) and not found.problem.gap and found.problem.alike
        share = f"; {energy:.1%} of its energy in the leading waves" if known else ""
        uncertainty = max(final.uncertainty, 1e-6)
        below = "the kick" if found.problem.kicks else "a free bead that was pushed so"
        print(f"amplitude {final.value:.5f} +- {uncertainty:.1g} V, {1.0 - final.value:.1%} below {below}{share}")
    if decay is not None:
        print(
            f"decay as (1 - n / n*)**2.5 over beads {decay.first} to {decay.last}: n* = {decay.n_star:.1f} "
            f"+- {decay.n_star_error:.1g}, theory {decay.expected:.1f}"
        )
    _print_train(found)
    others = 0
    for pulse, character in zip(found.pulses, found.characters, strict=True):
        if not found.leads(pulse):
            others += 1
        elif pulse.chain <= 8:
            print(f"chain {pulse.chain}: {_words(character)}")
    if others:
        strongest = max(pulse.peak_velocity.max() for pulse in found.pulses if not found.leads(pulse))
        print(f"{others} other pulses, the strongest {strongest:.3f} V (analysis.json lists them)")
    if found.noise:
        print(f"the record is noisy: {found.noise:.1e} V; it was smoothed")


def _print_train(found: Survey) -> None:
    """The pulses that followed each other in the chain that was hit, if more than one did."""
    seen = train(found)
    if seen is None or len(seen) < 2:
        return
    time = found.problem.scale.time
    each = ", ".join(f"{peak:.4f}" for peak in seen.peak_velocity[:MOST_PULSES])
    apart = ", ".join(f"{spacing * time:.4g}" for spacing in seen.spacing[: MOST_PULSES - 1])
    more = ", ..." if len(seen) > MOST_PULSES else ""
    place = f"bead {seen.bead} of chain {seen.chain}"
    print(f"a train of {len(seen)} pulses passed {place}: {each}{more} V, {apart}{more} apart")


def _words(character: Character) -> str:
    """What a pulse is, at the bead where it was measured."""
    measured = f"shape {character.residual:.1e}, speed {character.speed_excess:+.1e} off the exact wave"
    if math.isfinite(character.variation):
        measured += f", amplitude varies by {character.variation:.1e}"
    if not math.isfinite(character.speed_excess):
        kind = "steady" if character.solitary else "not steady"
        return f"{kind} at bead {character.bead}: amplitude varies by {character.variation:.1e} over beads of its mass"
    if not math.isfinite(character.residual):
        return f"at bead {character.bead}: not recorded long enough around its passage to compare its shape"
    kind = "solitary" if character.solitary else f"not solitary ({', '.join(character.fails)})"
    return f"{kind} at bead {character.bead}: {measured}"


def _rows(found: Analysis) -> list[int]:
    """About six beads that a pulse was seen at, from early to the last that the pulse passed undisturbed."""
    if len(found.waves) == 0:
        return []
    recorded = np.unique(found.waves.bead)
    last = int(found.waves.bead[last_clear_bead(found.waves, found.problem)])
    wanted = [2, 5, 10, 20, 55, 90, last] if last <= 200 else np.geomspace(5, last, 7).round().astype(int).tolist()
    near = {int(recorded[np.argmin(np.abs(recorded - bead))]) for bead in wanted if bead <= last}
    return sorted(near)
