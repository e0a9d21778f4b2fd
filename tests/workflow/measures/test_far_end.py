"""What arrives at the far end, against what is known of it."""

import math
from dataclasses import replace

import numpy as np
import pytest
from small_problems import problem, written_down
from synthetic_waves import of_keys

from analysis import motion
from analysis.gauges.gauge import at_frames, far_wall
from analysis.sharing.run_error import MeasuredError
from workflow.engines.reference import engine
from workflow.measures.far_end import VALUES, FarEndMeter, with_error


def far_end(run):
    return FarEndMeter(run.problem).read([run])


@pytest.mark.parametrize(("hit", "velocity", "end"), [(1, 1.0, slice(18, 20)), (20, -1.0, slice(0, 2))])
@pytest.mark.parametrize("exponent", [1.5, 2.0])
def test_frames_far_apart_say_what_energy_passes_the_last_tenth_and_when(hit, velocity, end, exponent):
    """Frames 0.5 apart, four in the passage of a pulse, against frames 0.01 apart."""
    plain = {"beads": 20, "contact": {"exponent": exponent}, "duration": 40.0, "timestep": 0.01}
    fine, coarse = (
        of_keys(**plain, kick={"bead": hit, "velocity": velocity}, output={"every": every}) for every in (0.01, 0.5)
    )
    run = engine.run(fine)
    there = motion.bead_energy(fine.system, run.displacement[..., end], run.velocity[..., end], end.start + 1)
    share = there.sum(axis=(1, 2)) / 0.5  # of the kick
    trajectory = engine.run(coarse)
    found = FarEndMeter(coarse).read((trajectory[:37], trajectory[37:]))
    rising = slice(0, int(np.argmax(share)))
    assert found.transmitted_energy == pytest.approx(share.max(), rel=1e-4)
    assert found.delay == pytest.approx(np.interp(0.5 * share.max(), share[rising], run.time[rising]), abs=5e-4)
    assert math.isnan(found.wall_force)


@pytest.mark.slow
@pytest.mark.parametrize(("side", "velocity", "bead"), [("right", 1.0, 6), ("left", -1.0, 1)])
def test_the_far_wall_is_the_one_that_the_blow_goes_to_and_feels_all_chains(side, velocity, bead):
    """Two chains; frames 0.5 apart, five in a pulse, say what frames 0.01 apart show."""
    kicks = [{"chain": n, "bead": 7 - bead, "velocity": part * velocity} for n, part in ((1, 1.0), (2, 0.9))]
    plain = {"chains": 2, "beads": 6, "walls": {side: "rigid"}, "kick": kicks, "duration": 10.0}
    fine, coarse = (of_keys(**{**plain, "timestep": 0.01, "output": {"every": every}}) for every in (0.01, 0.5))
    run, found = engine.run(fine), far_end(engine.run(coarse))
    force = at_frames(run, (far_wall(fine.system),))[..., 0]
    assert found.wall_force == pytest.approx(force.sum(axis=1).max(), rel=1e-3)
    assert found.wall_force_chain == pytest.approx(force.max(), rel=1e-3)
    assert found.delay == pytest.approx(run.time[force.sum(axis=1).argmax()], abs=0.02)


@pytest.mark.slow
@pytest.mark.parametrize("wall", [{}, {"walls": {"right": "bead"}}], ids=["free end", "wall"])
@pytest.mark.parametrize("load", [{}, {"precompression": {"force": 0.5}}], ids=["no load", "static load"])
def test_a_record_that_ends_before_or_inside_the_pulse_has_no_largest_value_of_it(wall, load):
    plain = {"chains": 1, "beads": 20, "kick": {"velocity": 1.0}, "duration": 40.0}
    small = of_keys(**plain, **wall, **load)
    run = engine.run(small)

    def of(frames):
        return {name: getattr(far_end(run[:frames]), name) for name in VALUES}

    final = of(run.frames)
    names = {"delay", "transmitted_energy"} | ({"wall_force", "wall_force_chain"} if wall else set())
    assert {name for name, value in final.items() if math.isfinite(value)} == names
    begins = np.flatnonzero(run.time >= final["delay"])[0]
    for frames in range(2, begins + 40, 3):
        for name, value in of(frames).items():
            assert math.isnan(value) or value == pytest.approx(final[name], rel=5e-3), (frames, name)
    assert all(math.isnan(value) for value in of(int(0.9 * begins)).values())


def test_energy_at_a_free_end_is_known_when_it_has_been_level_for_as_long_as_it_rose_from_a_quarter_to_half():
    small = of_keys(beads=20, kick={"velocity": 1.0}, duration=40.0, output={"every": 0.05})
    run = engine.run(small)
    there = motion.bead_energy(small.system, run.displacement[..., 18:], run.velocity[..., 18:], 19).sum(axis=(1, 2))
    quarter, half, level = (np.interp(share * there[-1], there, run.time) for share in (0.25, 0.5, 0.999))
    known = level + half - quarter
    seen = [far_end(run[run.time < until]).transmitted_energy for until in (known - 0.2, known + 0.2)]
    assert [math.isfinite(value) for value in seen] == [False, True]


def test_what_is_at_the_far_end_from_the_start_has_not_arrived_there():
    found = far_end(engine.run(problem(beads=20, chains=1, kicks=((1, 19, 1.0),))))
    assert all(math.isnan(getattr(found, name)) and math.isnan(getattr(found, f"{name}_error")) for name in VALUES)


