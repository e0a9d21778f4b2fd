"""What LAMMPS cannot compute is said by `show`; what it just can, it does. `refusals/limits.yaml` has the refusals."""

import pytest

from lammps_inputs import strict_yaml
from lammps_inputs.decks import deck
from lammps_inputs.library import from_plain
from workflow.cli import main
from workflow.runs.run import run

PUSH = {"peak": 0.5, "duration": 3.0, "shape": "half-sine"}


def test_show_says_that_lammps_cannot_and_how_large_a_run_of_the_reference_is(tmp_path, capsys):
    keys = {"name": "limited", "beads": 4, "kick": {"velocity": 1.0}, "duration": 5.0, "timestep": 0.01}
    (tmp_path / "scene.yaml").write_text(strict_yaml.dump(keys | {"contact": {"exponent": [1.5, 1.5, 2.0]}}))
    assert main(["show", str(tmp_path / "scene.yaml")]) == 0
    shown = capsys.readouterr().out
    assert "# warning: LAMMPS cannot compute it: contacts: LAMMPS has exponents that differ" in shown
    assert "a run by the reference integrator has" in shown


@pytest.mark.parametrize(("kind", "count"), [("push", 24), ("drive", 24)])
def test_lammps_reads_a_deck_with_as_many_groups_as_the_limit_allows(kind, count, tmp_path, lammps_here):  # noqa: ARG001
    acts = {"push": PUSH, "drive": {"force": 0.1, "frequency": 0.1}}[kind]
    keys = {"name": "most", "beads": 40, kind: [{**acts, "bead": bead} for bead in range(1, count + 1)]}
    output = {"beads": [1, 2], "every": 1.0}
    case = from_plain({**keys, "duration": 2.0, "timestep": 0.02, "output": output}, "test")
    assert deck.refusal(case.system) == ""
    assert run(case, tmp_path / "run", check=False).outcome == "done"
