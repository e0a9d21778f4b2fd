"""Ingredients whose force may be a formula of the scene's: ``force``, with its parameters as keys beside it."""

from typing import TYPE_CHECKING, Annotated, Any

from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    SerializerFunctionWrapHandler,
    ValidationError,
    model_serializer,
    model_validator,
)

from lammps_inputs import plugins
from lammps_inputs.ingredients.base import Ingredient

STIFFEST = 1e12
"""Dimensionless stiffness; beyond it the beads do not move."""


def formulas() -> Any:
    """Module of laws by formula that a distribution declares, with the functions of `lammps_inputs.formulas.force`.

    Raises:
        ValueError: none is installed.
    """
    if "force" not in plugins.declared("laws"):
        raise ValueError("no installed distribution declares laws of formulas (granchain.laws); reinstall granchain")
    return plugins.load("laws", "force")


def _complaint(model: type[BaseModel], force: str, why: str) -> ValidationError:
    error: Any = {"type": "value_error", "loc": ("force",), "input": force, "ctx": {"error": ValueError(why)}}
    return ValidationError.from_exception_data(model.__name__, [error])


def _other_keys_with_force(schema: dict[str, Any]) -> None:
    """Keys that are not known are those of a formula's parameters."""
    schema["anyOf"] = [{"required": ["force"]}, {"propertyNames": {"enum": list(schema["properties"])}}]


class ByFormula(Ingredient):
    """Keys that are known, and with ``force`` one for each parameter that it names."""

    model_config = ConfigDict(extra="allow", json_schema_extra=_other_keys_with_force)
    __pydantic_extra__: dict[str, Annotated[float, Field(ge=-1e30, le=1e30)]]

    if TYPE_CHECKING:  # each subclass declares it, in the order of its keys
        force: str | None

    @model_validator(mode="before")
    @classmethod
    def _known_keys(cls, keys: Any) -> Any:
        """Refuse other keys, and missing parameters.

        Raises:
            ValidationError: naming each of them.
        """
        if not isinstance(keys, dict):
            return keys
        fields = {field.alias or name for name, field in cls.model_fields.items()}
        named = cls.parameters_of(keys.get("force"))
        if named is None and isinstance(keys["force"], str):
            raise _complaint(cls, keys["force"], cls._wrong(keys["force"]))
        if named is None:  # no text
            return {key: value for key, value in keys.items() if key in fields}
        wrong: list[Any] = [
            {"type": "extra_forbidden", "loc": (key,), "input": value}
            for key, value in keys.items()
            if key not in fields and key not in named
        ]
        wrong += [
            {"type": "missing", "loc": (name,), "input": keys}
            for name in named
            if name not in keys and name not in fields
        ]
        if wrong:
            raise ValidationError.from_exception_data(cls.__name__, wrong)
        return keys

    @classmethod
    def parameters_of(cls, force: Any) -> tuple[str, ...] | None:
        """Parameters of a formula; None of what is none."""
        if force is None:
            return ()
        if not isinstance(force, str) or cls._wrong(force):
            return None
        parameters: tuple[str, ...] = formulas().parameters(force)
        return parameters

    @classmethod
    def names_with_meaning(cls) -> frozenset[str]:
        """Keys that no parameter may have as its name."""
        return frozenset(cls.model_fields)

    @classmethod
    def _wrong(cls, force: str) -> str:
        """Reason why a text is no formula of s; empty if it is one."""
        try:
            named = formulas().parameters(force)
        except ValueError as error:
            return str(error)
        meant = next((name for name in named if name in cls.names_with_meaning()), None)
        return "" if meant is None else f"names `{meant}`, a key with another meaning; take another name, such as k"

    @model_serializer(mode="wrap")
    def _without_defaults(self, usual: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Keys of the part; with a formula only those that differ from their defaults."""
        written: dict[str, Any] = usual(self)
        if self.force is None:
            return written
        fields = type(self).model_fields
        return {key: value for key, value in written.items() if key not in fields or value != fields[key].default}

    @property
    def formula(self) -> Any:
        """The force and its parameters, in the scene's units (`lammps_inputs.formulas.force.Force`); None where it is
        no formula.
        """
        if self.force is None:
            return None
        return formulas().Force(self.force, tuple(sorted((self.__pydantic_extra__ or {}).items())))

    def refuse_beside(self, part: str, *keys: str) -> None:
        """Refuse keys that say what the formula says.

        Raises:
            ValueError: naming the first.
        """
        for key in keys if self.formula is not None else ():
            if getattr(self, key) != type(self).model_fields[key].default:
                raise ValueError(f"{part}.{key}: {part}.force is the whole force; leave one of them out")
