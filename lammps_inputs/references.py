"""The publications behind the models, `references.bib`: as text, as BibTeX, and those that a scene uses."""

import functools
import importlib.resources
import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from lammps_inputs.scene import BaseScene

SCHEMES = {"verlet": "swope1982", "suzuki4": "suzuki1990"}


@functools.cache
def bibtex() -> dict[str, str]:
    """BibTeX entry of each publication, by its key."""
    page = (importlib.resources.files("lammps_inputs") / "references.bib").read_text(encoding="utf-8")
    entries = [entry.strip() for entry in re.split(r"^(?=@)", page, flags=re.M) if entry]
    return {entry.partition("{")[2].partition(",")[0]: entry for entry in entries}


def text(key: str) -> str:
    """A publication in one line."""
    entry = dict(re.findall(r"^  (\w+) = {(.*)},?$", bibtex()[key], flags=re.M))
    *others, last = entry["author"].replace(" and others", " et al.").split(" and ")
    place = f"{entry['journal']} {entry['volume']}, {entry['pages']}" if "journal" in entry else entry["publisher"]
    doi = f", doi:{entry['doi']}" if "doi" in entry else ""
    return f"{', '.join(others)}{' & ' * bool(others)}{last}, {entry['title']}, {place} ({entry['year']}){doi}"


def of_scene(scene: "BaseScene") -> dict[str, list[str]]:
    """What a paper on a scene cites: subject -> keys of `bibtex`."""
    exponent = scene.contact_scale[0]
    found = {"contacts": ["hertz1882"] if exponent == 1.5 else ["nesterenko2001", "spadoni2010"]}
    if scene.pattern:
        found["pattern"] = ["jayaprakash2011"]
    for key, ingredient in scene.named:
        if keys := ingredient.cited():
            found[key] = list(keys)
    found["engine"] = ["thompson2022", SCHEMES[scene.scheme or "verlet"]]
    return found | {"reference integrator": ["blanes2002"]}
