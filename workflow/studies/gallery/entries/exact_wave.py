"""The exact wave of the discrete chain: the series of Sen and Manciu, and how fast its tails fall."""

import numpy as np
from matplotlib.axes import Axes

from analysis.shape.exact_wave import solitary_wave
from analysis.trajectory import Floats
from workflow.studies.gallery.criteria import NAMES, Measured, at_most, near, state
from workflow.studies.gallery.entry import COLOURS, PUBLISHED, Entry, Ran, Results, chain, each
from workflow.studies.page import Statement

SCENE = chain(100, 125)
BEAD = 80
_DIGITS = {"lammps": 1e-11, "reference": 1e-200}
"""Velocities that an engine resolves, in units of V."""
SERIES = (2.39536, 0.268529, 0.0061347)


def _series(xi: Floats) -> Floats:
    """Share of its shift that a bead has moved, at a distance ahead of the wave's middle, beads."""
    return np.asarray(0.5 * (1.0 - np.tanh(0.5 * sum(c * xi ** (2 * k + 1) for k, c in enumerate(SERIES)))))


def _moved(run: Ran) -> tuple[Floats, Floats]:
    """Distance ahead of the wave, and share of its shift that bead `BEAD` has moved, [frame]."""
    arrival = float(run.waves.at(BEAD).arrival[0])
    xi = run.speed(BEAD - 10, BEAD + 10) * (arrival - run.trajectory.time)
    near = np.abs(xi) < 4.0
    shift = solitary_wave().shift_at(run.peak(BEAD))
    return xi[near], run.trajectory.displacement[near, 0, BEAD - 1] / shift


def _tail(run: Ran) -> Floats:
    """By what factor the logarithm of the velocity falls faster from each bead ahead of the wave to the next, [bead].

    As far as there are digits: LAMMPS adds tiny overlaps to positions, of which they vanish.
    """
    frame = int(np.argmin(np.abs(run.trajectory.time - run.waves.at(BEAD).arrival[0])))
    ahead = np.abs(run.trajectory.velocity[frame, 0, BEAD : BEAD + 9])
    steps = np.diff(np.log(ahead[ahead > _DIGITS[run.directory.engine]]))
    return np.asarray(steps[1:] / steps[:-1])


def statements(results: Results) -> list[Statement]:
    """The series, the tails, the shape."""
    runs = results["chain"]
    series = each(runs, lambda run: float(np.max(np.abs(_series(_moved(run)[0]) - _moved(run)[1]))))
    tails = {engine: _tail(run) for engine, run in runs.items()}
    rise, last = float(np.max(np.diff(tails["reference"]))), float(tails["reference"][-1])
    exact = solitary_wave()
    return [
        state(
            Measured("largest difference, in A", series, at_most(5e-4), "6"),
            published="The displacement of a bead is A/2 (1 - tanh(f/2)), f = 2.39536 x + 0.268529 x^3 + 0.0061347 "
            "x^5 (x in beads).",
            source="sen2001, as quoted",
        ),
        state(
            Measured("factor at the farthest bead", {"reference": last}, near(1.5, 0.03), "3"),
            Measured("largest change of the factor from bead to bead", {"reference": rise}, at_most(0.0), "3"),
            published="The tails of the wave fall off super-exponentially.",
            source="ahnert2009, abstract",
            derived="With each bead farther ahead of the wave the logarithm of the velocity falls faster, by a "
            "factor that decreases to the exponent 3/2 of the contact force.",
            also=[
                f"factors, {NAMES[engine]}: " + ", ".join(f"{value:.3f}" for value in one)
                for engine, one in tails.items()
            ],
        ),
        state(
            Measured(
                "speed over V_m^(1/5)",
                each(runs, lambda run: run.speed(60, 90) / run.peak(75) ** 0.2),
                near(exact.speed, 2e-5),
                "6",
            ),
            published="The travelling-wave equation c^2 r = Lambda * r^(3/2) is solved by iteration.",
            source="ahnert2009, abstract",
            derived=f"The iteration converges to c = {exact.speed:.6f} V_m^(1/5) beads per unit time.",
        ),
    ]


def draw(axis: Axes, results: Results) -> None:
    """The difference of the series."""
    xi, moved = _moved(results["chain"]["lammps"])
    axis.plot(xi, _series(xi) - moved, color=COLOURS[0], label="series minus LAMMPS")
    axis.axhline(0.0, **PUBLISHED)


ENTRY = Entry(
    title="The exact wave of the discrete chain",
    introduction="Properties of the travelling wave of the discrete chain: a series fitted by Sen & Manciu, its "
    "tails, and its speed.",
    sources={
        "sen2001": "as quoted in the literature; the paper could not be read",
        "sen2001solution": "as quoted in the literature; the paper could not be read",
        "ahnert2009": "abstract read",
        "english2005": "travelling-wave equation",
    },
    scenes={"chain": SCENE},
    statements=statements,
    axes=("distance ahead of the wave (beads)", "difference (share of A)"),
    draw=draw,
    caption="Difference of the displacement by the series from that by LAMMPS, as a share of the final displacement.",
)
