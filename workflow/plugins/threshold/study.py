"""Find where a quantity crosses a value as a field of the scene varies, with its uncertainty.

A threshold study: scans of the field, brackets that are halved, and files.

| file              | contents                                                                 |
|-------------------|--------------------------------------------------------------------------|
| threshold.csv     | a line for each place where the quantity crosses the value               |
| points.csv        | the quantity at every computed value of the field                        |
| threshold.png     | the quantity over the field; with a second field the place over that,    |
|                   | or, where the value is crossed nowhere, the quantity in lines            |
| evaluations.jsonl | the cache: every scene that was computed, as it was done                 |
"""

import argparse
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from granchain import InputError
from granchain.parts import (
    Study,
    axes,
    columns,
    computations,
    evaluate,
    fields,
    library,
    options,
    screen,
    units,
)
from workflow.plugins.threshold.crossings import Crossing, SearchedField, crossings, wanted

if TYPE_CHECKING:
    from matplotlib.figure import Figure

TABLE, POINTS, FIGURE = "threshold.csv", "points.csv", "threshold"
STUDY = Study(
    "threshold", f"{TABLE} is the table", tables=(TABLE, POINTS), figures=(FIGURE,), cache="evaluations.jsonl"
)


@dataclass(frozen=True)
class Question:
    """Where a quantity of a scene crosses a value.

    Attributes:
        source: name of the scene in messages.
        scene: its plain data.
        quantity: name of the quantity, as in the table of a sweep.
        level: the value, in the scene's units.
        field: the varied field.
        axis: range of the field, and how it is searched.
        over: a second field, with thresholds for each of its values.
    """

    source: str
    scene: dict[str, Any]
    quantity: str
    level: float
    field: str
    axis: SearchedField
    over: options.SecondField

    @property
    def uncertainty(self) -> str:
        """Name of the quantity's uncertainty; empty where it has none."""
        return columns.UNCERTAINTIES.get(self.quantity, "")

    def case(self, over: Any, value: float) -> computations.Computation:
        """Case of the scene with values in both fields."""
        number = int(value) if self.axis.integer else value
        scene = fields.put_all(self.over.put(self.scene, over), {self.field: number})
        return evaluate.case(scene, tuple(filter(None, (self.quantity, self.uncertainty))), self.source)

    def __post_init__(self) -> None:
        columns.refuse_unknown(self.quantity, self.source, "quantity of a threshold")
        names = [name for name in (self.field, self.over.name) if name]
        if len({fields.parse(name, self.scene) for name in names}) < len(names):
            raise InputError(f"{self.source}: --over {self.over.name}: is the field whose threshold is searched")


@dataclass(frozen=True)
class Threshold:
    """A place where the quantity crosses the value.

    Attributes:
        over: value of the second field; None without one.
        place: value of the field in the middle of the bracket.
        uncertainty: half the bracket's width, plus the quantity's uncertainty over its slope where it has one; None
            where that is undefined.
        low, high: the bracket: the computed values up to ``low`` are on one side, those from ``high`` on the other, as
            far as the neighbours in the scan.
        rises: whether the quantity rises through the value.
        mixed: whether values on both sides alternate within the bracket.
        undefined: whether the quantity is undefined at a value within the bracket.
    """

    over: Any
    place: float
    uncertainty: float | None
    low: float
    high: float
    rises: bool
    mixed: bool
    undefined: bool


@dataclass(frozen=True)
class ComputedPoint:
    """A computed scene: values of the second field and of the field, and the quantity, None where it is undefined."""

    over: Any
    value: float
    quantity: float | None


@dataclass(frozen=True)
class ThresholdResult:
    """Result of a study.

    Attributes:
        question: the question.
        thresholds: all thresholds, in the order of the second field and the field.
        points: all computed scenes, in that order.
        refused: value of the second field -> why the first of its scenes that were refused is invalid.
    """

    question: Question
    thresholds: list[Threshold]
    points: list[ComputedPoint]
    refused: dict[Any, str]

    def __repr__(self) -> str:
        question, count = self.question, len(self.thresholds)
        return f"<{count} threshold{'s' * (count != 1)} of {question.quantity} over {question.field}>"

    def plain(self) -> dict[str, Any]:
        """Plain data of the result, for scripts."""
        question = self.question
        return {
            "quantity": question.quantity,
            "value": question.level,
            "field": question.field,
            "over": question.over.name or None,
            "thresholds": [vars(threshold) for threshold in self.thresholds],
            "computed": len(self.points),
        }

    def missing(self, over: Any) -> str:
        """Why there is no threshold at a value of the second field, in one line."""
        question = self.question
        at = f" at {question.over.name} = {screen.cell(over)}" if question.over.name else ""
        points = [point for point in self.points if point.over == over]
        quantities = [point.quantity for point in points if point.quantity is not None]
        undefined = [point.value for point in points if point.quantity is None]
        where = f"at {len(points)} values of {question.field} from {question.axis.low:g} to {question.axis.high:g}{at}"
        if not quantities:
            name, _, _ = question.quantity.partition("@")
            reason = self.refused.get(over, f"`granchain help {name}` says when")
            return f"no threshold: {question.quantity} is undefined {where} ({reason})"
        without = f", undefined at {len(undefined)}, {undefined[0]:g} to {undefined[-1]:g}" if undefined else ""
        return (
            f"no threshold: {question.quantity} does not cross {question.level:g}: {min(quantities):.6g} to "
            f"{max(quantities):.6g} {where}{without}"
        )

    def by_over(self) -> dict[Any, list[Threshold]]:
        """Value of the second field -> its thresholds."""
        return {
            over: [threshold for threshold in self.thresholds if threshold.over == over]
            for over in self.question.over.values
        }


