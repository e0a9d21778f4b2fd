"""Contact strength along the chains: a factor on the contact constant of every contact, such as of cylinders at angles.

Contact i lies between beads i and i + 1. A slow ramp leaves the velocity of a pulse as it is, and changes its force and
speed as strength**0.4 (Chaunsali, Kim & Yang, Phil. Trans. R. Soc. A 376, 20170136, 2018).
"""

import math
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Discriminator, Field, Tag, field_validator

from lammps_inputs import strict_yaml
from lammps_inputs.ingredients.base import Part, Positive, ends, refuse_other_count, refuse_range, with_keys
from lammps_inputs.numbers import random_shares
from lammps_inputs.units import PURE, Unit

if TYPE_CHECKING:
    from lammps_inputs.scene import BaseScene

Floats = NDArray[np.float64]
Count = Annotated[int, Field(ge=1, le=10**8)]
Factor = Annotated[Positive, PURE]


@with_keys(
    ends(
        Factor | None,
        "Strength up to the first contact of the ramp.",
        "Strength from the last contact of the ramp on.",
        None,
    )
)
class Profile(Part):
    """A ramp, a cosine and random factors, each absent unless given; the strength is their product."""

    example: ClassVar[str] = "{from: 1, to: 4, contacts: [50, 150]}"

    contacts: tuple[Count, Count] | None = None
    """First and last contact of the ramp; the strength is constant before and after."""
    mean: Factor | None = None
    """Mean of the cosine; 1 if omitted."""
    amplitude: Annotated[float, Field(gt=-1e30, lt=1e30), PURE] | None = None
    """Amplitude of the cosine, smaller than its mean."""
    wavenumber: Annotated[float, Field(ge=-1e6, le=1e6), PURE] | None = None
    """Wavenumber q of the cosine, in cycles per contact."""
    phase: Annotated[float, Field(ge=-360, le=360), Unit("degrees", always=True)] | None = None
    """Phase of the cosine; 0 if omitted."""
    spread: Annotated[float, Field(ge=0, le=0.9), PURE] | None = None
    """Largest relative deviation of the random factors."""
    seed: Annotated[int, Field(ge=0, le=2**63 - 1)] | None = None
    """Seed of the random factors, which are the same on any machine; 1 if omitted."""

    _from_list = field_validator("contacts", mode="before")(strict_yaml.as_tuple)

    def refuse(self, key: str, contacts: int) -> None:
        """Refuse keys that miss others, and strengths that are not positive.

        Raises:
            ValueError: naming the key, what was found and what to do.
        """
        if not self.model_fields_set:
            raise ValueError(f"{key}: names nothing; valid: `strength: {self.example}`")
        parts = {("from", "to", "contacts"): (), ("amplitude", "wavenumber"): ("mean", "phase"), ("spread",): ("seed",)}
        for needed, more in parts.items():
            given = [name for name in (*needed, *more) if getattr(self, name) is not None]
            missing = [name for name in needed if getattr(self, name) is None]
            if given and missing:
                raise ValueError(f"{key}.{missing[0]}: is missing beside {given[0]}")
        refuse_range(f"{key}.contacts", self.contacts, contacts, of="contact", least=1)
        mean = 1.0 if self.mean is None else self.mean
        if self.amplitude is not None and not abs(self.amplitude) < mean:
            raise ValueError(f"{key}.amplitude: {self.amplitude:g} given; smaller than the mean, {mean:g}")

    def of(self, chains: int, contacts: int) -> Floats:
        """Strengths, [chain, contact]; random factors are those of ``numpy.random.default_rng(seed).uniform``."""
        number, found = np.arange(1, contacts + 1), np.ones((chains, contacts))
        if self.contacts is not None:
            found *= np.interp(number, self.contacts, [getattr(self, end) for end in ("from", "to")])
        if self.amplitude is not None:
            assert self.wavenumber is not None
            angle = 2.0 * math.pi * self.wavenumber * number + math.radians(self.phase or 0.0)
            found *= (1.0 if self.mean is None else self.mean) + self.amplitude * np.cos(angle)
        if self.spread:
            least, most = 1.0 - self.spread, 1.0 + self.spread
            shares = random_shares(1 if self.seed is None else self.seed, chains * contacts)
            found *= (least + (most - least) * shares).reshape(chains, contacts)
        return found


def kind(value: Any) -> str:
    """Tag of what is given: keys, a row for all chains, rows of chains, or a number."""
    if isinstance(value, dict | Profile):
        return "<keys>"
    rows = isinstance(value, tuple | list) and any(isinstance(row, tuple | list) for row in value)
    return "<rows>" if rows else "<row>" if isinstance(value, tuple | list) else "<plain>"


_Row = tuple[Factor, ...]
Strength = Annotated[
    Annotated[Factor, Tag("<plain>")]
    | Annotated[Profile, Tag("<keys>")]
    | Annotated[_Row, Tag("<row>")]
    | Annotated[tuple[_Row, ...], Tag("<rows>")],
    Discriminator(kind),
]
"""A number for all contacts, a profile, a list with one for each contact, or a list of such lists, one a chain."""


def refuse(key: str, strength: Any, scene: "BaseScene") -> None:
    """Refuse a strength that does not fit the chains.

    Raises:
        ValueError: naming the key, what was found and what to do.
    """
    contacts = scene.beads - 1
    if isinstance(strength, Profile):
        strength.refuse(key, contacts)
    if not isinstance(strength, tuple):
        return
    rows = strength if isinstance(strength[0] if strength else None, tuple) else (strength,)
    if len(rows) != 1:
        refuse_other_count(key, rows, scene.chains, what="lists")
    for row in rows:
        if len(row) != contacts:
            raise ValueError(f"{key}: {len(row)} numbers for the {contacts} contacts of {scene.beads} beads")


def strengths(strength: Any, scene: "BaseScene") -> float | Floats:
    """A number, or [chain, contact]."""
    shape = (scene.chains, scene.beads - 1)
    if isinstance(strength, Profile):
        return strength.of(*shape)
    return np.array(np.broadcast_to(strength, shape)) if isinstance(strength, tuple) else float(strength)
