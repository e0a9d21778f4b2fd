"""Parts that installed distributions declare as entry points: ingredients, materials, scenes, quantities, commands.

Those of granchain itself are declared in its ``pyproject.toml`` like those of anybody else:

- ``granchain.ingredients``: key of a scene = class derived from `lammps_inputs.ingredients.Ingredient`;
- ``granchain.contacts``: name of a law of contacts = class derived from `lammps_inputs.ingredients.contact.Contact`,
  which keys of ``contact`` choose; the first is that of no such key;
- ``granchain.laws``: key of ingredients that names a law, ``force`` = module that makes laws of it;
- ``granchain.starts``: ``run`` = function from the directory of a run to the keys of an initial state;
- ``granchain.materials``: any name = dictionary from names to `lammps_inputs.materials.Solid`;
- ``granchain.scenes``: any name = package in whose folder scenes stand as ``*.yaml``;
- ``granchain.engines``: place in lists, and name = instance of `workflow.runs.engines.Engine`;
- ``granchain.quantities``: place in the printed analysis, and name = class derived from
  `workflow.measures.measurement.Measurement`;
- ``granchain.studies``: command = module with ``add_arguments``, ``execute`` and ``EXAMPLES``; also, where they apply,
  the literals ``JOB`` (its heading in ``granchain --help``) and ``PRINTS`` (it makes nothing but what it prints);
- ``granchain.tools``: command that is no study of many runs = such a module;
- ``granchain.options.COMMAND``: any name = module or object that adds options to a command: ``add_arguments(parser)``,
  ``EXAMPLES``, and ``execute(arguments, command)``, where ``command(arguments)`` does what the command does without
  these options. An extension acts before it, in place of it, or after it; several wrap one another, the last outermost.
  ``ANSWERS``, if there is one, says what the extension adds to ``--json``;
- ``granchain.functions``: name in the module ``granchain`` = function for scripts and notebooks, as of a study;
- ``granchain.queues``: any name = module that knows jobs: their queue, and the states of their directories
  (`workflow.runs.status`);
- ``granchain.limits``: any name = function that returns the name of a file, and `lammps_inputs.output.Limits` of runs
  on this machine that it sets;
- ``granchain.gradients``: any name = function from an analysis to one with derivatives, as
  `workflow.plugins.derivatives.gradient.with_derivatives`;
- ``granchain.schedulers``: name for ``--scheduler`` = `workflow.plugins.jobs.schedulers.Scheduler`;
- ``granchain.schemas``: what `granchain schema` prints = function without arguments.

Examples:
    >>> "contact" in plugins.declared("ingredients")
    True
    >>> plugins.load("engines", "02-reference").title
    'the reference integrator'
    >>> plugins.provider("engines", "02-reference")  # empty for granchain
    ''
"""

import functools
from importlib.metadata import EntryPoint, entry_points
from typing import Any

from lammps_inputs.errors import InputError

DISTRIBUTION = "granchain"
"""Distribution whose parts come first."""

NEEDED = ("ingredients", "contacts", "materials", "scenes", "engines", "quantities")
"""Kinds without which nothing works; studies and tools may be absent."""


@functools.cache
def _all_points() -> Any:
    """Entry points of all distributions, to `select` from; looking through these takes some ten milliseconds."""
    return entry_points()


@functools.cache
def declared(kind: str) -> dict[str, EntryPoint]:
    """Name -> entry point of one kind, such as ``studies``: granchain's, then those of others, each sorted by name.

    Raises:
        InputError: granchain is not installed, or two distributions declare the same name.
    """
    points = sorted(_all_points().select(group=f"granchain.{kind}"), key=lambda point: (_provider(point), point.name))
    if kind in NEEDED and not any(_provider(point) == "" for point in points):
        raise InputError(
            f"granchain: its installation declares no {kind}; install it again: `pip install -e .` in its sources, or "
            "`pip install --force-reinstall --no-deps granchain`"
        )
    by_name: dict[str, EntryPoint] = {}
    for point in points:
        earlier = by_name.setdefault(point.name, point)
        if earlier.value != point.value:
            raise InputError(
                f"{point.name!r} is declared twice as one of granchain.{kind}: {earlier.value} of "
                f"{_provider(earlier) or DISTRIBUTION} and {point.value} of {_provider(point) or DISTRIBUTION}; "
                "uninstall one of them"
            )
    return by_name


def provider(kind: str, name: str) -> str:
    """Name of the distribution that declares an entry point; empty for granchain."""
    return _provider(declared(kind)[name])


def load(kind: str, name: str) -> Any:
    """Object that an entry point names.

    Raises:
        InputError: none is installed, or it cannot be imported; says which distribution declares it.
    """
    point = declared(kind).get(name)
    if point is None:
        raise InputError(f"{name}: no installed distribution declares it as one of granchain.{kind}")
    try:
        return point.load()
    except (Exception, SystemExit) as error:
        if _provider(point) == "":
            raise
        raise InputError(
            f"{_provider(point)}: {point.value}, declared as {name!r} of granchain.{kind}, cannot be imported "
            f"({type(error).__name__}: {error}); mend or uninstall it"
        ) from error


def loaded(kind: str) -> dict[str, Any]:
    """Name -> what its entry point names, in the order of `declared`.

    Raises:
        InputError: see `declared` and `load`.
    """
    return {name: load(kind, name) for name in declared(kind)}


def needed(kind: str, option: str) -> Any:
    """What the first entry point of a kind names.

    Args:
        kind: such as ``gradients``.
        option: what needs it, as users call it.

    Raises:
        InputError: nothing of this kind is installed; see also `load`.
    """
    for plug_in in loaded(kind).values():
        return plug_in
    raise InputError(f"{option}: needs a plug-in that declares granchain.{kind}, and none is installed")


def _provider(point: EntryPoint) -> str:
    """Name of the distribution that declares an entry point; empty for granchain, which sorts first."""
    name = "" if point.dist is None else point.dist.name
    return "" if name == DISTRIBUTION else name
