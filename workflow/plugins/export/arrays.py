"""Frames as labelled arrays, written block by block: netCDF and Zarr, both as xarray reads them."""

import io
from pathlib import Path
from typing import Any

from granchain.parts import labelled
from workflow.plugins.export.registry import FORMATS
from workflow.plugins.export.request import ExportRequest, Writers

_BYTES = 32.0
"""Of a bead in a frame, before compression: displacement, velocity, overlap and contact force."""


def netcdf(request: ExportRequest) -> Writers:
    """The file of netCDF 4, compressed without loss."""
    return {FORMATS["netcdf"].file: lambda path: _write_netcdf(request, path)}


class _SureFile(io.FileIO):
    """File whose writes never fail, but `check` does: HDF5 ends the process where one of its writes fails."""

    failure: OSError | None = None

    def write(self, content: Any) -> int:
        """Write all bytes, or pretend to once that has failed."""
        left = memoryview(content).cast("B")
        try:
            while self.failure is None and len(left):
                left = left[super().write(left) or 0 :]
        except OSError as error:
            self.failure = error
        return memoryview(content).nbytes

    def check(self) -> None:
        """Raise what a write has failed with, if one has."""
        if self.failure is not None:
            raise self.failure


def _write_netcdf(request: ExportRequest, path: Path) -> None:
    import h5netcdf

    with _SureFile(path, "w+") as stream:
        with h5netcdf.File(stream, "w") as file:
            _fill(file, stream, request)
        stream.check()  # also what it wrote when it was closed


def _fill(file: Any, stream: _SureFile, request: ExportRequest) -> None:
    """Write all pieces into a file of h5netcdf, until a write to its stream fails."""
    written = 0
    for piece in request.pieces(FORMATS["netcdf"].file, _BYTES):
        part = labelled.dataset(request.directory, piece)
        if not written:
            _begin(file, part)
        file.resize_dimension("time", written + piece.frames)
        for name in part.variables:
            if "time" in part[name].dims:
                file.variables[name][written:] = part[name].values
        written += piece.frames
        stream.check()


def _begin(file: Any, part: Any) -> None:
    """Declare the dimensions and variables of a dataset in a file; those without time get their values."""
    file.attrs.update(part.attrs)
    file.dimensions = {name: None if name == "time" else size for name, size in part.sizes.items()}
    for name, values in part.variables.items():
        changes = "time" in values.dims
        packed = {"chunks": values.shape, "compression": "gzip", "compression_opts": 1, "shuffle": True}
        variable = file.create_variable(name, values.dims, values.dtype, **(packed if changes and values.size else {}))
        variable.attrs.update(values.attrs)
        if not changes:
            variable[...] = values.values


def zarr(request: ExportRequest) -> Writers:
    """The directory of a Zarr store of format 2, which every reader knows."""
    return {FORMATS["zarr"].file: lambda path: _write_zarr(request, path)}


def _write_zarr(request: ExportRequest, path: Path) -> None:
    written = 0
    for piece in request.pieces(FORMATS["zarr"].file, _BYTES):
        part = labelled.dataset(request.directory, piece)
        if written:
            part.to_zarr(path, append_dim="time", consolidated=True, zarr_format=2)
        else:
            encoding = {name: {"chunks": values.shape} for name, values in part.items()}
            part.to_zarr(path, mode="w", consolidated=True, zarr_format=2, encoding=encoding)
        written += piece.frames
