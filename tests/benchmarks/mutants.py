"""Mutants that the tests find: ``python tests/benchmarks/mutants.py --number 300 --seed 1 [--only PATH]``.

A mutant is the tree with one operator, comparison, constant or sign changed, also in the texts that the reference
compiles (``TEXTS``). Words, annotations, decorators and what an error says are left alone. Mutants are drawn at random
from all of `FOLDERS`, the same ones for the same seed and sources, and tested in clones of the last commit.

Which tests execute which lines is measured by coverage.py (``pip install coverage``), by a run of all tests that is
kept in the file ``--map``. A mutant meets first the tests of the folder that mirrors its own, then those that execute
the line, then the others of their files, since fixtures and caches execute lines for later tests; files that take the
least time first, up to the first failure. A compiled line is not traced: it has the tests of the reference, too.
"""

import argparse
import ast
import concurrent.futures
import contextlib
import itertools
import json
import os
import queue
import random
import re
import signal
import subprocess
import sys
import tempfile
import time
import tokenize
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

OPERATORS: dict[type[ast.AST], list[tuple[str, str]]] = {
    ast.Add: [("+", "-")],
    ast.Sub: [("-", "+")],
    ast.Mult: [("*", "/")],
    ast.Div: [("/", "*")],
    ast.FloorDiv: [("//", "*")],
    ast.Mod: [("%", "*")],
    ast.Pow: [("**", "*")],
    ast.Lt: [("<", "<="), ("<", ">")],
    ast.LtE: [("<=", "<"), ("<=", ">=")],
    ast.Gt: [(">", ">="), (">", "<")],
    ast.GtE: [(">=", ">"), (">=", "<=")],
    ast.Eq: [("==", "!=")],
    ast.NotEq: [("!=", "==")],
    ast.Is: [("is", "is not")],
    ast.IsNot: [("is not", "is")],
    ast.In: [("in", "not in")],
    ast.NotIn: [("not in", "in")],
    ast.And: [("and", "or")],
    ast.Or: [("or", "and")],
}
IN_TEXTS = {old: [new for a, new in pairs if a == old] for pairs in OPERATORS.values() for old, _ in pairs}
IN_TEXTS |= {f"{old}=": [f"{new}="] for old, new in (("+", "-"), ("-", "+"), ("*", "/"), ("/", "*"))}
SECONDS = 300.0
"""Longest time of a test, and of what a mutant's tests take beyond ten times what they took unchanged."""


class Mutant(NamedTuple):
    """A change of the bytes [start, stop) of a file, at a line counted from 1."""

    path: str
    line: int
    start: int
    stop: int
    old: str
    new: str


def other_number(number: str) -> str:
    """An integer plus 1; a number with a point doubled, 1 for 0."""
    return str(int(number) + 1) if number.isdigit() else repr(2.0 * float(number) or 1.0)


