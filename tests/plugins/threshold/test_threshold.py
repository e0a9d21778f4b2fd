"""Where a quantity crosses a value: brackets of known functions, exact cases, resumption, and what has no threshold."""

import csv
import itertools
import math

import pytest
from figure_table import assert_shown
from pool_here import answers

from lammps_inputs import strict_yaml
from workflow.cli import main
from workflow.plugins.threshold.crossings import SearchedField, crossings, wanted
from workflow.study_kit import directory as studying
from workflow.workers.pool import Pool

pytestmark = pytest.mark.usefixtures("pool_here")

LINEAR = SearchedField(-1.0, 2.0, tolerance=1e-4)


def searched(function, axis, level=0.0):
    """The crossings of a function, and its computed values; none is asked for twice."""
    known = {}
    while values := wanted(known, axis, level):
        assert not known.keys() & set(values)
        assert len(known) < 1000
        known |= {value: function(value) for value in values}
    return crossings(known, axis, level), known


@pytest.mark.parametrize(
    ("function", "axis", "level", "places"),
    [
        (lambda x: x, SearchedField(0.1, 1.0), 0.3, [0.3]),
        (lambda x: -math.log(x), SearchedField(1e-6, 1e3, log=True), 3.0, [math.exp(-3.0)]),
        (lambda x: x * x, LINEAR, 0.5, [-math.sqrt(0.5), math.sqrt(0.5)]),
        (lambda x: float(x >= 0.7), LINEAR, 1.0, [0.7]),
        (lambda x: x * x - 0.25, SearchedField(1, 100, integer=True), 1000.0, [31.5]),
    ],
)
def test_every_crossing_of_a_function_is_in_a_bracket_as_narrow_as_asked_for(function, axis, level, places):
    found, _ = searched(function, axis, level)
    assert len(found) == len(places)
    for one, place in zip(found, places, strict=True):
        assert one.low <= place <= one.high
        assert axis.is_narrow(one.low, one.high)
        assert one.rises == (function(one.low) < level)
        assert (one.mixed, one.undefined) == (False, False)


def test_the_bracket_of_a_noisy_quantity_includes_all_computed_values_on_the_wrong_side():
    noise = 0.05
    (one,), known = searched(lambda x: x - 0.5 + noise * math.sin(1e6 * x), LINEAR)
    assert one.mixed
    assert 0.5 - noise <= one.low < one.high <= 0.5 + noise  # beyond, the noise cannot reach the level
    assert all(value < 0.0 for x, value in known.items() if x <= one.low)
    assert all(value >= 0.0 for x, value in known.items() if x >= one.high)
    assert not LINEAR.is_narrow(one.low, one.high)


def test_where_a_quantity_is_undefined_in_between_the_bracket_ends_on_either_side_of_that():
    (one,), known = searched(lambda x: None if 0.4 < x < 0.6 else x - 0.5, LINEAR)
    assert one.undefined
    assert not one.mixed
    assert one.low <= 0.4
    assert one.high >= 0.6
    assert None not in (known[one.low], known[one.high])


@pytest.mark.parametrize("function", [lambda _: None, lambda _: 1.0, lambda x: None if x < 0.5 else x])
def test_without_two_sides_there_is_no_bracket_and_no_search_beyond_the_scan(function):
    found, known = searched(function, LINEAR)
    assert (found, sorted(known)) == ([], LINEAR.scan())


CHAIN = {"name": "chain", "chains": 1, "beads": 24, "kick": {"velocity": 1.0}, "until_bead": 20}
"""One chain: times are in proportion to the kick's velocity to the power -1/5 (contacts of exponent 3/2)."""


def asked(tmp_path, *words, scene=CHAIN):
    """Exit code of the command, and the lines of its table."""
    path = tmp_path / "chain.yaml"
    path.write_text(strict_yaml.dump(scene))
    code = main(["threshold", str(path), *words, "-o", str(tmp_path / "found"), "--jobs", "1"])
    table = tmp_path / "found" / "threshold.csv"
    return code, list(csv.DictReader(table.read_text().splitlines())) if table.is_file() else []


def numbers(path):
    """Value of the field -> quantity."""
    return {float(row["value"]): float(row["quantity"]) for row in csv.DictReader(path.read_text().splitlines())}


@pytest.mark.slow
def test_the_kick_at_which_a_pulse_arrives_at_a_given_time_is_that_of_the_scaling_law(tmp_path):
    words = ["--where", "arrival=20", "--vary", "kick.velocity=0.5:4", "--log", "--points", "4"]
    code, (found,) = asked(tmp_path, *words)
    place = (numbers(tmp_path / "found" / "points.csv")[1.0] / 20.0) ** 5
    rounding = 1e-9  # of the scaled numbers, which are those of one motion at V = 1
    assert (code, found["rises"]) == (0, "False")
    assert float(found["low"]) * (1.0 - rounding) <= place <= float(found["high"]) * (1.0 + rounding)
    assert abs(float(found["place"]) - place) <= float(found["uncertainty"]) * (1.0 + rounding)
    assert float(found["uncertainty"]) <= 1e-3 * float(found["high"])


