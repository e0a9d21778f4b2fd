"""Search for thresholds from scripts and notebooks."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar, Unpack

from granchain import InputError, load
from granchain.parts import AnyScene, Processes, SecondField, checked, hashable, plain_values, source_of
from workflow.plugins.threshold.study import ScanOptions, ThresholdResult, carry_out, question_of

T = TypeVar("T")


class SearchOptions(ScanOptions, total=False):
    """How thresholds are searched.

    Attributes:
        jobs: scenes at a time.
    """

    jobs: Processes


@checked
def threshold(
    scene: AnyScene,
    where: Mapping[str, float],
    vary: Mapping[str, Sequence[float]],
    directory: Path | str,
    *,
    over: Mapping[str, Sequence[Any]] | None = None,
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
        **search: ``log``, whether the range is divided by factors; ``points``, values of the first scan; ``tolerance``,
            largest half-width of a bracket over its place; ``jobs``, scenes at a time; by default those of the command.

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
    second = SecondField()
    if over is not None:
        name, values = _single("over", over)
        second = SecondField(name, tuple(map(hashable, plain_values(values))))
        if not values or len(set(map(repr, second.values))) < len(values):
            raise InputError("over: different values are needed, such as {'chains': [2, 3, 4]}")
    jobs = search.pop("jobs", None)
    plain, source = load(scene).plain(), source_of(scene)
    question = question_of(source, plain, (quantity, level), (field, ends[0], ends[1]), second, search)
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
