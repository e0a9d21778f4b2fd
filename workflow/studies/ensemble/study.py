"""Statistics of quantities of a scene over the seeds of its random ingredients.

An ensemble study: a scene with each of many seeds, by the reference integrator, and what is written.

| file                  | what                                                                                    |
|-----------------------|-----------------------------------------------------------------------------------------|
| ensemble.csv          | statistics: a line for each quantity and value of the second field                      |
| seeds.csv             | the quantities of every seed                                                            |
| ensemble-QUANTITY.png | mean and bands over the second field; without one the distribution                      |
| evaluations.jsonl     | the cache: every scene that was computed, as it was done                                |
"""

import argparse
import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from lammps_inputs import InputError, Scene, library
from lammps_inputs.units import Label
from workflow.formats import figure_files
from workflow.screen import Answer, cell, one_line, print_table
from workflow.studies import options
from workflow.studies.measures import case, heading, label, refuse_unknown, scene_to_run
from workflow.studies.study import Study, csv_text, floats
from workflow.sweep import fields
from workflow.sweep.file import MAX_CASES

if TYPE_CHECKING:
    from matplotlib.figure import Figure

TABLE, SEEDS = "ensemble.csv", "seeds.csv"
STUDY = Study("ensemble", f"{TABLE} is the table", tables=(TABLE, SEEDS), cache="evaluations.jsonl")

APART = 2**48
"""Between the seeds of two random ingredients; seeds are below 2**32."""

NORMAL = 1.96
"""Half of the 95 % interval of a normal distribution, in standard deviations."""


@dataclass(frozen=True)
class Statistics:
    """Of the seeds at which the quantity is defined.

    Attributes:
        values: number of these.
        undefined: number of all others, which nothing else here includes.
        mean: None without a value.
        standard_error: of the mean, ``standard_deviation / sqrt(values)``.
        interval_95: half-width of the 95 % confidence interval of the mean, 1.96 standard errors: the normal
            approximation, which is too narrow for few values (by 13 % for ten).
        standard_deviation: of the values, with ``values - 1``; None for fewer than two, as what follows from it.
        q2_5, q16, q50, q84, q97_5: quantiles in %, interpolated linearly between the ordered values, which are the
            ends of the range for quantiles beyond them; None without a value.
        seeds_needed: least number of seeds with which ``interval_95`` is at most the wished share of the mean, if
            as large a share of them has a value; None where the mean is 0.
    """

    values: int
    undefined: int
    mean: float | None = None
    standard_error: float | None = None
    interval_95: float | None = None
    standard_deviation: float | None = None
    q2_5: float | None = None
    q16: float | None = None
    q50: float | None = None
    q84: float | None = None
    q97_5: float | None = None
    seeds_needed: int | None = None


def statistics(values: Sequence[float | None], precision: float) -> Statistics:
    """Of one value a seed, None where it is undefined.

    Args:
        values: of the quantity.
        precision: wished half-width of the 95 % interval of the mean over the mean.
    """
    found = np.array([value for value in values if value is not None], dtype=np.float64)
    count, undefined = len(found), len(values) - len(found)
    if not count:
        return Statistics(count, undefined)
    mean = float(found[0] + np.mean(found - found[0]))  # exact where all are the same
    error = interval = deviation = needed = None
    if count > 1:
        deviation = float(np.std(found - found[0], ddof=1))
        error = deviation / math.sqrt(count)
        interval = NORMAL * error
        if mean != 0.0:
            one = max(2.0, (NORMAL * deviation / (precision * mean)) ** 2)
            needed = math.ceil(one * len(values) / count)
    q2_5, q16, q50, q84, q97_5 = np.quantile(found, (0.025, 0.16, 0.5, 0.84, 0.975)).tolist()
    return Statistics(count, undefined, mean, error, interval, deviation, q2_5, q16, q50, q84, q97_5, needed)


