"""Impacts by which codes of the discrete element method are verified: tests 1 to 3 of Chung and Ooi (2011)."""

import functools
import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from scipy.special import beta

from granchain.parts import Floats, forces
from workflow.plugins.gallery.criteria import NAMES, MeasuredQuantity, at_most, near, state
from workflow.plugins.gallery.entry import COLOURS, PUBLISHED, Entry, Ran, Results, Statements, each

SOURCES = {
    "chung2011": "could not be read: radii, velocities and materials are those of input files of Yade and PySPH that "
    "follow it, forces and durations those of its figures as digitised for PySPH",
    "johnson1985": "Hertz's theory of impact, section 11.4",
}
ACCURACY = 1e-5
WITHIN = 1e-4
"""Largest accepted relative deviation from Hertz's theory."""

FRAMES = 400
"""Frames while the spheres touch."""

DURATION = 0.8 * float(beta(0.4, 0.5))
"""Duration of a contact in largest overlap over velocity, 2.943: twice the integral of ``(1 - x**2.5)**-0.5``."""


@dataclass(frozen=True)
class Impact:
    """A normal impact of two equal spheres, or of one on a rigid plane, with its values by Hertz's theory, in SI."""

    radius: float
    velocity: float
    modulus: float
    ratio: float
    density: float
    plane: bool

    @property
    def _mass(self) -> float:
        """Reduced mass: that of the sphere before a plane, half of it before another sphere."""
        return 4.0 / 3.0 * math.pi * self.radius**3 * self.density * (1.0 if self.plane else 0.5)

    @property
    def _constant(self) -> float:
        """Contact constant ``4/3 E* R*^(1/2)``; two spheres have half the modulus and half the radius."""
        modulus = self.modulus / (1.0 - self.ratio**2)
        return 4.0 / 3.0 * modulus * math.sqrt(self.radius) * (1.0 if self.plane else 0.5**1.5)

    @property
    def overlap(self) -> float:
        """Largest overlap in m."""
        return float((1.25 * self._mass * self.velocity**2 / self._constant) ** 0.4)

    @property
    def force(self) -> float:
        """Largest force in N."""
        return float(self._constant * self.overlap**1.5)

    @property
    def duration(self) -> float:
        """Duration of the contact in s."""
        return DURATION * self.overlap / self.velocity

    def scene(self, **keys: object) -> dict[str, object]:
        """Scene of two spheres that touch and approach, or of one a gap before a plane, with an idle one behind it."""
        material = {"radius": self.radius, "density": self.density, "youngs_modulus": self.modulus}
        common = {"beads": 2, "material": material | {"poisson_ratio": self.ratio}, "accuracy": ACCURACY, **keys}
        every = self.duration / FRAMES
        if not self.plane:
            kick = [{"bead": bead, "velocity": sign * 0.5 * self.velocity} for bead, sign in ((1, 1.0), (2, -1.0))]
            return common | {"kick": kick, "duration": 1.2 * self.duration, "output": {"every": every}}
        kick, gap = [{"bead": 2, "velocity": self.velocity}], 2.0 * self.overlap
        end = gap / self.velocity + 1.5 * self.duration
        return common | {
            "kick": kick, "gap": gap, "walls": {"right": "rigid"}, "duration": end, "output": {"every": every}
        }  # fmt: skip


def _readings(run: Ran) -> forces.Readings:
    """Readings of the force between the spheres, or on the plane."""
    plane = bool(run.scene.gap)
    return run.forces(contacts=() if plane else (1,), wall=plane)


def _largest(run: Ran) -> float:
    """Largest force in N."""
    return float(_readings(run).largest[0, 0] * run.problem.scale.force)


def _duration(run: Ran) -> float:
    """Duration of the contact in s."""
    return float(_readings(run).dwell[0, 0] * run.problem.scale.time)


def _approach(run: Ran) -> Floats:
    """Approach of the spheres, or to the plane, in m, [frame]; negative where they do not touch."""
    first, second = run.trajectory.displacement[:, 0].T * run.problem.scale.length
    return np.asarray(second - run.scene.gap if run.scene.gap else first - second)


