"""Chains whose beads or contacts change along them: tapered and graded ones, and a single impurity."""

import math
from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes

from granchain.parts import exact_wave, laws, physics
from workflow.plugins.gallery.criteria import MeasuredQuantity, at_least, at_most, by_engine, near, state
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

# --- tapered chains ---------------------------------------------------------------------------------------------------

BEADS = 20
TAPERS = {f"taper-{taper:g}": taper for taper in (0.02, 0.05, 0.08)}
FIRST, LAST = 5, 15


def _hard_spheres(taper: float) -> float:
    """Share of the kick's energy that the last of twenty hard spheres gets by successive binary collisions."""
    f = (1.0 - taper) ** 3
    return float((4.0 * f / (1.0 + f) ** 2) ** (BEADS - 1))


def _arrives(run: Ran) -> float:
    """Largest kinetic energy of the last bead over the energy of the kick."""
    mass = physics.mass_of(run.problem.system, slice(None), -1)
    return float(np.max(0.5 * mass * run.trajectory.velocity[:, :, -1] ** 2) / physics.energy(run.problem.system))


def _tapered(results: Results) -> Statements:
    """Energy that arrives, and growth of the velocities."""
    for name, taper in TAPERS.items():
        share = _hard_spheres(taper)
        yield state(
            MeasuredQuantity("share of the energy", each(_arrives, results[name]), near(share, 0.005, 0.06), "4"),
            published="Hard spheres: the last of n beads gets [4 f / (1 + f)^2]^(n - 1) of the energy.",
            source="doney2005, as quoted",
            derived=f"n = {BEADS}, each {taper:.0%} smaller, f = (1 - {taper:g})^3: {share:.4f}, taken for Hertzian "
            "beads.",
            correction="Hard spheres transmit too much: Hertzian beads share their energy with neighbours.",
        )
    falls = {
        f"share at {TAPERS[larger]:.0%} over that at {TAPERS[smaller]:.0%}": each(
            lambda small, large: _arrives(large) / _arrives(small), results[smaller], results[larger]
        )
        for smaller, larger in pairwise(TAPERS)
    }
    yield state(
        *(MeasuredQuantity(name, fall, at_most(1.0), "4") for name, fall in falls.items()),
        derived="The larger the taper, the smaller the share of the energy that arrives.",
    )
    for name, taper in TAPERS.items():
        growth = (2.0 / (1.0 + (1.0 - taper) ** 3)) ** (LAST - FIRST)
        ratio = each(lambda run: run.peak(LAST) / run.peak(FIRST), results[name])
        yield state(
            MeasuredQuantity("ratio of the velocities", ratio, near(growth, 0.01 * growth, 0.2 * growth), "4"),
            published="The binary collision approximation gives quantitatively accurate results.",
            source="harbola2009, abstract",
            derived=f"Taper {taper:.0%}: from bead {FIRST} to {LAST} the velocity grows by the factor {growth:.4f}; "
            "required within 1%.",
            correction="The trend is right, the number too large: beads do not collide in pairs.",
        )


def _draw_tapered(axis: Axes, results: Results) -> None:
    """Energy that arrives over the taper."""
    every = np.linspace(0.0, 0.09, 50)
    axis.plot(every, [_hard_spheres(taper) for taper in every], label="hard spheres", **PUBLISHED)
    energies = [_arrives(results[name]["lammps"]) for name in TAPERS]
    axis.plot([*TAPERS.values()], energies, "o", color=COLOURS[0], label="LAMMPS")


TAPERED = Entry(
    title="Tapered chains",
    introduction="Twenty beads, each smaller than the one before by the same share: a shock absorber.",
    sources={
        "doney2005": "could not be read; the formula follows from two-body collisions",
        "harbola2009": "abstract read: binary collisions quantitatively accurate",
        "machado2013": "abstract read: trends right, energies and momenta not in good quantitative agreement",
    },
    scenes={name: chain(BEADS, 25, timestep=0.002, every=0.02, taper=taper) for name, taper in TAPERS.items()},
    statements=_tapered,
    axes=("taper (decrease of the radius from bead to bead)", "largest energy of bead 20 / energy of the kick"),
    draw=_draw_tapered,
    caption="Largest kinetic energy of bead 20 as a share of that of the kick; the line is for hard spheres.",
)

