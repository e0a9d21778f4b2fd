"""Sentences on the pulses of a run: verdict, amplitude and shape, as `granchain analyze` prints them."""

import math
from collections.abc import Iterator

import numpy as np

from analysis.sharing.is_solitary import Character
from analysis.sharing.survey import Survey
from analysis.tracking.pulses import CONSTANT_OVER
from lammps_inputs import System, physics
from lammps_inputs.facts import Fact
from workflow.measures.measurement import MOST_CHAINS
from workflow.verdicts.analysis_report import train

FEW = 4
"""Largest number of chains of which each has a line."""

MOST_PULSES = 6
"""Largest number of pulses of a train that are printed."""

SMALLEST = 1e-6
"""Least uncertainty of an amplitude that is printed, in V: time steps leave as much."""


def change_sentences(survey: Survey) -> Iterator[str]:
    """Lines on where the leading pulses of each chain end and why, the first of them with its peak velocity."""
    for chain in range(1, survey.problem.chains + 1):
        changes = [change for change in survey.succession if change.chain == chain]
        if not changes:
            continue
        first, others = changes[0], [str(change.last) for change in changes[1:]]
        peak = f"{first.peak_velocity:.3g} V"
        why = (
            f"where it merges into the pulse behind it ({first.behind:.3g} V), which leads from bead {first.first} on"
            if math.isfinite(first.behind)
            else f"and another one leads from bead {first.first} on"
        )
        further = f"; others end at bead{'s' * (len(others) > 1)} {', '.join(others)}" if others else ""
        yield f"in chain {chain} the leading pulse ends at bead {first.last} ({peak}), {why}{further}"
        yield (
            f"in chain {chain} amplitude and verdict are those of the pulse that leads from bead {changes[-1].first} on"
        )


def pulse_sentences(survey: Survey) -> Iterator[str]:
    """Lines on the verdict on several chains, the fitted decay law, and what the leading waves and other pulses are."""
    if survey.problem.chains > 1:
        yield survey.verdict.sentence
    if not survey.problem.system.holds(Fact.PULSE):
        if survey.problem.chains == 1:
            yield physics.why_no_pulse(survey.problem.system)
        return
    yield from _amplitude(survey)
    if (decay := survey.decay) is not None:
        expected = f" (theory: {decay.n_star_expected:.1f})" if math.isfinite(decay.n_star_expected) else ""
        yield (
            f"the amplitude in the kicked chain decays as (1 - n / n*)**2.5 over beads {decay.first} to {decay.last}, "
            f"with n* = {decay.n_star:.1f} +- {decay.n_star_error:.1g} beads{expected}"
        )
    yield from _train(survey)
    yield from _leading(survey)
    others = [pulse for pulse in survey.pulses if not survey.leads(pulse)]
    if others:
        strongest = max(pulse.peak_velocity.max() for pulse in others)
        many = f"{len(others)} other pulses have" if len(others) > 1 else "one other pulse has"
        yield f"{many} peak velocities up to {strongest:.3f} V (analysis.json lists every pulse)"
    if survey.crests:
        largest = max(crest.peak_velocity.max() for crest in survey.crests)
        yield f"sound waves have peak velocities up to {largest:.3f} V"


def _amplitude(survey: Survey) -> Iterator[str]:
    """Lines on the asymptotic amplitude, or why there is none and the range of amplitudes, and the waves' energy."""
    shared, system, scale = survey.shared.followed, survey.problem.system, survey.problem.scale
    if shared.span is None:
        return
    energy = np.sum(survey.energies.wave[-1]) if len(survey.energies.wave) else math.nan
    final, worth = shared.final, f"V = {scale.written(1.0, 'velocity')}"
    if final is None:
        span = shared.span
        why = shared.changing or "it has not settled"
        compared = shared.compared if shared.of_impulses else "peak velocities"
        numbers = f"{span.least:.5f} to {span.largest:.5f} V over beads {span.first} to {span.last}"
        yield f"there is no asymptotic amplitude: {why}; {compared} are {numbers} ({worth})"
    else:
        amplitude = f"{final.value:.5f} +- {max(final.uncertainty, SMALLEST):.1g} V"
        yield f"the asymptotic amplitude is {amplitude}, {_compared(final.value, system, worth)}"
    if math.isfinite(energy):
        yield f"the leading waves carry {energy:.1%} of the energy input"
    chains = survey.energies.chain[-1:, :MOST_CHAINS]
    if survey.problem.chains > 1 and chains.size and np.all(np.isfinite(chains)):
        bead = survey.shared.bead[survey.energies.place[-1]]
        shares = ", ".join(f"chain {chain} has {share:.1%}" for chain, share in enumerate(chains[0], 1))
        more = f" (of {survey.problem.chains} chains)" if survey.problem.chains > MOST_CHAINS else ""
        yield (
            f"when the leading waves pass bead {bead}, {shares}{more} of the energy input, with half of that of its "
            "springs"
        )


