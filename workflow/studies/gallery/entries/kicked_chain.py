"""One bead of an uncompressed chain is hit."""

from matplotlib.figure import Figure

from analysis.figures.style import STYLE, CHAIN_COLOURS
from workflow.studies.gallery.compare import each, number
from workflow.studies.gallery.entry import Entry, Results

SCENE = {"beads": 100, "kick": {"velocity": 1.0}, "duration": 125, "timestep": 0.005, "output": {"every": 0.1}}
BEAD = 80


def statements(results: Results):
    runs = results["kicked"]
    return [number("peak", 0.682, each(runs, lambda run: run.peak(BEAD)), within=5e-4, unit="V")]


def picture(results: Results) -> Figure:
    f = Figure()
    f.add_subplot().plot(results["kicked"]["reference"].waves.peak_velocity)
    return f


ENTRY = Entry("A kicked chain", "x", ["s"], {"kicked": SCENE}, statements, picture, "c")
