"""Runs of rigid beads against runs of elastic ones: impulses of the first contacts and the energy of each chain."""

import math

import numpy as np
import pytest
from stock_lammps import scene

from analysis.sharing.energies import FlowMeter
from analysis.sharing.impulses import measure
from lammps_inputs import Kick, find
from workflow.cli import main
from workflow.plugins.rigid import events
from workflow.plugins.rigid.events import EVENTS, from_events
from workflow.runs.run import run
from workflow.verdicts.validate_run import validate_run

pytestmark = pytest.mark.usefixtures("lammps_here")

THETA_OF_WEAK_SPRINGS, WEAK = 1e-2, 1e-6
"""Contacts are short against the oscillation of the rows: the gap is theta / sqrt(2 kappa)."""


def small(**changes):
    return scene(**{"chains": 2, "beads": 14, "kappa": 0.1, "gap": 0.5, "duration": 40.0, **changes})


def both(case, path):
    """Runs of rigid and of elastic beads."""
    rigid = run(case, path / "rigid", engine="collisions").directory
    return rigid, run(case, path / "elastic", check=False).directory


@pytest.fixture(scope="module")
def pair(tmp_path_factory):
    return both(small(), tmp_path_factory.mktemp("pair"))


def first_impulses(rigid, elastic):
    """Of rigid and of elastic beads, [chain, row]."""
    collisions = events.from_csv(rigid.path / EVENTS, rigid.problem.scale)
    return from_events(rigid.problem, collisions), measure(elastic.problem, elastic.blocks())


@pytest.mark.slow
def test_the_differences_of_each_chain_are_those_of_the_impulses_and_of_the_energy_over_time(pair):
    rigid, elastic = pair
    validation = validate_run(elastic, rigid)
    collisions, contacts = first_impulses(*pair)
    rows = slice(0, 14 - 5 - 1)  # to bead 9, five before the end; in all of them both models pass something on
    apart = np.abs(collisions.first - contacts.first)[:, rows] / contacts.first[:, rows].max(axis=0)
    flows = [FlowMeter(run.problem).read(run.blocks()) for run in pair]
    shares = np.abs(flows[0].share - flows[1].share)
    for chain, difference in enumerate(validation.runs.chains):
        assert difference.chain == chain + 1
        assert difference.impulse.largest == apart[chain].max()
        assert difference.impulse.rms == pytest.approx(np.sqrt(np.mean(apart[chain] ** 2)), rel=1e-12)
        agreeing = np.flatnonzero(apart[chain] > 0.1)[0]
        assert difference.agrees_until == (None if agreeing == 0 else collisions.bead[agreeing - 1])
        assert difference.share.largest == shares[:, chain].max()
        assert difference.share.rms == pytest.approx(np.sqrt(np.mean(shares[:, chain] ** 2)), rel=1e-12)
    assert validation.deviations["impulse"].largest == apart.max()
    chain, row = np.unravel_index(np.argmax(apart), apart.shape)
    where = validation.deviations["impulse"].where
    assert (where.chain, where.bead) == (chain + 1, collisions.bead[row])
    assert validation.deviations["share"].largest == shares.max()
    other_way = validate_run(rigid, elastic)
    assert other_way.runs.chains == validation.runs.chains
    assert other_way.deviations["impulse"] == validation.deviations["impulse"]
    assert not any((validation.passed, other_way.passed))


def test_the_table_has_a_line_for_each_chain_and_velocities_have_no_tolerance(pair, capsys, golden):
    rigid, elastic = pair
    assert main(["validate", str(elastic.path), "--against", str(rigid.path)]) == 1
    out = capsys.readouterr().out
    tables = out[out.index("    quantity ") : out.index("settings and versions")]
    golden("validate", tables, {r"((?:energy|momentum) +)\S+": r"\1ROUNDING"})


