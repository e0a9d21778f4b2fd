"""What commands print and write of each kind of scene, as golden texts."""

import json
from pathlib import Path

import pytest
from leaves import leaves
from run_states import aged, with_deck, with_frames, with_record, with_restart

from lammps_inputs import file_names, strict_yaml
from workflow import screen
from workflow.cli import main

pytestmark = pytest.mark.usefixtures("lammps_here", "pool_here")

STEEL = {"radius": 4.76e-3, "density": 8000, "youngs_modulus": 193e9, "poisson_ratio": 0.3}
PLAIN = {"kick": {"velocity": 1}, "timestep": 0.01}
COUPLED = {**PLAIN, "chains": 2, "coupling": {"stiffness": 0.5}}
TRACES = {"every": 1e-6, "forces": {"wall": True, "contacts": [4], "sensors": [6]}}
SCENES = {
    "coupled": {**COUPLED, "beads": 30, "duration": 42},
    "gapped": {**COUPLED, "beads": 20, "gap": 0.9, "duration": 60, "output": {"every": 0.2}},
    "steel": {
        **{"beads": 12, "material": STEEL, "kick": {"velocity": 140}, "walls": {"right": "bead"}, "timestep": 2e-8},
        **{"precompression": {"force": 20}, "duration": 8e-5, "output": TRACES},
    },
    "coarse": {
        **{"beads": 10, "timestep": 0.02, "precompression": {"force": 0.125}},
        **{"drive": {"displacement": 0.01, "frequency": 0.2}, "duration": 40, "output": {"spectra": {"beads": [1, 8]}}},
    },
    "window": {**COUPLED, "beads": 150, "duration": 100, "window": 64, "output": {"every": 0.5}},
    "dragged": {**PLAIN, "beads": 30, "duration": 40, "damping": {"beads": 0.01}},
    "few": {**PLAIN, "beads": 30, "duration": 40, "output": {"every": 0.2, "beads": [10, 20]}},
    "disordered": {**PLAIN, "beads": 40, "disorder": {"mass": 0.1, "seed": 2}, "duration": 50, "timestep": 0.0125},
}
"""Kinds of scenes, of which commands have other things to say; the time step of the coarse one is too long."""

OF_MACHINE = {
    r"\d+(\.\d+)?(e[-+]\d+)? (ms|s|min) of processor time": "SECONDS of processor time",
    r"an estimated time of [\d.e+-]+ (us|ms|s|min|h)": "an estimated time of SECONDS",
    r"LAMMPS \d{8}": "LAMMPS RELEASE",
    r"\d(\.\d+)?e-1\d\b": "ROUNDING",
}


