"""The command ``granchain``: parses, calls one command, and turns errors into one line and an exit code.

Exit codes: 0 done, 1 a run or a check failed, 2 bad input, 130 interrupted.

Plug-ins take this module for commands as a whole, such as help and completion in shells: `COMMANDS` has their names,
those of plug-ins included, `summary_of` a line on each, `parser` their options; `main` runs one.

Examples:
    >>> cli.summary_of("analyze")
    'Find the pulses in a run, measure them and draw them.'
    >>> cli.parser(["analyze"]).parse_args(["analyze", "demo", "--no-figures"]).no_figures
    True
    >>> cli.main(["run", "no-such-scene", "-o", str(tmp / "out")])  # prints one line to standard error
    2
"""

import argparse
import ast
import contextlib
import functools
import importlib
import importlib.util
import io
import os
import signal
import sys
import textwrap
import threading
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, NoReturn

try:
    from lammps_inputs import InputError, plugins
    from workflow import formats, screen
    from workflow.errors import RunError
    from workflow.runs.files import as_json
    from workflow.screen import CommandResult, OutputStream
except (ImportError, SyntaxError):
    from importlib.metadata import distributions

    others = {distribution.name for distribution in distributions()} & {"workflow", "analysis"}
    if not others:
        raise
    names = " ".join(sorted(others))
    sys.exit(
        f"granchain: other packages of the same name lie over its own: {names}; "
        f"`pip uninstall {names}`, then `pip install --force-reinstall --no-deps granchain`"
    )

_HERE = Path(__file__).parent

GROUPS: dict[str, tuple[str, ...]] = {
    "Scenes": ("scenes", "show", "new"),
    "Runs": ("run", "deck", "status"),
    "Analysis": ("analyze", "validate"),
    "Studies": ("sweep", "collect"),
    "Tools": (),
    "Setting up": (),
}
"""Commands of `workflow.commands` by job; `by_job` adds those that installed distributions declare."""

PLUG_INS = {"studies": "Studies", "tools": "Tools"}
"""Kinds of plug-ins that are commands -> their job, unless the module of a command names its ``JOB``."""

COMMANDS = tuple(name for names in (*GROUPS.values(), *map(plugins.declared, PLUG_INS)) for name in names)

FIRST = ("show", "run", "analyze", "view", "sweep")
"""Commands to start with, where they are installed."""

ALIASES = {"analyse": "analyze"}

_OPTIONS_OF_ALL = ("-h", "--help", "-q", "--quiet")


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        raise InputError(f"{message}; `{self.prog} --help` lists the options")


class _Grouped(argparse.RawDescriptionHelpFormatter):
    """Help without argparse's list of commands, which `_listed` replaces."""

    def add_argument(self, action: argparse.Action) -> None:
        if not isinstance(action, argparse._SubParsersAction):
            super().add_argument(action)


class _Version(argparse.Action):
    """Prints the versions of everything that numbers depend on."""

    def __call__(self, parser: argparse.ArgumentParser, *_: Any) -> None:
        from importlib.metadata import version

        print(f"granchain {version('granchain')}")
        print(", ".join(f"{name} {version(name)}" for name in ("lammps", "numpy", "scipy", "numba", "MDAnalysis")))
        parser.exit()


