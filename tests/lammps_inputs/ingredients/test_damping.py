"""Damping: restitution, reach of dashpots, stability; the motion is in `test_every_ingredient`."""

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from stock_lammps import run, scene

from lammps_inputs import Kick, laws, library, physics
from lammps_inputs.decks import deck
from lammps_inputs.ingredients.contacts.power import PowerContact
from lammps_inputs.ingredients.damping import Damping
from lammps_inputs.ingredients.preload import Precompression
from lammps_inputs.ingredients.unequal import BeadKind
from lammps_inputs.ingredients.walls import Face, Walls
from lammps_inputs.laws.dashpot import alpha
from lammps_inputs.limits import rates
from lammps_inputs.limits.rates import stability_bound
from workflow.engines.reference import engine

SLOW = pytest.mark.slow


@pytest.mark.parametrize("load", [None, 4.94])
def test_dashpots_between_chains_reach_as_far_as_their_springs_and_not_to_the_next_row(load: float | None) -> None:
    """Both beads of one chain are kicked, and the spring is so weak that it may take nearly half of their spacing."""
    both = (Kick(velocity=1.0), Kick(bead=2, velocity=1.0))
    pressed = load and Precompression(force=load)
    tied = scene(chains=2, beads=2, kappa=0.31, kick=both, damping=Damping(coupling=0.1), precompression=pressed)
    problem = tied.problem()
    cutoff = float(re.findall(r"dpd/ext/tstat 0 0 (\S+)", deck.render_deck(problem))[0])
    beside, reach = (
        2.0 * problem.layout.diameter,
        float(laws.max_strain(problem.system.across[0].law, physics.energy(problem.system))),
    )
    assert reach > 0.45 * problem.layout.spacing or load is None
    assert math.hypot(beside, reach) < cutoff < math.hypot(beside, problem.layout.spacing - reach)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("share", "exponent"),
    [(0.5, 1.5), pytest.param(0.7, 1.0, marks=SLOW), pytest.param(0.7, 2.0, marks=SLOW)],
)
def test_two_beads_part_with_their_restitution(share: float, exponent: float, tmp_path: Path) -> None:
    losing = Damping(contact=share, law="restitution")
    contact = PowerContact(exponent=exponent)
    step = 0.002 if exponent > 1.0 else 0.0002  # where linear contacts open, their dashpots' force jumps
    asked = scene(duration=10.0, contact=contact, damping=losing, timestep=step, every=10.0)
    first, second = run(asked, tmp_path / "run").velocity[-1, 0]
    assert second - first == pytest.approx(share, abs=5e-5)


@pytest.mark.slow
@pytest.mark.parametrize("exponent", [1.2, pytest.param(2.5, marks=SLOW), pytest.param(3.0, marks=SLOW)])
@pytest.mark.parametrize("wall", [False, pytest.param(True, marks=SLOW)])
def test_by_the_reference_beads_of_any_exponent_part_with_their_restitution(exponent: float, *, wall: bool) -> None:
    asked = scene(
        duration=10.0 if not wall else 4.5,
        gap=0.97,
        contact=PowerContact(exponent=exponent),
        kick=(Kick(bead=2 if wall else 1, velocity=1.0),),
        walls=Walls(right=Face(stiffness=2.0)) if wall else None,
        damping=Damping(contact=0.7, law="restitution"),
        every=0.1,
    )
    first, second = engine.run(asked.problem()).velocity[-1, 0]
    assert (-second if wall else second - first) == pytest.approx(0.7, abs=1e-6)


UNEQUAL: dict[str, dict[str, Any]] = {
    "masses": {"kinds": {"light": BeadKind(mass=0.3), "plain": BeadKind(mass=1.0)}, "pattern": ("light", "plain")},
    "strengths": {"contact": PowerContact(exponent=1.0, strength=(2.0, 1.0)), "beads": 3},
}


@pytest.mark.parametrize("name", [pytest.param(name, marks=SLOW) for name in UNEQUAL])
def test_each_of_linear_contacts_that_differ_has_the_restitution(name: str, tmp_path: Path) -> None:
    keys: dict[str, Any] = {"contact": PowerContact(exponent=1.0), "beads": 2, **UNEQUAL[name]}
    asked = scene(
        **keys,
        gap=0.97,
        damping=Damping(contact=0.7, law="restitution"),
        duration=2.7,  # after the first collision, before the next
        every=2.7,
        timestep=0.0001,
    )
    motion = run(asked, tmp_path / "run").velocity[-1, 0]
    assert motion[1] - motion[0] == pytest.approx(0.7, abs=5e-5)
    assert not np.any(motion[2:])


