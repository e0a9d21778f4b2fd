"""What seems to be wrong with a trajectory, in words for its owner; `analysis.against.symptoms` does the measuring.

Every measurement is made on the reference too, so that what the method itself gets wrong (far apart frames, motion in
round numbers) is not taken for a fault of the trajectory.
"""

import math
from collections import Counter

import numpy as np

from analysis import motion
from analysis.against import start, symptoms
from analysis.files.recording import rest_positions
from analysis.trajectory import Floats, Trajectory
from lammps_inputs import laws, physics
from lammps_inputs.laws.in_time import Sine
from lammps_inputs.limits import rates
from lammps_inputs.loads import Load, Motion
from lammps_inputs.units import Scale

_MOTION_DOUBT = 1e-6
"""Share of the amplitude; the motion is given, to rounding."""

_TURN = 4.0
"""Doubt of a phase, in radians, over that of its sine's amplitude, as impulses of forces drift between frames."""

_PUSH_DOUBT = 5e-3
"""Share of the impulse; half a step of a force that ends at a frame may be missing there."""


def driven(own: Trajectory) -> list[str]:
    """Whether beads whose motion is given move by another sine."""
    problem, found = own.problem, []
    scale = problem.scale
    for given in problem.system.motions:
        is_at = _off_its_way(own, given)
        if is_at is None:
            continue
        sine = _sine(own.time, is_at, given.omega, _MOTION_DOUBT)
        if sine is not None:
            omega, along, across = sine
            amplitude, phase = math.hypot(along, across), math.atan2(across, along)
            right = given.amplitude * scale.length, given.omega, given.phase
            said = _other_sine("displacement", (amplitude * scale.length, omega, phase), right, scale, _MOTION_DOUBT)
            found += [f"the drive of bead {given.bead} of chain {given.chain} has {said}"] if said else []
    return found


def moved(own: Trajectory) -> list[str]:
    """Whether beads whose motion is given move otherwise."""
    return [
        f"bead {given.bead} of chain {given.chain} does not move as the drive says"
        for given in own.problem.system.motions
        if _off_its_way(own, given) is not None
    ]


def _off_its_way(own: Trajectory, given: Motion) -> Floats | None:
    """Displacement of a bead whose motion is given; None where it moves so."""
    is_at = own.displacement[:, given.chain - 1, given.bead - 1]
    off = np.max(np.abs(is_at - given.displacement(own.time)))
    return None if off < _MOTION_DOUBT * abs(given.amplitude) else is_at


def _sine(time: Floats, values: Floats, near: float, doubt: float) -> tuple[float, float, float] | None:
    """``a sin(omega t) + b (cos(omega t) - 1)`` as omega, a, b; omega as near to one as explains all but a doubt."""

    def fit(omega: float) -> tuple[float, Floats]:
        basis = np.stack([np.sin(omega * time), np.cos(omega * time) - 1.0], axis=-1)
        factors = np.linalg.lstsq(basis, values, rcond=None)[0]
        return float(np.sum((values - basis @ factors) ** 2)), factors

    tried, best = near * np.geomspace(0.5, 2.0, 401), near
    enough = doubt**2 * float(np.sum(values**2))
    for _ in range(9):
        left, (along, across) = fit(best)
        if left <= enough:
            return best, float(along), float(across)
        best = min(tried.tolist(), key=lambda omega: fit(omega)[0])
        tried = best * (tried / tried[200]) ** 0.05
    return None


