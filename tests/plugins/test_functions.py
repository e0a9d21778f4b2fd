"""Functions of studies in the module `granchain`: none affects the rest of the process."""

import numpy as np
import pytest
from global_state import SCENE, assert_state_remains

import granchain
from lammps_inputs import plugins

DESIGN = {"scene": SCENE, "vary": {"beads": {"from": 6, "to": 8}}, "minimize": "mass", "also": ["peak_velocity"]}
LOADED = {**SCENE, "beads": 4, "chains": 1, "precompression": {"force": 1.0}}
LOADED.pop("coupling")
DESIGN |= {"verify": 1}


def table(directory):
    """A table of the velocities of one bead in a run."""
    trajectory = granchain.run(SCENE, directory / "run", engine="reference").trajectory
    path = directory / "table.csv"
    rows = np.column_stack([trajectory.time, trajectory.velocity[:, 0, 3]])
    np.savetxt(path, rows, delimiter=",", header="time,velocity_1_4", comments="")
    return path


CALLS = {
    "fit": lambda path: granchain.fit(
        {**SCENE, "kick": {"velocity": 1.05}}, table(path), ["kick.velocity"], path / "new", lammps=False, offset=0.0
    ),
    "design": lambda path: granchain.design(DESIGN, path / "new", jobs=1),
    "extremes": lambda path: granchain.extremes(["drives"], path / "new", quick=True),
    "gallery": lambda path: granchain.gallery(path / "new", ["tapered"]),
    "lyapunov": lambda path: granchain.lyapunov(LOADED, path / "new", duration=1000.0),
    "modes": lambda path: granchain.modes(LOADED, path / "new", linear=True),
    "threshold": lambda path: granchain.threshold(
        SCENE, {"mass": 15.0}, {"beads": (6, 8)}, path / "new", points=3, jobs=1
    ),
    "trade": lambda path: granchain.trade(SCENE, path / "new", budget=1.0),
}
"""A cheap call of every function of a study; a new study has one here."""

OF_STUDIES = sorted(plugins.declared("functions").keys() & plugins.declared("studies"))


@pytest.mark.slow
@pytest.mark.parametrize("name", OF_STUDIES)
def test_the_state_of_the_process_is_as_before(name, tmp_path, monkeypatch):
    monkeypatch.setenv("FORCE_COLOR", "1")  # bars of progress have threads
    if name == "fit":
        for count in ("STARTS", "BEGUN"):  # which is no better for it
            monkeypatch.setattr(f"workflow.plugins.fit.study.{count}", 1)
    assert_state_remains(lambda: CALLS[name](tmp_path), tmp_path)
