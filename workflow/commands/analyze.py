"""Find the waves in a run and draw them."""

import argparse
import json
import math
from pathlib import Path

import numpy as np

from analysis.mirror import along_the_way
from analysis.sharing.is_solitary import Character
from analysis.sharing.survey import Survey
from analysis.sound.dispersion import NO_SOUND
from analysis.tracking.leading_waves import ARRIVALS
from analysis.tracking.pulses import of_one_kind
from analysis.tracking.undisturbed import CLEAR
from lammps_inputs import InputError, physics
from lammps_inputs.facts import Fact
from workflow.engines.lammps.invariants import ENERGY_TOLERANCE
from workflow.runs.run_directory import RunDirectory
from workflow.screen import Answer, one_line, print_table
from workflow.verdicts.analyse import Analysis, analyse, last_clear_bead
from workflow.verdicts.analysis_report import REPORT, train
from workflow.verdicts.findings.finding import MOST_CHAINS

FEW = 4
"""Chains up to which each has its own line."""

MOST_ROWS = 32
"""Of the table of the leading pulse."""

MOST_PULSES = 6
"""Of a train, that are told."""

SMALLEST = 1e-6
"""Uncertainty of an amplitude, in V, below which none is told: time steps leave as much."""

DOCUMENTED = 1e-4
"""Error of a peak velocity, in V, above which the user is told."""

FAR = 1.4
"""Time between frames, in T, from which on small maxima beside larger ones were seen to be missed."""


