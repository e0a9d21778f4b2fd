"""Repeat a run from its run.json and test whether the result is bitwise the same."""

import argparse
import tempfile
from pathlib import Path

from workflow.runs.rerun import Original, Rerun, original, rerun
from workflow.screen import progress_bar

EXAMPLES = (
    "rerun demo",
    "rerun run.json -o again",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The run, and where to keep the new one."""
    parser.add_argument("run", metavar="RUN.JSON|DIR", type=Path, help="a run.json, or the directory of a run")
    parser.add_argument("-o", "--output", metavar="DIR", type=Path, help="keep the new run there")


def execute(arguments: argparse.Namespace) -> int:
    """Run and compare; exit code 1 if the result is not the same."""
    first = original(arguments.run)
    with (
        tempfile.TemporaryDirectory(prefix="granchain-") as scratch,
        progress_bar(first.scene.name, first.scene.problem()) as progress,
    ):
        found = rerun(first, arguments.output or Path(scratch) / "run", progress=progress)
    print(_verdict(first, found))
    for name, (then, now) in found.changed.items():
        print(f"  {name}: {then} then, {now} here")
    return 0 if found.distance is None else 1


def _verdict(first: Original, found: Rerun) -> str:
    frames, code = found.results.frames, found.results.sha256[:12]
    if found.distance is None:
        return f"{first.scene.name}: bitwise the same ({frames} frames, sha256 {code}...)"
    apart = (
        f"velocities up to {found.distance.velocity:.1e} V and displacements {found.distance.displacement:.1e} L apart"
    )
    scale = first.scene.scale
    if found.distance.since is None:
        where = "at the end, among the beads whose last state run.json holds"
    else:
        where = f"first at t = {scale.written(found.distance.since, 'time', '.5g')}"
    return f"{first.scene.name}: not the same: {apart}, {where}"