WALLS: dict[str, dict[str, Any]] = {
    "flat": {"walls": Walls(right="flat")},
    "left, hard": {"walls": Walls(left=Face(stiffness=20.0))},
    "heavy bead": {
        "walls": Walls(right=Face(stiffness=5.0)),
        "kinds": {"heavy": BeadKind(mass=3.0)},
        "pattern": ("heavy",),
    },
    "linear": {"walls": Walls(right=Face(stiffness=2.0)), "contact": PowerContact(exponent=1.0)},
    "square": {"walls": Walls(right=Face(stiffness=2.0)), "contact": PowerContact(exponent=2.0)},
}


@pytest.mark.parametrize(
    ("share", "name"),
    [(0.9, "flat"), *(pytest.param(0.7, name, marks=SLOW) for name in list(WALLS)[1:])],
)
def test_a_bead_comes_back_from_a_wall_with_its_restitution(share: float, name: str, tmp_path: Path) -> None:
    keys = WALLS[name]
    left = keys["walls"].left is not None
    asked = scene(
        **keys,
        gap=0.97,
        kick=(Kick(bead=1, velocity=-1.0) if left else Kick(bead=2, velocity=1.0),),
        damping=Damping(contact=share, law="restitution"),
        timestep=0.0002 if name in ("linear", "left, hard") else 0.001,  # where the dashpot's force jumps, or is quick
        duration=4.5,  # on its way back
        every=4.5,
    )
    first, last = run(asked, tmp_path / "run").velocity[-1, 0]
    assert (first if left else -last) == pytest.approx(share, abs=5e-5)
    assert (last if left else first) == 0.0


TIED: dict[str, dict[str, Any]] = {
    "cubic": {"stiffness": 0.1, "cubic": 0.2},
    "unequal": {"topology": {"edges": [[1, 2, 0.1], [2, 3, 0.4]]}},
}


@pytest.mark.parametrize("name", [pytest.param(name, marks=SLOW) for name in TIED])
def test_lammps_damps_springs_between_each_chain_and_the_next_whatever_their_law(name: str, tmp_path: Path) -> None:
    plain = {"name": name, "chains": 3, "beads": 8, "kick": {"velocity": 1.0}, "duration": 12.0, "timestep": 0.002}
    case = library.from_plain({**plain, "coupling": TIED[name], "damping": {"coupling": 0.05}}, name)
    reference = engine.run(case.problem())
    assert np.max(np.abs(run(case, tmp_path / "run").velocity - reference.velocity)) < 5e-4
    free = engine.run(library.from_plain({**plain, "coupling": TIED[name]}, name).problem())
    assert np.max(np.abs(free.velocity - reference.velocity)) > 5e-3


def test_a_restitution_is_that_of_the_reduced_mass_and_the_strength_of_each_contact() -> None:
    kinds = {"light": {"mass": 0.25}, "hard": {"stiffness": 3.0}}
    several: dict[str, Any] = {"kinds": kinds, "pattern": ["light", "hard", "hard"]}
    losing = {"contact": 0.7, "law": "restitution"}
    plain = {"name": "a", "beads": 3, "kick": {"velocity": 1.0}, "duration": 1.0, "damping": losing, **several}
    (link,) = library.from_plain(plain, "a").system.dampers
    right = [alpha(0.7) * math.sqrt(0.25 / 1.25 * 1.5), alpha(0.7) * math.sqrt(0.5 * 3.0)]
    np.testing.assert_allclose(link.law.coefficient, [right], rtol=1e-14)  # type: ignore[attr-defined]


def test_strong_dashpots_shorten_the_stable_step() -> None:
    free, stuck = scene(beads=4).problem(), scene(beads=4, damping=Damping(contact=100.0)).problem()
    assert stability_bound(stuck.system) == pytest.approx(2.0 / rates.drag(stuck.system), rel=0.01)
    assert stability_bound(scene(beads=4, damping=Damping(beads=100.0)).problem().system) == stability_bound(
        free.system
    )


@pytest.mark.slow
def test_lammps_is_stable_below_the_bound_and_not_above(tmp_path: Path) -> None:
    asked = scene(chains=2, kappa=0.5, duration=4.0, every=1.0, damping=Damping(coupling=20.0))
    bound = stability_bound(asked.problem().system)
    largest = []
    for factor in (0.9, 1.2):
        step = 1.0 / np.ceil(1.0 / (factor * bound))
        found = run(asked.model_copy(update={"timestep": step}), tmp_path / f"{factor}")
        largest.append(np.max(np.abs(found.velocity)))
    assert largest[0] <= 1.0
    assert largest[1] > 1.0
