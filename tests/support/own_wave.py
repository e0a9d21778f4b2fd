"""The exact solitary wave of contacts of an exponent, by the iteration of English & Pego (2005) on a grid."""

from functools import cache
from typing import Any, NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline


class Wave(NamedTuple):
    """Of peak velocity 1; speed in beads / T."""

    exponent: float
    speed: float
    overlap: float
    energy: float
    shift: float
    width: float
    velocity: Any
    """Over the distance from the peak, in beads."""

    def speed_at(self, peak: Any) -> Any:
        return self.speed * peak ** ((self.exponent - 1.0) / (self.exponent + 1.0))


@cache
def wave(exponent: float = 1.5) -> Wave:
    """See the table in `analysis.shape.exact_wave` for how its numbers go with the amplitude."""
    size, reach = 8192, 24.0
    xi = (np.arange(size) - size // 2) * (2.0 * reach / size)
    box = np.sinc(np.fft.fftfreq(size, 2.0 * reach / size))

    def spread(values: Any, kernel: Any) -> Any:
        return np.fft.ifft(np.fft.fft(np.fft.ifftshift(values)) * kernel).real

    r = np.exp(-(xi**2))
    for _ in range(400):
        new = np.fft.fftshift(spread(np.maximum(r, 0.0) ** exponent, box**2))
        squared = new.max()
        if np.max(np.abs(new / squared - r)) < 1e-15:
            break
        r = new / squared
    r = np.maximum(r, 0.0)
    push = np.fft.fftshift(spread(r**exponent, box))
    # overlap a r with c**2 = squared a**(n - 1); a is such that c v = a**n push has the peak 1
    a = (np.sqrt(squared) / push.max()) ** (2.0 / (exponent + 1.0))
    speed = float(np.sqrt(squared * a ** (exponent - 1.0)))
    velocity = a**exponent * push / speed
    step = xi[1] - xi[0]
    energy = float(np.sum(0.5 * velocity**2 + (a * r) ** (exponent + 1.0) / (exponent + 1.0)) * step)
    profile = CubicSpline(xi, velocity)
    right = xi[(xi >= 0.0) & (velocity < 0.5)][0]
    for _ in range(60):
        right -= float((profile(right) - 0.5) / profile(right, 1))
    return Wave(
        exponent, speed, float(a * r.max()), energy, float(velocity.sum() * step / speed), 2.0 * float(right),
        lambda at: np.where(np.abs(at) < reach * 0.9, profile(np.clip(at, -reach * 0.9, reach * 0.9)), 0.0),
    )  # fmt: skip
