"""Draws the pictures of the README anew: ``python tests/support/gallery.py [NAME...]``, all of them or some.

Each is a figure that ``granchain run SCENE -o DIR`` and ``granchain analyze DIR`` leave, made small. A new picture is a
line in `PICTURES` and a cell in the README, or a place in SCENES.md.
"""

import sys
import tempfile
from pathlib import Path

from PIL import Image

from workflow.cli import main

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
    "gallery/disordered-chain": ("disordered-chain", "spacetime"),
    "gallery/two-chains-gapped": ("two-chains-gapped", "spacetime"),
}
"""File in ``.github`` -> installed scene, and which of its figures."""

LARGEST = (720, 540)
"""Pixels, wide and high; enough for a column of a page, also on a screen of twice the usual density."""

COLOURS = 96
"""Of a palette: half of the bytes, and no difference that can be seen."""


def shrink(source: Path, target: Path) -> None:
    """Write a picture of at most `LARGEST`."""
    with Image.open(source) as picture:
        small = picture.convert("RGB")
        small.thumbnail(LARGEST, Image.Resampling.LANCZOS)
        target.parent.mkdir(exist_ok=True)
        small.quantize(COLOURS, dither=Image.Dither.NONE).save(target, optimize=True)


def draw(names: list[str], home: Path) -> None:
    """Run and analyse the scenes of some pictures, and write those."""
    for name in names:
        scene, figure = PICTURES[name]
        directory = home / scene
        if not directory.exists():
            assert main(["run", scene, "-o", str(directory), "--no-check"]) == 0
            assert main(["analyze", str(directory)]) == 0
        shrink(directory / f"{figure}.png", FOLDER / f"{name}.png")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as made:
        draw(sys.argv[1:] or list(PICTURES), Path(made))
