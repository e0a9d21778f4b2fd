"""Parts that distributions declare as entry points: which there are, in which order, and what is refused."""

from dataclasses import dataclass
from importlib.metadata import EntryPoint, EntryPoints

import pytest

from lammps_inputs import InputError, plugins


@dataclass(frozen=True)
class Distribution:
    """What `importlib.metadata` says of a distribution."""

    name: str


def point(name, value, distribution):
    return EntryPoint(name, value, "granchain.ingredients")._for(Distribution(distribution))


def declare(monkeypatch, *points):
    monkeypatch.setattr(plugins, "_all_points", lambda: EntryPoints(points))
    return plugins.declared.__wrapped__


def test_parts_of_granchain_come_first_and_those_of_others_by_name(monkeypatch):
    others = point("a", "x:A", "zeta"), point("c", "x:C", "alpha")
    declared = declare(monkeypatch, *others, point("b", "y:B", "granchain"))
    assert list(declared("ingredients")) == ["b", "c", "a"]


def test_an_installation_without_what_is_needed_is_refused_with_what_to_do(monkeypatch):
    with pytest.raises(InputError, match=r"its installation declares no ingredients; install it again: `pip install"):
        declare(monkeypatch, point("a", "x:A", "other"))("ingredients")


def test_a_name_that_two_distributions_declare_is_refused_with_both(monkeypatch):
    declared = declare(monkeypatch, point("a", "x:A", "granchain"), point("a", "y:A", "other"))
    with pytest.raises(InputError, match=r"'a' is declared twice .*: x:A of granchain and y:A of other; uninstall one"):
        declared("ingredients")


def test_a_part_of_another_distribution_that_cannot_be_imported_is_named(monkeypatch):
    broken = point("a", "no_such_module:A", "other")
    monkeypatch.setattr(plugins, "declared", lambda kind: {"a": broken})  # noqa: ARG005
    with pytest.raises(InputError, match=r"other: no_such_module:A, declared as 'a' of granchain\.studies, cannot be"):
        plugins.load("studies", "a")
