"""A scene: what a user asks for, validated and frozen, from YAML or Python. What it leaves out does not exist.

No default depends on anything but the scene, and `Scene.resolved` fills every one of them in.
"""

import math
from collections.abc import Iterator, Mapping
from functools import cached_property, partial
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, Self, Union

import numpy as np
from numpy.typing import NDArray
from pydantic import (
    BaseModel,
    BeforeValidator,
    Discriminator,
    Field,
    Tag,
    ValidationError,
    create_model,
    field_validator,
    model_validator,
)

from lammps_inputs import html, laws, physics, strict_yaml
from lammps_inputs import scheme as schemes
from lammps_inputs.chains import contacts
from lammps_inputs.complaints import describe
from lammps_inputs.deck_atoms import DeckAtoms
from lammps_inputs.errors import InputError
from lammps_inputs.facts import Fact
from lammps_inputs.ingredients import periodic
from lammps_inputs.ingredients.base import (
    Count,
    FurtherAtoms,
    Ingredient,
    Positive,
    ScenePart,
    Setting,
    refuse_outside,
    together,
)
from lammps_inputs.ingredients.material import Material
from lammps_inputs.ingredients.profile import GapValues, values_of
from lammps_inputs.ingredients.registry import INGREDIENTS, OWN_INGREDIENTS, SEVERAL
from lammps_inputs.ingredients.unequal import KEYS as KEYS_OF_UNEQUAL
from lammps_inputs.ingredients.unequal import (
    Disorder,
    Kinds,
    Pattern,
    Replacements,
    Striker,
    Taper,
    masses_and_strengths,
    neighbours,
)
from lammps_inputs.limits import solids as limits_of_material
from lammps_inputs.limits.closing import never_closes
from lammps_inputs.limits.rates import timestep_for
from lammps_inputs.limits.solids import FLATTENED, LARGEST_OVERLAP, overlap_bounds, sound_speed
from lammps_inputs.loads import summed
from lammps_inputs.numbers import number_or_array, plain_values
from lammps_inputs.output import Limits, Output, too_far_apart
from lammps_inputs.problem import Problem
from lammps_inputs.rows import Rows
from lammps_inputs.scheme import SchemeName
from lammps_inputs.starts import rounded, with_start
from lammps_inputs.static_load import LoadError, under_load
from lammps_inputs.system import System
from lammps_inputs.units import PURE, Label, Scale, Unit, hertz_constant, make_scale, sphere_mass
from lammps_inputs.window import HEADROOM, LEAST_WINDOW, behind, rows_for

Floats = NDArray[np.float64]

DEFAULT_EVERY = 0.1
"""Dimensionless time between frames: 19 frames in the full width at half maximum of a solitary wave of amplitude 1."""

DEFAULT_ACCURACY = 2e-4
"""Of a scene that names neither accuracy nor time step: displacements, peaks, arrivals and energies are then within the
tolerances of ``granchain validate`` in all installed scenes; at 5e-4 one of them is exceeded in a quarter of them.

Examples:
    >>> granchain.load("two-chains").accuracy is None
    True
    >>> DEFAULT_ACCURACY  # in units of V
    0.0002
"""

MAX_STEPS = 10**12

MAX_STEPS_PER_FRAME = 10**9
"""Well within the 32-bit integers of LAMMPS's dump command."""

FAR = 20.0
"""Gap over the radius from which on it is unlikely."""

LONG = 1e5
"""Duration in units of T that is unlikely in SI units."""

SHORT, SHORT_EVERY, SHORT_STEP = 1e-2, 1e-5, 1e-6
"""Duration, time between frames and time step, in units of T, below which they are unlikely in reduced units."""

HEAVY = 10.0
"""Mass of a bead in kg from which on it is unlikely."""

STIFF = 1e4
"""Contact constant from which on it is unlikely in reduced units."""

EQUAL_BEADS = 5.0
"""Beads over 1 / kappa within which pulses of two coupled chains become equal to 1 %: measured, 5.1 to 8.5."""

UNCOUPLED = 1e-3
"""Part of `EQUAL_BEADS` below which chains are practically uncoupled: pulses of neighbours stay below some 1 % of V."""

MAX_LENGTH = 1e9
"""Dimensionless; positions up to here resolve overlaps of order 1 to 1e-7."""

_OF_BEADS = ("gap", "material", "periodic", "window", *KEYS_OF_UNEQUAL)
"""Keys beside those of ingredients on which masses, links and loads depend (`Setting.parts`)."""

_OF_THE_RUN = {"name", "description", "duration", "until_bead", "timestep", "accuracy", "scheme", "limits", "output"}
"""Keys on which no system depends, as ingredients do not see them: a copy with others has the same."""

_BUILT = {"gaps", "setting", "system", "_problem", "_released"}
"""What is built of a scene once."""

_EXCITATIONS = {
    "kick": "kick velocity",
    "striker": "velocity of the striker",
    "push": "velocity of a free bead after the push",
    "drive": "largest velocity of the drive",
    "initial": "velocity that the initial state can give a bead",
    "gravity": "velocity of a fall through the gap",
}


