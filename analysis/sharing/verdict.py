"""Whether the chains share the pulse equally and in step, how uncertain that is, and how far it would take, in words.

In a weakly coupled chain a pulse decays before its neighbours have taken their share. Each row that the pulse leaves
behind keeps ``kappa / 2 * shift**2`` in every spring of the chain; the exact wave has the shift ``1.840249 v**0.8`` and
the energy ``1.069323 v**2``. Equating the loss per bead gives::

    v(n) = v0 * (1 - n / n*)**2.5        n* = 10 * energy / (shift**2 * kappa * springs) * v0**0.4

with v0 = 0.6816315 V, the amplitude in a single chain: n* = 2.709 V**0.4 / kappa for a chain with one neighbour.
"""

import math
from dataclasses import dataclass
from enum import Enum

import numpy as np

from analysis.quantity import declare, result
from analysis.shape.exact_wave import HERTZ, solitary_wave
from analysis.sharing.equipartition import (
    AGREEMENT,
    Estimate,
    Sharing,
    error_of_crossing,
    error_of_line,
    last_springs,
    resolved,
    unlike,
)
from analysis.sharing.impulses import compared_by_impulses
from analysis.tracking.undisturbed import CLEAR
from analysis.trajectory import along_the_way
from lammps_inputs import Problem, laws, physics
from lammps_inputs.facts import Fact

SINGLE_CHAIN = 0.6816315
"""Amplitude far down a single chain whose first bead was kicked with V = 1."""

FIRST = 10
"""Beads after which the wave has formed."""

LARGEST_NEIGHBOUR = 0.3
"""Largest amplitude of another chain, in that of the chain that was kicked, for which the law is fitted."""

LEAST_BEADS = 10
"""Recorded beads needed for a fit."""


@result
class DecayFit:
    """The law fitted to the leading wave of the kicked chain, v0 and n* free."""

    first: int = declare("first bead of the fit")
    last: int = declare("last bead of the fit")
    v0: float = declare(f"amplitude at the kick; {SINGLE_CHAIN} expected", "V", symbol="v_0")
    n_star: float = declare("beads from the kicked one at which the pulse would end", "beads", symbol="n^*")
    v0_error: float = declare("uncertainty of ``v0``, as ``n_star_error``", "V")
    n_star_error: float = declare(
        "standard error of ``n_star``, and what the errors of the amplitudes change, by the time between frames and by "
        "the run (``run_error``)",
        "beads",
    )
    n_star_expected: float = declare(
        "``n_star`` of theory, for a kick of the first bead", "beads", "another bead was kicked"
    )
    deviation: float = declare("largest relative difference of an amplitude from the fitted law")


def expected_n_star(kappa: float, springs: int = 1) -> float:
    """Beads at which the law ends for V = 1 and a chain with this many springs of stiffness kappa."""
    exact = solitary_wave()
    return float(10.0 * exact.energy / (exact.shift**2 * kappa * springs) * SINGLE_CHAIN**0.4)


def stiffness_of_springs(problem: Problem, chain: int) -> float | None:
    """Stiffness of all springs of a chain (from 0) together; None if they are not linear or differ from row to row."""
    total = 0.0
    for link in problem.system.couplings:
        if not link.law.linear:
            return None
        for edge, ends in enumerate(link.edges):
            spring = laws.stiffness(laws.at(link.law, edge), 0.0)
            if np.ptp(spring) != 0.0:
                return None
            total += float(np.max(spring)) if chain in ends else 0.0
    return total


