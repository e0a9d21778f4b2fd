"""JSON schemas of the files that users write, for editors that complete and check them.

Examples:
    >>> of_limits = schema.of(output.Limits, "site")
    >>> of_limits["title"], sorted(of_limits["properties"])
    ('granchain site', ['gigabytes', 'hours'])
"""

import ast
import functools
import inspect
import re
import textwrap
from typing import Any

from pydantic import BaseModel
from pydantic.json_schema import GenerateJsonSchema

from lammps_inputs.ingredients.registry import SEVERAL
from lammps_inputs.scene import Scene

DIALECT = "https://json-schema.org/draft/2020-12/schema"


class _Untitled(GenerateJsonSchema):
    """Generator of schemas without titles, which would only repeat the keys."""

    def field_title_should_be_set(self, schema: Any) -> bool:  # noqa: ARG002  the base class has it
        """Whether a field has a title: never."""
        return False


def of(model: type[BaseModel], name: str) -> dict[str, Any]:
    """Schema of the files that a model reads.

    Args:
        model: model with the keys of a file.
        name: kind of the file, such as ``scene``.
    """
    schema = _written(model.model_json_schema(schema_generator=_Untitled))
    return {"$schema": DIALECT, **schema, "title": f"granchain {name}"}


def scene() -> dict[str, Any]:
    """Schema of a scene's file."""
    schema = of(Scene, "scene")
    for key in SEVERAL:
        listed = schema["properties"][key]
        schema["properties"][key] = {"anyOf": [listed["items"], listed]}
    return schema


def _written(schema: Any) -> Any:
    """Schema without null, as alternative or default, and without examples of Python, at all depths."""
    if isinstance(schema, str):
        return re.split(r"\n\n(?:Examples:|>>>)", schema)[0]
    if isinstance(schema, list):
        return [_written(part) for part in schema]
    if not isinstance(schema, dict):
        return schema
    result = {key: _written(value) for key, value in schema.items() if not (key == "default" and value is None)}
    options = result.get("anyOf")
    if isinstance(options, list):
        values = [option for option in options if option != {"type": "null"}]
        if len(values) == 1:
            del result["anyOf"]
            return {**values[0], **result}
        result["anyOf"] = values
    return result


def meanings(model: type[BaseModel]) -> dict[str, str]:
    """What stands below each field of a part of a scene, and of the types it is made from, or in the field itself.

    Examples:
        >>> schema.meanings(registry.INGREDIENTS["walls"])["left"]
        'Wall, or dashpot, before the first beads; none if omitted.'
    """
    texts = {key: field.description or "" for key, field in model.model_fields.items()}
    for parent in reversed(model.__mro__[: model.__mro__.index(BaseModel)]):
        texts |= _below_fields(parent)
    return texts


@functools.cache
def _below_fields(model: type) -> dict[str, str]:
    """What stands below each field in the source of one type."""
    try:
        tree = ast.parse(textwrap.dedent(inspect.getsource(model))).body[0]
    except (OSError, TypeError):  # made at run time
        return {}
    assert isinstance(tree, ast.ClassDef)
    return {
        field.target.id: " ".join(str(ast.literal_eval(text.value)).split())
        for field, text in zip(tree.body, tree.body[1:], strict=False)
        if isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name) and isinstance(text, ast.Expr)
    }
