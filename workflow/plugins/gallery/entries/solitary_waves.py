"""Solitary waves in uniform chains: after a kick, by Nesterenko's theory, the exact one, and trains of them."""

import math

import numpy as np
from matplotlib.axes import Axes

from granchain.parts import Floats, exact_wave
from workflow.plugins.gallery.criteria import NAMES, MeasuredQuantity, at_least, at_most, by_engine, near, state
from workflow.plugins.gallery.entry import (
    COLOURS,
    PUBLISHED,
    Entry,
    Ran,
    Results,
    Statements,
    chain,
    each,
    exponent,
    line,
)

BEAD = 80
"""Where a single wave is measured."""


def _speed(run: Ran) -> float:
    """Speed of the wave over the fifth root of its velocity, in units of V and T."""
    return float(run.speed(60, 90) / run.peak(75) ** 0.2)


# --- a kicked chain ---------------------------------------------------------------------------------------------------


def _kicked(results: Results) -> Statements:
    """Amplitude, last bead, first bead."""
    runs, leading = results["kicked"], f"velocity of the leading pulse at bead {BEAD}"
    peak = each(lambda run: run.peak(BEAD), runs)
    last = each(lambda run: run.trajectory.velocity[-1, 0, -1], runs)
    first = each(lambda run: run.trajectory.velocity[-1, 0, 0], runs)
    for name, velocities, value, published in (
        (leading, peak, 0.682, "The leading solitary wave has the velocity 0.682 V."),
        ("velocity of the last bead at the end", last, 0.986, "The last ball leaves the chain with 0.986 V."),
        ("velocity of bead 1 at the end", first, -0.071, "The impacting ball rebounds with 0.071 V."),
    ):
        measured = MeasuredQuantity(name, velocities, near(value, 5e-4), "5 V")
        yield state(measured, published=published, source="hinch1999, as quoted")


def _draw_kicked(axis: Axes, results: Results) -> None:
    """The leading pulse over distance."""
    for place, (engine, run) in enumerate(results["kicked"].items()):
        marks = "-" if place else "o"
        axis.plot(run.waves.bead, run.waves.peak_velocity, marks, ms=3, color=COLOURS[place], label=NAMES[engine])
    axis.axhline(0.682, label="published: 0.682 $V$", **PUBLISHED)


KICKED_CHAIN = Entry(
    title="A kicked chain",
    introduction="One hundred touching beads; the first starts with V = 1.",
    sources={"hinch1999": "as quoted in the literature; the paper could not be read"},
    scenes={"kicked": chain(100, 150)},
    statements=_kicked,
    axes=("bead", r"velocity of the leading pulse $v_\mathrm{max} / V$"),
    draw=_draw_kicked,
    caption="Velocity of the leading pulse along the chain.",
)

# --- Nesterenko's long-wave theory ------------------------------------------------------------------------------------

FAR = 110
HALF = 2.0 * math.acos(0.5**0.25) / math.pi
"""Full width at half maximum of cos**4, in its own width from end to end."""


def _train(run: Ran) -> tuple[Floats, Floats, Floats]:
    """Velocities (V), speeds (beads / T) and forces (m V / T) of the pulses of a train that pass one bead, [pulse]."""
    before, at = run.survey.train(1, FAR - 20, 0.1), run.survey.train(1, FAR, 0.1)
    count = min(len(before), len(at))
    speed = 20.0 / (at.arrival[:count] - before.arrival[:count])
    read = run.forces(contacts=(FAR,))
    force = [
        float(np.max(read.force[np.abs(read.time - arrival - 0.5 / c) < 2.0, 0, 0]))
        for arrival, c in zip(at.arrival, speed, strict=False)
    ]
    return at.peak_velocity[:count], speed, np.array(force)


def _nesterenko(results: Results) -> Statements:
    """Constants of the wave, and exponents of the train of a heavy striker."""
    single, train = results["single"], each(_train, results["striker-4"])
    theory, exact = exact_wave.nesterenko(), exact_wave.solitary_wave()
    width = HALF * theory.width
    yield state(
        MeasuredQuantity("speed over V_m^(1/5)", each(_speed, single), near(theory.speed, 1e-4, 0.01)),
        published="Long-wave theory: a compact wave overlap^(1/2) = 5/4 (c cos)^2, velocity = c overlap.",
        source="nesterenko2001, ch. 1",
        derived=f"c = (4/5)^(2/5) V_m^(1/5) = {theory.speed:.4f} V_m^(1/5) beads per unit time.",
        correction=f"{exact.speed:.5f}: the long-wave theory of the discrete chain is 0.8% too fast.",
    )
    measured = each(lambda run: run.width(BEAD), single)
    yield state(
        MeasuredQuantity("full width at half maximum", measured, near(width, 0.005, 0.25), "3 beads"),
        published="The wave is cos^4, five beads wide.",
        source="nesterenko1983",
        derived=f"End to end 5 pi / sqrt(10) = {theory.width:.2f} beads, {width:.3f} at half the maximum.",
        correction=f"{exact.width:.3f} beads: the wave of the discrete chain is an eighth narrower.",
    )
    for place, power, root in (
        (0, 0.2, "fifth root of the velocity of the beads"),
        (2, 1.0 / 6.0, "sixth root of the force"),
    ):
        exponents = {engine: exponent(columns[1], columns[place]) for engine, columns in train.items()}
        yield state(
            MeasuredQuantity("exponent", exponents, near(power, 0.002), "4"),
            published=f"The speed grows as the {root}.",
            source="nesterenko1983",
        )


