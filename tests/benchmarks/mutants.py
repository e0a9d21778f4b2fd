"""Mutants that the tests find: ``python tests/benchmarks/mutants.py --number 300 --seed 1 [--all] [--only PATH]``.

A mutant is the tree with one operator, comparison, constant or sign changed, also in the texts that the reference
compiles (``TEXTS``). Words, annotations, decorators and what an error says are left alone. Mutants are drawn at random
from all of `FOLDERS`, the same ones for the same seed and sources, and tested in a clone of the last commit; different
seeds may run beside each other.

Which tests execute which lines is measured by coverage.py (``pip install coverage``), by a run of the tests of README's
command, or of all of them, that is kept in the file ``--map``. A mutant meets first the tests in the folder that
mirrors its own, then the others that execute its line, and last the rest of their files, since fixtures and caches
execute lines for later tests; those that take the least time first, up to the first failure. A compiled line is not
traced: it has the tests of the reference.
"""

import argparse
import ast
import contextlib
import copy
import itertools
import json
import os
import random
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import pytest

ROOT = Path(__file__).parents[2]
FOLDERS = ("lammps_inputs/laws", "lammps_inputs/decks", "workflow/engines/reference", "workflow/measures")
FOLDERS += ("analysis/tracking", "analysis/sharing")
REFERENCE = "workflow/engines/reference/"
TEXTS = (f"{REFERENCE}template.py", f"{REFERENCE}kernel.py")
COMPILED = ("lammps_inputs/laws/", *TEXTS, f"{REFERENCE}common.py")
ENGINE = f"{REFERENCE}engine.py"
"""Executes all that is compiled."""

SWAPPED: list[tuple[type[Any], type[Any]]] = [
    *((ast.Add, ast.Sub), (ast.Mult, ast.Div), (ast.Eq, ast.NotEq), (ast.Is, ast.IsNot), (ast.In, ast.NotIn)),
    *((ast.And, ast.Or), (ast.Lt, ast.LtE), (ast.Gt, ast.GtE), (ast.Lt, ast.Gt), (ast.LtE, ast.GtE)),
]
OPERATORS = {old: [b if old is a else a for a, b in SWAPPED if old in (a, b)] for pair in SWAPPED for old in pair}
OPERATORS |= {ast.FloorDiv: [ast.Mult], ast.Mod: [ast.Mult], ast.Pow: [ast.Mult]}
IN_TEXTS = dict(pair.split() for pair in ("+ -", "* /", "< >", "<= >=", "== !=", "and or", "+= -=", "*= /="))
IN_TEXTS |= {new: old for old, new in IN_TEXTS.items()}
CHANGED_IN_TEXTS = re.compile(r"(?<![\w.\[{])\d+(?:\.\d+)?(?![\w.])|(?<= )(?:[-+*/<>=!]{1,2}|and|or)(?= )")
LEFT_OUT_OF_TEXTS = re.compile(r'#.*|(?<=\n) +""".*|@.*')
BUDGET = 600.0
"""Seconds of tests for a mutant."""

SECONDS = 300.0
"""Longest time of a test, and of what a mutant's tests take beyond ten times what they took unchanged."""


class Mutant(NamedTuple):
    """A change of a file: its number among those of the file, the line, counted from 1, and what is changed there."""

    path: str
    number: int
    line: int
    change: str


def other_number(number: float) -> float:
    """An integer plus 1; a number with a point doubled, 1 for 0."""
    return number + 1 if isinstance(number, int) else 2.0 * number or 1.0


def others(node: Any, texts: bool) -> Iterator[ast.AST]:
    """Nodes to put in place of one; ``texts``: whether strings are programs."""
    match node:
        case ast.BinOp() | ast.AugAssign() | ast.BoolOp():
            for operator in OPERATORS.get(type(node.op), []):
                yield _with(node, op=operator())
        case ast.Compare():
            for place, old in enumerate(node.ops):
                for operator in OPERATORS.get(type(old), []):
                    yield _with(node, ops=[*node.ops[:place], operator(), *node.ops[place + 1 :]])
        case ast.UnaryOp(op=ast.USub() | ast.Not()):
            yield node.operand
        case ast.Constant(value=bool()):
            yield _with(node, value=not node.value)
        case ast.Constant(value=int() | float()):
            yield _with(node, value=other_number(node.value))
        case ast.Constant(value=str()) if texts:
            text = LEFT_OUT_OF_TEXTS.sub(lambda found: "#" * len(found[0]), node.value)
            for found in CHANGED_IN_TEXTS.finditer(text):
                old = found[0]
                new = repr(other_number(ast.literal_eval(old))) if old[0].isdigit() else IN_TEXTS.get(old)
                if new:
                    yield _with(node, value=node.value[: found.start()] + new + node.value[found.end() :])


def _with(node: Any, **changes: Any) -> Any:
    changed = copy.copy(node)
    for name, value in changes.items():
        setattr(changed, name, value)
    return changed


