"""The exact solitary wave of a problem's contacts, where they have one."""

from analysis.shape.exact_wave import HERTZ, SolitaryWave, solitary_wave
from lammps_inputs import System, physics
from lammps_inputs.facts import Fact


def has_wave(system: System) -> bool:
    """Whether there is an exact wave to compare pulses with: contacts are a power of the overlap, and carry one."""
    return physics.exponent(system) is not None and system.holds(Fact.PULSE) and system.holds(Fact.SONIC_VACUUM)


def wave_of(system: System) -> SolitaryWave:
    """The exact wave of the contacts; that of spheres where there is none, as a measure of how long a pulse takes."""
    exponent = physics.exponent(system) if has_wave(system) else None
    return solitary_wave(HERTZ if exponent is None else exponent)
