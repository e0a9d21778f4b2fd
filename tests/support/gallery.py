"""Draws the pictures of README.md and GALLERY.md: ``python tests/support/gallery.py [NAME...]``, all of them or some.

Each is a figure of ``granchain run SCENE -o DIR`` and ``granchain analyze DIR --width INCHES``. Those of the gallery
are drawn for the width at which the pages show them, 280 pixels: some panels, few ticks. A new picture is a line in
`PICTURES` and a cell in GALLERY.md, or a place in SCENES.md.
"""

import io
import sys
import tempfile
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from PIL import Image

from analysis.figures.style import legend_below, picture, styled
from workflow.cli import main
from workflow.formats import written_as
from workflow.verdicts import analysis_files

FOLDER = Path(__file__).parents[2] / ".github"

PICTURES = {
    "two-chains": ("two-chains", "spacetime"),
    "sharing": ("two-chains", "distance"),
    "gallery/coupled-from-row-41": ("coupled-from-row-41", "spacetime"),
    "gallery/ring-of-three": ("ring-of-three", "distance"),
    "gallery/lattice-of-nine": ("lattice-of-nine", "distance"),
    "gallery/dimer": ("dimer", "response"),
    "gallery/heavy-impurity": ("heavy-impurity", "spacetime"),
    "gallery/steel-beside-brass": ("steel-beside-brass", "spacetime"),
    "gallery/wall-reflection": ("wall-reflection", "forces"),
    "gallery/striker-train": ("striker-train", "response"),
    "gallery/hammer-from-a-file": ("hammer-from-a-file", "spacetime"),
    "gallery/beats-on-a-foundation": ("beats-on-a-foundation", "energy"),
    "gallery/landau-zener": ("landau-zener", "energy"),
    "gallery/cubic-coupling": ("cubic-coupling", "spacetime"),
    "gallery/damped-contacts": ("damped-contacts", "spacetime"),
    "gallery/restitution": ("restitution", "spacetime"),
    "gallery/precompressed": ("precompressed", "dispersion"),
    "gallery/precompressed-damped": ("precompressed-damped", "spacetime"),
    "gallery/gravity-column": ("gravity-column", "spacetime"),
    "gallery/other-exponent": ("other-exponent", "spacetime"),
    "gallery/driven-chain": ("driven-chain", "spectra"),
    "gallery/drive-above-the-cut-off": ("drive-above-the-cut-off", "spectra"),
    "gallery/column-of-rings": ("column-of-rings", "budget"),
    "gallery/tapered-chain": ("tapered-chain", "spacetime"),
    "gallery/graded-contacts": ("graded-contacts", "spacetime"),
    "gallery/resonators": ("resonators", "spacetime"),
    "gallery/magnets": ("magnets", "spacetime"),
    "gallery/plastic-contacts": ("plastic-contacts", "budget"),
    "gallery/disordered-chain": ("disordered-chain", "spacetime"),
    "gallery/newtons-cradle": ("newtons-cradle", "spacetime"),
    "gallery/falling-column": ("falling-column", "spacetime"),
    "gallery/closed-chain": ("closed-chain", "spacetime"),
    "gallery/two-chains-gapped": ("two-chains-gapped", "distance"),
}
"""File in ``.github`` -> installed scene, and which of its figures."""

PANELS = {
    "gallery/ring-of-three": ("(a)",),
    "gallery/two-chains-gapped": ("(a)",),
    "gallery/dimer": ("bead 42", "bead 216"),
    "gallery/lattice-of-nine": ("(a)",),
    "gallery/wall-reflection": ("right wall", "contact 50", "sensor 50"),
    "gallery/striker-train": ("bead 59", "bead 306"),
    "gallery/beats-on-a-foundation": ("(a)",),
    "gallery/driven-chain": ("bead 1", "bead 20"),
    "gallery/landau-zener": ("(b)",),
}
"""Panels of a figure that a picture of the gallery has, by the ends of their titles; all where it is not named here."""

CURVES = {
    "gallery/drive-above-the-cut-off": ("chain 1", "chain 30", "drive"),
    "gallery/lattice-of-nine": ("chain 1", "chain 2", "chain 5", "chain 9"),
}
"""Curves that a picture has, where those of all chains hide each other."""

INCHES = (2.8, 2.4)
"""Size of a gallery picture without its legend; 100 pixels each as the README shows them, and 200 in the file."""

PAGE = 7.2
"""Inches of the others, as wide as the page; 100 pixels each."""


