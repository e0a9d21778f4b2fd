"""Find the waves in a run and draw them."""

import argparse
import json
import math
from pathlib import Path

import numpy as np

from analysis.gauges.readings import Readings
from analysis.gauges.spectra import Spectra
from analysis.shape.loaded_wave import sound_speed
from analysis.sharing.cells import CellEnergy
from analysis.sharing.energy_flow import Flow
from analysis.sharing.equipartition import CLEAR
from analysis.sharing.is_solitary import Character
from analysis.sharing.survey import Survey
from analysis.sound.dispersion import Map
from analysis.tracking.leading_waves import ARRIVALS
from analysis.tracking.pulses import of_one_kind
from analysis.trajectory import Floats
from lammps_inputs import InputError, Problem
from lammps_inputs.facts import Fact
from workflow.engines.lammps.invariants import ENERGY_TOLERANCE
from workflow.runs.files import REPORT
from workflow.runs.run_directory import RunDirectory
from workflow.screen import Answer, one_line, print_table
from workflow.verdicts.analyse import Analysis, analyse, last_clear_bead
from workflow.verdicts.analysis_report import train

MOST_CHAINS = 8
"""Chains that a table shows."""

FEW = 4
"""Chains up to which each has its own line."""

MOST_ROWS = 32
"""Of the table of the leading pulse."""

MOST_PULSES = 6
"""Of a train, that are told."""

DOCUMENTED = 1e-4
"""Error of a peak velocity, in V, above which the user is told."""

SMALLEST_LOSS = 1e-8
"""Share of the energy per cell that is told; what frames and time steps blur is less."""

MOSTLY = 0.9
"""Share of the beads from which on a chain is one of equal beads but for a few."""

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
    if isinstance(found.dispersion, str) and (arguments.dispersion or found.problem.loaded):
        print(f"no dispersion map: {found.dispersion}")
    more = (
        ("forces.csv", found.forces is not None),
        ("spectra.csv", found.spectra is not None),
        ("dispersion.csv", not isinstance(found.dispersion, str)),
    )
    tables = ["waves.csv", *(name for name, there in more if there), REPORT]
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
            rows.append(["", f"of {len(at)}", "", "", ""])
    if problem.holds(Fact.PULSE):
        print_table(f"{problem.name}: leading pulse", head, rows)
        _print_accuracy(found)
    _print_pulses(found.survey)
    if problem.loaded:
        _print_sound(found)
    if found.cells is not None:
        _print_cells(problem, found.cells)
    if found.forces is not None:
        _print_forces(problem, found.forces, found.given_back)
    if found.spectra is not None:
        _print_spectra(problem, found.spectra)
    if found.left is not None:
        print(found.left.sentence(waves))
    drifts = {"energy": seen.energy_drift, "momentum": seen.momentum_drift}
    known = {name: drift for name, drift in drifts.items() if np.isfinite(drift)}
    if found.budget is not None:
        print(f"{found.budget.account.sentence(scale)}\n{found.budget.sentence}")
    right = "what was put in" if problem.exchanges else "the kick's"
    said = [
        f"{name} within {drift:.1e}" for name, drift in known.items() if name == "momentum" or not problem.exchanges
    ]
    if said:
        print(f"{', '.join(said)} of {right}")
    if max(known.values(), default=0.0) > ENERGY_TOLERANCE:
        print(found.failure or "that is not this scene: was the deck run with another kappa or kick?")
    if found.contacts is not None:
        print("\n".join(found.contacts.lines()))


def _print_sound(found: Analysis) -> None:
    """The speed of sound, and the leading pulse on it against the long-wave theory's."""
    problem, wave = found.problem, found.sound
    scale = problem.scale
    if problem.held:
        line = "sound: long waves do not run, for springs to the ground hold the beads"
        if isinstance(found.dispersion, Map):
            bands, unit = found.dispersion.cell.bands() / scale.time, "rad/s" if scale.si else "rad per unit time"
            line += f"; small ones have frequencies from {bands.min():.6g} to {bands.max():.6g} {unit}"
        print(line)
        return
    speeds = sound_speed(problem) if wave is None else np.array([wave.sound])
    unit = "beads/s" if scale.si else "beads per unit time"
    said = dict.fromkeys(f"{speed / scale.time:.6g}" for speed in (float(speeds.min()), float(speeds.max())))
    line = f"sound: c0 = {' to '.join(said)} {unit}"
    if found.bead_length is not None:
        line += f" ({float(speeds.max()) * found.bead_length / scale.time:.5g} m/s)"
    if wave is not None:
        line += (
            f"; the leading pulse runs at {wave.over_sound:.5f} c0 past beads {wave.first} to {wave.last}, "
            f"F_m/F_0 = {wave.force_ratio:.4g}"
        )
        if math.isfinite(wave.theory):
            line += f": {wave.over_theory:.5f} of what the long-wave theory says (Nesterenko)"
    print(line)