def _none_if_false(value: Any) -> Any:
    if not isinstance(value, bool | None):
        raise ValueError(f"should be true or false, not {value!r}")
    return value or None


Closed = Annotated[Literal[True] | None, BeforeValidator(_none_if_false, json_schema_input_type=bool)]
"""Whether chains are rings; false is as good as absent."""


class Kick(ScenePart):
    """An initial velocity of one bead, towards higher bead numbers when positive."""

    example: ClassVar[str] = "{velocity: 1}"

    chain: Annotated[Count, Label("kicked chain")] = 1
    """Chain of the kicked bead."""
    bead: Annotated[Count, Label("kicked bead")] = 1
    """Number of the kicked bead."""
    velocity: Annotated[float, Field(ge=-1e30, le=1e30), Unit("m/s")]
    """Initial velocity, positive towards higher bead numbers."""

    @field_validator("velocity")
    @classmethod
    def _moves(cls, value: float) -> float:
        if abs(value) < 1e-30:
            raise ValueError("a kick needs a velocity (at least 1e-30)")
        return value


class SceneType(type(BaseModel)):  # type: ignore[misc]
    """Type of scenes, which states in one line why keys and values that Python passes make none."""

    def __call__(cls, *values: Any, **parts: Any) -> Any:
        """Make a scene.

        Args:
            *values: none; keys have names.
            **parts: values by key.

        Returns:
            The scene.

        Raises:
            InputError: a value without a key, an unknown key, or a value that is not valid; it names the key.
        """
        if values:
            raise InputError("Scene takes its keys by name, such as beads=20; `granchain.load` takes a mapping")
        try:
            return super().__call__(**parts)
        except ValidationError as error:
            raise InputError(f"scene: {describe(error, cls, parts)}") from None