def _other_sine(
    what: str, found: tuple[float, float, float], right: tuple[float, float, float], scale: Scale, doubt: float
) -> str:
    """What differs of two sines, each its amplitude, angular frequency and phase."""
    turned = math.pi if right[0] < 0.0 else 0.0
    late = math.remainder(found[2] + turned - right[2], 2.0 * math.pi)
    second = 2.0 * math.pi * scale.time
    size_unit, hertz = scale.after(what.replace("displacement", "length")), scale.after("cycles")
    said = [
        f"a {name} of {here:.4g} instead of {there:.4g}{unit}"
        for name, here, there, size, unit in (
            (what, math.copysign(found[0], right[0]), right[0], abs(right[0]), size_unit),
            ("frequency", found[1] / second, right[1] / second, right[1] / second, hertz),
            ("phase", math.degrees(right[2] + late), math.degrees(right[2]), math.degrees(_TURN), " degrees"),
        )
        if abs(here - there) > doubt * size and f"{here:.4g}" != f"{there:.4g}"
    ]
    return " and ".join(said)


def pushes(own: Trajectory, reference: Trajectory) -> list[str]:
    """Whether the beads were given another impulse from outside than the scene says."""
    problem, found = own.problem, []
    system = problem.system
    if own.time[0] != 0.0:
        return []
    places = Counter((load.chain, load.bead) for load in system.loads)
    for load in system.loads:
        if places[load.chain, load.bead] > 1:  # which of them is wrong cannot be determined
            continue
        right = load.impulse(own.time)
        off, method = (symptoms.impulse_given(one, load) - right for one in (own, reference))
        most, furthest = (float(np.max(np.abs(values))) for values in (right, off))
        felt = right + off - method
        if most == 0.0 or np.max(np.abs(felt - right)) < _PUSH_DOUBT * most or furthest < np.max(np.abs(method)):
            continue  # right, or the reference is further off than this
        what = "drive" if load.endless else "push"
        name = f"the {what}" if len(system.loads) == 1 else f"the {what} on bead {load.bead} of chain {load.chain}"
        if said := _other_push(load, own.time, felt, problem.scale):
            found.append(f"{name} {said}")
    left = symptoms.beyond(own, reference)
    by = np.zeros_like(left)
    for load in system.loads:
        by[:, load.chain - 1, load.bead - 1] = left[:, load.chain - 1, load.bead - 1]
    return found if _explains(by, left) else []


def _explains(by: Floats, left: Floats) -> bool:
    """Whether the impulses of a cause are what the scene's forces do not explain."""
    return bool(np.sum((left - by) ** 2) <= _LITTLE * np.sum(left**2))


def _other_push(load: Load, time: Floats, felt: Floats, scale: Scale) -> str:
    """What is wrong with a push that gave another impulse over time than it should; empty within its doubt."""
    law = load.law
    if np.max(np.abs(felt)) < _PUSH_DOUBT * load.law.total:
        return "is missing"
    if isinstance(law, Sine) and (sine := _sine(time, felt, law.omega, _PUSH_DOUBT)) is not None:
        omega, along, across = sine
        there = law.peak * scale.force, law.omega, law.phase
        here = omega * math.hypot(along, across) * scale.force, omega, math.atan2(along, -across)
        said = _other_sine("force", here, there, scale, _PUSH_DOUBT)
        return f"has {said}" if said else ""
    shape = np.asarray(law.impulse(time, *law))
    factor = float(np.sum(felt * shape) / np.sum(shape * shape))
    if np.sum((felt - factor * shape) ** 2) < _PUSH_DOUBT**2 * np.sum(felt * felt):
        return f"is {factor:.4g} times as strong as the scene says"
    return "has another course over time than the scene says"


_CLEAR = 0.97
"""Share of the squared difference that a cause must explain."""

_MOST_NAMED = 10

_EXPLAINED = 0.03
"""Share of what the scene's own forces leave unexplained that other strengths of them must leave at most."""

_LITTLE = 0.3
"""The same of a cause that was measured bead by bead."""

_OF_METHOD = 2.0
"""What a cause leaves unexplained over what the reference does, up to which the method has left it."""

_METHOD = 0.25
"""Of a strength: if the reference differs more from the scene, the method does not work on these frames."""

_BESIDE = 0.01
"""Share of what the strongest or weakest differs by, which others seem to differ by beside it."""

