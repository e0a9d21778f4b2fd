"""The table of a sweep, and its figures: every case in one line, with the numbers that its files hold."""

import csv
import json
import os
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import granchain
from analysis.figures.studies import MOST_LINES, StudyAxis, map_figure
from analysis.shape.unit_cell import cell_of
from lammps_inputs import InputError, strict_yaml
from lammps_inputs.units import Label
from workflow.cli import main
from workflow.commands.collect import cell
from workflow.quantities.columns import QUANTITIES
from workflow.runs.run_directory import RunDirectory
from workflow.sweep import collect as collecting
from workflow.sweep import fields
from workflow.sweep import file as sweep_file
from workflow.sweep.collect import collect
from workflow.sweep.file import all_cases, scene_of

pytestmark = pytest.mark.usefixtures("lammps_here", "pool_here")

SCENE = {
    "name": "small",
    "chains": 2,
    "beads": 20,
    "kick": {"velocity": 1},
    "duration": 30,
}


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


def test_the_table_has_a_line_per_case_ordered_by_value(copied, capsys):
    assert main(["collect", str(copied)]) == 0
    assert "6 cases: 6 done" in capsys.readouterr().out
    values = [(row["beads"], row["coupling.stiffness"]) for row in table(copied / "table.csv")]
    assert values == [(beads, stiffness) for beads in ("20", "24") for stiffness in ("0.2", "0.4", "0.8")]


def test_where_chooses_the_cases_of_the_table_and_of_the_figure_and_what_is_drawn_is_printed(
    copied, capsys, monkeypatch
):
    monkeypatch.setattr(collecting, "write_figure", lambda *_: ())
    assert main(["collect", str(copied), "--where", "beads=24"]) == 0
    assert "3 cases: 3 done" in capsys.readouterr().out
    assert {row["beads"] for row in table(copied / "table.csv")} == {"24"}
    drawn = ["--plot", "speed", "--over", "beads", "--where", "coupling.stiffness=0.2"]
    assert main(["collect", str(copied), *drawn]) == 0
    head, *_ = (line for line in capsys.readouterr().out.splitlines() if "outcome" in line)
    assert head.split()[:4] == ["beads", "coupling.stiffness", "outcome", "speed"]
    assert {row["coupling.stiffness"] for row in table(copied / "table.csv")} == {"0.2"}


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


def test_what_came_back_from_a_cluster_is_analysed_and_gives_the_same_numbers(copied):
    before = collect(copied).rows
    for path in copied.glob("*=*"):
        for name in ("run.json", "analysis.json", "waves.csv"):
            (path / name).unlink()
    after = collect(copied).rows
    assert [row["outcome"] for row in after] == ["done"] * 6
    assert [row["amplitude"] for row in after] == [row["amplitude"] for row in before]


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


def test_frames_that_cannot_be_analysed_are_one_cases_matter(copied):
    case = next(copied.glob("*=*"))
    (case / "analysis.json").unlink()
    (case / "chains.dump.bin").write_bytes(b"nonsense" * 100)
    found = {row["case"]: row for row in collect(copied).rows}
    assert found[case.name]["outcome"] == "not analysed"
    assert "is not a LAMMPS binary dump" in found[case.name]["reason"]
    assert [row["outcome"] for row in found.values()].count("done") == 5


@pytest.mark.parametrize("content", [b"", b"{", b"[]", b"\xff", b'{"complete": 3}', b"[" * 10**6])
def test_a_spoiled_analysis_is_made_again(content, copied):
    case = next(copied.glob("*=*"))
    before = collect(copied).rows
    (case / "analysis.json").write_bytes(content)
    assert collect(copied).rows == before


def test_files_of_somebody_else_that_hold_other_things_leave_blanks(copied):
    case = next(copied.glob("*=*"))
    (case / "analysis.json").write_bytes(b'{"complete": true, "equipartition": 3, "waves": {"a": 1}}')
    (case / "run.json").write_bytes(b'{"outcome": "done", "check": [1], "steps": "many", "engine": {}}')
    row = next(row for row in collect(copied).rows if row["case"] == case.name)
    assert {row[name] for name in ("amplitude", "error_velocity", "steps", "speed", "engine", "verdict")} == {None}