def skipped(tree: ast.AST) -> set[ast.AST]:
    """Nodes that are not changed: annotations, decorators, errors, and arguments that only guard against mistakes."""
    roots: list[ast.AST | None] = []
    for node in ast.walk(tree):
        roots += [getattr(node, "annotation", None), getattr(node, "returns", None)]
        roots += getattr(node, "decorator_list", [])
        roots += [node] * isinstance(node, ast.Raise | ast.Assert)
        roots += [node] * (isinstance(node, ast.keyword) and node.arg == "strict")
        roots += [node] * (isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__")
    return {node for root in roots if root is not None for node in ast.walk(root)}


def changes(node: Any, at: Any) -> Iterator[tuple[int, int, str]]:
    """Start, stop and new text of each change of a node; ``at`` has the offset of a line and column."""
    between: list[tuple[Any, Any, Any]] = []
    match node:
        case ast.BinOp():
            between = [(node.left, node.op, node.right)]
        case ast.AugAssign():
            between = [(node.target, node.op, node.value)]
        case ast.Compare():
            sides = [node.left, *node.comparators]
            between = list(zip(sides, node.ops, sides[1:], strict=False))
        case ast.BoolOp():
            between = [(left, node.op, right) for left, right in zip(node.values, node.values[1:], strict=False)]
        case ast.UnaryOp(op=ast.USub() | ast.Not()):
            yield at(node), at(node.operand), ""
        case ast.Constant(value=bool()):
            yield at(node), at(node, end=True), str(not node.value)
        case ast.Constant(value=int() | float()):
            yield at(node), at(node, end=True), other_number(ast.unparse(node))
    for left, operator, right in between:
        start, stop = at(left, end=True), at(right)
        for old, new in OPERATORS.get(type(operator), []):
            found = re.search(rb"(?<![\w<>=*/])" + re.escape(old.encode()), at.source[start:stop])
            if found:
                yield start + found.start(), start + found.end(), new


class At:
    """Offsets in a source, in bytes."""

    def __init__(self, source: bytes) -> None:
        self.source = source
        self.lines = [0, *(match.end() for match in re.finditer(b"\n", source))]

    def __call__(self, node: Any, end: bool = False) -> int:
        line, column = (node.end_lineno, node.end_col_offset) if end else (node.lineno, node.col_offset)
        return int(self.lines[line - 1] + column)


def in_texts(source: bytes) -> Iterator[tuple[int, int, str]]:
    """Changes in the texts of programs: strings but docstrings, without comments."""
    at = At(source)
    docstrings = {node.lineno for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Expr)}
    lines = iter(source.splitlines(keepends=True))
    number, operator = r"(?<![\w.\[{])\d+(?:\.\d+)?(?![\w.])", r"(?<= )(?:[-+*/<>=!]{1,2}|and|or)(?= )"
    for token in tokenize.tokenize(lambda: next(lines, b"")):
        if token.type != tokenize.STRING or token.start[0] in docstrings:
            continue
        begin = at.lines[token.start[0] - 1] + len(token.line.split("\n")[0][: token.start[1]].encode())
        text = re.sub(r'#.*|(?<=\n) +""".*|@.*', lambda match: "#" * len(match[0].encode()), token.string)
        for found in re.finditer(f"{number}|{operator}", text):
            start = begin + len(text[: found.start()].encode())
            old = found[0]
            for new in [other_number(old)] if old[0].isdigit() else IN_TEXTS.get(old, []):
                yield start, start + len(old), new


def mutants_of(path: str) -> list[Mutant]:
    """All mutants of a file; a few are no Python."""
    source = (ROOT / path).read_bytes()
    tree, at = ast.parse(source), At(source)
    left_out = skipped(tree)
    inside = {node for text in ast.walk(tree) if isinstance(text, ast.JoinedStr) for node in ast.walk(text)}
    nodes = [node for node in ast.walk(tree) if node not in left_out | inside]  # places within f-strings are unsure
    sites = {change for node in nodes for change in changes(node, at)}
    sites |= set(in_texts(source)) if path in TEXTS else set()
    return [
        Mutant(path, source[:start].count(b"\n") + 1, start, stop, source[start:stop].decode(), new)
        for start, stop, new in sorted(sites)
    ]


def is_python(mutant: Mutant) -> bool:
    """Whether a mutant can be imported."""
    try:
        compile(mutated(mutant), mutant.path, "exec")
    except SyntaxError:
        return False
    return True


def mutated(mutant: Mutant) -> bytes:
    """Content of the file of a mutant."""
    source = (ROOT / mutant.path).read_bytes()
    return source[: mutant.start] + mutant.new.encode() + source[mutant.stop :]


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
        data = self.coverage.get_data()
        lines = {
            Path(file).relative_to(ROOT).as_posix(): data.contexts_by_lineno(file) for file in data.measured_files()
        }
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


