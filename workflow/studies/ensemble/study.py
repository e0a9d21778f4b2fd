"""An ensemble study: a scene with each of many seeds, by the reference integrator, and what is written.

| file                  | what                                                                                    |
|-----------------------|-----------------------------------------------------------------------------------------|
| ensemble.csv          | statistics: a line for each quantity and value of the second field                      |
| seeds.csv             | the quantities of every seed                                                            |
| ensemble-QUANTITY.png | mean and bands over the second field; without one the distribution                      |
| evaluations.jsonl     | the cache: every scene that was computed, as it was done                                |
"""

from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from lammps_inputs import InputError, Scene, library
from workflow.studies.ensemble.statistics import Statistics, statistics
from workflow.studies.measures import case, heading, refuse_unknown, scene_to_run
from workflow.studies.study import Study, csv_text, floats
from workflow.sweep import fields
from workflow.workers import evaluate
from workflow.workers.pool import Pool

if TYPE_CHECKING:
    from matplotlib.figure import Figure

TABLE, SEEDS = "ensemble.csv", "seeds.csv"
STUDY = Study("ensemble", f"{TABLE} is the table", tables=(TABLE, SEEDS), cache="evaluations.jsonl")

APART = 2**48
"""Between the seeds of two random ingredients; seeds are below 2**32."""


@dataclass(frozen=True)
class Question:
    """Quantities of a scene with random ingredients, over their seeds.

    Attributes:
        source: what the scene is called in messages.
        scene: its plain data.
        quantities: by the names of `workflow.studies.measures`.
        seeds: of the random ingredients of the scene.
        precision: wished half-width of the 95 % interval of a mean over the mean.
        over: a second field; empty without one.
        places: its values, one ensemble for each.
    """

    source: str
    scene: dict[str, Any]
    quantities: tuple[str, ...]
    seeds: range
    precision: float = 0.01
    over: str = ""
    places: tuple[Any, ...] = ()

    @property
    def lines(self) -> tuple[Any, ...]:
        """Values of the second field; one of no meaning without one."""
        return self.places if self.over else (None,)

    def scenes(self, over: Any) -> list[dict[str, Any]]:
        """Plain data of the scene with a value in the second field, for each seed.

        The n-th random ingredient, from 0, has the seed plus n times `APART`, lest two draw the same numbers.

        Raises:
            InputError: it is no scene, nothing in it is random, or the second field is a seed.
        """
        plain = fields.put_all(self.scene, {self.over: over} if self.over else {})
        where = f"{self.source}: {self.over} = {over}" if self.over else self.source
        scene_to_run(plain, self.quantities, where)
        random = [name for name in fields.all_fields(Scene) if name.endswith(".seed") and _takes(plain, name)]
        if not random:
            raise InputError(f"{self.source}: has no random ingredient; add one, such as `disorder: {{mass: 0.2}}`")
        if self.over in random:
            raise InputError(f"{self.source}: --over {self.over}: is what --seeds varies")
        return [fields.put_all(plain, {name: seed + APART * n for n, name in enumerate(random)}) for seed in self.seeds]

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
        seeds = [asked.seeds[0], asked.seeds[-1]]
        return {"seeds": seeds, "precision": asked.precision, "over": asked.over or None, "statistics": self.rows()}


def carry_out(
    question: Question, directory: Path, *, pool: Pool | None = None, progress: evaluate.Progress | None = None
) -> Found:
    """Compute all scenes, on all cores; what a directory holds of an earlier start is not computed again.

    Args:
        question: what is asked.
        directory: made if need be.
        pool: worker processes; by default as many as there are cores.
        progress: called with the scenes computed, and their number.

    Raises:
        InputError: the directory cannot be used.
        RunError: a process was killed.
    """
    study = replace(STUDY, figures=tuple(question.files.values()))
    scenes = [scene for over in question.lines for scene in question.scenes(over)]
    plan = [(over, seed) for over in question.lines for seed in question.seeds]
    cases = [case(scene, question.quantities, question.source) for scene in scenes]
    with study.opened(directory) as cache:
        answers = evaluate.values(cases, cache, pool=pool, progress=progress)
        seeds = [
            {
                "over": over,
                "seed": seed,
                **{name: answer.get("quantities", {}).get(name) for name in question.quantities},
            }
            for (over, seed), answer in zip(plan, answers, strict=True)
        ]
        found = Found(
            question,
            {
                (name, over): statistics([row[name] for row in seeds if row["over"] == over], question.precision)
                for name in question.quantities
                for over in question.lines
            },
            seeds,
            next((answer["refused"] for answer in answers if "refused" in answer), ""),
        )
        head = {name: heading(name, question.scene) for name in question.quantities}
        own = [{head.get(name, name): value for name, value in row.items()} for row in seeds]
        rows = [{**row, "quantity": head[row["quantity"]]} for row in found.rows()]
        figures = {question.files[name]: _figure(found, name) for name in found.defined}
        study.write(directory, {TABLE: csv_text(rows), SEEDS: csv_text(own)}, figures)
    return found


def _figure(found: Found, name: str) -> "Figure":
    """Mean and bands over the second field; where that is none of numbers, the share of seeds up to each value."""
    from analysis.figures.swept import Axis, swept_figure  # matplotlib takes half a second to import

    asked = found.question
    label, title = heading(name, asked.scene), f"{asked.source}: {len(asked.seeds)} seeds"
    if asked.over and all(isinstance(over, int | float) for over in asked.places):
        of = [found.statistics[name, over] for over in asked.places]
        mean, error, *ends = (
            floats([getattr(one, key) for one in of]) for key in ("mean", "interval_95", "q2_5", "q97_5", "q16", "q84")
        )
        bands = (np.array(ends[:2]), np.array(ends[2:]))
        over = Axis(heading(asked.over, asked.scene), floats(asked.places))
        title = f"{title}; bars: 95 % interval of the mean; bands: quantiles 2.5, 16, 84 and 97.5 %"
        return swept_figure(Axis(label, mean, error, bands=bands), over, title=title)
    rows = sorted((row for row in found.seeds if row[name] is not None), key=lambda row: float(row[name]))
    place = {over: [k for k, row in enumerate(rows) if row["over"] == over] for over in asked.lines}
    share = np.zeros(len(rows))
    for own in place.values():
        share[own] = np.arange(len(own)) / max(len(own), 1)
    numbers = floats([asked.places.index(row["over"]) + 1 for row in rows]) if asked.over else None
    beside = None if numbers is None else Axis(f"value of {asked.over}, by its number", numbers)
    return swept_figure(
        Axis("share of seeds below", share), Axis(label, floats([r[name] for r in rows])), beside, title
    )
