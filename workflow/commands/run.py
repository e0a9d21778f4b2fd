"""Run a scene with LAMMPS, with the reference integrator, or as rigid beads that collide."""

import argparse
import math
from pathlib import Path
from typing import Any

from lammps_inputs import Problem, library
from workflow import run as running
from workflow.check import Check
from workflow.ending import with_duration
from workflow.screen import progress_bar
from workflow.validate import TOLERANCES


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The scene, where to, and how."""
    parser.add_argument("scene", metavar="SCENE", help="a YAML file, or the name of an installed scene")
    parser.add_argument("-o", "--output", metavar="DIR", type=Path, required=True, help="run directory to make")
    parser.add_argument("--engine", choices=running.ENGINES, default="lammps", help="what computes (default lammps)")
    parser.add_argument("--ranks", metavar="N", type=int, default=1, help="MPI ranks of LAMMPS (default 1)")
    parser.add_argument("--overwrite", action="store_true", help="replace an earlier run's files in DIR")
    parser.add_argument("--no-check", action="store_true", help="do not measure the error against the reference")


def execute(arguments: argparse.Namespace) -> int:
    """Run, with a progress bar on a terminal; exit code 1 when interrupted."""
    scene = with_duration(library.find(arguments.scene))
    problem = scene.problem()
    with progress_bar(scene.name, problem) as progress:
        result = running.run(
            scene,
            arguments.output,
            engine=arguments.engine,
            ranks=arguments.ranks,
            overwrite=arguments.overwrite,
            check=not arguments.no_check,
            progress=progress,
        )
    record = result.directory.record
    if result.outcome == "interrupted":
        print(f"{arguments.output}: interrupted at step {record['steps_done']} of {record['steps']}; frames are kept")
        return 1
    print(f"{arguments.output}: {_done(record)}")
    if result.check is not None:
        print(_checked(result.check, problem))
        if result.check.velocity > TOLERANCES["velocity"]:
            step = problem.timestep * problem.scale.time * math.sqrt(TOLERANCES["velocity"] / result.check.velocity)
            print(f"that is more than {TOLERANCES['velocity']:.0e} V; a timestep of about {step:.2g} would do")
    return 0


def _done(record: dict[str, Any]) -> str:
    if record["engine"] == "reference":
        certificate = record["certificate"]
        return (
            f"reference, {record['engine_seconds']:.2f} s; velocities certified to {certificate['velocity']:.1e} V, "
            f"arrivals to {certificate['arrival']:.1e} T"
        )
    if record["engine"] == "collisions":
        seconds = f"{record['engine_seconds']:.2g} s"
        return f"{record['collisions']} collisions of rigid beads in {seconds}; events.csv lists them"
    ranks = f"{record['ranks']} rank{'s' * (record['ranks'] > 1)}"
    return f"{record['steps']} steps in {record['engine_seconds']:.2f} s (LAMMPS {record['lammps']}, {ranks})"


def _checked(check: Check, problem: Problem) -> str:
    """The run's error in one line, in the dimensionless units that it does not depend on the scene for."""
    where = ""
    if check.where is not None and check.where.time is not None:
        time = check.where.time * problem.scale.time
        unit = f" {problem.scale.symbol('time')}" if problem.scale.si else ""
        where = f" (bead {check.where.bead} of chain {check.where.chain}, t = {time:.5g}{unit})"
    return (
        f"error: velocities {check.velocity:.1e} V{where}, peaks {check.amplitude:.1e} V, "
        f"arrivals {check.arrival:.1e} T; "
        f"the reference is sure to {check.reference.velocity:.1e} V and {check.reference.arrival:.1e} T"
    )
