"""What an ingredient of a scene is: keys that a user may write, and what becomes of them."""

from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any, ClassVar, NamedTuple, Protocol, TypeVar, cast

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, create_model

from lammps_inputs import strict_yaml
from lammps_inputs.facts import Fact
from lammps_inputs.laws import Law, Parameter
from lammps_inputs.links import Across, Link
from lammps_inputs.loads import Load, Motion
from lammps_inputs.system import System
from lammps_inputs.units import PURE, Label, Scale, Unit

Positive = Annotated[float, Field(gt=0, le=1e30)]
NotNegative = Annotated[float, Field(ge=0, le=1e30)]
Stiffness = Annotated[NotNegative, Unit("N/m")]
Cubic = Annotated[NotNegative, Unit("N/m3")]
Coefficient = Annotated[NotNegative, Unit("kg/s")]
Phase = Annotated[float, Field(ge=-360, le=360), Unit("degrees", always=True)]
Seed = Annotated[int, Field(ge=0, le=2**63 - 1)]
Spread = Annotated[float, Field(ge=0, le=0.9), PURE]
Count = Annotated[int, Field(ge=1, le=2**31 - 1)]
Row = Annotated[int, Field(ge=1, le=10**8)]
Rows = Annotated[tuple[Row, Row], BeforeValidator(strict_yaml.as_tuple)]


class ScenePart(BaseModel):
    """Keys of a scene that belong together: frozen, and none that is not known."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)

    alone: ClassVar[str | None] = None
    """Key of a number that may be written in place of the part."""

    example: ClassVar[str] = ""
    """A valid value in YAML, shown where something else than keys and values is given."""


class SceneContext(Protocol):
    """A scene as its ingredients see it: counts, units and its other parts (`lammps_inputs.scene.BaseScene`)."""

    @property
    def chains(self) -> int:
        """Number of chains."""

    @property
    def beads(self) -> int:
        """Number of beads of each chain."""

    @property
    def gap(self) -> float:
        """Clear distance between neighbouring beads, in the units of the scene."""

    @property
    def material(self) -> Any:
        """Material of the beads; None where numbers have no units."""

    @property
    def kinds(self) -> Any:
        """Kinds of beads by name."""

    @property
    def pattern(self) -> Any:
        """Kinds along the chains."""

    @property
    def replace(self) -> Any:
        """Single beads of another kind."""

    @property
    def taper(self) -> Any:
        """Fraction by which each radius is smaller than that before."""

    @property
    def disorder(self) -> Any:
        """Random differences between the beads."""

    @property
    def striker(self) -> Any:
        """First bead with its own mass and velocity."""

    @property
    def duration(self) -> float | None:
        """Time at which the run ends; None where a bead ends it."""

    @property
    def scheme(self) -> str | None:
        """Integration scheme; None for the default."""

    @property
    def window(self) -> Any:
        """Rows near the front that are simulated; None for all."""

    @property
    def output(self) -> Any:
        """What is recorded, and how often."""

    @property
    def scale(self) -> Scale:
        """Dimensionless units in those of the scene."""

    @property
    def contact_scale(self) -> tuple[float, float | None]:
        """Exponent and constant of the contacts' force, by which lengths are measured."""

    @property
    def kicks(self) -> tuple[Any, ...]:
        """Initial velocities, those of strikers included."""

    @property
    def system(self) -> System:
        """Beads, links and kicks, dimensionless."""

    @property
    def ingredients(self) -> "tuple[Ingredient, ...]":
        """Every ingredient that the scene names."""

    def part(self, key: str) -> Any:
        """Part of the scene under a key; None where it names none."""

    def key_of(self, ingredient: "Ingredient") -> str:
        """Key of an ingredient in messages."""

    def contact_law(self, strength: Parameter) -> Law | None:
        """Dimensionless law of contacts of a strength; None where it is Hertz's."""


Model = TypeVar("Model", bound=BaseModel)


def with_keys(keys: dict[str, Any]) -> Callable[[type[Model]], type[Model]]:
    """Adds keys that are words of Python's, such as ``from``, which cannot be written as attributes."""

    def extended(model: type[Model]) -> type[Model]:
        about: dict[str, Any] = {"__base__": model, "__module__": model.__module__, "__doc__": model.__doc__}
        return cast(type[Model], create_model(model.__name__, **about, **keys))

    return extended


def ends(unit: Any, first: str, last: str, default: Any = ...) -> dict[str, Any]:
    """Keys ``from`` and ``to`` of a ramp, for `with_keys`: type, and meaning of each."""
    meanings = {"from": (first, "value before the ramp"), "to": (last, "value after the ramp")}
    return {
        key: (Annotated[unit, Field(description=meaning), Label(words)], default)
        for key, (meaning, words) in meanings.items()
    }


def refuse_range(key: str, places: tuple[int, int] | None, last: int, *, of: str = "bead", least: int = 0) -> None:
    """Refuse a first and a last place that are not in this order, at least so far apart, and within the chain.

    Raises:
        ValueError: naming the key.
    """
    if places is not None and not places[0] + least <= places[1] <= last:
        raise ValueError(f"{key}: {places[0]} to {places[1]} given; from a {of} to a later one, within {last}")