def skipped(tree: ast.AST) -> set[ast.AST]:
    """Nodes that are not changed: annotations, decorators, errors, docstrings, arguments that only guard."""
    roots: list[ast.AST | None] = []
    for node in ast.walk(tree):
        roots += [getattr(node, "annotation", None), getattr(node, "returns", None)]
        roots += getattr(node, "decorator_list", [])
        roots += [node] * isinstance(node, ast.Raise | ast.Assert)
        roots += [node] * (isinstance(node, ast.keyword) and node.arg == "strict")
        roots += [node] * (isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant))
    return {node for root in roots if root is not None for node in ast.walk(root)}


def changed_trees(path: str) -> Iterator[tuple[ast.AST, ast.AST, ast.AST]]:
    """The tree of a file with one node changed at a time, that node, and what is in its place until the next one."""
    tree = ast.parse((ROOT / path).read_bytes())
    left_out = skipped(tree)
    for parent in [node for node in ast.walk(tree) if node not in left_out]:
        for name, value in ast.iter_fields(parent):
            children = value if isinstance(value, list) else [value]
            for place, old in enumerate(children):
                for new in others(old, path in TEXTS) if old not in left_out else ():
                    changed = [*children[:place], new, *children[place + 1 :]]
                    setattr(parent, name, changed if isinstance(value, list) else new)
                    yield tree, old, new
            setattr(parent, name, value)


def mutants_of(path: str) -> list[Mutant]:
    """All mutants of a file."""
    trees = enumerate(changed_trees(path))
    return [Mutant(path, number, old.lineno, _change(old, new)) for number, (_, old, new) in trees]


def source(mutant: Mutant) -> str:
    """Content of the file of a mutant, without its comments."""
    tree, _, _ = next(itertools.islice(changed_trees(mutant.path), mutant.number, None))
    return ast.unparse(tree)


def _change(old: ast.AST, new: ast.AST) -> str:
    """What differs between two sources, with what is around it."""
    before, after = ast.unparse(old), ast.unparse(new)
    same = next((k for k, (a, b) in enumerate(zip(before, after, strict=False)) if a != b), 0)
    begin, end = max(0, same - 30), same + 30
    return f"`{before[begin:end]}` -> `{after[begin:end]}`"


# --- tests ------------------------------------------------------------------------------------------------------------


