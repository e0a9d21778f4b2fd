"""A whole run as MDAnalysis sees it."""

import pickle
from pathlib import Path
from typing import Any

import MDAnalysis as mda
import numpy as np
import pytest
from MDAnalysis.analysis.base import AnalysisFromFunction

from analysis.files.binary_dump import Parts
from analysis.files.dump_layout import header
from analysis.files.recording import Writer, blocks
from analysis.mda.formats import BinaryDumpReader, ChainsParser, of_deck
from analysis.mda.universe import topology_of, universe
from analysis.trajectory import joined
from lammps_inputs import InputError, Kick, Material, Output, Scene
from lammps_inputs.decks import deck
from lammps_inputs.library import from_plain

STEEL = Scene(
    name="steel",
    chains=2,
    beads=6,
    kick=(Kick(velocity=0.5),),
    duration=1e-4,
    material=Material(radius=4.76e-3, density=8000.0, youngs_modulus=193e9, poisson_ratio=0.3),
    output=Output(every=1e-5),
)
PROBLEM = STEEL.problem()


@pytest.fixture
def dumps(tmp_path: Path) -> list[Path]:
    """Ten frames and the start in four files, as of a run that was interrupted thrice.

    The first ends within a frame; the second holds a frame of the first again; the third holds none.
    """
    rng = np.random.default_rng(2)
    moved = rng.normal(size=(11, 2, 2, 6)) * 1e-3
    moved[0] = 0.0
    paths = [tmp_path / f"{number}.bin" for number in range(4)]
    for path, frames in zip(paths, [range(5), range(3, 8), [], range(8, 11)], strict=True):
        with Writer(path, PROBLEM) as writer:
            for frame in frames:
                writer.append(frame * PROBLEM.steps_per_frame, *moved[frame])
    paths[0].write_bytes(paths[0].read_bytes()[:-8])
    return paths


def test_frames_of_a_continued_run_follow_each_other_once_in_any_order_copied_and_in_several_processes(
    dumps: list[Path],
) -> None:
    wanted = joined(blocks(dumps, PROBLEM))
    found = universe(PROBLEM, dumps)
    assert found.trajectory.n_frames == wanted.frames == 11
    for number in (*range(11), 4, 3, 9, 0, -1):
        ts = found.trajectory[number]
        np.testing.assert_array_equal(ts.data["displacement"], wanted.displacement[number].ravel())
        np.testing.assert_array_equal(ts.data["velocity"], wanted.velocity[number].ravel())
        assert ts.time == pytest.approx(wanted.time[number])
    for other in (found.copy(), pickle.loads(pickle.dumps(found))):
        assert [ts.data["step"] for ts in other.trajectory] == [ts.data["step"] for ts in found.trajectory]
    alone, shared = (
        AnalysisFromFunction(largest, found.atoms).run(**options).results.timeseries
        for options in ({}, {"backend": "multiprocessing", "n_workers": 2})
    )
    np.testing.assert_array_equal(alone, shared)
    np.testing.assert_array_equal(alone, wanted.velocity.max(axis=(1, 2)))


def largest(atoms: mda.AtomGroup) -> float:
    return float(atoms.universe.trajectory.ts.data["velocity"].max())


def test_displacements_in_a_window_are_those_of_the_rows_that_the_atoms_are_in(tmp_path: Path) -> None:
    spacing = 4.0
    frames = []
    for step, row in enumerate(np.array([[1.0, 2.0, 3.0], [4.0, 2.0, 3.0]])):
        atoms = np.stack([np.arange(1.0, 4.0), row, row * spacing + 0.25 * step], axis=1)
        frames.append(header(step, float(step), 3, [0.0, 16.0] * 3, "id mol x") + atoms.tobytes())
    (tmp_path / "window.bin").write_bytes(b"".join(frames))
    for ts in BinaryDumpReader(tmp_path / "window.bin"):
        assert ts.data["displacement"].tolist() == [0.25 * ts.frame] * 3