_LAW_DOUBT = 0.05
"""Of a strength that does not explain what is wrong; long steps leave less."""

_LOAD_DOUBT = 5e-3
"""Share of a static load."""

_BEAD_DOUBT = 0.01
"""Of a mass or a contact's strength."""

_MOST_WRONG = 4
"""Single beads that are named; were more wrong, something else would be."""


def causes(own: Trajectory, reference: Trajectory) -> list[str]:
    """What seems to be wrong, most of all first; empty if nothing can be determined.

    Args:
        own: consecutive frames of the trajectory, all beads.
        reference: the same frames, right.
    """
    found = _numbers(own) or driven(own) or _times(own, reference) or moved(own)
    if own.problem.system.inner_mass is not None and own.inner is None:
        return found  # forces on the beads are not known
    found = found or (start.differences(own) if own.time[0] == 0.0 else []) or pushes(own, reference)
    if own.problem.system.inner_links:  # whose forces on their beads act as static ones where they are wrong
        found = found or _strengths(own, reference)
    found = found or _static(own, reference) or _exponent(own, reference)
    found = found or ([] if physics.one_kind(own.problem.system) else _beads(own, reference))
    found = found or _strengths(own, reference) or _springs(own, reference)
    found = found or (_beads(own, reference) if physics.one_kind(own.problem.system) else [])
    return found or _laws(own, reference)


def rounded(own: Trajectory, reference: Trajectory) -> list[str]:
    """Which of the numbers were rounded on their way into the file; any beads."""
    found = []
    rest = rest_positions(own.problem) if own.problem.window is None else own.beads * own.problem.layout.spacing
    for name, values, right in (
        ("positions", own.displacement + rest, reference.displacement + rest),
        ("velocities", own.velocity, reference.velocity),
    ):
        moved = own.displacement != 0.0
        precision = symptoms.precision(values[moved])
        if precision is not None and symptoms.precision(right[moved]) is None:
            found.append(f"{name} have only {precision}; write them with %.17g or in binary")
    return found


def _numbers(own: Trajectory) -> list[str]:
    wrong = ~np.all(np.isfinite(own.displacement) & np.isfinite(own.velocity), axis=(1, 2))
    if not wrong.any():
        return []
    time = own.problem.scale.written(own.time[int(np.argmax(wrong))], "time")
    return [f"from t = {time} on, positions or velocities are not finite numbers (a time step too long?)"]


def _acceleration(reference: Trajectory) -> Floats:
    """Of the beads, [frame, chain, bead]."""
    x, v = reference.atoms
    found = motion.acceleration(reference.problem.system, x, time=reference.time, velocity=v)
    return found[:, : reference.problem.chains]


def _times(own: Trajectory, reference: Trajectory) -> list[str]:
    """Whether a shift in time, of all or of the velocities alone, explains the difference."""
    problem = own.problem
    velocity = symptoms.time_shift(
        own.velocity - reference.velocity,
        _acceleration(reference),
    )
    displacement = symptoms.time_shift(own.displacement - reference.displacement, reference.velocity)
    if velocity.explained < _CLEAR:
        return []
    if displacement.explained > _CLEAR and abs(displacement.time / velocity.time - 1.0) < 0.1:
        word = "earlier" if displacement.time > 0.0 else "later"
        shift = problem.scale.written(abs(displacement.time), "time", ".2g")
        return [f"all frames are shown {shift} {word} than they are"]
    if abs(displacement.time) < 0.1 * abs(velocity.time):
        steps = velocity.time / problem.timestep
        word = "after" if steps > 0.0 else "before"
        return [f"velocities are those of {abs(steps):.2g} time steps {word} the positions (half-step velocities?)"]
    return []


