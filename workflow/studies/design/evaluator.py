"""Evaluates designs on all cores, each once; what was computed is kept, also by an earlier start."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

from lammps_inputs import InputError, library
from workflow.studies.design.file import Design
from workflow.studies.design.measures import MASS, evaluated, mass_of
from workflow.studies.design.variables import scene_with
from workflow.workers.pool import Pool, Task
from workflow.workers.results import Results, key_of


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
        pool: worker processes; with 1 all is done in this process.
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
        """
        wanted: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {}
        keys = []
        for values in designs:
            scene = scene_with(self.design.scene, values)
            key = key_of(scene)
            keys.append(key)
            wanted.setdefault(key, (values, scene))
        missing = {}
        for key, (values, scene) in wanted.items():
            names = self._needed(scene, whole=whole)
            if not self._known(key, names):
                missing[key] = (values, {"plain": scene, "names": names, "source": self.design.source})
        for key, record in self._computed(missing):
            self.results.keep(key, asdict(record))
            self._records[key] = record
            if self.tell is not None:
                self.tell(record)
        return [self._records.setdefault(key, Record(**self.results[key])) for key in keys]

    def _known(self, key: str, names: tuple[str, ...]) -> bool:
        """Whether what is kept of a scene has what is asked for."""
        found = self.results.get(key)
        return found is not None and bool(found["refused"] or all(name in found["quantities"] for name in names))

    def _needed(self, scene: dict[str, Any], *, whole: bool) -> tuple[str, ...]:
        """Quantities to know: no more than the mass where that rules a design out."""
        limit = self.design.where.get(MASS)
        if limit is not None and not whole:
            try:
                if limit.violation(mass_of(library.from_plain(scene, self.design.source))) > 0.0:
                    return (MASS,)
            except InputError:
                pass
        return self.design.names

    def _computed(self, missing: dict[str, tuple[dict[str, Any], dict[str, Any]]]) -> Iterator[tuple[str, Record]]:
        runs = {}
        for key, (values, request) in missing.items():
            if request["names"] == (MASS,):
                mass = mass_of(library.from_plain(request["plain"], self.design.source))
                yield key, Record(values, {MASS: mass}, "", 0.0)
            elif self.pool.processes == 1:
                yield key, _record(values, evaluated(**request))
            else:
                runs[key] = values
        tasks = ((key, Task("workflow.studies.design.measures:evaluated", missing[key][1])) for key in runs)
        for key, answer in self.pool.values(tasks):
            yield key, _record(runs[key], answer)


def _record(values: dict[str, Any], answer: dict[str, Any]) -> Record:
    return Record(values, answer.get("quantities", {}), answer.get("refused", ""), answer["seconds"])
