"""The exact solitary wave of an uncompressed chain whose contact force is ``overlap**n``, and its long-wave theory.

A wave that moves by ``c`` beads per unit time without changing its form is, in every contact, the same overlap ``r`` as
a function of the distance ``xi`` from the wave's peak. Newton's law then is one equation::

    c**2 r = Lambda * r**n        Lambda(x) = max(1 - |x|, 0), * a convolution
    c v    = box * r**n           box = 1 between -1/2 and 1/2; v the velocity of the beads

English & Pego, Proc. Am. Math. Soc. 133, 1763 (2005): r is smooth and falls doubly exponentially. Ahnert & Pikovsky,
Phys. Rev. E 79, 026209 (2009), arXiv 0808.3059: iterating the equation converges. On a periodic grid Lambda is a
multiplication by sinc**2 in Fourier space, and for so smooth a function the error falls faster than any power of
the grid's spacing.

| quantity             | here               | unit            | for a peak velocity of v instead of 1 |
|----------------------|--------------------|-----------------|---------------------------------------|
| c                    | ``speed``          | beads / T       | ``speed * v**((n - 1) / (n + 1))``    |
| largest r            | ``peak_overlap``   | L               | ``peak_overlap * v**(2 / (n + 1))``   |
| way a bead is moved  | ``shift``          | L               | ``shift * v**(2 / (n + 1))``          |
| momentum, = c shift  | ``momentum``       | m L / T         | ``momentum * v``                      |
| energy               | ``energy``         | m (L / T)**2    | ``energy * v**2``                     |
| width, form          | ``width``, methods | beads           | the same                              |

Mass and contact constant are 1. Nothing here depends on runs: waves found in a trajectory are compared elsewhere. The
wave of a system's contacts, where they have one, is `wave_of`.

Plug-ins take this module to compare pulses with theory: `solitary_wave` is exact, `nesterenko` the long-wave theory.

Examples:
    >>> exact, theory = exact_wave.solitary_wave(), exact_wave.nesterenko()
    >>> round(exact.speed, 4), round(theory.speed, 4)  # at a peak velocity of V, in beads / T
    (0.9075, 0.9146)
    >>> exact.velocity([0.0, 1.0, 2.0]).round(4)  # ahead of the peak, in units of V
    array([1.    , 0.3263, 0.0087])
"""

from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from analysis import hermite
from analysis.trajectory import Floats, Integers
from lammps_inputs import System, laws, physics
from lammps_inputs.facts import Fact

HERTZ = 1.5
"""Exponent of the contact of spheres."""
_CONVERGED = 1e-14
"""Change of the overlap (of peak 1) in the last iteration; the error left is 2 of it for Hertz, 20 for n = 1.05."""
_NEGLIGIBLE = 1e-15
"""Overlap (of peak 1) at the ends of the period; ten times as much for the force's spectrum at its end."""
_FINER = 4
"""Points of the profiles per point of the iteration."""
_DERIVATIVES = 4
"""Derivatives of the profiles, from the value on, that are exact at these points; polynomials between have degree 7."""