def _beads(own: Trajectory, reference: Trajectory) -> list[str]:
    """Whether beads are heavier, or contacts stronger, than the scene says: of one kind, or single ones.

    Where dashpots are quicker than contacts, beads go as forces let them, and hardly as they weigh.
    """
    problem = own.problem
    system = problem.system
    if rates.drag(system) > rates.fastest(system):
        return []
    felt, right = symptoms.identify_beads(own), symptoms.identify_beads(reference)
    if felt is None or right is None:
        return []
    found: list[str] = []
    if not _explains(_of_beads(own, felt, right), symptoms.beyond(own, reference)):
        return found
    for values, expected, kinds, what, names in (
        (felt.mass, right.mass, system.mass, "heavy", ("beads of mass {}", "all beads", "bead {} of chain {}")),
        (felt.strength, right.strength, laws.strength(system.along[0].law), "strong",
         ("contacts of strength {}", "all contacts", "the contact of beads {} and {next} of chain {}")),
    ):  # fmt: skip
        with np.errstate(invalid="ignore"):
            factor, doubt = values / expected, _BEAD_DOUBT + 3.0 * np.abs(expected - 1.0)
            wrong = np.abs(factor - 1.0) > doubt
        kind_of = np.broadcast_to(kinds, factor.shape)
        single, named = wrong.copy(), len(found)
        for kind in np.unique(kind_of[wrong]).tolist():
            members = (kind_of == kind) & np.isfinite(factor)
            if np.count_nonzero(members) > 1 and np.all(wrong[members]) and np.ptp(factor[members]) < symptoms.SAME:
                single[members] = False
                name = names[1] if np.ptp(kind_of) == 0.0 else names[0].format(f"{kind:.4g}")
                found.append(f"{name} are {np.median(factor[members]):.4g} times as {what} as the scene says")
        if max(int(np.count_nonzero(single)), len(found) - named) > _MOST_WRONG:
            return (
                _profile(own, values / np.where(np.isfinite(expected), expected, 1.0))
                if what == "strong" and not named
                else []
            )
        for chain, place in np.argwhere(single).tolist():
            name = names[2].format(place + 1, chain + 1, next=place + 2)
            found.append(f"{name} is {factor[chain, place]:.4g} times as {what} as the scene says")
    return found


def _of_beads(own: Trajectory, felt: symptoms.Felt, right: symptoms.Felt) -> Floats:
    """What beads and contacts that differ from the scene's leave unexplained."""
    heavier, stronger = (
        np.nan_to_num(np.where(np.abs(off) > _BEAD_DOUBT, off, 0.0))
        for off in (felt.mass - right.mass, felt.strength - right.strength)
    )
    by = -heavier * own.problem.system.mass * np.diff(own.velocity, axis=0)
    for link in own.problem.system.along:
        by += symptoms.on_beads(link, stronger * symptoms.of_link(link, own), own)
    return np.asarray(by)


def _profile(own: Trajectory, factor: Floats) -> list[str]:
    """Whether other strengths of the contacts along the chains, the scene's times factors, explain the motion."""
    (contact,) = own.problem.system.along
    left = symptoms.unexplained(own, (contact,))
    contact.drive(left, -np.where(np.isfinite(factor), factor, 1.0) * symptoms.of_link(contact, own))
    if np.sum(left**2) > _EXPLAINED * np.sum(symptoms.unexplained(own) ** 2):
        return []
    right = np.broadcast_to(laws.strength(contact.law), factor.shape)
    felt = right * factor
    known = np.isfinite(felt)
    if np.ptp(np.log(felt[known])) < symptoms.SAME:
        ends = f"{np.min(right):.4g} to {np.max(right):.4g}"
        return [f"all contacts have the strength {np.median(felt[known]):.4g} instead of {ends} (no contact.strength?)"]
    off = np.where(known, np.abs(factor - 1.0), 0.0)
    chain, place = np.unravel_index(int(np.argmax(off)), off.shape)
    return [
        f"{np.count_nonzero(off > _BEAD_DOUBT)} contacts have another strength than the scene says, most of all that "
        f"of beads {place + 1} and {place + 2} of chain {chain + 1}: {felt[chain, place]:.4g} instead of "
        f"{right[chain, place]:.4g}"
    ]


