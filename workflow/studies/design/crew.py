"""Evaluations on all cores, each remembered as it is done."""

import contextlib
import os
import signal
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import as_completed
from typing import Any

from lammps_inputs import InputError, library
from workflow.studies.design.file import Design
from workflow.studies.design.measures import MASS, evaluated, mass_of
from workflow.studies.design.memory import Memory, Record, key_of
from workflow.studies.design.variables import scene_with
from workflow.studies.spawned import SpawnPool
from workflow.sweep.worker import die_with_parent

Tell = Callable[[Record], None]
"""Called with every record as it is asked for, or done."""


def _begin(parent: int) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent ends them
    die_with_parent(parent)


class Crew:
    """Processes that evaluate designs, and what they found.

    Args:
        design: what is evaluated.
        memory: where it is kept.
        processes: how many; with 1 all is done in this process.
        tell: called after each.
    """

    def __init__(self, design: Design, memory: Memory, processes: int, tell: Tell | None = None) -> None:
        self.design, self.memory, self.tell = design, memory, tell
        self._pool: SpawnPool | None = None
        if processes > 1:
            self._pool = SpawnPool(processes, initializer=_begin, initargs=(os.getpid(),))

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
        missing = {
            key: entry
            for key, entry in wanted.items()
            if self.memory.known(key, self._needed(entry[1], whole=whole)) is None
        }
        for key, record in self._computed(missing, whole=whole):
            self.memory.add(key, record)
            if self.tell is not None:
                self.tell(record)
        return [self.memory.records[key] for key in keys]

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

    def _computed(
        self, missing: dict[str, tuple[dict[str, Any], dict[str, Any]]], *, whole: bool
    ) -> Iterator[tuple[str, Record]]:
        runs = []
        for key, (values, scene) in missing.items():
            names = self._needed(scene, whole=whole)
            if names == (MASS,):
                mass = mass_of(library.from_plain(scene, self.design.source))
                yield key, Record(values, {MASS: mass}, "", 0.0)
            else:
                runs.append((key, values, scene, names))
        if self._pool is None:
            for key, values, scene, names in runs:
                yield key, _record(values, evaluated(scene, names, self.design.source))
            return
        futures = {
            self._pool.submit(evaluated, scene, names, self.design.source): (key, values)
            for key, values, scene, names in runs
        }
        for future in as_completed(futures):
            key, values = futures[future]
            yield key, _record(values, future.result())

    def close(self) -> None:
        """End the processes; what is under way is lost."""
        if self._pool is None:
            return
        processes = list((self._pool._processes or {}).values())
        self._pool.shutdown(wait=False, cancel_futures=True)
        for process in processes:
            with contextlib.suppress(OSError, AttributeError):
                process.terminate()
        for process in processes:
            process.join()
        self._pool.shutdown()  # its thread has seen them end


def _record(values: dict[str, Any], answer: dict[str, Any]) -> Record:
    return Record(values, answer.get("quantities", {}), answer.get("refused", ""), answer["seconds"])
