"""Driven, damped scenes: which have responses, at which frequency, and their linear response."""

import math
from dataclasses import replace
from typing import Any

import numpy as np

from granchain import InputError
from granchain.parts import Flags, Floats, Problem, System, physics
from workflow.plugins.modes.linear import damping_matrix, free_atoms, mass_of_atoms, stiffness_matrix

UNDAMPED = 1e-9
"""Rate of decay, over the largest angular frequency, up to which a linear mode counts as undamped."""


def refuse_no_response(problem: Problem, source: str) -> None:
    """Refuse a scene that has no isolated periodic responses to one sinusoidal drive.

    Args:
        problem: of the scene.
        source: name of the scene in messages.

    Raises:
        InputError: says what is missing, or not allowed.
    """
    system = problem.system
    if not all(each.law.omega for each in system.loads):
        raise InputError(f"{source}: push: is not sinusoidal; `--frequencies` needs a `drive` alone")
    if physics.varying(system):
        raise InputError(f"{source}: foundation: varies in time; `--frequencies` needs a `drive` alone")
    if not all(law.omega for law in _laws(system)):
        raise InputError(f"{source}: drive: is not sinusoidal; `--frequencies` needs a sinusoidal one")
    frequencies = sorted({law.omega for law in _laws(system)})
    if not frequencies:
        raise InputError(f"{source}: drive: is missing; `--frequencies` gives responses to a sinusoidal drive")
    if len(frequencies) > 1:
        texts = [f"{problem.scale.measured(omega / (2.0 * math.pi), 'cycles'):.6g}" for omega in frequencies]
        raise InputError(f"{source}: drive: has the frequencies {', '.join(texts)}; `--frequencies` needs the same one")
    if not system.dampers:
        raise InputError(f"{source}: damping: is missing; without it responses depend on the start for ever")
    slowest_decay(problem, source)


def _laws(system: System) -> list[Any]:
    """Laws in time of motions and loads."""
    return [law for motion in system.motions for law in motion.laws] + [load.law for load in system.loads]


def at_period(problem: Problem, period: float) -> Problem:
    """The problem with all drives of another period, in units of T."""
    omega, system = 2.0 * math.pi / period, problem.system

    def changed(law: Any) -> Any:
        return law.of(*(law.numbers | {"omega": omega}).values())

    loads = tuple(replace(load, law=changed(load.law)) for load in system.loads)
    motions = tuple(replace(prescribed, laws=tuple(map(changed, prescribed.laws))) for prescribed in system.motions)
    return replace(problem, system=replace(system, loads=loads, motions=motions))


def moving_atoms(system: System) -> Flags:
    """Atoms whose motion is not given, [line, bead]."""
    free = free_atoms(system)
    for prescribed in system.motions:
        free[prescribed.chain - 1, prescribed.bead - 1] = False
    return free


def slowest_decay(problem: Problem, source: str) -> float:
    """Rate at which the slowest small deviation from rest decays, in 1 / T.

    Args:
        problem: of a driven scene.
        source: name of the scene in messages.

    Raises:
        InputError: some deviations do not decay.
    """
    system = problem.system
    atoms = np.flatnonzero(moving_atoms(system))
    mass = mass_of_atoms(system).ravel()[atoms, np.newaxis]
    stiffness, damping = (matrix(system)[np.ix_(atoms, atoms)] / mass for matrix in (stiffness_matrix, damping_matrix))
    unit = np.eye(len(atoms))
    rates = np.linalg.eigvals(np.block([[np.zeros_like(unit), unit], [-stiffness, -damping]]))
    slowest = -float(np.max(rates.real))
    if slowest <= UNDAMPED * math.sqrt(float(np.linalg.norm(stiffness, 2)) + 1e-300):
        raise InputError(
            f"{source}: small deviations from rest do not all decay: contacts need a load (`precompression`), chains "
            "something that holds them (`walls`, `foundation`), and every mode a dashpot (`damping: {beads: ...}`)"
        )
    return slowest


def linear_response(problem: Problem) -> tuple[Floats, Floats]:
    """Displacements and velocities at phase 0 of the linearised steady response, [line, bead] each.

    Args:
        problem: with the drive's frequency.
    """
    system = problem.system
    omega = _laws(system)[0].omega
    mass, moving = mass_of_atoms(system), moving_atoms(system).ravel()
    force, prescribed_motion = np.zeros((2, *mass.shape), dtype=complex)
    offset = np.zeros(mass.shape)
    for load in system.loads:
        peak, _, phase = load.law.numbers.values()
        force[load.chain - 1, load.bead - 1] += peak * np.exp(1j * phase)
    for prescribed in system.motions:
        place = prescribed.chain - 1, prescribed.bead - 1
        for amplitude, _, phase in (law.numbers.values() for law in prescribed.laws):
            prescribed_motion[place] += amplitude * np.exp(1j * phase)
            offset[place] -= amplitude * math.sin(phase)
    stiffness = stiffness_matrix(system)
    dynamic = stiffness - omega**2 * np.diag(mass.ravel()) + 1j * omega * damping_matrix(system)
    complex_amplitude, shift = prescribed_motion.ravel(), offset.ravel()
    for matrix, right, values in ((dynamic, force.ravel(), complex_amplitude), (stiffness, 0.0, shift)):
        values[moving] = np.linalg.solve(matrix[np.ix_(moving, moving)], (right - matrix @ values)[moving])
    x, v = complex_amplitude.imag + shift, omega * complex_amplitude.real
    return x.reshape(mass.shape), v.reshape(mass.shape)
