"""The command ``granchain``: parses, calls one command, and turns errors into one line and an exit code.

Exit codes: 0 done, 1 a run or a check failed, 2 bad input, 130 interrupted.
"""

import argparse
import ast
import contextlib
import importlib
import os
import signal
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

from lammps_inputs import InputError
from workflow.errors import RunError

COMMANDS = (
    "scenes",
    "show",
    "deck",
    "run",
    "rerun",
    "status",
    "analyze",
    "validate",
    "compare",
    "reproduce",
    "map",
    "fit",
    "design",
    "trade",
    "sweep",
    "collect",
    "bench",
    "extremes",
)


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        raise InputError(f"{message}; `{self.prog} --help` tells more")


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code."""
    words = list(sys.argv[1:] if argv is None else argv)
    with contextlib.suppress(ValueError):  # not in the main thread
        for ending in (signal.SIGTERM, signal.SIGQUIT, signal.SIGHUP):  # batch systems, `timeout`: end as at Ctrl-C
            if signal.getsignal(ending) is not signal.SIG_IGN:  # nohup
                signal.signal(ending, signal.default_int_handler)
    try:
        arguments = _parser(words[:1]).parse_args(words)
        code = int(arguments.execute(arguments))
        sys.stdout.flush()
    except InputError as error:
        return _say(error, 2)
    except RunError as error:
        return _say(error, 1)
    except BrokenPipeError:  # whoever read the output has seen enough; what Python flushes at its end must go somewhere
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except OSError as error:
        return _say(error, 1)
    except KeyboardInterrupt:
        return _say("interrupted", 130)
    return code


def _parser(first: list[str]) -> argparse.ArgumentParser:
    """The parser of the one command that is asked for, or of all by name: some take a second to import."""
    parser = _Parser(prog="granchain", description="Shock pulses in weakly coupled, uncompressed granular chains.")
    subparsers = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for name in first if first and first[0] in COMMANDS else COMMANDS:
        summary = _summary(name)
        subparser = subparsers.add_parser(name, help=summary, description=summary)
        if name in first:
            module = importlib.import_module(f"workflow.commands.{name}")
            module.add_arguments(subparser)
            subparser.set_defaults(execute=module.execute)
    return parser


def _summary(name: str) -> str:
    """First line of a command's docstring, read without importing it."""
    source = (Path(__file__).parent / "commands" / f"{name}.py").read_text(encoding="utf-8")
    return (ast.get_docstring(ast.parse(source)) or "").partition("\n")[0]


def _say(error: object, code: int) -> int:
    print(f"granchain: {error}", file=sys.stderr)
    return code


if __name__ == "__main__":
    sys.exit(main())
