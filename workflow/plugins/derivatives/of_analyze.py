"""Derivatives of quantities of a run by fields of its scene: options of ``granchain analyze``."""

import argparse
from collections.abc import Callable
from dataclasses import asdict

from granchain.parts import RunDirectory, analyze, screen
from workflow.plugins.derivatives.derivative import HEAD
from workflow.plugins.derivatives.gradient import with_derivatives

ANSWERS = "with --gradient also the derivatives"
EXAMPLES = ("analyze demo --gradient peak_velocity@50,arrival@50 --by coupling.stiffness",)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the quantities and the fields."""
    parser.add_argument(
        "--gradient",
        metavar="Q,Q,...",
        help="compute derivatives of quantities by fields of the scene, with the reference; at a bead: arrival@50",
    )
    parser.add_argument("--by", metavar="FIELD,...", help="fields for --gradient (default all numbers of the scene)")


def execute(
    arguments: argparse.Namespace, command: Callable[[argparse.Namespace], screen.CommandResult]
) -> screen.CommandResult:
    """Print derivatives with the analysis, and write gradient.csv, where they are asked for."""
    if arguments.gradient is None and arguments.by is None:
        return command(arguments)
    quantities = () if arguments.gradient is None else arguments.gradient.split(",")
    by = None if arguments.by is None else arguments.by.split(",")
    directory = RunDirectory(arguments.directory)
    analysis = with_derivatives(lambda: analyze.analysis_of(arguments), directory, quantities, by)
    lines = [derivative.cells() for derivative in analysis.derivatives]
    result = analyze.report(arguments, analysis, ("derivatives of quantities by fields", HEAD, lines))
    return screen.CommandResult(result.code, result.data | {"gradient": list(map(asdict, analysis.derivatives))})
