"""Evaluates designs on all cores, each once; what was computed is kept, also by an earlier start."""

import contextlib
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

from lammps_inputs import InputError, library
from workflow.errors import RunError
from workflow.studies.design.file import Design
from workflow.studies.measures import MASS, mass_of
from workflow.sweep import fields
from workflow.workers import evaluate
from workflow.workers.evaluate import Results, key_of
from workflow.workers.pool import Answer, Pool, Task


@dataclass(frozen=True)
class Record:
    """One design.

    Attributes:
        values: field -> value.
        quantities: name -> value, None where it has none; empty if refused.
        refused: why it is no scene; empty if it is one.
        seconds: processor time.
    """

    values: dict[str, Any]
    quantities: dict[str, float | None]
    refused: str
    seconds: float


Tell = Callable[[Record], None]
"""Called with every record as it is done."""


@dataclass(frozen=True)
class Evaluator:
    """Evaluates designs.

    Attributes:
        design: what is evaluated.
        results: where it is kept, by the design's scene.
        pool: worker processes.
        tell: called after each.
    """

    design: Design
    results: Results
    pool: Pool
    tell: Tell | None = None
    _records: dict[str, Record] = field(default_factory=dict)

    def all_of(self, designs: Sequence[dict[str, Any]], *, whole: bool = False) -> list[Record]:
        """Records of designs, each field -> value, in their order; each is computed once.

        Args:
            designs: which.
            whole: whether to run also those whose mass rules them out.

        Raises:
            RunError: a process was killed.
        """
        scenes = [fields.put_all(self.design.scene, values) for values in designs]
        wanted = {key_of(scene): (values, scene) for values, scene in zip(designs, scenes, strict=True)}
        cases = []
        for key, (values, scene) in wanted.items():
            names = self._needed(scene, whole=whole)
            if self._known(key, names):
                continue
            if names == (MASS,):
                mass = mass_of(library.from_plain(scene, self.design.source))
                self._keep(key, Record(values, {MASS: mass}, "", 0.0))
            else:
                arguments = {"plain": scene, "names": names, "source": self.design.source}
                cases.append(evaluate.Case(key, Task("workflow.studies.measures:evaluated", arguments)))

        def take(key: str, answer: Answer) -> None:
            if answer.failed:
                raise RunError(answer.failed)
            found = answer.value
            quantities, refused = found.get("quantities", {}), found.get("refused", "")
            self._keep(key, Record(wanted[key][0], quantities, refused, found["seconds"]))

        evaluate.evaluate(cases, pool=self.pool, tell=take)
        return [self._records.setdefault(key, Record(**self.results[key])) for key in map(key_of, scenes)]

    def _keep(self, key: str, record: Record) -> None:
        self.results.keep(key, asdict(record))
        self._records[key] = record
        if self.tell is not None:
            self.tell(record)

    def _known(self, key: str, names: tuple[str, ...]) -> bool:
        """Whether what is kept of a scene has what is asked for."""
        found = self.results.get(key)
        return found is not None and bool(found["refused"] or all(name in found["quantities"] for name in names))

    def _needed(self, scene: dict[str, Any], *, whole: bool) -> tuple[str, ...]:
        """Quantities to know: no more than the mass where that rules a design out."""
        limit = self.design.where.get(MASS)
        if limit is not None and not whole:
            with contextlib.suppress(InputError):
                if limit.violation(mass_of(library.from_plain(scene, self.design.source))) > 0.0:
                    return (MASS,)
        return self.design.names