# --- carried out ------------------------------------------------------------------------------------------------------


def carry_out(question: Question, directory: Path, jobs: int | None = None) -> ThresholdResult:
    """Find all thresholds, on all cores; scenes of an earlier start are not computed again.

    Args:
        question: the question.
        directory: made if need be.
        jobs: scenes at a time; None for all cores.

    Raises:
        InputError: the directory cannot be used.
        RunError: a process was killed.
    """
    axis, level = question.axis, question.level
    computed: dict[Any, dict[float, float | None]] = {over: {} for over in question.over.values}
    errors: dict[tuple[Any, float], float | None] = {}
    refused: dict[Any, str] = {}
    with STUDY.evaluating(directory, jobs) as evaluated:
        while plan := [(over, x) for over, values in computed.items() for x in wanted(values, axis, level)]:
            answers = evaluated([question.case(over, x) for over, x in plan])
            for (over, x), value in zip(plan, answers, strict=True):
                quantities = value.get("quantities", {})
                computed[over][x] = quantities.get(question.quantity)
                errors[over, x] = quantities.get(question.uncertainty)
                if "refused" in value:
                    refused.setdefault(over, value["refused"])
        result = ThresholdResult(
            question,
            [
                _threshold(question, over, crossing, [errors[over, crossing.low], errors[over, crossing.high]])
                for over, values in computed.items()
                for crossing in crossings(values, axis, level)
            ],
            [
                ComputedPoint(over, x, quantity)
                for over, values in computed.items()
                for x, quantity in sorted(values.items())
            ],
            refused,
        )
        tables: dict[str, Any] = {TABLE: (Threshold, result.thresholds), POINTS: (ComputedPoint, result.points)}
        STUDY.write(directory, tables, {FIGURE: _figure(result)})
    return result


def _threshold(question: Question, over: Any, crossing: Crossing, errors: list[float | None]) -> Threshold:
    """Threshold of a crossing, from the quantity's uncertainties at both ends of its bracket."""
    uncertainty: float | None = 0.5 * (crossing.high - crossing.low)
    if question.uncertainty:
        sizes = [error for error in errors if error is not None]
        from_quantity = max(sizes) / abs(crossing.slope) if len(sizes) == 2 else None
        uncertainty = None if from_quantity is None else 0.5 * (crossing.high - crossing.low) + from_quantity
    edges = {name: value for name, value in vars(crossing).items() if name != "slope"}
    return Threshold(over, question.axis.middle(crossing.low, crossing.high), uncertainty, **edges)


def _figure(result: ThresholdResult) -> "Figure":
    from granchain.parts import studies  # matplotlib takes half a second to import

    question = result.question
    quantity, field = axes.label(question.quantity, question.scene), axes.label(question.field, question.scene)
    if question.over.is_numeric and result.thresholds:
        lines: list[tuple[Any, float | None, float | None]] = []
        for over, thresholds in result.by_over().items():
            lines += [(over, threshold.place, threshold.uncertainty) for threshold in thresholds]
            lines += [] if thresholds else [(over, None, None)]  # a tick at the foot
        over, place, error = map(studies.floats, zip(*lines, strict=True))
        unit = "" if quantity.unit in ("", units.REDUCED) else f" {quantity.unit}"
        named = f"${quantity.symbol}$" if quantity.symbol else quantity.words
        comma = "," if field.symbol else ""
        crossing = replace(field, words=f"{field.words} where {named} = {question.level:g}{unit}{comma}")
        over_field = studies.StudyAxis(axes.label(question.over.name, question.scene), over)
        return studies.swept_figure(studies.StudyAxis(crossing, place, error), over_field, title=question.source)
    values = studies.StudyAxis(quantity, studies.floats([point.quantity for point in result.points]))
    over_field = studies.StudyAxis(field, studies.floats([point.value for point in result.points]))
    beside = question.over.axis([point.over for point in result.points], question.scene)
    if beside is not None and len(question.over.values) > studies.MOST_LINES:
        return studies.map_figure(values, over_field, beside, question.source)
    places, errors = (
        studies.floats([getattr(threshold, name) for threshold in result.thresholds])
        for name in ("place", "uncertainty")
    )
    return studies.swept_figure(
        values, over_field, beside, question.source, sought=studies.Sought(question.level, places, errors)
    )


# --- command ----------------------------------------------------------------------------------------------------------