def fit_decay(shared: Sharing, problem: Problem) -> DecayFit | None:
    """The law fitted where it holds; None if it does not for ten recorded beads, or unless one bead was kicked.

    It is one of linear springs that are the same in all rows, of the contacts of spheres that touch, and of chains
    without losses.

    ``(v / v0)**0.4 = 1 - n / n*`` is a straight line.
    """
    system = problem.system
    if (
        physics.exponent(system) != HERTZ
        or not (physics.alike(system) and system.holds(Fact.PULSE) and system.holds(Fact.SONIC_VACUUM))
        or len(physics.excitations(system)) != 1
        or physics.exchanges(system)
        or len(shared) == 0
        or shared.of_impulses
    ):
        return None
    chain, kicked_bead = shared.kicked, along_the_way(problem, physics.excitations(system)[0][1])
    springs = stiffness_of_springs(problem, chain)
    if not springs:
        return None
    others = np.nanmax(np.delete(shared.amplitude, chain, axis=1), axis=1)
    regime = others < LARGEST_NEIGHBOUR * shared.amplitude[:, chain]
    ahead = shared.bead >= kicked_bead + FIRST
    ended = np.flatnonzero(ahead & ~regime)
    used = np.flatnonzero(ahead)[: None if len(ended) == 0 else int(ended[0] - np.argmax(ahead))]
    if len(used) < LEAST_BEADS:
        return None
    distance, amplitude = (shared.bead[used] - kicked_bead).astype(float), shared.amplitude[used, chain]
    (slope, intercept), covariance = np.polyfit(distance, amplitude**0.4, 1, cov=True)
    if slope >= 0.0:
        return None
    n_star = float(-intercept / slope)
    law = (intercept + slope * distance) ** 2.5
    relative = covariance[0, 0] / slope**2 + covariance[1, 1] / intercept**2
    relative -= 2.0 * covariance[0, 1] / (slope * intercept)
    errors = 0.4 * shared.largest_error[used] / amplitude**0.6
    return DecayFit(
        first=int(shared.bead[used[0]]),
        last=int(shared.bead[used[-1]]),
        v0=float(intercept**2.5),
        n_star=n_star,
        v0_error=2.5
        * float(intercept**2.5 / intercept)
        * (float(np.sqrt(covariance[1, 1])) + error_of_line(distance, errors, 0.0)),
        n_star_error=n_star * float(np.sqrt(max(relative, 0.0)))
        + error_of_crossing(distance, amplitude**0.4, 0.0, errors),
        n_star_expected=expected_n_star(springs * physics.pulse_time(system) ** 2)
        if kicked_bead == 1
        else float("nan"),
        deviation=float(np.max(np.abs(law / amplitude - 1.0))),
    )


RULE_CHAINS, RULE_UNSURE, RULE_LEAST_UNSURE = 20, 0.25, 5.0
"""Most chains for which `_by_rule` was measured, and how far it is off at most: a share, but at least so many beads."""

NEAR, STRONG = 0.5, 0.01
"""Share of the way seen for which the beats' decay foretells agreement, and the weakest coupling: measured at 2 to 20
chains. Farther ahead, and at weaker couplings, it was off by up to 1.3 times the way still to go.
"""


class EquipartitionState(Enum):
    """State of equipartition of a run."""

    EQUAL = "equipartitioned and synchronised"
    BEATING = "beating"
    SHORT = "too short"
    ALONE = "no energy exchange"
    UNSURE = "inconclusive"
    UNLIKE = "of different beads"
    NO_PULSE = "does not apply"


@dataclass(frozen=True)
class Verdict:
    """Equipartition of a run.

    Attributes:
        state: the state.
        sentence: the state and its numbers, in a sentence.
        since: bead from which on amplitudes and arrivals agree to 1%; None if they do not.
        expected: bead from which on the amplitudes may be expected to agree to 1%, where they do not yet; always ahead
            of the last one seen; None if nothing is known.
    """

    state: EquipartitionState
    sentence: str
    since: int | None = None
    expected: Estimate | None = None


