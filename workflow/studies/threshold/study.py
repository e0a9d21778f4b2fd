"""A threshold study: scans of the field, brackets that are halved, and what is written.

| file              | what                                                                     |
|-------------------|--------------------------------------------------------------------------|
| threshold.csv     | a line for each place where the quantity crosses the value               |
| points.csv        | the quantity at every computed value of the field                        |
| threshold.png     | the quantity over the field; with a second field the place over that     |
| evaluations.jsonl | the cache: every scene that was computed, as it was done                 |
"""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lammps_inputs import InputError
from workflow.studies.measures import case, heading, refuse_unknown
from workflow.studies.study import Study, floats, to_csv
from workflow.studies.threshold.bracket import Axis, Crossing, crossings, wanted
from workflow.sweep import fields
from workflow.sweep.collect import UNCERTAINTIES
from workflow.workers import evaluate
from workflow.workers.pool import Pool

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
        source: what the scene is called in messages.
        scene: its plain data.
        quantity: by the name of a sweep's table.
        level: the value, in the scene's units.
        field: what varies.
        axis: where it varies.
        over: a second field; empty without one.
        places: its values, one threshold for each.
    """

    source: str
    scene: dict[str, Any]
    quantity: str
    level: float
    field: str
    axis: Axis
    over: str = ""
    places: tuple[Any, ...] = ()

    @property
    def lines(self) -> tuple[Any, ...]:
        """Values of the second field; one of no meaning without one."""
        return self.places if self.over else (None,)

    @property
    def names(self) -> tuple[str, ...]:
        """The quantity, and its uncertainty where it has one."""
        return (self.quantity, *filter(None, [UNCERTAINTIES.get(self.quantity)]))

    def scene_at(self, value: float, over: Any) -> dict[str, Any]:
        """Plain data of the scene with values in both fields."""
        number = int(value) if self.axis.whole else value
        return fields.put_all(self.scene, {**({self.over: over} if self.over else {}), self.field: number})

    def __post_init__(self) -> None:
        refuse_unknown(self.quantity, self.source, "quantity of a threshold")
        names = [name for name in (self.field, self.over) if name]
        if len({fields.parse(name, self.scene) for name in names}) < len(names):
            raise InputError(f"{self.source}: --over {self.over}: is the field whose threshold is searched")


@dataclass(frozen=True)
class Threshold:
    """A place where the quantity crosses the value.

    Attributes:
        over: value of the second field; None without one.
        place: of the field, the middle of its bracket.
        uncertainty: half the bracket's width, plus the quantity's own uncertainty over its slope where it has one; None
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
class Point:
    """A computed scene: values of the second field and of the field, and the quantity, None where it is undefined."""

    over: Any
    value: float
    quantity: float | None


@dataclass(frozen=True)
class Found:
    """Result of a study.

    Attributes:
        question: what was asked.
        thresholds: all places, by the second field and the field.
        points: all computed scenes, in that order.
        refused: why the first scene that could not be computed is none; empty if all could.
    """

    question: Question
    thresholds: list[Threshold]
    points: list[Point]
    refused: str

    def plain(self) -> dict[str, Any]:
        """For scripts."""
        asked = self.question
        return {
            "quantity": asked.quantity,
            "value": asked.level,
            "field": asked.field,
            "over": asked.over or None,
            "thresholds": [vars(one) for one in self.thresholds],
            "computed": len(self.points),
        }

    def missing(self, over: Any) -> str:
        """Why there is no threshold at a value of the second field, in one line; empty where there is one."""
        if any(one.over == over for one in self.thresholds):
            return ""
        asked = self.question
        at = f" at {asked.over} = {over}" if asked.over else ""
        values = [point.quantity for point in self.points if point.over == over]
        found = [value for value in values if value is not None]
        where = f"at {len(values)} values of {asked.field} from {asked.axis.low:g} to {asked.axis.high:g}{at}"
        if not found:
            refused = f" ({self.refused})" if self.refused else ""
            return f"no threshold: {asked.quantity} is undefined {where}{refused}"
        undefined = f", undefined at {len(values) - len(found)}" if len(found) < len(values) else ""
        return (
            f"no threshold: {asked.quantity} does not cross {asked.level:g}: {min(found):.6g} to {max(found):.6g} "
            f"{where}{undefined}"
        )


