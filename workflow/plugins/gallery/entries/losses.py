"""Contacts that lose energy: they yield, or have dashpots, linear ones or those of viscoelastic spheres."""

import functools
import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from granchain.parts import Floats, laws
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

# --- contacts that yield ----------------------------------------------------------------------------------------------

RATIOS = {f"pair-{number}": ratio for number, ratio in enumerate((0.5, 5.0, 50.0, 500.0, 5000.0), 1)}
"""Scene -> velocity of approach over that at which two beads yield."""

YIELD = {"yield": {"overlap": 0.1}}
TWO: dict[str, Any] = {"chains": 2, "coupling": {"stiffness": 0.1}}


def _onset(ratio: float) -> float:
    """Overlap at yield of beads that meet with V: ``v_y^2 = 0.8 A delta_y^2.5 / mu`` with mu = 1/2."""
    return float((ratio**-2 / 1.6) ** 0.4)


def _restitution(run: Ran) -> float:
    first, second = run.trajectory.velocity[-1, 0]
    return float(second - first)


def _law(run: Ran) -> Any:
    """Law of the contacts, with their largest overlaps so far at the end."""
    return run.trajectory.system_at(-1).along[0].law


def _worst(*runs: Ran) -> float:
    """Largest deviation of the restitution of the pairs from the closed form."""
    return max(
        abs(_restitution(run) - float(_law(run).restitution_at(ratio, 1.0)))
        for run, ratio in zip(runs, RATIOS.values(), strict=True)
    )


def _force_exponent(first: int, last: int, run: Ran) -> float:
    """Exponent of the largest force as a power of the number of the contact, from a contact to another."""
    law = _law(run)
    force = laws.whole_force(law, laws.turning_overlap(law))[0]
    return exponent(force[first - 1 : last - 1], np.arange(float(first), last))


def _agree(run: Ran) -> float:
    """Bead from which on the amplitudes of both chains agree to 1 % up to bead 100."""
    waves = (run.waves.of_chain(number) for number in (1, 2))
    first, second = (wave.peak_velocity[(wave.bead >= 4) & (wave.bead <= 100)] for wave in waves)
    apart = np.flatnonzero(np.abs(first - second) > 0.005 * (first + second))
    return float(apart[-1] + 5)


def _plastic(results: Results) -> Statements:
    """Restitution, decay, trains, and equipartition."""
    worst = each(_worst, *(results[name] for name in RATIOS))
    slope = each(
        lambda slow, fast: math.log(_restitution(fast) / _restitution(slow)) / math.log(10.0),
        *(results[name] for name in ("pair-4", "pair-5")),
    )
    single, plastic, elastic = (results[name] for name in ("chain", "two-plastic", "two-elastic"))
    early, late = (each(functools.partial(_force_exponent, *ends), single) for ends in ((5, 20), (60, 80)))
    amplitude = MeasuredQuantity(
        "amplitude at bead 100", each(lambda run: run.peak(100), plastic), near(0.0641, 5e-4), "4 V"
    )
    yield state(
        MeasuredQuantity("largest deviation from Thornton's closed form", worst, at_most(1e-3), "1e"),
        derived="The restitution of two beads follows from their velocity over that at yield, over four decades.",
    )
    yield state(
        MeasuredQuantity("exponent between 500 and 5000 times the velocity at yield", slope, near(-0.25, 2e-3), "4"),
        derived="Far beyond yield the restitution falls as v^(-1/4).",
    )
    yield state(
        MeasuredQuantity(
            "pulses that pass bead 40",
            each(lambda run: run.survey.train(1, 40, 0.01).pulses, single),
            at_least(2.0),
            "0",
        ),
        published="In elasto-plastic chains energy dissipation leads to the formation of wave trains.",
        source="pal2013, abstract",
    )
    yield state(
        MeasuredQuantity("exponent, contacts 5 to 20", early, at_most(-0.6), "3"),
        MeasuredQuantity("contacts 60 to 80", late, at_least(-0.5), "3"),
        derived="The largest force falls along the chain, and the more slowly the nearer its overlap comes to that "
        "at yield, below which no energy is lost: there is no one power law.",
    )
    yield state(
        MeasuredQuantity("bead from which on amplitudes agree to 1 %", each(_agree, plastic), near(33.0, 1.0), "0"),
        MeasuredQuantity("of elastic chains", each(_agree, elastic), near(62.0, 1.0), "0"),
        derived="Two coupled plastic chains reach equipartition, and earlier than elastic ones: the larger wave "
        "loses more.",
        also=[amplitude.line()],
    )