def _compared(amplitude: float, system: System, worth: str) -> str:
    """An asymptotic amplitude (in V) relative to the largest kick or push, in words."""
    kicked = any(
        abs(velocity) == max(abs(impulse) for *_, impulse in physics.excitations(system))
        for *_, velocity in system.kicks
    )
    than = f"the kick ({worth})" if kicked else f"the velocity that the push gives a free bead ({worth})"
    return f"{abs(1.0 - amplitude):.1%} {'above' if amplitude > 1.0 else 'below'} {than}"


def _leading(survey: Survey) -> Iterator[str]:
    """Lines on what the leading wave of each chain is at its farthest bead; one line where many are all solitary."""
    farthest: dict[int, tuple[int, Character]] = {}
    for pulse, character in zip(survey.pulses, survey.characters, strict=True):
        distance = survey.direction * int(pulse.bead[-1])
        if survey.leads(pulse) and distance >= farthest.get(pulse.chain, (distance, character))[0]:
            farthest[pulse.chain] = distance, character
    leading = {chain: character for chain, (_, character) in sorted(farthest.items())}
    exact = all(character.solitary and math.isfinite(character.residual) for character in leading.values())
    if exact and len(leading) > FEW:
        shape, speed, variation = (
            np.nanmax(np.abs([getattr(character, name) for character in leading.values()]))
            for name in ("residual", "speed_excess", "variation")
        )
        yield (
            f"the leading waves of all {len(leading)} chains are solitary: they differ from the exact wave by up to "
            f"{shape:.1e} in shape and {speed:.1e} in speed; their amplitudes vary by up to {variation:.1e} over "
            f"{CONSTANT_OVER} beads"
        )
        return
    for chain, character in leading.items():
        if chain <= MOST_CHAINS:
            yield f"in chain {chain} {_words(character)}"


def _train(survey: Survey) -> Iterator[str]:
    """Lines on the pulses that followed each other in the kicked chain, if more than one did."""
    pulses = train(survey)
    if (
        pulses is None or len(pulses) < 2 or np.any(np.diff(pulses.peak_velocity) > 0.0)
    ):  # the faster ones are the higher
        return
    scale = survey.problem.scale
    pairs = zip(pulses.peak_velocity[:MOST_PULSES], pulses.uncertainty, strict=False)
    each = ", ".join(
        f"{peak:.4f}" + (f" +- {max(varies, SMALLEST):.1g}" if math.isfinite(varies) else "") for peak, varies in pairs
    )
    apart = ", ".join(f"{spacing * scale.time:.4g}" for spacing in pulses.spacing[: MOST_PULSES - 1])
    more = ", ..." if len(pulses) > MOST_PULSES else ""
    unit = scale.symbol("time") if scale.si else "T"
    place = f"bead {pulses.bead} of chain {pulses.chain}"
    yield (
        f"a train of {len(pulses)} pulses passes {place}: peak velocities {each}{more} V, "
        f"intervals {apart}{more} {unit}"
    )


def _words(character: Character) -> str:
    """Sentence on the leading wave of a chain, at the bead where it was measured."""
    place, varies = f"at bead {character.bead}", math.isfinite(character.variation)
    parts, has_exact_wave = [], math.isfinite(character.speed_excess)
    if has_exact_wave:
        if not math.isfinite(character.residual):
            return (
                f"the shape of the leading wave {place} cannot be compared, as a larger pulse overlaps or the record "
                "ends too early"
            )
        parts.append(
            f"it differs from the exact wave by {character.residual:.1e} in shape and {character.speed_excess:+.1e} in "
            "speed"
        )
    elif not varies:
        return (
            f"it is undefined whether the leading wave {place} is steady, as fewer than two of the last "
            f"{CONSTANT_OVER} beads have its mass"
        )
    if varies:
        of_mass = "" if has_exact_wave else " of this mass"
        parts.append(f"its amplitude varies by {character.variation:.1e} over {CONSTANT_OVER} beads{of_mass}")
    fails = [name for name in character.fails if name != "decay"]
    if "decay" in character.fails:
        kind = "decaying" if character.falls else "not steady"
    elif has_exact_wave:
        kind = f"not solitary ({', '.join(fails)})" if fails else "solitary"
    else:
        kind = "not steady" if fails else "steady"
    return f"the leading wave is {kind} {place}: {'; '.join(parts)}"