def _draw_nesterenko(axis: Axes, results: Results) -> None:
    """Speed over force."""
    _, speed, force = _train(results["striker-4"]["lammps"])
    axis.loglog(force, speed, "o", color=COLOURS[0], label="pulses of a train (LAMMPS)")
    every = np.geomspace(force.min(), force.max(), 50)
    axis.loglog(every, speed[0] * (every / force[0]) ** (1.0 / 6.0), label="sixth root of the force", **PUBLISHED)


NESTERENKO = Entry(
    title="Nesterenko's solitary wave",
    introduction="The long-wave theory of an uncompressed chain, whose sound speed is zero: compact waves whose "
    "speed grows with their amplitude. A single kicked chain, and a striker of four beads' mass, which makes a "
    "train of them.",
    sources={
        "nesterenko1983": "long-wave theory, derived again in analysis/shape/exact_wave.py",
        "nesterenko2001": "long-wave theory",
        "coste1997": "abstract read: agreement with experiments without free parameter",
    },
    scenes={"single": chain(100, 125, every=0.05), "striker-4": chain(200, 200, striker={"mass": 4, "velocity": 1})},
    statements=_nesterenko,
    axes=("largest contact force $F / (m V / T)$", "speed $c\\,T$ (beads)"),
    draw=_draw_nesterenko,
    caption="Speed of the pulses of one train over their force.",
)

# --- the exact wave ---------------------------------------------------------------------------------------------------

RESOLVED = {"lammps": 1e-11, "reference": 1e-200}
"""Least velocity that an engine resolves, in units of V; LAMMPS rounds overlaps with positions."""

SERIES = (2.39536, 0.268529, 0.0061347)


def _series(xi: Floats) -> Floats:
    """Displacement of a bead over its final one, [frame], at distances (beads) ahead of the wave's middle, [frame]."""
    return np.asarray(0.5 * (1.0 - np.tanh(0.5 * sum(c * xi ** (2 * k + 1) for k, c in enumerate(SERIES)))))


def _deviation(run: Ran) -> tuple[Floats, Floats]:
    """Distance of `BEAD` ahead of the wave, and displacement by the series minus that of the run over the final one."""
    xi = run.speed(BEAD - 10, BEAD + 10) * (run.arrival(BEAD) - run.trajectory.time)
    close = np.abs(xi) < 4.0
    shift = exact_wave.solitary_wave().shift_at(run.peak(BEAD))
    return xi[close], _series(xi[close]) - run.trajectory.displacement[close, 0, BEAD - 1] / shift


def _tail(run: Ran) -> Floats:
    """Factor by which the logarithm of the velocity falls faster from bead to bead ahead of the wave, [bead]."""
    frame = int(np.argmin(np.abs(run.trajectory.time - run.arrival(BEAD))))
    ahead = np.abs(run.trajectory.velocity[frame, 0, BEAD : BEAD + 9])
    steps = np.diff(np.log(ahead[ahead > RESOLVED[run.engine]]))
    return np.asarray(steps[1:] / steps[:-1])


def _exact(results: Results) -> Statements:
    """The series, the tails, the shape."""
    runs, exact = results["chain"], exact_wave.solitary_wave()
    series, tails = each(lambda run: np.max(np.abs(_deviation(run)[1])), runs), each(_tail, runs)
    rise, last = float(np.max(np.diff(tails["reference"]))), float(tails["reference"][-1])
    yield state(
        MeasuredQuantity("largest difference, in A", series, at_most(5e-4), "6"),
        published="The displacement of a bead is A/2 (1 - tanh(f/2)), f = 2.39536 x + 0.268529 x^3 + 0.0061347 "
        "x^5 (x in beads).",
        source="sen2001, as quoted",
    )
    yield state(
        MeasuredQuantity("factor at the farthest bead", {"reference": last}, near(1.5, 0.03), "3"),
        MeasuredQuantity("largest change of the factor from bead to bead", {"reference": rise}, at_most(0.0), "3"),
        published="The tails of the wave fall off super-exponentially.",
        source="ahnert2009, abstract",
        derived="With each bead farther ahead of the wave the logarithm of the velocity falls faster, by a "
        "factor that decreases to the exponent 3/2 of the contact force.",
        also=by_engine(tails, lambda tail: ", ".join(f"{value:.3f}" for value in tail), "factors, "),
    )
    yield state(
        MeasuredQuantity("speed over V_m^(1/5)", each(_speed, runs), near(exact.speed, 2e-5), "6"),
        published="The travelling-wave equation c^2 r = Lambda * r^(3/2) is solved by iteration.",
        source="ahnert2009, abstract",
        derived=f"The iteration converges to c = {exact.speed:.6f} V_m^(1/5) beads per unit time.",
    )


