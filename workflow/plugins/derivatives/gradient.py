"""Derivatives of quantities of a scene by its fields, from the tangent flow of the reference, with uncertainties.

An uncertainty has three parts. That of time steps and frames is found by halving both: the difference from a run with
steps and frames twice as long. That of the central difference along a derivative of the motion, and of rounding in what
is measured, is found by a difference over twice the change. That of forces is known.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from granchain import InputError
from granchain.parts import (
    Fact,
    Floats,
    RunDirectory,
    axes,
    columns,
    numbers,
    output_directory,
    quantity,
    screen,
    units,
    write_text,
)
from granchain.parts import analyse as analysing
from workflow.plugins.derivatives.derivative import Derivative
from workflow.plugins.derivatives.motion import DerivativesOfMotion
from workflow.plugins.derivatives.varied_scene import JUMP, VariedScene

FORCES = 1e-7
"""Error of differences of forces, over the size of a derivative: rounding of the way of beads whose motion is given;
mostly far below."""

NEAR, FAR = 1e-5, 2e-5
"""Largest changes of a velocity, in units of V, along a derivative of the motion where quantities are measured."""

_NOISE = 1e-9
"""Relative change of a quantity by a relative change of 1 of a field, below which a derivative is that of rounding."""

SAFETY = 3.0
"""Uncertainty over the difference from a run with half the steps and frames, as of the reference itself."""

GOAL, HALVINGS = 2e-7, 5
"""Difference of a run with half the steps and frames, over the size of a derivative, that is aimed for, and how often
these are halved for it at most."""

FALL = 2.0**-1.5
"""Factor by which halving lessens errors at least: where contacts open, slopes of forces begin as roots of the overlap.
A difference that is smaller than by it is so by chance."""

GRADIENT = "gradient.csv"
"""File of the derivatives in a run's directory."""


def gradient(
    plain: dict[str, Any], quantities: Sequence[str], by: Sequence[str] | None, source: str
) -> list[Derivative]:
    """Derivatives of quantities of a scene by its fields, with uncertainties.

    Args:
        plain: plain data of the scene.
        quantities: names of quantities (`quantities.columns.KNOWN`), or such as ``peak_velocity@50``, at a bead.
        by: dotted paths of fields that hold a number other than 0; None for all of the scene.
        source: name of the scene in messages.

    Returns:
        One for each quantity and field, quantity by quantity.

    Raises:
        InputError: a name is that of no quantity or field, the scene cannot be linearised, or a field has no value on
            both sides of its own.
    """
    for name in quantities:
        columns.refuse_unknown(name, f"{source}: --gradient", "quantity")
        if reason := why_no_derivative(name):
            raise InputError(f"{source}: --gradient: {reason}")
    varied = VariedScene.of(plain, tuple(dict.fromkeys(quantities)), by, source)
    with screen.count_bar("derivatives") as count:
        motion = varied.motion(0)
        estimate = _Estimate.of(varied, motion)
        for halvings in range(1, HALVINGS + 1):
            count(halvings - 1, HALVINGS)
            if halvings > 1 and not varied.fits(halvings):
                break
            motion = varied.motion(halvings)
            estimate = _Estimate.of(varied, motion, estimate)
            if not np.any(estimate.change > GOAL * estimate.sizes):
                break
        return list(estimate.lines(varied, varied.slopes(motion, estimate.values, FAR)))


@dataclass(frozen=True)
class _Estimate:
    """Derivatives by one run.

    Attributes:
        values: quantities of the motion, [quantity].
        slopes: derivatives by moving frames by `NEAR`, [quantity, field].
        change: bound on what the last halving of steps and frames changes, [quantity, field]; infinite without one.
        sizes: what errors are compared to, [quantity, field]: the derivative, or the quantity over the field if larger.
    """

    values: Floats
    slopes: Floats
    change: Floats
    sizes: Floats

    @classmethod
    def of(cls, varied: VariedScene, motion: DerivativesOfMotion, coarser: "_Estimate | None" = None) -> "_Estimate":
        """Derivatives by a motion, with what they differ from those by one with twice the step."""
        values = varied.unmoved(motion)
        slopes = varied.slopes(motion, values, NEAR)
        scale = np.abs(values[:, np.newaxis] / np.array(list(varied.values.values())))
        change = np.full_like(slopes, np.inf)
        if coarser is not None:
            least = np.where(np.isfinite(coarser.change), coarser.change * FALL, 0.0)
            change = np.fmax(np.abs(slopes - coarser.slopes), least)
        return cls(values, slopes, change, np.fmax(np.abs(slopes), scale))

    def lines(self, varied: VariedScene, farther: Floats) -> Iterator[Derivative]:
        """All derivatives.

        Args:
            varied: the scene.
            farther: derivatives by moving frames by `FAR`, [quantity, field].
        """
        slopes, differences = (4.0 * self.slopes - farther) / 3.0, np.abs(farther - self.slopes)
        for place, dependent in enumerate(varied.quantities):
            value = numbers.known(float(self.values[place]))
            for number, (name, at) in enumerate(varied.values.items()):
                entry = place, number
                slope, unit = float(slopes[entry]), _unit(varied, dependent, name)
                difference, change, size = (float(array[entry]) for array in (differences, self.change, self.sizes))
                if value is None or not difference <= JUMP * abs(slope) + change + _NOISE * size:  # NaN, too
                    yield Derivative(dependent, name, value, None, None, unit, None)
                    continue
                uncertainty = SAFETY * change + difference + (_NOISE + FORCES) * size
                yield Derivative(
                    dependent, name, value, slope, uncertainty, unit, slope * at / value if value else None
                )


