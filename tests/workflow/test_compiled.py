"""Machine code is kept between processes, and never that of other sources."""

import gc
import importlib
import os
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import SimpleNamespace

import pytest
from processes import HANGS

from lammps_inputs import find
from workflow import compiled, screen
from workflow.engines.reference import engine

ROOT = Path(__file__).parents[2]
FLOORS = ("lammps_inputs", "analysis", "workflow")

PROGRAM = """
import os, tempfile
import lammps_inputs
tempfile.tempdir = os.environ.get("TEMPORARY")
from workflow.engines.reference import engine
problem = lammps_inputs.find("one-chain").problem().coarser(400)
print(engine.run(problem).velocity[-1].max())
print(sum(engine.make_state(problem, None).program.advance.stats.cache_hits.values()))
"""


def run(tree, cache, **environment):
    """Largest velocity at the end of a run with the sources of a tree, and whether the kernel came from the disk."""
    own = {"PYTHONPATH": str(tree), "NUMBA_CACHE_DIR": str(cache), **environment}
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM],
        env={**os.environ, **own},
        capture_output=True,
        text=True,
        timeout=HANGS,
        cwd=tree,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    value, hits = done.stdout.split()
    return float(value), hits == "1"


@pytest.fixture(scope="module")
def value():
    """Largest velocity at the end of the same run in this process."""
    return float(engine.run(find("one-chain").problem().coarser(400)).velocity[-1].max())


@pytest.fixture(scope="module")
def at_once(tmp_path_factory):
    """A cache that two processes have filled at once, and what they found."""
    cache = tmp_path_factory.mktemp("compiled") / "cache"
    with ThreadPoolExecutor(2) as pool:
        return cache, {found for found, _ in pool.map(lambda _: run(ROOT, cache), range(2))}


@pytest.mark.slow
def test_a_changed_law_is_computed_with_though_the_old_one_is_on_the_disk(at_once, value, tmp_path):
    tree, (cache, _) = tmp_path / "tree", at_once
    for floor in FLOORS:
        shutil.copytree(ROOT / floor, tree / floor, ignore=shutil.ignore_patterns("__pycache__"))
    law = tree / "lammps_inputs/laws/contact.py"
    text = law.read_text()
    hertz = "return strength * (closed * np.sqrt(closed))\n"
    assert text.count(hertz) == 1
    law.write_text(text.replace(hertz, "return 2.0 * strength * (closed * closed)\n"))
    other, hit = run(tree, cache)
    assert not hit
    assert other != value


@pytest.mark.slow
def test_processes_that_compile_at_once_agree_and_leave_whole_files(at_once, value):
    cache, values = at_once
    assert values == {value}
    assert run(ROOT, cache) == (value, True)
    place = next(path for path in (cache / "granchain").iterdir() if any(path.glob("*.py")))
    assert len([path for path in place.glob("*") if path.is_file()]) == 1


@pytest.mark.slow
def test_a_cache_that_cannot_be_written_to_changes_no_number(value, tmp_path):
    (tmp_path / "file").write_text("no directory")
    own = {"HOME": f"{tmp_path}/file", "XDG_CACHE_HOME": f"{tmp_path}/file", "TEMPORARY": f"{tmp_path}/file"}
    assert run(ROOT, tmp_path / "file", **own) == (value, False)


HELPER = "def twice(s):\n    return 2.0 * s\n"


def test_a_change_of_what_a_law_calls_changes_its_digest(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "law_of_mine.py").write_text("from helper_of_mine import twice\n\ndef force(s):\n    return twice(s)\n")
    (tmp_path / "helper_of_mine.py").write_text(HELPER)
    law = importlib.import_module("law_of_mine")
    before = compiled.digest([law.force])
    (tmp_path / "helper_of_mine.py").write_text(HELPER.replace("2.0", "3.0"))
    assert compiled.digest([law.force]) != before


def test_a_program_is_a_file_that_can_be_read_and_one_that_is_damaged_is_written_again(place, tmp_path):
    where = place(tmp_path / "home", tmp_path)
    file = Path(compiled.module("answer = 42\n").__file__)
    assert file.parent == where
    file.write_text("answer =")
    compiled.module.cache_clear()
    assert compiled.module("answer = 42\n").answer == 42
    assert file.read_text() == "answer = 42\n"