class Map:
    """Which tests execute which lines, and how long they take."""

    def __init__(self, file: Path, budget: float) -> None:
        self.budget = budget  # of the tests that a mutant meets
        content = json.loads(file.read_text(encoding="utf-8"))
        self.seconds: dict[str, float] = content["seconds"]  # those that pass
        self.lines: dict[str, dict[str, list[str]]] = content["lines"]
        self.of_file: dict[str, list[str]] = defaultdict(list)
        for test in self.seconds:
            self.of_file[test.partition("::")[0]].append(test)

    def executing(self, path: str, line: int | None = None) -> set[str]:
        """Tests that execute a line, or any line of a file."""
        lines = self.lines.get(path, {})
        numbers = lines if line is None else [str(line)]
        return {test for number in numbers for test in lines.get(number, []) if test in self.seconds}

    def batches(self, mutant: Mutant) -> list[list[str]]:
        """Lists of tests to run one after the other; none if no test executes the mutant."""
        exact = self.executing(mutant.path, mutant.line) or self.executing(mutant.path)
        if mutant.path.startswith(COMPILED):
            exact |= self.executing(ENGINE)
        files: dict[str, list[str]] = defaultdict(list)
        for test in sorted(exact, key=self.seconds.__getitem__):
            files[test.partition("::")[0]].append(test)
        took = {file: sum(self.seconds[test] for test in tests) for file, tests in files.items()}
        order = sorted(files, key=took.__getitem__)
        home = f"tests/{Path(mutant.path).parent.as_posix()}/"
        near, far = ([file for file in order if file.startswith(home) is nearby] for nearby in (True, False))
        rest = [test for file in order for test in self.of_file[file] if test not in exact]
        affordable, total = [], 0.0
        for batch in ([t for f in near for t in files[f]], [t for f in far for t in files[f]], rest):
            sums = zip(batch, itertools.accumulate((self.seconds[test] for test in batch), initial=total), strict=False)
            affordable.append([test for test, before in sums if before < self.budget])
            total += sum(self.seconds[test] for test in batch)
        return [batch for batch in affordable if batch]


