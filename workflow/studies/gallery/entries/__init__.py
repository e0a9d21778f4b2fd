"""The entries, in the order of the page: a name and what builds its section. A new one is a file and a line here."""

from collections.abc import Callable
from pathlib import Path

from workflow.studies.gallery.entries import (
    beats,
    collision,
    decorated,
    dimer_resonance,
    dimers,
    exact_wave,
    impurity,
    kicked_chain,
    nesterenko,
    striker_trains,
    tapered,
    wall,
)
from workflow.studies.kept_runs import Say
from workflow.studies.page import Section
from workflow.studies.reproduce import section2, section3

ENTRIES: dict[str, Callable[[Path, Say], Section]] = {
    "paper-touching": section2.build,
    "paper-gapped": section3.build,
    "kicked-chain": kicked_chain.ENTRY.build,
    "nesterenko": nesterenko.ENTRY.build,
    "exact-wave": exact_wave.ENTRY.build,
    "collision": collision.ENTRY.build,
    "striker-trains": striker_trains.ENTRY.build,
    "dimers": dimers.ENTRY.build,
    "dimer-resonance": dimer_resonance.ENTRY.build,
    "tapered": tapered.ENTRY.build,
    "decorated": decorated.ENTRY.build,
    "impurity": impurity.ENTRY.build,
    "wall": wall.ENTRY.build,
    "beats": beats.ENTRY.build,
}