def refuse_other_count(key: str, values: Any, chains: int, *, noun: str = "numbers") -> None:
    """Refuse a tuple that does not have one value for each chain.

    Raises:
        ValueError: naming the key.
    """
    if isinstance(values, tuple) and len(values) != chains:
        raise ValueError(f"{key}: {len(values)} {noun} for {chains} chains; one, or one for each")


def refuse_outside(key: str, place: Any, scene: SceneContext) -> None:
    """Refuse a bead, of attributes ``chain`` and ``bead``, outside the array.

    Raises:
        ValueError: naming the key.
    """
    for name, number, last in (("chain", place.chain, scene.chains), ("bead", place.bead, scene.beads)):
        if number > last:
            raise ValueError(f"{key}.{name}: {number} is outside the array ({name}s 1 to {last})")


def in_rows(values: Any, rows: tuple[int, int] | None, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """Values, broadcast to [..., bead], from the first to the last of some rows, all if omitted; 0 in others."""
    table = np.array(np.broadcast_to(values, shape), dtype=np.float64)
    if rows is not None:
        table[..., : rows[0] - 1] = table[..., rows[1] :] = 0.0
    return table


class FurtherAtoms(NamedTuple):
    """Lines of atoms that are no beads, such as a mass inside each bead; frames of all beads hold them.

    Attributes:
        mass: [line, bead], of lines of as many places as a chain has; 0 where there is no atom.
        ties: links of these lines, which count on from the chains, with chains and each other; their law is 0 where
            there is no atom.
        dampers: dashpots of these lines, counted in the same way.
    """

    mass: NDArray[np.float64]
    ties: tuple[Across, ...]
    dampers: tuple[Across, ...] = ()


class Ingredient(ScenePart):
    """A part of a scene that makes links between beads; what is not overridden, it does not do."""

    takes_away: ClassVar[frozenset[Fact]] = frozenset()
    """What no longer holds where any of its links exist."""
    why: ClassVar[dict[Fact, str]] = {}
    """Reasons for the facts that it removes, for users who ask for what needs them (`BaseScene.wanted`)."""
    several: ClassVar[bool] = False
    """Whether a scene may have a list of them."""
    sources: ClassVar[tuple[str, ...]] = ()
    """Publications of its model, keys of `references.bib`."""

    @classmethod
    def from_files(cls, value: Any, folder: Path) -> Any:  # noqa: ARG003
        """Content of a scene's file with that of the files that it names, which are beside it, in the folder."""
        return value

    def refuse(self, scene: SceneContext) -> None:
        """Refuse what the scene's other parts make impossible.

        Raises:
            ValueError: naming the key, what was found and what to do.
        """

    def refuse_system(self, scene: SceneContext, system: System) -> None:
        """Refuse what all ingredients together make impossible, after each has passed `refuse` alone.

        Raises:
            ValueError: as `refuse`.
        """

    def cited(self) -> tuple[str, ...]:
        """Publications of the models that it has chosen."""
        return self.sources

    def links(self, scene: SceneContext) -> tuple[Link, ...]:  # noqa: ARG002
        """The links that it makes, dimensionless; none where its numbers come to nothing."""
        return ()

    def contact_law(self, strength: Parameter) -> Law | None:  # noqa: ARG002
        """The law of the contacts between beads, where it makes them other than those of spheres.

        Its parameters are in the scene's units, but for those without unit (`lammps_inputs.laws.dimensionless`).

        Args:
            strength: strength over that of two reference beads, a number or [chain, contact].
        """
        return None

    def contact_scale(self) -> tuple[float, float | None] | None:
        """Exponent p and constant A of a force ``A overlap**p`` by which lengths are measured; without A the usual one.

        None for the contacts of spheres.
        """
        return None

    @property
    def strength_key(self) -> str:
        """Key that changes the strength of the contacts along the chains; empty where none does."""
        return ""

    def strengths(self, scene: SceneContext) -> Parameter:  # noqa: ARG002
        """Factors on the strengths of the contacts, a number or [chain, contact]."""
        return 1.0

    def dampers(self, scene: SceneContext) -> tuple[Link, ...]:  # noqa: ARG002
        """Links with laws of damping (`lammps_inputs.laws.dashpot`), dimensionless; they store no energy."""
        return ()

    def further_atoms(self, scene: SceneContext) -> FurtherAtoms | None:  # noqa: ARG002
        """Lines of atoms beside the chains that it adds, dimensionless."""
        return None

    def lacks(self, scene: SceneContext) -> frozenset[Fact]:
        """Facts that no longer hold in this scene."""
        return self.takes_away if self.links(scene) else frozenset()

    def speed(self, mass: float) -> float:  # noqa: ARG002
        """Speed of a bead of this mass that it sets in motion, in the scene's units: a measure of V."""
        return 0.0

    def static(self, scene: SceneContext, mass: float | NDArray[np.float64]) -> float | NDArray[np.float64]:  # noqa: ARG002
        """Force at rest, dimensionless: a number, or [chain, bead + 1] from before the first bead to behind the last.

        Args:
            scene: scene that it is part of.
            mass: dimensionless masses of the beads, a number or [chain, bead].
        """
        return 0.0

    def loads(self, scene: SceneContext) -> tuple[Load, ...]:  # noqa: ARG002
        """The forces from outside that it makes, dimensionless."""
        return ()

    def motions(self, scene: SceneContext) -> tuple[Motion, ...]:  # noqa: ARG002
        """The beads whose motion it gives, dimensionless."""
        return ()
