"""Table of what patterns, gradients and random numbers of a scene come to, for every bead, contact and spring."""

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple, get_type_hints

import numpy as np
from numpy.typing import NDArray

from lammps_inputs import laws
from lammps_inputs.ingredients import unequal
from lammps_inputs.links import Links
from lammps_inputs.numbers import known, text
from lammps_inputs.system import System
from lammps_inputs.units import Dimension, Scale, dimension_of

if TYPE_CHECKING:
    from lammps_inputs.scene import BaseScene

Floats = NDArray[np.float64]


class BeadColumn(NamedTuple):
    """A quantity that differs from bead to bead.

    Attributes:
        name: ``mass``, or a link and a parameter of its law, ``foundation.spring``; its SI unit follows in brackets.
        values: [chain, bead], in the scene's units; NaN where there is none. A contact stands at its first bead, a
            spring between chains at the chain of lower number.
    """

    name: str
    values: Floats


def columns(scene: "BaseScene") -> list[BeadColumn]:
    """Columns of all that differs from bead to bead; none where all beads, contacts and springs are alike."""
    links = _with_last(scene.system)
    candidates = [*_of_beads(scene), *(column for link in links for column in _of_link(link, scene))]
    return [column for column in candidates if len(np.unique(column.values[np.isfinite(column.values)])) > 1]


def csv(table: list[BeadColumn]) -> Iterator[str]:
    """Lines of CSV, one for each bead: numbers that read back exactly, empty cells where there is none."""
    yield ",".join(["chain", "bead", *(column.name for column in table)])
    for chain, beads in enumerate(np.stack([column.values for column in table], axis=-1), 1):
        for bead, values in enumerate(beads.tolist(), 1):
            yield ",".join([f"{chain},{bead}", *("" if math.isnan(value) else text(value) for value in values)])


def plain(table: list[BeadColumn]) -> dict[str, list[list[float | None]]]:
    """Columns for JSON, each a list of chains of beads; null where there is none."""
    return {name: [[known(value) for value in beads] for beads in values.tolist()] for name, values in table}


def _of_beads(scene: "BaseScene") -> Iterator[BeadColumn]:
    if not unequal.unlike(scene.setting):
        return
    ball, scale = scene.material, scene.scale
    shape = (scene.chains, scene.beads)
    mass, _ = unequal.masses_and_strengths(scene.setting)
    radius = 1.0 if ball is None else ball.radius
    si = ball is not None
    plane_modulus = 1.0 if ball is None else ball.youngs_modulus / (1.0 - ball.poisson_ratio**2)
    yield BeadColumn(scale.heading("mass", "mass"), scale.mass * np.broadcast_to(mass, shape))
    if si or not scale.si:  # beads given by their mass have no radius in m
        yield BeadColumn(scale.heading("radius", "length"), radius * unequal.radii(scene.setting))
    yield BeadColumn("plane_modulus (Pa)" if si else "plane_modulus", plane_modulus * unequal.moduli(scene.setting))


def _with_last(system: System) -> Iterator[Links]:
    """Links of chains; contacts of rings with those that close them, [chain, bead]."""
    shape = system.chains, system.beads - 1
    last = {"along": system.closing, "closing": ()}
    for link in system.links_of_chains:
        for closing in last.get(link.kind, ()):
            gap, law = link.gap, laws.joined(link.law, closing.law, shape)
            if isinstance(gap, np.ndarray):
                gap = np.concatenate([gap, np.broadcast_to(closing.gap, (system.chains, 1))], axis=1)
            yield replace(link, gap=gap, law=law)
        if not (system.closing and link.kind in last):
            yield link


def _of_link(link: Links, scene: "BaseScene") -> Iterator[BeadColumn]:
    if np.ndim(link.gap) > 0:
        for _, table in _at_beads(link, link.gap, scene):
            yield BeadColumn(scene.scale.heading("gap", "length"), scene.scale.length * table)
    hints = get_type_hints(type(link.law), include_extras=True)
    for parameter, values in link.law.by_name.items():
        dimension = dimension_of(hints[parameter])
        if np.ndim(values) == 0 or dimension is None:
            continue
        name, unit = f"{link.name}.{parameter}", _symbol(dimension, scene.scale)
        for place, table in _at_beads(link, values, scene):
            yield BeadColumn(f"{name}{place}{unit}", dimension.worth(scene.scale) * table)


def _at_beads(link: Links, values: Any, scene: "BaseScene") -> Iterator[tuple[str, Floats]]:
    """Values of links, [chain, bead], and what their names end with; one table for each neighbour of a graph."""
    shape = (scene.chains, scene.beads)
    if link.kind == "along":
        count = np.shape(values)[-1]
        contacts = np.broadcast_to(values, (scene.chains, count))
        yield "", np.pad(contacts, ((0, 0), (0, scene.beads - count)), constant_values=np.nan)
    elif link.kind == "across":
        rows = np.broadcast_to(values, (len(link.edges), scene.beads))
        tables: dict[str, Floats] = {}
        for (lower, higher), row in zip(link.edges, rows, strict=True):
            place = " to the next chain" if link.open_row else f" to chain {higher + 1}"
            tables.setdefault(place, np.full(shape, np.nan))[lower] = row
        yield from tables.items()
    else:
        (beads, _), *_ = link.ends
        table = np.full(shape, np.nan)
        table[:, beads.rows] = values
        yield "", table


def _symbol(dimension: Dimension, scale: Scale) -> str:
    """Unit of a parameter in brackets, after a space; empty in reduced units and of pure numbers."""
    symbol = dimension.symbol
    return f" ({symbol})" if scale.si and symbol else ""
