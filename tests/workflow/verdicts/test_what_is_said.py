"""Of many scenes, what ``analyze`` must say of the run, and what it must not.

Beads of agreement (``agrees``) are those of chains so long that they were reached, run by the reference with a window;
all other numbers follow from the scene. Most rows are run by the reference engine, on coarse
frames.
"""

import json
import re
from dataclasses import dataclass, field
from typing import Any

import pytest

from analysis.sharing.verdict import EquipartitionState
from lammps_inputs import installed_scenes, strict_yaml
from workflow.cli import main
from workflow.engines.registry import engine_names

pytestmark = pytest.mark.usefixtures("lammps_here")

EQUAL, BEATING, SHORT, ALONE = (EquipartitionState[name] for name in ("EQUAL", "BEATING", "SHORT", "ALONE"))

GAP = 0.9089137578630695
"""Of eq. 5 at kappa = 1."""


@dataclass(frozen=True)
class Row:
    """A scene that ends at a time, and what is to be said of it.

    `agrees` is the bead from which on amplitudes agree to 1%, None where nobody knows; `foretold`, whether it must be
    foretold within its uncertainty; where not, it must not be named. `more` are further keys of the scene, `kept` is
    the part of the frames that is kept, as in a run that was cut; `says` and `never` are patterns of what is printed.
    """

    name: str
    state: EquipartitionState
    chains: int
    beads: int
    kappa: float
    until: float
    agrees: int | None = None
    foretold: bool = False
    more: dict[str, Any] = field(default_factory=dict)
    engine: str = "reference"
    kept: float = 1.0
    says: tuple[str, ...] = ()
    never: tuple[str, ...] = ()

    def scene(self) -> dict[str, Any]:
        coupling = {"coupling": {"stiffness": self.kappa}} if self.kappa else {}
        scene = {"name": self.name, "chains": self.chains, "beads": self.beads, **coupling, "output": {"every": 0.5}}
        return {**scene, "kick": {"velocity": 1.0}, "duration": self.until, **self.more}


def hit(*kicks):
    return {"kick": [dict(zip(("chain", "bead", "velocity"), kick, strict=True)) for kick in kicks]}


def recorded(*beads, **more):
    return {"output": {"every": 0.5, "beads": list(beads), **more}}


ROWS = (
    # two chains, strong to weak
    Row("two-0.1", EQUAL, 2, 100, 0.1, 140.0, 62),
    Row("two-0.003", SHORT, 2, 100, 0.003, 135.0, 1606, foretold=True, says=("decays",)),
    Row("one", ALONE, 1, 60, 0.0, 80.0, says=("solitary at bead 55",)),
    Row("barely-begun", SHORT, 2, 40, 0.1, 3.0, 62, foretold=True, says=("was passed in every chain",)),
    # more chains
    Row("twenty-0.2", SHORT, 20, 76, 0.2, 130.0, 983, foretold=True, never=(r"25 \+- ", "beats of")),
    # kicks
    Row("backwards", EQUAL, 2, 50, 0.5, 72.0, 17, more=hit((1, 50, -1.0))),
    Row("both-ends", BEATING, 2, 60, 0.1, 100.0, more=hit((1, 1, 1.0), (1, 60, -1.0)), never=("should agree",)),
    # what is recorded
    Row("few", SHORT, 2, 100, 0.1, 140.0, 62, more=recorded(10, 50, 90), says=("too far",), never=("beats of",)),
    Row("window", EQUAL, 2, 120, 0.1, 165.0, 62, more={"window": 64}, engine="lammps"),
    Row("cut", BEATING, 2, 100, 0.1, 140.0, 62, True, kept=0.5, says=("incomplete",), never=("solitary at bead 95",)),
    # gaps
    Row("gap-weak", EQUAL, 2, 100, 0.1, 720.0, more={"gap": GAP * 10**0.5}, never=("should agree",)),
    Row("rigid", BEATING, 2, 60, 1.0, 200.0, more={"gap": GAP}, engine="collisions", never=("equipartitioned",)),
)


@pytest.fixture(params=[pytest.param(row, id=row.name) for row in ROWS if row.engine in engine_names()])
def told(request, tmp_path, capsys):
    """A row, what ``analyze`` prints of it, and its analysis.json."""
    row = request.param
    (tmp_path / "scene.yaml").write_text(strict_yaml.dump(row.scene()))
    words = ["run", str(tmp_path / "scene.yaml"), "-o", str(tmp_path / "run"), "--engine", row.engine, "--no-check"]
    assert main(words) == 0
    dump = tmp_path / "run" / "chains.dump.bin"
    whole = dump.read_bytes()
    dump.write_bytes(whole[: int(row.kept * len(whole))])
    capsys.readouterr()
    assert main(["analyze", str(tmp_path / "run"), "--no-figures"]) == 0
    return row, capsys.readouterr().out, json.loads((tmp_path / "run" / "analysis.json").read_text())


@pytest.mark.slow
def test_what_is_said_holds(told):
    row, printed, report = told
    shared = report["equipartition"]
    assert shared["state"] == row.state.value
    assert printed.count(shared["verdict"]) == (row.chains > 1)
    for pattern in row.says:
        assert re.search(pattern, printed)
    for pattern in row.never:
        assert not re.search(pattern, printed)
    expected = shared["expected"]
    assert (expected is not None) == ("should agree" in printed) == row.foretold
    if expected is not None:
        assert abs(expected["value"] - row.agrees) <= expected["uncertainty"]
    if row.state is EQUAL and row.agrees is not None:
        assert shared["amplitudes"]["0.01"] == row.agrees
        assert f"amplitudes agree to 1% from bead {row.agrees} on" in printed
    if row.state is not EQUAL:
        assert "equipartitioned" not in printed


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(installed_scenes.installed())[2::4])
def test_every_fourth_installed_scene_passes_validate(name, tmp_path, capsys):
    assert main(["validate", name, "-o", str(tmp_path / "run")]) == 0
    assert capsys.readouterr().out.count("\nthe validation passed\n") == 1