@pytest.fixture
def printed(tmp_path, monkeypatch, capsys):
    """A function of words and an exit code: what the command prints, in a directory with the scenes as files."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HOME", str(tmp_path))  # without limits of whoever runs the tests
    monkeypatch.delenv("GRANCHAIN_SITE", raising=False)
    for name, keys in SCENES.items():
        Path(f"{name}.yaml").write_text(strict_yaml.dump({"name": name, **keys}))

    def text(words, code=0):
        capsys.readouterr()
        with screen.without_bars():  # nor hints, which depend on what was compiled before
            assert main(words if isinstance(words, list) else words.split()) == code
        out, err = capsys.readouterr()
        assert err == ""
        return out

    return text


def told(directory):
    """What the files of an analysis hold: the report, and of tables their heads and last lines."""
    report = json.loads((directory / "analysis.json").read_text(), parse_constant=pytest.fail)
    lines = [*leaves({key: part for key, part in report.items() if key != "version"})]
    for path in sorted(directory.glob("*.csv")):
        head, *_, last = path.read_text().splitlines()
        lines += ["", path.name, *map(": ".join, zip(head.split(","), last.split(","), strict=True))]
    return "\n".join(lines)


@pytest.mark.parametrize("name", SCENES)
def test_what_is_printed_of_a_scene_its_run_its_analysis_and_its_validation(name, printed, golden):
    shown = printed(f"show {name}.yaml")
    said = [shown, printed(f"run {name}.yaml -o {name}"), printed(f"analyze {name} --no-figures"), told(Path(name))]
    said.append(printed(f"validate {name}", int(name == "coarse")))
    golden(name, "\n\n".join(said), OF_MACHINE)
    json.loads(Path(name, "validation.json").read_text(), parse_constant=pytest.fail)
    Path("shown.yaml").write_text(shown)
    assert printed("show shown.yaml") == shown


WARNED = {
    "unstable": {"beads": 9, "duration": 10, "timestep": 1.0, "output": {"every": 1}},
    "frames beyond the end": {"beads": 9, "duration": 0.5, "timestep": 0.01, "output": {"every": 1}},
    "one chain with springs": {"beads": 9, "duration": 5, "timestep": 0.01, "coupling": {"stiffness": 0.1}},
    "duration in units of T": {
        **{"beads": 9, "duration": 192, "timestep": 1e-7, "output": {"every": 1e-6}, "material": STEEL},
    },
    "gap in SI": {
        **{"chains": 2, "beads": 9, "gap": 1e-5, "material": STEEL, "duration": 1e-3, "timestep": 1e-7},
        "coupling": {"stiffness": 2e6},
    },
    "what LAMMPS has not": {"beads": 4, "duration": 5, "timestep": 0.01, "contact": {"exponent": [1.5, 1.5, 2.0]}},
    "all left open": {"beads": 60, "until_bead": 50, "window": "auto"},
}


def test_warnings_of_show(printed, golden):
    said = []
    for title, keys in WARNED.items():
        Path("scene.yaml").write_text(strict_yaml.dump({"name": "a", "kick": {"velocity": 1}, **keys}))
        comments = [line for line in printed("show scene.yaml").splitlines() if line.startswith("#")]
        said += [f"{title}:", *comments, ""]
    golden("warnings", "\n".join(said), OF_MACHINE)


def test_what_a_deck_is_written_with_and_what_to_do_with_it(printed, golden):
    golden("deck", printed("deck steel.yaml -o deck"), OF_MACHINE)
    assert sorted(path.name for path in Path("deck").iterdir()) == [
        "data.chains",
        "in.chains",
        "run.json",
        "scene.yaml",
    ]


@pytest.mark.slow
def test_what_a_sweep_its_table_and_its_statistics_print(printed, golden):
    scene = {"name": "small", "chains": 2, "beads": 20, "kick": {"velocity": 1}, "duration": 30, "timestep": 0.01}
    vary = {"coupling.stiffness": [0.2, 0.4], "beads": [20, 24]}
    Path("sweep.yaml").write_text(strict_yaml.dump({"scene": scene, "vary": vary, "engine": "reference"}))
    said = [printed("sweep sweep.yaml -o s --jobs 1") for _ in range(2)]
    said += [printed(f"collect s {more}") for more in ("", "--where beads=24", "--statistics speed")]
    golden("sweep", "\n".join(said), {**OF_MACHINE, r"(?m) \d\.\d\d$": " SECONDS"})
    golden("table", Path("s/statistics.csv").read_text())


def test_each_state_of_a_directory_is_told_with_what_to_do_next(printed, golden):
    Path("empty").mkdir()
    with_deck(Path("deck"))
    aged(with_frames(with_deck(Path("deck ended")), 100))
    aged(with_frames(with_deck(Path("deck cut")), 30))
    with_frames(with_deck(Path("deck with restart")), 30)
    Path("deck with restart", file_names.RESTART).write_text("")
    aged(Path("deck with restart"))
    with_record(with_deck(Path("done")), outcome="done", steps_done=1000)
    with_record(with_deck(Path("failed")), outcome="failed", reason="no \x1b[31mway")
    with_record(with_deck(Path("killed")), outcome="running")
    with_record(with_frames(with_deck(Path("elsewhere")), 20), outcome="running", host="elsewhere")
    with_record(with_deck(Path("interrupted")), outcome="interrupted", steps_done=300)
    with_record(with_restart(with_deck(Path("old restart")), 400), outcome="interrupted", versions={"lammps": "2020"})
    names = sorted(path.name for path in Path().iterdir() if path.is_dir())
    golden("status", printed(["status", *names], 1))