def _draw_plastic(axis: Axes, results: Results) -> None:
    """Restitution over velocity."""
    every = np.geomspace(0.3, 1e4, 200)
    law = _law(next(iter(results["chain"].values())))
    axis.loglog(every, law.restitution_at(every, 1.0), label="Thornton, closed form", **PUBLISHED)
    for engine, colour, mark in zip(NAMES, COLOURS, "ox", strict=False):
        restitutions = [_restitution(results[name][engine]) for name in RATIOS]
        axis.loglog([*RATIOS.values()], restitutions, mark, color=colour, label=NAMES[engine])


PLASTIC = Entry(
    title="Contacts that yield",
    introduction="Elastic, perfectly plastic spheres: two that collide, a kicked chain whose wave decays, and two "
    "coupled chains (kappa = 0.1), of which one is kicked; overlap at yield 0.1 L.",
    sources={
        "thornton1997": "title read; the restitution is derived here from the law",
        "pal2013": "abstract read: formation and merging of wave trains, scaling laws",
    },
    scenes={
        **{name: chain(2, 12, contact={"yield": {"overlap": _onset(ratio)}}) for name, ratio in RATIOS.items()},
        "chain": chain(100, 175, timestep=0.02, contact=YIELD),
        "two-plastic": chain(112, 195, timestep=0.02, contact=YIELD, **TWO),
    },
    swept={"two-elastic": chain(130, 170, timestep=0.02, **TWO)},
    statements=_plastic,
    axes=("velocity of approach / velocity at yield", "restitution"),
    draw=_draw_plastic,
    caption="Restitution of two equal beads over four decades of velocity.",
)

# --- dashpots ---------------------------------------------------------------------------------------------------------

BEADS = np.arange(40, 101)


def _slope(power: float, coefficient: float, run: Ran) -> float:
    """Slope of a power of the peak velocity over beads, divided by the coefficient of the dashpots."""
    return float(np.polyfit(BEADS, run.peaks(BEADS) ** power, 1)[0]) / coefficient


WEAK, TWO_WAVES, STRONG = 0.002, 0.02, 1.0
WHEN = 120.0


def _along(run: Ran) -> Floats:
    """Velocity (V) of the beads at the time `WHEN`, [bead]."""
    frame = int(np.argmin(np.abs(run.trajectory.time - WHEN)))
    return np.asarray(run.trajectory.velocity[frame, 0])


def _tops(run: Ran) -> list[tuple[int, float]]:
    """Maxima of the velocity along the chain at the time `WHEN`: bead and velocity (V), the foremost first."""
    row = _along(run)
    tops = np.flatnonzero((row[1:-1] > row[:-2]) & (row[1:-1] >= row[2:]) & (row[1:-1] > 5e-3)) + 1
    return [(int(place) + 1, float(row[place])) for place in tops[::-1]]


