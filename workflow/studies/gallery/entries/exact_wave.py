"""The exact wave of the discrete chain: the series of Sen and Manciu, and how fast its tails fall."""

import numpy as np
from matplotlib.axes import Axes

from analysis.shape.exact_wave import solitary_wave
from analysis.trajectory import Floats
from workflow.studies.gallery.entry import (
    COLOURS,
    NAMES,
    PUBLISHED,
    Entry,
    Ran,
    Results,
    Statement,
    chain,
    claim,
    each,
    engines,
    number,
)

SCENE = chain(100, 125)
BEAD = 80
_DIGITS = {"lammps": 1e-11, "reference": 1e-200}
"""Velocities below which an engine's are not to be taken at their word, in units of V."""
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
    exact = solitary_wave()
    return [
        claim(
            "A bead's displacement is A/2 (1 - tanh(f/2)), f = 2.39536 x + 0.268529 x^3 + 0.0061347 x^5 (x in beads).",
            engines(series, digits=6, label="largest difference, in A: "),
            max(series.values()) < 5e-4,
        ),
        claim(
            "The wave falls off super-exponentially: with each bead farther ahead the logarithm of the velocity falls "
            "faster, by a factor that tends to the exponent 3/2.",
            [f"{NAMES[engine]}: " + ", ".join(f"{value:.3f}" for value in one) for engine, one in tails.items()],
            bool(np.all(np.diff(tails["reference"]) < 0.0)) and abs(float(tails["reference"][-1]) - 1.5) < 0.03,
        ),
        number(
            "What the iteration of the equation of travelling waves gives is the wave that runs in the chain: "
            f"c = {exact.speed:.6f} V_m^(1/5).",
            exact.speed,
            each(runs, lambda run: run.speed(60, 90) / run.peak(75) ** 0.2),
            within=2e-5,
            form="6",
        ),
    ]


def draw(axis: Axes, results: Results) -> None:
    """The difference of the series."""
    xi, moved = _moved(results["chain"]["lammps"])
    axis.plot(xi, _series(xi) - moved, color=COLOURS[0], label="series minus LAMMPS")
    axis.axhline(0.0, **PUBLISHED)


ENTRY = Entry(
    title="The exact wave of the discrete chain",
    introduction="Between the long-wave theory and the discrete chain: a series fitted by Sen & Manciu, and what is "
    "known of the exact wave.",
    sources={
        "sen2001": "as quoted in the literature; the paper could not be read",
        "sen2001solution": "as quoted in the literature; the paper could not be read",
        "ahnert2009": "abstract read",
        "english2005": "travelling-wave equation",
    },
    scenes={"chain": SCENE},
    statements=statements,
    axes=("distance ahead of the wave (beads)", "displacement (its shift)"),
    draw=draw,
    caption="What the series is off by, in the displacement that the wave leaves behind.",
)