def choose(figure: Figure, name: str) -> None:
    """Leave some panels, and some curves, of a figure."""
    panels = [axis for axis in figure.axes if axis.get_label() != "<colorbar>"]
    ends = PANELS.get(name, ("",))
    chosen = [axis for axis in panels if axis.get_title(loc="left").endswith(ends)]
    for axis in panels:
        for line in axis.get_lines() if name in CURVES else ():
            if line.get_label() not in CURVES[name]:
                line.remove()
        if axis not in chosen:
            lowest = chosen[-1]
            if axis.get_xlabel() and lowest.get_shared_x_axes().joined(lowest, axis):
                lowest.set_xlabel(axis.get_xlabel())
            axis.remove()
    chosen[-1].xaxis.set_tick_params(labelbottom=True)
    if len(chosen) < len(panels):
        for axis, place in zip(chosen, figure.add_gridspec(len(chosen), 1), strict=True):
            axis.set_subplotspec(place)
    for axis in chosen:
        title = axis.get_title(loc="left").partition(") ")[2]
        axis.set_title("" if len(chosen) == 1 else title, loc="left")
        axis.set_title("", loc="right")


@styled
def reduce(figure: Figure, name: str) -> None:
    """Make a figure one for the gallery."""
    choose(figure, name)
    panels = [axis for axis in figure.axes if axis.get_label() != "<colorbar>"]
    for legend in (*figure.legends, *(axis.get_legend() for axis in panels)):
        if legend is not None:
            legend.remove()
    figure.set_size_inches(INCHES)
    beside = panels[0].get_gridspec().ncols > 1
    for axis in panels:
        for setting in (axis.xaxis, axis.yaxis):
            few = (4 if len(panels) < 3 else 2) - (beside and setting is axis.xaxis)
            if isinstance(setting.get_major_locator(), MaxNLocator):
                setting.get_major_locator().set_params(nbins=few, min_n_ticks=1)
    share_label(figure, panels)
    for axis in figure.axes:
        axis.set(xlabel=_short(axis.get_xlabel()), ylabel=_short(axis.get_ylabel()))
    handles, labels = panels[0].get_legend_handles_labels()
    named = dict(zip(map(_short_entry, labels), handles, strict=True))
    if len(named) > 1:
        legend_below(figure, [*named.values()], [*named])


def share_label(figure: Figure, panels: list[Axes]) -> None:
    """Write one label for panels whose quantity is the same."""
    words = {axis.get_ylabel() for axis in panels} - {""}
    if len(words) == 1 and len(panels) > 1:
        for axis in panels:
            axis.set_ylabel("")
        figure.supylabel(*words)
    if figure._supylabel is not None:
        figure.supylabel(_short(figure.get_supylabel()), fontsize="medium")


def _short(label: str) -> str:
    """The label without reduced units, and of a bar of colours without its scale."""
    return label.partition(";")[0].replace(" (reduced)", "").replace("\n", " ")


def _short_entry(label: str) -> str:
    """Words of a legend without their place: ``dissipated`` for ``dissipated in contact damping``."""
    return label.partition(" in ")[0].partition(" between ")[0]


def draw(names: list[str], home: Path) -> None:
    """Run and analyse the scenes of some pictures, and write those."""
    for name in names:
        scene, wanted = PICTURES[name]
        directory, found = home / scene, {}
        if not directory.exists():
            assert main(["run", scene, "-o", str(directory), "--no-check"]) == 0
        analysis_files.write_figure = lambda _, made, figure, found=found: found.setdefault(made, figure) and ()
        width = INCHES[0] if name.startswith("gallery/") else PAGE
        assert main(["analyze", str(directory), "--width", str(width)]) == 0
        with written_as(("png",), width):
            if name.startswith("gallery/"):
                reduce(found[wanted], name)
            write(found[wanted], FOLDER / f"{name}.png", dpi=200 if name.startswith("gallery/") else 100)


def write(figure: Figure, target: Path, dpi: float) -> None:
    """Write a picture."""
    with Image.open(io.BytesIO(picture(figure, "png", dpi))) as drawn:
        small(drawn.convert("RGB"), figure).save(target, optimize=True)


MOST_COLOURS = 256


def small(drawn: Image.Image, figure: Figure) -> Image.Image:
    """The picture with at most 256 colours: those of its colour map, as finely as the bar shows them, and greys."""
    colours = drawn.getcolors(MOST_COLOURS)
    images = [axis.get_images()[0] for axis in figure.axes if axis.get_images()]
    if colours is not None or not images:
        return drawn.quantize(MOST_COLOURS, dither=Image.Dither.NONE)
    greys = np.linspace(0.0, 1.0, 40)[:, np.newaxis] * np.ones(3)
    bar = images[0].get_cmap()(np.linspace(0.0, 1.0, MOST_COLOURS - len(greys)))[:, :3]
    palette = Image.new("P", (1, 1))
    palette.putpalette(np.round(255.0 * np.concatenate([greys, bar])).astype(np.uint8).tobytes())
    return drawn.quantize(palette=palette, dither=Image.Dither.NONE)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as made:
        draw(sys.argv[1:] or list(PICTURES), Path(made))