class Traced:
    """Plug-in of pytest that notes for each test how long it takes and which lines it executes."""

    def __init__(self, place: str) -> None:
        import coverage

        self.file = Path(place) / f"{os.getpid()}.json"
        self.seconds: dict[str, float] = {}
        self.coverage = coverage.Coverage(data_file=None, include=[f"{folder}/*" for folder in FOLDERS])
        self.coverage.start()

    @pytest.hookimpl(hookwrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        """Run a test."""
        self.coverage.switch_context(item.nodeid)
        started = time.perf_counter()
        yield
        self.seconds.setdefault(item.nodeid, time.perf_counter() - started)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Note a failure: such a test finds nothing."""
        if report.failed:
            self.seconds[report.nodeid] = float("nan")

    def pytest_sessionfinish(self) -> None:
        """Write the notes."""
        self.coverage.stop()
        data, here = self.coverage.get_data(), Path.cwd()
        lines = {Path(f).relative_to(here).as_posix(): data.contexts_by_lineno(f) for f in data.measured_files()}
        self.file.write_text(json.dumps({"seconds": self.seconds, "lines": lines}))


class Ordered:
    """Plug-in of pytest that runs the tests of a list, in its order."""

    def __init__(self, file: str) -> None:
        self.place = {name: n for n, name in enumerate(Path(file).read_text(encoding="utf-8").split("\n"))}

    @pytest.hookimpl(hookwrapper=True)
    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> Iterator[None]:
        """Sort the tests."""
        yield
        items[:] = sorted((item for item in items if item.nodeid in self.place), key=lambda it: self.place[it.nodeid])


def pytest_configure(config: pytest.Config) -> None:
    """Register what the environment asks for."""
    place = os.environ.get("MUTANTS_TRACED")
    if place and (hasattr(config, "workerinput") or not config.option.numprocesses):  # where the tests run
        config.pluginmanager.register(Traced(place))
    if file := os.environ.get("MUTANTS_TESTS"):
        config.pluginmanager.register(Ordered(file))


class Clone:
    """The last commit in a directory, with a cache for compiled programs, and which tests execute which lines."""

    def __init__(self, place: Path) -> None:
        self.place = place
        subprocess.run(["git", "clone", "-q", str(ROOT), str(place)], check=True)
        paths = [place / folder for folder in ("", "workflow/python", "tests/support", "tests/benchmarks")]
        self.environment = os.environ | {
            "PYTHONPATH": os.pathsep.join(map(str, paths)),
            "XDG_CACHE_HOME": f"{place}.cache",
            "PYTHONPYCACHEPREFIX": f"{place}.pyc",
            "OMP_NUM_THREADS": "1",
            "CI": "1",  # the same examples of every property
        }
        self.seconds: dict[str, float] = {}
        self.lines: dict[str, dict[str, list[str]]] = {}

    def pytest(self, arguments: list[str], seconds: float | None = None, **environment: str) -> tuple[int, str]:
        """Exit code, negative if it took longer, and output."""
        command = [sys.executable, "-m", "pytest", "-q", "-p", "mutants", "-p", "no:cacheprovider"]
        command += ["-o", f"timeout={SECONDS:g}", *arguments]
        process = subprocess.Popen(
            command,
            cwd=self.place,
            env=self.environment | environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        )
        try:
            output, _ = process.communicate(timeout=seconds)
        except subprocess.TimeoutExpired:
            return -signal.SIGKILL, ""
        finally:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)  # with all that it left behind
        return process.returncode, output

    def read_map(self, file: Path, *, slow: bool) -> None:
        """Read which tests execute which lines from a file, made by running them, also slow ones, if it is missing."""
        if not file.is_file():
            notes = Path(f"{self.place}.notes")
            notes.mkdir()
            command = ["-n", "auto", "--dist", "loadfile", *(["-m", ""] if slow else [])]
            _, output = self.pytest(command, MUTANTS_TRACED=str(notes))
            print(output[-500:], flush=True)
            merged: dict[str, Any] = {"seconds": {}, "lines": defaultdict(lambda: defaultdict(list))}
            for content in (json.loads(note.read_text(encoding="utf-8")) for note in notes.glob("*.json")):
                merged["seconds"] |= {test: took for test, took in content["seconds"].items() if took == took}
                for path, of_lines in content["lines"].items():
                    for line, found in of_lines.items():
                        merged["lines"][path][line] += filter(None, found)
            file.parent.mkdir(exist_ok=True)
            file.write_text(json.dumps(merged), encoding="utf-8")
        content = json.loads(file.read_text(encoding="utf-8"))
        self.seconds, self.lines = content["seconds"], content["lines"]

    def executing(self, path: str, line: int | None = None) -> set[str]:
        """Tests that execute a line, or any line of a file."""
        lines = self.lines.get(path, {})
        numbers = lines if line is None else [str(line)]
        return {test for number in numbers for test in lines.get(number, []) if test in self.seconds}

    def tests_of(self, mutant: Mutant) -> list[str]:
        """Tests that may find a mutant, in the order in which to run them; none if no test executes it."""
        exact = self.executing(mutant.path, mutant.line) or self.executing(mutant.path)
        if mutant.path.startswith(COMPILED) and not mutant.path.endswith("_lines.py"):
            exact |= self.executing(ENGINE)
        home, files = f"tests/{Path(mutant.path).parent.as_posix()}/", {test.partition("::")[0] for test in exact}
        rest = {test for test in self.seconds if test.partition("::")[0] in files} - exact
        order = [*sorted(exact, key=lambda test: (not test.startswith(home), self.seconds[test]))]
        order += sorted(rest, key=self.seconds.__getitem__)
        until = itertools.accumulate(self.seconds[test] for test in order)
        return [test for test, seconds in zip(order, until, strict=True) if seconds < BUDGET]

    def verdict(self, mutant: Mutant) -> str:
        """Which test finds a mutant, empty for none."""
        tests, path, listed = self.tests_of(mutant), self.place / mutant.path, Path(f"{self.place}.tests")
        original = path.read_bytes()
        path.write_text(source(mutant), encoding="utf-8")
        os.utime(path, (mutant.number,) * 2)  # the size may be the same, and the second: not what was compiled
        listed.write_text("\n".join(tests), encoding="utf-8")
        limit = SECONDS + 10.0 * sum(self.seconds[test] for test in tests)
        files = list(dict.fromkeys(test.partition("::")[0] for test in tests))
        code, output = self.pytest(["-x", "-m", "", *files], limit, MUTANTS_TESTS=str(listed)) if tests else (0, "")
        path.write_bytes(original)
        named = re.search(r"^(?:FAILED|ERROR) (.*?)(?: - |$)", output, re.MULTILINE)
        return "" if code in (0, 5) else named[1] if named else f"exit code {code}"


def main(arguments: list[str]) -> int:
    """Print which mutants are found, and those that survive."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--number", type=int, default=100, help="mutants drawn, default 100")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--all", action="store_true", help="also tests that are slow or need other programs")
    parser.add_argument("--only", default="", metavar="PATH", help="mutants of a file or folder")
    parser.add_argument("--map", type=Path, default=ROOT / "build" / "mutants.json", help="made if it is missing")
    chosen = parser.parse_args(arguments)
    files = [file for folder in FOLDERS for file in sorted((ROOT / folder).rglob("*.py"))]
    paths = [path for path in (file.relative_to(ROOT).as_posix() for file in files) if path.startswith(chosen.only)]
    every = [mutant for path in paths for mutant in mutants_of(path)]
    drawn = random.Random(chosen.seed).sample(every, min(chosen.number, len(every)))
    found = 0
    with tempfile.TemporaryDirectory(prefix="granchain-mutants-") as root:
        clone = Clone(Path(root) / "clone")
        clone.read_map(chosen.map, slow=chosen.all)
        for mutant in drawn:
            test = clone.verdict(mutant)
            print(f"{mutant.path}:{mutant.line} | {mutant.change} | {test or 'SURVIVED'}", flush=True)
            found += bool(test)
    print(f"seed {chosen.seed}: {found} of {len(drawn)} found, of {len(every)}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
