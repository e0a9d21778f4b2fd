"""Values from bead to bead: exactly those of NumPy's generators, of the ramps and of the problem that is computed."""

import csv
import io
import json

import numpy as np
import pytest
from ingredient_scenes import STEEL
from plain_scene import BEADS, scene

from lammps_inputs import strict_yaml, values
from workflow.cli import main

SHAPE = (2, BEADS)


def table(**keys):
    return {column.name: column.values for column in values.columns(scene(**keys))}


def uniform(seed, count):
    return np.random.default_rng(seed).random((2, count))


def test_disorder_draws_the_numbers_that_the_manual_says():
    spread = {"mass": 0.2, "radius": 0.1, "stiffness": 0.3}
    factors = {
        key: 1.0 + spread[key] * (2.0 * uniform([7, i], BEADS) - 1.0)
        for i, key in enumerate(("mass", "radius", "stiffness"))
    }
    listed = table(disorder={**spread, "seed": 7})
    radius = factors["radius"]
    np.testing.assert_array_equal(listed["radius"], radius)
    np.testing.assert_array_equal(listed["mass"], radius * radius * radius * factors["mass"])
    np.testing.assert_array_equal(listed["plane_modulus"], factors["stiffness"])


@pytest.mark.parametrize("seed", [1, 2**62 + 3])
def test_random_contacts_draw_the_numbers_that_the_manual_says(seed):
    listed = table(contact={"strength": {"spread": 0.3, "seed": seed}})["contacts.strength"]
    strength = np.random.default_rng(seed).uniform(1.0 - 0.3, 1.0 + 0.3, (2, BEADS - 1))
    np.testing.assert_array_equal(listed[:, :-1], strength)
    assert np.isnan(listed[:, -1]).all()


def test_the_contact_that_closes_a_ring_is_listed_behind_its_last_bead():
    kinds = {"big": {}, "small": {"mass": 0.5, "stiffness": 2.0}}
    listed = table(periodic=True, kinds=kinds, pattern=["big", "big", "small"])
    strength = listed["contacts.strength"][0]
    assert np.isfinite(strength).all()
    # of beads 11 and 12, and of bead 12 and bead 1: both between a small and a big one
    assert strength[-1] == strength[-2] != strength[0] == 1.0


def test_ramps_of_springs_and_contacts_are_listed_in_the_scene_s_units():
    ramp = {"from": 1e3, "to": 4e3, "rows": [3, 9]}
    listed = table(
        material=STEEL,
        kick={"velocity": 0.1},
        duration=1e-3,
        output=None,
        foundation={"stiffness": ramp},
        coupling={"stiffness": {**ramp, "from": 0.0}},
        contact={"strength": {"from": 1, "to": 4, "contacts": [2, 6]}},
    )
    rows = np.arange(1, BEADS + 1)
    exact = np.interp(rows, [3, 9], [1e3, 4e3])
    np.testing.assert_allclose(listed["foundation.spring (N/m)"], [exact, exact], rtol=1e-12)
    coupling = listed["coupling.spring to the next chain (N/m)"]
    np.testing.assert_allclose(coupling[0], np.interp(rows, [3, 9], [0.0, 4e3]), rtol=1e-12)
    assert np.isnan(coupling[1]).all()
    np.testing.assert_array_equal(listed["contacts.strength"][0, :-1], np.interp(rows[:-1], [2, 6], [1, 4]))


def test_show_prints_values_that_read_back_exactly_and_nothing_else(tmp_path, capsys):
    path = tmp_path / "scene.yaml"
    path.write_text(strict_yaml.dump(scene(disorder={"mass": 0.2}).plain()))
    assert main(["show", str(path), "--values"]) == 0
    lines = list(csv.reader(io.StringIO(capsys.readouterr().out)))
    assert lines[0] == ["chain", "bead", "mass"]
    printed = np.array(lines[1:], dtype=np.float64)
    assert printed[:, :2].tolist() == [[chain, bead] for chain in (1, 2) for bead in range(1, BEADS + 1)]
    np.testing.assert_array_equal(printed[:, 2].reshape(SHAPE), scene(disorder={"mass": 0.2}).system.mass)
    assert main(["show", str(path), "--values", "--json"]) == 0
    assert np.array_equal(json.loads(capsys.readouterr().out)["mass"], printed[:, 2].reshape(SHAPE))
