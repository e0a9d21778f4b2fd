"""The table of a sweep, and its figures: every case in one line, with the numbers that its files hold."""

import csv
import json
import os
import shutil
from pathlib import Path

import numpy as np
import pytest
from figure_table import table as table_of

import granchain
from analysis.figures.studies import StudyAxis, map_figure
from lammps_inputs import strict_yaml
from lammps_inputs.units import Label
from workflow.cli import main
from workflow.runs.run_directory import RunDirectory
from workflow.sweep import collect as collecting
from workflow.sweep import fields
from workflow.sweep import file as sweep_file
from workflow.sweep.collect import collect

pytestmark = pytest.mark.usefixtures("lammps_here", "pool_here")

SCENE = {"name": "small", "chains": 2, "beads": 20, "kick": {"velocity": 1}, "duration": 30, "timestep": 0.01}


@pytest.fixture(scope="module")
def swept(tmp_path_factory):
    """A finished sweep of six cases."""
    folder = tmp_path_factory.mktemp("sweep")
    vary = {"coupling.stiffness": [0.2, 0.4, 0.8], "beads": [20, 24]}
    (folder / "sweep.yaml").write_text(strict_yaml.dump({"scene": SCENE, "vary": vary}))
    assert main(["sweep", str(folder / "sweep.yaml"), "-o", str(folder / "s"), "--jobs", "1"]) == 0
    return folder / "s"


@pytest.fixture
def copied(swept, tmp_path):
    """A copy of it that may be spoiled."""
    return shutil.copytree(swept, tmp_path / "s")


def table(path):
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


@pytest.mark.slow
def test_numbers_in_the_table_are_exactly_those_of_the_cases_files(copied):
    assert main(["collect", str(copied), "-o", str(copied / "mine.csv")]) == 0
    for row in table(copied / "mine.csv"):
        report = json.loads((copied / row["case"] / "analysis.json").read_text())
        record = json.loads((copied / row["case"] / "run.json").read_text())
        shared = report["equipartition"]
        numbers = {
            "amplitude": (shared["final"] or {}).get("value"),
            "agree_10": shared["amplitudes"]["0.1"],
            "energy_share": shared["energy_share"]["measured"],
            "error_velocity": record["check"]["velocity"],
            "wall_seconds": record["wall_seconds"],
            "speed": report["waves"][0]["speed"],
        }
        assert {name: float(row[name]) if row[name] else None for name in numbers} == numbers
        assert (row["outcome"], row["verdict"]) == ("done", shared["verdict"])


def test_failed_interrupted_and_unfinished_cases_are_in_the_table_with_their_reason(copied, capsys):
    done, failed, interrupted, empty, *_ = sorted(copied.glob("*=*"))
    RunDirectory(failed).update(outcome="failed", reason="by step 200, nonsense")
    (failed / "analysis.json").unlink()
    RunDirectory(interrupted).update(outcome="interrupted")
    for name in ("run.json", "analysis.json", "chains.dump.bin"):
        (empty / name).unlink()
    assert main(["collect", str(copied)]) == 0
    assert "6 cases: 3 done, 1 failed, 1 incomplete, 1 written" in capsys.readouterr().out
    found = {row["case"]: (row["outcome"], row["amplitude"], row["reason"]) for row in table(copied / "table.csv")}
    assert found[failed.name] == ("failed", "", "by step 200, nonsense")
    assert found[interrupted.name][0] == "incomplete"
    assert found[interrupted.name][2].startswith("interrupted; ")
    assert found[empty.name] == ("written", "", "`lmp -in in.chains` there starts it")
    assert found[done.name][0] == "done"


