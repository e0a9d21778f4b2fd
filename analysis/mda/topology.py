"""MDAnalysis's topology of a ``data.chains``: chains are segments, beads are residues of one atom."""

import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from MDAnalysis.core import topologyattrs as attributes
from MDAnalysis.core.topology import Topology
from MDAnalysis.lib.util import openany
from MDAnalysis.topology.base import TopologyReaderBase

from analysis.trajectory import Flags, Integers
from lammps_inputs import file_names
from lammps_inputs.units import sphere_density

ATOM, RESIDUE = "X", "bead"
"""Names, for formats that demand some; X is no chemical element to other programs."""

_SECTION = re.compile(r"^(Atoms|Bonds)\b.*\n", re.MULTILINE)
_RECORDED = re.compile(r"^group recorded (type|id) (.+)$", re.MULTILINE)


class ChainsParser(TopologyReaderBase):  # type: ignore[misc]  # MDAnalysis has no types
    """Topology of a ``data.chains``, with the beads that the ``in.chains`` beside it records.

    - segment: a chain, ``segid C1``, ``C2`` and so on;
    - residue: a bead of a chain, ``resid`` from 1; in a window a row;
    - atom: the same bead; ``id`` is LAMMPS's, ``mass`` and ``radius`` are in LAMMPS's own (dimensionless) units;
    - bond: a spring between chains.
    """

    format = "CHAINS"

    def parse(self, **_: Any) -> Topology:
        """The topology.

        Raises:
            ValueError: the file is no ``data.chains``; the text names it.
        """
        with openany(self.filename, "rt") as file:
            data = file.read()
        beside = Path(str(self.filename)).with_name(file_names.DECK)
        try:
            return of_deck(data, beside.read_text(encoding="utf-8") if beside.is_file() else "")
        except ValueError as error:
            raise ValueError(f"{self.filename}: {error}") from None


def of_deck(data: str, commands: str) -> Topology:
    """The topology of the texts of a ``data.chains`` and of an ``in.chains``, which says what is recorded.

    Raises:
        ValueError: they are not.
    """
    sections = _sections(data)
    number, kind, mass, diameter, y = _atoms(sections.get("Atoms", ()))
    chain = np.unique(y, return_inverse=True)[1]
    rows = len(number) // (chain[-1] + 1)
    kept = _recorded(commands, number, kind)
    bonds = np.array([line.split() for line in sections.get("Bonds", ())], dtype=np.int64).reshape(-1, 4)
    bonds = bonds[kept[bonds[:, 2:] - 1].all(axis=1)]
    place = np.cumsum(kept) - 1
    count = int(np.count_nonzero(kept))
    row = (number[kept] - 1) % rows + 1
    return Topology(
        count,
        count,
        chain[-1] + 1,
        attrs=[
            attributes.Atomids(number[kept]),
            attributes.Atomnames(np.full(count, ATOM, dtype=object)),
            attributes.Atomtypes(kind[kept].astype(str).astype(object)),
            attributes.Masses(mass[kept]),
            attributes.Radii(diameter[kept] / 2.0),
            attributes.Resids(row),
            attributes.Resnums(row.copy()),
            attributes.Resnames(np.full(count, RESIDUE, dtype=object)),
            attributes.Segids(np.array([f"C{number + 1}" for number in range(chain[-1] + 1)], dtype=object)),
            attributes.Bonds([tuple(pair) for pair in place[bonds[:, 2:] - 1].tolist()]),
        ],
        atom_resindex=np.arange(count),
        residue_segindex=chain[kept],
    )


def _sections(data: str) -> dict[str, list[str]]:
    """Name -> lines."""
    _, *parts = _SECTION.split(data)
    pairs = zip(parts[::2], parts[1::2], strict=True)
    return {name: [line for line in body.splitlines() if line.strip()] for name, body in pairs}


def _atoms(lines: Iterable[str]) -> tuple[Any, ...]:
    """Number, type, mass, diameter and y of every atom, in their order."""
    # sphere: id type diameter density x y z; hybrid sphere bond: id type x y z diameter density molecule
    try:
        rows = np.array([line.split() for line in lines], dtype=np.float64)
        size, y = {7: (2, 5), 8: (5, 3)}[rows.shape[1]]
    except (ValueError, KeyError, IndexError):
        raise ValueError("its Atoms are not those of a data.chains") from None
    number, kind = rows[:, 0].astype(np.int64), rows[:, 1].astype(np.int64)
    if not np.array_equal(number, np.arange(1, len(rows) + 1)):
        raise ValueError("its Atoms are not those of a data.chains")
    diameter, density = rows[:, size], rows[:, size + 1]
    # the mass of 1 is exact in a run, and its density is not
    mass = np.ones(len(rows)) if np.ptp(density) == 0.0 else density / sphere_density(float(diameter[0]))
    return number, kind, mass, diameter, rows[:, y]


def _recorded(commands: str, number: Integers, kind: Integers) -> Flags:
    """[atom] whether its frames are written."""
    found = _RECORDED.search(commands)
    if found is None:
        return np.ones(len(number), dtype=bool)
    if found[1] == "type":
        return np.asarray(kind == int(found[2]))
    kept = np.zeros(len(number), dtype=bool)
    for first, last, stride in (map(int, words.split(":")) for words in found[2].split()):
        kept[first - 1 : last : stride] = True
    return kept
