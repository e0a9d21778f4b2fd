"""The publications behind the models, `references.bib`: as text, as BibTeX, and those that a scene uses.

Examples:
    >>> references.text("hertz1882").partition(",")[0]
    'H. Hertz'
    >>> references.of_scene(granchain.load("plastic-contacts"))["contacts"]
    ['hertz1882']
"""

import functools
import importlib.resources
import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from lammps_inputs.scene import BaseScene

UNEQUAL = {"pattern": "jayaprakash2011", "taper": "doney2006", "disorder": "ponson2010", "striker": "sokolow2007"}
HERTZ, POWER_LAW, GRADED = "hertz1882", ("nesterenko2001", "spadoni2010"), "chaunsali2018"
LAMMPS, REFERENCE = "thompson2022", "blanes2002"
SCHEMES = {"verlet": "swope1982", "suzuki4": "suzuki1990"}
ENGINES = [LAMMPS, SCHEMES["verlet"], REFERENCE]
"""What every run by LAMMPS, checked against the reference, cites."""

OF_ENGINE, OF_REFERENCE = "engine", "reference integrator"
"""Subjects of `of_scene`: publications of LAMMPS and its scheme, and of the reference."""

LINKS = {"doi": "doi", "eprint": "arXiv"}
"""Field of an entry that leads to the publication -> its prefix."""


@functools.cache
def bibtex() -> dict[str, str]:
    """BibTeX entry of each publication, by its key."""
    page = (importlib.resources.files("lammps_inputs") / "references.bib").read_text(encoding="utf-8")
    entries = [entry.strip() for entry in re.split(r"^(?=@)", page, flags=re.M) if entry]
    return {entry.partition("{")[2].partition(",")[0]: entry for entry in entries}


def text(key: str) -> str:
    """A publication in one line."""
    entry = _fields(key)
    *others, last = entry.get("author", "").replace(" and others", " et al.").split(" and ")
    authors = f"{', '.join(others)}{' & ' * bool(others)}{last}"
    named = ", ".join(filter(None, (authors, entry["title"], _place(entry))))
    links = "".join(f", {name}:{entry[field]}" for field, name in LINKS.items() if field in entry)
    return f"{named} ({entry['year']}){links}"


def number(key: str) -> int:
    """Place of a publication in the list of references of MODEL.md, from 1."""
    return list(bibtex()).index(key) + 1


def short(key: str) -> str:
    """Authors, year and DOI of a publication."""
    entry = _fields(key)
    names = [re.sub(r"^(\S+\. )+", "", author) for author in entry.get("author", entry["title"]).split(" and ")]
    several = f"{', '.join(names[:-1])} & {names[-1]}" if names[1:] else names[0]
    listed = f"{names[0]} et al." if len(names) > 3 or "others" in names else several
    named = next((f"{LINKS[link]}:{entry[link]}" for link in LINKS if link in entry), "")
    place = named if "doi" in entry else _place(entry) or named
    return f"{listed} ({entry['year']}), {place}"


def _fields(key: str) -> dict[str, str]:
    return dict(re.findall(r"^  (\w+) = {(.*)},?$", bibtex()[key], flags=re.M))


def _place(entry: dict[str, str]) -> str:
    if "journal" in entry:
        return entry["journal"] + (f" {entry['volume']}, {entry['pages']}" if "volume" in entry else "")
    return entry.get("publisher", "")


def of_models() -> dict[str, list[str]]:
    """Laws and schemes that a scene can choose: subject -> keys of `bibtex`."""
    from lammps_inputs.ingredients.contact import Contact
    from lammps_inputs.ingredients.registry import INGREDIENTS

    sources = {"contacts of spheres": [HERTZ], "`contact.strength`": [GRADED]}
    sources |= {f"`contact.{law.key}`": [*law.sources] for law in Contact.laws() if law.sources}
    sources |= {f"`{key}`": [source] for key, source in UNEQUAL.items()}
    sources |= {f"`{key}`": [*kind.sources] for key, kind in INGREDIENTS.items() if kind.sources}
    kinds = (kind for ingredient in INGREDIENTS.values() for kind in ingredient.kinds())
    chosen = [choice for kind in kinds for choice in kind.sources_of_laws.items()]
    sources |= {f"`{key}`, law `{law}`": [*keys] for key, laws in chosen for law, keys in laws.items()}
    sources |= {f"`scheme: {name}`": [key] for name, key in SCHEMES.items()}
    return sources | {"engine LAMMPS": [LAMMPS], "reference integrator": [REFERENCE]}


def of_scene(scene: "BaseScene") -> dict[str, list[str]]:
    """Publications that a paper on a scene cites: subject -> keys of `bibtex`."""
    from lammps_inputs.ingredients import unequal

    exponent = scene.contact_scale[0]
    sources = {"contacts": [HERTZ] if exponent == 1.5 else [*POWER_LAW], **unequal.cited(scene.setting)}
    sources |= {key: [source] for key, source in UNEQUAL.items() if getattr(scene, key)}
    for key, ingredient in scene.named:
        if keys := ingredient.cited():
            sources[key] = list(keys)
    sources[OF_ENGINE] = [LAMMPS, SCHEMES[scene.scheme or "verlet"]]
    return sources | {OF_REFERENCE: [REFERENCE]}
