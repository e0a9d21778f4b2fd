"""Search for thresholds from scripts and notebooks."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, TypedDict, TypeVar, Unpack

from granchain import InputError, load
from granchain.parts import Between, checked, inputs, numbers, options
from workflow.plugins.threshold.crossings import SearchedField
from workflow.plugins.threshold.study import ThresholdResult, carry_out, question_of

T = TypeVar("T")


class SearchOptions(TypedDict, total=False):
    """How a range is searched for thresholds.

    Attributes:
        log: whether it is divided by factors instead of differences.
        points: values of the first scan.
        tolerance: largest half-width of a bracket over its place.
    """

    log: bool
    points: Annotated[int, Between(2, 10_000)]
    tolerance: Annotated[float, Between(1e-12, 0.5)]


@checked
def threshold(
    scene: inputs.AnyScene,
    where: Mapping[str, float],
    vary: Mapping[str, Sequence[float]],
    directory: Path | str,
    *,
    over: Mapping[str, Sequence[Any]] | None = None,
    jobs: inputs.Processes | None = None,
    **search: Unpack[SearchOptions],
) -> ThresholdResult:
    """Find where a quantity crosses a value as a field of the scene varies; resumes an interrupted call.

    Writes the same files as ``granchain threshold``.

    Args:
        scene: see `granchain.load`; its other fields are constant.
        where: the quantity and the value, in the units of `granchain.collect`, such as ``{"agree_1": 50}``.
        vary: the varied field and both ends of its range, such as ``{"coupling.stiffness": (0.02, 0.5)}``.
        directory: new, or resumed.
        over: a second field and its values, each with thresholds of its own, such as ``{"chains": [2, 3, 4]}``.
        jobs: scenes at a time; as many as there are cores by default.
        **search: ``log``, whether the range is divided by factors; ``points``, values of the first scan; ``tolerance``,
            largest half-width of a bracket over its place; by default those of the command.

    Returns:
        The thresholds with their brackets and uncertainties, and all computed points.

    Raises:
        InputError: there is no such scene, quantity or field, or the directory cannot be used.
        RunError: a process was killed.

    Examples:
        >>> scene = {"name": "short", "beads": 20, "kick": {"velocity": 1.0}, "duration": 20.0}
        >>> found = granchain.threshold(
        ...     scene, {"peak_velocity@15": 1.0}, {"kick.velocity": (1.0, 2.0)}, "crossed", points=3, tolerance=0.01
        ... )
        >>> found
        <1 threshold of peak_velocity@15 over kick.velocity>
        >>> round(found.thresholds[0].place, 1)
        1.5
    """
    quantity, level = _single("where", where)
    field, ends = _single("vary", vary)
    if len(ends) != 2:
        raise InputError(f"vary: {len(ends)} numbers given; both ends of a range, such as {{{field!r}: (0.02, 0.5)}}")
    second = options.SecondField()
    if over is not None:
        name, values = _single("over", over)
        second = options.SecondField(name, tuple(map(options.hashable, numbers.plain_values(values))))
        if not values or len(set(map(repr, second.values))) < len(values):
            raise InputError("over: different values are needed, such as {'chains': [2, 3, 4]}")
    plain, source = load(scene).plain(), inputs.source_of(scene)
    axis = SearchedField(ends[0], ends[1], **search)
    question = question_of(source, plain, (quantity, level), field, axis, second)
    return carry_out(question, Path(directory), jobs)


def _single(name: str, values: Mapping[str, T]) -> tuple[str, T]:
    """Key and value of a mapping that holds one.

    Raises:
        InputError: it holds none, or several.
    """
    if len(values) != 1:
        raise InputError(f"{name}: {len(values)} entries given; one name with its value")
    [entry] = values.items()
    return entry
