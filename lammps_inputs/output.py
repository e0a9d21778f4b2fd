"""What is recorded, and how often; and what is computed from the frames: forces and spectra.

Plug-ins take this module for limits of output: `too_far_apart` says why no wave is found between frames, `Limits` are
the sizes beyond which no run starts.

Examples:
    >>> scale = granchain.load("one-chain").scale
    >>> output.too_far_apart(3.0, scale)
    'frames are 3 apart, too far to find waves between them; at most 2'
"""

from collections.abc import Iterable
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, field_validator

from lammps_inputs import strict_yaml
from lammps_inputs.facts import Fact
from lammps_inputs.ingredients.base import Count, Positive, ScenePart
from lammps_inputs.system import System
from lammps_inputs.units import Label, Scale, Unit

Recorded = Literal["all"] | tuple[Count, ...]
"""Numbers of the recorded beads of every chain, or all."""

FARTHEST = 2.0
"""Time between frames from which on a wave, which passes a bead in 2 T in contacts of strength 1, is missed; until then
peaks state their uncertainty."""


def too_far_apart(every: float, scale: Scale, pulse_time: float = 1.0) -> str:
    """Why no wave is found between frames so far apart; empty where they are near enough.

    Args:
        every: time between frames, in units of T.
        scale: units in which it is written.
        pulse_time: factor on times of pulses, see `physics.pulse_time`.

    Examples:
        >>> scale = granchain.load("one-chain").problem().scale
        >>> output.too_far_apart(0.1, scale)
        ''
        >>> output.too_far_apart(3.0, scale)
        'frames are 3 apart, too far to find waves between them; at most 2'
    """
    farthest = FARTHEST * pulse_time
    if every <= farthest * (1.0 + 1e-9):
        return ""
    apart, limit = (scale.written(time, "time", ".4g") for time in (every, farthest))
    return f"frames are {apart} apart, too far to find waves between them; at most {limit}"


def each_once(beads: Any, otherwise: str = "") -> Any:
    """The beads of a list, if there are any, and none is named twice.

    Raises:
        ValueError: the list is empty, or a bead is named twice; ``otherwise`` names an alternative.
    """
    if not beads:
        raise ValueError(f"name at least one bead{otherwise}")
    if len(set(beads)) < len(beads):
        raise ValueError("a bead is named twice")
    return beads


class Forces(ScenePart):
    """Places in every chain where forces are evaluated."""

    example: ClassVar[str] = "{contacts: [10]}"

    wall: Literal[True] | None = None
    """Forces on the walls."""
    contacts: tuple[Count, ...] | None = None
    """Force between bead n and bead n + 1, for each n in the list; in damped contacts with the dashpot's."""
    sensors: tuple[Count, ...] | None = None
    """Force inside bead n: the mean of its two contacts, as an embedded sensor measures it."""

    _from_list = field_validator("contacts", "sensors", mode="before")(strict_yaml.as_tuple)

    @field_validator("contacts", "sensors")
    @classmethod
    def _ascending(cls, value: Any) -> Any:
        return None if value is None else tuple(sorted(each_once(value, ", or leave it out")))

    def refuse(self, system: System, recorded: Recorded, *, window: bool) -> None:
        """Refuse places that do not exist, or whose beads are not recorded.

        Args:
            system: beads and walls of the scene.
            recorded: beads that are recorded.
            window: whether the scene has a window.

        Raises:
            ValueError: naming the key, what was found and what to do.
        """
        beads = system.beads
        if self.wall is None and self.contacts is None and self.sensors is None:
            raise ValueError("output.forces: name wall: true, contacts or sensors")
        if window:
            raise ValueError("output.forces: a window removes the beads behind it; leave one of them out")
        walls = system.walls if self.wall else ()
        if self.wall and not walls:
            raise ValueError("output.forces.wall: the chains have no wall; name one in walls, or leave this out")
        contacts, sensors = self.contacts or (), self.sensors or ()
        first, last = (1, beads) if system.closing else (2, beads - 1)
        for bead in contacts:
            if bead > last:
                raise ValueError(f"output.forces.contacts: bead {bead} has no next one (beads 1 to {last} have)")
        for bead in sensors:
            if not first <= bead <= last:
                raise ValueError(
                    f"output.forces.sensors: bead {bead} has no bead on either side (beads {first} to {last} have)"
                )
        needed = {
            "wall": {beads if wall.side > 0.0 else 1 for wall in walls},
            "contacts": {(bead + beside - 1) % beads + 1 for bead in contacts for beside in (0, 1)},
            "sensors": {(bead + beside - 1) % beads + 1 for bead in sensors for beside in (-1, 0, 1)},
        }
        for key, wanted in needed.items():
            if missing := _not_recorded(recorded, wanted):
                raise ValueError(f"output.forces.{key}: needs beads {missing} too; add them to output.beads")


