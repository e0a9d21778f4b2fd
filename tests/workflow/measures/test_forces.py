"""Forces as gauges read them: largest values, impulses, and how long contacts last."""

import math
from dataclasses import replace

import numpy as np
import pytest
from small_problems import problem, written_down
from synthetic_waves import of_keys

from analysis.files.traces import Channel
from analysis.gauges.channels import read, read_at
from analysis.gauges.gauge import gauges
from lammps_inputs import physics
from workflow.engines.reference import engine
from workflow.measures import forces
from workflow.measures.forces.force_meter import ForceMeter
from workflow.measures.forces.measurement import ForceMeasurement
from workflow.measures.forces.reflection import Reflection


def walled(**changes):
    plain = {"beads": 20, "walls": {"right": "bead"}, "kick": {"velocity": 1.0}, "duration": 50.0}
    given = {key: value for key, value in {**plain, **changes}.items() if value is not None}
    return of_keys(**given)


def readings_of(trajectory, *blocks, **places):
    meter = ForceMeter(trajectory.problem, gauges(trajectory.problem.system, **{"wall": True, **places}))
    return meter.read(blocks or (trajectory,))


@pytest.fixture(scope="module")
def found():
    return engine.run(walled(output={"every": 0.1}), steps_per_frame=100)


@pytest.mark.parametrize("walls", [{"right": "bead"}, {"left": "flat", "right": "rigid"}], ids=str)
def test_momentum_lost_is_the_impulse_of_the_walls(walls):
    one = walled(walls=walls, chains=2, coupling={"stiffness": 0.1}, output={"every": 0.01})
    trajectory = engine.run(one, steps_per_frame=10)
    readings = readings_of(trajectory)
    lost = 1.0 - trajectory.velocity[-1].sum()
    taken = sum(
        (1.0 if gauge.name == "right wall" else -1.0) * readings.impulse[:, place].sum()
        for place, gauge in enumerate(readings.gauges)
    )
    assert lost > 1.0
    assert taken == pytest.approx(lost, abs=1e-10)


def test_a_lone_bead_at_a_wall_has_the_exact_contact():
    """Largest force (5/4)**0.6, impulse 2, duration 2.9432752 times the largest overlap (5/4)**0.4."""
    last = walled(beads=2, kick={"bead": 2, "velocity": 1.0}, duration=6.0, output={"every": 0.02})
    readings = readings_of(engine.run(last, steps_per_frame=40))
    beta = 2.0 * math.sqrt(math.pi) * math.gamma(1.4) / math.gamma(0.9)
    assert readings.largest[0, 0] == pytest.approx(1.25**0.6, abs=1e-9)
    assert readings.at[0, 0] == pytest.approx(0.5 * beta * 1.25**0.4, abs=1e-5)
    assert readings.impulse[0, 0] == pytest.approx(2.0, abs=1e-9)
    assert readings.dwell[0, 0] == pytest.approx(beta * 1.25**0.4, abs=5e-6)  # closed from an overlap of 1e-6 on
    assert readings.contacts[0, 0] == 1


def impulses_by_momentum(trajectory, readings):
    """Impulse of each gauge but the left wall's that the momentum of the beads beyond it gives, [gauge], of all chains.

    The static forces of all contacts are in equilibrium, so that they cancel.
    """
    (_, velocity), mass = trajectory.atoms, physics.masses(trajectory.problem.system)
    gained = ((velocity[-1] - velocity[0]) * mass).sum(axis=0)
    at_wall = [gauge.name for gauge in readings.gauges].index("right wall")
    passed_on = readings.impulse[:, at_wall].sum()
    contact = [gained[n:].sum() + passed_on for n in range(trajectory.problem.beads)]
    return {
        "left wall": contact[0],
        **{gauge.name: contact[gauge.bead] for gauge in readings.gauges if gauge.kind == "contact"},
        **{
            gauge.name: 0.5 * (contact[gauge.bead - 1] + contact[gauge.bead])
            for gauge in readings.gauges
            if gauge.kind == "sensor"
        },
    }


