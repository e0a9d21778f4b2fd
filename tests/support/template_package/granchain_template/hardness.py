"""Print over how many beads a pulse spreads, by the stiffness of the bed that they stand on."""

import argparse
from pathlib import Path

from workflow.study_kit import scene_quantities
from workflow.study_kit.directory import Study, csv_text
from workflow.study_kit.options import add_jobs, add_output

EXAMPLES = ("hardness -o hard",)
STUDY = Study("hardness", "hardness.csv is the table", tables=("hardness.csv",), cache="cases.jsonl")
STIFFNESS = (0.5, 1.0, 2.0)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The directory."""
    add_output(parser)
    add_jobs(parser)


def execute(arguments: argparse.Namespace) -> int:
    """Compute the participation number of the energies at the end for every stiffness."""
    directory: Path = arguments.output
    scenes = [
        {"name": "case", "beads": 6, "bed": {"quintic": stiffness}, "kick": {"velocity": 1.0}, "duration": 12.0}
        for stiffness in STIFFNESS
    ]
    with STUDY.evaluating(directory, arguments.jobs) as values:
        answers = values([scene_quantities.case(scene, ["participation"], "case") for scene in scenes])
        rows = [
            {"stiffness": stiffness, "participation": answer["quantities"]["participation"]}
            for stiffness, answer in zip(STIFFNESS, answers, strict=True)
        ]
        STUDY.write(directory, {"hardness.csv": csv_text(rows)})
    return 0