def test_a_column_that_a_run_was_analysed_without_is_blank_alone(copied):
    case = next(copied.glob("*=*"))
    names = ["arrival@8", "speed@8", "peak_velocity@8"]
    before = {row["case"]: row for row in collect(copied, names).rows}
    rows = table(case / "waves.csv")
    with (case / "waves.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, [name for name in rows[0] if name != "speed"], extrasaction="ignore")
        writer.writeheader()
        writer.writerows(rows)
    report = json.loads((case / "analysis.json").read_text())
    del report["front"]
    (case / "analysis.json").write_text(json.dumps(report))
    expected = before[case.name] | {"speed@8": None, "front": None}
    assert {**before, case.name: expected} == {row["case"]: row for row in collect(copied, names).rows}
    assert None not in [before[case.name][name] for name in (*names, "front")]


def test_runs_without_a_sweep_are_gathered_too(copied):
    for path in copied.glob("*=*"):
        RunDirectory(path).update(request=None)
    assert (collect(copied).fields, len(collect(copied).rows)) == ([], 6)


# --- figures ----------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_quantity_is_drawn_over_one_field_and_over_two(copied, capsys):
    name = "amplitude-over-coupling.stiffness"
    words = ["collect", str(copied), "--plot", "amplitude", "--over", "coupling.stiffness"]
    assert main([*words, "--and", "beads", "--formats", "pdf"]) == 0
    assert f"{name}-and-beads.pdf" in capsys.readouterr().out
    assert main([*words, "--where", "beads=24"]) == 0
    both = ["collect", str(copied), "--plot", "amplitude", "--over", "coupling.stiffness,beads"]
    assert main(both) == 0
    for file in (f"{name}.png", f"{name}-and-beads.pdf", "amplitude-map-over-coupling.stiffness-and-beads.png"):
        assert (copied / file).stat().st_size > 5_000


def legend(figure):
    return [text.get_text() for one in figure.legends for text in one.get_texts()]


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


def test_a_field_of_more_values_than_lines_is_refused_with_the_limit_and_drawn_as_a_map():
    blank = dict.fromkeys(QUANTITIES)
    rows = [
        {**blank, "case": f"{gap}-{beads}", "gap": gap, "beads": beads, "outcome": "done", "speed": gap * beads}
        for gap in (1.0, 2.0)
        for beads in range(10, 11 + MOST_LINES)
    ]
    found = collecting.SweepTable(["gap", "beads"], rows, False)
    with pytest.raises(InputError, match=r"9 values; a figure has at most 8 lines; --over gap,beads draws a map"):
        collecting.drawn(found, "speed", "gap", "beads")
    mesh = collecting.drawn(found, "speed", "gap,beads").axes[0].collections[0]
    assert mesh.get_array().shape == (MOST_LINES + 1, 2)


def test_the_legend_names_the_bars_of_a_collected_quantity_where_there_are_any():
    case = {"outcome": "done", "state": "equipartitioned", "amplitude": 0.3, "amplitude_uncertainty": 0.1}
    rows = [{**case, "gap": gap} for gap in (0.1, 0.2)]
    found = collecting.SweepTable(["gap"], rows, False)
    assert "uncertainty" in legend(collecting.drawn(found, "amplitude", "gap"))
    unknown = [{**row, "amplitude_uncertainty": None} for row in rows]
    assert "uncertainty" not in legend(collecting.drawn(replace(found, rows=unknown), "amplitude", "gap"))


def test_an_amplitude_is_printed_with_its_uncertainty_to_the_digits_that_are_sure():
    words = {0.25: "0.34 +- 0.25", 0.00951: "0.3368 +- 0.0095", 1e-9: "0.3368", None: "0.3368"}
    for uncertainty, said in words.items():
        assert cell("amplitude", {"amplitude": 0.3368, "amplitude_uncertainty": uncertainty}) == said


def test_the_collected_figure_knows_its_scene_its_bars_and_its_unsettled_cases(copied, monkeypatch):
    drawn = []
    monkeypatch.setattr(collecting, "write_figure", lambda _path, _name, figure: drawn.append(figure) or ())
    found = collecting.only(collect(copied), {"beads": 20})
    collecting.plot(found, copied, "amplitude", "coupling.stiffness", None, "beads = 20")
    axis = drawn[0].axes[0]
    assert drawn[0].get_suptitle() == "small, beads = 20"
    states = [row["state"] for row in found.rows if row["amplitude"] is not None]
    hollow = [len(line.get_xdata()) for line in axis.get_lines() if line.get_markerfacecolor() == "white"]
    assert sum(hollow) == sum(state in ("beating", "too short") for state in states) > 0
    assert len(axis.collections[0].get_segments()) == len(states) == 2


def test_columns_of_si_scenes_name_their_units_and_others_keep_their_names(swept):
    reduced = collect(swept)
    assert reduced.to_csv().splitlines()[0].split(",") == reduced.columns
    labels = {"kick.velocity": Label("kick velocity", "", "m/s")}
    head = type(reduced)(["kick.velocity"], [], si=True, labels=labels).to_csv().splitlines()[0]
    found = {"kick.velocity (m/s)", "amplitude (V)", "amplitude_uncertainty (V)", "error_arrival (T)", "arrival (s)"}
    assert found <= set(head.split(","))


def test_labels_are_words_symbols_and_units_of_the_scenes(swept):
    reduced = collect(swept)
    assert reduced.label("coupling.stiffness").mathtext == "coupling stiffness $k$ (reduced)"
    assert reduced.label("beads").plain == "number of beads of a chain n_b"
    assert reduced.label("speed").mathtext == "speed at the last clear bead $c$ (reduced)"
    assert reduced.label("agree_1").mathtext == "bead from which amplitudes agree to 1 % $d_1$"
    assert reduced.label("case").plain == "case"
    assert type(reduced)([], [], si=True).label("speed").plain == "speed at the last clear bead c (beads/s)"
    for si in (True, False, None):
        assert type(reduced)([], [], si=si).label("amplitude").mathtext == "asymptotic amplitude $v / V$"


# --- over frequency ---------------------------------------------------------------------------------------------------

SHAKEN = {
    "name": "shaken",
    "beads": 16,
    "material": {"radius": 4.76e-3, "density": 8000, "youngs_modulus": 193e9, "poisson_ratio": 0.3},
    "precompression": {"force": 20},
    "drive": {"displacement": 1e-9, "frequency": 1000, "phase": -90},
    "duration": 8e-4,
    "timestep": 1e-7,
    "output": {"every": 1e-5, "spectra": {"beads": [1, 5], "after": 4e-4}},
}


@pytest.fixture(scope="module")
def shaken(tmp_path_factory):
    """A finished sweep below and above the cut-off, which is at 20.6 kHz."""
    folder = tmp_path_factory.mktemp("shaken")
    vary = {"drive.frequency": [10000, 25000]}
    (folder / "sweep.yaml").write_text(strict_yaml.dump({"scene": SHAKEN, "vary": vary}))
    assert main(["sweep", str(folder / "sweep.yaml"), "-o", str(folder / "s"), "--jobs", "1", "--no-check"]) == 0
    return folder / "s"


@pytest.mark.slow
def test_what_a_drive_passes_on_falls_above_the_cut_off_of_the_load(shaken):
    found = collect(shaken)
    assert found.heading("drive.frequency") == "drive.frequency (Hz)"
    (band,) = found.passed("drive.frequency")
    speed, factor = 369.2 / 9.52e-3, 20.0 ** (1.0 / 6.0)  # of sound at 1 N, in beads a second
    np.testing.assert_allclose(band, [0.0, speed * factor / np.pi], rtol=1e-3, atol=1e-3)
    low, high = found.numbers("transmissibility")
    assert 0.3 < low < 3.0
    decay = np.arccosh(25000 / band[1])
    assert high == pytest.approx(np.exp(-2.0 * decay * 4), rel=0.1)


@pytest.mark.slow
def test_frequencies_that_do_not_pass_are_shaded_in_the_figure_over_frequency(shaken, monkeypatch):
    drawn = []
    monkeypatch.setattr(collecting, "write_figure", lambda _path, _name, figure: drawn.append(figure) or ())
    collecting.plot(collect(shaken), shaken, "transmissibility", "drive.frequency", None)
    assert drawn[0].get_suptitle() == "shaken"
    assert "no small waves pass" in legend(drawn[0])


@pytest.fixture
def example(tmp_path):
    """The sweep of the README."""
    text = (Path(__file__).parents[3] / "workflow" / "README.md").read_text(encoding="utf-8")
    path = tmp_path / "shaken.yaml"
    path.write_text(text.partition("<!-- transmissibility -->\n```yaml\n")[2].partition("```")[0])
    return sweep_file.load(path)


def test_the_example_of_the_readme_is_a_sweep_across_the_cut_off(example):
    first, *_, last = (scene_of(example, case).problem() for case in all_cases(example))
    (band,) = cell_of(first.system).bands() / first.scale.time
    assert first.system.motions[0].omega / first.scale.time < band[1] < last.system.motions[0].omega / last.scale.time


@pytest.mark.slow
@pytest.mark.parametrize("frequency", [0.4, 0.45, 0.5])
def test_the_example_of_the_readme_finds_what_it_says(frequency, example, tmp_path):
    scene = fields.put(example.scene, fields.parse("drive.frequency"), frequency)
    granchain.analyze(granchain.run(scene, tmp_path / "run", engine="reference", check=False))
    report = json.loads((tmp_path / "run" / "analysis.json").read_text())
    ((_, cut_off),) = report["spectra"]["bands"]
    exact = np.exp(-20.0 * np.arccosh(frequency / cut_off))
    assert report["spectra"]["transmissibility"] == pytest.approx(exact, rel=0.05)


@pytest.mark.parametrize("name", ["foo@50", "peak_velocity@x", "peak_velocity_error@50", "peak_velocity"])
def test_a_column_at_a_bead_that_there_is_not_is_refused(name, tmp_path):
    with pytest.raises(InputError, match=r"no column at a bead; valid: .*peak_velocity@BEAD"):
        granchain.collect(tmp_path, [name])
