"""Two kinds of alternating beads under a load do not transmit sound between two frequencies."""

import math

from matplotlib.axes import Axes

from analysis.dispersion import Dispersion, Map
from workflow.studies.gallery.criteria import Measured, near, state
from workflow.studies.gallery.entry import COLOURS, PUBLISHED, Entry, Ran, Results, chain
from workflow.studies.page import Statement

LIGHT, LOAD = 0.5, 1.0
STIFFNESS = 1.5 * LOAD ** (1.0 / 3.0)
EDGES = {
    "The acoustic band ends": ("2 k / M", math.sqrt(2.0 * STIFFNESS)),
    "The optical band begins": ("2 k / m", math.sqrt(2.0 * STIFFNESS / LIGHT)),
    "The optical band ends": ("2 k (1/M + 1/m)", math.sqrt(2.0 * STIFFNESS * (1.0 + 1.0 / LIGHT))),
}
PLACES = ((0, 1), (1, 0), (1, 1))


def _map(run: Ran) -> Map:
    return run.read(Dispersion(run.problem)).result()


def statements(results: Results) -> list[Statement]:
    """The three edges, from the power of the velocities over wavenumber and frequency."""
    runs = results["diatomic"]
    maps = {engine: _map(run) for engine, run in runs.items()}
    second = {engine: run.problem.scale.time for engine, run in runs.items()}
    bin_width = max(found.bin / second[engine] for engine, found in maps.items())
    return [
        state(
            Measured(
                "angular frequency of the edge",
                {engine: float(found.measured_bands()[place]) / second[engine] for engine, found in maps.items()},
                near(edge, bin_width),
                "4",
            ),
            published=f"{says} at the squared angular frequency {formula}.",
            source="brillouin1946",
            derived=f"k = 3/2 F_0^(1/3) = {STIFFNESS:g}, M = 1, m = {LIGHT:g}: an angular frequency of {edge:.4f}; "
            f"the spectrum resolves {bin_width:.4f}.",
        )
        for (says, (formula, edge)), place in zip(EDGES.items(), PLACES, strict=True)
    ]


def draw(axis: Axes, results: Results) -> None:
    """Branches."""
    run = results["diatomic"]["lammps"]
    found, second = _map(run), run.problem.scale.time
    for branch in range(2):
        axis.plot(found.folded, found.measured[:, branch] / second, "o", ms=4, color=COLOURS[branch])
    for _, edge in EDGES.values():
        axis.axhline(edge, **PUBLISHED)


ENTRY = Entry(
    title="Band gap of a diatomic chain",
    introduction="Alternating beads of mass 1 and 1/2 under a static force of 1, with a weak kick.",
    sources={
        "brillouin1946": "band edges of a chain of two masses",
        "boechler2010": "abstract read: such a spectrum measured in a compressed diatomic chain",
    },
    scenes={
        "diatomic": chain(
            160,
            200,
            timestep=0.01,
            every=0.25,
            kinds={"heavy": {"mass": 1}, "light": {"mass": LIGHT}},
            pattern=["heavy", "light"],
            precompression={"force": LOAD},
            kick={"velocity": 1e-3},
        )
    },
    statements=statements,
    axes=("wavenumber (rad / bead)", "angular frequency (reduced)"),
    draw=draw,
    caption="Frequencies over wavenumber in the LAMMPS run; lines: the published edges.",
)
