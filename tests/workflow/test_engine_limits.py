"""What LAMMPS cannot compute is said by `show`; what it just can, it does. `refusals/limits.yaml` has the refusals."""

import pytest

from lammps_inputs.decks import deck
from lammps_inputs.library import from_plain
from workflow.runs.run import run

PUSH = {"peak": 0.5, "duration": 3.0, "shape": "half-sine"}


@pytest.mark.parametrize(("kind", "count"), [("push", 24), ("drive", 24)])
def test_lammps_reads_a_deck_with_as_many_groups_as_the_limit_allows(kind, count, tmp_path, lammps_here):  # noqa: ARG001
    acts = {"push": PUSH, "drive": {"force": 0.1, "frequency": 0.1}}[kind]
    keys = {"name": "most", "beads": 40, kind: [{**acts, "bead": bead} for bead in range(1, count + 1)]}
    output = {"beads": [1, 2], "every": 1.0}
    case = from_plain({**keys, "duration": 2.0, "timestep": 0.02, "output": output}, "test")
    assert deck.refusal(case.system) == ""
    assert run(case, tmp_path / "run", check=False).outcome == "done"
