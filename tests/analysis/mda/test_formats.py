import pickle
import re
from pathlib import Path

import MDAnalysis as mda
import numpy as np
import pytest
from MDAnalysis.coordinates.XYZ import XYZReader
from stock_lammps import run, scene

import analysis.mda.formats as formats
import lammps_inputs
from analysis import trajectory
from analysis.files.recording import atom_ids, blocks, rest_positions
from lammps_inputs import Output, Scene, file_names
from lammps_inputs.decks import scene_files

TEXT = "frames.lammpstrj"
THREE = scene(chains=3, beads=10, kappa=0.1, duration=6.0, every=0.1)
SOME = THREE.model_copy(update={"output": Output(every=0.1, beads=(2, 7, 9))})
LOOSE_SOME = SOME.model_copy(update={"coupling": None})
PROBLEM = THREE.problem()


@pytest.fixture(scope="module")
def directory(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run on two ranks, so that atoms are in disorder, with a text dump of the same frames."""
    also = f"dump text all custom ${{every}} {TEXT} id x y z vx\ndump_modify text format float %.17g"
    return run(THREE, tmp_path_factory.getbasetemp() / "run", ranks=2, before_run=also).directory


@pytest.fixture
def universe(directory: Path) -> mda.Universe:
    return mda.Universe(directory / file_names.DATA, directory / file_names.DUMP, timestep=PROBLEM.timestep)


@pytest.fixture(scope="module")
def expected(directory: Path) -> trajectory.Trajectory:
    return trajectory.joined(blocks([directory / file_names.DUMP], PROBLEM))


def check(ts: mda.coordinates.timestep.Timestep, expected: trajectory.Trajectory, number: int) -> None:
    np.testing.assert_array_equal(ts.data["displacement"], expected.displacement[number].ravel())
    np.testing.assert_array_equal(ts.data["velocity"], expected.velocity[number].ravel())
    np.testing.assert_allclose(ts.time, expected.time[number], rtol=1e-14)
    assert ts.frame == number


@pytest.mark.parametrize("ahead", [1 << 17, 7 * 8 * 2 * 30], ids=["all", "seven"])
def test_iteration_gives_all_frames_in_float64_however_many_are_read_ahead(
    universe: mda.Universe, expected: trajectory.Trajectory, ahead: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(formats, "_AHEAD_BYTES", ahead)
    universe.trajectory.rewind()
    for number, ts in enumerate(universe.trajectory):
        check(ts, expected, number)
        assert {ts.data[name].dtype for name in ("displacement", "velocity", "x", "vx")} == {np.dtype(np.float64)}
        assert ts.data["step"] == number * PROBLEM.steps_per_frame
    assert number == PROBLEM.frames == universe.trajectory.n_frames - 1


def test_random_access_and_slices_give_the_same_frames(universe: mda.Universe, expected: trajectory.Trajectory) -> None:
    for number in (17, 3, 60, 0, 4, 5, -1):
        check(universe.trajectory[number], expected, number % 61)
    for part in (slice(10, 20), slice(None, None, 7), slice(None, None, -3), [5, 1, 30]):
        numbers = np.arange(61)[part]
        for number, ts in zip(numbers, universe.trajectory[part], strict=True):
            check(ts, expected, number)


def test_frames_that_are_kept_or_changed_do_not_change_others(
    universe: mda.Universe, expected: trajectory.Trajectory
) -> None:
    kept = [ts.data["velocity"] for ts in universe.trajectory]
    np.testing.assert_array_equal(np.array(kept).reshape(expected.velocity.shape), expected.velocity)
    universe.trajectory[5].data["velocity"][:] = 7.0
    universe.trajectory[6]
    check(universe.trajectory[5], expected, 5)


def test_positions_and_velocities_for_viewing_lie_along_the_chain(universe: mda.Universe) -> None:
    ts = universe.trajectory[30]
    np.testing.assert_array_equal(universe.atoms.positions[:, 0], ts.data["x"].astype(np.float32))
    np.testing.assert_array_equal(universe.atoms.velocities[:, 0], ts.data["velocity"].astype(np.float32))
    assert not universe.atoms.positions[:, 2].any()
    assert not universe.atoms.velocities[:, 1:].any()
    width = 2.0 * PROBLEM.layout.spacing
    np.testing.assert_allclose(ts.dimensions[1:], [(1 + PROBLEM.chains) * width, 2.0 * width, 90.0, 90.0, 90.0])


def test_chains_lie_side_by_side_as_in_the_data_file_also_in_what_mdanalysis_writes(
    universe: mda.Universe, directory: Path, tmp_path: Path
) -> None:
    across = np.array([float(line.split()[3]) for line in atom_lines(directory / file_names.DATA)])
    assert sorted(set(across)) == [2.0 * PROBLEM.layout.spacing * chain for chain in range(3)]
    universe.atoms.write(tmp_path / "out.xyz", frames="all")
    written = XYZReader(tmp_path / "out.xyz")
    assert len(written) == 61
    for frames in (universe.trajectory, written):
        for ts in frames[::20]:
            np.testing.assert_allclose(ts.positions[:, 1], across, atol=1e-4)


def atom_lines(path: Path) -> list[str]:
    return path.read_text().split("Atoms #")[1].split("Bonds")[0].strip().splitlines()[2:]


def test_the_text_dump_of_the_same_columns_reads_to_the_same_arrays(directory: Path, universe: mda.Universe) -> None:
    text = mda.Universe(
        directory / file_names.DATA,
        directory / TEXT,
        format="LAMMPSDUMP",
        additional_columns=["x", "vx"],
        dt=PROBLEM.timestep,
    )
    for ours, stock in zip(universe.trajectory, text.trajectory, strict=True):
        np.testing.assert_array_equal(ours.data["x"], stock.data["x"])
        np.testing.assert_array_equal(ours.data["vx"], stock.data["vx"])
        np.testing.assert_allclose(ours.dimensions, stock.dimensions, rtol=1e-6)
        assert (ours.data["step"], ours.time) == (stock.data["step"], stock.time)


# times


def test_time_is_lammps_own_unless_a_timestep_or_a_time_per_frame_is_given(directory: Path) -> None:
    files = directory / file_names.DATA, directory / file_names.DUMP
    for options, time, dt in (({}, 0.2, 0.1), ({"timestep": 0.5}, 10.0, 5.0), ({"dt": 3.0}, 6.0, 3.0)):
        trajectory = mda.Universe(*files, **options).trajectory
        assert trajectory[2].time == pytest.approx(time)
        assert trajectory.dt == pytest.approx(dt)
    with pytest.raises(ValueError, match=r"either timestep .* or dt"):
        mda.Universe(*files, timestep=1.0, dt=1.0)


# several files, copies


def parts(directory: Path, tmp_path: Path) -> list[Path]:
    """The dump in two files."""
    raw = (directory / file_names.DUMP).read_bytes()
    size = len(raw) // 61
    paths = [tmp_path / "1.bin", tmp_path / "2.bin"]
    paths[0].write_bytes(raw[: 40 * size])
    paths[1].write_bytes(raw[40 * size :])
    return paths


def test_several_dumps_in_a_row_are_one_trajectory(
    directory: Path, tmp_path: Path, expected: trajectory.Trajectory
) -> None:
    rest = rest_positions(PROBLEM).ravel()
    chain = mda.Universe(
        directory / file_names.DATA, parts(directory, tmp_path), timestep=PROBLEM.timestep, rest=rest
    ).trajectory
    assert len(chain) == 61
    for number in (*range(61), 3, 50, 39, 40):
        ts = chain[number]
        check(ts, expected, number)
        assert ts.data["step"] == number * PROBLEM.steps_per_frame


def test_displacement_is_absent_where_the_positions_at_rest_are_unknown(directory: Path, tmp_path: Path) -> None:
    universe = mda.Universe(directory / file_names.DATA, parts(directory, tmp_path)[1])
    assert "displacement" not in universe.trajectory[3].data
    with pytest.raises(ValueError, match=r"rest holds 2 positions; .* has 30 atoms"):
        mda.Universe(directory / file_names.DATA, directory / file_names.DUMP, rest=[1.0, 2.0])


def test_copies_and_pickles_stand_at_the_same_frame_and_go_on_alone(
    universe: mda.Universe, expected: trajectory.Trajectory
) -> None:
    universe.trajectory[20]
    for other in (universe.copy(), pickle.loads(pickle.dumps(universe))):
        check(other.trajectory.ts, expected, 20)
        check(other.trajectory.next(), expected, 21)
        check(universe.trajectory.ts, expected, 20)


def test_the_reader_is_a_context_manager_and_knows_its_atoms(directory: Path) -> None:
    with formats.BinaryDumpReader(directory / file_names.DUMP) as reader:
        assert (reader.n_atoms, reader.n_frames, len(reader)) == (30, 61, 61)
    assert formats.BinaryDumpReader.parse_n_atoms(directory / file_names.DUMP) == 30


# damage


@pytest.mark.filterwarnings(r"ignore:Exception ignored in. <function ReaderBase.__del__")  # of MDAnalysis's ChainReader
@pytest.mark.parametrize("content", [b"", b"hello", b"ITEM: TIMESTEP\n0\n"])
def test_empty_and_alien_files_are_refused_by_name_alone_and_in_a_list(
    directory: Path, tmp_path: Path, content: bytes
) -> None:
    path = tmp_path / "alien.bin"
    path.write_bytes(content)
    for dumps in (path, [directory / file_names.DUMP, path]):
        with pytest.raises(OSError, match=rf"{re.escape(str(path))}: is "):
            mda.Universe(directory / file_names.DATA, dumps)


# topology


def test_chains_are_segments_beads_are_residues_springs_are_bonds_and_masses_are_one(universe: mda.Universe) -> None:
    assert universe.atoms.ids.tolist() == list(range(1, 31))
    assert universe.atoms.segids.tolist() == ["C1"] * 10 + ["C2"] * 10 + ["C3"] * 10
    assert universe.atoms.resids.tolist() == [*range(1, 11)] * 3
    assert universe.atoms.masses.tolist() == [1.0] * 30
    assert set(universe.atoms.radii.tolist()) == {PROBLEM.layout.diameter / 2.0}
    assert [tuple(bond) for bond in universe.bonds.indices] == [(i, i + 10) for i in range(20)]
    assert universe.select_atoms("segid C2 and resid 3:5").ids.tolist() == [13, 14, 15]


def test_chains_of_a_window_are_segments_and_its_rows_are_residues(tmp_path: Path) -> None:
    for coupling in (None, THREE.coupling):
        scene_files.write(THREE.model_copy(update={"beads": 80, "window": 64, "coupling": coupling}), tmp_path)
        with formats.ChainsParser(tmp_path / file_names.DATA) as parser:
            universe = mda.Universe(parser.parse())
        assert universe.atoms.segids.tolist() == ["C1"] * 64 + ["C2"] * 64 + ["C3"] * 64
        assert universe.atoms.resids.tolist() == [*range(1, 65)] * 3


@pytest.mark.parametrize("name", ["steel-beside-brass", "tapered-chain", "dimer"])
@pytest.mark.parametrize("beads", [None, (1, 7)])
def test_beads_that_differ_are_atoms_with_their_masses(
    name: str, beads: tuple[int, ...] | None, tmp_path: Path
) -> None:
    scene = lammps_inputs.find(name)
    scene = scene.model_copy(update={"output": scene.output.model_copy(update={"beads": beads})})
    scene_files.write(scene, tmp_path)
    problem = scene.problem()
    with formats.ChainsParser(tmp_path / file_names.DATA) as parser:
        universe = mda.Universe(parser.parse())
    assert universe.atoms.ids.tolist() == atom_ids(problem).ravel().tolist()
    masses = np.broadcast_to(problem.system.mass, (problem.chains, problem.beads))[:, problem.rows.numbers - 1]
    np.testing.assert_allclose(universe.atoms.masses, masses.ravel(), rtol=4e-16)


@pytest.mark.slow
@pytest.mark.parametrize("scene", [SOME, LOOSE_SOME], ids=["springs", "no springs"])
def test_only_recorded_beads_are_atoms_and_lie_on_their_chains(tmp_path: Path, scene: Scene) -> None:
    directory = run(scene, tmp_path / "some", ranks=2).directory
    universe = mda.Universe(directory / file_names.DATA, directory / file_names.DUMP)
    assert universe.atoms.ids.tolist() == [2, 7, 9, 12, 17, 19, 22, 27, 29]
    assert universe.atoms.resids.tolist() == [2, 7, 9] * 3
    assert universe.atoms.segids.tolist() == ["C1"] * 3 + ["C2"] * 3 + ["C3"] * 3
    assert len(universe.bonds) == (6 if scene is SOME else 0)
    first = universe.trajectory[0].data["x"].reshape(3, 3)
    np.testing.assert_array_equal(first, rest_positions(scene.problem()))
    width = 2.0 * scene.problem().layout.spacing
    np.testing.assert_array_equal(universe.atoms.positions[:, 1], np.repeat(np.arange(3.0), 3) * width)


def test_a_file_that_is_no_data_file_is_refused_by_name(tmp_path: Path) -> None:
    path = tmp_path / "data.chains"
    path.write_text("title\n\n2 atoms\n1 atom types\n\nAtoms\n\n1 1 0 0 0\n2 1 1 0 0\n")
    with pytest.raises(ValueError, match=r"data\.chains: its Atoms are not those of a data\.chains"):
        mda.Universe(path, topology_format="CHAINS")
