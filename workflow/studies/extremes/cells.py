"""The cells of the report, of ``cells.yaml``: a number at its extremes in each, and all that chains may be made of."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lammps_inputs import library, strict_yaml
from lammps_inputs.limits.rates import stability_bound
from workflow.engines.lammps.mpi import cores

Plain = dict[str, Any]


@dataclass(frozen=True)
class ReportRun:
    """One run of the report.

    Attributes:
        axis, value: its name.
        scene: what a scene file would say.
        ranks: MPI ranks; more than one must compute bit for bit what one computes.
        scaling: whether the run must be a scaled copy of that at another V, 1 in reduced units.
        drift: whether the energy must stay as near to the kick's in the second half as in the first.
        force: whether a time step above the stability bound is let pass.
    """

    axis: str
    value: str
    scene: Plain
    ranks: int = 1
    scaling: bool = False
    drift: bool = False
    force: bool = False


_FILE = strict_yaml.load(Path(__file__).with_name("cells.yaml"))
BASE: Plain = _FILE["base"]
PARTS: dict[str, dict[str, list[Plain]]] = {name: axes for name, axes in _FILE.items() if name != "base"}

WORDS: Plain = {
    "more than cores": cores() + 1,
    "every bead": [{"velocity": (-1.0) ** (i + j), "chain": j, "bead": i} for i in range(1, 31) for j in (1, 2)],
}
"""Words of ``cells.yaml`` that stand for what is computed."""


def changed(scene: Plain, **changes: Any) -> Plain:
    """A scene with some keys changed, added, or (None) left out."""
    return {key: value for key, value in {**scene, **changes}.items() if value is not None}


def scaled(scene: Plain, factor: float) -> Plain:
    """The same motion with all kicks times a positive factor: the equations have no scale of their own.

    Displacements go as V**0.8, times as V**-0.2, springs as V**0.4. For scenes with a duration and default output.
    """
    kicks = scene["kick"] if isinstance(scene["kick"], list) else [scene["kick"]]
    changes: Plain = {
        "kick": [{**kick, "velocity": kick["velocity"] * factor} for kick in kicks],
        "duration": scene["duration"] * factor**-0.2,
    }
    if "gap" in scene:
        changes["gap"] = scene["gap"] * factor**0.8
    if "coupling" in scene:
        changes["coupling"] = {"stiffness": scene["coupling"]["stiffness"] * factor**0.4}
    return {**scene, **changes}


def grid(parts: Sequence[str] = ()) -> list[ReportRun]:
    """Cells of these parts, or of all, axis by axis."""
    return [
        _cell(axis, WORDS.get(value, value), entry)
        for name, axes in PARTS.items()
        if not parts or name in parts
        for axis, entries in axes.items()
        for entry in entries
        for value in entry.get("values", [entry.get("value")])
    ]


def _cell(axis: str, value: Any, entry: Plain) -> ReportRun:
    """The cell of an entry of ``cells.yaml`` at a value."""
    own = _filled({key: one for key, one in entry.items() if key not in ("value", "values")}, {**WORDS, "VALUE": value})
    flags = {key: own.pop(key) for key in ("ranks", "scaling", "drift", "force") if key in own}
    scene = scaled(BASE, own.pop("scaled")) if "scaled" in own else BASE
    if "of_bound" in own:
        step = own.pop("of_bound") * stability_bound(library.from_plain(BASE, "base").system)
        own |= {"timestep": step, "output": {"every": step * max(1, round(0.1 / step))}}
    return ReportRun(axis, value if isinstance(value, str) else f"{value:g}", changed(scene, **own), **flags)


def _filled(template: Any, words: Plain) -> Any:
    """What an entry says, with the values of words in their places."""
    if isinstance(template, dict):
        return {key: _filled(one, words) for key, one in template.items()}
    if isinstance(template, list):
        return [_filled(one, words) for one in template]
    return words.get(template, template) if isinstance(template, str) else template
