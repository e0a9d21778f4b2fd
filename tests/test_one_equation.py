"""The equation of motion stands once: only laws and ingredients know what a force is."""

import io
import re
import tokenize
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
ALLOWED = ("lammps_inputs/laws/", "lammps_inputs/ingredients/", "lammps_inputs/formulas/")
EXCEPT = {
    "analysis/shape/exact_wave.py": "its own theory, for any exponent",
    "lammps_inputs/chains.py": "the plain chain, whose contacts are Hertz's unless a scene says otherwise",
    "lammps_inputs/limits/solids.py": "where that one law ends",
    "workflow/plugins/gallery/entries/breathers.py": "the exact periodic state of one bead, to compare with",
    "workflow/plugins/gallery/entries/impacts.py": "the exact impact of two spheres, to compare with",
    "analysis/compare/common_times.py": "how an interpolation errs where a contact opens",
    "workflow/plugins/adopt/deck_text.py": "reads decks of others",
    "workflow/plugins/adopt/measure.py": "measures forces that LAMMPS computes in decks of others",
    "workflow/plugins/adopt/scene_of.py": "names the commands of decks of others",
}
FORCES = re.compile(r"laws ?\. ?hertz|Hertz ?\(|gran/hertz|bond_style|bond_coeff|pair_style|spring/self|\*\* ?1\.5\b")


def code(source: str) -> str:
    """A source without comments and docstrings."""
    kept, previous = [], tokenize.NEWLINE
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        docstring = token.type == tokenize.STRING and previous in (tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT)
        if token.type != tokenize.COMMENT and not docstring:
            kept.append(token.string)
        if token.type not in (tokenize.NL, tokenize.COMMENT):
            previous = token.type
    return " ".join(kept)


def files():
    for floor in ("lammps_inputs", "analysis", "workflow"):
        for path in sorted((ROOT / floor).rglob("*.py")):
            name = path.relative_to(ROOT).as_posix()
            if not name.startswith(ALLOWED) and name not in EXCEPT:
                yield name


@pytest.mark.slow
def test_no_module_but_laws_and_ingredients_names_a_force():
    found = {name: FORCES.findall(code((ROOT / name).read_text(encoding="utf-8"))) for name in files()}
    assert {name: forces for name, forces in found.items() if forces} == {}
    assert FORCES.search(code('lines = ["pair_style gran/hertz/history 1"]'))
