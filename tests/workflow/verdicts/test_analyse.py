"""LAMMPS runs analysed: on the exact wave, on any grid, in documented files."""

import csv
import json
import math
import os
import shutil
import struct

import numpy as np
import pytest
from refusals import refusal

from analysis.shape.exact_wave import solitary_wave
from analysis.sharing.verdict import EquipartitionState
from lammps_inputs import Kick, Output, Scene, file_names, find
from lammps_inputs.ingredients.coupling import Coupling
from workflow.cli import main
from workflow.runs.run import run
from workflow.verdicts.analysis_files import analyse

pytestmark = pytest.mark.usefixtures("lammps_here")


def scene(**changes):
    options = {"chains": 2, "beads": 120, "coupling": Coupling(stiffness=0.1), "kick": (Kick(velocity=1.0),)}
    return Scene(**{"name": "test", **options, "duration": 170.0, "output": Output(every=0.1), **changes})


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    return run(scene(), tmp_path_factory.mktemp("analyse") / "fine").directory


@pytest.fixture(scope="module")
def found(finished):
    return analyse(finished, figures=False)


def rows(path):
    with (path / "waves.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def test_waves_in_lammps_equipartition_at_the_bead_of_the_table_and_are_then_the_exact_wave(found):
    shared = found.survey.shared
    assert (shared.agrees_from(0.1), shared.agrees_from(0.01)) == (33, 62)
    assert shared.final.value == pytest.approx(0.36524, abs=2e-5)
    waves = found.waves.where((found.waves.bead >= 100) & (found.waves.bead <= 115))
    assert len(waves) == 32
    assert np.max(np.abs(waves.speed / solitary_wave().speed_at(waves.peak_velocity) - 1.0)) < 1e-4
    late = (found.waves.bead >= 90) & (found.waves.bead <= 115)
    assert np.max(found.survey.shape.residual[late]) < 1e-3
    assert found.survey.shape.width[late] == pytest.approx(solitary_wave().width, abs=1e-3)


@pytest.mark.slow
def test_output_ten_times_coarser_changes_amplitudes_by_less_than_1e_4_and_arrivals_by_less_than_1e_3(found, tmp_path):
    coarse = analyse(run(scene(output=Output(every=1.0), timestep=0.01), tmp_path / "coarse").directory, figures=False)
    fine = {(c, b): k for k, (c, b) in enumerate(zip(found.waves.chain, found.waves.bead, strict=True))}
    own = coarse.waves.bead <= 115
    place = [fine[key] for key in zip(coarse.waves.chain[own], coarse.waves.bead[own], strict=True)]
    assert np.max(np.abs(coarse.waves.peak_velocity[own] - found.waves.peak_velocity[place])) < 1e-4
    assert np.max(np.abs(coarse.waves.arrival[own] - found.waves.arrival[place])) < 1e-3
    assert coarse.survey.shared.agrees_from(0.01) == 62


def copy_with(finished, tmp_path, number):
    """The run with one velocity of its last frame replaced."""
    copy = tmp_path / "copy"
    shutil.copytree(finished.path, copy)
    with (copy / file_names.DUMP).open("r+b") as file:
        file.seek(-8, os.SEEK_END)
        file.write(struct.pack("<d", number))
    return copy


@pytest.mark.parametrize("number", [math.nan, 1e308])
def test_frames_that_hold_what_is_no_number_are_refused_in_one_line(finished, tmp_path, capsys, number):
    said = refusal(["analyze", copy_with(finished, tmp_path, number)], capsys)
    assert "the velocity of bead 120 of chain 2 is" in said
    assert "at t = 170" in said


@pytest.mark.slow
def test_frames_that_are_not_those_of_the_run_are_told_of(finished, tmp_path, capsys):
    main(["analyze", str(finished.path), "--no-figures"])
    assert "fingerprint" not in capsys.readouterr().out
    main(["analyze", str(copy_with(finished, tmp_path, 1e-9)), "--no-figures"])
    assert "the checksum of the frames is not that in run.json" in capsys.readouterr().out


@pytest.mark.slow
def test_an_uncertainty_covers_the_error_that_the_run_states_and_without_a_check_the_frames_alone(tmp_path, capsys):
    short = scene(beads=50, duration=72.0, timestep=0.1)
    coarse = run(short, tmp_path / "coarse").directory
    assert main(["analyze", str(coarse.path), "--no-figures"]) == 0
    assert "was not checked" not in capsys.readouterr().out
    check, report = coarse.account.check, json.loads((coarse.path / "analysis.json").read_text())
    assert check.amplitude > 1e-4
    assert report["run_error"]["amplitude"] >= check.amplitude
    assert report["equipartition"]["final"]["uncertainty"] >= check.amplitude
    assert all(wave["peak_velocity_error"] >= check.amplitude for wave in report["waves"])
    assert all(wave["arrival_error"] >= check.arrival for wave in report["waves"])
    alone = run(short, tmp_path / "alone", check=False).directory
    assert main(["analyze", str(alone.path), "--no-figures"]) == 0
    assert "uncertainties cover the time between frames alone" in capsys.readouterr().out
    assert json.loads((alone.path / "analysis.json").read_text())["run_error"] is None


@pytest.mark.slow
def test_frames_so_far_apart_that_agreement_to_one_per_cent_cannot_be_told_get_no_verdict(tmp_path):
    seldom = scene(output=Output(every=2.0, beads=tuple(range(2, 120))))
    told = analyse(run(seldom, tmp_path / "coarse", check=False).directory, figures=False).survey.verdict
    assert told.state is not EquipartitionState.EQUAL


@pytest.mark.slow
def test_gapped_chains_whose_impulses_become_equal_are_found_equal_and_in_step_by_impulses_alone(tmp_path, capsys):
    gapped = run(find("two-chains-gapped"), tmp_path / "run", check=False).directory
    found = analyse(gapped, figures=False).survey
    assert found.arrival == "impulse"
    assert found.verdict.state is EquipartitionState.EQUAL
    # impulses differ by less than 1 % from bead 63 on; they are not the peaks, but level out with them
    assert abs(found.shared.agrees_from(0.01) - 63) <= 3
    last = found.waves.at(115)
    assert np.ptp(last.arrival) < 2e-3
    assert last.speed == pytest.approx(115 / 779.0 * np.ones(2), rel=0.02)  # nearly the mean speed since the kick
    assert np.isnan(found.shape.residual[found.waves.bead == 115]).all()
    assert main(["analyze", str(gapped.path), "--no-figures", "--arrival", "maximum"]) == 0
    assert "inconclusive: beads fly freely" in capsys.readouterr().out
    late = [row for row in rows(gapped.path) if row["bead"] == "115"]
    assert [(row["arrival"], row["speed"]) for row in late] == [("", "")] * 2


@pytest.mark.slow
def test_where_a_leading_pulse_ends_is_said_and_its_table_numbers_the_pulses(tmp_path, capsys):
    steel = find("steel-beside-brass")
    case = steel.model_copy(update={"beads": 36, "duration": 7e-4, "timestep": 1e-7})
    run(case, tmp_path / "run", check=False)
    assert main(["analyze", str(tmp_path / "run"), "--no-figures"]) == 0
    lines = capsys.readouterr().out.splitlines()
    merging = "where it merges into the pulse behind it (0.333 V), which leads from bead 24 on"
    assert f"in chain 1 the leading pulse ends at bead 23 (0.0596 V), {merging}" in lines
    pulse = {(int(row["chain"]), int(row["bead"])): int(row["pulse"]) for row in rows(tmp_path / "run")}
    assert (pulse[1, 10], pulse[1, 23], pulse[1, 24]) == (1, 1, 2)
    assert {number for (chain, _), number in pulse.items() if chain == 2} == {1}
    waves = json.loads((tmp_path / "run" / "analysis.json").read_text())["waves"]
    assert [wave["ended"] for wave in waves] == [[23], []]
