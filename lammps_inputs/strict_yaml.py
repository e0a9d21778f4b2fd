"""YAML as engineers read it: one mapping, no duplicate keys, ``1e-5`` is a number, ``1:30`` and ``yes`` are text.

No tags, anchors or aliases either, so what is read is dictionaries, lists, text, numbers, truth values and null.

Nothing here depends on scenes.

Examples:
    >>> strict_yaml.parse("{beads: 20, kick: {velocity: 1e-1}}", "mine.yaml")
    {'beads': 20, 'kick': {'velocity': 0.1}}
    >>> strict_yaml.parse("{beads: 20, beads: 30}", "mine.yaml")
    Traceback (most recent call last):
        ...
    lammps_inputs.errors.InputError: mine.yaml: line 1: key 'beads' is given twice
    >>> strict_yaml.as_tuple([1, [2, 3]])
    (1, (2, 3))
"""

import re
from pathlib import Path
from typing import Any

import yaml
from yaml.composer import Composer
from yaml.constructor import SafeConstructor

from lammps_inputs.errors import InputError

MAX_BYTES = 8 << 20
MAX_VALUES = 30_000
"""Keys, values, lists and mappings: what is read within a second or two."""


def as_tuple(value: Any) -> Any:
    """Value that was read, with tuples for lists, as frozen parts of a scene have them."""
    return tuple(map(as_tuple, value)) if isinstance(value, list) else value


_TEXT, _INT = "tag:yaml.org,2002:str", "tag:yaml.org,2002:int"


class _Strict(Composer, SafeConstructor):
    """Nodes and values of events; refuses duplicate keys, keys that are not text, tags, anchors and aliases."""

    yaml_implicit_resolvers: dict[Any, Any] = {}  # noqa: RUF012  PyYAML's own attribute
    values = 0

    def compose_node(self, parent: Any, index: Any) -> Any:
        event = self.peek_event()  # type: ignore[attr-defined]
        self.values += 1
        if self.values > MAX_VALUES:
            raise _refusal(f"more than {MAX_VALUES:,} keys and values", event)
        if isinstance(event, yaml.NodeEvent) and event.anchor is not None:
            raise _refusal("anchors and aliases are not read here; write the value out", event)
        if isinstance(event, yaml.ScalarEvent | yaml.CollectionStartEvent) and event.tag is not None:
            raise _refusal("tags (`!...`) are not read here; write the plain value", event)
        return super().compose_node(parent, index)

    def construct_mapping(self, node: Any, deep: bool = False) -> dict[Any, Any]:
        keys = set()
        before = None
        for key_node, value_node in node.value:
            key = key_node.value
            if node.flow_style and before is not None and _is_decimal_comma(before, key_node, value_node):
                raise _refusal(
                    f"`{before.value},{key}` has a comma, which begins another entry; "
                    f"write a number with a point: {before.value}.{key}",
                    key_node,
                )
            before = value_node
            if key_node.tag == _INT and re.fullmatch("[1-9][0-9]*", key):
                key_node.tag = _TEXT  # a number of the user's, such as of a contact
            if key_node.tag != _TEXT or not key.isprintable():
                raise _refusal("keys are plain words", key_node)
            if key in keys:
                raise _refusal(f"key {key!r} is given twice", key_node)
            keys.add(key)
        return super().construct_mapping(node, deep)


class _Loader(_Strict, yaml.SafeLoader):
    """A safe loader in Python, whose messages on what is no YAML are those of `_ADVICE`."""


_LIBYAML: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
"""Loader of libyaml where PyYAML was built with it."""


class _FastLoader(_Strict, _LIBYAML):  # type: ignore[misc]
    """A safe loader of the same values, with the events of libyaml."""

    def __init__(self, stream: str) -> None:
        _LIBYAML.__init__(self, stream)
        Composer.__init__(self)


def _is_decimal_comma(before: Any, key: Any, value: Any) -> bool:
    """Whether an entry without a value, between braces, is what follows the comma of a number such as ``0,1``."""
    lone = isinstance(value, yaml.ScalarNode) and value.value == ""
    digits = isinstance(key, yaml.ScalarNode) and re.fullmatch(r"[0-9]+([eE][-+]?[0-9]+)?", key.value)
    return bool(lone and digits and isinstance(before, yaml.ScalarNode) and re.fullmatch(r"[-+]?[0-9]+", before.value))


def _refusal(problem: str, where: Any) -> yaml.MarkedYAMLError:
    return yaml.MarkedYAMLError(problem=problem, problem_mark=where.start_mark)


class _Dumper(yaml.SafeDumper):
    """A safe dumper that quotes text which `_Loader` would take for a number, such as ``1e5``, but for keys."""

    def represent_mapping(self, tag: str, mapping: Any, flow_style: bool | None = None) -> yaml.MappingNode:
        node = super().represent_mapping(tag, mapping, flow_style)
        for key, _ in node.value:
            if key.tag == _TEXT and re.fullmatch("[1-9][0-9]*", key.value):
                key.tag = _INT
        return node