RANGE_OF_LAWS = {
    "flat walls": {"walls": {"left": "flat", "right": "rigid"}},
    "Toda": {"contact": {"force": "A*(exp(b*s)-1)", "A": 1, "b": 1, "tension": "allowed"}},
    "kinked at rest": {"contact": {"force": "A*s*abs(s)", "A": 1, "tension": "allowed"}},
    "magnets": {"contact": {"force": "A/(d-s)^p", "A": 1, "d": 3, "p": 2}},
    "loaded power": {"precompression": {"force": 0.2}, "contact": {"exponent": 2}},
    "column": {"gravity": 0.02, "walls": {"right": "flat"}},
    "viscoelastic": {"damping": {"contact": 0.3, "law": "viscoelastic"}},
    "restitution": {"damping": {"contact": 0.7, "law": "restitution"}},
    "tension cut": {"damping": {"contact": 0.3, "tension": "cut"}},
    "loaded dashpots": {"precompression": {"force": 0.02}, "damping": {"contact": 0.3}},
    "resonators": {"resonators": {"mass": 0.3, "stiffness": 1.0}},
    "coupled": {"chains": 2, "coupling": {"stiffness": 0.1}},
}
"""Keys of scenes whose contacts only push, push and pull, touch or act at a distance."""


@pytest.mark.slow
@pytest.mark.parametrize("every", [0.05, 0.4])
@pytest.mark.parametrize("law", RANGE_OF_LAWS)
def test_impulses_of_every_law_are_the_momentum_beyond_them_within_their_uncertainties(law, every):
    """The reference integrator takes steps of 5e-4 T, whose error in the sum is below 1e-8."""
    walls = {"left": "bead", "right": "bead"}
    keys = {"beads": 6, "walls": walls, "duration": 20.0, "output": {"every": every}} | RANGE_OF_LAWS[law]
    trajectory = engine.run(walled(**keys), steps_per_frame=round(every / 5e-4))
    readings = readings_of(trajectory, contacts=(1, 2, 3, 4, 5), sensors=(3,))
    places = {gauge.name: place for place, gauge in enumerate(readings.gauges)}
    off = {name: readings.impulse_error[:, place].sum() for name, place in places.items()}
    for name, impulse in impulses_by_momentum(trajectory, readings).items():
        if name in places:
            bound = off[name] + off["right wall"] + 1e-8
            assert abs(readings.impulse[:, places[name]].sum() - impulse) <= bound


def test_the_bulk_force_is_the_solitary_waves():
    one = walled(beads=60, duration=50.0, walls={"right": "bead"})
    readings = readings_of(engine.run(one, steps_per_frame=100), contacts=(30,))
    assert readings.largest[0, 1] == pytest.approx(0.63955, abs=5e-6)


def test_a_wall_is_read_where_it_is_asked_for(found):
    places = [
        [gauge.name for gauge in forces.read(found.blocks(), found.problem, contacts=(3,), **asked).gauges]
        for asked in ({}, {"wall": True})
    ]
    assert places == [["contact 3"], ["right wall", "contact 3"]]


def test_the_largest_force_does_not_depend_on_where_frames_fall(found):
    fine = readings_of(found).largest[0, 0]
    for start in (0, 1, 2):
        coarse = found[start::3]
        assert readings_of(coarse).largest[0, 0] == pytest.approx(fine, abs=2e-7)


@pytest.mark.slow
def test_blocks_add_up_to_the_whole(found):
    whole = readings_of(found, contacts=(9,), sensors=(10,))
    parts = readings_of(found, found[:57], found[57:], contacts=(9,), sensors=(10,))
    for name in ("force", "largest", "impulse", "dwell", "contacts"):
        np.testing.assert_array_equal(getattr(whole, name), getattr(parts, name))


def test_under_a_load_walls_and_contacts_read_it_at_rest():
    loaded = walled(beads=8, precompression={"force": 0.5}, duration=2.0)
    readings = readings_of(written_down(loaded, lambda t: (0.0 * t, 0.0 * t)), contacts=(4,), sensors=(4,))
    np.testing.assert_allclose(readings.force, 0.5, rtol=1e-4)
    np.testing.assert_allclose(readings.static, 0.5, rtol=1e-4)
    np.testing.assert_allclose(readings.impulse, 0.0, atol=1e-15)


def pressed_by(size, until=20.0):
    """A loaded wall's reading where the force above the static one is size * sin(pi (t - 3) / 6)**2 from t = 3 to 9."""
    loaded = walled(beads=8, precompression={"force": 0.5}, duration=until)
    law = loaded.system.walls[0].law

    def motion(t):
        phase, inside = np.pi * (t - 3.0) / 6.0, (t > 3.0) & (t < 9.0)
        above = np.where(inside, size * np.sin(phase) ** 2, 0.0)
        rate = np.where(inside, size * np.pi / 6.0 * np.sin(2.0 * phase), 0.0)
        strength = np.max(law.strength)
        overlap = ((0.5 + above) / strength) ** (2.0 / 3.0)
        last = np.arange(8) == 7
        return last * (overlap - (0.5 / strength) ** (2.0 / 3.0)), last * (2.0 / 3.0 * rate / strength * overlap**-0.5)

    return readings_of(written_down(loaded, motion))