def _static(own: Trajectory, reference: Trajectory) -> list[str]:
    """Whether the static forces on the beads differ from the scene's."""
    felt, right = symptoms.identify_load(own), symptoms.identify_load(reference)
    if felt is None or right is None:
        return []
    if right.pressed == 1.0 and felt.pressed != 1.0:
        if felt.pressed == 0.0:
            return ["the static load is missing"]
        return [f"the contacts carry about {felt.pressed:.3g} times the static load of the scene"]
    if abs(felt.holding - 1.0) > _LOAD_DOUBT + 3.0 * abs(right.holding - 1.0):
        if abs(felt.holding) < _LOAD_DOUBT:
            return ["the forces that hold the beads at rest (on the ends, or weights) are missing"]
        return [f"the forces that hold the beads at rest are {felt.holding:.4g} times what the scene says"]
    return []


def _strengths(own: Trajectory, reference: Trajectory) -> list[str]:
    """Whether the beads were held, or tied in ways that `_springs` does not know, otherwise than the scene says.

    So also contacts whose force is a formula, of which neither an exponent nor a load is known.
    """
    system = own.problem.system
    contacts = system.along if physics.exponent(system) is None and len(system.along) == 1 else ()
    across = () if physics.open_row(system) else system.across
    links = (*contacts, *system.ground, *across, *system.inner_links, *system.dampers)
    if not links:
        return []
    felt, right = symptoms.identify_strengths(own), symptoms.identify_strengths(reference)
    if felt is None or right is None or not _explained(felt, right):
        return _inner_masses(own, reference, 1.0)
    found = []
    names = [link.name for link in links] + [symptoms.in_time(link) for link in links if laws.varies(link.law)]
    factors = {name: _factor(name, felt, right) for name in names}
    aside = _BESIDE * max(abs(factor - 1.0) for factor, _ in factors.values())
    for name, (factor, least) in factors.items():
        doubt = max(least, aside)
        said = f"the {name.replace('_', ' ')} {'are' if name.rstrip('_0123456789').endswith('s') else 'is'}"
        if abs(factor) < doubt:
            found.append(f"{said} missing")
        elif abs(factor - 1.0) > doubt:
            found.append(f"{said} {factor:.4g} times as strong as the scene says")
    strength = next((_factor(link.name, felt, right)[0] for link in system.inner_links), 1.0)
    return found + _inner_masses(own, reference, strength)


def _inner_masses(own: Trajectory, reference: Trajectory, strength: float) -> list[str]:
    """Whether inner atoms on springs so many times as strong have another mass than the scene says."""
    if len(own.problem.system.inner_links) != 1:
        return []
    factor = strength * symptoms.felt_inner_mass(own) / symptoms.felt_inner_mass(reference)
    if not abs(factor - 1.0) > _BEAD_DOUBT or strength < _BEAD_DOUBT:
        return []
    name = own.problem.system.inner_links[0].name
    return [f"the {name.replace('_', ' ')} are {factor:.4g} times as heavy as the scene says"]


def _laws(own: Trajectory, reference: Trajectory) -> list[str]:
    """Whether what holds beads, or stops them, acts otherwise than the scene says, however strong it is."""
    links = (*own.problem.system.ground, *own.problem.system.dampers)
    if not links:
        return []
    felt, right = symptoms.identify_strengths(own), symptoms.identify_strengths(reference)
    if felt is None or right is None or _explained(felt, right):
        return []
    off = {link.name: _off(*_factor(link.name, felt, right)) for link in links}
    name = max(off, key=lambda name: off[name])
    return [f"the {name.replace('_', ' ')} follows another law than the scene says"] if off[name] > _LAW_DOUBT else []


