"""JSON schemas of the files that users write, for editors that complete and check them."""

from typing import Any

from pydantic import BaseModel
from pydantic.json_schema import GenerateJsonSchema

from lammps_inputs.scene import SEVERAL, Scene

DIALECT = "https://json-schema.org/draft/2020-12/schema"


class _Untitled(GenerateJsonSchema):
    """Without titles, which would only repeat the keys."""

    def field_title_should_be_set(self, schema: Any) -> bool:  # noqa: ARG002  the base class has it
        """Never."""
        return False


def of(model: type[BaseModel], name: str) -> dict[str, Any]:
    """Schema of what a model reads.

    Args:
        model: with the keys that a file may have.
        name: what the file is.
    """
    found = _written(model.model_json_schema(schema_generator=_Untitled))
    return {"$schema": DIALECT, **found, "title": f"granchain {name}"}


def scene() -> dict[str, Any]:
    """Schema of a scene's file."""
    found = of(Scene, "scene")
    for key in SEVERAL:
        listed = found["properties"][key]
        found["properties"][key] = {"anyOf": [listed["items"], listed]}
    return found


def _written(schema: Any) -> Any:
    """As it stands in a file: null is no value there, and what Python code says about classes is of no use."""
    if isinstance(schema, list):
        return [_written(part) for part in schema]
    if not isinstance(schema, dict):
        return schema
    result = {key: _written(value) for key, value in schema.items() if not (key == "default" and value is None)}
    options = result.get("anyOf")
    if isinstance(options, list):
        kept = [option for option in options if option != {"type": "null"}]
        if len(kept) == 1:
            del result["anyOf"]
            return {**kept[0], **result}
        result["anyOf"] = kept
    return result
