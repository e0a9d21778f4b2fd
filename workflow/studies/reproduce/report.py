"""Makes the report: builds every section, writes the figures and the page."""

from pathlib import Path

from workflow.runs.own_files import claim
from workflow.runs.study_directory import study_directory
from workflow.runs.whole_files import write_bytes, write_text
from workflow.studies import page
from workflow.studies.kept_runs import Say
from workflow.studies.reproduce import section2, section3

PAGE = "index.html"

SECTIONS = (section2.build, section3.build)


def reproduce(directory: Path, say: Say) -> Path:
    """Compute the paper's numbers and figures and write them to a directory; finished runs in it are used again.

    Args:
        directory: made if need be.
        say: told what is going on.

    Raises:
        InputError: the directory cannot be written, or holds such a file of somebody else's.
        RunError: a run failed.
    """
    runs = directory / "runs"
    with study_directory(directory, "reproduce", (runs.name, PAGE), result=f"{PAGE} is the report"):
        runs.mkdir(exist_ok=True)
        sections = [build(runs, say) for build in SECTIONS]
        pictures = [picture for section in sections for picture in section.pictures]
        claim(directory, (f"{picture.name}.png" for picture in pictures))
        for picture in pictures:
            write_bytes(directory / f"{picture.name}.png", picture.image)
        text = page.render(
            "Pulse equipartition in coupled granular chains, recomputed",
            "Every number and figure on this page was computed when it was made: nothing is copied from the paper but "
            "its statements. Velocities are in units of the kick V, times in units of T.",
            sections,
        )
        write_text(directory / PAGE, text)
    return directory / PAGE
