"""Print what a paper that uses a scene should cite, as text and BibTeX."""

import argparse
from importlib.metadata import version

from granchain.parts import library, references, screen
from workflow.plugins.cite import software

JOB = "Scenes"
PRINTS = True
ANSWERS = "subject -> keys of the publications"
EXAMPLES = ("cite two-chains", "cite my.yaml --bibtex > references.bib")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the scene and the form of the output."""
    parser.add_argument("scene", metavar="SCENE", help="a YAML file, or the name of an installed scene")
    parser.add_argument("--bibtex", action="store_true", help="print BibTeX entries only")


def execute(arguments: argparse.Namespace) -> screen.CommandResult:
    """Print software, engine, laws and schemes, each with its source."""
    cited = references.of_scene(library.find(arguments.scene))
    if arguments.bibtex:
        wanted = dict.fromkeys(key for keys in cited.values() for key in keys)
        print("\n".join([software.bibtex(version("granchain")), *(references.bibtex()[key] for key in wanted)]))
        return screen.CommandResult(0, cited)
    print(f"software: {software.in_a_line(version('granchain'))}")
    for subject, keys in cited.items():
        for key in keys:
            print(f"{subject}: {references.text(key)}")
    return screen.CommandResult(0, cited)
