"""Evaluate the cases of a study: each once, side by side, with what an earlier start has found taken from a cache.

A case is a function's name and its arguments as plain data (`Task`), under the key that its value is kept by. A study
that plans its cases in advance calls `evaluate` or `values` once; a search calls it for each generation, with one pool.

Plug-ins take this module for the cases of studies: `case` makes a `Computation` of a function and its arguments,
`key_of` a key of plain data; `Study.evaluating` computes them, or `evaluate` without a directory.

Examples:
    >>> cases = [computations.case("statistics:fmean", {"data": data}) for data in ([1.0, 2.0], [3.0, 5.0])]
    >>> computations.values(cases)  # each in a worker process
    [1.5, 4.0]
    >>> cases[0].key == computations.key_of({"data": [1.0, 2.0]})
    True
"""

import contextlib
import hashlib
import json
import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from lammps_inputs import InputError
from workflow.errors import RunError
from workflow.workers.pool import Pool, Task, TaskResult

# --- results ----------------------------------------------------------------------------------------------------------


def key_of(request: Any) -> str:
    """Key of a request: equal requests have equal keys.

    Args:
        request: plain data.

    Returns:
        The key, of 20 hexadecimal digits.
    """
    return hashlib.sha256(json.dumps(request, sort_keys=True).encode()).hexdigest()[:20]


class StoredResults(dict[str, Any]):
    """Key -> result as plain data; `keep` writes it to the disk at once.

    Args:
        path: read if it is there, and added to; a line that a kill cut short is dropped. None keeps nothing.

    Raises:
        InputError: it cannot be read or written.
    """

    def __init__(self, path: Path | None) -> None:
        super().__init__()
        self._file = None
        if path is None:
            return
        try:
            text = path.read_bytes() if path.is_file() else b""
            complete = text[: text.rfind(b"\n") + 1]
            if len(complete) < len(text):
                os.truncate(path, len(complete))
            self._file = path.open("a", encoding="utf-8")
        except OSError as error:
            raise InputError(f"{path}: cannot be used ({error.strerror})") from None
        for line in complete.splitlines():
            self._take(line)

    def _take(self, line: bytes) -> None:
        try:
            data = json.loads(line)
            self[str(data["key"])] = data["result"]
        except (ValueError, TypeError, KeyError, RecursionError):
            return  # not ours

    def keep(self, key: str, result: Any) -> None:
        """Add a result."""
        self[key] = result
        if self._file is not None:
            self._file.write(json.dumps({"key": key, "result": result}) + "\n")
            self._file.flush()

    def __enter__(self) -> "StoredResults":
        return self

    def __exit__(self, *_: object) -> None:
        if self._file is not None:
            self._file.close()


# --- evaluate ---------------------------------------------------------------------------------------------------------

Progress = Callable[[int, int, int], None]
"""Called with the cases done, their total, and how many of them failed."""

Tell = Callable[[str, TaskResult], None]
"""Called with the key and the answer of each case that was computed, as it is done."""


Failed = Callable[[TaskResult], bool]
"""Whether progress counts an answer as failed."""


def _has_failed(answer: TaskResult) -> bool:
    return bool(answer.failed)


class Computation(NamedTuple):
    """One computation of a study.

    Attributes:
        key: the same for the same computation.
        task: what computes it.
        cost: work in proportion to that of the other cases; the largest begin first, so that no core ends up with one
            long case alone.
        alone: whether it uses all cores itself, and so waits until the others are done.
    """

    key: str
    task: Task
    cost: float = 0.0
    alone: bool = False


def case(
    function: str, arguments: dict[str, Any], *, key: str = "", cost: float = 0.0, alone: bool = False
) -> Computation:
    """Computation of a function at arguments.

    Args:
        function: ``module:name`` of the function, which a worker process imports.
        arguments: plain data that it is called with, by name.
        key: key of the value in a cache; by default it follows from the arguments.
        cost: work, in proportion to that of the other cases.
        alone: whether it uses all cores itself.

    Returns:
        The computation.
    """
    return Computation(key or key_of(arguments), Task(function, arguments), cost, alone)


def evaluate(
    cases: Sequence[Computation],
    cache: StoredResults | None = None,
    *,
    pool: Pool | None = None,
    progress: Progress | None = None,
    tell: Tell | None = None,
    failed: Failed = _has_failed,
) -> dict[str, TaskResult]:
    """The answer to each case by its key; values are added to the cache at once, so that an interruption loses none.

    Args:
        cases: of which those of one key are computed once.
        cache: values of earlier starts; without it, nothing is kept.
        pool: worker processes that stay open; by default as many as there are cores, ended with the last case.
        progress: called before the first case and after each.
        tell: called after each case that was computed; an exception that it raises ends the evaluation.
        failed: which answers progress counts as failed; by default those without a value.

    Returns:
        Key -> answer, whose ``failed`` says why there is no value.
    """
    wanted = {computation.key: computation for computation in cases}
    stored = StoredResults(None) if cache is None else cache
    answers = {key: TaskResult(stored[key]) for key in wanted if key in stored}
    missing = sorted(
        (computation for key, computation in wanted.items() if key not in answers),
        key=lambda computation: -computation.cost,
    )
    bad = sum(failed(answer) for answer in answers.values())
    if progress is not None:
        progress(len(answers), len(wanted), bad)
    for alone in (False, True):
        some = [(computation.key, computation.task) for computation in missing if computation.alone == alone]
        if not some:
            continue
        with contextlib.ExitStack() as stack:
            processes = 1 if alone else None
            workers = pool if pool and not alone else stack.enter_context(Pool(processes, interrupt=True))
            for key, answer in workers.answers(some):
                answers[key] = answer
                if not answer.failed:
                    stored.keep(key, answer.value)
                if tell is not None:
                    tell(key, answer)
                bad += failed(answer)
                if progress is not None:
                    progress(len(answers), len(wanted), bad)
    return answers


def values(
    cases: Sequence[Computation],
    cache: StoredResults | None = None,
    *,
    pool: Pool | None = None,
    progress: Progress | None = None,
    failed: Failed = _has_failed,
) -> list[Any]:
    """Values of cases none of which may fail, in their order; arguments as of `evaluate`.

    Raises:
        RunError: one failed; the others are ended.
    """
    answers = evaluate(cases, cache, pool=pool, progress=progress, tell=_refuse_failure, failed=failed)
    return [answers[computation.key].value for computation in cases]


def _refuse_failure(_: str, answer: TaskResult) -> None:
    if answer.failed:
        raise RunError(answer.failed)
