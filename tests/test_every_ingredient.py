"""Every ingredient, in every way that it can be given: deck, LAMMPS, reference and resume do what its keys say.

The cases are in `ingredient_scenes`; the exact motion is by the integrator that shares no code with the product.
"""

import functools

import numpy as np
import pytest
from ingredient_scenes import CASES, STEEL, exact, exponent, in_units, scene
from plain_scene import goes_on_bit_for_bit
from stock_lammps import run as run_deck
from wrong_runs import deck_run, substituted, without_uncertainties

from analysis.conservation import ConservationMeter
from lammps_inputs import laws, physics
from lammps_inputs.decks import continuation, deck
from lammps_inputs.facts import Fact
from lammps_inputs.ingredients.registry import INGREDIENTS
from workflow.engines.reference import engine
from workflow.engines.reference.schemes import VERLET
from workflow.runs.run import run
from workflow.verdicts.analysis_files import analyse
from workflow.verdicts.validate import validate

pytestmark = pytest.mark.usefixtures("lammps_here")

QUICK = {"dimer of sizes", "walls"}


def marked(names):
    return [name if name in QUICK else pytest.param(name, marks=pytest.mark.slow) for name in names]


ALL = marked(CASES)
ELASTIC = [name for name in CASES if not CASES[name].keys() & {"damping", "precompression", "gravity"}]
DAMPED = [
    "damping all, exponent 2, pressed",
    "damping viscoelastic, cut",
    "damping cut, pressed by a wall",
    "damped column",
    "exponents by chain, damped",
]
AT_REST = [name for name, keys in CASES.items() if keys.keys() & {"precompression", "gravity"}]
AT_REST = [name for name in AT_REST if not CASES[name].keys() & {"damping", "drive"}]
AT_REST += ["random contacts, damping viscoelastic", "damping viscoelastic, exponent 1, pressed"]

BY_BOND = {"lattice", "formulas of springs"}
"""Ranks may add up the springs of a row on their border in another order."""
ACROSS_RANKS = [
    *sorted(BY_BOND),
    "foundations over time",
    "closed to rings of sizes",
    "bonded rings, initial states",
    "disorder",
    "walls of exponent 3, gap",
    "column",
    "driven by two tones, a piston and records",
    "magnets",
    "pushed by long records",
    "resonators, damped in some rows, pushed, with all other dashpots",
]
RESUMED = [
    *ACROSS_RANKS,
    "exponents by contact",
    "closed to rings, damped",
    "foundation that vanishes in time beside a graded one",
    "initial states of all atoms, pressed, damped, walls",
    "damping cut, pressed by a wall",
]
"""One of each kind that restarts hold or that continued decks give again."""
OLD = ["cubic ring", "dimer of sizes", "foundations over time", "wavy contacts, gap, walls", "closed to rings"]
OLD += ["damping cut, pressed by a wall", "resonators, damped, driven, walls, foundation, drag"]
RECORDED = ["walls", "lattice", "closed to rings of sizes", "resonators of two kinds, in some rows"]
COMPILED_ANEW = [
    "foundations over time",
    "driven",
    "damping viscoelastic, cut",
    "damping cut, pressed by a wall",
    "graded contacts, damping restitution, pressed",
    "resonators, damped in some rows, pushed, with all other dashpots",
]
"""For LAMMPS's scheme, as the reference is for every combination with dashpots, loads or drives."""


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    """Case -> its run with the measured error."""
    return functools.cache(lambda name: run(scene(name), tmp_path_factory.mktemp("done") / "run"))


def error(result, name):
    return float(np.max(np.abs(result.trajectory.velocity - exact(name))))


def test_every_ingredient_has_a_case():
    """A new one has its line in `CASES` of `ingredient_scenes.py`."""
    assert INGREDIENTS.keys() <= {key for keys in CASES.values() for key in keys}


@pytest.mark.slow
@pytest.mark.parametrize("name", ALL)
def test_lammps_tends_to_the_exact_motion_with_its_order(name, done, tmp_path):
    coarse = error(run(scene(name, timestep=0.02), tmp_path / "coarse", check=False), name)
    fine = error(done(name), name)
    order = 2 if scene(name).problem().system.holds(Fact.SECOND_ORDER) else 1
    # linear contacts begin with a kink, whose error depends on where it lies in a step
    linear = 1.0 in np.ravel(CASES[name].get("contact", {}).get("exponent", 1.5))
    assert np.log2(coarse / fine) == pytest.approx(order, abs=0.25 if linear else 0.05)


