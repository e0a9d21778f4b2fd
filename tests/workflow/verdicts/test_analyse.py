"""LAMMPS runs analysed: on the exact wave, on any grid, in documented files."""

import math
import os
import shutil
import struct

import numpy as np
import pytest
from refusals import refusal

from analysis.shape.exact_wave import solitary_wave
from analysis.sharing.verdict import EquipartitionState
from lammps_inputs import Kick, Output, Scene, file_names
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
def test_frames_so_far_apart_that_agreement_to_one_per_cent_cannot_be_told_get_no_verdict(tmp_path):
    seldom = scene(output=Output(every=2.0, beads=tuple(range(2, 120))))
    told = analyse(run(seldom, tmp_path / "coarse", check=False).directory, figures=False).survey.verdict
    assert told.state is not EquipartitionState.EQUAL