def _unit(varied: VariedScene, quantity: str, name: str) -> str:
    """Unit of a quantity over that of a field, such as ``(m/s)/(N/m)``; empty of a number."""
    symbols = [axes.label(part, varied.plain).unit for part in (quantity, name)]
    above, below = ("" if unit == units.REDUCED else unit for unit in symbols)
    return above if not below else f"({above or '1'})/({below})"


INSTEAD = {
    "agree_10": "amplitude, or peak_velocity@BEAD of the kicked chain",
    "agree_1": "amplitude, or peak_velocity@BEAD of the kicked chain",
    "synchronised_1": "arrival@BEAD of the kicked chain",
    "front": "arrival@BEAD",
    "bead": "arrival@BEAD",
    "contacts": "permanent",
}
"""Quantity that is a whole number -> quantities that have derivatives and change with the same."""


def why_no_derivative(name: str) -> str:
    """Why a quantity has no derivative, and what to ask for instead; empty if it has one.

    It changes in jumps alone, or is an error of a computation.
    """
    column = columns.column_called(name)
    if column is not None and column.place.quantity.counts:
        return f"{name} is a whole number, which changes in jumps; ask for {INSTEAD.get(name, 'another quantity')}"
    if name.endswith("_uncertainty"):
        return f"{name} is an uncertainty; ask for {name.removesuffix('_uncertainty')}"
    if name == "energy_drift":
        return "energy_drift is an error of the time step; ask for another quantity"
    return ""


def values_and_slopes(plain: dict[str, Any], names: Sequence[str], by: Sequence[str], source: str) -> dict[str, Any]:
    """What a process answers: ``values`` [quantity] and ``slopes`` [quantity, field], None where undefined.

    Steps are half of those of the reference's default. A scene that has no derivatives is ``refused``, with the reason.

    Args:
        plain: plain data of the scene.
        names: names of the quantities.
        by: dotted paths of the fields.
        source: name of the scene in messages.
    """
    try:
        varied = VariedScene.of(plain, tuple(names), by, source)
        motion = varied.motion(1)
        values = varied.unmoved(motion)
        slopes = varied.slopes(motion, values, NEAR)
    except (InputError, ValueError, ArithmeticError) as error:
        return {"refused": str(error)}
    return {
        "values": list(map(numbers.known, values.tolist())),
        "slopes": [list(map(numbers.known, row)) for row in slopes.tolist()],
    }


def with_derivatives(
    analyse: Callable[[], analysing.Analysis],
    directory: RunDirectory,
    quantities: Sequence[str],
    by: Sequence[str] | None,
) -> analysing.Analysis:
    """The analysis of a run with derivatives for its scene, which are also written beside the frames.

    Args:
        analyse: computes the analysis; called once the derivatives are known.
        directory: the run's directory.
        quantities: names of quantities.
        by: dotted paths of fields; None for all numbers of the scene.

    Raises:
        InputError: see `gradient`; or the beads of the run do not deform, there are no quantities, or another file
            stands where derivatives are written.
    """
    if not quantities:
        raise InputError("--by: names fields for --gradient, which is missing")
    if not directory.problem.system.holds(Fact.OVERLAPS):
        raise InputError(f"--gradient: {directory.path} is a run of rigid beads, which has no derivatives")
    derivatives = tuple(gradient(directory.scene.plain(), quantities, by, str(directory.path)))
    analysis = analyse()
    output_directory.record_files(directory.path, [GRADIENT])
    write_text(directory.path / GRADIENT, quantity.csv_of_rows([asdict(derivative) for derivative in derivatives]))
    return replace(analysis, tables=(*analysis.tables, GRADIENT), derivatives=derivatives)
