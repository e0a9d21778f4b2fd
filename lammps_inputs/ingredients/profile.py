"""Values that differ from contact to contact: lists, profiles of a ramp, a cosine and random factors, and gaps.

Contact n lies between beads n and n + 1.

Examples:
    >>> strengths = profile.Profile.model_validate({"from": 1.0, "to": 4.0, "contacts": (1, 4)})
    >>> strengths.of((1, 5))  # [chain, contact]
    array([[1., 2., 3., 4., 4.]])
"""

import math
import re
from typing import Annotated, Any, ClassVar, TypeVar

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, Discriminator, Field, Tag

from lammps_inputs.ingredients import base
from lammps_inputs.ingredients.base import NotNegative, Phase, Positive, Rows, ScenePart, Seed, Spread
from lammps_inputs.numbers import random_shares
from lammps_inputs.units import PURE, Label, Unit

Floats = NDArray[np.float64]
Factor = Annotated[Positive, PURE]


Length = Annotated[NotNegative, Unit("m")]


def _numbers_as_text(value: Any) -> Any:
    """Keys that Python has as whole numbers as the text that files have."""
    if not isinstance(value, dict):
        return value
    text = {str(key): inner for key, inner in value.items()}
    wrong = [key for key in text if not re.fullmatch("[1-9][0-9]{0,7}", key)]
    if wrong or not text:
        raise ValueError("should hold numbers of contacts and their gaps, such as {1: 0.1}")
    return text


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

    def values(self, key: str, shape: tuple[int, int], mean: float) -> Floats:
        """Values, [chain, contact], that fit the chains (`values_of`)."""
        self._refuse(key, shape[1], mean)
        return self.of(shape, mean)

    def _refuse(self, key: str, contacts: int, mean: float) -> None:
        """Refuse keys that miss others, and values that are not positive."""
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
        return values * random_factors(self.spread, self.seed, shape)

    def _mean(self, mean: float) -> float:
        """Mean of the cosine; the value in its place where there is no ramp either."""
        return self.mean if self.mean is not None else mean if self.contacts is None else 1.0


class Gaps(ScenePart):
    """Gaps of single contacts by their numbers, or random ones."""

    example: ClassVar[str] = "{mean: 0.1, spread: 0.5}"

    contacts: Annotated[Annotated[dict[str, Length], BeforeValidator(_numbers_as_text)] | None, Label("gap")] = None
    """Gaps of contacts by their numbers, `{1: 0.1, 3: 0.3}`, in every chain; other beads touch."""
    mean: Annotated[Positive, Unit("m")] | None = None
    """Mean of random gaps."""
    spread: Spread | None = None
    """Largest relative deviation of random gaps from their mean."""
    seed: Seed | None = None
    """Seed of random gaps, which are the same on any machine; 1 if omitted."""

    def values(self, key: str, shape: tuple[int, int], mean: float) -> Floats:  # noqa: ARG002
        """Gaps, [chain, contact], that fit the chains (`values_of`)."""
        if (self.contacts is None) == (self.mean is None):
            reason = "neither is given" if self.mean is None else "both are given"
            raise ValueError(f"{key}: give either contacts or mean ({reason}); valid: `{key}: {self.example}`")
        if self.mean is not None and self.spread is None:
            raise ValueError(f"{key}.spread: is missing beside mean")
        if self.mean is None and (self.spread is not None or self.seed is not None):
            raise ValueError(f"{key}.mean: is missing beside {'seed' if self.spread is None else 'spread'}")
        if self.mean is not None:
            return np.full(shape, self.mean) * random_factors(self.spread, self.seed, shape)
        gaps = np.zeros(shape)
        for contact, gap in (self.contacts or {}).items():
            if int(contact) > shape[1]:
                raise ValueError(f"{key}.contacts: {contact} is outside the chain (contacts 1 to {shape[1]})")
            gaps[:, int(contact) - 1] = gap
        return gaps


def random_factors(spread: float | None, seed: int | None, shape: tuple[int, int]) -> float | Floats:
    """Factors of ``numpy.random.default_rng(seed).uniform(1 - spread, 1 + spread, shape)``; 1 without a spread."""
    if not spread:
        return 1.0
    least, largest = 1.0 - spread, 1.0 + spread
    shares = random_shares(1 if seed is None else seed, shape[0] * shape[1])
    return np.asarray(least + (largest - least) * shares).reshape(shape)


def kind_of_values(value: Any) -> str:
    """Tag of what is given: keys, a row for all chains, rows of chains, or a number."""
    if isinstance(value, dict | ScenePart):
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


GapValues = Annotated[
    Annotated[Length, Tag("<plain>")]
    | Annotated[Gaps, Tag("<keys>")]
    | Annotated[tuple[Length, ...], Tag("<row>")]
    | Annotated[tuple[tuple[Length, ...], ...], Tag("<rows>")],
    Discriminator(kind_of_values),
]
"""A gap of all contacts, gaps by contact or at random, a list, or a list of such lists, one a chain."""


def values_of(key: str, given: Any, shape: tuple[int, int], mean: float = 1.0) -> float | Floats:
    """Values of the contacts: a number, or [chain, contact].

    Args:
        key: key in messages.
        given: a number, a profile or gaps, a list or a list of lists.
        shape: number of chains, and of contacts of each.
        mean: see `Profile.of`.

    Raises:
        ValueError: they do not fit the chains; names the key, what was found and what to do.
    """
    if isinstance(given, Profile | Gaps):
        return given.values(key, shape, mean)
    if not isinstance(given, tuple):
        return float(given)
    rows = given if isinstance(given[0] if given else None, tuple) else (given,)
    if len(rows) != 1:
        base.refuse_other_count(key, rows, shape[0], noun="lists")
    for row in rows:
        if len(row) != shape[1]:
            raise ValueError(f"{key}: {len(row)} numbers for the {shape[1]} contacts of a chain")
    return np.array(np.broadcast_to(rows, shape))
