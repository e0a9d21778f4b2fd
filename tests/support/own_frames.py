"""A run directory as an outsider reads it: frames straight from the documented layout of LAMMPS's dumps, tables, JSON."""  # noqa: E501

import csv
import io
import json
import re
import struct
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from scene_keys import nature, units
from scenes_nature import Floats, Nature, Units

from lammps_inputs import Scene

SYMBOLS = {"s", "m/s", "beads/s", "N", "J", "Hz", "rad/s", "kg m/s", "m"}


def dump(path: Path) -> list[tuple[int, Floats]]:
    """(step, rows of numbers) of each frame of a LAMMPS binary dump."""
    raw, at, found = path.read_bytes(), 0, []
    while at < len(raw):
        step, _, triclinic = struct.unpack_from("<2qi", raw, at + 26)
        assert triclinic == 0
        at += 26 + 16 + 4 + 24 + 48
        columns, unit = struct.unpack_from("<2i", raw, at)
        at += 8 + unit
        at += 1 + 8 * raw[at]
        (names,) = struct.unpack_from("<i", raw, at)
        at += 4 + names
        (chunks,) = struct.unpack_from("<i", raw, at)
        at += 4
        rows = []
        for _ in range(chunks):
            (count,) = struct.unpack_from("<i", raw, at)
            rows.append(np.frombuffer(raw, "<f8", count, at + 4))
            at += 4 + 8 * count
        found.append((step, np.concatenate(rows).reshape(-1, columns)))
    return found


@dataclass(frozen=True)
class Frames:
    """Dimensionless states at some times; NaN for beads that are not there.

    Attributes:
        steps: [frame].
        time: [frame].
        x, v: [frame, chain, bead].
    """

    steps: Any
    time: Floats
    x: Floats
    v: Floats

    def __len__(self) -> int:
        return len(self.time)


class Directory:
    """A run directory."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._tables: dict[str, list[dict[str, float | None]]] = {}
        self.record: dict[str, Any] = json.loads((path / "run.json").read_text())
        self.scene = Scene.model_validate_json(json.dumps(self.record["scene"]))

    @cached_property
    def unit(self) -> Units:
        return units(self.scene)

    @cached_property
    def nature(self) -> Nature:
        return nature(self.scene)

    @property
    def every(self) -> float:
        """Time between frames, dimensionless."""
        return float(self.scene.output.every) / self.unit.time

    @property
    def wanted(self) -> int:
        """Frames that the scene asks for, the start among them."""
        return max(1, int(np.ceil(self.scene.duration / self.scene.output.every * (1.0 - 1e-9)))) + 1

    @property
    def duration(self) -> float:
        return (self.wanted - 1) * self.every

    @property
    def steps_per_frame(self) -> int:
        return round(self.record["steps"] / (self.wanted - 1))

    @property
    def report(self) -> dict[str, Any]:
        return dict(json.loads((self.path / "analysis.json").read_text()))

    @cached_property
    def frames(self) -> Frames:
        return self._read("dump", 1)

    @cached_property
    def snapshots(self) -> Frames | None:
        return self._read("snapshots", 1) if self.scene.output.snapshots is not None else None

    @property
    def whole(self) -> bool:
        """Whether frames hold all beads."""
        window = self.scene.window
        return self.scene.output.beads == "all" and (window is None or window >= self.scene.beads)

    @property
    def recorded(self) -> list[int]:
        beads = self.scene.output.beads
        return list(range(1, self.scene.beads + 1)) if beads == "all" else list(beads)

    def _read(self, kind: str, _: int) -> Frames:
        chains, beads = self.scene.chains, self.scene.beads
        found: dict[int, Floats] = {}
        for path in sorted(self.path.glob(f"chains.{kind}*.bin"), key=lambda path: (len(path.name), path.name)):
            for step, rows in dump(path):
                found.setdefault(step, rows)
        steps = np.array(sorted(found))
        x, v = np.full((2, len(steps), chains, beads), np.nan)
        rest: dict[tuple[int, int], float] = {}
        for place, step in enumerate(steps.tolist()):
            rows = found[step]
            atoms = rows[:, 0].astype(int) - 1
            if rows.shape[1] > 3:  # a window: its rows are molecules, evenly spaced at rest
                many = len(rows) // chains
                chain, bead = atoms // many, rows[:, 1].astype(int) - 1
                if place == 0:
                    spacing = float(np.diff(np.sort(rows[chain == 0, 2])).mean())
                    first = float(rows[(chain == 0) & (bead == 0), 2][0])
                at_rest = first + bead * spacing
            else:
                chain, bead = atoms // beads, atoms % beads
                if place == 0:
                    rest = {(c, b): value for c, b, value in zip(chain, bead, rows[:, 1], strict=True)}
                    for moved in self.nature.moved:
                        assert (moved.chain, moved.bead) in rest or self.scene.output.beads != "all"
                at_rest = np.array([rest[pair] for pair in zip(chain, bead, strict=True)])
            x[place, chain, bead] = rows[:, -2] - at_rest
            v[place, chain, bead] = rows[:, -1]
        return Frames(steps, steps / self.steps_per_frame * self.every, x, v)

    def table(self, name: str) -> list[dict[str, float | None]]:
        """Rows of a CSV table; headings without their units, which must be those of the scene; empty is None."""
        if name not in self._tables:
            self._tables[name] = self._parsed(name)
        return self._tables[name]

    def _parsed(self, name: str) -> list[dict[str, float | None]]:
        text = (self.path / name).read_text()
        reader = csv.reader(io.StringIO(text))
        names = [heading(word, si=self.unit.si) for word in next(reader)]
        return [{key: float(word) if word else None for key, word in zip(names, row, strict=True)} for row in reader]


def heading(word: str, *, si: bool) -> str:
    """A heading without its unit.

    Raises:
        ValueError: a unit in a table in reduced units, or one that is none.
    """
    found = re.fullmatch(r"(.*?)(?: \((.*)\))?", word)
    assert found is not None
    if found[2] is not None and not (si and found[2] in SYMBOLS):
        raise ValueError(f"unit of {word}")
    return found[1]
