"""What MDAnalysis writes in our own format is what it read."""

from pathlib import Path

import MDAnalysis as mda
import numpy as np
import pytest
from MDAnalysis.transformations import translate
from stock_lammps import scene

from analysis.files.binary_dump import BinaryDump
from analysis.files.recording import Writer, atom_ids, blocks
from analysis.mda.formats import BinaryDumpReader, BinaryDumpWriter
from analysis.mda.universe import universe
from analysis.trajectory import joined
from lammps_inputs import Output, file_names
from lammps_inputs.decks import deck

SCENE = scene(chains=3, beads=10, kappa=0.1, duration=6.0, every=0.1)
PROBLEM = SCENE.problem()


@pytest.fixture(scope="module")
def directory(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of any numbers, none of which float32 holds."""
    path = tmp_path_factory.mktemp("run")
    deck.write(SCENE, path)
    rng = np.random.default_rng(1)
    with Writer(path / file_names.DUMP, PROBLEM) as writer:
        for number in range(PROBLEM.frames + 1):
            moved = rng.normal(size=(2, 3, 10)) * 1e-3 * (number > 0)
            writer.append(number * PROBLEM.steps_per_frame, *moved)
    return path


@pytest.fixture
def read(directory: Path) -> mda.Universe:
    return mda.Universe(directory / file_names.DATA, directory / file_names.DUMP)


def test_all_frames_written_again_are_the_same_file_to_the_byte(
    read: mda.Universe, directory: Path, tmp_path: Path
) -> None:
    read.atoms.write(tmp_path / "again.bin", frames="all")
    assert (tmp_path / "again.bin").read_bytes() == (directory / file_names.DUMP).read_bytes()
    assert read.trajectory.frame == 0


def test_some_beads_in_every_third_frame_are_a_recording_of_the_scene_that_says_so(
    read: mda.Universe, directory: Path, tmp_path: Path
) -> None:
    beads = (2, 7, 9)
    read.select_atoms("resid 2 7 9").write(tmp_path / "thin.bin", frames=read.trajectory[::3])
    thin = SCENE.model_copy(update={"output": Output(every=0.3, beads=beads)}).problem()
    found, whole = joined(blocks([tmp_path / "thin.bin"], thin)), joined(blocks([directory / file_names.DUMP], PROBLEM))
    np.testing.assert_allclose(found.time, whole[::3].time, rtol=1e-15)
    np.testing.assert_array_equal(found.displacement, whole[::3].displacement[:, :, [1, 6, 8]])
    np.testing.assert_array_equal(found.velocity, whole[::3].velocity[:, :, [1, 6, 8]])
    np.testing.assert_array_equal(BinaryDump(tmp_path / "thin.bin").ids, atom_ids(thin).ravel())
    again = universe(thin, [tmp_path / "thin.bin"])
    for ours, theirs in zip(again.trajectory, read.trajectory[::3], strict=True):
        np.testing.assert_array_equal(again.atoms.positions, read.select_atoms("resid 2 7 9").positions)
        assert (ours.data["step"], ours.time) == (theirs.data["step"], pytest.approx(theirs.time))


def test_one_chain_of_three_stays_in_its_place_and_merges(read: mda.Universe, tmp_path: Path) -> None:
    part = read.select_atoms("segid C2")
    part.write(tmp_path / "part.bin", frames="all")
    assert BinaryDump(tmp_path / "part.bin").columns == ("id", "x", "y", "vx")
    alone = mda.Merge(part)
    alone.load_new(str(tmp_path / "part.bin"))
    for ours, theirs in zip(alone.trajectory[::20], read.trajectory[::20], strict=True):
        np.testing.assert_array_equal(ours.positions, part.positions)
        np.testing.assert_array_equal(ours.data["vx"], theirs.data["vx"][10:20])
    assert alone.atoms.segids.tolist() == ["C2"] * 10


def test_a_window_is_written_with_the_rows_that_its_atoms_are_in(tmp_path: Path) -> None:
    columns = {"mol": np.array([1.0, 2.0, 3.0]), "x": np.array([4.0, 8.0, 12.0]), "vx": np.array([1e-17, 0.1, 0.0])}
    memory = mda.Universe.empty(3, trajectory=True, velocities=True)
    memory.atoms.positions = np.stack([columns["x"], [0] * 3, [0] * 3], axis=1)
    memory.atoms.velocities = np.stack([columns["vx"], [0] * 3, [0] * 3], axis=1)
    memory.trajectory.ts.data.update(columns)
    memory.atoms.write(tmp_path / "window.bin")
    ts = BinaryDumpReader(tmp_path / "window.bin").ts
    for name, values in columns.items():
        np.testing.assert_array_equal(ts.data[name], values)


def test_frames_in_memory_are_written_in_float32_with_all_columns(read: mda.Universe, tmp_path: Path) -> None:
    read.transfer_to_memory(step=10)
    read.atoms.write(tmp_path / "memory.bin", frames="all")
    dump = BinaryDump(tmp_path / "memory.bin")
    assert dump.columns == ("id", "x", "y", "z", "vx", "vy", "vz")
    assert dump.times == pytest.approx(np.arange(7.0))
    np.testing.assert_array_equal(dump.read(3, 4, columns=("x",))[0, 0], read.trajectory[3].positions[:, 0])


def test_positions_that_were_moved_and_data_that_were_not_are_refused_until_one_is_deleted(
    read: mda.Universe, tmp_path: Path
) -> None:
    read.trajectory.add_transformations(translate([1.0, 0.0, 0.0]))
    with pytest.raises(ValueError, match=r"ts\.data\['x'\] and ts\.positions disagree: .*`del ts\.data\['x'\]`"):
        read.atoms.write(tmp_path / "moved.bin")
    moved = read.trajectory[1].positions.copy()
    del read.trajectory.ts.data["x"]
    read.atoms.write(tmp_path / "moved.bin")
    np.testing.assert_array_equal(BinaryDumpReader(tmp_path / "moved.bin").ts.positions, moved)


def test_the_file_that_is_read_is_not_written_over(read: mda.Universe, directory: Path) -> None:
    before = (directory / file_names.DUMP).read_bytes()
    with pytest.raises(ValueError, match=r"chains\.dump\.bin: is what is being read; write to another file"):
        read.atoms.write(directory / file_names.DUMP, frames=read.trajectory[::10])
    assert (directory / file_names.DUMP).read_bytes() == before


def test_frames_of_other_atoms_or_columns_and_what_is_no_atom_are_refused(read: mda.Universe, tmp_path: Path) -> None:
    with BinaryDumpWriter(tmp_path / "a.bin", n_atoms=30) as writer:
        writer.write(read)
        with pytest.raises(ValueError, match="30 atoms are to be written, each once; not 10"):
            writer.write(read.select_atoms("segid C1"))
        with pytest.raises(ValueError, match="30 atoms are to be written, each once; not 31"):
            writer.write(read.atoms + read.atoms[:1])
        with pytest.raises(TypeError, match="an AtomGroup or a Universe can be written"):
            writer.write(3)
        read.trajectory[1].data["heat"] = np.zeros(30)
        with pytest.raises(ValueError, match="a frame has columns id x vx heat; before it was id x vx"):
            writer.write(read)
    assert BinaryDump(tmp_path / "a.bin").n_frames == 1