def verdict_on(shared: Sharing, problem: Problem, decay: DecayFit | None) -> Verdict:
    """The verdict on a run. Equality must have lasted for half a beat to count."""
    verdict = _without_exchange(shared, problem) or _of_waves(shared, problem, decay)
    if (
        verdict.state in (EquipartitionState.BEATING, EquipartitionState.SHORT)
        and len(shared)
        and unlike(problem.system, shared.kicked)
    ):
        return Verdict(
            EquipartitionState.UNLIKE,
            f"the chains are {EquipartitionState.UNLIKE.value}: at bead {shared.bead[-1]} {shared.compared} differ by "
            f"{shared.mismatch[-1]:.1%}, and no agreement to 1% has lasted for half a beat",
        )
    return verdict


def _verdict(
    state: EquipartitionState, reason: str, since: int | None = None, expected: Estimate | None = None
) -> Verdict:
    """Verdict whose sentence begins with its state."""
    subject = "equipartition " if state is EquipartitionState.NO_PULSE else ""
    return Verdict(state, f"{subject}{state.value}: {reason}", since, expected)


def _without_exchange(shared: Sharing, problem: Problem) -> Verdict | None:
    """Verdict where there is no pulse, or no exchange of its energy; else None."""
    system = problem.system
    if not system.holds(Fact.PULSE):
        return _verdict(EquipartitionState.NO_PULSE, physics.why_no_pulse(system))
    if problem.chains == 1:
        return _verdict(EquipartitionState.ALONE, "a single chain")
    if not physics.coupled(system):
        return _verdict(EquipartitionState.ALONE, "no chain is coupled to another")
    if len(physics.tied_to(system, shared.kicked)) == 1:
        return _verdict(EquipartitionState.ALONE, "the kicked chain is coupled to no other")
    return None


def _of_waves(shared: Sharing, problem: Problem, decay: DecayFit | None) -> Verdict:
    if len(shared) == 0:
        last = problem.beads - CLEAR
        text = f"no bead between the kick and bead {last} was passed in every chain, "
        if last <= along_the_way(problem, physics.largest_excitation(problem.system)[1]):
            text = f"no bead beyond the kick lies {CLEAR} beads before the end of the chains, "
        return _too_short(f"{text}so amplitudes cannot be compared", _by_rule(problem, 0), None)
    last, differ = int(shared.bead[-1]), f"{shared.compared} differ by {shared.mismatch[-1]:.1%}"
    expected = _expected(shared, problem)
    if not resolved(shared, problem.system):
        if compared_by_impulses(problem.system):
            text = "chains with gaps are compared by impulses, which are known only where all beads are recorded"
            return _verdict(EquipartitionState.UNSURE, text)
        apart = int(np.diff(shared.bead).max())
        text = f"the compared beads lie up to {apart} apart, too far to see beats; at bead {last} {differ}"
        return _too_short(text, expected, decay)
    level, in_step = shared.agrees_from(AGREEMENT), shared.in_step_from(AGREEMENT)
    if level is not None and (doubt := _doubt(shared)):
        return _verdict(EquipartitionState.UNSURE, doubt)
    if level is not None and in_step is not None:
        text = (
            f"{shared.compared} agree to 1% from bead {level} on, arrivals to 1% of the passage time "
            f"from bead {in_step} on (observed to bead {last})"
        )
        return _verdict(EquipartitionState.EQUAL, text, max(level, in_step))
    if (end := last_springs(problem, shared.kicked)) + CLEAR < last:
        text = f"{EquipartitionState.ALONE.value} beyond row {end}, where springs end; at bead {last} {differ}"
        return Verdict(EquipartitionState.ALONE, text)
    beat = shared.beat_length
    if beat is None and (largest := float(np.max(shared.mismatch))) < AGREEMENT:
        text = f"no beat is seen from bead {shared.bead[0]} to {last}, where {shared.compared} agree to {largest:.1%}"
        return _too_short(text, None, None)
    if beat is None:
        return _too_short(f"no complete half beat is observed to bead {last}, where {differ}", expected, decay)
    recent = shared.bead >= last - 0.5 * beat.value
    beats = "without a regular beat"
    if (regular := shared.regular_beat) is not None:
        beats = f"beats of {regular.value:.1f} +- {regular.uncertainty:.1f} beads"
    if level is not None:
        text = f"{shared.compared} agree to 1% from bead {level} on, but arrivals differ by up to "
        text += f"{np.nanmax(shared.spread[recent]):.1%} of the wave's passage over the last half beat; {beats}"
        return _verdict(EquipartitionState.BEATING, text)
    text = f"{shared.compared} differ by up to {shared.mismatch[recent].max():.2%} over the last half beat"
    return _verdict(EquipartitionState.BEATING, f"{text} to bead {last}, {beats}{_about(expected)}", expected=expected)


