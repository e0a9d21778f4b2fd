"""Laws of the compiled step where there is no link: its parameters are 0 there."""

import numpy as np
import pytest
from ingredient_scenes import CASES, TIED

from granchain import InputError
from lammps_inputs import library
from workflow.engines.reference.kernel_inputs import make_terms

STRAINS = np.array([-3.0, -1e-3, -1e-320, 0.0, 1e-320, 1e-3, 3.0])
INNER = {"resonators": {"mass": 0.3, "stiffness": 0.5}}
LAWS = {
    "pole": CASES["magnets"],
    "root": {"contact": {"force": "A*s*sqrt(d+s)", "A": 1.0, "d": 2.5}},
    "formula of contacts": {"contact": {"force": "A*s^p", "A": 1.0, "p": 2.2}},
    "formulas of springs in some rows": {
        "coupling": {"force": "k*s/sqrt(b^2-s^2)", "k": 0.3, "b": 2.0, "rows": [2, 5]},
        "foundation": {"force": "k*tan(s)", "k": 0.3, "rows": [2, 5]},
    },
    "exponent 2.5, pressed": {"contact": {"exponent": 2.5}, "precompression": {"force": 0.02}},
    "exponent 1.2": {"contact": {"exponent": 1.2}},
    "exponents": {"contact": {"exponent": [1.5, 2.0, 3.0, 1.7, 1.5, 1.5, 1.5]}},
    "walls of exponent 3": CASES["walls of exponent 3, gap"],
    "pressed": CASES["pressed between walls"],
    "spheres": {},
}


def system_of(changes):
    """System of a case, with resonators where it does not exclude them."""
    keys = {"name": "test", "chains": 2, "beads": 8, "coupling": TIED, "kick": {"velocity": 1.0}, "duration": 12.0}
    try:
        return library.from_plain({**keys, **changes, **INNER}, "test").problem().system
    except InputError:
        return library.from_plain({**keys, **changes}, "test").problem().system


def functions_of(term):
    """Force and slope of a term's law as the compiled step has them, of a strain and parameters."""
    for function in ("force", "stiffness"):
        if term.law.source is not None:
            names = {"np": np}
            exec(term.law.source("called", function), names)
            yield names["called"]
        else:
            yield getattr(term.law, function)


def parameters_without_link(term, values, places):
    """Parameters, [case, parameter], of a term at places where it is no link: its first parameter is 0."""
    columns = [np.broadcast_to(values[text.partition("[")[0]], places) for text in term.parameters]
    return np.unique([row for row in np.array(columns).T if row[0] == 0.0], axis=0)


SLOW = {name for name, keys in LAWS.items() if "force': '" in str(keys)} - {"formula of contacts"}
"""Sympy derives each formula."""


@pytest.mark.parametrize("name", [pytest.param(name, marks=pytest.mark.slow if name in SLOW else ()) for name in LAWS])
@np.errstate(all="ignore")
def test_absent_links_have_neither_force_nor_slope_at_any_strain(name):
    system = system_of(LAWS[name])
    terms, values = make_terms(system, as_lammps=False, step=0.0)
    by_name = dict(zip(terms.names, values, strict=True))
    places = (system.beads + 2) * int(by_name[terms.row])
    absent = 0
    for term in (*terms.contacts, *terms.across, *terms.ground, *terms.walls):
        for parameters in parameters_without_link(term, by_name, places):
            absent += 1
            for function in functions_of(term):
                results = [function(strain, *parameters) for strain in STRAINS]
                assert not np.any(results), (term.law.__name__, results)
    assert absent > 0