def test_a_run_that_got_farther_since_is_analysed_again(copied):
    case = next(copied.glob("*=*"))
    record = json.loads((case / "run.json").read_text())
    (case / "run.json").write_text(json.dumps({"files": record["files"]}))  # as a cluster leaves it
    dump = case / "chains.dump.bin"
    whole = dump.read_bytes()
    dump.write_bytes(whole[: len(whole) // 2])
    assert main(["analyze", str(case), "--no-figures"]) == 0
    os.utime(dump, (0, 0))  # nobody writes it at the moment
    assert {row["outcome"] for row in collect(copied).rows if row["case"] == case.name} == {"incomplete"}
    dump.write_bytes(whole)
    assert {row["outcome"] for row in collect(copied).rows} == {"done"}
    assert json.loads((case / "analysis.json").read_text())["complete"] is True


@pytest.mark.parametrize("content", [b"\xff", b'{"complete": 3}'])
def test_a_spoiled_analysis_is_made_again(content, copied):
    case = next(copied.glob("*=*"))
    before = collect(copied).rows
    (case / "analysis.json").write_bytes(content)
    assert collect(copied).rows == before


# --- figures ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("factor", [1.0, 100.0])
def test_contours_of_a_map_lie_where_the_quantity_has_their_value(factor):
    x, y = (part.ravel() for part in np.meshgrid([0.0, 1.0, 2.0, 3.0], [0.0, 1.0, 2.0]))
    z = 1.0 + factor * (x + 2.0 * y)  # linear, as the interpolation between the centres of cells is
    figure = map_figure(StudyAxis(Label("z"), z), StudyAxis(Label("x"), x), StudyAxis(Label("y"), y))
    mesh, contours = figure.axes[0].collections
    assert (type(mesh.norm).__name__ == "LogNorm") == (z.max() / z.min() > 30.0)
    assert len(contours.levels) >= 3
    for level, path in zip(contours.levels, contours.get_paths(), strict=True):
        np.testing.assert_allclose(1.0 + factor * (path.vertices @ [1.0, 2.0]), level, rtol=1e-12)


def test_the_collected_figure_shows_its_scene_its_bars_and_its_unsettled_cases(copied, monkeypatch, golden):
    figures = []
    monkeypatch.setattr(collecting, "write_figure", lambda _path, _name, figure: figures.append(figure) or ())
    found = collecting.only(collect(copied), {"beads": 20})
    collecting.plot(found, copied, "amplitude", "coupling.stiffness", None, "beads = 20")
    golden("amplitude", table_of(figures[0]))


# --- over frequency ---------------------------------------------------------------------------------------------------

SHAKEN = {
    **{"name": "shaken", "beads": 16, "precompression": {"force": 20}, "duration": 8e-4, "timestep": 1e-7},
    "material": {"radius": 4.76e-3, "density": 8000, "youngs_modulus": 193e9, "poisson_ratio": 0.3},
    "drive": {"displacement": 1e-9, "frequency": 1000, "phase": -90},
    "output": {"every": 1e-5, "spectra": {"beads": [1, 5], "after": 4e-4}},
}


@pytest.mark.slow
def test_what_a_drive_passes_on_falls_above_the_cut_off_of_the_load(tmp_path):
    """Below and above it; it is at 20.6 kHz."""
    vary = {"drive.frequency": [10000, 25000]}
    (tmp_path / "sweep.yaml").write_text(strict_yaml.dump({"scene": SHAKEN, "vary": vary}))
    assert main(["sweep", str(tmp_path / "sweep.yaml"), "-o", str(tmp_path / "s"), "--jobs", "1", "--no-check"]) == 0
    found = collect(tmp_path / "s")
    assert found.heading("drive.frequency") == "drive.frequency (Hz)"
    (band,) = found.passed("drive.frequency")
    speed, factor = 369.2 / 9.52e-3, 20.0 ** (1.0 / 6.0)  # of sound at 1 N, in beads a second
    np.testing.assert_allclose(band, [0.0, speed * factor / np.pi], rtol=1e-3, atol=1e-3)
    low, high = found.numbers("transmissibility")
    assert 0.3 < low < 3.0
    assert high == pytest.approx(np.exp(-2.0 * np.arccosh(25000 / band[1]) * 4), rel=0.1)


@pytest.fixture
def example(tmp_path):
    """The sweep of the README."""
    text = (Path(__file__).parents[3] / "workflow" / "README.md").read_text(encoding="utf-8")
    path = tmp_path / "shaken.yaml"
    path.write_text(text.partition("<!-- transmissibility -->\n```yaml\n")[2].partition("```")[0])
    return sweep_file.load(path)


@pytest.mark.slow
@pytest.mark.parametrize("frequency", [0.4, 0.5])
def test_the_example_of_the_readme_finds_what_it_says(frequency, example, tmp_path):
    scene = fields.put(example.scene, fields.parse("drive.frequency"), frequency)
    granchain.analyze(granchain.run(scene, tmp_path / "run", engine="reference", check=False))
    report = json.loads((tmp_path / "run" / "analysis.json").read_text())
    ((_, cut_off),) = report["spectra"]["bands"]
    exact = np.exp(-20.0 * np.arccosh(frequency / cut_off))
    assert report["spectra"]["transmissibility"] == pytest.approx(exact, rel=0.05)
