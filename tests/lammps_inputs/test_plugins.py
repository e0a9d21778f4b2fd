"""Parts that distributions declare as entry points: which there are, in which order, and what is refused."""

from dataclasses import dataclass
from importlib.metadata import EntryPoint, EntryPoints

import pytest

from lammps_inputs import InputError, plugins
from lammps_inputs.ingredients import registry


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


def test_studies_may_be_absent(monkeypatch):
    assert declare(monkeypatch)("studies") == {}


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


def test_what_a_distribution_declares_as_an_ingredient_is_refused_unless_it_is_a_class_of_one(monkeypatch):
    monkeypatch.setattr(plugins, "declared", lambda kind: {"bed": point("bed", "math:pi", "other")})  # noqa: ARG005
    with pytest.raises(InputError, match=r"^granchain\.ingredients: bed = math:pi should be a key of a scene and a"):
        registry._of_distributions()


def test_a_part_that_no_installed_distribution_declares_is_refused_by_its_name(monkeypatch):
    monkeypatch.setattr(plugins, "declared", lambda kind: {})  # noqa: ARG005
    with pytest.raises(InputError, match=r"^view: no installed distribution declares it as one of granchain.fun"):
        plugins.load("functions", "view")
