"""Compute published results on granular chains and compare them with the publications, as an HTML page.

Entries are computed in parallel, each in a folder, then one page of all is written. The folder of an entry holds its
runs, which a later start uses again, and its section of the page, which remains when only other entries are asked for.
"""

import argparse
from collections.abc import Sequence
from pathlib import Path

from granchain import InputError
from granchain.parts import Study, checked, complaints, computations, html, output_directory, screen
from workflow.plugins.gallery import statements
from workflow.plugins.gallery.criteria import RULE
from workflow.plugins.gallery.entries import ENTRIES, GROUPS, LONG, LONGEST

PAGE = "index.html"
FOLDER = "entries"


class Sections(dict[str, statements.Section]):
    """Name of an entry -> its section of the page."""

    def __repr__(self) -> str:
        return f"<gallery: {', '.join(self)[:150]}>"

    def _repr_html_(self) -> str:
        rows = [(name, *section.verdicts.values(), section.failed) for name, section in self.items()]
        return html.table("statements", ("entry", *statements.VERDICTS, "failed"), rows)


STUDY = Study("gallery", f"{PAGE} is the page", tables=(PAGE,), others=(FOLDER,))
TITLE = "Granular chains: published results, recomputed"
SUMMARY = (
    "Each result was computed by LAMMPS and by the reference integrator when its section was made. Where a "
    "publication could not be read, its section says what is known of it. Mass and contact constant of a bead are "
    "1; V is the kick velocity, T = L / V and L = (m V^2 / A)^(2/5) the units of time and length, unless a line "
    "says otherwise."
)


@checked
def gallery(directory: Path | str, names: Sequence[str] = (), *, everything: bool = False) -> Sections:
    """Compute published results and compare them with the publications; writes ``index.html``.

    Args:
        directory: new, or resumed.
        names: entries to run, or groups of them such as ``paper``; by default all but those of ``paper-open``.
        everything: whether those are run, too, and the finest grids.

    Returns:
        The section of the page of each of these entries, by its name; that of one that failed says why.

    Raises:
        InputError: there is no such entry, or the directory cannot be used.

    Examples:
        >>> sections = granchain.gallery("published", ["tapered"])
        >>> list(sections), sections["tapered"].failed
        (['tapered'], '')
    """
    _chosen(names, everything, "names")
    with screen.count_bar("gallery") as progress:
        return carry_out(Path(directory), names, everything=everything, progress=progress)


def carry_out(
    directory: Path,
    names: Sequence[str] = (),
    *,
    everything: bool = False,
    progress: computations.Progress | None = None,
) -> Sections:
    """Run entries, and write the page of these and of those that earlier starts have run.

    Args:
        directory: made if need be, or resumed.
        names: of the entries to run, or of groups of them such as ``paper``; by default all but ``paper-open``.
        everything: whether those are run, too, and the finest grids.
        progress: called with the entries done, all that are run, and how many of them failed.

    Returns:
        The sections of these entries, in the order of the page; the section of one that failed says why.

    Raises:
        InputError: no such entry; the directory cannot be written, or has a file of such a name that is not a study's.
    """
    folder = directory / FOLDER
    chosen = _chosen(names, everything)
    with STUDY.opened(directory):
        folder.mkdir(exist_ok=True)
        computed = _side_by_side(chosen, folder.absolute(), progress)
        shown = {name: computed.get(name) or statements.kept(folder / name) for name in ENTRIES}
        sections = [section for section in shown.values() if section is not None]
        STUDY.write(directory, {PAGE: statements.render(TITLE, f"{SUMMARY}\n{RULE}", sections)})
    return Sections({name: computed[name] for name in chosen})


def _chosen(names: Sequence[str], everything: bool = False, argument: str = "ENTRY") -> list[str]:
    """Names of the entries with these names and in groups with these names, in the order of the page.

    Without names all, and, unless everything is asked for, none of those that take long.

    Raises:
        InputError: no entry or group has such a name.
    """
    for name in names:
        if name not in ENTRIES and name not in GROUPS:
            names_and_groups = (*GROUPS, *ENTRIES)
            hint = complaints.suggestion(name, names_and_groups)
            raise InputError(f"{argument}: {name!r} is no entry{hint}; entries are {', '.join(names_and_groups)}")
    chosen = {entry for name in names for entry in GROUPS.get(name, (name,))} or set(ENTRIES)
    if not everything:
        chosen -= (LONGEST if names else LONG) - set(names)
    return [name for name in ENTRIES if name in chosen]


def _side_by_side(
    names: Sequence[str], folder: Path, progress: computations.Progress | None
) -> dict[str, statements.Section]:
    """Run entries in parallel: name -> section; each entry uses runs of an earlier start again."""
    cases = [
        computations.case(f"{__name__}:run_entry", {"name": name, "folder": str(folder)}, key=name) for name in names
    ]
    sections = {}
    for name, answer in computations.evaluate(cases, progress=progress).items():
        section = None if answer.failed else statements.kept(folder / name)
        sections[name] = section or statements.Section(
            name, "", (), failed=answer.failed or "its section cannot be read"
        )
    return sections


def run_entry(name: str, folder: str) -> None:
    """Run one entry in its own folder, and write its section there."""
    entry_folder = Path(folder) / name
    runs = entry_folder / "runs"
    runs.mkdir(parents=True, exist_ok=True)
    files = statements.files_of(ENTRIES[name].build(runs))
    output_directory.record_files(entry_folder, files)
    STUDY.write(entry_folder, files)


# --- command ----------------------------------------------------------------------------------------------------------

EXAMPLES = (
    "gallery -o gallery                # a minute; the same command resumes; then open gallery/index.html",
    "gallery paper -o gallery          # the statements and figures of the paper; some ten seconds",
    "gallery dimers -o gallery         # this entry; the others remain",
    "gallery paper-open -o open        # what the paper leaves open; four minutes",
    "gallery --list",
)

ANSWERS = "each entry with its title, its verdicts, and why it failed"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("entries", metavar="ENTRY", nargs="*", help="entries to run, or `paper`, `paper-open`")
    parser.add_argument("--all", action="store_true", help="also entries that take long, and finer grids")
    where = parser.add_mutually_exclusive_group(required=True)
    where.add_argument("-o", "--output", metavar="DIR", type=Path, help="new directory, or one to resume")
    where.add_argument("--list", action="store_true", help="print the names of the entries, and run nothing")


def execute(arguments: argparse.Namespace) -> screen.CommandResult:
    """Print the names, or run entries, write the page and print the verdicts; exit code 1 if one could not be run."""
    if arguments.list:
        print("\n".join(ENTRIES))
        return screen.CommandResult(0, list(ENTRIES))
    directory = arguments.output
    with screen.count_bar("gallery") as progress:
        sections = carry_out(directory, arguments.entries, everything=arguments.all, progress=progress)
    rows, plain = [], []
    for name, section in sections.items():
        counts = section.verdicts
        rows.append([name, *(str(count or "-") for count in counts.values()), "failed" if section.failed else ""])
        plain.append({"name": name, "title": section.title, **counts, "failed": section.failed or None})
    screen.print_table("statements", ["entry", *statements.VERDICTS, ""], rows)
    for name, section in sections.items():
        if section.failed:
            print(f"{name} failed: {screen.one_line(section.failed)}")
    screen.print_files(directory, (PAGE,))
    return screen.CommandResult(int(any(section.failed for section in sections.values())), plain)
