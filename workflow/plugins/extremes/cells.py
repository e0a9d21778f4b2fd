"""Cells of the report, from ``cells.yaml``: each has a number at an extreme, or an ingredient of chains."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from granchain import InputError
from granchain.parts import complaints, library, mpi, rates, strict_yaml

Plain = dict[str, Any]


@dataclass(frozen=True)
class ReportRun:
    """One run of the report.

    Attributes:
        axis, value: quantity at an extreme, and its value in words; together the name of the cell.
        scene: plain data of the scene.
        ranks: MPI ranks; several must compute bit for bit what a single one computes.
        scaling: whether the run must be a scaled copy of that at another V, 1 in reduced units.
        drift: whether the energy must be as near to that of the kick in the second half as in the first.
        force: whether a time step above the stability bound is allowed.
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
    "more than cores": mpi.cores() + 1,
    "every bead": [{"velocity": (-1.0) ** (i + j), "chain": j, "bead": i} for i in range(1, 31) for j in (1, 2)],
}
"""Words of ``cells.yaml`` that stand for computed values."""


def refuse_unknown(parts: Sequence[str], source: str) -> None:
    """Refuse what is no part of the report.

    Raises:
        InputError: a part is not in `PARTS`.
    """
    for name in parts:
        if name not in PARTS:
            hint = complaints.suggestion(name[:60], PARTS)
            raise InputError(f"{source}: {name[:60]!r} given{hint}; of {', '.join(PARTS)}")


def changed(scene: Plain, **changes: Any) -> Plain:
    """A scene with some keys changed, added, or (None) left out."""
    return {key: value for key, value in {**scene, **changes}.items() if value is not None}


def scaled(scene: Plain, factor: float) -> Plain:
    """Scene of the same motion, scaled, with all kicks multiplied by a positive factor.

    Displacements scale as V**0.8, times as V**-0.2, springs as V**0.4. The scene has a duration and default output.
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
    entries = _filled(
        {key: content for key, content in entry.items() if key not in ("value", "values")}, {**WORDS, "VALUE": value}
    )
    flags = {key: entries.pop(key) for key in ("ranks", "scaling", "drift", "force") if key in entries}
    scene = scaled(BASE, entries.pop("scaled")) if "scaled" in entries else BASE
    if "of_bound" in entries:
        step = entries.pop("of_bound") * rates.stability_bound(library.from_plain(BASE, "base").system)
        entries |= {"timestep": step, "output": {"every": step * max(1, round(0.1 / step))}}
    return ReportRun(axis, value if isinstance(value, str) else f"{value:g}", changed(scene, **entries), **flags)


def _filled(template: Any, words: Plain) -> Any:
    """An entry in which words are replaced by their values."""
    if isinstance(template, dict):
        return {key: _filled(entry, words) for key, entry in template.items()}
    if isinstance(template, list):
        return [_filled(entry, words) for entry in template]
    return words.get(template, template) if isinstance(template, str) else template
