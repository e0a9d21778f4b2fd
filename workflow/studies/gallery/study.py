"""Makes the gallery: entries side by side in processes of their own, each kept in a folder, then one page of all.

What an entry leaves is kept: its runs, which a later start takes, and its section of the page, which stays when only
other entries are asked for.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from lammps_inputs import InputError, html
from lammps_inputs.library import suggestion
from workflow.studies import page
from workflow.studies.gallery import entries
from workflow.studies.gallery.entries import ENTRIES
from workflow.studies.study import Study
from workflow.workers import evaluate
from workflow.workers.pool import Task

PAGE = "index.html"
FOLDER = "entries"


class Sections(dict[str, page.Section]):
    """Name of an entry -> its section of the page."""

    def __repr__(self) -> str:
        return f"<gallery: {', '.join(self)[:150]}>"

    def _repr_html_(self) -> str:
        words = (page.HOLDS, page.CORRECTED, page.FAILS)
        rows = []
        for name, section in self.items():
            held = [statement.holds for statement in section.statements]
            rows.append((name, *(held.count(word) for word in words), section.failed))
        return html.table("what was published", ("entry", *words, "failed"), rows)


@dataclass(frozen=True)
class Collection:
    """Entries that make a page together.

    Attributes:
        study: its directory.
        names: of its entries.
        title, summary: head of the page.
        said_by: heading of what was published.
        contents: whether a list of the entries with their verdicts comes first.
    """

    study: Study
    names: Sequence[str]
    title: str
    summary: str
    said_by: str
    contents: bool


GALLERY = Collection(
    study=Study("gallery", f"{PAGE} is the page", tables=(PAGE,), others=(FOLDER,)),
    names=tuple(ENTRIES),
    title="Granular chains: what was published, recomputed",
    summary=(
        "Each result was run through LAMMPS and through the reference integrator when this page was made. What was "
        "published stands beside what is found, with a verdict; where the publication itself could not be read, its "
        "section says so. Mass and contact constant of a bead are 1, velocities are in units of the kick V, times in "
        "units of T, unless a line says otherwise."
    ),
    said_by="published",
    contents=True,
)
PAPER = Collection(
    study=Study("reproduce", f"{PAGE} is the report", tables=(PAGE,), others=(FOLDER,)),
    names=entries.PAPER,
    title="Pulse equipartition in coupled granular chains, recomputed",
    summary=(
        "Every number and figure on this page was computed when it was made: nothing is copied from the paper but its "
        "statements. Velocities are in units of the kick V, times in units of T."
    ),
    said_by="the paper says",
    contents=False,
)


def gallery(
    directory: Path,
    names: Sequence[str] = (),
    *,
    collection: Collection = GALLERY,
    progress: evaluate.Progress | None = None,
) -> Sections:
    """Run entries, and write the page of these and of those that earlier starts have left.

    Args:
        directory: made if need be, or resumed.
        names: of the entries to run; all of the collection by default.
        collection: what the page holds.
        progress: called with the entries done, all that are run, and how many of them failed.

    Returns:
        The sections of the entries that were asked for, in the page's order; of one that failed it says why.

    Raises:
        InputError: no such entry; the directory cannot be written, or holds such a file of somebody else's.
    """
    known, folder = collection.names, directory / FOLDER
    for name in names:
        if name not in known:
            raise InputError(f"--only: {name!r} is no entry{suggestion(name, known)}; there are {', '.join(known)}")
    asked = [name for name in known if name in names or not names]
    with collection.study.opened(directory):
        folder.mkdir(exist_ok=True)
        found = _side_by_side(asked, folder.absolute(), progress)
        shown = {name: found.get(name) or page.kept(folder / name) for name in known}
        sections = [section for section in shown.values() if section is not None]
        text = page.render(
            collection.title,
            collection.summary,
            sections,
            said_by=collection.said_by,
            contents=collection.contents,
        )
        collection.study.write(directory, {PAGE: text})
    return Sections({name: found[name] for name in asked})


def _side_by_side(names: Sequence[str], folder: Path, progress: evaluate.Progress | None) -> dict[str, page.Section]:
    """The section of each entry; runs of an earlier start are used again by the entry itself."""
    cases = [
        evaluate.Case(name, Task(f"{__name__}:run_entry", {"name": name, "folder": str(folder)})) for name in names
    ]
    found = {}
    for name, answer in evaluate.evaluate(cases, progress=progress).items():
        section = None if answer.failed else page.kept(folder / name)
        found[name] = section or page.Section(name, "", (), failed=answer.failed or "its section cannot be read")
    return found


def run_entry(name: str, folder: str) -> None:
    """Run one entry in its own folder, and keep its section there."""
    own = Path(folder) / name
    runs = own / "runs"
    runs.mkdir(parents=True, exist_ok=True)
    page.keep(ENTRIES[name].build(runs), own)