def error_of_all_atoms(result, name):
    """Largest error of beads and resonators; the latter by the reference, which is as certain as its run states."""
    of_beads, further = error(result, name), result.trajectory.further_lines
    if further is None:
        return of_beads
    exact_lines = engine.run(scene(name).problem()).further_lines
    return max(of_beads, float(np.max(np.abs(further[:, 1] - exact_lines[:, 1]))))


@pytest.mark.slow
@pytest.mark.parametrize("name", ALL)
def test_a_run_states_its_error(name, done):
    check, second = done(name).check, scene(name).problem().system.holds(Fact.SECOND_ORDER)
    assert error(done(name), name) < (3e-4 if second else 2e-3)
    assert check.velocity == pytest.approx(error_of_all_atoms(done(name), name), abs=check.reference.velocity)


@pytest.mark.slow
@pytest.mark.parametrize("name", ALL)
def test_the_reference_is_within_its_stated_uncertainty_of_the_exact_motion(name, done):
    stated = done(name).check.reference.velocity
    assert np.max(np.abs(engine.run(scene(name).problem()).velocity - exact(name))) < stated < 5e-5


WITH_SCHEME = [name for name in CASES if name in COMPILED_ANEW or not CASES[name].keys() & {"damping", "drive", "push"}]


@pytest.mark.parametrize("name", marked(WITH_SCHEME))
def test_the_reference_with_the_scheme_of_lammps_is_lammps_to_rounding(name, done):
    problem = scene(name).problem()
    found = engine.run(problem, scheme=VERLET, steps_per_frame=problem.steps_per_frame)
    np.testing.assert_allclose(found.velocity, done(name).trajectory.velocity, rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("name", marked([*ELASTIC, *DAMPED]))
def test_energy_and_momentum_are_balanced(name, done):
    result = done(name)
    seen, problem = analyse(result.directory, figures=False).conservation, scene(name).problem()
    assert seen.energy_drift < 4.0 * result.check.velocity
    assert result.check.reference.energy < 1e-5
    assert seen.momentum_drift < 1e-12 if problem.system.holds(Fact.MOMENTUM) else np.isnan(seen.momentum_drift)


@pytest.mark.parametrize("name", marked(name for name in CASES if "damping" in CASES[name]))
def test_the_budget_of_the_reference_closes_to_1e_9_with_every_dashpot(name):
    # forces of linear contacts have a kink where they open, which leaves an error of second order
    steps = 800 if 1.0 in np.ravel(CASES[name].get("contact", {}).get("exponent", 1.5)) else 200
    problem = scene(name).problem()
    seen = ConservationMeter(problem).read(engine.blocks(problem, steps_per_frame=steps))
    assert seen.energy_drift < 1e-9


@pytest.mark.slow
@pytest.mark.parametrize("name", ["walls", "pressed", "resonators of two kinds, in some rows"])
def test_suzuki_s_composition_of_steps_agrees_with_the_exact_motion(name, tmp_path):
    assert error(run(scene(name, scheme="suzuki4"), tmp_path / "run", check=False), name) < 1e-4


@pytest.mark.parametrize("name", marked(RESUMED))
def test_a_run_that_was_interrupted_goes_on_bit_for_bit(name, tmp_path):
    goes_on_bit_for_bit(scene(name, duration=20.0), tmp_path, after=500)


@pytest.mark.parametrize("name", marked(RECORDED))
def test_recorded_beads_are_that_part_of_the_whole_bit_for_bit(name, done, tmp_path):
    some = run(scene(name, output={"every": 0.5, "beads": [3, 7]}), tmp_path / "some", check=False).trajectory
    whole = done(name).trajectory
    np.testing.assert_array_equal(some.velocity, whole.velocity[:, :, [2, 6]])
    np.testing.assert_array_equal(some.displacement, whole.displacement[:, :, [2, 6]])


@pytest.mark.slow
@pytest.mark.parametrize("name", ACROSS_RANKS)
def test_two_ranks_compute_the_same_bits(name, tmp_path):
    one, two = (run_deck(scene(name, timestep=0.05), tmp_path / str(ranks), ranks=ranks) for ranks in (1, 2))
    assert "2 by 1 by 1 MPI processor grid" in two.log
    assert "cutoff" not in "".join(line for line in two.log.splitlines() if "WARNING" in line)
    np.testing.assert_allclose(two.vx, one.vx, rtol=0.0, atol=1e-15 if name in BY_BOND else 0.0)


@pytest.mark.slow
@pytest.mark.parametrize("name", OLD)
def test_the_release_of_2021_computes_the_same(name, done, lmp_of, tmp_path):
    old = run_deck(scene(name), tmp_path / "old", executable=lmp_of("2021"))
    np.testing.assert_allclose(old.velocity, done(name).trajectory.velocity, rtol=0.0, atol=1e-11)


@pytest.mark.slow
def test_what_continues_from_a_restart_has_every_force_of_the_deck():
    for name in CASES:
        problem = scene(name).problem()
        forces = [line for line in deck.render_deck(problem).splitlines() if line.startswith(("fix", "bond", "pair"))]
        continued = continuation.render_continuation(problem).splitlines()
        left = ["fix start all store/state 0 vx vy"] if problem.system.start else []  # a restart has later velocities
        assert [line for line in forces if line not in continued] == [*left, "fix motion all nve"], name


def numbers(problem):
    """All of the physics of a problem."""
    system, found = problem.system, {"mass": problem.system.mass, "gap": physics.gap(problem.system)}
    found |= {"times": (problem.duration, problem.every, problem.timestep), "kicks": [v for *_, v in system.kicks]}
    found |= {"start": physics.initial_state(system)}
    found |= {f"load {n} ends": load.end for n, load in enumerate(system.loads)}
    for kind in ("links", "dampers", "loads"):
        for n, part in enumerate(getattr(system, kind)):
            values = part.law
            if hasattr(part.law, "derived"):  # a formula, which is scaled as a whole
                values = [laws.force(part.law, s) for s in (-0.1, 0.1, 0.3)]
            found |= {f"{kind} {n}, {parameter}": value for parameter, value in enumerate(values)}
    laws_in_time = [law for motion in system.motions for law in motion.laws]
    return found | {
        f"motion {n}, {part}": value for n, law in enumerate(laws_in_time) for part, value in enumerate(law)
    }


SLOWLY_READ = ("formula", "magnets", "bonded")
"""Beginnings of names of cases whose formulas are derived once more in every unit."""


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=[pytest.mark.slow] * name.startswith(SLOWLY_READ))
        for name in CASES
        if not name.startswith("exponents")
    ],
)
def test_a_scene_in_other_units_is_the_same_problem(name):
    own = numbers(scene(name).problem())
    for faster, material in ((4.0, None), (2.0, STEEL)):
        other = numbers(in_units(name, faster, material).problem())
        assert other.keys() == own.keys()
        for what, value in own.items():
            # slopes of tables lose digits of times, as many as a time is longer than its interval
            np.testing.assert_allclose(other[what], value, rtol=1e-11, atol=1e-15, err_msg=what)


