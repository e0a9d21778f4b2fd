"""The report on extremes: it sees what is silently wrong, and says nothing against what is right."""

import csv
import math
from dataclasses import replace

import numpy as np
import pytest
import wrong_runs
from stock_lammps import scene

from lammps_inputs import InputError
from lammps_inputs.laws.spring import Linear
from workflow.cli import main
from workflow.errors import RunError
from workflow.plugins.extremes import study
from workflow.plugins.extremes.cells import BASE, ReportRun, changed, grid, scaled
from workflow.plugins.extremes.study import LargestError, classify, true_error
from workflow.prepare.pilot import stride
from workflow.runs import check as checking
from workflow.runs.run import run

pytestmark = pytest.mark.usefixtures("lammps_here")

SHORT = changed(BASE, beads=8, duration=5.0)

REFUSED = ReportRun("gap", "1e9", changed(SHORT, gap=1e9))


CELLS = grid()


def named(axis, value):
    """A cell of the grid."""
    (found,) = (cell for cell in CELLS if (cell.axis, cell.value) == (axis, value))
    return found


# --- what a cell is called --------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("kind", "told", "truth"),
    [
        ("RIGHT", (1e-5, 1e-6), (1e-5, 0.0)),
        ("RIGHT", (1e-3, 1e-3), (1e-5, 0.0)),  # says more than is true
        ("REPORTED", (0.1, 1e-3), (0.1, 0.0)),
        ("REPORTED", (1e-4, 0.1), (0.1, 0.0)),  # says how uncertain it is
        ("WRONG", (4.5e-4, 0.0), (6e-4, 0.0)),  # nearly as reported, and more than asked
        ("WRONG", (1e-5, 1e-6), (1e-3, 0.0)),
        ("WRONG", (1e-5, 1e-6), (math.nan, 0.0)),
        ("WRONG", (1e-7, 1e-8), (1e-5, 0.0)),  # as right as asked, and not as right as said
        ("RIGHT", (1e-5, 1e-6), (1e-4, 1e-4)),  # within the uncertainty of the reference
        ("WRONG", (1e-5, 1e-6), (1e-4, 1e-6)),
    ],
)
def test_a_run_that_ended_is_right_or_told_or_wrong(kind, told, truth):
    assert classify(5e-4, LargestError(*told), LargestError(*truth))[0] == kind


@pytest.mark.parametrize(
    ("failing", "error", "kind"),
    [
        ("run", InputError("no"), "REFUSED"),
        ("run", RunError("no"), "STOPPED"),
        ("run", ValueError("no"), "WRONG"),
        ("true_error", InputError("no"), "WRONG"),
    ],
)
def test_a_run_that_fails_is_refused_or_stopped_or_a_crash_and_its_comparison_never_a_refusal(
    failing, error, kind, monkeypatch
):
    def fail(*_, **__):
        raise error

    monkeypatch.setattr(study, failing, fail)
    assert study.measure(ReportRun("x", "y", SHORT)).kind == kind


# --- planted errors ---------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_deck_with_springs_one_per_cent_stiffer_than_its_scene_is_silently_wrong(tmp_path):
    pair = scene(chains=2, beads=30, kappa=0.1, duration=30.0)
    planted = wrong_runs.deck_run(pair, tmp_path / "run", wrong_runs.ONE_PERCENT_MORE)
    assert classify(study.PROMISED, LargestError(1e-4, 1e-6), true_error(planted, 1e-5))[0] == "WRONG"


@pytest.mark.slow
def test_wrong_springs_that_a_run_tells_of_are_told_and_wrong_once_it_is_silent(monkeypatch):
    right = Linear.across

    def wrong(*arguments):
        lines = right(*arguments)
        return replace(lines, coefficients=tuple(k.replace("kappa/2", "kappa*0.51") for k in lines.coefficients))

    monkeypatch.setattr(Linear, "across", wrong)
    honest = study.measure(ReportRun("x", "y", BASE))
    assert honest.kind == "REPORTED"
    check = checking.check

    def lie(*arguments):
        return replace(check(*arguments), velocity=1e-5)

    monkeypatch.setattr(checking, "check", lie)
    assert study.measure(ReportRun("x", "y", BASE)).kind == "WRONG"


@pytest.fixture(scope="module")
def good(tmp_path_factory):
    return run(scene(chains=2, beads=8, kappa=0.1, duration=20.0), tmp_path_factory.mktemp("good") / "run").directory


def test_one_bit_more_than_one_rank_computes_is_found(good, tmp_path):
    other = wrong_runs.rewritten(
        good, tmp_path / "other", lambda own: (own.displacement, np.nextafter(own.velocity, 2))
    )
    cell = ReportRun("ranks", "2", {}, ranks=2)
    assert "differs from one rank" in study._fault(cell, other, tmp_path)
    assert study._fault(cell, good, tmp_path / "again") is None


