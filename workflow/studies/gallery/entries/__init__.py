"""The entries, in the order of the page. A new one is a file with an `ENTRY`, and its name here."""

from importlib import import_module

from workflow.studies.gallery.entry import Entry

PAPER = ("paper-touching", "paper-gapped")

NAMES = (
    *PAPER,
    "kicked-chain",
    "nesterenko",
    "exact-wave",
    "collision",
    "striker-trains",
    "dimers",
    "dimer-resonance",
    "tapered",
    "graded",
    "plastic",
    "decorated",
    "impurity",
    "wall",
    "beats",
    "parametric",
    "landau-zener",
    "rosas",
    "kuwabara-kono",
    "precompressed",
    "band-gap",
    "resonators",
    "gravity",
)

ENTRIES: dict[str, Entry] = {name: import_module(f"{__name__}.{name.replace('-', '_')}").ENTRY for name in NAMES}
