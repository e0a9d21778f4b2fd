"""netCDF and Zarr hold every number of the frames, with units and names, and are written in pieces."""

import numpy as np
import pytest

import granchain
from analysis import motion
from analysis.gauges.gauge import TOUCHING, at_frames, gauges

xarray = pytest.importorskip("xarray", reason="xarray is not installed (granchain[export])")
pytest.importorskip("h5netcdf", reason="h5netcdf is not installed (granchain[export])")
pytest.importorskip("h5py", reason="h5py is not installed (granchain[export])")
pytest.importorskip("zarr", reason="zarr is not installed (granchain[export])")

FILES = {"netcdf": ("frames.nc", xarray.open_dataset), "zarr": ("frames.zarr", xarray.open_zarr)}


@pytest.fixture(params=FILES)
def read(request, tmp_path, monkeypatch):
    """A function: the dataset of a run as it is read from a file of one format, written in several pieces."""
    name, read = FILES[request.param]
    monkeypatch.setattr("workflow.plugins.export.request.PIECE_BYTES", 16 * 24 * 30)

    def dataset(run, **options):
        [path] = granchain.export(run, request.param, tmp_path, **options)
        assert path == tmp_path / name
        return read(path)

    return dataset


@pytest.mark.parametrize("name", ["coupled", "steel", "recorded"])
def test_frames_read_back_bit_for_bit_in_the_scenes_units(name, read, run_of):
    run = run_of(name)
    frames, dataset = run.si, read(run)
    np.testing.assert_array_equal(dataset.time, frames.time)
    np.testing.assert_array_equal(dataset.velocity, frames.velocity)
    np.testing.assert_array_equal(dataset.displacement, frames.displacement)
    np.testing.assert_array_equal(dataset.bead, run.trajectory.beads)
    assert ("contact_force" in dataset) == ("overlap" in dataset) == (name != "recorded")  # of neighbours
    assert dataset.velocity.dims == ("time", "chain", "bead")
    assert dataset.velocity.dtype == np.float64
    assert {dataset[variable].attrs["units"] for variable in ("time", "velocity")} == (
        {"s", "m/s"} if name == "steel" else {"reduced"}
    )


@pytest.mark.slow
def test_a_file_holds_what_the_attribute_dataset_holds_or_only_every_nth_frame(read, run_of):
    run = run_of("coupled")
    xarray.testing.assert_identical(run.dataset, read(run).load())
    np.testing.assert_array_equal(read(run, every=7, overwrite=True).velocity, run.trajectory.velocity[::7])


@pytest.mark.slow
@pytest.mark.parametrize("name", ["steel", "damped"])
def test_contact_forces_are_those_of_the_gauges(name, run_of):
    trajectory = run_of(name).trajectory
    force = at_frames(trajectory, gauges(trajectory.system, contacts=(5,)))[..., 0] * trajectory.problem.scale.force
    at_contact = run_of(name).dataset.sel(contact=5)
    # gauges take the dashpot of a smaller overlap for that of an open contact
    rounding = (at_contact.overlap > 0.0) & (at_contact.overlap < TOUCHING * trajectory.problem.scale.length)
    assert np.count_nonzero(rounding) < 0.1 * rounding.size
    np.testing.assert_allclose(at_contact.contact_force.where(~rounding), np.where(rounding, np.nan, force), rtol=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["steel", "damped", "coupled"])
def test_an_overlap_is_0_where_beads_are_apart_and_else_the_approach_of_their_centres(name, run_of):
    run = run_of(name)
    dataset, approach = run.dataset, motion.overlaps(run.trajectory.system, run.trajectory.displacement)
    assert (approach < 0.0).any()
    np.testing.assert_array_equal(dataset.overlap, np.maximum(approach, 0.0) * run.trajectory.problem.scale.length)


def test_resonators_have_variables_which_are_nan_where_there_is_none(run_of):
    dataset, trajectory = run_of("resonators").dataset, run_of("resonators").trajectory
    present = trajectory.problem.system.further_lines[0].mass > 0.0
    motion = dataset.resonator_velocity.isel(resonator=0)
    assert 0 < np.count_nonzero(present) < len(present)
    np.testing.assert_array_equal(motion[:, present], trajectory.further_lines[:, 1, 0, present])
    assert np.isnan(motion[:, ~present]).all()


def test_states_of_contacts_that_yield_are_written_in_metres(run_of):
    run = run_of("plastic-contacts")
    states = run.trajectory.contact_state * run.trajectory.problem.scale.length
    np.testing.assert_array_equal(run.dataset.contact_state, states)
    assert run.dataset.contact_state.units == "m"


@pytest.mark.slow
def test_beads_that_a_window_has_left_are_nan_and_those_ahead_are_at_rest(tmp_path, lammps_here, read):  # noqa: ARG001
    scene = {"name": "window", "beads": 160, "kick": {"velocity": 1.0}, "duration": 160.0, "window": 64}
    run = granchain.run(scene | {"output": {"every": 2.0}}, tmp_path / "run", check=False)
    velocity, last = read(run).velocity, list(run.directory.blocks())[-1]
    assert last.first > 1
    assert np.isnan(velocity[-1, :, : last.first - 1]).all()
    np.testing.assert_array_equal(velocity[-1].sel(bead=last.beads), last.velocity[-1])
    assert np.all(velocity[0, :, 64:] == 0.0)


def test_attributes_are_the_scene_its_origin_and_the_error(tmp_path, lammps_here):  # noqa: ARG001
    run = granchain.run({"name": "one", "beads": 8, "kick": {"velocity": 2.0}, "duration": 4.0}, tmp_path / "run")
    attributes = run.dataset.attrs
    (tmp_path / "scene.yaml").write_text(attributes["scene"])
    assert granchain.load(tmp_path / "scene.yaml") == run.directory.scene
    assert attributes["velocity_error"] == run.check.velocity * 2.0
    assert attributes["velocity_uncertainty"] == run.check.reference.velocity * 2.0
    assert attributes["frames_sha256"] == run.directory.fingerprint
    assert "lammps" in attributes["source"]
    assert attributes["history"].startswith(run.directory.job.started)
