"""Values that differ from contact to contact: lists, and profiles of a ramp, a cosine and random factors.

Contact n lies between beads n and n + 1.

Examples:
    >>> strengths = profile.Profile.model_validate({"from": 1.0, "to": 4.0, "contacts": (1, 4)})
    >>> strengths.of((1, 5))  # [chain, contact]
    array([[1., 2., 3., 4., 4.]])
"""

import math
from typing import Annotated, Any, ClassVar, TypeVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Discriminator, Field, Tag

from lammps_inputs.ingredients import base
from lammps_inputs.ingredients.base import Phase, Positive, Rows, ScenePart, Seed, Setting, Spread
from lammps_inputs.numbers import random_shares
from lammps_inputs.units import PURE

Floats = NDArray[np.float64]
Factor = Annotated[Positive, PURE]


@base.with_keys(
    base.ends(
        Factor | None,
        "Value up to the first contact of the ramp.",
        "Value from the last contact of the ramp on.",
        None,
    )
)
class Profile(ScenePart):
    """A ramp, a cosine and random factors, each absent unless given; values are their product."""

    example: ClassVar[str] = "{from: 1, to: 4, contacts: [50, 150]}"

    contacts: Rows | None = None
    """First and last contact of the ramp; values are constant before and after."""
    mean: Factor | None = None
    """Mean of the cosine, or of what random factors multiply; if omitted 1, or the default of the key without a ramp.
    """
    amplitude: Annotated[float, Field(gt=-1e30, lt=1e30), PURE] | None = None
    """Amplitude of the cosine, smaller than its mean."""
    wavenumber: Annotated[float, Field(ge=-1e6, le=1e6), PURE] | None = None
    """Wavenumber q of the cosine, in cycles per contact."""
    phase: Phase | None = None
    """Phase of the cosine; 0 if omitted."""
    spread: Spread | None = None
    """Largest relative deviation of the random factors."""
    seed: Seed | None = None
    """Seed of the random factors, which are the same on any machine; 1 if omitted."""

    def refuse(self, key: str, contacts: int, mean: float) -> None:
        """Refuse keys that miss others, and values that are not positive.

        Raises:
            ValueError: naming the key, what was found and what to do.
        """
        if not self.model_fields_set:
            raise ValueError(f"{key}: names nothing; valid: `{key.rpartition('.')[2]}: {self.example}`")
        parts = {("from", "to", "contacts"): (), ("amplitude", "wavenumber"): ("phase",), ("spread",): ("seed",)}
        for needed, more in parts.items():
            named = [name for name in (*needed, *more) if getattr(self, name) is not None]
            missing = [name for name in needed if getattr(self, name) is None]
            if named and missing:
                raise ValueError(f"{key}.{missing[0]}: is missing beside {named[0]}")
        base.refuse_range(f"{key}.contacts", self.contacts, contacts, of="contact", least=1)
        mean = self._mean(mean)
        if self.amplitude is not None and not abs(self.amplitude) < mean:
            raise ValueError(f"{key}.amplitude: {self.amplitude:g} given; smaller than the mean, {mean:g}")

    def of(self, shape: tuple[int, int], mean: float = 1.0) -> Floats:
        """Values, [chain, contact]; random factors are those of ``numpy.random.default_rng(seed).uniform``.

        Args:
            shape: number of chains, and of contacts of each.
            mean: value in place of a ramp and a mean, where neither is given.
        """
        number, values = np.arange(1, shape[1] + 1), np.full(shape, self._mean(mean))
        if self.amplitude is not None:
            assert self.wavenumber is not None
            angle = 2.0 * math.pi * self.wavenumber * number + math.radians(self.phase or 0.0)
            values += self.amplitude * np.cos(angle)
        if self.contacts is not None:
            values = np.interp(number, self.contacts, [getattr(self, end) for end in ("from", "to")]) * values
        if self.spread:
            least, largest = 1.0 - self.spread, 1.0 + self.spread
            shares = random_shares(1 if self.seed is None else self.seed, shape[0] * shape[1])
            values *= (least + (largest - least) * shares).reshape(shape)
        return values

    def _mean(self, mean: float) -> float:
        """Mean of the cosine; the value in its place where there is no ramp either."""
        return self.mean if self.mean is not None else mean if self.contacts is None else 1.0


def kind_of_values(value: Any) -> str:
    """Tag of what is given: keys, a row for all chains, rows of chains, or a number."""
    if isinstance(value, dict | Profile):
        return "<keys>"
    rows = isinstance(value, tuple | list) and any(isinstance(row, tuple | list) for row in value)
    return "<rows>" if rows else "<row>" if isinstance(value, tuple | list) else "<plain>"


Number = TypeVar("Number")
Listed = Annotated[
    Annotated[Profile, Tag("<keys>")]
    | Annotated[tuple[Number, ...], Tag("<row>")]
    | Annotated[tuple[tuple[Number, ...], ...], Tag("<rows>")],
    Discriminator(kind_of_values),
]
"""A profile, a list with a number for each contact, or a list of such lists, one a chain."""

Values = Annotated[
    Annotated[Number, Tag("<plain>")]
    | Annotated[Profile, Tag("<keys>")]
    | Annotated[tuple[Number, ...], Tag("<row>")]
    | Annotated[tuple[tuple[Number, ...], ...], Tag("<rows>")],
    Discriminator(kind_of_values),
]
"""A number for all contacts, or what differs (`Listed`)."""


def values_of(key: str, given: Any, setting: Setting, mean: float = 1.0) -> float | Floats:
    """Values of the contacts: a number, or [chain, contact].

    Args:
        key: key in messages.
        given: a number, a profile, a list or a list of lists.
        setting: the scene.
        mean: see `Profile.of`.

    Raises:
        ValueError: they do not fit the chains; names the key, what was found and what to do.
    """
    shape = (setting.chains, setting.beads - 1)
    if isinstance(given, Profile):
        given.refuse(key, shape[1], mean)
        return given.of(shape, mean)
    if not isinstance(given, tuple):
        return float(given)
    rows = given if isinstance(given[0] if given else None, tuple) else (given,)
    if len(rows) != 1:
        base.refuse_other_count(key, rows, setting.chains, noun="lists")
    for row in rows:
        if len(row) != shape[1]:
            raise ValueError(f"{key}: {len(row)} numbers for the {shape[1]} contacts of {setting.beads} beads")
    return np.array(np.broadcast_to(rows, shape))
