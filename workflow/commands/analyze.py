"""Find the waves in a run and draw them."""

import argparse
import math
from pathlib import Path

import numpy as np

from analysis.solitary import Character
from analysis.survey import Survey
from lammps_inputs import InputError
from workflow.analyse import Analysis, analyse, last_clear_bead
from workflow.engines.lammps.checks import ENERGY_TOLERANCE
from workflow.run_directory import RunDirectory
from workflow.screen import one_line, print_table


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The directory and what to draw."""
    parser.add_argument("directory", metavar="DIR", type=Path, help="a run directory, also from a cluster")
    parser.add_argument("--beads", metavar="N,N,...", help="beads whose velocity over time is drawn")
    parser.add_argument("--no-figures", action="store_true", help="write the tables only")


def execute(arguments: argparse.Namespace) -> int:
    """Print a short table; write waves.csv, analysis.json and figures."""
    found = analyse(RunDirectory(arguments.directory), beads=_beads(arguments.beads), figures=not arguments.no_figures)
    _print(found)
    names = ["waves.csv", "analysis.json", *(path.name for path in found.figures)]
    print(f"{one_line(arguments.directory)}: {', '.join(names)}")
    return 0


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
    shown = [bead for bead in _rows(found) if len(waves.at(bead))]
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
    print_table(f"{problem.name}: leading pulse", head, rows)
    _print_pulses(found.survey)
    if found.left is not None:
        print(found.left.sentence(waves))
    if np.isfinite(seen.energy_drift):
        print(f"energy within {seen.energy_drift:.1e}, momentum within {seen.momentum_drift:.1e} of the kick's")
        if max(seen.energy_drift, seen.momentum_drift) > ENERGY_TOLERANCE:
            print(found.failure or "that is not this scene: was the deck run with another kappa or kick?")


def _print_pulses(found: Survey) -> None:
    """The verdict, the decay law where it was fitted, what the leading waves and other pulses are."""
    print(found.verdict.sentence)
    final, decay = found.shared.final, found.decay
    if final is not None:
        # the energy of exact waves; beads with gaps carry none of that kind
        energy = np.sum(found.shared.wave_share[-1])
        share = "" if found.problem.gap else f"; {energy:.1%} of its energy in the leading waves"
        uncertainty = max(final.uncertainty, 1e-6)
        print(f"amplitude {final.value:.5f} +- {uncertainty:.1g} V, {1.0 - final.value:.1%} below the kick{share}")
    if decay is not None:
        print(
            f"decay as (1 - n / n*)**2.5 over beads {decay.first} to {decay.last}: n* = {decay.n_star:.1f} "
            f"+- {decay.n_star_error:.1g}, theory {decay.expected:.1f}"
        )
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


def _words(character: Character) -> str:
    """What a pulse is, at the bead where it was measured."""
    measured = f"shape {character.residual:.1e}, speed {character.speed_excess:+.1e} off the exact wave"
    if math.isfinite(character.variation):
        measured += f", amplitude varies by {character.variation:.1e}"
    if not math.isfinite(character.residual):
        return f"at bead {character.bead}: not recorded long enough around its passage to compare its shape"
    kind = "solitary" if character.solitary else f"not solitary ({', '.join(character.fails)})"
    return f"{kind} at bead {character.bead}: {measured}"


def _rows(found: Analysis) -> list[int]:
    """About six recorded beads, from early to the last that the pulse passed undisturbed."""
    recorded = found.problem.recorded_beads
    if len(found.waves) == 0:
        return []
    last = int(found.waves.bead[last_clear_bead(found.waves, found.problem)])
    wanted = [2, 5, 10, 20, 55, 90, last] if last <= 200 else np.geomspace(5, last, 7).round().astype(int).tolist()
    near = {int(recorded[np.argmin(np.abs(recorded - bead))]) for bead in wanted if bead <= last}
    return sorted(near)