class BaseScene(ScenePart, metaclass=SceneType):
    """Identical chains of touching or gapped beads on parallel lines, kicked at the start.

    Beside the keys here, a scene has one for each ingredient that it names.

    >>> scene = granchain.Scene(name="mine", beads=20, kick={"velocity": 1.0}, duration=30.0)
    >>> scene
    <scene mine: 1 chain of 20 beads>
    >>> scene.coupling is None, scene.problem().beads  # what a scene does not name does not exist
    (True, 20)
    """

    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9._-]{0,63}$")]
    """Name of the scene: letters, digits, `.`, `_` and `-`, at most 64."""
    description: Annotated[str, Field(max_length=200, pattern=r"^[^\x00-\x1f\x7f-\x9f\u2028\u2029]*$")] = ""
    """One line that `granchain scenes` prints."""
    chains: Annotated[int, Field(ge=1, le=10**6), Label("number of chains", "N")] = 1
    """Number of chains."""
    beads: Annotated[int, Field(ge=2, le=10**8), Label("number of beads of a chain", "n_b")]
    """Number of beads of each chain."""
    gap: Annotated[GapValues, Label("gap", "D")] = 0.0
    """Clear distance between neighbouring beads at rest, 0: they just touch; or gaps by contact, a list with one for
    each contact, or random ones.
    """
    periodic: Annotated[Closed, Label("periodic")] = None
    """Whether the last bead of each chain touches the first, so that a chain of N beads is a ring of N contacts."""
    kinds: Kinds | None = None
    """Kinds of beads by name, for `pattern` and `replace`."""
    pattern: Pattern | None = None
    """Kinds along every chain, repeated, where `20*name` stands for 20 of a kind; or a list of such lists, one for each
    chain.
    """
    replace: Replacements | None = None
    """Single beads of another kind."""
    taper: Taper | None = None
    """Fraction by which the radius of each bead is smaller than that of the bead before."""
    disorder: Disorder | None = None
    """Random differences between the beads."""
    striker: Striker | None = None
    """First bead of a chain, with its own mass or radius and an initial velocity."""
    kick: tuple[Kick, ...] = ()
    """Initial velocities; all other beads start at rest."""
    material: Material | None = None
    """Material of the beads; with it every number of the scene is in SI units."""
    mass: Annotated[Annotated[Positive, Unit("kg", always=True)] | None, Label("mass of the beads", "m")] = None
    """Mass of the beads, in place of a material and beside `contact.stiffness`; every number of the scene is then in SI
    units.
    """
    duration: Annotated[Positive, Unit("s")] | None = None
    """Time at which the run ends; or give `until_bead`."""
    until_bead: Count | None = None
    """The run ends shortly after the pulse has passed this bead in every chain."""
    timestep: Annotated[Annotated[Positive, Unit("s")] | None, Label("time step")] = None
    """Time step of velocity Verlet, in place of `accuracy`; it must divide `output.every` where that is named."""
    accuracy: Annotated[float, Field(ge=1e-10, le=0.1), PURE] | None = None
    """Largest error of any recorded velocity in units of V, kept by the time step that a pilot run finds; 2e-4 if
    neither `accuracy` nor `timestep` is given.
    """
    scheme: SchemeName | None = None
    """Velocity Verlet, or Suzuki's composition of order 4, whose mean Verlet step is `timestep`; `verlet` if omitted.
    """
    window: Literal["auto"] | Annotated[int, Field(ge=LEAST_WINDOW, le=10**8)] | None = None
    """Number of rows near the front that are simulated, or `auto`; all rows if omitted."""
    limits: Limits | None = None
    """Size beyond which `granchain run` refuses to start."""
    output: Output = Output()
    """What is recorded, and how often."""
    adopted: DeckAtoms | None = None
    """Atoms of the LAMMPS deck that `granchain adopt` read."""

    @model_validator(mode="before")
    @classmethod
    def _from_scripts(cls, data: Any) -> Any:
        return plain_values(data)

    _from_list = field_validator("gap", mode="before")(strict_yaml.as_tuple)

    @field_validator("kick", mode="before")
    @classmethod
    def _from_one(cls, value: Any) -> Any:
        return _one_or_several(value) or ()

    @model_validator(mode="after")
    def _fits_together(self) -> Self:
        if self.chains * self.beads > 2**31 - 1:
            raise ValueError(f"beads: {self.chains} x {self.beads} beads are more than LAMMPS numbers (2147483647)")
        if not self.kicks and not self._speed() > 0.0:
            missing = "" if "kick" in self.model_fields_set else "is missing; "
            raise ValueError(
                f"kick: {missing}at least one bead must be kicked, or a striker, a push, a drive, or an initial state "
                "that sets beads in motion named"
            )
        for number, kick in enumerate(self.kicks):
            refuse_outside(_kick_key(self, number), kick, self.chains, self.beads)
        if len({(kick.chain, kick.bead) for kick in self.kicks}) < len(self.kicks):
            raise ValueError("kick: one bead is kicked twice; add the velocities")
        if (self.duration is None) == (self.until_bead is None):
            reason = "neither is given" if self.duration is None else "both are given"
            raise ValueError(f"duration: give either duration or until_bead ({reason})")
        if self.until_bead is not None and self.until_bead > self.beads:
            raise ValueError(f"until_bead: {self.until_bead} is outside the array (beads 1 to {self.beads})")
        if self.timestep is not None and self.accuracy is not None:
            raise ValueError("accuracy: give either accuracy or timestep (both are given)")
        self._check_mass()
        self._check_window()
        self._check_numbers()
        self._check_materials()
        setting = self.setting
        if setting.closed:
            periodic.refuse(self.beads, setting.parts)
        for ingredient in self.ingredients:
            ingredient.refuse(setting)
        self._check_wanted()
        system = self.system
        for ingredient in self.ingredients:
            ingredient.refuse_system(setting, system)
        self._check_further_atoms()
        self._check_motion(system)
        self.output.refuse(system, self.duration, window=self.window is not None)
        if self.adopted is not None:
            self.adopted.refuse(self.chains, self.beads)
        self._check_times()
        return self

    def _check_further_atoms(self) -> None:
        """Refuse what is not known beside lines of atoms that are no beads."""
        for key, _ in self._further_atoms(self.setting):
            for other, ingredient in self.named:
                if Fact.FRAMES in ingredient.lacks(self.setting):
                    reason = ingredient.reason(other, Fact.FRAMES)
                    raise ValueError(f"{reason} beside {key}; leave one of them out")
            if self.window is not None:
                raise ValueError(f"window: {key} behind it keep moving; leave the window out")

    def _check_mass(self) -> None:
        """Refuse a mass beside a material, and one without the constant of the contacts."""
        if self.mass is None:
            return
        if self.material is not None:
            raise ValueError("mass: the material determines it; leave one of them out")
        if self.contact_scale[1] is None:
            raise ValueError(
                "mass: is in SI units, which need the constant A of the force A overlap^p, too; valid: "
                "`contact: {stiffness: 1.05e7}` (N/m^1.5), or a `material` in place of the mass"
            )

    def _check_window(self) -> None:
        """Refuse a window where what leaves it matters."""
        if self.window is None:
            return
        if self.output.beads != "all":
            raise ValueError("window: records the rows that exist; leave output.beads out")
        for number, kick in enumerate(self.kicks):
            key = _kick_key(self, number)
            if kick.velocity < 0.0:
                raise ValueError(f"{key}.velocity: a window follows pulses to higher beads only; leave it out")
            rows = (LEAST_WINDOW if self.window == "auto" else self.window) - HEADROOM
            if kick.bead > rows:
                raise ValueError(f"{key}.bead: {kick.bead} is not among the first {rows} rows of the window")
        if not self.kicks or self.window == "auto" or self.window >= self.beads:
            return
        first, last = (choose(kick.bead for kick in self.kicks) for choose in (min, max))
        if last - first > behind(self.window) - HEADROOM:
            raise ValueError(
                f"window: {self.window} rows; those of bead {first} would be removed before the kick of bead {last}; "
                f"take {rows_for(last - first + HEADROOM)} or more, or auto"
            )

    @property
    def wanted(self) -> dict[Fact, str]:
        """Facts on which the scene's choices depend, each with the key of the choice; no ingredient may remove them."""
        composed = self.scheme not in (None, "verlet")
        chosen = ((Fact.FRONT, "window", self.window is not None), (Fact.REVERSIBLE, "scheme", composed))
        return {fact: key for fact, key, made in chosen if made}

    def _check_wanted(self) -> None:
        """Refuse choices that build on what an ingredient takes away."""
        wanted = self.wanted
        for key, ingredient in self.named if wanted else ():
            for fact in ingredient.lacks(self.setting) & wanted.keys():
                raise ValueError(f"{ingredient.reason(key, fact)}; leave the {wanted[fact]} out")

    def _check_numbers(self) -> None:
        """Refuse scenes whose dimensionless numbers overflow."""
        try:
            scale = self.scale
            units = [scale.length, scale.time, scale.mass]
        except (ZeroDivisionError, OverflowError):
            units = [math.nan]
        if not all(1e-30 <= unit <= 1e30 for unit in units):
            raise ValueError("kick: these units overflow when made dimensionless; check the material and velocities")
        largest = float(np.max(self.gaps)) / scale.length
        if largest * self.beads > MAX_LENGTH:
            raise ValueError(
                f"gap: {largest:.3g} in dimensionless units, so wide that positions lose their digits; "
                f"at most {MAX_LENGTH / self.beads:.3g} for {self.beads} beads"
            )

    def _check_materials(self) -> None:
        """Refuse numbers that no solid has, which are mostly those of another unit."""
        for key, bead in self._solids():
            wrong = limits_of_material.impossible(*bead)
            if wrong:
                raise ValueError(f"{key}.{wrong}")

    def _solids(self) -> Iterator[tuple[str, tuple[float, float, float]]]:
        """Key of every kind of bead in SI units, and its radius, density and Young's modulus."""
        ball = self.material
        if ball is None:
            return
        names = ("radius", "density", "youngs_modulus")
        reference = tuple(float(getattr(ball, name)) for name in names)
        yield "material", reference  # type: ignore[misc]
        kinds = {f"kinds.{name}": kind for name, kind in (self.kinds or {}).items()}
        if self.striker is not None:
            kinds["striker"] = self.striker
        for key, kind in kinds.items():
            constants = [getattr(kind, name) for name in names]
            # with a mass the density is not the material's
            if kind.mass is None and any(value is not None for value in constants):
                radius, density, modulus = (a if b is None else b for a, b in zip(reference, constants, strict=True))
                yield key, (radius, density, modulus)

    def _unlikely_solids(self) -> Iterator[str]:
        return (f"{key}.{why}" for key, bead in self._solids() for why in limits_of_material.unlikely(*bead))

    @property
    def unlikely(self) -> list[str]:
        """Warnings of unlikely values, each with the unit or key that was probably meant.

        Returns:
            The warnings; none in a plausible scene.

        Examples:
            >>> granchain.load("two-chains").unlikely
            []
        """
        warnings = list(self._unlikely_solids())
        gap = float(np.max(self.gaps))
        if self.material is not None and gap > FAR * self.material.radius:
            ratio = gap / self.material.radius
            warnings.append(f"gap in m? {gap:g} m is {ratio:.3g} times the radius; {gap:g} mm is {1e-3 * gap:g} m")
        if self.chains == 1 and self.part("coupling") is not None:
            warnings.append("coupling: a single chain has no springs between chains; `chains: 2` gives it a neighbour")
        every = self._cadence()[0]
        if self.duration is not None and every > self.duration * (1.0 + 1e-9):
            warnings.append(
                f"output.every: {every:g} is longer than the duration of {self.duration:g}; "
                f"the run lasts {every:g} and records its start and its end only"
            )
        if self.in_units_of_time:
            warnings.append(f"duration in s? {self.in_units_of_time}")
        warnings += [*self._times_in_seconds(), *self._unlikely_masses(), *filter(None, [self.uncoupled()])]
        return warnings

    def _unlikely_masses(self) -> Iterator[str]:
        """Warnings of a mass in g, and of a contact constant in SI units where the mass of a bead is 1."""
        mass, constant = self.mass, self.contact_scale[1]
        if mass is not None and mass > HEAVY:
            yield f"mass in kg? {mass:g} kg is that of no bead of an experiment; {mass:g} g is {1e-3 * mass:g} kg"
        masses = np.broadcast_to(self.system.mass, (self.chains, self.beads))
        if not self._si and (constant or 0.0) > STIFF and np.any(masses == 1.0):
            yield (
                f"contact.stiffness in N/m^{self.contact_scale[0]:g}? {constant:g} in reduced units, where the mass of "
                "a bead is 1; beside `mass`, such as mass: 0.0283 (kg), all numbers are in SI units"
            )

    def _times_in_seconds(self) -> Iterator[str]:
        """Warnings of times in reduced units that are as short as those in seconds."""
        if self._si:
            return
        unit = self.scale.time
        named = {"duration": (self.duration, SHORT), "timestep": (self.timestep, SHORT_STEP)}
        named["output.every"] = self.output.every, SHORT_EVERY
        for key, (value, least) in named.items():
            if value is not None and value < least * unit:
                yield (
                    f"{key} in s? {value:g} is {value / unit:.3g} T, the unit of time T being {unit:.4g} in reduced "
                    "units; a scene in SI units needs a `material`, such as {name: steel, radius: 4.76e-3}"
                )

    def uncoupled(self) -> str:
        """Why the springs between chains have practically no effect; empty where they have, or are no linear ones."""
        system = self.system
        if not (physics.coupled(system) and physics.simply_coupled(system)):
            return ""
        kappa, scale = physics.kappa(system), self.scale
        needed = EQUAL_BEADS / (physics.kappa_of_pulses(system) * max(1.0, physics.gap(system)) ** 2)
        passed = max(self.beads, 0.0 if self.duration is None else self.duration / scale.time)
        if passed > UNCOUPLED * needed:
            return ""
        return (
            f"coupling.stiffness: kappa = {kappa:.3g}, so the chains are practically uncoupled: their pulses become "
            f"equal after some {needed:.2g} beads, and a chain has {self.beads}; kappa = 0.1 is a stiffness of "
            f"{scale.written(0.1, 'stiffness', '.3g')}"
        )

    @property
    def in_units_of_time(self) -> str:
        """Long duration of a scene in SI units, in T, which may have been meant; empty where it is not long."""
        unit = self.scale.time
        if not self._si or self.duration is None or not self.duration > LONG * unit:
            return ""
        return (
            f"{self.duration:g} s is {self.duration / unit:.3g} T, the unit of time T being {unit:.4g} s "
            f"({self.duration:g} T = {self.duration * unit:.4g} s)"
        )

    def _check_motion(self, system: System) -> None:
        """Refuse scenes in which nothing happens, or what no beads of the material would do."""
        if physics.simply_coupled(system) and never_closes(
            self.chains, physics.kappa(system), system.along[0].gap, system.kicks, self.beads
        ):
            raise ValueError(
                f"kick: none ever closes the gap of {float(np.max(self.gaps)):g}, so nothing collides; "
                "kick a bead towards another (bead 1 forward), or leave the gap out"
            )
        if self.material is not None:
            self._check_contacts(self.material, system)

    def _check_times(self) -> None:
        """Refuse times that do not fit together."""
        every, steps = self._cadence()
        frames = 0.0 if self.duration is None else self.duration / every
        if not frames * steps <= MAX_STEPS:
            needed = f"needs {frames * steps:.3g} time steps; at most {MAX_STEPS:.0e}"
            raise ValueError(f"duration: {'; '.join(filter(None, [needed, self.in_units_of_time]))}")
        if steps > MAX_STEPS_PER_FRAME:
            raise ValueError(
                f"output.every: {every:g} is more than {MAX_STEPS_PER_FRAME:.0e} time steps; "
                "record more often or take longer steps"
            )
        if self.timestep is not None and abs(steps * self.timestep / every - 1.0) > 1e-9:
            if why := too_far_apart(every / self.scale.time, self.scale, physics.pulse_time(self.system)):
                raise ValueError(f"output.every: {why}")  # first: a step that divides it would be no answer
            raise ValueError(
                f"timestep: {self.timestep:g} does not divide output.every = {every:g} evenly; "
                f"leave it out for an accuracy of {DEFAULT_ACCURACY:g} V, or try {every / steps:.12g}"
            )

    def _check_contacts(self, ball: Material, system: System) -> None:
        """Refuse what no contact of elastic spheres is, though the dimensionless numbers would be sane."""
        sound = sound_speed(ball.youngs_modulus, ball.density)
        key, _ = max(self._speeds(), key=lambda excitation: excitation[1])
        meant = next(self._unlikely_solids(), "")
        if self.scale.velocity > sound:
            raise ValueError(
                f"{key}: {self.scale.velocity:g} m/s is faster than sound in this material, "
                f"sqrt(youngs_modulus / density) = {sound:.4g} m/s; {meant or 'contacts are Hertzian far below it'}"
            )
        least = overlap_bounds(system)[0]
        overlap = least * self.scale.length / ball.radius
        if overlap >= FLATTENED:
            key = self._loaded_by if physics.loaded(system) else key
            raise ValueError(
                f"{key}: gives an overlap of at least {overlap:.2g} times the radius, where Hertz's law holds below "
                f"{LARGEST_OVERLAP}; {meant or 'slower kicks, smaller loads or a stiffer material are needed'}"
            )

    @property
    def kicks(self) -> tuple[Kick, ...]:
        """The kicked beads, and the striker's first bead."""
        if self.striker is None:
            return self.kick
        return (Kick(chain=self.striker.chain, bead=1, velocity=self.striker.velocity), *self.kick)

    @property
    def scale(self) -> Scale:
        """Sizes of the dimensionless units in this scene's units.

        Returns:
            V, T, L and the mass of a bead, in SI or reduced units.

        Examples:
            >>> f"T = {granchain.load('two-chains-steel').scale.time:.2e} s"
            'T = 1.22e-05 s'
        """
        return self._scale(self._speed())

    def _scale(self, velocity: float) -> Scale:
        """Sizes of the dimensionless units where V is this velocity, in the scene's units."""
        ball = self.material
        exponent, constant = self.contact_scale
        if ball is not None:
            constant = constant or hertz_constant(ball.radius, ball.youngs_modulus, ball.poisson_ratio)
        return make_scale(self._bead_mass, constant or 1.0, velocity, si=self._si, exponent=exponent)

    @property
    def _si(self) -> bool:
        """Whether numbers are in SI units."""
        return self.material is not None or self.mass is not None

    @property
    def _bead_mass(self) -> float:
        """Mass of the reference bead, in the scene's units."""
        ball = self.material
        if ball is None:
            return 1.0 if self.mass is None else self.mass
        return sphere_mass(ball.radius, ball.density)

    @property
    def units(self) -> str:
        """Values of V, T, L and of the coupling's kappa, in one line; V is the largest excitation (MODEL.md).

        Returns:
            The line.

        Examples:
            >>> granchain.load("two-chains").units
            'reduced units: V = 1 (kick velocity), T = 1, L = 1, kappa = 0.1'
        """
        scale, system = self.scale, self.system
        excitations = [(key, speed) for key, speed in self._speeds() if speed > 0.0]
        key, _ = max(excitations, key=lambda excitation: excitation[1])
        meaning = _EXCITATIONS.get(key, key)
        largest = "largest " if len(excitations) > 1 and not meaning.startswith("largest") else ""
        parts = [f"V = {scale.written(1.0, 'velocity')} ({largest}{meaning})"]
        parts += [f"{symbol} = {scale.short(1.0, name)}" for symbol, name in (("T", "time"), ("L", "length"))]
        if physics.coupled(system):
            parts.append(f"kappa = {physics.kappa(system):.6g}")
        return f"{'SI' if scale.si else 'reduced'} units: {', '.join(parts)}"

    @property
    def contact_scale(self) -> tuple[float, float | None]:
        """Exponent and constant of the contacts' force, by which lengths are measured (`Ingredient.contact_scale`)."""
        scales = (ingredient.contact_scale() for ingredient in self.ingredients)
        return next((scale for scale in scales if scale is not None), (1.5, None))

    def _speed(self) -> float:
        """Velocity V: that of the fastest kick, or of a bead after the impulse of a push."""
        return max((speed for _, speed in self._speeds()), default=0.0)

    def _speeds(self) -> Iterator[tuple[str, float]]:
        """Key of all that sets a bead in motion, and the speed that it gives it."""
        for number, kick in enumerate(self.kicks):
            yield _kick_key(self, number).partition("[")[0], abs(kick.velocity)
        for key, ingredient in self.named:
            yield key, ingredient.speed(self._bead_mass)
        yield from self._released

    @cached_property
    def _released(self) -> tuple[tuple[str, float], ...]:
        """Key of all that stores energy at the start, and the speed that this can give a bead.

        Energies are those of a system in provisional units, which do not matter.
        """
        storing = [(key, ingredient) for key, ingredient in self.named if ingredient.stores]
        if not storing:
            return ()
        self.__dict__["_released"] = ()  # of the provisional units: those of kicks, pushes and drives
        try:
            setting = self._setting(self._scale(self._speed() or 1.0))
            for ingredient in self.ingredients:
                ingredient.refuse(setting)
            mass, p = masses_and_strengths(setting)[0], self.contact_scale[0]
            force = max(float(np.max(ingredient.static(setting, mass))) for ingredient in self.ingredients)
            if force and not self._speed():  # units of the load, which is too large or small in others
                setting = self._setting(self._scale(force ** (0.5 * (p + 1.0) / p)))
            system = self._system(setting)
        finally:
            del self.__dict__["_released"]
        velocity = setting.scale.velocity
        return tuple((key, velocity * ingredient.released(setting, system)) for key, ingredient in storing)

    def part(self, key: str) -> Any:
        """Part of the scene under a key; None where it names none."""
        return getattr(self, key, None)

    @cached_property
    def gaps(self) -> float | Floats:
        """Clear distances of neighbouring beads at rest: a number, or [chain, contact], in the units of the scene."""
        return number_or_array(values_of("gap", self.gap, (self.chains, self.beads - (self.periodic is None))))

    @property
    def ingredients(self) -> tuple[Ingredient, ...]:
        """Ingredients that the scene names."""
        return tuple(ingredient for _, ingredient in self.named)

    @property
    def named(self) -> Iterator[tuple[str, Ingredient]]:
        """Every ingredient of the scene, with its key; the material first."""
        if self.material is not None:
            yield "material", self.material
        for key in INGREDIENTS:
            named = getattr(self, key)
            for ingredient in named if isinstance(named, tuple) else () if named is None else (named,):
                yield key, ingredient

    @cached_property
    def setting(self) -> Setting:
        """What the ingredients see of the scene: all on which its system depends."""
        return self._setting(self.scale)

    def _setting(self, scale: Scale) -> Setting:
        return Setting(
            chains=self.chains,
            beads=self.beads,
            gap=self.gaps,
            material=self.material,
            kicks=self.kicks,
            scale=scale,
            contact_scale=self.contact_scale,
            parts={key: self.part(key) for key in (*_OF_BEADS, *INGREDIENTS)},
            named=tuple(self.named),
        )

    @cached_property
    def system(self) -> System:
        """Beads, links and kicks, dimensionless at V = 1; built once, as the scene is frozen."""
        return self._system(self.setting)

    def _system(self, setting: Setting) -> System:
        """Beads, links and kicks, dimensionless in the units of a setting."""
        scale = setting.scale
        mass, strength = masses_and_strengths(setting)
        law = setting.law_between(strength, partial(neighbours, setting))
        law = law and laws.for_all(law, setting.contacts)
        touching = contacts(self.gaps / scale.length, strength, law, closed=setting.closed)
        links = [link for ingredient in self.ingredients for link in ingredient.links(setting)]
        loads = tuple(load for ingredient in self.ingredients for load in ingredient.loads(setting))
        motions = summed(motion for ingredient in self.ingredients for motion in ingredient.motions(setting))
        taken = {fact for ingredient in self.ingredients for fact in ingredient.lacks(setting)}
        taken |= {Fact.SECOND_ORDER} if any(load.law.jumps for load in loads) else set()
        further_lines, ties, dashpots = together(self.chains, [atoms for _, atoms in self._further_atoms(setting)])
        taken |= physics.taken_by_state(touching[0].law) | ({Fact.FRONT} if setting.closed else set())
        system = System(
            chains=self.chains,
            beads=self.beads,
            kicks=tuple((kick.chain, kick.bead, kick.velocity / scale.velocity) for kick in self.kicks),
            mass=mass,
            further_lines=further_lines,
            links=(*touching, *links, *ties),
            lacks=frozenset(taken),
            loads=loads,
            motions=motions,
            dampers=(*(link for ingredient in self.ingredients for link in ingredient.dampers(setting)), *dashpots),
        )
        started = [ingredient.start(setting) for ingredient in self.ingredients]
        system = with_start(system, np.concatenate(started)) if started else system
        borne = physics.mass_with_tied(system)
        static = sum((ingredient.static(setting, borne) for ingredient in self.ingredients), np.float64(0.0))
        if not np.any(static):
            return rounded(system)
        try:
            return rounded(under_load(system, np.broadcast_to(static, (self.chains, self.beads + 1))))
        except LoadError as error:
            raise ValueError(f"{self._loaded_by}: {error}") from None

    def _further_atoms(self, setting: Setting) -> list[tuple[str, FurtherAtoms]]:
        """Lines of atoms that ingredients add to the chains, each with the key of its ingredient."""
        each = [(key, ingredient.further_atoms(setting)) for key, ingredient in self.named]
        return [(key, atoms) for key, atoms in each if atoms is not None]

    @property
    def _loaded_by(self) -> str:
        """Key of the first static load."""
        mass, _ = masses_and_strengths(self.setting)
        return next(key for key, ingredient in self.named if np.any(ingredient.static(self.setting, mass)))

    def _cadence(self) -> tuple[float, int]:
        """Time between frames in the scene's units, and time steps in it."""
        every = self._default_every() if self.output.every is None else self.output.every
        return every, self._steps(every, self._rule() if self.timestep is None else self.timestep)

    def _default_every(self) -> float:
        """Time between frames where none is named: a tenth of the time of pulses, or the most steps within that."""
        every, step = DEFAULT_EVERY * physics.pulse_time(self.system) * self.scale.time, self.timestep
        if step is None or every / step > MAX_STEPS_PER_FRAME:
            return every
        if abs(self._steps(every, step) * step / every - 1.0) <= 1e-9:
            return every
        cycle = schemes.cycle(self.scheme or "verlet")
        return max(1, math.floor(every / (cycle * step) * (1.0 + 1e-9))) * cycle * step

    def _steps(self, every: float, step: float) -> int:
        """Time steps between frames, whole cycles of the scheme, no longer than a step."""
        steps = max(1, math.ceil(min(every / step, 2.0 * MAX_STEPS_PER_FRAME) * (1.0 - 1e-9)))
        return steps + -steps % schemes.cycle(self.scheme or "verlet")

    def _rule(self) -> float:
        """The time step by the rule for an accuracy."""
        until = self.duration
        by_bead = 2.0 * (self.until_bead or 0) * physics.pulse_time(self.system)
        duration = by_bead if until is None else until / self.scale.time
        accuracy = self.accuracy or DEFAULT_ACCURACY
        return timestep_for(accuracy, duration, self.system, self.scheme or "verlet") * self.scale.time

    def resolved(self) -> Self:
        """Scene with every default written out; resolving twice changes nothing.

        The time step is that of the rule; one that keeps an accuracy is found by `workflow.prepare.settings`.

        Returns:
            The scene.

        Examples:
            >>> granchain.load("two-chains").resolved().output.every
            0.1
        """
        every, steps = self._cadence()
        output = self.output.model_copy(update={"every": every})
        step = every / steps if self.accuracy is None else None
        return self.model_copy(update={"output": output, "timestep": step})

    def problem(self) -> Problem:
        """The dimensionless problem at V = 1.

        Returns:
            The problem, in units of V, T, L and the mass of a bead.

        Raises:
            ValueError: the scene ends at a bead, or asks for an accuracy; `workflow.prepare.settings.settle`
                finds the duration and the time step.

        Examples:
            >>> granchain.load("two-chains").problem().frames
            1920
        """
        return self._problem

    @cached_property
    def _problem(self) -> Problem:
        if self.duration is None:
            raise ValueError(
                "this scene ends at a bead; workflow.prepare.duration.with_duration(scene) finds its duration"
            )
        if self.accuracy is not None:
            raise ValueError(
                "this scene asks for an accuracy; workflow.prepare.settings.settle(scene) finds its time step"
            )
        if self.window == "auto":
            raise ValueError(
                "this scene's window is `auto`; workflow.prepare.window_width.with_window(scene) finds its rows"
            )
        scale, system = self.scale, self.system
        every, steps = self._cadence()
        recorded = None if self.output.beads == "all" else self.output.beads
        return Problem(
            system=system,
            name=self.name,
            timestep=every / scale.time / steps,
            steps_per_frame=steps,
            frames=max(1, math.ceil(self.duration / every * (1.0 - 1e-9))),
            rows=Rows(self.beads).only(recorded).near_front(self.window),
            scale=scale,
            scheme=self.scheme or "verlet",
        )

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """Copy of the scene with other values, which are not checked.

        What was built of the scene is built anew of the copy, but for a system that does not depend on these values.
        """
        copy = super().model_copy(update=update, deep=deep)
        stale = {"_problem"} if (update or {}).keys() <= _OF_THE_RUN else _BUILT
        for name in stale:
            copy.__dict__.pop(name, None)
        return copy

    def __iter__(self) -> Iterator[tuple[str, Any]]:  # type: ignore[override]  # as pydantic declares it
        """Keys and their values, without what was built of them."""
        return ((key, value) for key, value in super().__iter__() if key not in _BUILT)

    def __getstate__(self) -> dict[Any, Any]:
        state = super().__getstate__()
        values = {name: value for name, value in state["__dict__"].items() if name not in _BUILT}
        return {**state, "__dict__": values}

    def __repr__(self) -> str:
        chains = "1 chain" if self.chains == 1 else f"{self.chains} chains"
        return f"<scene {self.name}: {chains} of {self.beads} beads>"

    __str__ = __repr__

    def _repr_html_(self) -> str:
        return html.text(strict_yaml.dump(self.plain()))

    def plain(self) -> dict[str, Any]:
        """Nested plain data for YAML, without what the scene does not name.

        Returns:
            The keys and values, of mappings, lists, numbers and text.

        Examples:
            >>> granchain.load("two-chains").plain()["coupling"]
            {'model': 'linear', 'stiffness': 0.1}
        """
        data = self.model_dump(mode="json", exclude_none=True)
        keys = [key for key in BaseScene.model_fields if key in data]
        keys[keys.index("kick") : keys.index("kick")] = [key for key in INGREDIENTS if key in data]
        return dict(_named({key: data[key] for key in keys}))


