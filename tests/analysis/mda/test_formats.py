from pathlib import Path

import MDAnalysis as mda
import numpy as np
import pytest
from stock_lammps import run, scene

import analysis.mda.formats as formats
from analysis import trajectory
from analysis.files.recording import blocks
from lammps_inputs import file_names

TEXT = "frames.lammpstrj"
THREE = scene(chains=3, beads=10, kappa=0.1, duration=6.0, every=0.1)
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


@pytest.mark.slow
@pytest.mark.parametrize("ahead", [1 << 17, 7 * 8 * 2 * 30], ids=["all", "seven"])
def test_every_frame_is_read_in_float64_in_any_order_however_many_are_read_ahead(
    universe: mda.Universe, expected: trajectory.Trajectory, ahead: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(formats, "_AHEAD_BYTES", ahead)
    universe.trajectory.rewind()
    for number, ts in enumerate(universe.trajectory):
        check(ts, expected, number)
        assert {ts.data[name].dtype for name in ("displacement", "velocity", "x", "vx")} == {np.dtype(np.float64)}
        assert ts.data["step"] == number * PROBLEM.steps_per_frame
        np.testing.assert_array_equal(universe.atoms.positions[:, 0], ts.data["x"].astype(np.float32))
        np.testing.assert_array_equal(universe.atoms.velocities[:, 0], ts.data["velocity"].astype(np.float32))
        assert not universe.atoms.velocities[:, 1:].any()
    assert number == PROBLEM.frames == universe.trajectory.n_frames - 1
    for number in (17, 3, 60, 0, 4, 5, -1):
        check(universe.trajectory[number], expected, number % 61)
    for part in (slice(10, 20), slice(None, None, -3), [5, 1, 30]):
        for number, ts in zip(np.arange(61)[part], universe.trajectory[part], strict=True):
            check(ts, expected, number)


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


# topology


def test_chains_are_segments_beads_are_residues_springs_are_bonds_and_masses_are_one(universe: mda.Universe) -> None:
    assert universe.atoms.ids.tolist() == list(range(1, 31))
    assert universe.atoms.segids.tolist() == ["C1"] * 10 + ["C2"] * 10 + ["C3"] * 10
    assert universe.atoms.resids.tolist() == [*range(1, 11)] * 3
    assert universe.atoms.masses.tolist() == [1.0] * 30
    assert set(universe.atoms.radii.tolist()) == {PROBLEM.layout.diameter / 2.0}
    assert [tuple(bond) for bond in universe.bonds.indices] == [(i, i + 10) for i in range(20)]
    assert universe.select_atoms("segid C2 and resid 3:5").ids.tolist() == [13, 14, 15]
