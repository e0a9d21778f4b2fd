"""Terms of verdicts with their criteria, and numbers of the pulse in a kicked chain, from the constants behind them.

The manual's page of quantities holds both; `granchain help TERM` prints a term.

Plug-ins take this module for help on verdicts: `explained` has the criterion of a term, `manual` the page's section.

Examples:
    >>> terms.explained("decaying")
    'contacts or beads dissipate energy, and the amplitude is smaller than 10 beads before'
"""

from typing import NamedTuple

from analysis.shape.exact_wave import HERTZ, solitary_wave
from analysis.shape.waveforms import COMPARED
from analysis.sharing.equipartition import (
    AGREEMENT,
    CONVERGES,
    LARGEST_DEVIATION,
    RESOLVED,
    SETTLED,
    SMALLEST_BEAT,
)
from analysis.sharing.is_solitary import Tolerances
from analysis.sharing.verdict import SINGLE_CHAIN, EquipartitionState, expected_n_star
from analysis.tracking.pulses import CONSTANT_OVER, LEAST_BEADS, SMALLEST
from analysis.tracking.undisturbed import APART, CLEAR
from lammps_inputs import physics, references
from workflow.verdicts.analysis_report import STEADY

_ALLOWED = Tolerances()
_EQUAL = f"{AGREEMENT:.0%}"

TERMS = {
    "pulse": f"maxima of the velocity of at least {LEAST_BEADS} recorded beads (all, if fewer are recorded), one after "
    f"the other as a wave of their amplitude runs, that reach {SMALLEST:g} V somewhere",
    "clear bead": f"a leading wave is clear up to {CLEAR} beads before the end that it runs to; any other pulse more "
    f"than {CLEAR} beads from either end, before a reflection can have reached it (*returns*)",
    "returns": "a reflection can have reached a bead as long after the leading pulse reached the end of the chain as "
    "this pulse took from the bead to that end",
    "clear of other pulses": f"none is within {APART:g} beads, where the velocity of the exact wave is 1e-10 of its "
    "peak",
    "compared beads": "recorded beads ahead of the kicked one that the leading waves of all coupled chains passed "
    "clear of the end; where another pulse leads from a bead on, from the last such bead on",
    "passage time": "time in which the exact wave of the mean amplitude passes at half its height: full width at half "
    "maximum over speed",
    "half beat": "beads between two places where the amplitude of the kicked chain passes the mean of the chains; "
    f"changes of sign after which it deviates by less than {SMALLEST_BEAT:g} of the mean do not count",
    EquipartitionState.EQUAL.value: (
        f"up to the last compared bead, over a half beat at least, amplitudes differ by less than "
        f"{_EQUAL} of their mean, and arrivals by less than {_EQUAL} of the passage time"
    ),
    EquipartitionState.BEATING.value: (
        f"a half beat was seen, but amplitudes or arrivals do not agree to {_EQUAL} for as long as the last one"
    ),
    EquipartitionState.SHORT.value: (
        "no half beat was seen, or no bead was passed clear of the end in all chains, or the compared "
        f"beads are more than {RESOLVED:g} / sqrt(kappa) apart, a quarter of the shortest beat"
    ),
    EquipartitionState.ALONE.value: (
        "a single chain, chains that no spring connects with the kicked one, or springs that end more "
        f"than {CLEAR} rows before the last compared bead without agreement to {_EQUAL}"
    ),
    EquipartitionState.UNSURE.value: (
        f"amplitudes agree to {_EQUAL}, but the uncertainty of amplitudes or arrivals is larger, or "
        "arrivals are undefined"
    ),
    EquipartitionState.UNLIKE.value: (
        f"beads or contacts of one row differ between the coupled chains, and nothing agrees to {_EQUAL}"
    ),
    EquipartitionState.NO_PULSE.value: (
        "no pulse keeps its shape or is followed: drives, foundations, resonators slower than a "
        "pulse, contacts that act at a distance"
    ),
    "asymptotic amplitude": "mean over chains and the last half beat (of one chain the last tenth of the beads); its "
    f"uncertainty is the largest deviation, at most {LARGEST_DEVIATION:g} of it, or the change to come, plus "
    "errors by frames and run",
    "converge": f"the means over the last two half beats differ by at most {SETTLED:g} of them, half of the largest "
    f"deviation, or {CONVERGES:g} of the difference before; and neither dissipation, beads nor loads change amplitudes",
    "solitary": f"shape and speed are those of the exact wave of this amplitude within {_ALLOWED.shape:.0%} and "
    f"{_ALLOWED.speed:.0%}, the amplitude is constant within {_ALLOWED.amplitude:.0%}, and neither contacts nor beads "
    "dissipate energy",
    "shape": f"largest difference of the velocity from the exact wave, within {COMPARED:g} beads of the peak, over the "
    "peak velocity",
    "variation": f"(largest - smallest) / mean amplitude of the last {CONSTANT_OVER} beads, where beads differ of "
    "those of the same mass",
    "steady": f"where beads differ or are loaded, and there is no exact wave: the variation is at most "
    f"{_ALLOWED.amplitude:.0%}, and neither contacts nor beads dissipate energy",
    "steady in a train": f"the amplitude differs by at most {STEADY:.0%} from those of the {CONSTANT_OVER} beads "
    "before, and the pulse is clear of the ends and of other pulses",
    "decaying": f"contacts or beads dissipate energy, and the amplitude is smaller than {CONSTANT_OVER} beads before",
}
"""Term -> criterion, with its tolerances."""


