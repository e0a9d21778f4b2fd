"""Write a run or a sweep in files of other programs: netCDF, Zarr, Parquet, OVITO, VMD, films, vector graphics."""

import argparse
import importlib
import os
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Annotated, Any, TypedDict, Unpack

from granchain import InputError
from granchain.parts import (
    Between,
    RunDirectory,
    checked,
    complaints,
    complete,
    file_names,
    formats,
    inputs,
    labelled,
    output_directory,
    screen,
)
from workflow.plugins.export.registry import FORMATS
from workflow.plugins.export.request import ExportRequest, Options, Writers

ANSWERS = "the paths of the files"
EXAMPLES = (
    "export demo --to netcdf,csv",
    "export demo --to ovito --every 4 -o frames.gsd",
    "export demo --to mp4 --seconds 20 --pixels 1600",
    "export swept --to parquet",
)

_WIDEST, _NARROWEST = 4000, 320
"""Pixels of a film."""

_MOST_PICTURES = 20_000

_FASTEST = 100
"""Pictures a second of a film."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the directory, the formats and their options."""
    usual = Options()
    parser.add_argument("directory", metavar="DIR", type=Path, help="of a run (also a cut one) or a sweep")
    listed = "; ".join(f"{name}: {chosen.content}" for name, chosen in FORMATS.items())
    parser.add_argument("--to", metavar="FORMAT,...", required=True, help=listed)
    parser.add_argument(
        "-o", "--output", metavar="PATH", type=Path, help="directory of the files, or name of the file (default DIR)"
    )
    parser.add_argument("--overwrite", action="store_true", help="replace existing files in PATH")
    parser.add_argument("--every", metavar="N", type=int, default=usual.every, help="every N-th frame (default 1)")
    parser.add_argument(
        "--seconds", metavar="S", type=float, default=usual.seconds, help=f"of a film (default {usual.seconds:g})"
    )
    parser.add_argument(
        "--rate", metavar="N", type=int, default=usual.rate, help=f"pictures a second (default {usual.rate})"
    )
    parser.add_argument(
        "--pixels", metavar="N", type=int, default=usual.pixels, help=f"width of a film (default {usual.pixels})"
    )
    parser.add_argument(
        "--width",
        metavar="INCHES",
        type=formats.width_from_words,
        help="width of figures, without titles (default: its own)",
    )


def execute(arguments: argparse.Namespace) -> screen.CommandResult:
    """Write the files; print them and their sizes."""
    options = Options(arguments.every, arguments.seconds, arguments.rate, arguments.pixels)
    with formats.written_as(("svg",), arguments.width):
        paths = write(
            arguments.directory,
            _formats(arguments.to.split(",")),
            arguments.output,
            options,
            overwrite=arguments.overwrite,
        )
    incomplete = _incomplete(arguments.directory)
    if incomplete:
        print(incomplete)
    print(f"written: {', '.join(f'{screen.one_line(path)} ({_size(path)})' for path in paths)}")
    return screen.CommandResult(0, [str(path) for path in paths])


class FilmOptions(TypedDict, total=False):
    """Options of a film.

    Attributes:
        seconds: its duration.
        rate: pictures a second.
        pixels: its width.
    """

    seconds: Annotated[float, Between(0.0, _MOST_PICTURES, above=True)]
    rate: Annotated[int, Between(1, _FASTEST)]
    pixels: Annotated[int, Between(_NARROWEST, _WIDEST)]


@checked
def export(
    run: inputs.AnyRun,
    to: Sequence[str],
    output: Path | str | None = None,
    *,
    overwrite: bool = False,
    every: Annotated[int, Between(1)] = 1,
    **film: Unpack[FilmOptions],
) -> list[Path]:
    """Write a run, or the table of a sweep, in files of other programs, as ``granchain export`` does.

    Args:
        run: a run, or the directory of a run or a sweep.
        to: format, or formats: "netcdf", "zarr", "parquet", "csv", "ovito", "vmd", "mp4", "gif", "svg", "pdf".
        output: directory of the files, or name of the file; the run's directory if omitted.
        overwrite: whether existing files at another place than the run's directory may be replaced.
        every: only every so many frames.
        **film: ``seconds``, duration of a film; ``rate``, pictures of it a second; ``pixels``, its width; by default
            those of the command.

    Returns:
        Paths of the files.

    Raises:
        InputError: unknown format, a package that is not installed, or a file that would be overwritten.

    Examples:
        >>> granchain.export("out", to="vmd", output="for-vmd")
        [PosixPath('for-vmd/frames.vmd')]
    """
    path = Path(run) if isinstance(run, str | os.PathLike) else inputs.directory_of(run).path
    names = [name for each in to for name in each.split(",")]
    options = Options(every, **film)
    target = None if output is None else Path(output)
    return write(path, _formats(names), target, options, overwrite=overwrite)


