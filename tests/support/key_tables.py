"""Tables of keys in the scene reference, made from the types; ``python tests/support/key_tables.py`` renews them."""

import functools
import importlib.resources
import re
import textwrap
import typing
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from lammps_inputs import materials, references, schema
from lammps_inputs.deck_atoms import DeckAtoms
from lammps_inputs.ingredients import coupling, foundation, initial, plastic, profile, unequal
from lammps_inputs.ingredients.contact import Contact
from lammps_inputs.ingredients.contacts.power import PowerContact
from lammps_inputs.ingredients.registry import INGREDIENTS
from lammps_inputs.output import Forces, Limits, Output, Spectra
from lammps_inputs.scene import Kick, Material, Scene
from lammps_inputs.units import Unit

_TYPES: list[type[BaseModel]] = [
    Material,
    Kick,
    Output,
    Forces,
    Spectra,
    Limits,
    coupling.Ramp,
    profile.Profile,
    profile.Gaps,
]
_TYPES += [DeckAtoms, initial.LastFrame]
_TYPES += [foundation.GroundRamp, foundation.Modulation, plastic.Yield]
_TYPES += [unequal.BeadKind, unequal.Replacement, unequal.Disorder, unequal.Striker]
_TYPES += [kind for ingredient in INGREDIENTS.values() for kind in ingredient.kinds()]
PARTS = {model.__name__: model for model in _TYPES}
"""Types whose keys have a table, by name."""

PAGES = ("SCENES.md", "MODEL.md")

_UNBOUNDED = 1e6
"""Bounds beyond it guard against overflow only."""


def renewed(page: str) -> str:
    """The page with all that stands between ``<!-- KIND: NAMES -->`` and ``<!-- end -->``, and the list of references.

    KIND is ``keys`` (NAMES: one of `PARTS`, or keys of a scene), ``sources`` (keys of publications) or ``materials``.
    """
    mark = re.compile(r"(<!-- (keys|sources|materials): ([\w ]+) -->\n).*?(<!-- end -->)", re.S)
    made = {"keys": table, "sources": _sources, "materials": _materials}
    page = mark.sub(lambda found: found[1] + made[found[2]](found[3]) + found[4], page)
    head, mark_of_list, rest = page.partition("<!-- references -->\n")
    listed = "".join(f"{number}. {references.text(key)}.\n" for number, key in enumerate(references.bibtex(), 1))
    return head + mark_of_list + (listed + rest[rest.index("<!-- end -->") :] if mark_of_list else "")


def _sources(keys: str) -> str:
    """A line that names publications."""
    return textwrap.fill(f"Source: {'; '.join(map(references.short, keys.split()))}.", 118, **_UNBROKEN) + "\n"


_UNBROKEN: dict[str, Any] = {"break_long_words": False, "break_on_hyphens": False}


def _materials(_: str) -> str:
    """Rows of the catalogue of materials."""
    heads = ("name", "meaning", "E (GPa)", "nu", "density (kg/m3)", "yield strength (MPa)", "source")
    rows = [f"| {' | '.join(heads)} |", "|---" * len(heads) + "|"]
    for name, solid in materials.CATALOGUE.items():
        soft = f"{solid.yield_strength / 1e6:g}" if solid.yield_strength else "-"
        numbers = f"{solid.youngs_modulus / 1e9:g} | {solid.poisson_ratio:g} | {solid.density:g} | {soft}"
        rows.append(f"| `{name}` | {solid.meaning} | {numbers} | {references.short(solid.source)} |")
    return "\n".join(rows) + "\n"


@functools.cache
def _schema(model: type[BaseModel]) -> dict[str, Any]:
    return schema.of(model, model.__name__)