def test_parts_of_other_runs_and_a_run_without_a_frame_are_refused(dumps: list[Path], tmp_path: Path) -> None:
    other = STEEL.model_copy(update={"beads": 7}).problem()
    with Writer(tmp_path / "other.bin", other) as writer:
        writer.append(0, np.zeros((2, 7)), np.zeros((2, 7)))
    with pytest.raises(InputError, match=r"other\.bin: holds other atoms or columns than .*1\.bin"):
        Parts([dumps[1], tmp_path / "other.bin"])
    with pytest.raises(InputError, match=r"2\.bin: is an empty file"):
        Parts([dumps[2]])


def test_files_that_mdanalysis_cannot_take_are_named_with_the_reason(dumps: list[Path], tmp_path: Path) -> None:
    data = tmp_path / "mine.chains"
    data.write_text("mine\n\nAtoms\n\n1 2 3\n")
    with pytest.raises(ValueError, match=r"mine\.chains: its Atoms are not those of a data\.chains"):
        ChainsParser(data).parse()
    with pytest.raises(OSError, match=r"none\.bin: no such file"):
        BinaryDumpReader(tmp_path / "none.bin")
    with pytest.raises(ValueError, match=r"rest holds 2 positions; .*1\.bin has 12 atoms"):
        BinaryDumpReader(dumps[1], rest=[1.0, 2.0])


LIGHT = {"mass": 0.3, "stiffness": 0.2, "rows": [3, 5]}
ATOMS_OF = {
    "chains": {"chains": 3, "coupling": {"stiffness": 0.1}},
    "springs in some rows, around": {"chains": 3, "coupling": {"cubic": 0.7, "rows": [2, 4], "topology": "ring"}},
    "recorded": {"chains": 2, "coupling": {"stiffness": 0.1}, "output": {"beads": [2, 7]}},
    "contacts that differ": {"contact": {"strength": [1.0, 2.0, 3.0] * 3}, "output": {"beads": [2, 7]}},
    "masses": {"kinds": {"heavy": {"mass": 1.0}, "light": {"mass": 0.5}}, "pattern": ["heavy", "light"]},
    "resonators": {"chains": 2, "resonators": [LIGHT, {**LIGHT, "rows": [5, 9]}]},
    "window": {"chains": 2, "coupling": {"stiffness": 0.1}, "beads": 200, "window": 64},
}


@pytest.mark.parametrize("keys", ATOMS_OF.values(), ids=ATOMS_OF)
def test_atoms_and_bonds_are_those_of_the_deck(keys: dict[str, Any]) -> None:
    plain = {"name": "atoms", "beads": 10, "kick": {"velocity": 1.0}, "duration": 1.0, "timestep": 0.01, **keys}
    problem = from_plain(plain, "test").problem()
    mine, of_files = (
        mda.Universe(made)
        for made in (topology_of(problem), of_deck(deck.render_data(problem), deck.render_deck(problem)))
    )
    assert len(mine.atoms) > 0
    np.testing.assert_array_equal(mine.atoms.ids, of_files.atoms.ids)
    np.testing.assert_array_equal(mine.atoms.resids, of_files.atoms.resids)
    np.testing.assert_array_equal(mine.atoms.segids, of_files.atoms.segids)
    np.testing.assert_allclose(mine.atoms.masses, of_files.atoms.masses, rtol=1e-12)  # densities in the file
    np.testing.assert_array_equal(mine.atoms.radii, of_files.atoms.radii)
    assert sorted(mine.bonds.indices.tolist()) == sorted(of_files.bonds.indices.tolist())


def test_a_run_that_lammps_cannot_compute_is_read_like_any_other(tmp_path: Path) -> None:
    plain = {"name": "by_reference", "beads": 6, "kick": {"velocity": 1.0}, "duration": 1.0, "timestep": 0.01}
    problem = from_plain({**plain, "contact": {"exponent": [1.5, 1.5, 2.0, 2.0, 2.0]}}, "test").problem()
    assert "exponents" in deck.refusal(problem.system)
    with Writer(tmp_path / "run.bin", problem) as writer:
        writer.append(0, np.zeros((1, 6)), np.ones((1, 6)))
    assert universe(problem, [tmp_path / "run.bin"]).trajectory[0].data["velocity"].tolist() == [1.0] * 6