def _draw_exact(axis: Axes, results: Results) -> None:
    """The difference of the series."""
    axis.plot(*_deviation(results["chain"]["lammps"]), color=COLOURS[0], label="series minus LAMMPS")
    axis.axhline(0.0, color="0.8", linewidth=0.8, zorder=0)


EXACT_WAVE = Entry(
    title="The exact wave of the discrete chain",
    introduction="Properties of the travelling wave of the discrete chain: a series fitted by Sen & Manciu, its "
    "tails, and its speed.",
    sources={
        "sen2001": "as quoted in the literature; the paper could not be read",
        "sen2001solution": "as quoted in the literature; the paper could not be read",
        "ahnert2009": "abstract read",
        "english2005": "travelling-wave equation",
    },
    scenes={"chain": chain(100, 125)},
    statements=_exact,
    axes=("distance ahead of the wave (beads)", "difference / final displacement $A$"),
    draw=_draw_exact,
    caption="Difference of the displacement by the series from that by LAMMPS, as a share of the final displacement.",
)

# --- trains -----------------------------------------------------------------------------------------------------------

PASSED, LEAST = 110, 0.05
"""Bead that trains pass, and the least velocity of a wave that counts."""

LAUNCHED = {f"launched-{count}": count for count in (2, 3)}


def _trains(results: Results) -> Statements:
    """Number of waves, equal to that of the beads launched; nearly geometric decrease after a heavy striker."""
    trains = {
        name: each(lambda run: run.survey.train(1, PASSED, LEAST).peak_velocity, runs) for name, runs in results.items()
    }
    count = {
        name: {engine: len(velocities) for engine, velocities in by_engines.items()}
        for name, by_engines in trains.items()
    }
    lines = {
        name: by_engine(by_engines, lambda train: ", ".join(f"{v:.5f}" for v in train) + " V")
        for name, by_engines in trains.items()
    }
    ratios = {engine: velocities[1:] / velocities[:-1] for engine, velocities in trains["striker-4"].items()}
    spread = {engine: float(np.ptp(ratio) / np.mean(ratio)) for engine, ratio in ratios.items()}
    steepest = {engine: float(ratio.max()) for engine, ratio in ratios.items()}
    for name, beads in LAUNCHED.items():
        yield state(
            MeasuredQuantity("number of waves", count[name], near(beads, 0.0), "0"),
            published="When m grains hit a chain, m solitons are generated.",
            source="multisoliton2003, abstract",
            derived=f"m = {beads}; counted at bead {PASSED}, from {LEAST} V on.",
            also=lines[name],
        )
    yield state(
        MeasuredQuantity("number of waves", count["striker-4"], at_least(4.0), "0"),
        MeasuredQuantity("largest ratio of a wave to the one before", steepest, at_most(1.0), "3"),
        published="The impact of a large striker generates a train of solitary waves ordered by decreasing amplitude.",
        source="job2007, abstract",
        also=lines["striker-4"],
    )
    yield state(
        MeasuredQuantity("range of the ratios over their mean", spread, at_most(0.1, 0.25), "3"),
        published="The force at the end of the chain unloads nearly exponentially.",
        source="job2007, abstract",
        derived="Velocities of the train form nearly a geometric series.",
        correction=f"Ratios differ by {spread['reference']:.0%}.",
        also=["ratios " + ", ".join(f"{value:.3f}" for value in ratios["reference"])],
    )


def _draw_trains(axis: Axes, results: Results) -> None:
    """Velocity of a bead over time."""
    for place, (name, runs) in enumerate(results.items()):
        run = runs["lammps"].trajectory
        axis.plot(run.time, run.velocity[:, 0, PASSED - 1], label=name, **line(place))
    axis.set_xlim(100.0, 220.0)


STRIKER_TRAINS = Entry(
    title="Trains of waves from heavy strikers",
    introduction="A striker of four beads' mass, and two or three beads launched together.",
    sources={
        "multisoliton2003": "abstract read; authors not known here",
        "job2007": "abstract read",
    },
    scenes={
        "striker-4": chain(200, 220, striker={"mass": 4, "velocity": 1}),
        **{
            name: chain(200, 220, kick=[{"bead": bead, "velocity": 1.0} for bead in range(1, count + 1)])
            for name, count in LAUNCHED.items()
        },
    },
    statements=_trains,
    axes=("time $t / T$", f"velocity of bead {PASSED} $v / V$"),
    draw=_draw_trains,
    caption=f"Velocity of bead {PASSED} as trains pass it (LAMMPS).",
)
