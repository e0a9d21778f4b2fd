"""What `granchain help` prints is the scene reference, section by section."""

import re

import pytest

from lammps_inputs import library, references
from lammps_inputs.ingredients.registry import INGREDIENTS
from workflow.plugins.help import handbook


def test_keys_symbols_and_terms_are_explained_and_what_is_none_is_not(golden):
    asked = {handbook.of_key: ("coupling.stiffness.from", "gap"), handbook.of_term: ("V", "T", "kappa", "row")}
    golden("explanations", "\n\n".join(explain(word) for explain, words in asked.items() for word in words))
    assert handbook.of_key("coupling.rows") == handbook.of_key("coupling")
    assert [handbook.of_term(word) for word in ("agree_1", "dimers")] == [None] * 2
    assert [handbook.of_key(word) for word in ("no_such", "", "a b", "gap`", ".", "[1]")] == [None] * 6


MODELS = ("gap", "material", "kinds", "taper", "disorder", "striker", "kick", *INGREDIENTS)


@pytest.mark.parametrize("key", MODELS)
def test_the_section_of_a_model_has_example_exclusions_spelling_sources_and_a_picture(key):
    section = next(section for names, section in handbook.sections() if key in names)
    (example,) = re.findall(r"```yaml\n(.*?)```", section, re.S)
    assert len(example.splitlines()) <= 6
    assert all(re.search(rf"^{word}:", section, re.M) for word in ("Excluded", "LAMMPS", "Source"))
    assert "Installed scene" in section
    assert "![" in section
    assert "![" not in handbook.of_key(key)
    assert " = " in section, "no equation"
    cited = re.search(r"<!-- sources: (.*) -->", section)[1].split()
    own = INGREDIENTS[key].sources if key in INGREDIENTS else (references.UNEQUAL.get(key, cited[0]),)
    assert set(own) <= set(cited)


EXAMPLES = {
    "\n".join(chosen)
    for block in re.findall(r"```yaml\n(.*?)```", handbook.page(), re.S)
    for chosen in (
        [line for line in block.splitlines() if not line.startswith("# ")],
        *([line.removeprefix("# ")] for line in block.splitlines() if line.startswith("# ")),
    )
}


@pytest.mark.parametrize("example", sorted(EXAMPLES))
def test_examples_are_valid_scenes(example, tmp_path):
    (tmp_path / "hammer.csv").write_text("0, 0\n1, 0.5\n2, 0\n", encoding="utf-8")
    (tmp_path / "shaker.csv").write_text("time,velocity\n0, 0\n1, 0.5\n", encoding="utf-8")
    (tmp_path / "scene.yaml").write_text(example, encoding="utf-8")
    has = set(re.findall(r"[\w.]+", example))
    base = {"name": "example", "chains": 3 if "ring" in has else 2, "beads": 1000 if "990]" in example else 120}
    base |= {"until_bead": 60} | ({} if has & {"striker", "drive"} else {"kick": {"velocity": 1}})
    steel = {"radius": 4.76e-3, "density": 8e3, "youngs_modulus": 2e11, "poisson_ratio": 0.3}
    base |= {"material": steel} if "9.81" in has else {}
    base |= {"walls": {"left": "bead", "right": "bead"}} if "between walls" in example else {}
    scene = base | library.load_plain(tmp_path / "scene.yaml")
    assert library.from_plain(scene, "SCENES.md").beads


@pytest.mark.parametrize("key", INGREDIENTS)
def test_the_class_of_an_ingredient_tells_its_keys_and_which_are_required(key):
    text = handbook.of_ingredient(f"{key}.any")
    fields = INGREDIENTS[key].model_fields
    assert [line.strip() for line in text.splitlines() if line.strip() in fields][-len(fields) :] == list(fields)
    assert text.count("default: required") == sum(field.is_required() for field in fields.values())
    assert handbook.of_ingredient("beads") is None
