"""Draws the pictures of the README: ``python tests/support/gallery.py [NAME...]``, all of them or some.

Each is a figure of ``granchain run SCENE -o DIR`` and ``granchain analyze DIR``. Those of the gallery are drawn for the
width at which the README shows them, 280 pixels: some panels, few ticks, no legend. A new picture is a line in
`PICTURES` and a cell in the README, or a place in SCENES.md.
"""

import io
import sys
import tempfile
from pathlib import Path

import matplotlib as mpl
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, MaxNLocator
from PIL import Image

from analysis.figures.style import STYLE, picture
from workflow.cli import main
from workflow.verdicts import analyse

FOLDER = Path(__file__).parents[2] / ".github"

PICTURES = {
    "two-chains": ("two-chains", "spacetime"),
    "sharing": ("two-chains", "distance"),
    "gallery/coupled-from-row-41": ("coupled-from-row-41", "spacetime"),
    "gallery/ring-of-three": ("ring-of-three", "distance"),
    "gallery/lattice-of-nine": ("lattice-of-nine", "spacetime"),
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
    "gallery/two-chains-gapped": ("two-chains-gapped", "spacetime"),
}
"""File in ``.github`` -> installed scene, and which of its figures."""

PANELS = {
    "gallery/ring-of-three": (0,),
    "gallery/dimer": (0, 4),
    "gallery/wall-reflection": (0, 2, 5),
    "gallery/striker-train": (0, 4),
    "gallery/beats-on-a-foundation": (0,),
    "gallery/driven-chain": (0, 3),
    "gallery/landau-zener": (2,),
}
"""Panels of a figure that a picture of the gallery has, one below the other; all where it is not named here."""

INCHES = (2.8, 2.3)
"""Of a picture of the gallery; 100 pixels each as the README shows them, and 200 in the file."""

LARGEST = (720, 900)
"""Pixels of the others, as wide as the page."""

COLOURS = 128
"""Of a palette: half of the bytes, and no difference that can be seen."""


@mpl.rc_context(STYLE)
def reduce(figure: Figure, kept: tuple[int, ...] | None) -> None:
    """Make a figure one for the gallery."""
    bars = [axis for axis in figure.axes if axis.get_label() == "<colorbar>"]
    panels = [axis for axis in figure.axes if axis not in bars]
    if kept is not None:
        last = panels[kept[-1]]
        last.xaxis.set_tick_params(labelbottom=True)
        for axis in panels:
            if axis.get_xlabel() and last.get_shared_x_axes().joined(last, axis):
                last.set_xlabel(axis.get_xlabel())
            if panels.index(axis) not in kept:
                axis.remove()
        panels = [panels[place] for place in kept]
        for axis, place in zip(panels, figure.add_gridspec(len(kept), 1), strict=True):
            axis.set_subplotspec(place)
    figure.set_size_inches(INCHES)
    for text in (figure._suptitle, *figure.legends, *(axis.get_legend() for axis in panels)):
        if text is not None:
            text.remove()
    figure._suptitle = None
    beside = panels[0].get_gridspec().ncols > 1
    for axis in panels:
        axis.set_title("", loc="right")
        axis.set_title(axis.get_title(loc="left").partition(") ")[2], loc="left")
        if len(panels) == 1:
            axis.set_title("")
        for setting in (axis.xaxis, axis.yaxis):
            few = (4 if len(panels) < 3 else 2) - (beside and setting is axis.xaxis)
            if isinstance(setting.get_major_locator(), LogLocator):
                setting.set_major_locator(LogLocator(numticks=few))
            elif isinstance(setting.get_major_locator(), MaxNLocator):
                setting.get_major_locator().set_params(nbins=few, min_n_ticks=1)
    words = {axis.get_ylabel() for axis in panels} - {""}
    for axis in panels if len(words) == 1 and len(panels) > 1 else ():
        axis.set_ylabel("")
        figure.supylabel(*words)
    if figure._supylabel is not None:
        figure.supylabel(_short(figure.get_supylabel()), fontsize="medium")
    for axis in figure.axes:
        axis.set(xlabel=_short(axis.get_xlabel()), ylabel=_short(axis.get_ylabel()))


def _short(label: str) -> str:
    """The label without reduced units, and of a bar of colours without its scale."""
    return label.partition(";")[0].replace(" (reduced)", "").replace("\n", " ")


def draw(names: list[str], home: Path) -> None:
    """Run and analyse the scenes of some pictures, and write those."""
    for name in names:
        scene, wanted = PICTURES[name]
        directory, found = home / scene, {}
        if not directory.exists():
            assert main(["run", scene, "-o", str(directory), "--no-check"]) == 0
        analyse.write_figure = lambda _, made, figure, found=found: found.setdefault(made, figure) and ()
        assert main(["analyze", str(directory)]) == 0
        if name.startswith("gallery/"):
            reduce(found[wanted], PANELS.get(name))
        shrink(found[wanted], FOLDER / f"{name}.png")


def shrink(figure: Figure, target: Path) -> None:
    """Write a picture."""
    with Image.open(io.BytesIO(picture(figure, "png"))) as drawn:
        small = drawn.convert("RGB")
        small.thumbnail(LARGEST, Image.Resampling.LANCZOS)
        small.quantize(COLOURS, dither=Image.Dither.NONE).save(target, optimize=True)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as made:
        draw(sys.argv[1:] or list(PICTURES), Path(made))