def _doubt(shared: Sharing) -> str:
    """Reason why agreement to 1% cannot be determined from these waves; empty if it can."""
    amplitude, arrival = shared.uncertainties()
    if arrival == math.inf:
        return "beads fly freely when they are fastest, so that arrivals at the maximum are not defined"
    if max(amplitude, arrival) > AGREEMENT:
        return (
            f"the time between frames and the error of the run leave amplitudes an uncertainty of {amplitude:.1%}, and "
            f"arrivals one of {arrival:.1%} of the wave's passage"
        )
    return ""


def _too_short(text: str, expected: Estimate | None, decay: DecayFit | None) -> Verdict:
    fading = ""
    if decay is not None:
        fading = f"; the pulse in the kicked chain decays, towards zero {decay.n_star:.0f} beads from the kick"
    return _verdict(EquipartitionState.SHORT, f"{text}{_about(expected)}{fading}", expected=expected)


def _expected(shared: Sharing, problem: Problem) -> Estimate | None:
    """Bead of 1% agreement, ahead of the last one seen: by the beats' decay where it is near, else by the rule."""
    system = problem.system
    last = int(shared.bead[-1])
    tried = (
        physics.open_row(system)
        and physics.alike(system)
        and system.holds(Fact.SONIC_VACUUM)
        and physics.gap(system) == 0.0
        and physics.kappa_of_pulses(system) >= STRONG
        and resolved(shared, system)
    )
    if problem.chains > 4:  # a kicked chain among many first shares with its neighbours, and only later with all
        tried &= all(chain in (1, problem.chains) for chain, _, _ in physics.excitations(system))
    by_beats = shared.expected_agreement(AGREEMENT) if tried else None
    if by_beats is not None and last < by_beats.value <= (1.0 + NEAR) * last:
        return by_beats
    return _by_rule(problem, last)


def _by_rule(problem: Problem, last: int) -> Estimate | None:
    """Bead of 1% agreement when bead 1 of an open row's outer chain is kicked, ``10 + 5 / kappa * (chains / 2)**1.6``.

    Measured at 2 to 20 chains, kappa = 0.01 to 2 (two chains: from 0.003 on): 0.8 to 1.1 times that, and never more
    than 5 beads off where that is more. None elsewhere, and where it is not ahead of the last bead seen.
    """
    system = problem.system
    if not physics.open_row(system):
        return None
    least, kappa = 0.003 if problem.chains == 2 else 0.01, physics.kappa_of_pulses(system)
    (chain, bead, _), *more = physics.excitations(system)
    outer = not more and chain in (1, problem.chains) and along_the_way(problem, bead) == 1
    measured = (
        outer
        and physics.alike(system)
        and physics.exponent(system) == HERTZ
        and not physics.acted_on(system)
        and not system.dampers
        and system.holds(Fact.SONIC_VACUUM)
        and physics.gap(system) == 0.0
        and problem.chains <= RULE_CHAINS
        and least <= kappa <= 2.0
    )
    beads = 10.0 + 5.0 / kappa * (problem.chains / 2.0) ** 1.6
    if not measured or beads <= last:
        return None
    return Estimate(beads, max(RULE_UNSURE * beads, RULE_LEAST_UNSURE))


def _about(expected: Estimate | None) -> str:
    if expected is None:
        return ""
    return f"; they should agree to 1% from bead {expected.value:.0f} +- {math.ceil(expected.uncertainty)} on"