ANSWERS = "the thresholds, and how many scenes were computed"
DRAWS = True
EXAMPLES = (
    "threshold two-chains --where agree_1=50 --vary coupling.stiffness=0.02:0.5 --log -o found",
    "threshold two-chains --where agree_1=50 --vary coupling.stiffness=0.02:0.5 --log --over chains=2,3,4 -o curve",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("scene", metavar="SCENE", help="the scene; its other fields are constant")
    parser.add_argument(
        "--where", metavar="QUANTITY=VALUE", required=True, help="a quantity of `granchain collect`, in its units"
    )
    parser.add_argument("--vary", metavar="FIELD=LOW:HIGH", required=True, help="the varied field, and its range")
    parser.add_argument("--log", action="store_true", help="divide the range by factors instead of differences")
    parser.add_argument("--over", metavar="FIELD=A,B,...", help="one threshold for each value of a second field")
    words = ("values of the first scan (default 9)", "largest half-width of a bracket / its place (default 0.001)")
    parser.add_argument(
        "--points", metavar="N", type=options.within(int, 2, 10_000), default=SearchedField.points, help=words[0]
    )
    bounds = options.within(float, 1e-12, 0.5)
    parser.add_argument("--tolerance", metavar="X", type=bounds, default=SearchedField.tolerance, help=words[1])
    options.add_output(parser)
    options.add_jobs(parser)


def execute(arguments: argparse.Namespace) -> screen.CommandResult:
    """Print the thresholds; exit code 1 without any, 130 when interrupted, with all that was computed kept."""
    question = _question(arguments)
    try:
        result = carry_out(question, arguments.output, arguments.jobs)
    except KeyboardInterrupt:
        return options.interrupted()
    _print(result, arguments.output)
    return screen.CommandResult(0 if result.thresholds else 1, result.plain())


def _question(arguments: argparse.Namespace) -> Question:
    plain = library.find(arguments.scene).plain()
    quantity, level = options.split(arguments.where, "--where", "agree_1=50")
    field, ends = options.split(arguments.vary, "--vary", "coupling.stiffness=0.02:0.5")
    over = options.second_field(arguments.over)
    low, high = options.both_ends(ends, "--vary", "FIELD=0.02:0.5")
    wanted_level = quantity, options.number(level, "--where", "agree_1=50")
    axis = SearchedField(low, high, arguments.log, points=arguments.points, tolerance=arguments.tolerance)
    return question_of(arguments.scene, plain, wanted_level, field, axis, over)


def question_of(
    name: str,
    plain: dict[str, Any],
    where: tuple[str, float],
    field: str,
    axis: SearchedField,
    over: options.SecondField,
) -> Question:
    """The question where a quantity of a scene crosses a value.

    Args:
        name: name of the scene in messages.
        plain: its plain data.
        where: name of the quantity, and the value.
        field: the varied field.
        axis: its range, and how that is searched; whole numbers alone where the field takes no others.
        over: a second field and its values.

    Raises:
        InputError: there is no such quantity or field, or the range is none.
    """
    (quantity, level), low, high = where, axis.low, axis.high
    ends = f"{low:g}:{high:g}"
    try:
        integer = fields.is_whole(fields.parse(field, plain))
    except InputError as error:
        raise InputError(f"--vary: {error}") from None
    if not low < high or (axis.log and low <= 0.0):
        above = ", both above 0 with --log" if axis.log else ""
        raise InputError(f"--vary: {ends} given; the smaller number first{above}, such as 0.02:0.5")
    if integer and not (float(low).is_integer() and float(high).is_integer()):
        raise InputError(f"--vary: {field} takes whole numbers; {ends} given")
    return Question(name, plain, quantity, level, field, replace(axis, integer=integer), over)


def _print(result: ThresholdResult, output: Path) -> None:
    question = result.question
    if result.thresholds:
        head = [axes.heading(name, question.scene) for name in (question.over.name, question.field) if name]
        quantity = axes.heading(question.quantity, question.scene)
        screen.print_table(
            f"{screen.one_line(question.source)}: where {quantity} crosses {question.level:g}",
            [*head, "uncertainty", "from", "to", question.quantity, ""],
            [
                [screen.cell(threshold.over)] * bool(question.over.name) + _row(threshold)
                for threshold in result.thresholds
            ],
        )
    for over, thresholds in result.by_over().items():
        if not thresholds:
            print(screen.one_line(result.missing(over)))
    print(f"{len(result.points)} scenes were computed; the error of the reference is not in the uncertainty")
    screen.print_files(output, (TABLE, POINTS, *STUDY.figure_files))


def _row(threshold: Threshold) -> list[str]:
    notes = ["both sides alternate"] * threshold.mixed + ["undefined between"] * threshold.undefined
    numbers = [
        screen.cell(threshold.place),
        screen.cell(threshold.uncertainty, ".2g"),
        screen.cell(threshold.low),
        screen.cell(threshold.high),
    ]
    return [*numbers, "rises" if threshold.rises else "falls", ", ".join(notes)]
