"""Names of the files that a run is given and leaves: of the deck, and of what continues from a restart.

Imports nothing: who only looks at directories need not load what a scene may be.

Examples:
    >>> file_names.SCENE, file_names.DECK, file_names.DUMP
    ('scene.yaml', 'in.chains', 'chains.dump.bin')
"""

SCENE = "scene.yaml"

DECK = "in.chains"
DATA = "data.chains"
TABLES = "in.tables"
"""Long tables of forces over time, which the deck includes."""
DUMP = "chains.dump.bin"
LOG = "log.lammps"

CONTINUE = "in.continue"
RESTART = "chains.restart"
RESTART_SUMS = "chains.restart.sha256"
UNFINISHED = "chains.restart.part"
"""A restart while it is written."""

CASES = "cases.txt"
"""Directories of the cases of a sweep that is computed elsewhere, one or several a line."""