class Number(NamedTuple):
    """A number of the pulse that a kick of bead 1 makes in a single chain of equal, uncompressed spheres."""

    value: str
    meaning: str
    source: str


def numbers() -> list[Number]:
    """The numbers that the manual quotes; dimensionless, so that they hold for any kick."""
    wave, amplitude = solitary_wave(), SINGLE_CHAIN
    speed = float(wave.speed_at(amplitude))
    overlap = float(wave.peak_overlap_at(amplitude))
    duration = wave.width / speed
    exact = f"exact wave [{', '.join(str(references.number(key)) for key in ('english2005', 'ahnert2009'))}]"
    published = references.number("hinch1999")
    return [
        Number(f"{amplitude:.5f} V", "amplitude", f"reference integrator; published: 0.682 V [{published}]"),
        Number(f"{speed:.4f} beads / T", "speed", f"{exact}: {wave.speed:.5f} v^(1/5)"),
        Number(f"{overlap:.4f} L", "largest overlap", f"{exact}: {wave.peak_overlap:.5f} v^(4/5)"),
        Number(f"{overlap**HERTZ:.4f} m L / T^2", "largest force in a contact", "the overlap to the power 3/2"),
        Number(
            f"{float(wave.momentum_at(amplitude)):.4f} m V",
            "momentum, larger than that of the kick, as the first beads rebound",
            f"{exact}: {wave.momentum:.5f} v",
        ),
        Number(
            f"{float(wave.energy_at(amplitude)) / 0.5:.4f}",
            "energy over that of the kick",
            f"{exact}: {wave.energy:.5f} m v^2",
        ),
        Number(f"{wave.width:.4f} beads", "full width of the velocity at half its maximum", f"{exact}, at any v"),
        Number(f"{duration:.4f} T", "duration of the passage at half the maximum", "width / speed"),
        Number(
            f"{physics.PULSE_RATE:g} / T",
            "angular frequency below which a resonator is slower than the pulse",
            f"pi / {duration:.4f}: its half period is that duration",
        ),
        Number(
            f"{expected_n_star(1.0):.4f} / kappa",
            "beads n* over which a pulse in one of two weakly coupled chains decays, v = v_0 (1 - n / n*)^(5/2)",
            f"each spring that the pulse has passed holds kappa s^2 / 2, s = {wave.shift:.5f} v^(4/5) (displacement "
            "of the beads)",
        ),
    ]


def explained(word: str) -> str | None:
    """Criterion of a term, or of the state that has it as a part, such as ``synchronised``; None of other words."""
    names = [name for name in TERMS if word == name or word in name.split(" and ")]
    return TERMS[names[0]] if names else None


def manual() -> str:
    """The section of the manual, in Markdown."""
    page = (
        "\n## Terms of verdicts\n\nCriteria of the words in `state`, `verdict` and printed lines.\n\n"
        "| term | criterion |\n|---|---|\n"
    )
    page += "".join(f"| {name} | {criterion} |\n" for name, criterion in TERMS.items())
    page += (
        "\n## Numbers of the pulse in a single chain\n\nThe pulse that a kick V of bead 1 makes in a chain of equal "
        "spheres without static load; v is the amplitude over V.\n\n| number | meaning | source |\n|---|---|---|\n"
    )
    return page + "".join(f"| {' | '.join(number)} |\n" for number in numbers())
