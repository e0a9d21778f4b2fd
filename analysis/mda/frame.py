"""What stands where in a frame of LAMMPS and of MDAnalysis: columns, box, and what our decks' boxes say of the chains.

A box is [axis, end or tilt]: xlo xhi xy, ylo yhi xz, zlo zhi yz, or without tilt. The bounds are those of the whole
sheared box, as LAMMPS writes them.
"""

from typing import Any

import numpy as np
from MDAnalysis.lib.mdamath import triclinic_box, triclinic_vectors

from analysis.trajectory import Floats

FORMAT = ["BIN", "LAMMPSBIN"]
UNITS = {"time": None, "length": None, "velocity": None}
"""Numbers are dimensionless, so that MDAnalysis converts none."""

POSITION = {"x": 0, "y": 1, "z": 2}
VELOCITY = {"vx": 0, "vy": 1, "vz": 2}
"""Column -> axis."""

DERIVED = ("velocity", "displacement")
"""Arrays in ``ts.data`` that are no columns of a dump."""


def dimensions(box: Floats) -> Any:
    """[frame, 6] lengths and angles of boxes [frame, axis, end or tilt]."""
    lengths = box[:, :, 1] - box[:, :, 0]
    if box.shape[2] == 2:
        return np.concatenate([lengths, np.full_like(lengths, 90.0)], axis=1, dtype=np.float32, casting="same_kind")
    xy, xz, yz = box[:, :, 2].T
    zero = np.zeros_like(xy)
    x = lengths[:, 0] - np.ptp([zero, xy, xz, xy + xz], axis=0)
    y = lengths[:, 1] - np.ptp([zero, yz], axis=0)
    edges = np.array([[x, zero, zero], [xy, y, zero], [xz, yz, lengths[:, 2]]]).transpose(2, 0, 1)
    return np.array([triclinic_box(*vectors) for vectors in edges])


def bounds(lengths_and_angles: Any) -> Floats:
    """The box, from 0 on, of 6 lengths and angles."""
    edges = np.asarray(triclinic_vectors(lengths_and_angles, dtype=np.float64))
    high = np.diagonal(edges).copy()
    if not np.any(edges - np.diag(high)):
        return np.stack([np.zeros(3), high], axis=1)
    xy, xz, yz = edges[1, 0], edges[2, 0], edges[2, 1]
    shear_x, shear_y = (0.0, xy, xz, xy + xz), (0.0, yz)
    low = np.array([min(shear_x), min(shear_y), 0.0])
    high += [max(shear_x), max(shear_y), 0.0]
    return np.stack([low, high, [xy, xz, yz]], axis=1)


def lines(box: Floats, n_atoms: int) -> Floats | None:
    """[atom] y of its chain; None for a box that is not of a ``data.chains``, see
    `lammps_inputs.decks.deck.render_data`.

    There the box ends one chain's distance beside the first and last chain; each chain has as many atoms, in a row.
    """
    (y_low, y_high), (z_low, z_high) = box[1:, :2]
    if box.shape[1] == 3 or y_low >= 0.0 or (z_low, z_high) != (y_low, -y_low):
        return None
    chains = round(float(-y_high / y_low))
    if chains < 1 or y_high != -y_low * chains or n_atoms % chains:
        return None
    return np.repeat(-y_low * np.arange(chains), n_atoms // chains)
