"""Print over how many beads a pulse spreads, by the stiffness of the bed that they stand on."""

import argparse
from pathlib import Path

from granchain.parts import Study, evaluate, options, quantity

EXAMPLES = ("hardness -o hard",)
STUDY = Study("hardness", "hardness.csv is the table", tables=("hardness.csv",), cache="cases.jsonl")
STIFFNESS = (0.5, 1.0, 2.0)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The directory."""
    options.add_output(parser)
    options.add_jobs(parser)


def execute(arguments: argparse.Namespace) -> int:
    """Compute the participation number of the energies at the end for every stiffness."""
    hardness(arguments.output, jobs=arguments.jobs)
    return 0


def hardness(directory: Path | str, *, jobs: int | None = None) -> dict[float, float]:
    """Stiffness of the bed -> participation number of the energies at the end; ``granchain.hardness`` in scripts."""
    scenes = [
        {"name": "case", "beads": 6, "bed": {"quintic": stiffness}, "kick": {"velocity": 1.0}, "duration": 12.0}
        for stiffness in STIFFNESS
    ]
    with STUDY.evaluating(Path(directory), jobs) as values:
        answers = values([evaluate.case(scene, ["participation"], "case") for scene in scenes])
        numbers = [answer["quantities"]["participation"] for answer in answers]
        rows = [{"stiffness": x, "participation": number} for x, number in zip(STIFFNESS, numbers, strict=True)]
        STUDY.write(Path(directory), {"hardness.csv": quantity.csv_of_rows(rows)})
    return dict(zip(STIFFNESS, numbers, strict=True))
