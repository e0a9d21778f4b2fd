"""The files that LAMMPS reads: a deck from the start, and one that continues from a restart.

The lines themselves belong to what they say: of laws and ingredients, of the scheme and of the window. Nothing here
runs LAMMPS; that is `workflow.engines.lammps`.
"""
