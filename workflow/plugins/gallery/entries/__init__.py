"""The entries, in the order of the page. A new one is an `Entry` in the module of its subject, and a line here."""

from workflow.plugins.gallery.entries import (
    alternating,
    breathers,
    foundations,
    impacts,
    loaded,
    losses,
    nonuniform,
    paper_gapped,
    paper_touching,
    periodic,
    reflections,
    solitary_waves,
)
from workflow.plugins.gallery.entry import Entry

GROUPS = {"paper": ("paper-touching", "paper-gapped")}
"""Name of a group -> its entries."""

ENTRIES: dict[str, Entry] = {
    "paper-touching": paper_touching.ENTRY,
    "paper-gapped": paper_gapped.ENTRY,
    "kicked-chain": solitary_waves.KICKED_CHAIN,
    "nesterenko": solitary_waves.NESTERENKO,
    "exact-wave": solitary_waves.EXACT_WAVE,
    "collision": reflections.COLLISION,
    "two-spheres": impacts.TWO_SPHERES,
    "rigid-plane": impacts.PLANE,
    "impact-restitution": impacts.RESTITUTION,
    "striker-trains": solitary_waves.STRIKER_TRAINS,
    "dimers": alternating.DIMERS,
    "dimer-resonance": alternating.DIMER_RESONANCE,
    "tapered": nonuniform.TAPERED,
    "graded": nonuniform.GRADED,
    "plastic": losses.PLASTIC,
    "decorated": alternating.DECORATED,
    "impurity": nonuniform.IMPURITY,
    "wall": reflections.WALL,
    "beats": foundations.BEATS,
    "parametric": foundations.PARAMETRIC,
    "landau-zener": foundations.LANDAU_ZENER,
    "rosas": losses.ROSAS,
    "kuwabara-kono": losses.KUWABARA_KONO,
    "precompressed": loaded.PRECOMPRESSED,
    "band-gap": loaded.BAND_GAP,
    "resonators": loaded.RESONATORS,
    "gravity": loaded.GRAVITY,
    "rectifier": periodic.RECTIFIER,
    "dark-breathers": breathers.DARK_BREATHERS,
    "gap-breathers": breathers.GAP_BREATHERS,
    "mode-beats": periodic.MODE_BEATS,
}