def _rosas(results: Results) -> Statements:
    """The second wave, strong damping, weak damping."""
    weak, two, strong = (results[f"damping-{damping:g}"] for damping in (WEAK, TWO_WAVES, STRONG))
    maxima = "maxima of the velocity along the chain"
    second = each(lambda run: _tops(run)[-1][1] / _tops(run)[0][1], two)
    yield state(
        MeasuredQuantity(maxima, each(lambda run: len(_tops(run)), two), near(2.0, 0.0), "0"),
        MeasuredQuantity("last over first maximum", second, at_most(1.0), "3"),
        published="At low viscosity the disturbance has two parts: an attenuating solitary wave and a broad "
        "wave behind it.",
        source="rosas2008, abstract",
        derived=f"Here at a coefficient of {TWO_WAVES:g}.",
        also=by_engine(each(_tops, two), _said),
    )
    yield state(
        MeasuredQuantity(maxima, each(lambda run: len(_tops(run)), strong), near(1.0, 0.0), "0"),
        published="Beyond a critical viscosity the two waves merge into one with a monotonic front.",
        source="rosas2007, abstract",
        derived=f"Here at a coefficient of {STRONG:g}; the critical value is not in the abstract.",
        also=by_engine(each(_tops, strong), _said),
    )
    yield state(
        MeasuredQuantity(
            "slope over the coefficient", each(functools.partial(_slope, 0.2, WEAK), weak), near(-0.10586, 1e-3, 2e-3)
        ),
        derived="For weak damping the peak velocity to the power 1/5 falls linearly along the chain, by 0.10586 "
        f"times the coefficient a bead (exact wave; here {WEAK:g}).",
        correction="Derived for vanishing damping; at this one the amplitude lost is 1% less.",
    )


def _said(tops: list[tuple[int, float]]) -> str:
    return ", ".join(f"{value:.4f} V at bead {bead}" for bead, value in tops)


def _draw_rosas(axis: Axes, results: Results) -> None:
    """Velocity over distance."""
    for place, damping in enumerate((TWO_WAVES, STRONG)):
        run = results[f"damping-{damping:g}"]["lammps"]
        velocity = _along(run)
        forwards = np.where(velocity > 0.0, velocity, np.nan)  # others have no logarithm
        axis.semilogy(run.trajectory.beads, forwards, label=f"damping {damping:g}", **line(place))
    axis.set_ylim(bottom=1e-4)


ROSAS = Entry(
    title="Dissipation: a second wave",
    introduction="Linear dashpots in the contacts of a kicked chain.",
    sources={
        "rosas2007": "abstract read",
        "rosas2008": "abstract read; the critical viscosity is not in it",
    },
    scenes={
        f"damping-{damping:g}": chain(140, 130, damping={"contact": damping}) for damping in (WEAK, TWO_WAVES, STRONG)
    },
    statements=_rosas,
    axes=("bead", f"velocity $v / V$ at $t$ = {WHEN:g} $T$"),
    draw=_draw_rosas,
    caption="Velocity along the chain: a narrow pulse and a broad one behind it, or a single one (LAMMPS).",
)

VISCOELASTIC = {f"viscoelastic-{coefficient:g}": coefficient for coefficient in (0.01, 0.002)}


def _kuwabara_kono(results: Results) -> Statements:
    """Rise of the peak velocity to the power -1/5 along the chain."""
    for name, coefficient in VISCOELASTIC.items():
        rise = each(functools.partial(_slope, -0.2, coefficient), results[name])
        yield state(
            MeasuredQuantity("rise a bead over the coefficient", rise, near(0.07577, 1e-3, 4e-3)),
            derived="For weak damping the peak velocity to the power -1/5 rises linearly along the chain, by "
            f"0.07577 times the coefficient a bead (exact wave; here {coefficient:g}).",
            correction="Derived for vanishing damping.",
        )


def _draw_kuwabara_kono(axis: Axes, results: Results) -> None:
    """Peak velocity to the power -1/5 over beads."""
    for place, (name, coefficient) in enumerate(VISCOELASTIC.items()):
        power = results[name]["lammps"].peaks(BEADS) ** -0.2
        axis.plot(BEADS, power, label=f"coefficient {coefficient:g}", **line(place))


KUWABARA_KONO = Entry(
    title="Viscoelastic contacts",
    introduction="Dashpots in the contacts as of viscoelastic spheres: b overlap^(1/2) times the rate of overlap.",
    sources={
        "kuwabara1987": "the law; could not be read",
        "brilliantov1996": "the law; could not be read",
    },
    scenes={
        name: chain(120, 130, damping={"contact": coefficient, "law": "viscoelastic"})
        for name, coefficient in VISCOELASTIC.items()
    },
    statements=_kuwabara_kono,
    axes=("bead", r"peak velocity $(v_\mathrm{max} / V)^{-1/5}$"),
    draw=_draw_kuwabara_kono,
    caption="Peak velocity to the power -1/5 along the chain (LAMMPS).",
)