def _overlap(run: Ran) -> float:
    """Largest overlap in m."""
    return float(np.max(_approach(run)))


def _words(material: str) -> str:
    """Name of a material in a sentence."""
    return material.replace("-", " ")


def _deviation(impact: Impact, run: Ran) -> float:
    """Largest relative deviation of force, overlap and duration from Hertz's theory."""
    ratios = _largest(run) / impact.force, _overlap(run) / impact.overlap, _duration(run) / impact.duration
    return max(abs(ratio - 1.0) for ratio in ratios)


@dataclass(frozen=True)
class PublishedCurve:
    """Largest force in kN and duration in microseconds of a published curve, and half a unit of its last digit."""

    force: float
    duration: float
    digit: float


def _elastic(impacts: Mapping[str, Impact], curves: Mapping[str, PublishedCurve], results: Results) -> Statements:
    """Forces and durations against the published ones; forces, durations and overlaps against Hertz's theory."""
    for name, impact in impacts.items():
        curve, runs, material = curves[name], results[name], _words(name)
        force = each(lambda run: _largest(run) / 1000.0, runs)
        duration = each(lambda run: 1e6 * _duration(run), runs)
        deviation = each(functools.partial(_deviation, impact), runs)
        yield state(
            MeasuredQuantity("largest force", force, near(curve.force, 0.05), "3 kN"),
            MeasuredQuantity("duration of the contact", duration, near(curve.duration, curve.digit), "2 us"),
            published=f"{material}: the force reaches {curve.force:g} kN, and the contact lasts {curve.duration:g} us.",
            source="chung2011, curves of its figures as digitised by others",
        )
        yield state(
            MeasuredQuantity("largest relative deviation of the three", deviation, at_most(WITHIN), "1e"),
            published="Hertz's theory of impact, with the reduced mass m: largest overlap d = (5 m v^2 / (4 A))^(2/5), "
            "largest force A d^(3/2), duration of the contact 2.943 d / v.",
            source="johnson1985, section 11.4",
            derived=f"{material}: {impact.overlap * 1e6:.3f} um, {impact.force:.1f} N, {impact.duration * 1e6:.3f} us.",
        )


def _draw_elastic(impacts: Mapping[str, Impact], axis: Axes, results: Results) -> None:
    """Force over overlap, and the largest ones by Hertz's theory."""
    for colour, (name, impact) in zip(COLOURS, impacts.items(), strict=False):
        run, material = results[name]["lammps"], _words(name)
        force = _readings(run).force[:, 0, 0] * run.problem.scale.force
        overlap = np.maximum(_approach(run), 0.0)
        axis.plot(overlap * 1e6, force / 1000.0, color=colour, label=f"{material}, LAMMPS")
        axis.plot(impact.overlap * 1e6, impact.force / 1000.0, "o", color=colour, label=f"{material}, Hertz's theory")


def _entry(title: str, introduction: str, impacts: Mapping[str, Impact], curves: Mapping[str, PublishedCurve]) -> Entry:
    """An entry of elastic impacts."""
    return Entry(
        title=title,
        introduction=introduction,
        sources=SOURCES,
        scenes={name: impact.scene() for name, impact in impacts.items()},
        statements=functools.partial(_elastic, impacts, curves),
        axes=("overlap (um)", "force (kN)"),
        draw=functools.partial(_draw_elastic, impacts),
        caption="Force over overlap (LAMMPS), and the largest ones by Hertz's theory.",
    )


# --- test 1: two spheres ----------------------------------------------------------------------------------------------

SPHERES = {
    "glass": Impact(radius=0.01, velocity=20.0, modulus=48e9, ratio=0.2, density=2800.0, plane=False),
    "limestone": Impact(radius=0.01, velocity=20.0, modulus=20e9, ratio=0.25, density=2500.0, plane=False),
}
OF_SPHERES = {"glass": PublishedCurve(10.7, 40.0, 0.5), "limestone": PublishedCurve(7.1, 54.0, 0.5)}

