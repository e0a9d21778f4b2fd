"""What an ingredient of a scene is: keys that a user may write, and what becomes of them."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, ClassVar, NamedTuple, TypeVar, cast

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, create_model

from lammps_inputs import strict_yaml
from lammps_inputs.errors import InputError
from lammps_inputs.facts import Fact
from lammps_inputs.laws import Law, Parameter, dimensionless
from lammps_inputs.links import Links
from lammps_inputs.loads import Load, Motion
from lammps_inputs.system import FurtherLine, Noun, System
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


@dataclass(frozen=True)
class Setting:
    """What ingredients see of the scene that names them: all on which its beads, links and loads depend.

    Attributes:
        chains: number of chains.
        beads: number of beads of each chain.
        gap: clear distance between neighbouring beads, in the units of the scene: a number, or [chain, contact].
        material: material of the beads; None where numbers have no units.
        kicks: initial velocities, those of strikers included.
        scale: dimensionless units in those of the scene.
        contact_scale: exponent and constant of the contacts' force, by which lengths are measured.
        parts: what the scene names, by key; of keys on which forces may depend.
        named: every ingredient, with its key in a scene.

    Examples:
        >>> setting = granchain.load("two-chains").setting
        >>> setting.chains, setting.beads, setting.gap  # gap in the units of the scene
        (2, 120, 0.0)
        >>> [key for key, _ in setting.named]
        ['coupling']
    """

    chains: int
    beads: int
    gap: float | NDArray[np.float64]
    material: Any
    kicks: tuple[Any, ...]
    scale: Scale
    contact_scale: tuple[float, float | None]
    parts: Mapping[str, Any]
    named: "tuple[tuple[str, Ingredient], ...]"

    @property
    def contacts(self) -> tuple[int, int]:
        """Number of chains, and of the contacts of each."""
        return self.chains, self.beads - (not self.closed)

    @property
    def closed(self) -> bool:
        """Whether the last bead of each chain touches the first."""
        return self.part("periodic") is not None

    def at_contacts(self, values: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Values of the beads behind and ahead of each contact, [chain, contact], of values [chain, bead]."""
        return (values, np.roll(values, -1, axis=1)) if self.closed else (values[:, :-1], values[:, 1:])

    @property
    def gap_of_walls(self) -> float:
        """Clear distance of walls from the beads at the ends, which they touch where the scene's gap is no number."""
        gap = self.part("gap")
        return gap if isinstance(gap, float) else 0.0

    def part(self, key: str) -> Any:
        """Part of the scene under a key; None where it names none."""
        return self.parts.get(key)

    def key_of(self, ingredient: "Ingredient") -> str:
        """Key of an ingredient of the scene in messages, with its number where there is a list of several."""
        key = next(key for key, part in self.named if part is ingredient)
        alike = [part for other, part in self.named if other == key]
        number = next(number for number, part in enumerate(alike, 1) if part is ingredient)
        return f"{key}[{number}]" if len(alike) > 1 else key

    def contact_law(self, strength: Parameter) -> Law | None:
        """The dimensionless law of contacts by their strength alone (`Ingredient.contact_law`); None without one."""
        named = (ingredient.contact_law(strength) for _, ingredient in self.named)
        return next((dimensionless(law, self.scale) for law in named if law is not None), None)

    def law_between(self, strength: Parameter, solids: "Callable[[], Solids]") -> Law | None:
        """The dimensionless law of the contacts of solids (`Ingredient.law_between`); None where it is Hertz's."""
        named = (ingredient.law_between(self, strength, solids) for _, ingredient in self.named)
        return next((law for law in named if law is not None), None)


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


def refuse_outside(key: str, place: Any, chains: int, beads: int) -> None:
    """Refuse a bead, of attributes ``chain`` and ``bead``, outside the array.

    Raises:
        ValueError: naming the key.
    """
    for name, number, last in (("chain", place.chain, chains), ("bead", place.bead, beads)):
        if number > last:
            raise ValueError(f"{key}.{name}: {number} is outside the array ({name}s 1 to {last})")