def _one_or_several(value: Any) -> Any:
    return tuple(value) if isinstance(value, list | tuple) else None if value is None else (value,)


def _annotation(ingredient: type[Ingredient]) -> Any:
    """Type of an ingredient's key in a scene; where keys choose among classes, that of all these."""
    kinds = ingredient.kinds()
    if len(kinds) > 1:
        tagged: Any = Union[tuple(Annotated[kind, Tag(f"<{kind.__name__}>")] for kind in kinds)]  # noqa: UP007
        tag = Discriminator(lambda value: f"<{ingredient.kind_of(value).__name__}>")
        return Annotated[tagged, tag] | None
    if not ingredient.several:
        return ingredient | None
    return Annotated[tuple[ingredient, ...] | None, BeforeValidator(_one_or_several)]  # type: ignore[valid-type]


if TYPE_CHECKING:

    class Scene(BaseScene):  # type: ignore[metaclass]
        """Scene with the ingredients' keys, which are determined when the package is loaded."""

        def __init__(self, **parts: Any) -> None: ...
else:
    for _key in BaseScene.model_fields.keys() & INGREDIENTS:
        raise InputError(f"{OWN_INGREDIENTS}: {_key!r} is a key of every scene; give the ingredient another")
    Scene = create_model(
        "Scene",
        __base__=BaseScene,
        __module__=__name__,
        __doc__=BaseScene.__doc__,
        **{key: (_annotation(ingredient), None) for key, ingredient in INGREDIENTS.items()},
    )


def _kick_key(scene: BaseScene, number: int) -> str:
    """Key of a kick in messages, by its place in ``scene.kicks``."""
    strikers = len(scene.kicks) - len(scene.kick)
    if number < strikers:
        return "striker"
    return "kick" if len(scene.kick) == 1 else f"kick[{number - strikers + 1}]"


def _named(data: dict[str, Any]) -> Iterator[tuple[str, Any]]:
    for key, value in data.items():
        if key == "kick" and not value:
            continue
        if key in SEVERAL and len(value) == 1:
            yield key, value[0]
        elif not (key == "description" and value == "") and not (key == "gap" and value == 0.0) and value != []:
            yield key, value