STRUCK = {"name": "struck", "chains": 1, "beads": 24, "striker": {"velocity": 1.0, "mass": 1.0}, "duration": 2.0}
"""Its beads weigh 23 and the mass of the striker."""

BY_MASS = ["--where", "mass=25.5", "--vary", "striker.mass=0.5:3", "--points", "3"]


@pytest.mark.slow
@pytest.mark.usefixtures("drawn")
def test_a_mass_is_found_exactly_and_a_second_field_makes_a_curve_with_a_figure(tmp_path, capsys):
    code, found = asked(tmp_path, *BY_MASS, "--over", "beads=24,25,26,40", scene=STRUCK)
    assert code == 0
    assert [one["over"] for one in found] == ["24", "25"]  # 26 beads: 0.5, the end of the range, is not below the level
    for one, mass in zip(found, (2.5, 1.5), strict=True):
        assert float(one["low"]) <= mass <= float(one["high"])
        assert abs(float(one["place"]) - mass) <= float(one["uncertainty"]) <= 1e-3 * mass
    assert (
        "no threshold: mass does not cross 25.5: 39.5 to 42 at 3 values of striker.mass from 0.5 to 3"
        in capsys.readouterr().out
    )
    assert (tmp_path / "found" / "threshold.png").is_file()


@pytest.fixture
def figures(monkeypatch):
    """Figures of studies, not written."""
    found = []
    monkeypatch.setattr(studying, "write_figure", lambda _directory, _name, figure: found.append(figure) or ())
    return found


NINE = ",".join(map(str, range(20, 29)))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "more"),
    [
        ("crossing", []),
        ("curve", ["--over", "beads=24,25"]),
        ("no-crossing-map", ["--where", "mass=100", "--over", f"beads={NINE}"]),
    ],
)
def test_the_figure_marks_the_value_and_the_crossing_or_without_one_what_was_computed(
    name, more, tmp_path, figures, golden
):
    asked(tmp_path, *BY_MASS, *more, scene=STRUCK)
    figures[0].suptitle("")  # the path of the scene
    assert_shown(name, lambda: figures[0], None, golden)


def test_values_of_a_second_field_are_read_as_those_of_a_scene_lists_too(tmp_path):
    kinds = {**STRUCK, "kinds": {"a": {"mass": 1.0}, "b": {"mass": 2.0}}, "pattern": ["a", "b"]}
    words = ["--where", "mass=36", "--vary", "striker.mass=0.5:20", "--points", "3"]
    _, found = asked(tmp_path, *words, "--over", "pattern=[b, a],[a, a, b]", scene=kinds)
    for one, mass in zip(found, (36.0 - 12.0 - 2.0 * 11.0, 36.0 - 15.0 - 2.0 * 8.0), strict=True):
        assert float(one["low"]) <= mass <= float(one["high"])
    _, found = asked(tmp_path, *words, "--over", "kinds.b.mass=2,1e0", scene=kinds)
    assert [one["over"] for one in found] == ["2", "1.0"]


@pytest.mark.parametrize(
    ("where", "says"),
    [
        ("mass=100", "no threshold: mass does not cross 100: 23.5 to 26 at 3 values of striker.mass from 0.5 to 3"),
        (
            "agree_1=3",
            "no threshold: agree_1 is undefined at 3 values of striker.mass from 0.5 to 3 "
            "(`granchain help agree_1` says when)",
        ),
    ],
)
def test_no_threshold_is_one_line_and_exit_code_1(where, says, tmp_path, capsys):
    assert asked(tmp_path, *BY_MASS, "--where", where, scene=STRUCK) == (1, [])
    assert says in capsys.readouterr().out.splitlines()


def test_a_search_that_was_interrupted_keeps_what_it_computed_and_ends_as_one_that_was_not(
    tmp_path, monkeypatch, capsys
):
    def interrupted(pool, tasks):
        yield from itertools.islice(answers(pool, tasks), 2)
        raise KeyboardInterrupt

    (tmp_path / "s.yaml").write_text(strict_yaml.dump(STRUCK))
    words = ["threshold", str(tmp_path / "s.yaml"), *BY_MASS, "-o"]
    with monkeypatch.context() as patch:
        patch.setattr(Pool, "answers", interrupted)
        assert main([*words, str(tmp_path / "cut")]) == 130
    assert "the same command resumes" in capsys.readouterr().out
    cache = tmp_path / "cut" / "evaluations.jsonl"
    kept = cache.read_text()
    assert len(kept.splitlines()) == 2
    assert main([*words, str(tmp_path / "cut")]) == main([*words, str(tmp_path / "whole")]) == 0
    assert cache.read_text().startswith(kept)
    tables = [path.name for path in (tmp_path / "whole").glob("*.csv")]
    assert len(tables) == 2
    assert all((tmp_path / "cut" / name).read_text() == (tmp_path / "whole" / name).read_text() for name in tables)
