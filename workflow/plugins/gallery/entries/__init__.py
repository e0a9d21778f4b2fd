"""The entries, in the order of the page. A new one is an `Entry` in the module of its subject, and a line here."""

from importlib.util import find_spec

from workflow.plugins.gallery.entries import (
    alternating,
    foundations,
    impacts,
    losses,
    nonuniform,
    open_touching,
    paper_touching,
    rectifier,
    reflections,
    solitary_waves,
)
from workflow.plugins.gallery.entry import Entry

GROUPS = {
    "paper": ("paper-touching", "paper-gapped"),
    "paper-open": (
        "open-multipliers",
        "open-map",
        "open-map-fine",
        "open-more-chains",
        "open-modes",
        "open-arrays",
        "open-robust",
    ),
}
"""Name of a group -> its entries."""

LONG = frozenset(GROUPS["paper-open"])
"""Entries that take minutes each: run where they or their group are named, or with ``--all``."""

LONGEST = frozenset({"open-map-fine"})
"""Entries that take an hour: run where they are named, or with ``--all``."""

OF_RIGID_BEADS: dict[str, Entry] = {}
OF_SOUND: dict[str, Entry] = {}
OF_MODES: dict[str, Entry] = {}
"""Entries that other plug-ins compute, where they are installed."""

if find_spec("workflow.plugins.rigid"):
    from workflow.plugins.gallery.entries import open_gapped, paper_gapped

    OF_RIGID_BEADS = {
        "paper-gapped": paper_gapped.ENTRY,
        "open-multipliers": open_gapped.MULTIPLIERS,
        "open-map": open_gapped.MAP,
        "open-map-fine": open_gapped.FINE_MAP,
        "open-more-chains": open_gapped.MORE_CHAINS,
    }
if find_spec("workflow.plugins.sound"):
    from workflow.plugins.gallery.entries import loaded

    OF_SOUND = {
        "precompressed": loaded.PRECOMPRESSED,
        "band-gap": loaded.BAND_GAP,
        "resonators": loaded.RESONATORS,
        "gravity": loaded.GRAVITY,
    }
if find_spec("workflow.plugins.modes"):
    from workflow.plugins.gallery.entries import breathers, mode_beats

    OF_MODES = {
        "dark-breathers": breathers.DARK_BREATHERS,
        "gap-breathers": breathers.GAP_BREATHERS,
        "mode-beats": mode_beats.MODE_BEATS,
    }

ENTRIES: dict[str, Entry] = {
    "paper-touching": paper_touching.ENTRY,
    **OF_RIGID_BEADS,
    "open-modes": open_touching.MODES_ENTRY,
    "open-arrays": open_touching.ARRAYS,
    "open-robust": open_touching.ROBUST,
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
    **OF_SOUND,
    "rectifier": rectifier.RECTIFIER,
    **OF_MODES,
}
