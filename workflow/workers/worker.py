"""A process that does one task after another, so that what a fresh interpreter costs is paid once.

Started as ``python -m workflow.workers.worker PARENT``, with the number of the process that starts it. Each line of its
input is a task (`workflow.workers.pool.Task`), and each is answered with a JSON object: ``value``, or ``failed`` with a
reason; ``last`` says that this process can do no other. Before it there may be others, each with a ``hint`` for the
user. It ends when its input does, and dies with the process that started it, also where that ended before this one
came to its first task.
"""

import ctypes
import importlib
import json
import os
import signal
import sys
from typing import Any

from lammps_inputs import InputError
from workflow import screen
from workflow.engines.lammps import hosted
from workflow.errors import RunError


def main() -> int:
    """Do every task that comes in, until the input ends."""
    _die_with_parent(int(sys.argv[1]))
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # what LAMMPS or MPI print is no answer

    def say(answer: dict[str, Any]) -> None:
        answers.write(json.dumps(answer) + "\n")
        answers.flush()

    try:
        with screen.with_hints(lambda text: say({"hint": text})):
            for line in iter(sys.stdin.readline, ""):
                answer = do(**json.loads(line))
                say(answer)
                if answer.get("last"):
                    break
    except (KeyboardInterrupt, BrokenPipeError):
        pass
    os._exit(0)  # MPI, which LAMMPS started, would have its say at an orderly end


def do(function: str, arguments: dict[str, Any]) -> dict[str, Any]:
    """The answer to a task."""
    module, _, name = function.partition(":")
    try:
        return {"value": getattr(importlib.import_module(module), name)(**arguments)}
    except (RunError, InputError, OSError) as error:
        return {"failed": str(error), "last": isinstance(error, hosted.LammpsError)}
    except Exception as error:  # no memory, or a mistake of ours: must not end the other tasks
        return {"failed": " ".join(f"{type(error).__name__}: {error}".split()), "last": True}


def _die_with_parent(parent: int) -> None:
    """Let the system kill this process when the one that started it is gone, so that two never share a directory."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(1, int(signal.SIGKILL))  # PR_SET_PDEATHSIG
    if os.getppid() != parent:
        os._exit(1)


if __name__ == "__main__":
    sys.exit(main())