@dataclass(frozen=True)
class Question:
    """Quantities of a scene with random ingredients, over their seeds.

    Attributes:
        source: what the scene is called in messages.
        scene: its plain data.
        quantities: by the names of `workflow.studies.measures`.
        seeds: of the random ingredients of the scene.
        precision: wished half-width of the 95 % interval of a mean over the mean.
        over: a second field, one ensemble for each of its values.
    """

    source: str
    scene: dict[str, Any]
    quantities: tuple[str, ...]
    seeds: range
    precision: float = 0.01
    over: options.SecondField = options.NO_SECOND_FIELD

    def scenes(self, over: Any) -> list[dict[str, Any]]:
        """Plain data of the scene with a value in the second field, for each seed.

        The n-th random ingredient, from 0, has the seed plus n times `APART`, lest two draw the same numbers.

        Raises:
            InputError: it is no scene, nothing in it is random, or the second field is a seed.
        """
        plain, name = self.over.put(self.scene, over), self.over.name
        scene_to_run(plain, self.quantities, f"{self.source}: {name} = {over}" if name else self.source)
        random = [field for field in fields.all_fields(Scene) if field.endswith(".seed") and _takes(plain, field)]
        if not random:
            raise InputError(f"{self.source}: has no random ingredient; add one, such as `disorder: {{mass: 0.2}}`")
        if name in random:
            raise InputError(f"{self.source}: --over {name}: is what --seeds varies")
        return [fields.put_all(plain, {one: seed + APART * n for n, one in enumerate(random)}) for seed in self.seeds]

    @property
    def files(self) -> dict[str, str]:
        """Quantity -> name of its figure."""
        return {name: f"ensemble-{name.replace('@', '-at-')}" for name in self.quantities}

    def __post_init__(self) -> None:
        for name in self.quantities:
            refuse_unknown(name, self.source, "quantity of an ensemble")


def _takes(scene: dict[str, Any], name: str) -> bool:
    """Whether a part that a scene has is random: one that takes a seed."""
    path = fields.parse(name)
    if not isinstance(fields.look_up(scene, path[:-1]), dict):
        return False
    try:
        library.from_plain(fields.put(scene, path, 0), name)
    except InputError:
        return False
    return True


@dataclass(frozen=True)
class Found:
    """Result of a study.

    Attributes:
        question: what was asked.
        statistics: (quantity, value of the second field) -> what its seeds give.
        seeds: a row a scene: ``over``, ``seed``, and each quantity, None where it is undefined.
        refused: why the first scene that could not be computed is none; empty if all could.
    """

    question: Question
    statistics: dict[tuple[str, Any], Statistics]
    seeds: list[dict[str, Any]]
    refused: str

    @property
    def defined(self) -> list[str]:
        """Quantities that any seed has a value of, which are drawn."""
        return [name for name in self.question.quantities if any(row[name] is not None for row in self.seeds)]

    def rows(self) -> list[dict[str, Any]]:
        """A row a quantity and value of the second field."""
        return [{"quantity": name, "over": over, **asdict(one)} for (name, over), one in self.statistics.items()]

    def plain(self) -> dict[str, Any]:
        """For scripts."""
        asked = self.question
        seeds, over = [asked.seeds[0], asked.seeds[-1]], asked.over.name or None
        return {"seeds": seeds, "precision": asked.precision, "over": over, "statistics": self.rows()}


# --- carried out ------------------------------------------------------------------------------------------------------


def carry_out(question: Question, directory: Path, jobs: int | None = None) -> Found:
    """Compute all scenes, on all cores; what a directory holds of an earlier start is not computed again.

    Args:
        question: what is asked.
        directory: made if need be.
        jobs: scenes at a time; None for all cores.

    Raises:
        InputError: the directory cannot be used.
        RunError: a process was killed.
    """
    names, places = question.quantities, question.over.values
    scenes = [scene for over in places for scene in question.scenes(over)]
    cases = [case(scene, names, question.source) for scene in scenes]
    with replace(STUDY, figures=tuple(question.files.values())).evaluating(directory, jobs) as values:
        answers = values(cases)
        plan = [(over, seed) for over in places for seed in question.seeds]
        seeds = [
            {"over": over, "seed": seed, **{name: answer.get("quantities", {}).get(name) for name in names}}
            for (over, seed), answer in zip(plan, answers, strict=True)
        ]
        found = Found(
            question,
            {
                (name, over): statistics([row[name] for row in seeds if row["over"] == over], question.precision)
                for name in names
                for over in places
            },
            seeds,
            next((answer["refused"] for answer in answers if "refused" in answer), ""),
        )
        head = {name: heading(name, question.scene) for name in names}
        tables = {
            TABLE: csv_text([{**row, "quantity": head[row["quantity"]]} for row in found.rows()]),
            SEEDS: csv_text([{head.get(name, name): value for name, value in row.items()} for row in seeds]),
        }
        STUDY.write(directory, tables, {question.files[name]: _figure(found, name) for name in found.defined})
    return found


