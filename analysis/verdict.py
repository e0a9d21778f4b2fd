"""In words: whether the chains share the pulse equally and in step, how sure that is, and how far it would take."""

import math
from dataclasses import dataclass
from enum import Enum

import numpy as np

from analysis.decay_law import DecayFit
from analysis.equipartition import Estimate, Sharing
from lammps_inputs import Problem

AGREEMENT = 0.01
"""Mismatch of amplitudes and of arrivals (in passages of the wave) below which chains count as equal."""

ONE_PER_CENT = 5.0
"""Beads to agreement within 1%, times kappa: 3 for strong coupling, 6 at kappa = 0.1, 5 at 0.01 (two chains)."""


class State(Enum):
    """What a run shows."""

    EQUAL = "equipartitioned and synchronised"
    BEATING = "still beating"
    SHORT = "too short to tell"
    ALONE = "nothing to share"
    UNSURE = "not to be told"


@dataclass(frozen=True)
class Verdict:
    """What a run shows of equipartition.

    Attributes:
        state: in one word.
        since: bead from which on amplitudes and arrivals agree to 1%; None if they do not.
        expected: bead from which on the amplitudes may be expected to agree to 1%, where they do not yet; None if
            nothing is known.
        sentence: for people.
    """

    state: State
    since: int | None
    expected: Estimate | None
    sentence: str


def judge(shared: Sharing, problem: Problem, decay: DecayFit | None) -> Verdict:
    """The verdict on a run. Equality must have lasted for half a beat to count."""
    if problem.chains == 1 or not problem.coupled:
        return Verdict(State.ALONE, None, None, f"{State.ALONE.value}: no chain is coupled to another")
    if len(shared) == 0:
        expected = _by_rule(problem)
        return Verdict(
            State.SHORT, None, expected, f"{State.SHORT.value}: no bead was passed in every chain; {_about(expected)}"
        )
    last = int(shared.bead[-1])
    level, in_step = shared.agrees_from(AGREEMENT), shared.in_step_from(AGREEMENT)
    if level is not None and (doubt := _doubt(shared)):
        return Verdict(State.UNSURE, None, None, f"{State.UNSURE.value}: {doubt}")
    if level is not None and in_step is not None:
        sentence = (
            f"{State.EQUAL.value}: amplitudes within 1% from bead {level} on, arrivals within 1% of the wave's passage "
            f"from bead {in_step} on (seen to bead {last})"
        )
        return Verdict(State.EQUAL, max(level, in_step), None, sentence)
    beat = shared.beat_length
    if beat is None:
        return _too_short(shared, problem, decay)
    expected = shared.expected_agreement(AGREEMENT) or _by_rule(problem)
    recent = shared.mismatch[shared.bead >= last - 0.5 * beat.value].max()
    if level is not None:
        what = f"amplitudes agree to 1% from bead {level} on, but arrivals differ by up to {_step(shared):.1%} of "
        what += "the wave's passage over the last half beat"
        return Verdict(State.BEATING, None, None, f"{State.BEATING.value}: {what}; beats of {_beads(beat)} beads")
    sentence = (
        f"{State.BEATING.value}: amplitudes differ by up to {recent:.1%} over the last half beat to bead {last}, "
        f"beats of {_beads(beat)} beads; {_about(expected)}"
    )
    return Verdict(State.BEATING, None, expected, sentence)


def _doubt(shared: Sharing) -> str:
    """Why agreement to 1% cannot be told from these waves; empty if it can."""
    amplitude, arrival = shared.sure_to()
    if arrival == math.inf:
        return "beads fly freely when they are fastest, so that arrivals at the maximum are not defined"
    if max(amplitude, arrival) > AGREEMENT:
        return (
            f"with frames so far apart amplitudes are sure to {amplitude:.1%} and arrivals to {arrival:.1%} of the "
            "wave's passage only"
        )
    return ""


def _too_short(shared: Sharing, problem: Problem, decay: DecayFit | None) -> Verdict:
    expected = _by_rule(problem)
    fading = ""
    if decay is not None:
        fading = f"; until then the pulse that was hit fades, as if to end after {decay.n_star:.0f} beads"
    sentence = (
        f"{State.SHORT.value}: {int(shared.bead[-1])} beads show no whole half beat, amplitudes differ by "
        f"{shared.mismatch[-1]:.1%}; {_about(expected)}{fading}"
    )
    return Verdict(State.SHORT, None, expected, sentence)


def _by_rule(problem: Problem) -> Estimate:
    """Bead of 1% agreement by the rule 5 / kappa, which holds to a factor of 2 for two to three chains."""
    beads = ONE_PER_CENT / problem.kappa
    return Estimate(beads, 0.5 * beads)


def _about(expected: Estimate) -> str:
    return f"agreement to 1% takes about {expected.value:.0f} +- {expected.uncertainty:.0f} beads"


def _step(shared: Sharing) -> float:
    beat = shared.beat_length
    length = 0.0 if beat is None else 0.5 * beat.value
    return float(np.nanmax(shared.spread[shared.bead >= shared.bead[-1] - length]))


def _beads(estimate: Estimate) -> str:
    return f"{estimate.value:.1f} +- {estimate.uncertainty:.1f}"