@dataclass(frozen=True)
class _Profile:
    """Polynomials piece after piece, [power, piece], in the share of a piece that lies behind."""

    start: float
    spacing: float
    polynomials: Floats

    @classmethod
    def of(cls, spectrum: Floats, points: int, spacing: float) -> "_Profile":
        """Profile of an even function by its real spectrum [wavenumber], half a piece short at the ends of a period."""
        turn = 2j * np.pi * np.fft.rfftfreq(points, spacing)[: len(spectrum)]
        data = np.array([_FINER * np.fft.irfft(spectrum * turn**k, points) for k in range(_DERIVATIVES)])
        data = np.fft.fftshift(data, axes=-1)[:, 1:]
        pieces = np.stack([data[:, :-1], data[:, 1:]])
        return cls((1 - points // 2) * spacing, spacing, hermite.coefficients((0, 1), pieces, spacing))

    def __call__(self, xi: ArrayLike) -> Floats:
        """Values at xi (any shape); beyond the ends those at the ends."""
        piece, share = self._place(xi)
        return hermite.value(self.polynomials[:, piece], share).reshape(np.shape(xi))

    def integral(self, xi: ArrayLike) -> Floats:
        """Integrals from the start to xi, of the shape of xi."""
        piece, share = self._place(xi)
        until_end = np.cumsum(hermite.integral(self.polynomials, np.ones(self.polynomials.shape[1])))
        before = np.where(piece > 0, until_end[piece - 1], 0.0)
        return self.spacing * (before + hermite.integral(self.polynomials[:, piece], share)).reshape(np.shape(xi))

    def _place(self, xi: ArrayLike) -> tuple[Integers, Floats]:
        """[place] piece, and share of it, of places in one row."""
        count = self.polynomials.shape[1]
        at = np.clip((np.ravel(np.asarray(xi, dtype=np.float64)) - self.start) / self.spacing, 0.0, count)
        piece = np.minimum(at.astype(np.int64), count - 1)
        return piece, at - piece


@dataclass(frozen=True)
class SolitaryWave:
    """The wave whose fastest bead has velocity 1; the methods' ``*_at`` forms give the constants at any other.

    The arguments ``xi`` of the profiles are distances ahead of the peak, in beads. With its peak at bead n0 at time t0
    a wave of peak velocity v that moves towards higher bead numbers is, at ``c = speed_at(v)``::

        velocity of bead i                    v * velocity(i - n0 - c * (t - t0))
        displacement of bead i                v**(2 / (n + 1)) * displacement(i - n0 - c * (t - t0))
        overlap of beads i and i + 1          v**(2 / (n + 1)) * overlap(i + 1/2 - n0 - c * (t - t0))
    """

    exponent: float
    """n of the contact force ``overlap**n``."""
    speed: float
    peak_overlap: float
    momentum: float
    energy: float
    kinetic_share: float
    """Kinetic share of the energy, averaged over the passage of one bead; (n + 1) / (n + 3) by the virial theorem."""
    shift: float
    """Displacement that the wave leaves behind."""
    width: float
    """Full width at half maximum of the velocity, beads."""
    _velocity: _Profile = field(repr=False, compare=False)
    _overlap: _Profile = field(repr=False, compare=False)
    strength: float = 1.0
    """A of the contact force ``A overlap**n``, in units of the scale's contact constant."""

    def of_strength(self, strength: float) -> "SolitaryWave":
        """The wave in contacts so many times as strong: as much faster as overlaps are smaller, velocities alike."""
        factor = strength ** (1.0 / (self.exponent + 1.0))
        return replace(
            self,
            speed=self.speed * factor,
            peak_overlap=self.peak_overlap / factor,
            shift=self.shift / factor,
            strength=self.strength * strength,
            _overlap=replace(self._overlap, polynomials=self._overlap.polynomials / factor),
        )

    def velocity(self, xi: ArrayLike) -> Floats:
        """Velocity of a bead at a distance xi (any shape, beads) ahead of the peak; 1 at 0, and even."""
        return self._velocity(xi)

    def overlap(self, xi: ArrayLike) -> Floats:
        """Overlap of a contact at a distance xi (any shape, beads) ahead of the peak; even."""
        return self._overlap(xi)

    def displacement(self, xi: ArrayLike) -> Floats:
        """Displacement of a bead at a distance xi (any shape, beads) ahead of the peak: 0 far ahead, shift behind."""
        return np.asarray((self._velocity.integral(np.inf) - self._velocity.integral(xi)) / self.speed)

    @property
    def steepest(self) -> float:
        """Bound on the slope of `velocity` per bead: by Newton's law ``c v' = A r(xi + 1/2)**n - A r(xi - 1/2)**n``."""
        return float(self.strength * self.peak_overlap**self.exponent / self.speed)

    def speed_at(self, peak_velocity: ArrayLike) -> Floats:
        """Speed in beads / T at a peak velocity (any shape, in V)."""
        return self.speed * np.asarray(peak_velocity) ** ((self.exponent - 1.0) / (self.exponent + 1.0))

    def peak_overlap_at(self, peak_velocity: ArrayLike) -> Floats:
        """Largest overlap in L at a peak velocity (any shape, in V)."""
        return self.peak_overlap * np.asarray(peak_velocity) ** (2.0 / (self.exponent + 1.0))

    def shift_at(self, peak_velocity: ArrayLike) -> Floats:
        """Displacement in L that a wave of a peak velocity (any shape, in V) leaves behind."""
        return self.shift * np.asarray(peak_velocity) ** (2.0 / (self.exponent + 1.0))

    def momentum_at(self, peak_velocity: ArrayLike) -> Floats:
        """Momentum in m V at a peak velocity (any shape, in V)."""
        return self.momentum * np.asarray(peak_velocity)

    def energy_at(self, peak_velocity: ArrayLike) -> Floats:
        """Energy in m V**2 at a peak velocity (any shape, in V)."""
        return self.energy * np.asarray(peak_velocity) ** 2


def solitary_wave(exponent: float = HERTZ) -> SolitaryWave:
    """The solitary wave of the contact force ``overlap**exponent``; each exponent is computed once.

    Milliseconds between 1.05 and 30; the work grows as the inverse of exponent - 1, to seconds at 1.001.

    Raises:
        ValueError: the exponent is not a number above 1 (a linear chain disperses and has no solitary wave).
    """
    return _solved(_checked(exponent))


def fixed_point(exponent: float, period: float, points_per_bead: int) -> tuple[Floats, float]:
    """Periodic overlap of peak 1 and its squared speed, by iteration from the Gaussian of the limit n -> 1.

    The Gaussian is that of James & Pelinovsky, Proc. R. Soc. A 470, 20130462 (2014), arXiv 1307.3837.

    Returns:
        [point] overlap on a grid of ``period`` beads, from the peak on and around; squared speed at this overlap.
    """
    points = round(period * points_per_bead)
    xi = np.fft.fftfreq(points, 1.0 / period)
    triangle = np.sinc(np.fft.rfftfreq(points, 1.0 / points_per_bead)) ** 2
    overlap: Floats = np.exp(-3.0 * (exponent - 1.0) * xi**2)
    change = np.inf
    while change > _CONVERGED:
        # The real part of the spectrum keeps the peak at 0: the equation itself leaves its place open.
        force = np.fft.rfft(overlap**exponent).real
        following = np.maximum(np.fft.irfft(force * triangle, points), 0.0)
        squared_speed = float(following[0])
        following /= squared_speed
        change = float(np.max(np.abs(following - overlap)))
        overlap = following
    return overlap, squared_speed


@lru_cache(maxsize=64)
def _solved(exponent: float) -> SolitaryWave:
    """Refine the grid until it holds the whole wave; then normalise, interpolate and integrate."""
    period, per_bead = 16, 16
    while True:
        overlap, squared_speed = fixed_point(exponent, period, per_bead)
        force = np.fft.rfft(overlap**exponent).real
        if np.max(np.abs(force[-3:])) > 10.0 * _NEGLIGIBLE * force[0]:
            per_bead *= 2
        elif overlap[len(overlap) // 2] > _NEGLIGIBLE:
            period *= 2
        else:
            break
    box = np.sinc(np.fft.rfftfreq(len(overlap), 1.0 / per_bead))
    impulse = float(np.fft.irfft(force * box, len(overlap))[0])
    peak_overlap = float((np.sqrt(squared_speed) / impulse) ** (2.0 / (exponent + 1.0)))
    speed = float(np.sqrt(squared_speed * peak_overlap ** (exponent - 1.0)))
    force *= peak_overlap**exponent

    points = _FINER * len(overlap)
    spacing = period / points
    velocity = _Profile.of(force * box / speed, points, spacing)
    overlap_profile = _Profile.of(force * box**2 / speed**2, points, spacing)
    velocities, overlaps = velocity.polynomials[0], overlap_profile.polynomials[0]
    kinetic = 0.5 * float(np.sum(velocities**2)) * spacing
    potential = float(np.sum(np.maximum(overlaps, 0.0) ** (exponent + 1.0))) * spacing / (exponent + 1.0)
    return SolitaryWave(
        exponent=exponent,
        speed=speed,
        peak_overlap=peak_overlap,
        momentum=float(np.sum(velocities)) * spacing,
        energy=kinetic + potential,
        kinetic_share=kinetic / (kinetic + potential),
        shift=float(np.sum(overlaps)) * spacing,
        width=2.0 * _half(velocity),
        _velocity=velocity,
        _overlap=overlap_profile,
    )


def _half(velocity: _Profile) -> float:
    """Distance from the peak, in beads, at which a velocity of 1 there has fallen to a half."""
    xi = velocity.start + velocity.spacing * np.arange(velocity.polynomials.shape[1])
    last = np.flatnonzero(velocity.polynomials[0] >= 0.5)[-1:]
    falls = velocity.polynomials[:, last] - 0.5 * (np.arange(2 * _DERIVATIVES) == 0)[:, np.newaxis]
    share = hermite.falling_zero(falls, np.zeros(1), np.ones(1))
    return float(xi[last[0]] + velocity.spacing * share[0])


@dataclass(frozen=True)
class LongWave:
    """Nesterenko's wave of peak velocity 1, which is zero outside of ``width``; scales with v like the exact one."""

    exponent: float
    speed: float
    peak_overlap: float
    width: float
    """Width from end to end, beads: pi / (n - 1) * sqrt(n (n + 1) / 6), for Hertz 5 pi / sqrt(10)."""

    def velocity(self, xi: ArrayLike) -> Floats:
        """Velocity at a distance xi (any shape, beads) from the peak: ``cos(pi xi / width)**(2 / (n - 1))``."""
        phase = np.clip(np.asarray(xi, dtype=np.float64) / self.width, -0.5, 0.5)
        return np.asarray(np.cos(np.pi * phase) ** (2.0 / (self.exponent - 1.0)), dtype=np.float64)

    def overlap(self, xi: ArrayLike) -> Floats:
        """Overlap (strain times spacing) at a distance xi (any shape, beads): for Hertz ``peak_overlap * cos**4``."""
        return self.peak_overlap * self.velocity(xi)


def nesterenko(exponent: float = HERTZ) -> LongWave:
    """The long-wave theory, 0.8% too fast for Hertz; its errors fall as (n - 1)**2 in speed, as n - 1 in overlap.

    Nesterenko, J. Appl. Mech. Tech. Phys. 24, 733 (1983), for Hertz; Dynamics of Heterogeneous Materials (Springer,
    2001), chapter 1, for any n: ``overlap**(n - 1) = (n + 1) / 2 * (speed * cos)**2``, velocity = speed * overlap.

    Raises:
        ValueError: the exponent is not a number above 1.
    """
    n = _checked(exponent)
    speed = (2.0 / (n + 1.0)) ** (1.0 / (n + 1.0))
    return LongWave(n, speed, 1.0 / speed, float(np.pi / (n - 1.0) * np.sqrt(n * (n + 1.0) / 6.0)))


def _checked(exponent: float) -> float:
    if not 1.0 < exponent < np.inf:
        raise ValueError(f"exponent is {exponent!r}: a solitary wave needs a contact force overlap**n with n > 1")
    return float(exponent)


def has_wave(system: System) -> bool:
    """Whether there is an exact wave to compare pulses with: contacts are a power of the overlap, and carry one."""
    return physics.exponent(system) is not None and system.holds(Fact.PULSE) and system.holds(Fact.SONIC_VACUUM)


def wave_of(system: System) -> SolitaryWave:
    """The exact wave of the contacts; that of spheres where there is none, as a measure of how long a pulse takes.

    Where the contacts differ in strength it is that of a strength of 1.
    """
    if not has_wave(system):
        return solitary_wave()
    wave, strength = solitary_wave(physics.exponent(system) or HERTZ), laws.strength(system.along[0].law)
    return wave if np.ndim(strength) or strength == 1.0 else wave.of_strength(float(strength))