def _not_recorded(recorded: Recorded, beads: Iterable[int]) -> str:
    """Ten at most of these that are not recorded; empty where there are none."""
    return "" if recorded == "all" else ", ".join(map(str, sorted(set(beads) - set(recorded))[:10]))


class Spectra(ScenePart):
    """Spectra of the velocity of beads in every chain."""

    example: ClassVar[str] = "{beads: [1, 20]}"

    beads: tuple[Count, ...]
    """Beads whose spectra are computed; the others are compared with the first."""
    after: Annotated[float, Field(ge=0, le=1e30), Unit("s")] | None = None
    """Start of the analysed part of the record; half of the duration if omitted."""

    _from_list = field_validator("beads", mode="before")(strict_yaml.as_tuple)

    @field_validator("beads")
    @classmethod
    def _named(cls, value: Any) -> Any:
        return each_once(value)

    def refuse(self, beads: int, recorded: Recorded, duration: float | None, *, window: bool) -> None:
        """Refuse beads that do not exist or are not recorded, and times after the end.

        Args:
            beads: number of beads of each chain.
            recorded: beads that are recorded.
            duration: time of the end, in the scene's units; None where a bead ends the run.
            window: whether the scene has a window.

        Raises:
            ValueError: naming the key, what was found and what to do.
        """
        if window:
            raise ValueError("output.spectra: a window removes the beads behind it; leave one of them out")
        if max(self.beads) > beads:
            raise ValueError(f"output.spectra.beads: {max(self.beads)} is outside the array (beads 1 to {beads})")
        if missing := _not_recorded(recorded, self.beads):
            raise ValueError(f"output.spectra.beads: {missing} not recorded; add to output.beads")
        if self.after is not None and duration is not None and self.after >= duration:
            raise ValueError(f"output.spectra.after: {self.after:g} is after the end at {duration:g}")


class Limits(ScenePart):
    """Beyond either, `granchain run` refuses; in a scene, or for all scenes in a site's file.

    Examples:
        >>> output.Limits(gigabytes=200.0)
        Limits(gigabytes=200.0, hours=None)
        >>> output.Limits(gigabytes=200.0).hours is None  # the default holds
        True
    """

    example: ClassVar[str] = "{gigabytes: 200, hours: 100}"

    gigabytes: Annotated[Positive, Unit("GB", always=True)] | None = None
    """Size of all frames; 20 if omitted."""
    hours: Annotated[Positive, Unit("h", always=True)] | None = None
    """Estimated time of the run; 24 if omitted."""


class Output(ScenePart):
    """What is recorded, and how often."""

    example: ClassVar[str] = "{every: 0.1}"

    every: Annotated[Annotated[Positive, Unit("s")] | None, Label("time between frames")] = None
    """Time between frames; 0.1 T if omitted, or the nearest whole number of time steps below that."""
    beads: Recorded = "all"
    """Recorded beads of every chain."""
    forces: Forces | None = None
    """Where forces are evaluated."""
    spectra: Spectra | None = None
    """Beads whose velocity spectra are computed."""

    _from_list = field_validator("beads", mode="before")(strict_yaml.as_tuple)

    @field_validator("beads")
    @classmethod
    def _ascending(cls, value: Any) -> Any:
        return value if value == "all" else tuple(sorted(each_once(value, ", or `all`")))

    def refuse(self, system: System, duration: float | None, *, window: bool) -> None:
        """Refuse what the scene does not have, and what needs more to be recorded.

        Args:
            system: beads and walls of the scene.
            duration: time of the end, in the scene's units; None where a bead ends the run.
            window: whether the scene has a window.

        Raises:
            ValueError: naming the key, what was found and what to do.
        """
        if self.beads != "all" and self.beads[-1] > system.beads:
            raise ValueError(f"output.beads: {self.beads[-1]} is outside the array (beads 1 to {system.beads})")
        if self.forces is not None and self.beads != "all" and not system.holds(Fact.FRAMES):
            raise ValueError("output.beads: frames of all beads hold the memory on which forces depend; leave it out")
        if self.forces is not None:
            self.forces.refuse(system, self.beads, window=window)
        if self.spectra is not None:
            self.spectra.refuse(system.beads, self.beads, duration, window=window)