class Clone:
    """The last commit in a directory, with a cache for compiled programs."""

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

    def pytest(self, arguments: list[str], seconds: float | None = None, **environment: str) -> tuple[int, str]:
        """Exit code, negative if it took longer, and output."""
        command = ["nice", "-n", NICE, sys.executable, "-m", "pytest", "-q", "-p", "mutants", "-p", "no:cacheprovider"]
        process = subprocess.Popen(
            [*command, "-o", f"timeout={SECONDS:g}", *arguments],
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

    def trace(self, file: Path, tests: list[str], jobs: int) -> None:
        """Run tests and write the map."""
        notes = Path(f"{self.place}.notes")
        notes.mkdir()
        _, output = self.pytest(["-n", str(jobs), "--dist", "loadfile", *tests], MUTANTS_TRACED=str(notes))
        print(output[-500:], flush=True)
        seconds: dict[str, float] = {}
        lines: dict[str, dict[str, set[str]]] = defaultdict(lambda: defaultdict(set))
        for content in (json.loads(note.read_text(encoding="utf-8")) for note in notes.glob("*.json")):
            seconds |= {test: took for test, took in content["seconds"].items() if took == took}
            for path, of_lines in content["lines"].items():
                for line, found in of_lines.items():
                    lines[path][line] |= set(found) - {""}
        text = {path: {line: sorted(tests) for line, tests in of.items()} for path, of in lines.items()}
        file.write_text(json.dumps({"seconds": seconds, "lines": text}), encoding="utf-8")

    def verdict(self, mutant: Mutant, tests_of: Map) -> str:
        """Which test finds a mutant, empty for none."""
        path = self.place / mutant.path
        original, listed = path.read_bytes(), Path(f"{self.place}.tests")
        path.write_bytes(mutated(mutant))
        os.utime(path, (mutant.start, mutant.start))  # the size may be the same, and the second: not what was compiled
        try:
            for tests in tests_of.batches(mutant):
                listed.write_text("\n".join(tests), encoding="utf-8")
                limit = SECONDS + 10.0 * sum(tests_of.seconds[test] for test in tests)
                files = list(dict.fromkeys(test.partition("::")[0] for test in tests))
                code, output = self.pytest(["-x", *files], limit, MUTANTS_TESTS=str(listed))
                if code not in (0, 5):
                    named = re.search(r"^(?:FAILED|ERROR) (.*?)(?: - |$)", output, re.MULTILINE)
                    return named[1] if named else f"exit code {code}"
        finally:
            path.write_bytes(original)
        return ""


NICE = os.environ.get("MUTANTS_NICE", "10")


def main(arguments: list[str]) -> int:
    """Print which mutants are found, and those that survive."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--number", type=int, default=100, help="mutants drawn, default 100")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="", metavar="PATH", help="mutants of a file or folder")
    parser.add_argument(
        "--again", type=Path, metavar="FILE", help="the mutants in a table that was printed, not drawn ones"
    )
    parser.add_argument("--map", type=Path, default=ROOT / "build" / "mutants.json", help="made if it is missing")
    parser.add_argument("--tests", nargs="*", default=["tests"], help="that the map is made of")
    parser.add_argument(
        "--budget", type=float, default=600.0, help="seconds of the tests that a mutant meets, default 600"
    )
    parser.add_argument("--jobs", type=int, default=2)
    chosen = parser.parse_args(arguments)
    files = [file for folder in FOLDERS for file in sorted((ROOT / folder).rglob("*.py"))]
    paths = [path for path in (file.relative_to(ROOT).as_posix() for file in files) if path.startswith(chosen.only)]
    every = [mutant for path in paths for mutant in mutants_of(path)]
    random.Random(chosen.seed).shuffle(every)
    drawn = list(itertools.islice(filter(is_python, every), chosen.number))
    if chosen.again:
        wanted = {key(row) for row in chosen.again.read_text(encoding="utf-8").splitlines()}
        drawn = [mutant for mutant in every if key(said(mutant)) in wanted]
    survivors = []
    with tempfile.TemporaryDirectory(prefix="granchain-mutants-") as root:
        clones = [Clone(Path(root) / f"clone-{n}") for n in range(chosen.jobs)]
        if not chosen.map.is_file():
            chosen.map.parent.mkdir(exist_ok=True)
            clones[0].trace(chosen.map, chosen.tests, chosen.jobs)
        tests_of, idle = Map(chosen.map, chosen.budget), queue.SimpleQueue[Clone]()
        for clone in clones:
            idle.put(clone)

        def judged(mutant: Mutant) -> tuple[Mutant, str]:
            clone = idle.get()
            try:
                return mutant, clone.verdict(mutant, tests_of)
            finally:
                idle.put(clone)

        with concurrent.futures.ThreadPoolExecutor(chosen.jobs) as pool:
            for future in concurrent.futures.as_completed([pool.submit(judged, mutant) for mutant in drawn]):
                mutant, test = future.result()
                print(f"{said(mutant)} | {test or 'SURVIVED'}", flush=True)
                survivors += [mutant] * (not test)
    print(f"seed {chosen.seed}: {len(drawn) - len(survivors)} of {len(drawn)} found, of {len(every)}; survivors:")
    print(*map(said, survivors), sep="\n")
    return 0


def said(mutant: Mutant) -> str:
    """A row on a mutant: its file, line and column, counted from 1, what is changed, and the line."""
    source = (ROOT / mutant.path).read_bytes()
    begin = source.rfind(b"\n", 0, mutant.start) + 1
    line = source[begin:].partition(b"\n")[0].decode().strip()
    column = mutant.start - begin + 1
    return f"{mutant.path}:{mutant.line}:{column} | `{mutant.old}` -> `{mutant.new}` | `{line}`"


def key(row: str) -> tuple[str, ...]:
    """What a row says but the number of the line, which moves."""
    place, *change = row.split(" | ")[:3]
    return (*place.split(":")[::2], *change)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