def command() -> int:
    """Run the program as `main` does, also where standard streams are closed or full; its exit code."""
    while True:  # no file that is opened later is taken for one of them
        number = os.open(os.devnull, os.O_RDWR)
        if number > 2:
            os.close(number)
            break
    try:
        return main()
    finally:
        for stream in (sys.stdout, sys.stderr):
            try:
                if stream is not None:
                    stream.flush()
            except OSError:  # which has been reported; Python would do so again, and end with exit code 120
                os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code, also where standard output does not take all that it prints."""
    words = list(sys.argv[1:] if argv is None else argv)
    words[:1] = [ALIASES.get(word, word) for word in words[:1]]
    output: Any = OutputStream(sys.stdout, "standard output", needed=True)
    complaints: Any = OutputStream(sys.stderr, "standard error", needed=False)
    with contextlib.redirect_stdout(output), contextlib.redirect_stderr(complaints):
        try:
            with _ended_as_by_ctrl_c():
                try:
                    grammar = parser(words[:1])
                    if not words:
                        grammar.print_help()
                        return 0
                    arguments = grammar.parse_args(_as_taken(words))
                finally:  # --help and --version end here
                    output.flush()
                output.needed = arguments.prints
                code = _execute(arguments)
                output.flush()
        except InputError as error:
            return _say(error, 2)
        except RunError as error:
            return _say(error, 1)
        except BrokenPipeError:
            return 1
        except OSError as error:
            return _say(error, 1)
        except KeyboardInterrupt:
            return _say("interrupted", 130)
        return _say(f"{output.failure}; the results are in the files", code) if output.failure else code


@contextlib.contextmanager
def _ended_as_by_ctrl_c() -> Iterator[None]:
    """Treat the signals of batch systems and `timeout` as Ctrl-C, and restore the previous handlers at the end.

    A process forked with these handlers would turn the SIGTERM that is to end it into an exception.
    """
    before: dict[signal.Signals, Any] = {}
    try:
        if threading.current_thread() is threading.main_thread():
            for ending in (signal.SIGTERM, signal.SIGQUIT, signal.SIGHUP):
                handler = signal.getsignal(ending)
                if handler not in (signal.SIG_IGN, None):  # nohup; None: not set from Python, so it cannot be restored
                    before[ending] = handler
                    signal.signal(ending, signal.default_int_handler)
        yield
    finally:
        for ending, handler in before.items():
            signal.signal(ending, handler)


def _execute(arguments: argparse.Namespace) -> int:
    """Run a command with the output that its options request; its exit code."""
    wants_json = arguments.json
    only_prints = arguments.prints or vars(arguments).get("list", False)
    quiet = arguments.quiet and not only_prints
    with contextlib.ExitStack() as stack:
        if wants_json or quiet:
            stack.enter_context(contextlib.redirect_stdout(io.StringIO()))
        stack.enter_context(screen.without_bars() if arguments.quiet else screen.with_hints())
        if "formats" in arguments:
            stack.enter_context(formats.written_as(arguments.formats, arguments.width))
        answer = arguments.execute(arguments)
    if wants_json:
        print(as_json(answer.data))
    return answer.code if isinstance(answer, CommandResult) else int(answer)


def parser(names: Sequence[str]) -> argparse.ArgumentParser:
    """The parser with the arguments of these commands; without names it has all commands without arguments.

    Args:
        names: names of commands.

    Returns:
        The parser of the program.

    Raises:
        InputError: there is no such command.
    """
    # only these are imported, which takes long
    commands = [name for name in names if name in COMMANDS]
    top_level = _Parser(prog="granchain", description=None if commands else _listed(), formatter_class=_Grouped)
    top_level.add_argument("--version", action=_Version, nargs=0, help="print versions and exit")
    subparsers = top_level.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for name in names:
        if name not in COMMANDS and not name.startswith("-"):
            from lammps_inputs import complaints  # what a scene may be takes a while to load

            hint = complaints.suggestion(name[:200], COMMANDS)
            raise InputError(f"{name[:60]!r} is no command{hint}; `granchain --help` lists all")
    for name in commands or COMMANDS:
        summary = summary_of(name)
        subparser = subparsers.add_parser(
            name, help=summary, description=summary, formatter_class=argparse.RawDescriptionHelpFormatter
        )
        if name in commands:
            fill(subparser, module_of(name))
    return top_level


def _listed() -> str:
    """Description that lists all commands by job."""
    lines = ["Shock pulses in granular chains, single or weakly coupled, with or without a static load.", ""]
    first = ", ".join(name for name in FIRST if name in COMMANDS)
    lines += [f"Start with {first}. `granchain COMMAND --help` lists options and examples."]
    for job, names in by_job().items():
        if names:
            lines += ["", job]
        for name in names:
            lines += textwrap.wrap(f"  {name:<12}{summary_of(name)}", 100, subsequent_indent=" " * 14)
    return "\n".join(lines)


def by_job() -> dict[str, tuple[str, ...]]:
    """Commands by job: those of `workflow.commands`, then those that installed distributions declare."""
    jobs = {job: list(names) for job, names in GROUPS.items()}
    for kind, job in PLUG_INS.items():
        for name in plugins.declared(kind):
            jobs.setdefault(_constant(_tree(name), "JOB", job), []).append(name)
    return {job: tuple(names) for job, names in jobs.items()}


def _as_taken(words: list[str]) -> list[str]:
    """Words of the command line; further ones without their hyphens where a module has ``TAKES_WORDS``."""
    if words[0] not in COMMANDS or "TAKES_WORDS" not in vars(module_of(words[0])):
        return words
    return [words[0], *(word if word in _OPTIONS_OF_ALL else word.lstrip("-") for word in words[1:])]


def _plug_ins(name: str) -> str:
    """Kind of plug-ins that declare a command: studies or tools; empty for a command of the core."""
    return next((kind for kind in PLUG_INS if name in plugins.declared(kind)), "")


def module_of(name: str) -> Any:
    """The module of a command."""
    kind = _plug_ins(name)
    return plugins.load(kind, name) if kind else importlib.import_module(f"workflow.commands.{name}")


def _source(name: str) -> Path:
    """File of a command, located without importing it."""
    kind = _plug_ins(name)
    if not kind:
        return _HERE / "commands" / f"{name}.py"
    point = plugins.declared(kind)[name]
    specification = importlib.util.find_spec(point.module)
    if specification is None or specification.origin is None:
        raise InputError(
            f"{point.value}: is declared as {name!r} of granchain.{kind} and is no module; mend or uninstall it"
        )
    return Path(specification.origin)


def fill(subparser: argparse.ArgumentParser, module: Any) -> None:
    """Add the arguments and examples of a command and of plug-ins that extend it, and the arguments that all have."""
    name = subparser.prog.split()[-1]
    extensions = plugins.loaded(f"options.{name}").values()
    module.add_arguments(subparser)
    for extension in extensions:
        extension.add_arguments(subparser)
    if "add_last_arguments" in vars(module):
        module.add_last_arguments(subparser)
    prints = vars(module).get("PRINTS", False)
    words = "print no progress and no hints" if prints else "print errors only"
    subparser.add_argument("-q", "--quiet", action="store_true", help=words)
    if vars(module).get("DRAWS", False):
        subparser.add_argument(
            "--formats",
            metavar="NAME,...",
            type=formats.from_words,
            default=formats.asked(),
            help=f"what figures are written as, of {', '.join(formats.KNOWN)} (default {','.join(formats.asked())})",
        )
        subparser.add_argument(
            "--width",
            metavar="INCHES",
            type=formats.width_from_words,
            help="width of figures, without titles: 3.4 for one column of a journal, 7 for two (default: each its own)",
        )
    answers = "; ".join(vars(part)["ANSWERS"] for part in (module, *extensions) if "ANSWERS" in vars(part))
    if answers:
        subparser.add_argument("--json", action="store_true", help=f"print one JSON value and nothing else: {answers}")
    file = f"{module.FILE}\n" if "FILE" in vars(module) else ""
    subparser.epilog = file + _examples(line for part in (module, *extensions) for line in part.EXAMPLES)
    execute = module.execute
    for extension in extensions:
        execute = functools.partial(extension.execute, command=execute)
    subparser.set_defaults(execute=execute, prints=prints, json=False)


def _examples(lines: Iterable[str]) -> str:
    return "examples:\n" + "\n".join(f"  granchain {line}" for line in lines)


def summary_of(name: str) -> str:
    """First line of a command's docstring, read without importing it."""
    return (ast.get_docstring(_tree(name)) or "").partition("\n")[0]


@functools.cache
def _tree(name: str) -> ast.Module:
    """Source of a command."""
    return ast.parse(_source(name).read_text(encoding="utf-8"))


def _constant(tree: ast.Module, name: str, default: str) -> str:
    """Literal that a module assigns to a name; a default where it assigns none."""
    for line in tree.body:
        if isinstance(line, ast.Assign) and any(isinstance(at, ast.Name) and at.id == name for at in line.targets):
            return str(ast.literal_eval(line.value))
    return default


def _say(error: object, code: int) -> int:
    print(f"granchain: {error}", file=sys.stderr)
    return code


if __name__ == "__main__":
    sys.exit(command())