LINEAR_TOO = [(name, {}, "wheel") for name in AT_REST] + [("pressed column of exponent 2", exponent(3.0), "wheel")]
LINEAR_TOO += [(name, {}, "2021") for name in ("pressed between walls", "graded column of exponent 1")]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "changes", "release"), LINEAR_TOO, ids=str)
def test_a_loaded_chain_that_is_not_kicked_stays_at_rest_to_the_last_bit(name, changes, release, lmp_of, tmp_path):
    case = scene(name, kick={"velocity": 1e-3, "chain": 2}, coupling=None, duration=5.0, **changes)
    found = run_deck(case, tmp_path / "run", executable=lmp_of(release))
    assert not np.any(found.displacement[:, 0])
    assert not np.any(found.velocity[:, 0])
    assert np.any(found.velocity[-1, 1])


EDITED = {
    "no strengths": (
        "random contacts",
        r"pair_coeff \d+ \d+ hertz .*\n",
        "",
        "the strength of the contacts differs from the scene's at 14 places, most of all: the contacts between beads 4 "
        "and 5 of chain 1 are 1.336 times as strong as the scene says",
    ),
    "no modulation": (
        "foundation rising, modulated",
        r"\(1\+0\.5\*sin",
        "(1+0*sin",
        "the change of the foundation in time is missing",
    ),
    "masses of resonators": (
        "resonators by chain, column, dimer",
        r"fix motion all nve",
        "group inner subtract all beads\nset group inner mass 0.22\nfix motion all nve",
        "the resonators are 1.1 times as heavy as the scene says",
    ),
    "drive": (
        "driven",
        r"(variable drive1[xv] equal )",
        r"\g<1>1.1*",
        "the amplitude of the drive of bead 1 of chain 1 is 1.1 times that of the scene",
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize(("name", "pattern", "new", "cause"), EDITED.values(), ids=EDITED)
def test_validate_names_what_in_a_deck_is_not_the_scene_s(name, pattern, new, cause, tmp_path):
    case = scene(name, duration=20.0, output={"every": 0.1})
    found = validate(deck_run(case, tmp_path / "run", substituted(pattern, new)))
    assert cause in without_uncertainties(found.causes)
