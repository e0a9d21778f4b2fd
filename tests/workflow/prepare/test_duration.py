"""Where a scene ends that ends at a bead: after the pulse, and where beads have a gap, after a swing more."""

import math

import numpy as np
import pytest
from stock_lammps import scene

from analysis.gauges.gauge import PULSE, far_wall
from lammps_inputs import library
from workflow.engines.reference import engine
from workflow.measures.forces.force_meter import ForceMeter
from workflow.prepare.duration import with_duration

AFTER = 6.0


@pytest.mark.parametrize(
    ("changes", "more"),
    [({"chains": 1}, 0.0), ({"chains": 2, "kappa": 0.3, "gap": 0.3}, 2.0 * math.pi / math.sqrt(2.0 * 0.3))],
    ids=["one chain", "two with a gap"],
)
def test_a_scene_ends_6_t_after_the_last_chain_s_peak_and_with_a_gap_a_period_of_its_slowest_swing_later(changes, more):
    ended = with_duration(scene(beads=30, duration=None, until_bead=20, **changes))
    found = engine.run(ended.problem())
    speed = np.abs(found.velocity[:, :, 19])
    largest = np.maximum.accumulate(speed, axis=0)
    passed = np.maximum.accumulate((largest > 1e-3) & (speed <= 0.5 * largest), axis=0).all(axis=1)
    last = found.time[int(np.argmax(passed))]
    assert ended.duration == pytest.approx(last + AFTER + more, abs=0.1001)
    if not more:
        assert speed[-1, 0] < 1e-5


@pytest.mark.slow
def test_a_pulse_may_begin_late():
    """Such as one from a recorded force; 130 T are what a pulse may take at most to bead 3."""
    late = {"table": [[200.0, 0.0], [201.0, 1.0], [202.0, 0.0]]}
    plain = {"name": "late", "beads": 5, "push": late, "until_bead": 3}
    assert with_duration(library.from_plain(plain, "late")).duration == pytest.approx(200.0 + 11.5, abs=2.0)


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"until_bead": 5},
        {"precompression": {"force": 0.5}},
        {"chains": 2, "coupling": {"stiffness": 0.1}},
        {"kick": {"bead": 20, "velocity": -1.0}, "walls": {"left": "bead", "right": "bead"}, "until_bead": 1},
    ],
    ids=str,
)
def test_where_the_force_on_walls_is_read_the_end_waits_for_the_pulse_at_the_far_wall(changes):
    plain = {"name": "a", "chains": 1, "beads": 20, "walls": {"right": "bead"}, "kick": {"velocity": 1.0}}
    plain |= {"until_bead": 20, "output": {"forces": {"wall": True}}, **changes}
    problem = with_duration(library.from_plain(plain, "a")).problem()
    meter = ForceMeter(problem, (far_wall(problem.system),))
    found = meter.read([engine.run(problem)])
    for chain in range(problem.chains):
        above = found.force[:, chain, 0] - found.static[chain, 0]
        released = (found.time > found.at[chain, 0]) & (above <= PULSE * found.dynamic[chain, 0])
        assert found.time[released].min() < problem.duration - AFTER + 0.2