def in_rows(values: Any, rows: tuple[int, int] | None, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """Values, broadcast to [..., bead], from the first to the last of some rows, all if omitted; 0 in others."""
    table = np.array(np.broadcast_to(values, shape), dtype=np.float64)
    if rows is not None:
        table[..., : rows[0] - 1] = table[..., rows[1] :] = 0.0
    return table


class Solids(NamedTuple):
    """Two solids in contact, as two equal beads whose contact is theirs, in those of the reference bead.

    Attributes:
        radius: radius of these beads, a number or an array over contacts, as all that follows.
        modulus: plane modulus E / (1 - nu^2) of these beads.
        softer: lower yield strength of the two solids.
    """

    radius: Parameter
    modulus: Parameter
    softer: Parameter


def table_text(path: Path, owner: str, most: int) -> str:
    """Text of a file with a table.

    Args:
        path: the file.
        owner: what has the table, such as "a push", for messages.
        most: number of bytes that it may have.

    Raises:
        InputError: it cannot be read, is larger, or is no text.
    """
    reason = f"{path}: the table of {owner} cannot be read"
    try:
        with path.open("rb") as file:
            raw = file.read(most + 1)
        content = raw.decode("utf-8-sig")
    except (OSError, ValueError) as error:
        why = (error.strerror if isinstance(error, OSError) else None) or "it is not a text file"
        raise InputError(f"{reason}: {why}") from None
    if len(raw) > most:
        raise InputError(f"{reason}: it is larger than {most >> 20} MiB")
    return content


class FurtherAtoms(NamedTuple):
    """Lines of atoms that are no beads, such as a mass inside each bead; frames of all beads hold them.

    Attributes:
        mass: [line, bead], of lines of as many places as a chain has; 0 where there is no atom.
        ties: links of these lines, which count on from the chains, with chains and each other; their law is 0 where
            there is no atom.
        dampers: dashpots of these lines, counted in the same way.
        noun: what one atom is called, and several: in the energy budget, deviations, exported frames and on pages.
        chain_of_line: chain that each line belongs to, counted from 0; empty where the lines are those of all chains in
            turn, once or several times.

    Examples:
        >>> mass = np.where(np.arange(1, 31) == 10, 0.1, 0.0)[np.newaxis]  # at bead 10, of one line of 30 places
        >>> spring = laws.spring.Linear(np.where(mass > 0.0, 0.05, 0.0))
        >>> tie = Links.across("absorber", spring, edges=((0, 2),))  # chain 1 of two with the line after both
        >>> atoms = FurtherAtoms(mass, (tie,), noun=("absorber", "absorbers"), chain_of_line=(0,))
        >>> [(line.chain, line.noun.plural) for line in atoms.lines(2)]
        [(0, 'absorbers')]
    """

    mass: NDArray[np.float64]
    ties: tuple[Links, ...]
    dampers: tuple[Links, ...] = ()
    noun: tuple[str, str] = ("inner atom", "inner atoms")
    chain_of_line: tuple[int, ...] = ()

    def lines(self, chains: int) -> tuple[FurtherLine, ...]:
        """The lines of a system of so many chains."""
        of_line = self.chain_of_line or (np.arange(len(self.mass)) % chains).tolist()
        noun = Noun(*self.noun)
        return tuple(FurtherLine(mass, chain, noun) for mass, chain in zip(self.mass, of_line, strict=True))


def together(
    chains: int, each: Iterable[FurtherAtoms]
) -> tuple[tuple[FurtherLine, ...], tuple[Links, ...], tuple[Links, ...]]:
    """Lines of all atoms that ingredients add to so many chains, their ties and dashpots.

    Lines of one ingredient stand in those of another of the same noun and chain whose places are free, else after them.
    """
    lines: list[FurtherLine] = []
    ties: list[Links] = []
    dampers: list[Links] = []
    for atoms in each:
        added = atoms.lines(chains)
        first = next(n for n in range(len(lines) + 1) if all(map(_free, lines[n:], added)))
        shared = [replace(line, mass=line.mass + more.mass) for line, more in zip(lines[first:], added, strict=False)]
        lines[first : first + len(added)] = [*shared, *added[len(shared) :]]
        ties += [link.counted_on(chains, first) for link in atoms.ties]
        dampers += [link.counted_on(chains, first) for link in atoms.dampers]
    return tuple(lines), tuple(ties), tuple(dampers)


def _free(line: FurtherLine, added: FurtherLine) -> bool:
    """Whether the atoms of another line may stand in a line."""
    return (line.chain, line.noun) == (added.chain, added.noun) and not np.any(line.mass * added.mass)


class Ingredient(ScenePart):
    """A part of a scene that makes links between beads; what is not overridden, it does not do.

    Its annotated fields are its keys in a scene; an entry point of ``granchain.ingredients`` gives its own key.

    Examples:
        >>> class Bed(Ingredient):
        ...     stiffness: float  # in units of m / T^2
        ...     def links(self, setting: Setting) -> tuple[Links, ...]:
        ...         return (Links.ground("bed", laws.spring.Linear(self.stiffness)),)
        >>> [bed] = Bed(stiffness=0.2).links(granchain.load("one-chain").setting)
        >>> bed.strain(np.array([[0.0, 0.3]]))  # [chain, bead], in units of L
        array([[0. , 0.3]])
    """

    takes_away: ClassVar[frozenset[Fact]] = frozenset()
    """What no longer holds where any of its links exist."""
    why: ClassVar[dict[Fact, str]] = {}
    """Reasons for the facts that it removes, for users who ask for what needs them (`BaseScene.wanted`)."""
    several: ClassVar[bool] = False
    """Whether a scene may have a list of them."""
    sources: ClassVar[tuple[str, ...]] = ()
    """Publications of its model, keys of `references.bib`."""
    sources_of_laws: ClassVar[dict[str, dict[str, tuple[str, ...]]]] = {}
    """Publications of the laws that its keys choose: key, such as ``damping.contact`` -> law -> keys."""

    @classmethod
    def kinds(cls) -> "tuple[type[Ingredient], ...]":
        """Classes among which the keys choose, such as one a law; the first where none is chosen."""
        return (cls,)

    @classmethod
    def kind_of(cls, value: Any) -> "type[Ingredient]":  # noqa: ARG003
        """Class that plain data, or an ingredient, is of."""
        return cls

    @classmethod
    def from_files(cls, value: Any, folder: Path) -> Any:  # noqa: ARG003
        """Content of a scene's file with that of the files that it names, which are beside it, in the folder."""
        return value

    def refuse(self, setting: Setting) -> None:
        """Refuse what the scene's other parts make impossible.

        Raises:
            ValueError: naming the key, what was found and what to do.
        """

    def refuse_system(self, setting: Setting, system: System) -> None:
        """Refuse what all ingredients together make impossible, after each has passed `refuse` alone.

        Raises:
            ValueError: as `refuse`.
        """

    def cited(self) -> tuple[str, ...]:
        """Publications of the models that it has chosen."""
        return self.sources

    def links(self, setting: Setting) -> tuple[Links, ...]:  # noqa: ARG002
        """The links that it makes, dimensionless; none where its numbers come to nothing."""
        return ()

    def contact_law(self, strength: Parameter) -> Law | None:  # noqa: ARG002
        """The law of the contacts between beads, where it makes them other than those of spheres.

        Its parameters are in the scene's units, but for those without unit (`lammps_inputs.laws.dimensionless`).

        Args:
            strength: strength over that of two reference beads, a number or [chain, contact].
        """
        return None

    def law_between(self, setting: Setting, strength: Parameter, solids: Callable[[], Solids]) -> Law | None:  # noqa: ARG002
        """The dimensionless law of the contacts of solids, those between beads or with a wall; None where it has none.

        Args:
            setting: the scene that it is part of.
            strength: strength over that of two reference beads, a number or an array over contacts.
            solids: gives the solids in contact, to a law that depends on more than the strength.
        """
        law = self.contact_law(strength)
        return None if law is None else dimensionless(law, setting.scale)

    def contact_scale(self) -> tuple[float, float | None] | None:
        """Exponent p and constant A of a force ``A overlap**p`` by which lengths are measured; without A the usual one.

        None for the contacts of spheres.
        """
        return None

    @property
    def strength_key(self) -> str:
        """Key that changes the strength of the contacts along the chains; empty where none does."""
        return ""

    def strengths(self, setting: Setting) -> Parameter:  # noqa: ARG002
        """Factors on the strengths of the contacts, a number or [chain, contact]."""
        return 1.0

    def dampers(self, setting: Setting) -> tuple[Links, ...]:  # noqa: ARG002
        """Links with laws of damping (`lammps_inputs.laws.dashpot`), dimensionless; they store no energy."""
        return ()

    def further_atoms(self, setting: Setting) -> FurtherAtoms | None:  # noqa: ARG002
        """Lines of atoms beside the chains that it adds, dimensionless."""
        return None

    def lacks(self, setting: Setting) -> frozenset[Fact]:
        """Facts that no longer hold in this scene."""
        return self.takes_away if self.links(setting) else frozenset()

    def reason(self, key: str, fact: Fact) -> str:
        """Key and reason for a fact that it removes, in words for users who ask for what needs the fact."""
        return f"{key}: {self.why.get(fact, f'takes away that {fact.value}')}"

    def speed(self, mass: float) -> float:  # noqa: ARG002
        """Speed of a bead of this mass that it sets in motion, in the scene's units: a measure of V."""
        return 0.0

    def start(self, setting: Setting) -> NDArray[np.float64]:  # noqa: ARG002
        """Atoms that it displaces or sets in motion at the start, [atom, column], dimensionless.

        Columns are the line and the bead, counted from 1, displacement and velocity; lines are the chains, then
        further ones. Entries of one atom add.
        """
        return np.zeros((0, 4))

    @property
    def stores(self) -> bool:
        """Whether it may store energy at the start, which becomes motion."""
        return False

    def released(self, setting: Setting, system: System) -> float:  # noqa: ARG002
        """Speed, dimensionless, that what it stores at the start can give a bead: a measure of V (`stores`)."""
        return 0.0

    def static(self, setting: Setting, mass: float | NDArray[np.float64]) -> float | NDArray[np.float64]:  # noqa: ARG002
        """Force at rest, dimensionless: a number, or [chain, bead + 1] from before the first bead to behind the last.

        Args:
            setting: the scene that it is part of.
            mass: dimensionless masses of the beads, a number or [chain, bead].
        """
        return 0.0

    def loads(self, setting: Setting) -> tuple[Load, ...]:  # noqa: ARG002
        """The forces from outside that it makes, dimensionless."""
        return ()

    def motions(self, setting: Setting) -> tuple[Motion, ...]:  # noqa: ARG002
        """The beads whose motion it gives, dimensionless."""
        return ()
