"""A quantity has the number that its run's analysis says, also where no other is computed."""

import contextlib
import math
import random

import pytest
from random_scenes import draw

from lammps_inputs import find, installed_scenes
from workflow.cli import main
from workflow.quantities.columns import AT_BEAD, KNOWN, MASS, UNCERTAINTIES
from workflow.quantities.evaluate import of_frames, of_scene, scene_to_run
from workflow.runs.exchange import accountant
from workflow.runs.run import run
from workflow.runs.run_directory import RunDirectory
from workflow.sweep.collect import collect

RELATIVE, ABSOLUTE = 1e-9, 1e-11
"""Frames in a directory lie at times of other rounding, which differences between them magnify; numbers are some 1."""


def unlike(values, row):
    """Quantities whose numbers differ, with both; undefined ones are alike.

    An uncertainty of an analysis covers the error of the run, too, which is not measured in memory.
    """
    differ = {}
    for name, value in values.items():
        expected = row[name]
        if None in (value, expected):
            alike = value is expected
        elif name in UNCERTAINTIES.values():
            alike = value <= expected * (1.0 + RELATIVE)
        else:
            alike = math.isclose(value, expected, rel_tol=RELATIVE, abs_tol=ABSOLUTE)
        if not alike:
            differ[name] = value, expected
    return differ


def all_names(plain):
    """All quantities, and those of the leading wave at three beads."""
    beads = sorted({1, 1 + plain["beads"] // 2, plain["beads"]})
    return (*(name for name in KNOWN if name != MASS), *(f"{name}@{bead}" for name in AT_BEAD for bead in beads))


def analysed(plain, names, tmp_path):
    """Run of the reference in a directory, and its line in the table of `granchain collect`."""
    scene = scene_to_run(plain, names, "scene")
    run(scene, tmp_path / "run", engine="reference")
    assert main(["analyze", str(tmp_path / "run"), "--no-figures"]) == 0
    return RunDirectory(tmp_path / "run"), collect(tmp_path, [name for name in names if "@" in name]).rows[0]


def unlike_in_frames(plain, tmp_path, *, alone):
    """Quantities of a scene's frames that differ from those of its analysis; computed one by one, or each alone."""
    names = all_names(plain)
    directory, row = analysed(plain, names, tmp_path)
    read = list(accountant(directory, directory.problem).counted(directory.blocks()))  # with the steps of the run
    values = {}
    for asked in [(name,) for name in names] if alone else [names]:
        values |= of_frames(directory.problem, lambda: read, directory.scene, asked)
    assert sum(value is not None for value in values.values()) > 1
    return unlike(values, row)


TWO = {"name": "two", "chains": 2, "coupling": {"stiffness": 0.1}, "kick": {"velocity": 1}}
ROWS = {**TWO, "beads": 60, "duration": 90, "resonators": {"mass": 3, "stiffness": 0.3, "rows": [10, 20]}}
FEW = {
    "kicks both ways": {**TWO, "beads": 20, "duration": 24, "kick": [{"velocity": -1, "bead": 20}, {"velocity": 0.6}]},
    "gaps": {**TWO, "beads": 16, "gap": 0.5, "duration": 30},
    "driven before a wall": {
        **{"name": "driven", "beads": 16, "duration": 40, "walls": {"right": "bead"}},
        **{"drive": {"displacement": 0.1, "frequency": 0.2}, "output": {"spectra": {"beads": [3, 9]}}},
    },
    "gauges": {**TWO, "beads": 16, "duration": 24, "output": {"forces": {"contacts": [4]}, "spectra": {"beads": [3]}}},
}


@pytest.mark.slow
@pytest.mark.parametrize("kind", FEW)
def test_each_quantity_of_frames_is_that_of_their_analysis(kind, tmp_path):
    assert unlike_in_frames(FEW[kind], tmp_path, alone=False) == {}


@pytest.mark.parametrize(
    ("plain", "name", "number"),
    [
        ({**find("beats-on-a-foundation").plain(), "kick": {"velocity": 0.9}}, "beat_length", None),
        (find("resonators").plain(), "amplitude", 0.4563724808),
        (ROWS, "beat_length", 20.80632121),
    ],
    ids=["foundation", "resonators", "resonators in some rows"],
)
def test_a_number_without_the_rest_is_that_of_the_analysis(plain, name, number, tmp_path):
    row = analysed(plain, (name,), tmp_path)[1]
    values = of_scene(plain, (name,), "scene")
    assert unlike(values, row) == {}
    assert values[name] == (None if number is None else pytest.approx(number, rel=1e-9))


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(installed_scenes.installed())[::8])
def test_each_quantity_of_an_installed_scene_is_that_of_its_analysis(name, tmp_path):
    assert unlike_in_frames(find(name).plain(), tmp_path, alone=False) == {}


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(0, 100, 36))
def test_each_quantity_of_a_random_scene_is_that_of_its_analysis(seed, tmp_path):
    chance = random.Random(seed)
    scene = None
    while scene is None or scene.window is not None:
        with contextlib.suppress(ValueError):
            scene = draw(chance, seed)
    assert unlike_in_frames(scene.plain(), tmp_path, alone=True) == {}
