"""Print the JSON schema of scenes, sweeps, designs or sites, for completion and checks in editors."""

import argparse
import json

from granchain.parts import plugins

JOB = "Setting up"
PRINTS = True
EXAMPLES = (
    "schema > scene.schema.json",
    "schema sweep",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the kind of file."""
    names = tuple(plugins.declared("schemas"))
    parser.add_argument("of", choices=names, nargs="?", default="scene", help="default scene")


def execute(arguments: argparse.Namespace) -> int:
    """Print the schema of a kind of file."""
    print(json.dumps(plugins.load("schemas", arguments.of)(), indent=2, ensure_ascii=False))
    return 0