def test_energy_that_grows_is_found(good, tmp_path):
    cell = ReportRun("steps", "2000", {}, drift=True)
    assert study._fault(cell, good, tmp_path) is None
    growing = wrong_runs.rewritten(
        good, tmp_path / "growing", lambda own: (own.displacement, own.velocity * (1 + 1e-6 * own.time[:, None, None]))
    )
    assert "the energy drifts" in study._fault(cell, growing, tmp_path)


def test_a_run_that_is_not_the_scaled_copy_is_found(tmp_path):
    slow = scaled(SHORT, 1e-6)
    other = changed(slow, coupling={"stiffness": 1.0001 * slow["coupling"]["stiffness"]})
    directory = run(study.library.from_plain(other, "scene"), tmp_path / "run", check=False).directory
    assert "differs from the scaled run" in study._fault(
        ReportRun("V", "1e-6", slow, scaling=True), directory, tmp_path
    )


# --- a small grid, for real -------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "cell"),
    [
        ("RIGHT", named("V", "1e+12")),
        ("RIGHT", named("kappa", "1e-08")),
        ("RIGHT", ReportRun("kappa", "1e4", changed(SHORT, coupling={"stiffness": 1e4}, duration=0.1))),
        ("STOPPED", named("step / bound", "0.99")),
        ("REFUSED", named("step / bound", "1.01")),
        ("STOPPED", named("step / bound", "1.5 forced")),
        ("REPORTED", named("step / bound", "0.5")),
        ("RIGHT", named("beads", "2")),
        ("REFUSED", named("gap", "1e+09")),
        ("RIGHT", named("corners", "V 1e-30")),
    ],
    ids=lambda one: f"{one.axis} {one.value}" if isinstance(one, ReportRun) else one,
)
def test_a_cell_ends_as_it_should(kind, cell):
    found = study.measure(cell)
    assert (found.kind, found.why) == (kind, found.why)
    assert found.why or kind == "RIGHT"
    assert kind != "RIGHT" or found.error <= found.asked


@pytest.mark.slow
def test_stiff_springs_are_checked_in_every_phase_of_their_swing():
    # 0.4 T are nine swings to a percent, so frames 0.4 apart show no error
    stiff = changed(SHORT, coupling={"stiffness": 1e4}, timestep=2e-4, output={"every": 0.1}, duration=0.5)
    found = study.measure(ReportRun("kappa", "1e4", stiff))
    assert found.kind == "REPORTED"
    assert found.reported == pytest.approx(found.error, rel=0.01)


@pytest.mark.slow
def test_an_accuracy_is_kept_in_every_phase_of_a_swing():
    cell = named("corners", "accuracy, 5 frames a period")
    found = study.measure(replace(cell, scene=changed(cell.scene, beads=8, duration=0.5)))
    assert found.kind == "RIGHT"


@pytest.mark.parametrize(
    ("frames", "every", "left"), [(7, 0.1, 0), (100, 0.1, 0), (5, 3.0, 0), (400, 0.1, 0), (401, 0.1, 1), (403, 0.1, 1)]
)
def test_the_last_frame_is_checked_or_the_one_before(frames, every, left):
    problem = scene(beads=9, duration=frames * every, every=every).problem()
    assert problem.frames == frames
    assert problem.frames % stride(problem) == left


@pytest.mark.slow
def test_an_automatic_window_takes_in_kicks_that_are_far_apart():
    kicks = [{"velocity": 1.0}, {"velocity": 0.7, "bead": 50}]
    far = changed(BASE, beads=150, kick=kicks, window="auto", duration=20.0, output={"every": 0.5})
    assert study.measure(ReportRun("window", "two kicks", far)).kind == "RIGHT"


# --- the report -------------------------------------------------------------------------------------------------------


@pytest.mark.usefixtures("pool_here")
def test_the_command_writes_a_table_goes_on_where_it_stopped_and_fails_for_a_wrong_cell(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(study, "grid", lambda *_: [ReportRun("beads", "8", SHORT), REFUSED])
    monkeypatch.setattr(study, "_program", lambda: "this one")
    command = ["extremes", "-o", str(tmp_path)]
    assert main(command) == 0
    out = capsys.readouterr().out
    assert "2 cells: 1 RIGHT, 0 REPORTED, 1 REFUSED, 0 STOPPED, 0 WRONG" in out
    assert "REFUSED gap 1e9: scene: gap: 1e+09 in dimensionless units" in out
    with (tmp_path / "extremes.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["kind"] for row in rows] == ["RIGHT", "REFUSED"]
    kept = tmp_path / "cells.jsonl"
    kept.write_text(kept.read_text().replace('"kind": "RIGHT", "why": ""', '"kind": "WRONG", "why": "planted"'))
    assert main(command) == 1  # taken from the file
    assert "WRONG beads 8: planted" in capsys.readouterr().out
    monkeypatch.setattr(study, "_program", lambda: "another one")
    assert main(command) == 0  # measured again