TWO_SPHERES = _entry(
    "Impact of two spheres",
    "Two equal spheres of 10 mm radius meet elastically, each with 10 m/s: test 1 of Chung and Ooi.",
    SPHERES,
    OF_SPHERES,
)

# --- test 2: a plane --------------------------------------------------------------------------------------------------

ON_PLANE = {
    "aluminium-alloy": Impact(radius=0.1, velocity=0.2, modulus=70e9, ratio=0.3, density=2699.0, plane=True),
    "magnesium-alloy": Impact(radius=0.1, velocity=0.2, modulus=40e9, ratio=0.35, density=1800.0, plane=True),
}
OF_PLANE = {"aluminium-alloy": PublishedCurve(11.4, 730.0, 5.0), "magnesium-alloy": PublishedCurve(7.2, 770.0, 5.0)}

PLANE = _entry(
    "Impact on a rigid plane",
    "A sphere of 0.1 m radius meets a rigid plane elastically with 0.2 m/s: test 2 of Chung and Ooi.",
    ON_PLANE,
    OF_PLANE,
)

# --- test 3: restitution ----------------------------------------------------------------------------------------------

COEFFICIENTS = (0.2, 0.4, 0.6, 0.8, 1.0)
MATERIALS = {
    "aluminium-oxide": Impact(radius=0.0025, velocity=3.9, modulus=380e9, ratio=0.23, density=4000.0, plane=True),
    "cast-iron": Impact(radius=0.0025, velocity=3.9, modulus=100e9, ratio=0.25, density=7000.0, plane=True),
}


def _name(material: str, coefficient: float) -> str:
    return f"{material}-{coefficient:g}"


def _rebound(run: Ran) -> float:
    """Velocity of the sphere after the impact over that before it."""
    velocity = run.trajectory.velocity[:, 0, 1]
    return float(-velocity[-1] / velocity[0])


def _restitution(results: Results) -> Statements:
    """Measured restitution against that of the scene."""
    for material in MATERIALS:
        runs = [results[_name(material, coefficient)] for coefficient in COEFFICIENTS]
        rebounds = [each(_rebound, by_engine) for by_engine in runs]
        worst = {
            engine: max(
                abs(by_engine[engine] - coefficient)
                for by_engine, coefficient in zip(rebounds, COEFFICIENTS, strict=True)
            )
            for engine in NAMES
        }
        yield state(
            MeasuredQuantity("largest deviation", worst, at_most(WITHIN), "1e"),
            derived=f"{_words(material)}: the sphere leaves the plane with the coefficient of restitution that was "
            f"given, {', '.join(f'{coefficient:g}' for coefficient in COEFFICIENTS)}; the dashpot is that of the law "
            "`restitution`, whose force is tensile at the end of the contact.",
        )


def _draw_restitution(axis: Axes, results: Results) -> None:
    """Measured restitution over that of the scene."""
    axis.plot(COEFFICIENTS, COEFFICIENTS, label="as given", **PUBLISHED)
    for colour, mark, material in zip(COLOURS, "o+", MATERIALS, strict=False):
        rebounds = [_rebound(results[_name(material, coefficient)]["lammps"]) for coefficient in COEFFICIENTS]
        axis.plot(COEFFICIENTS, rebounds, mark, color=colour, label=f"{_words(material)}, LAMMPS")


RESTITUTION = Entry(
    title="Impact with restitution",
    introduction="A sphere of 2.5 mm radius meets a rigid plane with 3.9 m/s, with five coefficients of restitution: "
    "test 3 of Chung and Ooi.",
    sources={"chung2011": SOURCES["chung2011"]},
    scenes={
        _name(material, coefficient): impact.scene(damping={"contact": coefficient, "law": "restitution"})
        for material, impact in MATERIALS.items()
        for coefficient in COEFFICIENTS
    },
    statements=_restitution,
    axes=("coefficient of restitution, given", "coefficient of restitution, found"),
    draw=_draw_restitution,
    caption="Coefficient of restitution after the impact over the one that was given (LAMMPS).",
)