@pytest.mark.parametrize("stride", [5, 10])
@pytest.mark.parametrize("wall", [{}, {"walls": {"right": "bead"}}], ids=["free end", "wall"])
def test_what_has_arrived_is_off_by_no_more_than_its_uncertainty_which_covers_the_run(wall, stride):
    """Frames 0.25 or 0.5 T apart against those 0.05 T apart."""
    plain = {"chains": 2, "beads": 20, "coupling": {"stiffness": 0.2}, "kick": {"velocity": 1.0}, "duration": 45.0}
    run = engine.run(of_keys(**plain, **wall, output={"every": 0.05}))
    exact, found = far_end(run), far_end(replace(run[::stride], problem=run.problem.coarser(stride)))
    error = MeasuredError(velocity=1e-4, amplitude=1e-5, arrival=1e-3, measured=True)
    total = with_error(found, error, run.problem)
    for name in VALUES if wall else VALUES[2:]:
        uncertainty = getattr(found, f"{name}_error")
        assert abs(getattr(found, name) - getattr(exact, name)) <= uncertainty < 0.1 * getattr(found, name)
        assert getattr(total, f"{name}_error") > uncertainty
    assert total.delay_error == pytest.approx(found.delay_error + 1e-3)


@pytest.mark.parametrize(("moved", "felt"), [(-0.1, False), (1e-11, False), (1e-7, True)])
def test_the_force_of_a_loaded_wall_is_defined_where_it_exceeds_the_load_and_not_by_rounding(moved, felt):
    """The last bead goes from or into the wall and comes back to where it was."""
    plain = {"chains": 1, "beads": 20, "walls": {"right": "bead"}, "precompression": {"force": 0.5}}
    small = of_keys(**plain, kick={"velocity": 1.0}, duration=10.0)

    def motion(time):
        x, v = np.zeros((2, time.shape[0], 1, 20))
        x[:, :, 19] = moved * np.sin(math.pi * time[..., 0] / 10.0) ** 2
        v[:, :, 19] = moved * math.pi / 10.0 * np.sin(math.pi * time[..., 0] / 5.0)
        return x, v

    found = far_end(written_down(small, motion))
    assert [math.isfinite(getattr(found, name)) for name in ("wall_force", "wall_force_chain", "delay")] == 3 * [felt]
    assert found.delay == pytest.approx(5.0 if felt else math.nan, abs=1e-3, nan_ok=True)


PUSH = {"push": {"peak": 0.5, "duration": 3.0, "shape": "half-sine"}}
FORCE = {"drive": {"force": 0.5, "frequency": 0.05}}
MOVED = {"drive": {"displacement": 0.5, "frequency": 0.05, "phase": -90.0}}


@pytest.mark.slow
@pytest.mark.parametrize("bead", [3, 4])
@pytest.mark.parametrize("acting", [PUSH, MOVED])
def test_where_energy_is_input_none_is_transmitted(bead, acting):
    ((name, how),) = acting.items()
    plain = {"beads": 4, "duration": 30.0, name: {**how, "bead": bead}}
    found = far_end(engine.run(of_keys(**plain)))
    assert [math.isnan(value) for value in (found.delay, found.transmitted_energy)] == 2 * [bead == 4]


@pytest.mark.slow
@pytest.mark.parametrize("set_in_motion", [PUSH, FORCE, MOVED], ids=["push", "force", "displacement"])
def test_transmitted_energy_is_a_share_of_the_work_done_until_then(set_in_motion):
    """Nothing is lost, so that the energy of all beads is that work."""
    small = of_keys(beads=30, duration=70.0, **set_in_motion)
    run = engine.run(small)
    there = motion.bead_energy(small.system, run.displacement, run.velocity)[:, 0, 27:].sum(axis=-1)
    work = motion.energy(small.system, run.displacement, run.velocity)
    assert far_end(run).transmitted_energy == pytest.approx(np.nanmax(there[1:] / work[1:]), rel=1e-4)
    assert math.isnan(far_end(replace(run, exchange=None)).transmitted_energy)


def test_the_largest_force_of_a_chain_is_undefined_where_the_record_ends_inside_its_pulse():
    """Chain 2 has given the wall its weak pulse when that of chain 1 is rising beyond it."""
    kicks = [{"chain": 1, "bead": 1, "velocity": 1.0}, {"chain": 2, "bead": 6, "velocity": 0.3}]
    plain = {"chains": 2, "beads": 6, "walls": {"right": "rigid"}, "kick": kicks, "timestep": 0.01}
    whole, cut = (engine.run(of_keys(**plain, duration=end, output={"every": 0.1})) for end in (12.0, 7.0))
    force = at_frames(cut, (far_wall(cut.problem.system),))[..., 0]
    assert force[:, 1].max() < force[-1, 0] < far_end(whole).wall_force_chain
    assert math.isnan(far_end(cut).wall_force_chain)


def test_energy_that_passes_contacts_that_yield_is_found_between_frames():
    """Frames 0.25 apart against frames 0.01 apart."""
    plain = {"chains": 1, "beads": 10, "contact": {"yield": {"overlap": 0.15}}, "kick": {"velocity": 1.0}}
    plain |= {"duration": 20.0, "timestep": 0.01}
    fine, coarse = (far_end(engine.run(of_keys(**plain, output={"every": every}))) for every in (0.01, 0.25))
    assert coarse.transmitted_energy == pytest.approx(fine.transmitted_energy, rel=1e-3)