def _explained(felt: symptoms.Strengths, right: symptoms.Strengths) -> bool:
    """Whether other strengths explain a motion, but for what the method leaves of the reference's."""
    return felt.left <= _EXPLAINED or felt.power <= _OF_METHOD * right.power


def _factor(name: str, felt: symptoms.Strengths, right: symptoms.Strengths) -> tuple[float, float]:
    """How strong a link was felt to be, and the doubt of that; 1 where nothing has reached it, or the reference itself
    tells something else.
    """
    here, there = (found.factors.get(name, math.nan) for found in (felt, right))
    if math.isnan(here) or not abs(there - 1.0) <= _METHOD:
        return 1.0, 0.0
    return here / there, 5e-4 + 3.0 * abs(there - 1.0)


def _off(factor: float, doubt: float) -> float:
    """How much beyond its doubt."""
    return abs(factor - 1.0) - doubt


def _springs(own: Trajectory, reference: Trajectory) -> list[str]:
    """Whether the beads felt other springs than the scene's."""
    problem = own.problem
    system = problem.system
    felt, right = symptoms.identify_springs(own), symptoms.identify_springs(reference)
    if felt is None:
        return []
    if felt.cubic and not (right is not None and right.cubic):
        return [f"the coupling is cubic ({felt.cubic:.4g} times the cube), not linear: is r0 of the bonds 0?"]
    moved = np.isfinite(felt.linear)
    typical = float(np.median(felt.linear[moved]))
    if not physics.coupled(system):
        doubt = 1e-6 if right is None else 1e-6 + 3.0 * float(np.nanmax(np.abs(right.linear)))
        return [f"the chains are coupled ({typical:.4g}), though the scene has no coupling"] if typical > doubt else []
    missing = np.argwhere(moved & (felt.linear < 0.5 * typical))
    if right is not None:
        whole = np.isfinite(right.linear)
        if np.any(np.abs(right.linear[whole] / physics.kappa(system) - 1.0) > _METHOD):
            return []
    weight = np.zeros_like(felt.linear)
    weight[tuple(missing.T)] = -1.0
    if 0 < len(missing) <= _MOST_NAMED and _explains(_of_springs(own, weight), symptoms.beyond(own, reference)):
        rows = ", ".join(f"row {row + 1} between chains {chain + 1} and {chain + 2}" for chain, row in missing)
        return [f"no spring in {rows}"]
    expected = physics.kappa(system) if right is None else float(np.nanmedian(right.linear))
    more = typical / expected - 1.0
    off = abs(more) > 5e-4 + 3.0 * abs(expected / physics.kappa(system) - 1.0)
    if off and _explains(_of_springs(own, more), symptoms.beyond(own, reference)):
        unit = problem.scale.stiffness
        kappa = physics.kappa(system)
        found, right_one = typical / expected * kappa * unit, kappa * unit
        if abs(found) < 1e-3 * right_one:
            return [f"the chains are not coupled, though the scene says {right_one:.4g}"]
        return [f"the coupling is {found:.4g} instead of {right_one:.4g}"]
    return []


def _of_springs(own: Trajectory, more: Floats | float) -> Floats:
    """What springs so many times stronger than the scene's leave unexplained."""
    by = np.zeros_like(own.velocity[1:])
    for link in own.problem.system.across:
        by += symptoms.on_beads(link, more * symptoms.of_link(link, own), own)
    return by


def _exponent(own: Trajectory, reference: Trajectory) -> list[str]:
    """Whether the contacts had another exponent than the scene's."""
    felt, right = symptoms.identify_exponent(own), symptoms.identify_exponent(reference)
    expected = physics.exponent(own.problem.system)
    if felt is None or right is None or expected is None or abs(felt - right) < 1e-3 + 3.0 * abs(right - expected):
        return []
    return [f"the contacts have the exponent {felt:.3f} instead of {expected:g}"]