def _print_cells(problem: Problem, cells: CellEnergy) -> None:
    """What the pulse of each chain leaves behind, and where the energy is as seen from a replaced bead."""
    splits = cells.splits()
    mass = np.asarray(problem.mass)
    alike = cells.period == 1 and np.mean(mass == np.median(mass)) > MOSTLY
    cell = "bead" if cells.period == 1 else f"cell of {cells.period} beads"
    for chain in range(1, min(problem.chains, MOST_CHAINS) + 1):
        left = cells.left(chain)
        if left is not None and math.isfinite(left.per_cell):
            lost = f"{left.per_cell:.1e}" if left.per_cell > SMALLEST_LOSS else f"less than {SMALLEST_LOSS:.0e}"
            # where single beads differ, nothing is left in cell after cell
            more = "" if alike else f"; from bead {left.first} on it has left {lost} of it in every {cell}"
            print(f"chain {chain}: the pulse carries {left.carried:.2%} of the energy at bead {left.last}{more}")
        final = cells.end(chain)
        if final is not None:
            print(f"chain {chain}: its last bead has had up to {final:.2%} of the energy, as motion")
    for split in splits[:MOST_CHAINS]:
        print(
            f"bead {split.bead} of chain {split.chain}: at the end {split.before:.2%} of the energy is before it, "
            f"{split.at:.2%} in it, {split.beyond:.2%} beyond"
        )
        if math.isfinite(split.reflected):
            print(f"  of {split.incident:.2%} that the pulse brought it has sent {split.reflected:.2%} back")


def _print_forces(problem: Problem, readings: Readings, given_back: dict[str, Floats]) -> None:
    """The largest force, impulse and dwell of every gauge; what walls felt and threw back."""
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
    kinds = [gauge.kind for gauge in readings.gauges]
    for place, gauge in enumerate(readings.gauges):
        if gauge.kind != "wall":
            continue
        for chain in range(min(problem.chains, MOST_CHAINS)):
            said = []
            if "contact" in kinds and (inside := readings.largest[chain, kinds.index("contact")]) > 0.0:
                other = readings.gauges[kinds.index("contact")].name
                said.append(f"largest force {readings.largest[chain, place] / inside:.4f} times that at {other}")
            if math.isfinite(back := given_back[gauge.side][chain]):
                among = " (and chains have exchanged energy meanwhile)" if problem.coupled else ""
                said.append(f"the first pulse is thrown back at {back:.4f} of its velocity{among}")
            if said:
                print(f"{gauge.name}, chain {chain + 1}: {', '.join(said)}")


def _print_spectra(problem: Problem, spectra: Spectra) -> None:
    """The highest line of every bead, and what it has of the drives."""
    scale = problem.scale
    hertz, velocity = (" (Hz)", f" ({scale.symbol('velocity')})") if scale.si else ("", "")
    head = ["bead", "chain", f"highest line at{hertz}", f"its velocity{velocity}"]
    head += [f"at {frequency / scale.time:.5g}{hertz}, over bead {spectra.beads[0]}" for frequency in spectra.drive]
    rows = []
    for place, bead in enumerate(spectra.beads):
        for chain in range(min(problem.chains, MOST_CHAINS)):
            top = int(np.argmax(spectra.amplitude[:, chain, place]))
            height = float(spectra.amplitude[top, chain, place] * scale.velocity)
            line = [f"{spectra.frequency[top] / scale.time:.5g}", f"{height:.5g}"]
            passed_on = [f"{share:.5g}" for share in spectra.transmissibility[:, chain, place]]
            rows.append([str(bead) if chain == 0 else "", str(chain + 1), *line, *passed_on])
    print_table(f"{problem.name}: spectra from t = {spectra.after * scale.time:.5g} on", head, rows)


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
        rows.append([f"of {problem.chains}", "", "", "", ""])
    head = ["chain", f"least at time{unit}", f"most at time{unit}", "at the end", "there, around bead"]
    print_table(f"{problem.name}: share of the energy", head, rows)


def _print_accuracy(found: Analysis) -> None:
    """What arrivals are, if not the maxima; and how sure the table is, if less than to `DOCUMENTED`."""
    problem, waves = found.problem, found.waves
    scale = problem.scale
    if found.survey.arrival == "impulse":
        print("arrival: centre of the impulse until the bead is fastest")
    elif free := int(np.count_nonzero(np.isnan(waves.arrival[waves.bead <= problem.beads - CLEAR]))):
        where = f"{free} beads that fly" if free > 1 else "a bead that flies"
        print(
            f"arrivals are maxima, which are not defined at {where} freely (empty in waves.csv); --arrival impulse is"
        )
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
        # the energy of exact waves; beads with gaps, that differ or bear a load, carry none of that kind
        energy = np.sum(found.shared.wave_share[-1])
        exact = found.problem.alike and found.problem.holds(Fact.SONIC_VACUUM)
        known = np.isfinite(energy) and not found.problem.gap and exact
        share = f"; {energy:.1%} of its energy in the leading waves" if known else ""
        uncertainty = max(final.uncertainty, 1e-6)
        than = "the kick" if found.problem.kicks else "what the push would give a free bead"
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
    last = int(found.waves.bead[last_clear_bead(found.waves, found.problem)])
    few = max(2, min(7, MOST_ROWS // min(found.problem.chains, MOST_CHAINS)))
    wanted = [2, 5, 10, 20, 55, 90, last] if last <= 200 else np.geomspace(5, last, 7).round().astype(int).tolist()
    wanted = [wanted[place] for place in np.linspace(0, len(wanted) - 1, few).round().astype(int)]
    near = {int(recorded[np.argmin(np.abs(recorded - bead))]) for bead in wanted if bead <= last}
    return sorted(near)