# --- graded contacts --------------------------------------------------------------------------------------------------

STRONGEST = 4.0
"""Strength behind the ramp, over that before it."""

RAMPS = {"ramp-100": (50, 150), "ramp-10": (100, 110), "jump": (100, 101)}
"""Contacts at which the ramp begins and ends."""

BEFORE, BEHIND = 40, 200
"""Beads, and contacts, at which the pulse is measured."""


def _change(run: Ran) -> float:
    """Relative change of the peak velocity across the ramp."""
    return run.peak(BEHIND) / run.peak(BEFORE) - 1.0


def _force_exponent(run: Ran) -> float:
    before, behind = run.forces(contacts=(BEFORE, BEHIND)).largest[0]
    return math.log(behind / before) / math.log(STRONGEST)


def _speed_exponent(run: Ran) -> float:
    ratio = run.speed(BEHIND - 20, BEHIND + 20) / run.speed(BEFORE - 15, BEFORE)
    return math.log(ratio) / math.log(STRONGEST)


def _graded(results: Results) -> Statements:
    """Velocity, force and speed behind a slow ramp; change of the velocity by steeper ones."""
    source, slow = "chaunsali2018, abstract", results["ramp-100"]
    yield state(
        MeasuredQuantity("change of the peak velocity", each(_change, slow), near(0.0, 2e-3)),
        published="The gradient in stiffness accelerates the impulse wave without a significant scattering.",
        source=source,
        derived="A pulse that keeps its momentum and energy keeps its velocity V_m, as all beads have one mass.",
    )
    yield state(
        MeasuredQuantity("exponent", each(_force_exponent, slow), near(0.4, 1e-3), "4"),
        published="The gradient in stiffness results in the scaling of contact forces along the chain.",
        source=source,
        derived="F_m grows as A^(2/5) V_m^(6/5), so as A^0.4.",
    )
    yield state(
        MeasuredQuantity("exponent", each(_speed_exponent, slow), near(0.4, 1e-3), "4"),
        derived="The speed grows as A^(2/5) V_m^(1/5), so as A^0.4.",
    )
    for name, contacts in (("ramp-10", "10 contacts"), ("jump", "1 contact")):
        yield state(
            MeasuredQuantity("change of the peak velocity", each(_change, results[name]), near(0.0, 2e-3, 0.1)),
            derived=f"A ramp over {contacts} does not change the velocity.",
            correction="The pulse is about five beads long: a shorter ramp scatters it.",
        )


def _draw_graded(axis: Axes, results: Results) -> None:
    """Local speed over local strength."""
    run = results["ramp-100"]["lammps"]
    waves, strength = run.waves.of_chain(1), np.asarray(laws.strength(run.problem.system.along[0].law))[0]
    inside = (waves.bead > 30) & (waves.bead < 160)
    at = strength[waves.bead[inside] - 1]
    axis.loglog(at, waves.speed[inside], "o", markersize=3, color=COLOURS[0], label="LAMMPS")
    every = np.geomspace(1.0, STRONGEST, 50)
    axis.loglog(every, run.speed(BEFORE - 15, BEFORE) * every**0.4, label=r"$\propto$ strength$^{0.4}$", **PUBLISHED)


GRADED = Entry(
    title="Graded contacts",
    introduction="Contacts become four times as stiff along the chain, as between cylinders whose crossing angle "
    "changes: the pulse keeps its velocity, and becomes faster and stronger.",
    sources={"chaunsali2018": "abstract read: acceleration without significant scattering, scaling of forces"},
    scenes={
        name: chain(260, 293, contact={"strength": {"from": 1.0, "to": STRONGEST, "contacts": [*ends]}})
        for name, ends in RAMPS.items()
    },
    statements=_graded,
    axes=("strength of the contact / strength of the first", "speed $c\\,T$ (beads)"),
    draw=_draw_graded,
    caption="Speed of the leading pulse over the strength of the contacts that it passes; ramp over 100 contacts.",
)