def _text_node(dumper: _Dumper, text: str) -> yaml.ScalarNode:
    """Lines of text as they are; text with odd line breaks (NEL, U+2028) in double quotes, where they are escaped."""
    lines = text.endswith("\n") and all(line.isprintable() for line in text.split("\n"))
    style = None if text.isprintable() else "|" if lines else '"'
    return dumper.represent_scalar("tag:yaml.org,2002:str", text, style=style)


_Dumper.add_representer(str, _text_node)


for _tag, _pattern, _first in (
    ("bool", r"true|false|True|False", "tfTF"),
    ("int", r"[-+]?(?:0|[1-9][0-9]*)", "-+0123456789"),
    ("float", r"[-+]?(?:[0-9]+\.[0-9]*|\.[0-9]+|[0-9]+(?=[eE]))(?:[eE][-+]?[0-9]+)?", "-+.0123456789"),
    ("float", r"[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN)", "-+."),
    ("null", r"~|null|Null|NULL|", ["~", "n", "N", ""]),
):
    for _class in (_Loader, _FastLoader, _Dumper):
        _class.add_implicit_resolver(f"tag:yaml.org,2002:{_tag}", re.compile(f"^(?:{_pattern})$"), list(_first))


_KINDS = {str: "text", list: "a list", int: "a number", float: "a number"}


def parse(text: str, source: str, needed: str = "") -> dict[str, Any]:
    """The mapping that a YAML text holds.

    Args:
        text: the YAML text.
        source: what to call the text in messages, usually the file's path.
        needed: what should stand there, to be said of an empty text.

    Raises:
        InputError: not YAML, empty, not a mapping, a key given twice, too long, or nested beyond reason.
    """
    if len(text) > MAX_BYTES:
        raise InputError(f"{source}: larger than {MAX_BYTES >> 10} KiB, so hardly a scene")
    try:
        try:
            data = yaml.load(text, Loader=_FastLoader)
        except yaml.YAMLError:
            data = yaml.load(text, Loader=_Loader)
    except yaml.MarkedYAMLError as error:
        raise InputError(f"{source}: {_misread(error)}") from None
    except yaml.YAMLError as error:
        raise InputError(f"{source}: {error}") from None
    except RecursionError:
        raise InputError(f"{source}: nested too deeply to be a scene") from None
    except (ValueError, OverflowError):
        raise InputError(f"{source}: holds a number too long to read, or a character that does not exist") from None
    if data is None:
        raise InputError(f"{source}: is empty{'; ' * bool(needed)}{needed}")
    if not isinstance(data, dict):
        raise InputError(f"{source}: holds {_KINDS.get(type(data), 'a value')}, not `key: value` lines")
    return data


_LEVEL = "keys of one part have the same indentation"

_ADVICE = {
    "expected ':'": "write `key: value`, with a space after the colon",
    "expected ',' or": "close the bracket of line {line}, and separate entries by commas",
    "'\\t' that cannot start": "indent with spaces",
    "mapping values are not allowed": _LEVEL,
    "expected <block end>": _LEVEL,
}
"""What to do, by what PyYAML says, and the line where that began."""


def _misread(error: yaml.MarkedYAMLError) -> str:
    """The line, what cannot be read, and what to do."""
    problem = ", ".join(part for part in (error.context, error.problem) if part)
    advice = [advice for part, advice in _ADVICE.items() if part in problem][:1]
    began, mark = error.context_mark, error.problem_mark
    if "expected ':'" in problem:
        mark = began  # what follows is the next line
    line = "" if mark is None else f"line {mark.line + 1}: "
    return line + "; ".join([problem, *(text.format(line=began.line + 1 if began else "") for text in advice)])


def load(path: Path, needed: str = "") -> dict[str, Any]:
    """Read one mapping from a file of at most `MAX_BYTES`.

    Args:
        path: the file.
        needed: as for `parse`.

    Raises:
        InputError: the file is missing, unreadable, not text, or does not parse.
    """
    try:
        with path.open("rb") as file:
            raw = file.read(MAX_BYTES + 1)
    except IsADirectoryError:
        raise InputError(f"{path}: is a directory, not a file") from None
    except FileNotFoundError:
        raise InputError(f"{path}: no such file") from None
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else None
        raise InputError(f"{path}: cannot be read ({reason or error})") from None
    if len(raw) > MAX_BYTES:
        raise InputError(f"{path}: larger than {MAX_BYTES >> 10} KiB, so hardly a scene")
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(f"{path}: is not a text file (UTF-8)") from None
    return parse(text, str(path), needed)


def dump(data: dict[str, Any]) -> str:
    """YAML text of nested plain data, in the order given; numbers round-trip exactly."""
    return yaml.dump(data, Dumper=_Dumper, sort_keys=False, default_flow_style=None, width=1000, allow_unicode=True)