@pytest.mark.parametrize("size", [0.2, 20.0])
def test_under_a_load_the_dwell_is_that_above_it(size):
    readings = pressed_by(size)
    assert readings.largest[0, 0] == pytest.approx(0.5 + size, rel=1e-4)
    assert readings.dynamic[0, 0] == pytest.approx(size, rel=2e-4)
    assert readings.at[0, 0] == pytest.approx(6.0, abs=0.01)
    assert readings.dwell[0, 0] == pytest.approx(6.0 - 12.0 / np.pi * math.asin(0.1), abs=1e-3)
    assert readings.impulse[0, 0] == pytest.approx(3.0 * size, rel=1e-3)
    assert readings.ended[0, 0]
    assert readings.last[0, 0] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(("until", "last", "most"), [(7.0, 0.75, 1.0), (4.0, 1.0, 0.25)])
def test_a_dwell_is_so_far_where_the_record_ends_inside_the_pulse(until, last, most):
    """It begins at a hundredth of the largest force so far, which is that share of the pulse's."""
    readings = pressed_by(0.2, until)
    assert not readings.ended[0, 0]
    begins = 3.0 + 6.0 / np.pi * math.asin(0.1 * math.sqrt(most))
    assert readings.dwell[0, 0] == pytest.approx(until - begins, abs=1e-3)
    assert readings.last[0, 0] == pytest.approx(last, abs=0.01)
    lines = ForceMeasurement(
        walled(precompression={"force": 0.5}), readings.entries({"right": (None,)}), readings
    ).lines()
    assert any(f"the record ends (t = {until:g}) inside a pulse" in line for line in lines if isinstance(line, str))


def test_what_a_wall_reflects_is_told_with_its_uncertainty_and_the_beads_where_it_was_measured():
    readings, reflection = pressed_by(0.2), Reflection(0.9, 2e-3, (46, 55), (48, 39))
    entries = readings.entries({"right": (reflection,)})
    lines = ForceMeasurement(walled(precompression={"force": 0.5}), entries, readings).lines()
    told = "right wall reflects the first pulse with 0.9000 +- 0.002 of its peak velocity (incident: beads 46 to 55"
    assert any(f"{told}, reflected: 48 to 39," in line for line in lines if isinstance(line, str))


def test_a_force_that_never_exceeds_the_static_one_has_no_largest_dynamic_value():
    readings = pressed_by(-0.2)
    assert readings.largest[0, 0] == pytest.approx(0.5, rel=1e-9)
    assert np.isnan([readings.at[0, 0], readings.dynamic[0, 0], readings.last[0, 0]]).all()
    assert readings.impulse[0, 0] == pytest.approx(-0.6, rel=1e-3)


def struck(*blows):
    """Readings of two beads that overlap from a time on, for a time, by a length at most, in each blow."""
    small = problem(chains=1, recorded=(1, 2))

    def motion(t):
        overlap, rate = 0.0 * t, 0.0 * t
        for start, length, most in blows:
            turn, inside = math.pi * (t - start) / length, (t > start) & (t < start + length)
            overlap = overlap + inside * most * np.sin(turn) ** 2
            rate = rate + inside * most * math.pi / length * np.sin(2.0 * turn)
        first = np.array([1.0, 0.0])  # bead 1 moves, bead 2 does not
        return first * overlap, first * rate

    return readings_of(written_down(small, motion), wall=False, contacts=(1,))


def test_the_dwell_is_that_of_the_hardest_contact():
    readings = struck((1.0, 1.0, 0.1), (4.0, 3.0, 0.5), (8.0, 1.0, 0.2))
    assert readings.contacts[0, 0] == 3
    assert readings.largest[0, 0] == pytest.approx(0.5**1.5, rel=1e-4)
    assert readings.at[0, 0] == pytest.approx(5.5, abs=0.01)
    assert readings.dwell[0, 0] == pytest.approx(3.0, abs=0.02)


def test_a_dwell_is_known_where_two_contacts_that_last_as_long_are_as_hard():
    """Which of them is harder decides rounding; a weak one in between does not count."""
    readings = struck((1.0, 3.0, 0.5), (5.0, 0.5, 0.1), (6.0, 3.03, 0.5))
    assert readings.at_error[0, 0] > 4.0
    assert readings.dwell[0, 0] == pytest.approx(3.0, abs=0.04)
    assert 0.02 < readings.dwell_error[0, 0] < 0.06


