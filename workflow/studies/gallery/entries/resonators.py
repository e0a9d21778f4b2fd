"""Resonators in a loaded chain: two bands, the gap between them, and the decay of a motion in the gap."""

import math

import numpy as np
from matplotlib.axes import Axes

from analysis.dispersion import Dispersion, Map
from workflow.studies.gallery.criteria import Measured, near, state
from workflow.studies.gallery.entry import COLOURS, PUBLISHED, Entry, Ran, Results, chain, each
from workflow.studies.page import Statement

MASS, STIFFNESS, FORCE, OVERLAP, DRIVE = 0.1, 1.0, 0.125, 0.25, 2.5
CONTACT, OWN = 1.5 * math.sqrt(OVERLAP), STIFFNESS / MASS
SUM = (1.0 + MASS) * OWN + 4.0 * CONTACT
TOPS = [math.sqrt(0.5 * (SUM + sign * math.sqrt(SUM**2 - 16.0 * CONTACT * OWN))) for sign in (-1.0, 1.0)]
EDGES = {
    "the acoustic band ends": (TOPS[0], (0, 1)),
    "the optical band begins": (math.sqrt(OWN * (1.0 + MASS)), (1, 0)),
    "the optical band ends": (TOPS[1], (1, 1)),
}
EFFECTIVE = 1.0 + MASS * OWN / (OWN - DRIVE**2)
RATIO = -math.exp(-math.acosh(EFFECTIVE * DRIVE**2 / (2.0 * CONTACT) - 1.0))
KEYS = {"precompression": {"force": FORCE}, "resonators": {"mass": MASS, "stiffness": STIFFNESS}}
SOURCE = "kim2014, abstract"


def _map(run: Ran) -> Map:
    return run.read(Dispersion(run.problem)).result()


def _ratio(run: Ran) -> float:
    """Velocity of bead 3 over that of bead 2 at the frequency of the drive, in phase with it."""
    found = run.trajectory
    late = found.time > 0.5 * found.time[-1]
    time = found.time[late]
    weight = np.hanning(len(time)) * np.exp(-1j * DRIVE * run.problem.scale.time * time)
    second, third = (weight @ found.velocity[late, 0, bead] for bead in (1, 2))
    return float((third / second).real)


def statements(results: Results) -> list[Statement]:
    """The three edges, from the power of the velocities over wavenumber and frequency; the decay in the gap."""
    runs = results["kicked"]
    maps = {engine: _map(run) for engine, run in runs.items()}
    second = {engine: run.problem.scale.time for engine, run in runs.items()}
    bin_width = max(found.bin / second[engine] for engine, found in maps.items())
    return [
        *(
            state(
                Measured(
                    "angular frequency of the edge",
                    {engine: float(found.measured_bands()[place]) / second[engine] for engine, found in maps.items()},
                    near(edge, bin_width),
                    "4",
                ),
                published="Local resonances of the cylinders of a woodpile form band gaps.",
                source=SOURCE,
                derived=f"At an angular frequency of {edge:.6f} {says}; the spectrum resolves {bin_width:.4f}.",
            )
            for says, (edge, place) in EDGES.items()
        ),
        state(
            Measured("ratio", each(results["driven"], _ratio), near(RATIO, 1e-4), "6"),
            derived=f"A drive in the gap, at an angular frequency of {DRIVE:g}, moves each bead "
            f"-exp(-arccosh(m omega^2 / (2 K) - 1)) = {RATIO:.6f} times as far as the bead before, with the effective "
            "mass m = 1 + m2 w^2 / (w^2 - omega^2).",
        ),
    ]


def draw(axis: Axes, results: Results) -> None:
    """Branches."""
    run = results["kicked"]["lammps"]
    found, second = _map(run), run.problem.scale.time
    for branch in range(2):
        axis.plot(found.folded, found.measured[:, branch] / second, "o", ms=4, color=COLOURS[branch])
        axis.plot(found.folded, found.exact[:, branch] / second, color=COLOURS[branch], linewidth=0.8)
    for edge, _ in EDGES.values():
        axis.axhline(edge, **PUBLISHED)


ENTRY = Entry(
    title="Band gap of resonators",
    introduction="Equal beads with masses of 0.1 on springs of stiffness 1, under a static overlap of 0.25: a weak "
    "kick, and a drive in the gap.",
    sources={
        "kim2014": "abstract read: band gaps of woodpiles by the bending of their cylinders",
        "vorotnikov2017": "abstract read: pulses in a chain with resonators inside the beads",
    },
    scenes={
        "kicked": chain(160, 200, timestep=0.01, every=0.25, kick={"velocity": 1e-3}, **KEYS),
        "driven": chain(
            30,
            200,
            timestep=0.01,
            every=0.25,
            kick=None,
            drive={"displacement": 1e-4, "frequency": DRIVE / (2.0 * math.pi), "phase": -90},
            **KEYS,
        ),
    },
    statements=statements,
    axes=("wavenumber (rad / bead)", "angular frequency (reduced)"),
    draw=draw,
    caption="Frequencies over wavenumber in the LAMMPS run, the exact branches, and the derived edges of the bands.",
)
