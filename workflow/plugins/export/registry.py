"""The formats of ``granchain export``, in one place: what writes each, what it needs, and what it holds."""

from typing import NamedTuple


class Format(NamedTuple):
    """A format of files.

    Attributes:
        writer: module of this package and function in it that makes the files of an `ExportRequest`, or of its
            `Results`: the name of each, and what writes it to a path.
        content: what the files hold, for help.
        file: name of its only file, whose ending is that of others; empty where there may be several.
        packages: modules that it needs beside those of granchain.
        of_results: whether its files are made of `Results`, tables and figures, and not of frames.
        of_sweeps: whether it holds the table of a sweep, too.
    """

    writer: str
    content: str
    file: str = ""
    packages: tuple[str, ...] = ()
    of_results: bool = False
    of_sweeps: bool = False


FORMATS = {
    "netcdf": Format(
        "arrays:netcdf", "frames for xarray, MATLAB and Julia", "frames.nc", ("xarray", "h5netcdf", "h5py")
    ),
    "zarr": Format("arrays:zarr", "the same arrays in a directory of small files", "frames.zarr", ("xarray", "zarr")),
    "parquet": Format(
        "tables:parquet", "tables of waves, forces and others, or of a sweep", "", ("pyarrow",), True, True
    ),
    "csv": Format(
        "tables:csv", "the same tables, and the numbers behind every figure of a run", of_results=True, of_sweeps=True
    ),
    "ovito": Format("atoms:ovito", "beads, springs and velocities for OVITO", "frames.gsd", ("gsd",)),
    "vmd": Format("atoms:vmd", "the same as a script for VMD", "frames.vmd"),
    "mp4": Format(
        "film:mp4", "film of the beads and of the velocity in space and time", "film.mp4", ("imageio_ffmpeg",)
    ),
    "gif": Format("film:gif", "the same film for slides and web pages", "film.gif"),
    "svg": Format(
        "figures:svg", "every figure of a run as vector graphics, and the numbers behind it as CSV", of_results=True
    ),
    "pdf": Format("figures:pdf", "the same as PDF", of_results=True),
}