@functools.cache
def table(name: str) -> str:
    """Rows of key, unit, valid values, default and meaning."""
    model: type[BaseModel] = PARTS.get(name, Scene)
    chosen = list(model.model_fields) if name in PARTS else name.split()
    if model is unequal.Striker:
        chosen = [key for key in chosen if key not in unequal.BeadKind.model_fields]
    if issubclass(model, Contact) and model is not PowerContact:  # whose table is above the others
        shared = PowerContact.model_fields
        chosen = [key for key in chosen if key not in shared or str(model.model_fields[key]) != str(shared[key])]
    described, meaning = _schema(model), schema.meanings(model)
    defs = described.get("$defs", {})
    # of a part that may be a number, too, its keys
    described = next((option for option in described.get("anyOf", ()) if "properties" in option), described)
    rows = ["| key | unit | valid | default | meaning |", "|---|---|---|---|---|"]
    for key in chosen:
        field, spelled = model.model_fields[key], described["properties"][key]
        default = "required" if key in described.get("required", ()) else _value(spelled.get("default"))
        cells = (f"`{key}`", _unit(field), _valid(spelled, defs), default, meaning[key])
        rows.append(f"| {' | '.join(cells)} |")
    return "\n".join(rows) + "\n"


def _unit(field: Any) -> str:
    """Of a number, or of the numbers in a list; with a material."""
    units = [part for part in (*field.metadata, *_annotated(field.annotation)) if isinstance(part, Unit)]
    return next((unit.si if isinstance(unit.si, str) else unit.si({"contact": {}}) for unit in units), "")


def _annotated(annotation: Any) -> list[Any]:
    """All that annotations within a type hold, but for those of the keys of parts."""
    own = list(getattr(annotation, "__metadata__", ()))
    return own + [found for part in typing.get_args(annotation) for found in _annotated(part)]


def _valid(spelled: dict[str, Any], defs: dict[str, Any]) -> str:
    """What a JSON schema allows, in few words."""
    if "$ref" in spelled:
        name = spelled["$ref"].rpartition("/")[2]
        return _valid(defs[name], defs) if name in defs else name
    options = spelled.get("anyOf") or spelled.get("oneOf")
    if options:
        return " or ".join(dict.fromkeys(_valid(option, defs) for option in options))
    if "const" in spelled or "enum" in spelled:
        return ", ".join(f"`{_value(value)}`" for value in spelled.get("enum", [spelled.get("const")]))
    kind = spelled.get("type")
    if kind == "object":
        keys, values = spelled.get("properties"), spelled.get("additionalProperties")
        by_number = isinstance(values, dict) and values.get("type") == "number"
        return f"`{{{', '.join(keys)}}}`" if keys else "`{contact: gap}`" if by_number else "`{name: kind}`"
    if kind == "array":
        prefix = spelled.get("prefixItems")
        if prefix:
            return f"[{', '.join(_valid(item, defs) for item in prefix)}]"
        return (
            "list of " + re.sub(r"\b(number|list)\b", r"\1s", _valid(spelled["items"], defs))
            if "items" in spelled
            else "list"
        )
    if kind == "boolean":
        return "`true`, `false`"
    return _bounds(spelled) if kind in ("number", "integer") else "text"


def _bounds(spelled: dict[str, Any]) -> str:
    """Of a number: the type, and what is more than a guard against overflow."""
    word = "whole number" if spelled["type"] == "integer" else "number"
    least, above = spelled.get("minimum"), spelled.get("exclusiveMinimum")
    most, below = spelled.get("maximum"), spelled.get("exclusiveMaximum")
    said = [
        f"{sign} {bound:g}"
        for sign, bound in ((">=", least), (">", above), ("<=", most), ("<", below))
        if bound is not None and abs(bound) <= _UNBOUNDED
    ]
    return " ".join([word, ", ".join(said)]).strip()


def _value(value: Any) -> str:
    """As in YAML; nothing for what has no plain default."""
    if value is None or isinstance(value, dict | list):
        return ""
    return str(value).lower() if isinstance(value, bool) else f"{value:g}" if isinstance(value, float) else str(value)


if __name__ == "__main__":
    for name in PAGES:
        place = Path(str(importlib.resources.files("lammps_inputs") / name))
        place.write_text(renewed(place.read_text(encoding="utf-8")), encoding="utf-8")