def _figure(found: Found, name: str) -> "Figure":
    """Mean and bands over the second field; where that is none of numbers, the share of values below each."""
    from analysis.figures.studies import Axis, swept_figure  # matplotlib takes half a second to import

    asked = found.question
    quantity, title = label(name, asked.scene), f"{asked.source}: {len(asked.seeds)} seeds"
    if asked.over.is_numeric:
        of = [found.statistics[name, over] for over in asked.over.values]
        mean, error, *ends = (
            floats([getattr(one, key) for one in of]) for key in ("mean", "interval_95", "q2_5", "q97_5", "q16", "q84")
        )
        bands = (np.array(ends[:2]), np.array(ends[2:]))
        over = Axis(label(asked.over.name, asked.scene), floats(asked.over.values))
        title = f"{title}; bars: 95 % interval of the mean; bands: quantiles 2.5, 16, 84 and 97.5 %"
        return swept_figure(Axis(quantity, mean, error, bands=bands), over, title=title)
    rows = sorted((row for row in found.seeds if row[name] is not None), key=lambda row: float(row[name]))
    values, share = floats([row[name] for row in rows]), np.zeros(len(rows))
    for over in asked.over.values:
        own = [k for k, row in enumerate(rows) if row["over"] == over]
        share[own] = np.searchsorted(values[own], values[own]) / max(len(own), 1)
    numbered = asked.over.axis([row["over"] for row in rows], asked.scene)
    return swept_figure(Axis(Label("share of defined values below"), share), Axis(quantity, values), numbered, title)


# --- command ----------------------------------------------------------------------------------------------------------

ANSWERS = "the statistics, and the seeds"
DRAWS = True
EXAMPLES = (
    "ensemble disordered-chain --seeds 0:199 --quantity peak_velocity@100 -o found",
    "ensemble disordered-chain --seeds 0:99 --over disorder.mass=0.05,0.1,0.2,0.4 --quantity participation -o spread",
)

_HEADS = {
    "values": "values",
    "undefined": "undefined",
    "mean": "mean",
    "interval_95": "+- (95 %)",
    "standard_error": "standard error",
    "standard_deviation": "standard deviation",
    "seeds_needed": "",
}
"""Statistic -> head in the printed table; the last says which precision needs so many seeds."""

_QUANTILES = {"q2_5": "2.5 %", "q16": "16 %", "q50": "50 %", "q84": "84 %", "q97_5": "97.5 %"}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The ensemble, where to, and how."""
    parser.add_argument(
        "scene", metavar="SCENE", help="the scene, with `disorder` or random contacts; its other fields are constant"
    )
    parser.add_argument("--seeds", metavar="FIRST:LAST", required=True, help="the seeds, both ends included")
    parser.add_argument(
        "--quantity",
        metavar="NAME",
        action="append",
        help="of `granchain collect`, or of the leading wave at a bead: peak_velocity@100; several times for several "
        "(default peak_velocity)",
    )
    parser.add_argument("--over", metavar="FIELD=A,B,...", help="one ensemble for each value of a second field")
    parser.add_argument(
        "--precision",
        metavar="X",
        type=options.within(float, 1e-9, 1.0),
        default=0.01,
        help="wished half-width of the 95%% interval / the mean, to say how many seeds it needs (default 0.01)",
    )
    options.add_output(parser)
    options.add_jobs(parser)


def execute(arguments: argparse.Namespace) -> Answer:
    """Print the statistics; exit code 1 without any value, 130 when interrupted, with all that was computed kept."""
    question = _question(arguments)
    try:
        found = carry_out(question, arguments.output, arguments.jobs)
    except KeyboardInterrupt:
        return options.interrupted()
    _print(found, arguments.output)
    return Answer(0 if found.defined else 1, found.plain())


def _question(arguments: argparse.Namespace) -> Question:
    first, last = options.both_ends(arguments.seeds, "--seeds", "0:199")
    if not (first.is_integer() and last.is_integer() and 0 <= first <= last < 2**32 and last - first < MAX_CASES):
        raise InputError(f"--seeds: {arguments.seeds} given; whole numbers, the smaller one first, such as 0:199")
    return Question(
        arguments.scene,
        library.find(arguments.scene).plain(),
        tuple(dict.fromkeys(arguments.quantity or ["peak_velocity"])),
        range(int(first), int(last) + 1),
        arguments.precision,
        options.second_field(arguments.over),
    )


def _print(found: Found, output: Path) -> None:
    asked = found.question
    needed = f"seeds for {100.0 * asked.precision:g} %"
    seeds = f"seeds {asked.seeds[0]} to {asked.seeds[-1]}"
    for name in asked.quantities:
        title = f"{one_line(asked.source)}: {heading(name, asked.scene)}"
        for heads, what in ((_HEADS, seeds), (_QUANTILES, "quantiles")):
            rows = [
                [cell(over)] * bool(asked.over.name) + [cell(getattr(one, key)) for key in heads]
                for (quantity, over), one in found.statistics.items()
                if quantity == name
            ]
            head = [*(heading(field, asked.scene) for field in [asked.over.name] if field), *heads.values()]
            print_table(f"{title}, {what}", [word or needed for word in head], rows)
    if found.refused:
        print(one_line(f"some scenes cannot be computed: {found.refused}"))
    files = ", ".join((TABLE, SEEDS, *figure_files(*(asked.files[name] for name in found.defined))))
    print(f"{len(found.seeds)} scenes computed; {one_line(output)}: {files}")
