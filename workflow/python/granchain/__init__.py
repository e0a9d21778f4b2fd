"""Shock pulses in granular chains, single or weakly coupled: what the commands do, for scripts and notebooks.

A function has the name and the arguments of its command. A scene may be a name, a file, plain data or a `Scene`; a run
is a `Run` or the path of its directory; numbers and arrays of NumPy count as those of Python. Bad input raises
`InputError`, a run that fails `RunError`, each with one line of text that names the argument; nothing ends the
interpreter. On a terminal and in a notebook long work has a progress bar.

Studies and tools that are installed are functions, too (``fit``, ``design``, ``gallery``, ``threshold``, ``lyapunov``,
``modes``, ``trade``, ``extremes``, ``adopt``, ``explore``, ``export``), and loaded when they are first used.

Examples:
    >>> import granchain
    >>> run = granchain.run("two-chains", "demo")
    >>> run.trajectory.velocity.shape  # [frame, chain, bead], in units of V
    (1921, 2, 120)
    >>> analysis = granchain.analyze(run)
    >>> analysis.waves.of_chain(1).arrival[:3].round(2)  # in the scene's units
    array([0.  , 1.82, 3.05])
    >>> granchain.open("demo").trajectory.frames  # later, or on another machine
    1921
"""

from typing import TYPE_CHECKING, Any

from lammps_inputs import plugins
from workflow import lazy_names

if TYPE_CHECKING:
    from lammps_inputs import InputError as InputError
    from lammps_inputs import Scene as Scene
    from lammps_inputs.materials import CATALOGUE as materials  # noqa: N811  no constant to those who read it
    from lammps_inputs.materials import Solid as Solid
    from workflow.errors import RunError as RunError
    from workflow.inputs import load as load
    from workflow.inputs import trace_file as trace_file
    from workflow.interface.analyses import analyze as analyze
    from workflow.interface.analyses import universe as universe
    from workflow.interface.analyses import validate as validate
    from workflow.interface.runs import Run as Run
    from workflow.interface.runs import deck as deck
    from workflow.interface.runs import open as open
    from workflow.interface.runs import resume as resume
    from workflow.interface.runs import run as run
    from workflow.interface.sweeps import NotebookFigure as NotebookFigure
    from workflow.interface.sweeps import collect as collect
    from workflow.interface.sweeps import plot as plot
    from workflow.interface.sweeps import statistics as statistics
    from workflow.interface.sweeps import sweep as sweep
    from workflow.sweep.collect import SweepTable as SweepTable
    from workflow.sweep.statistics import Group as Group
    from workflow.verdicts.analyse import Analysis as Analysis
    from workflow.verdicts.analysis_report import WavesTable as WavesTable
    from workflow.verdicts.validate import Validation as Validation

    __version__: str

    def __getattr__(name: str) -> Any:
        """Function that a plug-in declares; its types are those of the module that defines it."""

else:
    _SOURCES = lazy_names.sources(__file__)

    def __getattr__(name: str) -> Any:
        """Name of this module, function that an installed distribution adds, or the version; looked up when used."""
        if name in _SOURCES:
            return globals().setdefault(name, lazy_names.imported(*_SOURCES[name]))
        if name in plugins.declared("functions"):
            return plugins.load("functions", name)
        if name == "__version__":
            from importlib.metadata import version

            return version("granchain")
        raise AttributeError(f"module 'granchain' has no attribute {name!r}")


__all__ = [
    "Analysis",
    "Group",
    "InputError",
    "NotebookFigure",
    "Run",
    "RunError",
    "Scene",
    "Solid",
    "SweepTable",
    "Validation",
    "WavesTable",
    "analyze",
    "collect",
    "deck",
    "load",
    "materials",
    "open",
    "plot",
    "resume",
    "run",
    "statistics",
    "sweep",
    "trace_file",
    "universe",
    "validate",
]


def __dir__() -> list[str]:
    return sorted([*__all__, *plugins.declared("functions"), "__version__"])