def carry_out(
    question: Question, directory: Path, *, pool: Pool | None = None, progress: evaluate.Progress | None = None
) -> Found:
    """Find all places, on all cores; what a directory holds of an earlier start is not computed again.

    Args:
        question: what is asked.
        directory: made if need be.
        pool: worker processes; by default as many as there are cores.
        progress: called with the scenes computed, how many are planned so far, and how many are undefined.

    Raises:
        InputError: the directory cannot be used.
        RunError: a process was killed.
    """
    computed: dict[Any, dict[float, dict[str, float | None]]] = {over: {} for over in question.lines}
    refused: list[str] = []

    def known(over: Any) -> dict[float, float | None]:
        return {x: quantities.get(question.quantity) for x, quantities in computed[over].items()}

    with STUDY.opened(directory) as cache:
        while plan := [
            (over, x) for over in question.lines for x in wanted(known(over), question.axis, question.level)
        ]:
            done = sum(map(len, computed.values()))

            def show(now: int, total: int, _: int, done: int = done) -> None:
                if progress is not None:
                    progress(done + now, done + total, 0)

            cases = [case(question.scene_at(x, over), question.names, question.source) for over, x in plan]
            for (over, x), value in zip(plan, evaluate.values(cases, cache, pool=pool, progress=show), strict=True):
                computed[over][x] = value.get("quantities", {})
                refused += [value["refused"]] if "refused" in value else []
        found = Found(
            question,
            [
                _threshold(question, over, one, computed[over])
                for over in question.lines
                for one in crossings(known(over), question.axis, question.level)
            ],
            [Point(over, x, quantity) for over in question.lines for x, quantity in sorted(known(over).items())],
            "".join(refused[:1]),
        )
        tables = {TABLE: to_csv(Threshold, found.thresholds), POINTS: to_csv(Point, found.points)}
        STUDY.write(directory, tables, {FIGURE: _figure(found)})
    return found


def _threshold(
    question: Question, over: Any, crossing: Crossing, computed: dict[float, dict[str, float | None]]
) -> Threshold:
    low, high = crossing.low, crossing.high
    uncertainty: float | None = 0.5 * (high - low)
    if len(question.names) > 1:
        own = [computed[x].get(question.names[-1]) for x in (low, high)]
        sizes = [one for one in own if one is not None]
        uncertainty = None if len(sizes) < len(own) else 0.5 * (high - low) + max(sizes) / abs(crossing.slope)
    edges = {name: value for name, value in vars(crossing).items() if name != "slope"}
    return Threshold(over, question.axis.middle(low, high), uncertainty, **edges)


def _figure(found: Found) -> "Figure":
    from analysis.figures.swept import Axis as Shown  # matplotlib takes half a second to import
    from analysis.figures.swept import swept_figure

    asked = found.question
    title = f"{asked.source}: {asked.quantity} = {asked.level:g}"
    field = heading(asked.field, asked.scene)
    if asked.over and all(isinstance(over, int | float) for over in asked.places):
        lines: list[tuple[Any, float | None, float | None]]
        lines = [(one.over, one.place, one.uncertainty) for one in found.thresholds]
        # a value without a threshold is a tick at the foot
        lines += [(over, None, None) for over in asked.places if not any(one[0] == over for one in lines)]
        over, place, error = map(floats, zip(*sorted(lines, key=lambda line: asked.places.index(line[0])), strict=True))
        return swept_figure(Shown(field, place, error), Shown(heading(asked.over, asked.scene), over), title=title)
    values, quantity = (floats([getattr(point, name) for point in found.points]) for name in ("value", "quantity"))
    second = None
    if asked.over:
        numbers = floats([asked.places.index(point.over) + 1 for point in found.points])
        second = Shown(f"value of {asked.over}, by its number", numbers)
    return swept_figure(Shown(heading(asked.quantity, asked.scene), quantity), Shown(field, values), second, title)