def test_tolerances_are_as_given(pair):
    rigid, elastic = pair
    loose = {"impulse": 2.0, "share": 1.0}
    validation = validate_run(elastic, rigid, loose)
    assert validation.passed
    assert [chain.agrees_until for chain in validation.runs.chains] == [9, 9]
    assert not validate_run(elastic, rigid, {**loose, "velocity": 1e-3}).passed


@pytest.mark.parametrize(("beads", "last"), [(10, 10), (11, 6)])
def test_the_five_beads_that_fly_off_are_left_out_of_chains_of_more_than_ten(beads, last, tmp_path):
    rigid, elastic = both(small(beads=beads), tmp_path)
    chains = validate_run(elastic, rigid, {"impulse": 2.0, "share": 1.0}).runs.chains
    assert [chain.agrees_until for chain in chains] == [last, last]


@pytest.mark.slow
def test_where_contacts_are_short_against_oscillations_rigid_beads_agree(tmp_path):
    gap = THETA_OF_WEAK_SPRINGS / math.sqrt(2.0 * WEAK)
    rigid, elastic = both(small(gap=gap, kappa=WEAK, duration=140.0, every=0.5), tmp_path)
    validation = validate_run(rigid, elastic)
    assert validation.deviations["impulse"].largest < 0.1
    assert [chain.agrees_until for chain in validation.runs.chains] == [9, 9]


@pytest.mark.slow
def test_a_pulse_towards_bead_1_has_the_same_differences_up_to_the_mirrored_bead(pair, tmp_path):
    kick = (Kick(bead=14, velocity=-1.0),)
    mirrored = validate_run(*both(small(kick=kick), tmp_path)).runs.chains
    for chain, other in zip(mirrored, validate_run(*pair).runs.chains, strict=True):
        assert chain.impulse.largest == pytest.approx(other.impulse.largest, abs=1e-6)
        assert chain.share.largest == pytest.approx(other.share.largest, abs=1e-6)
        assert chain.agrees_until == (None if other.agrees_until is None else 15 - other.agrees_until)


def test_neighbours_that_both_recorded_have_impulses_and_no_share(pair, tmp_path):
    few = run(small(recorded=(3, 4, 8)), tmp_path / "few", check=False).directory
    validation = validate_run(few, pair[0])
    collisions, contacts = first_impulses(*pair)
    row = collisions.row(4)
    apart = np.abs(collisions.first - contacts.first)[:, row] / contacts.first[:, row].max()
    # fewer neighbours were recorded, so overlaps between frames follow polynomials of a lower degree
    assert [chain.impulse.largest for chain in validation.runs.chains] == pytest.approx(apart, abs=1e-4)
    assert "share" not in validation.deviations
    assert math.isnan(validation.runs.chains[0].share.largest)


@pytest.mark.slow
def test_in_the_papers_gapped_array_lammps_has_the_published_impulses_and_rigid_beads_do_not_share_the_pulse(tmp_path):
    rigid, elastic = both(find("two-chains-gapped"), tmp_path)
    collisions, contacts = first_impulses(rigid, elastic)
    for bead, published in ((5, (0.342, 0.724)), (25, (0.569, 0.487)), (100, (0.527, 0.527))):
        np.testing.assert_allclose(contacts.first[:, contacts.row(bead)], published, rtol=0, atol=5e-4)
    assert contacts.imbalance < 2e-5
    assert collisions.first[:, 0].max() == pytest.approx(0.5, abs=1e-14)  # bead 2 of chain 1, with V / 2 by eq. 5
    rows = slice(contacts.row(20), contacts.row(30) + 1)
    apart = [
        np.abs(first[0] - first[1])[rows] / first.mean(axis=0)[rows] for first in (collisions.first, contacts.first)
    ]
    assert apart[0].min() > 0.5
    assert apart[1].max() < 0.25
    assert [chain.agrees_until for chain in validate_run(rigid, elastic).runs.chains] == [None, None]
