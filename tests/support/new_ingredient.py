"""Write what a new ingredient owes beside its code: ``python tests/support/new_ingredient.py NAME``.

NAME is the key of an ingredient that is declared in ``pyproject.toml``, with an `example` and `sources`. It gets a
section of SCENES.md, an installed scene, a place in the gallery, a picture and a case of `test_every_ingredient.py`,
each a skeleton whose texts say FILL; what remains to be done is printed. Nothing is written if a skeleton exists.
"""

import sys
from pathlib import Path

import yaml
from key_tables import PAGES, renewed

from lammps_inputs.ingredients.registry import INGREDIENTS

ROOT = Path(__file__).resolve().parents[2]

FILL = "FILL"
"""Word that stands where a text is missing; `test_manual.py` finds it."""

SECTION = """## {name}

FILL: what it models, in one sentence, with its equation: F = FILL.

<!-- keys: {model} -->
<!-- end -->

```yaml
{name}: {example}
```

Excluded:

- FILL

LAMMPS:

- FILL

Installed scene: `{name}`.

![{name}](../.github/gallery/{name}.png)

<!-- sources: {sources} -->
<!-- end -->

"""

SCENE = """# yaml-language-server: $schema=../templates/scene.schema.json
# FILL: what is to be seen, and in which figure: granchain run {name} -o out && granchain analyze out
name: {name}
description: FILL, in half a line
chains: 2
beads: 60
coupling: {{stiffness: 0.1}}
{name}: {example}
kick: {{velocity: 1}}
duration: 60
"""

REMAINS = """remains:
  each FILL in lammps_inputs/SCENES.md, lammps_inputs/GALLERY.md and lammps_inputs/scenes/{name}.yaml
  the exact motion, where its force is new, in tests/support/scene_keys.py; more cases in ingredient_scenes.py there
  the units of its keys: `in_units` of tests/support/ingredient_scenes.py
  python tests/support/gallery.py gallery/{name}     # draws the picture; its figure is a word of PICTURES there
  granchain schema > lammps_inputs/templates/scene.schema.json
  python -m workflow.plugins.gallery.sources         # its line in MODEL.md
  pytest -m '' tests/lammps_inputs tests/test_readme.py tests/test_manual.py
  pytest -m '' tests/test_every_ingredient.py -k '{name}'"""


def before(page: str, mark: str, text: str) -> str:
    """A page with a text before the first line that begins with a mark."""
    head, found, rest = page.partition(f"\n{mark}")
    if not found:
        raise ValueError(f"no line begins with {mark!r}")
    return f"{head}\n{text}{mark}{rest}"


def pages(name: str) -> dict[str, str]:
    """File -> its content with the skeletons of an ingredient."""
    ingredient = INGREDIENTS[name]
    words = {"name": name, "model": ingredient.__name__, "example": ingredient.example}
    section = SECTION.format(**words, sources=" ".join(ingredient.sources))
    manual = (ROOT / "lammps_inputs" / PAGES[0]).read_text(encoding="utf-8")
    gallery = (ROOT / "lammps_inputs" / "GALLERY.md").read_text(encoding="utf-8")
    pictures = (ROOT / "tests/support/gallery.py").read_text(encoding="utf-8")
    cases = (ROOT / "tests/support/ingredient_scenes.py").read_text(encoding="utf-8")
    case = f'    "{name}": {{"{name}": {yaml.safe_load(ingredient.example)!r}}},\n'
    cell = f"| ![{name}](../.github/gallery/{name}.png) `{name}`: FILL | | |\n"
    return {
        f"lammps_inputs/{PAGES[0]}": renewed(before(manual, "# Time and output", section)),
        f"lammps_inputs/scenes/{name}.yaml": SCENE.format(**words),
        "lammps_inputs/GALLERY.md": before(gallery, "\nAnd ", cell),
        "tests/support/gallery.py": before(
            pictures, '}\n"""File in', f'    "gallery/{name}": ("{name}", "spacetime"),\n'
        ),
        "tests/support/ingredient_scenes.py": before(cases, '    "one chain"', case),
    }


def main(name: str) -> int:
    """Write the skeletons; exit code."""
    if name not in INGREDIENTS:
        print(f"{name}: no declared ingredient; first its class and its entry point in pyproject.toml", file=sys.stderr)
        return 2
    for attribute in ("example", "sources"):
        if not vars(INGREDIENTS[name]).get(attribute):
            print(f"{name}: its class has no `{attribute}`", file=sys.stderr)
            return 2
    if (ROOT / "lammps_inputs" / "scenes" / f"{name}.yaml").exists():
        print(f"lammps_inputs/scenes/{name}.yaml: exists", file=sys.stderr)
        return 2
    for file, text in pages(name).items():
        (ROOT / file).write_text(text, encoding="utf-8")
        print("written:", file)
    print(REMAINS.format(name=name))
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