def test_a_dwell_is_withheld_where_two_contacts_are_as_hard_and_last_otherwise():
    assert np.isnan(struck((1.0, 3.0, 0.5), (6.0, 2.0, 0.5)).dwell[0, 0])


@pytest.mark.parametrize("g", [0.2, 1.0])
def test_a_damped_contact_is_read_with_its_dashpot(g):
    """Two beads, linear: s = exp(-g t) sin(w t) / w with w**2 = 2 - g**2, and the force s + g s' jumps to g at once."""
    keys = {"beads": 2, "walls": None, "contact": {"exponent": 1}, "damping": {"contact": g}, "duration": 6.0}
    both = walled(**keys, output={"every": 0.02})
    omega = math.sqrt(2.0 - g * g)
    over = math.pi / omega
    share = math.exp(-g * over)

    def motion(time):
        inside, after = np.minimum(time, over), np.maximum(time - over, 0.0)
        fall = np.exp(-g * inside)
        s = fall * np.sin(omega * inside) / omega - share * after
        rate = np.where(after > 0.0, -share, fall * (np.cos(omega * inside) - g / omega * np.sin(omega * inside)))
        return 0.5 * (time + s * np.array([1.0, -1.0])), 0.5 * (1.0 + rate * np.array([1.0, -1.0]))

    exact = written_down(both, motion)
    time = np.linspace(1e-9, over, 100001)
    fall = np.exp(-g * time)
    force = fall * (np.sin(omega * time) / omega + g * (np.cos(omega * time) - g / omega * np.sin(omega * time)))
    readings = readings_of(exact, wall=False, contacts=(1,))
    assert readings.largest[0, 0] == pytest.approx(force.max(), abs=1e-4)
    assert readings.at[0, 0] == pytest.approx(time[np.argmax(force)], abs=0.01)
    assert readings.force.min() == pytest.approx(force.min(), abs=0.02 * g)  # it pulls, last of all hardest
    assert readings.impulse[0, 0] == pytest.approx(0.5 * (1.0 + share), abs=1e-4)
    assert readings.dwell[0, 0] == pytest.approx(over, abs=1e-4)
    assert readings.contacts[0, 0] == 1


@pytest.mark.slow
def test_the_largest_force_of_a_sensor_may_be_the_jump_of_one_contact_while_the_other_is_closed():
    """Bead 2 reaches bead 3 while bead 1 presses on it; the dashpot's force falls from its largest at once."""
    kicks = [{"bead": 1, "velocity": 1.0}, {"bead": 2, "velocity": 0.9}]
    keys = {"beads": 3, "walls": None, "gap": [0.0, 0.16], "damping": {"contact": 2.0}, "kick": kicks, "duration": 3.0}
    fine = engine.run(walled(**keys, output={"every": 0.001}))
    close, far = (
        readings_of(replace(fine[::stride], problem=fine.problem.coarser(stride)), wall=False, sensors=(2,))
        for stride in (1, 50)
    )
    assert np.max(np.diff(close.force[:, 0, 0])) > 0.9  # it jumps
    assert 1e-3 < abs(far.largest - close.largest)[0, 0] < far.largest_error[0, 0] < 1e-2


def test_beads_at_rest_are_read_as_no_force():
    still = problem(kappa=0.0)
    trajectory = written_down(still, lambda t: (0.0 * t, 0.0 * t))
    readings = readings_of(trajectory, wall=False, contacts=(3,))
    assert not readings.force.any()
    assert readings.impulse.tolist() == readings.largest.tolist() == readings.dwell.tolist() == [[0.0], [0.0]]
    assert np.isnan(readings.at).all()


# --- traces as they would have been measured --------------------------------------------------------------------------


PROBLEM = walled(chains=2, beads=8, walls={"right": "flat"}, precompression={"force": 0.3}, duration=5.0)


def test_a_dynamic_force_is_that_above_rest_and_nothing_is_before_the_start():
    channels = tuple(
        Channel(kind, 1, 4, dynamic=dynamic) for kind in ("contact", "sensor") for dynamic in (False, True)
    )
    channels += tuple(Channel("wall", 1, right=True, dynamic=dynamic) for dynamic in (False, True))
    rest = written_down(PROBLEM, lambda t: (0.0 * t, 0.0 * t))
    np.testing.assert_allclose(read(rest, channels), [[0.3, 0.0] * 3] * rest.frames, rtol=1e-9, atol=1e-12)
    before, after = read_at(rest, channels, np.array([-0.5, 1.23]))
    assert not np.any(before)
    np.testing.assert_allclose(after, [0.3, 0.0] * 3, rtol=1e-9, atol=1e-12)