# --- an impurity ------------------------------------------------------------------------------------------------------

LIGHT = {f"mass-{mass:g}": mass for mass in (0.05, 0.1, 0.2)}
HEAVY = {f"mass-{mass:g}": mass for mass in (2.0, 8.0)}
PLACE = 40


def _with_impurity(mass: float) -> dict[str, object]:
    other = {"chain": 1, "bead": PLACE, "kind": "other"}
    return chain(90, 100, timestep=0.002, every=0.05, kinds={"other": {"mass": mass}}, replace=other)


def _frequency(run: Ran) -> float:
    """Frequency (1 / T) of the first oscillation of the impurity, during the largest load of the wave."""
    first, second = run.passages(PLACE)[:2]
    return float(1.0 / (second - first))


def _passed(run: Ran) -> float:
    """Transmitted over incident velocity."""
    return run.peak(70) / run.peak(PLACE - 15)


def _impurity(results: Results) -> Statements:
    """Light beads oscillate, heavy ones reflect."""
    light = [results[name] for name in LIGHT]
    width = exact_wave.solitary_wave().width
    above = each(lambda run: _frequency(run) / (float(run.speed(60, 75)) / width), results["mass-0.1"])
    slope = each(lambda *runs: exponent(np.array([*map(_frequency, runs)]), np.array([*LIGHT.values()])), *light)
    yield state(
        MeasuredQuantity(
            "frequency of mass 0.1 over one over the time in which the wave passes", above, at_least(1.0), "2"
        ),
        published="A light intruder oscillates while the wave passes, at frequencies above the wave's spectrum.",
        source="job2009, abstract",
        also=[
            line
            for name, mass in LIGHT.items()
            for line in by_engine(each(_frequency, results[name]), "{:.4f} 1/T".format, f"mass {mass:g}, ")
        ],
    )
    yield state(
        MeasuredQuantity("exponent", slope, near(-0.5, 0.02, 0.1), "3"),
        published="The frequency follows from dimensional analysis.",
        source="job2009, abstract",
        derived="Contacts of unchanged stiffness: frequency as mass^(-1/2).",
        correction=f"mass^({slope['reference']:.2f}): the lightest bead remains longest within one wave.",
    )
    two, eight = (results[name] for name in HEAVY)
    weaker = each(lambda lighter, heavier: _passed(heavier) / _passed(lighter), two, eight)
    yield state(
        MeasuredQuantity("mass 2: transmitted over incident velocity", each(_passed, two), at_most(1.0)),
        MeasuredQuantity("mass 8: the same, over that of mass 2", weaker, at_most(1.0)),
        derived="A heavy bead reflects part of the wave, the more the heavier it is, and transmits a train of "
        "weaker waves.",
    )


def _draw_impurity(axis: Axes, results: Results) -> None:
    """The impurities over time."""
    for place, mass in enumerate((0.1, *HEAVY.values())):
        run = results[f"mass-{mass:g}"]["lammps"].trajectory
        axis.plot(run.time, run.velocity[:, 0, PLACE - 1], label=f"mass {mass:g}", **line(place))
    axis.set_xlim(42.0, 65.0)


IMPURITY = Entry(
    title="An impurity",
    introduction="One bead of another mass in an otherwise uniform chain; its contacts are those of the other beads.",
    sources={"job2009": "abstract read; its intruders are smaller, not only lighter"},
    scenes={name: _with_impurity(mass) for name, mass in (LIGHT | HEAVY).items()},
    statements=_impurity,
    axes=("time $t / T$", "velocity of the impurity $v / V$"),
    draw=_draw_impurity,
    caption="A light impurity oscillates several times while the wave passes; heavy ones move slowly (LAMMPS).",
)