def test_without_a_place_a_program_is_in_no_file(place, tmp_path):
    (tmp_path / "file").write_text("no directory")
    assert place(tmp_path / "file", tmp_path / "file") is None
    found = compiled.module("from workflow.compiled import compiled\n\n@compiled\ndef more(x):\n    return x + 1.0\n")
    assert found.more(1.0) == 2.0


def test_any_source_or_its_name_changes_the_place():
    plain = [("a.py", b"x = 1\n"), ("b.py", b"y = 2\n")]
    changed = [[("a.py", b"x = 2\n"), plain[1]], [("c.py", b"x = 1\n"), plain[1]], plain[:1], plain[::-1]]
    assert len({compiled.fingerprint(sources) for sources in [plain, *changed]}) == 5


def test_laws_and_kernels_are_among_the_sources():
    names = {name for name, _ in compiled.sources()}
    assert {"lammps_inputs/laws/contact.py", "workflow/engines/reference/kernel.py"} <= names


@pytest.fixture
def place(monkeypatch):
    """Where code would be kept, given the user's cache directory and the one for temporary files."""

    def asked(home, temporary):
        for name in ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME"):
            monkeypatch.delenv(name, raising=False)
        monkeypatch.setenv("HOME", str(home))
        monkeypatch.setattr(compiled.tempfile, "gettempdir", lambda: str(temporary))
        compiled.cache_directory.cache_clear()
        compiled.module.cache_clear()
        return compiled.cache_directory()

    yield asked
    compiled.cache_directory.cache_clear()
    compiled.module.cache_clear()


def test_code_is_kept_in_the_users_cache(place, tmp_path):
    assert place(tmp_path / "home", tmp_path).parent == tmp_path / "home/.cache/granchain"


def test_without_a_home_it_is_kept_among_the_temporary_files_where_only_we_can_write(place, tmp_path):
    (tmp_path / "home").write_text("no directory")
    found = place(tmp_path / "home", tmp_path)
    assert found.parent == tmp_path / f"granchain-{os.getuid()}"
    assert found.parent.stat().st_mode & 0o077 == 0


def test_a_directory_that_others_can_write_to_is_not_trusted(place, tmp_path):
    (tmp_path / "home").write_text("no directory")
    theirs = tmp_path / f"granchain-{os.getuid()}"
    theirs.mkdir()
    theirs.chmod(0o777)
    assert place(tmp_path / "home", tmp_path) is None


def test_with_no_place_at_all_functions_are_compiled_all_the_same(place, tmp_path):
    (tmp_path / "file").write_text("no directory")
    assert place(tmp_path / "file", tmp_path / "file") is None
    assert compiled.compiled(lambda x: x + 1.0)(1.0) == 2.0


def start(module=f"{compiled._WRITTEN}0123"):
    """What numba says when it compiles a function."""
    function = SimpleNamespace(py_func=SimpleNamespace(__module__=module))
    hint = compiled._Hint()
    for _ in range(2):
        hint.on_start(SimpleNamespace(data={"dispatcher": function}))


@pytest.mark.parametrize("collects", [True, False])
def test_the_garbage_collector_is_held_while_functions_are_compiled_and_is_then_as_it_was(collects):
    compilation = compiled._Compiling()
    try:
        (gc.enable if collects else gc.disable)()
        for _ in range(2):
            compilation.on_start(None)
        assert not gc.isenabled()
        compilation.on_end(None)
        assert not gc.isenabled()
        compilation.on_end(None)
        assert gc.isenabled() == collects
    finally:
        gc.enable()


def test_commands_say_once_that_and_what_is_compiled(capsys):
    with screen.with_hints():
        start()
        start("a.users.own")
    out, err = capsys.readouterr()
    assert out == ""
    assert err == "compiling the reference; takes a few seconds, once for this kind of scene\n"


def test_scripts_and_quiet_commands_say_nothing_of_it(capsys):
    start()
    with screen.with_hints(), screen.without_bars():
        start()
    assert capsys.readouterr() == ("", "")
