"""Words of the command line that no page of the manual is about, and what each means: for `granchain help`.

Options and words that they take, keys of files, installed scenes, and materials.
"""

import argparse
import functools
import importlib
import re
import textwrap
from collections.abc import Collection, Iterator, Mapping
from typing import Any, Literal, NamedTuple, get_args, get_origin

from pydantic import BaseModel

from granchain import Scene, materials
from granchain.parts import cli, complaints, installed_scenes, options, plugins

WIDTH = 100


class WordMeaning(NamedTuple):
    """What a word means: where it belongs to, and a sentence."""

    where: str
    meaning: str

    @property
    def text(self) -> str:
        """Both, wrapped."""
        line = f"{self.where}: {self.meaning}" if self.meaning else self.where
        return "\n".join(textwrap.wrap(line, WIDTH, initial_indent="    ", subsequent_indent="      "))


def explained(word: str) -> str:
    """All that a word means, one below the other; empty where it is none of these words."""
    plain = word.lstrip("-").replace("_", "-") if word.startswith("-") else word
    named = [*explanations().get(plain, ()), *(explanations().get(word.replace("_", "-"), ()) if "_" in word else ())]
    lines = [explanation.text for explanation in dict.fromkeys(named)]
    lines += [of_file(kind) for kind, keys in keys_of_files().items() if word in keys]
    return "\n".join([word, *lines]) if lines else ""


def words() -> list[str]:
    """All words that `explained` explains."""
    return [*explanations(), *(key for keys in keys_of_files().values() for key in keys), *words_of(Scene)]


def words_of(model: type[BaseModel]) -> Iterator[str]:
    """Words that fields of a model, and of its parts, take in place of numbers."""
    for field in model.model_fields.values():
        yield from _words_in(field.annotation)
        for part in complaints.models_in(field.annotation):
            yield from words_of(part)


def _words_in(kind: Any) -> Iterator[str]:
    if get_origin(kind) is Literal:
        yield from (word for word in get_args(kind) if isinstance(word, str))
    for inside in get_args(kind):
        yield from _words_in(inside)


@functools.cache
def explanations() -> Mapping[str, list[WordMeaning]]:
    """Word -> its explanations; options stand without their hyphens."""
    meanings: dict[str, list[WordMeaning]] = {}
    for word, explanation in (*_of_commands(), *_of_scenes(), *_of_materials()):
        entries = meanings.setdefault(word, [])
        same = next((k for k, entry in enumerate(entries) if entry.meaning == explanation.meaning), None)
        if same is None:
            entries.append(explanation)
        else:  # several commands have the option
            shared = f"{entries[same].where}, {explanation.where.removeprefix('granchain ')}"
            entries[same] = WordMeaning(shared, explanation.meaning)
    return meanings


def _of_commands() -> Iterator[tuple[str, WordMeaning]]:
    """Options of all commands, the words that options and arguments take, and formats of files."""
    for name in cli.COMMANDS:
        parser = argparse.ArgumentParser(f"granchain {name}")
        cli.fill(parser, cli.module_of(name))
        for action in parser._actions:
            usage = " ".join(filter(None, [action.option_strings[-1] if action.option_strings else "", _taken(action)]))
            meaning = parser._get_formatter()._expand_help(action) if action.help else ""
            explanation = WordMeaning(f"granchain {name} {usage}", meaning)
            for option in action.option_strings:
                yield option.lstrip("-"), explanation
            for word in action.choices or _listed(meaning):
                yield str(word), explanation


def _taken(action: argparse.Action) -> str:
    """What an option takes, as in its usage."""
    metavar = action.metavar
    return " ".join(metavar) if isinstance(metavar, tuple) else metavar or ""


def _listed(meaning: str) -> list[str]:
    """Words that a help lists after "of", or explains one by one (``netcdf: frames; csv: tables``)."""
    match = re.search(r"\bof ((?:[a-z][\w-]*, )+[a-z][\w-]*)", meaning)
    return [*(match[1].split(", ") if match else ()), *re.findall(r"(?:^|; )([a-z][a-z0-9]+): ", meaning)]


def _of_scenes() -> Iterator[tuple[str, WordMeaning]]:
    for name, description in installed_scenes.descriptions().items():
        yield name, WordMeaning(f"installed scene, `granchain show {name}`", description)


def _of_materials() -> Iterator[tuple[str, WordMeaning]]:
    for name, solid in materials.items():
        constants = (
            f"{solid.meaning}; Young's modulus {solid.youngs_modulus:g} Pa, Poisson's ratio {solid.poisson_ratio:g}, "
            f"density {solid.density:g} kg/m^3"
        )
        yield name, WordMeaning("material", constants)


# --- files ------------------------------------------------------------------------------------------------------------


def kinds() -> dict[str, str]:
    """Kind of a file that a command of that name takes -> module that has an example in its docstring."""
    points = plugins.declared("schemas")
    return {name: points[name].module for name in cli.COMMANDS if name in points}


@functools.cache
def keys_of_files() -> dict[str, tuple[str, ...]]:
    """Kind of a file -> its keys, also within others."""
    of_scene = plugins.load("schemas", "scene")()["$defs"]
    return {kind: tuple(_keys(plugins.load("schemas", kind)(), of_scene)) for kind in kinds()}


def _keys(schema: Mapping[str, object], of_scene: Collection[str]) -> Iterator[str]:
    """Keys of a file by its JSON schema, but for those of its scene, whose definitions have these names."""
    properties = schema.get("properties", {})
    assert isinstance(properties, dict)
    for key, part in properties.items():
        yield key
        if isinstance(part, dict) and key not in ("scene", "beside"):
            yield from _keys(part, of_scene)
    definitions = schema.get("$defs", {})
    assert isinstance(definitions, dict)
    for name, definition in definitions.items():
        if name not in of_scene:
            yield from _keys(definition, of_scene)


def of_file(kind: str) -> str:
    """Example of a file of a kind, below a heading."""
    example = textwrap.indent(options.example_file(importlib.import_module(kinds()[kind])), " " * 6)
    return f"    in a {kind} file, which `granchain {kind} FILE -o DIR` takes:\n{example}"