ANSWERS = "what analysis.json holds"
DRAWS = True
EXAMPLES = (
    "analyze demo",
    "analyze demo --beads 10,55,90 --formats png,pdf",
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
    parser.add_argument(
        "--dispersion",
        action="store_true",
        help="map frequency against wavenumber, which chains under a static load get anyway; says why if there is none",
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
    if arguments.dispersion and not physics.loaded(found.problem.system):
        print(f"no dispersion map: {NO_SOUND}")
    names = [*found.tables, REPORT, *(path.name for path in found.figures)]
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
    problem, seen = found.problem, found.conservation
    if not found.complete:
        print(
            f"incomplete: {seen.frames} of {problem.frames + 1} frames, to t = "
            f"{problem.scale.written(seen.last_time, 'time')}; what there is was analysed"
        )
    if found.altered:
        print(
            "the frames are not those that the run wrote, by the fingerprint in run.json: a file is damaged or changed"
        )
    if problem.system.holds(Fact.PULSE):
        _print_waves(found)
        _print_accuracy(found)
    _print_pulses(found.survey)
    for finding in found.findings.values():
        for said in finding.said():
            if isinstance(said, str):
                print(said)
            else:
                print_table(*said)
    _print_drifts(found)


def _print_waves(found: Analysis) -> None:
    """The leading pulse at some beads."""
    waves, scale = found.waves, found.problem.scale
    unit = {name: f" ({scale.symbol(name)})" if scale.si else "" for name in ("time", "velocity", "speed")}
    head = ["bead", "chain", f"arrival{unit['time']}", f"peak velocity{unit['velocity']}", f"speed{unit['speed']}"]
    if scale.si:
        head.append("peak velocity / V")
    rows = []
    for bead in _rows(found):
        at = waves.at(bead)
        for k in range(min(len(at), MOST_CHAINS)):
            row = [
                str(bead) if k == 0 else "",
                str(at.chain[k]),
                f"{at.arrival[k] * scale.time:.7g}",
                f"{at.peak_velocity[k] * scale.velocity:.5g}",
                f"{at.speed[k] / scale.time:.5g}",
            ]
            rows.append([*row, f"{at.peak_velocity[k]:.5f}"] if scale.si else row)
        if len(at) > MOST_CHAINS:
            rows.append(["", f"of {len(at)}", "", "", ""])
    print_table(f"{found.problem.name}: leading pulse", head, rows)


def _print_drifts(found: Analysis) -> None:
    """Of energy, unless an account of it has been told, and of momentum; what to think of them if they are large."""
    problem, seen = found.problem, found.conservation
    drifts = {"energy": seen.energy_drift, "momentum": seen.momentum_drift}
    known = {name: drift for name, drift in drifts.items() if np.isfinite(drift)}
    told = [
        f"{name} within {drift:.1e}"
        for name, drift in known.items()
        if name != "energy" or not physics.exchanges(problem.system)
    ]
    right = "what was put in" if physics.exchanges(problem.system) else "the kick's"
    if told:
        print(f"{', '.join(told)} of {right}")
    if max(known.values(), default=0.0) > ENERGY_TOLERANCE:
        print(found.failure or "that is not this scene: was the deck run with another kappa or kick?")


def _print_accuracy(found: Analysis) -> None:
    """What arrivals are, if not the maxima; and how sure the table is, if less than to `DOCUMENTED`."""
    problem, waves = found.problem, found.waves
    scale, clear = problem.scale, problem.beads - CLEAR
    if found.survey.arrival == "impulse":
        print("arrival: centre of the impulse until the bead is fastest")
    elif free := int(np.count_nonzero(np.isnan(waves.arrival[along_the_way(problem, waves.bead) <= clear]))):
        where = f"{free} beads that fly" if free > 1 else "a bead that flies"
        print(
            f"arrivals are maxima, which are not defined at {where} freely (empty in waves.csv); --arrival impulse is"
        )
    if len(waves) and waves.peak_velocity_error.max() > DOCUMENTED:
        worst = int(np.argmax(waves.peak_velocity_error))
        late = waves.arrival_error[np.isfinite(waves.arrival_error)].max(initial=0.0)
        why = "the noise" if found.survey.noise else f"frames {problem.every * scale.time:.3g} apart"
        largest = waves.peak_velocity_error[worst]
        print(
            f"{why}: peak velocities are sure to {largest:.1e} V only (bead {waves.bead[worst]} of "
            f"chain {waves.chain[worst]}), arrivals to {late:.1e} T; each one's error is in waves.csv"
        )
    if problem.every > FAR:
        print(f"frames are more than {FAR * scale.time:.3g} apart: small pulses may be missed between them")


def _print_pulses(found: Survey) -> None:
    """The verdict, the decay law where it was fitted, what the leading waves and other pulses are."""
    print(found.verdict.sentence)
    if not found.problem.system.holds(Fact.PULSE):
        return
    final, decay = found.shared.final, found.decay
    if final is not None:
        # the energy of exact waves; beads with gaps, that differ or bear a load, carry none of that kind
        energy = np.sum(found.shared.wave_share[-1])
        exact = physics.alike(found.problem.system) and found.problem.system.holds(Fact.SONIC_VACUUM)
        known = np.isfinite(energy) and not physics.gap(found.problem.system) and exact
        share = f"; {energy:.1%} of its energy in the leading waves" if known else ""
        uncertainty = max(final.uncertainty, SMALLEST)
        than = "the kick" if found.problem.system.kicks else "what the push would give a free bead"
        far = f"{abs(1.0 - final.value):.1%} {'above' if final.value > 1.0 else 'below'} {than}"
        print(f"amplitude {final.value:.5f} +- {uncertainty:.1g} V, {far}{share}")
    if decay is not None:
        print(
            f"decay as (1 - n / n*)**2.5 over beads {decay.first} to {decay.last}: n* = {decay.n_star:.1f} "
            f"+- {decay.n_star_error:.1g}, theory {decay.expected:.1f}"
        )
    _print_train(found)
    _print_leading(found)
    others = [pulse for pulse in found.pulses if not found.leads(pulse)]
    if others:
        strongest = max(pulse.peak_velocity.max() for pulse in others)
        many = f"{len(others)} other pulses, the strongest" if len(others) > 1 else "one other pulse, at most"
        print(f"{many} {strongest:.3f} V (analysis.json has all)")
    if found.crests:
        print(f"sound follows, up to {max(crest.peak_velocity.max() for crest in found.crests):.3f} V")
    if found.noise:
        print(f"the record is noisy: {found.noise:.1e} V; it was smoothed")


def _print_leading(found: Survey) -> None:
    """What the leading wave of each chain is; in one line where there are many and all are solitary."""
    leading = [
        (pulse.chain, character)
        for pulse, character in zip(found.pulses, found.characters, strict=True)
        if found.leads(pulse)
    ]
    exact = all(character.solitary and math.isfinite(character.residual) for _, character in leading)
    if exact and len({chain for chain, _ in leading}) > FEW:
        shape, speed, variation = (
            np.nanmax(np.abs([getattr(character, name) for _, character in leading]))
            for name in ("residual", "speed_excess", "variation")
        )
        print(
            f"{len(leading)} leading waves, solitary: shape {shape:.1e}, speed {speed:.1e} off the exact wave at most, "
            f"amplitude varies by up to {variation:.1e}"
        )
        return
    for chain, character in leading:
        if chain <= MOST_CHAINS:
            print(f"chain {chain}: {_words(character)}")


def _print_train(found: Survey) -> None:
    """The pulses that followed each other in the chain that was hit, if more than one did."""
    seen = train(found)
    if seen is None or len(seen) < 2 or np.any(np.diff(seen.peak_velocity) > 0.0):  # the faster ones are the higher
        return
    scale = found.problem.scale
    pairs = zip(seen.peak_velocity[:MOST_PULSES], seen.uncertainty, strict=False)
    each = ", ".join(
        f"{peak:.4f}" + (f" +- {max(varies, SMALLEST):.1g}" if math.isfinite(varies) else "") for peak, varies in pairs
    )
    apart = ", ".join(f"{spacing * scale.time:.4g}" for spacing in seen.spacing[: MOST_PULSES - 1])
    more = ", ..." if len(seen) > MOST_PULSES else ""
    unit = scale.symbol("time") if scale.si else "T"
    place = f"bead {seen.bead} of chain {seen.chain}"
    print(f"train of {len(seen)} pulses at {place}: {each}{more} V; intervals {apart}{more} {unit}")


def _words(character: Character) -> str:
    """What a pulse is, at the bead where it was measured."""
    measured = f"shape {character.residual:.1e}, speed {character.speed_excess:+.1e} off the exact wave"
    if math.isfinite(character.variation):
        measured += f", amplitude varies by {character.variation:.1e}"
    if not math.isfinite(character.speed_excess):
        if not math.isfinite(character.variation):
            return f"at bead {character.bead}: too few beads of its mass before it to tell whether the pulse is steady"
        kind = "steady" if character.solitary else "not steady"
        return f"{kind} at bead {character.bead}: amplitude varies by {character.variation:.1e} over beads of its mass"
    if not math.isfinite(character.residual):
        return f"at bead {character.bead}: not recorded long enough around its passage to compare its shape"
    kind = "solitary" if character.solitary else f"not solitary ({', '.join(character.fails)})"
    return f"{kind} at bead {character.bead}: {measured}"


def _rows(found: Analysis) -> list[int]:
    """Some beads that a pulse was seen at, from early to the last that the pulse passed undisturbed: seven at most."""
    if len(found.waves) == 0:
        return []
    recorded = np.unique(found.waves.bead)
    alike = recorded[of_one_kind(found.problem)[recorded - 1]]
    recorded = alike if len(alike) else recorded
    recorded = along_the_way(found.problem, recorded)
    last = int(along_the_way(found.problem, found.waves.bead)[last_clear_bead(found.waves, found.problem)])
    few = max(2, min(7, MOST_ROWS // min(found.problem.chains, MOST_CHAINS)))
    wanted = [2, 5, 10, 20, 55, 90, last] if last <= 200 else np.geomspace(5, last, 7).round().astype(int).tolist()
    wanted = [wanted[place] for place in np.linspace(0, len(wanted) - 1, few).round().astype(int)]
    near = {int(recorded[np.argmin(np.abs(recorded - bead))]) for bead in wanted if bead <= last}
    return [along_the_way(found.problem, bead) for bead in sorted(near)]
