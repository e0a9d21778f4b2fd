"""The engines side by side: what stands in compare.json, and what is said about it."""

import json
import math

import numpy as np
import pytest
from stock_lammps import scene

from lammps_inputs import file_names
from workflow.cli import main
from workflow.formats import figure_files
from workflow.prepare.settings import DEFAULT_ACCURACY
from workflow.runs.run_directory import RunDirectory
from workflow.studies.compare.study import compare

pytestmark = pytest.mark.usefixtures("lammps_here")


@pytest.fixture(scope="module", params=[pytest.param("two-chains-gapped", marks=pytest.mark.slow)])
def found(tmp_path_factory, request):
    path = tmp_path_factory.mktemp("compare") / "gapped"
    assert main(["compare", request.param, "-o", str(path)]) == 0
    return path, json.loads((path / "compare.json").read_text())


@pytest.fixture(autouse=True)
def _undrawn(monkeypatch):
    """Only `found`, which is made before, has a figure; the files of others are empty."""

    def touch(directory, name, _):
        for file in figure_files(name):
            (directory / file).touch()

    monkeypatch.setattr("workflow.studies.study.write_figure", touch)


def small(**changes):
    return scene(**{"chains": 2, "beads": 14, "kappa": 0.1, "gap": 0.5, "duration": 40.0, **changes})


@pytest.mark.parametrize("engine", ["reference", "lammps"])
@pytest.mark.parametrize(("bead", "published"), [(5, (0.342, 0.724)), (25, (0.569, 0.487)), (100, (0.527, 0.527))])
def test_hertz_beads_have_the_published_impulses(engine, bead, published, found):
    data = found[1]
    first = np.array(data["engines"][engine]["first_impulse"])[:, data["beads"].index(bead)]
    np.testing.assert_allclose(first, published, rtol=0, atol=5e-4)


def test_rigid_beads_do_not_share_the_pulse_and_hertz_beads_do(found):
    data = found[1]
    rows = [data["beads"].index(bead) for bead in range(20, 31)]
    apart = {}
    for engine, result in data["engines"].items():
        first = np.array(result["first_impulse"])[:, rows]
        apart[engine] = np.abs(first[0] - first[1]) / first.mean(axis=0)
    assert apart["collisions"].min() > 0.5
    assert apart["reference"].max() < 0.25


@pytest.mark.parametrize("engine", ["collisions", "reference", "lammps"])
def test_the_shares_of_the_energy_are_a_whole(engine, found):
    share = found[1]["engines"][engine]["energy_share"]
    assert len(share) == 3
    assert sum(share) == pytest.approx(1.0, abs=1e-12)


def test_impulses_and_momentum_balance_in_every_engine(found):
    for result in found[1]["engines"].values():
        assert result["imbalance"] < 2e-5


def test_the_struck_bead_of_rigid_beads_has_its_velocity_as_peak(found):
    data = found[1]
    rigid = data["engines"]["collisions"]
    # chain 1's bead 2 is struck with V/2, by eq. 5, and then only pulled back
    assert data["shown"][0] == 2
    assert rigid["peak"][0][0] == pytest.approx(0.5, abs=1e-14)
    assert rigid["first_impulse"][0][0] == pytest.approx(0.5, abs=1e-14)


def test_the_answer_says_what_is_lost_and_what_it_costs(found):
    text = " ".join(found[1]["answer"])
    assert "LAMMPS and the reference agree on first impulses to" in text
    assert "do not reproduce: the first impulses, from bead 2 on" in text
    assert "Energy exchange between chains is not the same" in text
    assert "times as long" in text


def test_every_engine_leaves_a_run_that_can_be_analysed(found):
    path = found[0]
    for engine in ("collisions", "reference", "lammps"):
        assert RunDirectory(path / engine).job.outcome == "done"
    assert {file.name for file in path.iterdir() if file.is_file()} == {"run.json",
        "scene.yaml", "compare.json", "compare.png"
    }  # fmt: skip


def test_the_table_has_every_engine_at_every_row(tmp_path, capsys):
    command = ["compare", "two-chains-gapped-strong", "--engines", "collisions,reference", "-o", str(tmp_path / "out")]
    assert main(command) == 0
    out = capsys.readouterr().out
    assert "theta = omega D / V = 1.2854 (eq. 5: 1.2854)" in out
    rows = 7 + 1  # beads, and the table of shares
    assert out.count("collisions ") >= rows
    assert out.count("reference ") >= rows
    assert "no impulse" in out
    assert "nan" not in out


def test_weak_swings_keep_the_cheap_model_right(tmp_path):
    """Contacts that are short against a swing: theta = 1e-2 and kappa = 1e-6."""
    case = small(gap=1e-2 / math.sqrt(2e-6), kappa=1e-6, duration=140.0, every=0.5)
    result = compare(case, tmp_path / "out", engines=("collisions", "reference"))
    assert result.last == 14 - 5
    text = " ".join(result.answer)
    assert "Rigid beads reproduce, within 10 %: the first impulses of beads 2 to " in text


def test_touching_beads_are_compared_without_rigid_ones(tmp_path):
    result = compare(small(gap=0.0, duration=10.0), tmp_path / "out")
    assert [one.engine for one in result.results] == ["reference", "lammps"]


def test_the_reference_that_lammps_is_compared_with_has_a_third_of_its_accuracy_as_uncertainty(tmp_path):
    case = small(gap=5.0, kappa=0.05, beads=8, duration=70.0).model_copy(update={"timestep": None})
    compare(case, tmp_path / "out", engines=("reference", "lammps"))
    own = RunDirectory(tmp_path / "out" / "reference").account.uncertainty
    assert own.velocity <= DEFAULT_ACCURACY / 3


def test_a_scene_until_a_bead_and_of_few_recorded_beads_is_compared_whole(tmp_path):
    case = small(until_bead=8, duration=None, recorded=(3,))
    result = compare(case, tmp_path / "out", engines=("reference", "collisions"))
    assert result.results[0].impulses.bead.tolist() == list(range(2, 15))
    assert result.last >= 8


def test_one_chain_and_many_chains_are_compared(tmp_path):
    for chains in (1, 5):
        result = compare(
            small(chains=chains, kappa=None if chains == 1 else 0.1),
            tmp_path / str(chains),
            engines=("collisions", "reference"),
        )
        assert len(result.answer) >= 2


def test_a_run_that_is_too_short_for_any_contact_says_so(tmp_path):
    result = compare(small(duration=0.2), tmp_path / "out", engines=("collisions", "reference"))
    assert result.last == 1
    assert "No row received an impulse in both models" in result.answer[0]


def test_a_comparison_keeps_its_runs_and_refuses_the_directory_of_another_scene(tmp_path, capsys):
    path, out = tmp_path / "scene.yaml", tmp_path / "out"
    text = "name: a\nbeads: 9\ngap: 0.5\nkick: {velocity: 1.0}\nduration: 9\n"
    path.write_text(text)
    command = ["compare", str(path), "-o", str(out), "--engines", "collisions,reference"]
    assert main(command) == 0
    dumps = [out / engine / file_names.DUMP for engine in ("collisions", "reference")]
    before = [dump.stat().st_mtime_ns for dump in dumps]
    assert main(command) == 0
    assert [dump.stat().st_mtime_ns for dump in dumps] == before
    capsys.readouterr()
    path.write_text(text.replace("0.5", "0.6"))
    assert main(command) == 2
    assert "another scene" in capsys.readouterr().err
    assert [dump.stat().st_mtime_ns for dump in dumps] == before
