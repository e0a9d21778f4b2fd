"""Tests ask for the programs that a machine with Python may lack, and are skipped without them."""

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import executables
import pytest
from processes import HANGS

TESTS = Path(__file__).parent
BARE = TESTS.parent / ".ci" / "bare"

ALWAYS = {"bash", "date", "env", "false", "mount", "sh", "sleep", "true", "umount"}
"""Programs of Debian's required packages, without which no machine is."""

PATH = re.compile(r"/(?:s?bin|lib/gridengine)/([\w.+-]+)")
STARTS = re.compile(r"subprocess|started|shutil\.which|os\.(system|exec|spawn|posix_spawn)|" + PATH.pattern)
"""What the text of a module has that starts a program."""


def _starts(call: ast.Call, starters: set[str]) -> bool:
    """Whether a call starts or looks for a program, which its first argument names."""
    match call.func:
        case ast.Attribute(value=ast.Name(id="subprocess")):
            return bool(call.args)
        case ast.Attribute(value=ast.Name(id="os" | "shutil"), attr=name):
            return bool(call.args) and name.startswith(("which", "system", "exec", "spawn", "posix_spawn"))
        case ast.Name(id=name):
            return bool(call.args) and name in starters
    return False


def _starters(functions: list[ast.FunctionDef]) -> set[str]:
    """Functions of a module that start what their arguments say, besides `started`."""
    return {"started"} | {
        one.name
        for one in functions
        if one.args.vararg
        for call in ast.walk(one)
        if isinstance(call, ast.Call) and _starts(call, set()) and one.args.vararg.arg in ast.dump(call.args[0])
    }


def _head(node: ast.expr) -> str | None:
    """First word of what a call starts, where it stands there."""
    if isinstance(node, ast.List | ast.Tuple):
        return _head(node.elts[0]) if node.elts else None
    if isinstance(node, ast.Constant) and isinstance(node.value, str) and node.value.strip():
        return node.value.split()[0]
    return None


def _heads(scope: ast.AST, starters: set[str]) -> Iterator[ast.expr]:
    """What the calls in a function or module start, also by a variable that it sets."""
    inside = list(ast.walk(scope))
    heads = [call.args[0] for call in inside if isinstance(call, ast.Call) and _starts(call, starters)]
    variables = {head.id for head in heads if isinstance(head, ast.Name)}
    yield from heads
    for node in inside if isinstance(scope, ast.FunctionDef) else ast.iter_child_nodes(scope):
        if isinstance(node, ast.Assign) and any(isinstance(to, ast.Name) and to.id in variables for to in node.targets):
            yield node.value


def unasked(text: str) -> list[str]:
    """Programs that a module names itself, in place of asking the fixture, though a machine may lack them."""
    if not STARTS.search(text):
        return []
    tree = ast.parse(text)
    functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]
    starters = _starters(functions)
    heads = (_head(head) for scope in (tree, *functions) for head in _heads(scope, starters))
    names = {Path(word).name for word in heads if word is not None}
    texts = (str(node.value) for node in ast.walk(tree) if isinstance(node, ast.Constant))
    return sorted(names.union(*(PATH.findall(text) for text in texts)) - ALWAYS)


ASK_FIRST = {"core_alone", "executables", "gridengine", "slurm"}
"""Modules of support whose users ask for a package before they start its programs by name."""


def _sources() -> Iterator[tuple[Path, str]]:
    """Path and text of the tests, their fixtures, and what of their support they import: scripts are not meant."""
    texts = {file: file.read_text(encoding="utf-8") for file in TESTS.rglob("*.py")}
    imported = set(re.findall(r"^ *(?:from|import) (\w+)", "\n".join(texts.values()), re.M)) - ASK_FIRST
    for file, text in texts.items():
        if file != Path(__file__) and (file.stem.startswith(("test_", "conftest")) or file.stem in imported):
            yield file, text


def test_no_test_starts_a_program_without_asking_for_it():
    assert {str(file.relative_to(TESTS)): names for file, text in _sources() if (names := unasked(text))} == {}


@pytest.mark.parametrize(
    "text",
    [
        'subprocess.run(["ffmpeg", "-i", path], check=True)',
        'def test():\n    words = ["ffmpeg", "-i", path]\n    subprocess.Popen(words)',
        'command = ("ffmpeg", "-i")\nsubprocess.check_output(command)',
        'def run(*words):\n    return subprocess.run([str(word) for word in words])\nrun("ffmpeg", "-version")',
        'with started(["ffmpeg", "-i"]) as process: pass',
        'subprocess.run("ffmpeg -version", shell=True)',
        'os.execvp("ffmpeg", words)',
        'subprocess.run(["/opt/video/ffmpeg", "-i", path])',
        'PROGRAM = Path("/usr/bin/ffmpeg")',
        'LAUNCHER = f"/usr/local/bin/ffmpeg -i {name}"',
        'path = shutil.which("ffmpeg")',
    ],
)
def test_a_program_that_is_not_asked_for_is_seen(text):
    assert unasked(text) == ["ffmpeg"]


@pytest.mark.parametrize(
    "text",
    [
        'subprocess.run([executable("ffmpeg"), "-i", path], check=True)',
        'subprocess.run(["bash", "-c", text])',
        'environment = {"PATH": "/usr/bin:/bin"}',
        'words = ["ffmpeg", "-i"]\nmain(words)',
    ],
)
def test_a_program_that_is_asked_for_or_always_there_or_not_started_is_no_finding(text):
    assert unasked(text) == []


def test_the_fixture_says_what_is_missing(monkeypatch, executable):
    monkeypatch.setattr(executables, "FOLDERS", "/nowhere")
    monkeypatch.delenv(executables.PROMISED, raising=False)
    with pytest.raises(pytest.skip.Exception, match=r"^no tclsh: apt-get install tcl$"):
        executable("tclsh")


def test_what_is_promised_fails_where_it_is_missing(monkeypatch, executable):
    monkeypatch.setattr(executables, "FOLDERS", "/nowhere")
    monkeypatch.setenv(executables.PROMISED, "1")
    with pytest.raises(pytest.fail.Exception, match=r"^no tclsh: apt-get install tcl$"):
        executable("tclsh")


@pytest.fixture
def behind(lmp_of):
    """A fixture that asks for others."""


@pytest.mark.usefixtures("behind")
def test_a_test_whose_fixtures_ask_is_selected_by_the_marker(request):
    assert request.node.get_closest_marker("executable")


def test_a_test_that_asks_for_nothing_is_not_selected_by_the_marker(request):
    assert request.node.get_closest_marker("executable") is None


def on_a_bare_machine(*words):
    done = subprocess.run([BARE, *words], capture_output=True, text=True, timeout=HANGS, check=False)
    if "unshare failed" in done.stderr:
        executables.unavailable("only root may mount")
    return done


def test_a_bare_machine_has_python_and_none_of_the_programs_that_are_asked_for(executable):
    needed = str(executable("dpkg-query"))
    names = [*executables.PACKAGES, "gcc", "ps", "ffmpeg", "mpiexec", "sbatch"]
    code = f"import shutil; print([shutil.which(n, path={executables.FOLDERS!r}) for n in {names}])"
    done = on_a_bare_machine(sys.executable, "-c", code)
    assert done.stdout == f"{[needed if name == 'dpkg-query' else None for name in names]}\n", done.stderr


def test_a_bare_machine_passes_words_and_exit_code_on(executable):
    executable("dpkg-query")
    done = on_a_bare_machine("bash", "-c", 'echo "$1"; exit 3', "-", "a  b")
    assert (done.returncode, done.stdout) == (3, "a  b\n"), done.stderr
