"""Laws, schemes and gallery entries with their sources, in MODEL.md; ``python -m`` of this module renews the table."""

import importlib.resources
from pathlib import Path

from granchain.parts import references
from workflow.plugins.gallery.entries import ENTRIES

PAGE = Path(str(importlib.resources.files("lammps_inputs") / "MODEL.md"))
BEGIN, END = "<!-- table of sources -->\n", "<!-- end -->"


def renewed(page: str) -> str:
    """The page with the table between its marks."""
    head, begin, rest = page.partition(BEGIN)
    return head + begin + table() + rest[rest.index(END) :]


def table() -> str:
    """Rows of subject and numbers of the list of references."""
    cited = references.of_models()
    cited |= {f"gallery: `{name}`, {entry.title}": [*entry.sources] for name, entry in ENTRIES.items()}
    rows = ["| law, scheme or gallery entry | references |", "|---|---|"]
    rows += [
        f"| {subject} | [{', '.join(map(str, sorted(map(references.number, keys))))}] |"
        for subject, keys in cited.items()
    ]
    return "\n".join(rows) + "\n"


if __name__ == "__main__":
    PAGE.write_text(renewed(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