def write(
    path: Path, names: Sequence[str], output: Path | None, options: Options, *, overwrite: bool = False
) -> list[Path]:
    """Write the files of formats by their names.

    Args:
        path: directory of a run or a sweep.
        names: keys of `FORMATS`.
        output: directory of the files, or name of the file; None for the directory of the run or sweep.
        options: see `Options`.
        overwrite: whether existing files at another place than the run's directory may be replaced.

    Returns:
        Paths of the files.

    Raises:
        InputError: see `export`.
        RunError: a file cannot be written.
    """
    _refuse_options(options)
    request = _request(path, names, options)
    for name in names:
        labelled.need(f"--to {name}", *FORMATS[name].packages)
    named = output is not None and len(names) == 1 and output.suffix == Path(FORMATS[names[0]].file).suffix != ""
    folder = output.parent if output is not None and named else output or path
    ours = request.is_run and folder.is_dir() and folder.samefile(path)

    def name_of(file: str) -> str:
        return output.name if output is not None and named else file

    _reserve(folder, [name_of(FORMATS[name].file) for name in names if FORMATS[name].file], ours, overwrite)
    files: Writers = {}
    results = _part("results:Results")(request) if any(FORMATS[name].of_results for name in names) else None
    for name in names:
        made: Writers = _part(FORMATS[name].writer)(results if FORMATS[name].of_results else request)
        files |= {name_of(file): write_file for file, write_file in made.items()}
    _reserve(folder, files, ours, overwrite)
    output_directory.make_directory(folder)
    for name, write_file in files.items():
        with complete(folder / name, directory=Path(name).suffix == _STORE) as temporary:
            write_file(temporary)
    return [folder / name for name in files]


def _part(place: str) -> Any:
    """What stands as ``module:name`` in this package, imported when a format needs it."""
    module, _, name = place.partition(":")
    return getattr(importlib.import_module(f"workflow.plugins.export.{module}"), name)


_STORE = Path(FORMATS["zarr"].file).suffix


def _reserve(folder: Path, names: Iterable[str], ours: bool, overwrite: bool) -> None:
    """See that files may be written: in the run's directory as files of granchain, elsewhere where none of them stands.

    Raises:
        InputError: a file stands there that is the user's.
    """
    if ours:
        output_directory.record_files(folder, names)
        return
    for path in (folder / name for name in names):
        if not os.path.lexists(path):
            continue
        if not overwrite:
            raise InputError(f"{path}: exists; choose another -o, or replace it (--overwrite)")
        if path.is_dir() != (path.suffix == _STORE) or (path.is_dir() and not (path / ".zgroup").is_file()):
            raise InputError(f"{path}: is a directory that granchain did not write; choose another -o")


def _formats(names: Sequence[str]) -> list[str]:
    """Formats that are named, each once.

    Raises:
        InputError: there is no such format; names those there are.
    """
    chosen = list(dict.fromkeys(name.strip().lower() for name in names))
    for name in chosen:
        if name not in FORMATS:
            hint = complaints.suggestion(name[:60], FORMATS)
            raise InputError(f"--to: {name[:60]!r} is no format{hint}; {', '.join(FORMATS)}, with commas between")
    return chosen


def _refuse_options(options: Options) -> None:
    """Refuse numbers that make no file.

    Raises:
        InputError: names the option.
    """
    pictures = options.seconds * options.rate
    for option, value, fits, valid in (
        ("--every", options.every, options.every >= 1, "1 or more"),
        ("--seconds", options.seconds, 0.0 < options.seconds <= _MOST_PICTURES, "more than 0"),
        ("--rate", options.rate, 1 <= options.rate <= _FASTEST, f"1 to {_FASTEST} pictures a second"),
        ("--seconds", options.seconds, pictures <= _MOST_PICTURES, f"at most {_MOST_PICTURES} pictures"),
        ("--pixels", options.pixels, _NARROWEST <= options.pixels <= _WIDEST, f"{_NARROWEST} to {_WIDEST}"),
    ):
        if not fits:
            raise InputError(f"{option}: {value} given; {valid}")


def _request(path: Path, names: Sequence[str], options: Options) -> ExportRequest:
    """What is exported: a run, or a sweep, of which there are tables only.

    Raises:
        InputError: the directory is neither, or a format is one of runs alone.
    """
    if not path.is_dir():
        raise InputError(f"{path}: no such directory")
    is_run = (path / file_names.SCENE).is_file()
    if not is_run and not any((case / file_names.SCENE).is_file() for case in path.iterdir()):
        raise InputError(f"{path}: neither a run nor a sweep; it has no {file_names.SCENE}")
    of_sweeps = [name for name, each in FORMATS.items() if each.of_sweeps]
    for name in names:
        if not is_run and name not in of_sweeps:
            raise InputError(f"--to {name}: {path} is a sweep, which is exported to {' or '.join(of_sweeps)}")
    request = ExportRequest(path, options, is_run)
    if is_run:
        _ = request.directory.dumps  # refuses a directory without frames
    return request


_UNFINISHED = {"running": "has not ended", "interrupted": "was interrupted", "failed": "failed"}


def _incomplete(path: Path) -> str:
    """Sentence on a run that has not come to its end; empty for others."""
    outcome = RunDirectory(path).account.outcome if (path / file_names.SCENE).is_file() else None
    return f"the run {_UNFINISHED[outcome]}: only its frames until then are written" if outcome in _UNFINISHED else ""


def _size(path: Path) -> str:
    """Size of a file, or of all in a directory."""
    files = [file for file in path.rglob("*") if file.is_file()] if path.is_dir() else [path]
    size = sum(file.stat().st_size for file in files)
    return f"{size / 1e6:.1f} MB" if size >= 1e5 else f"{size / 1e3:.1f} kB"
