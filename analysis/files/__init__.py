"""Files that hold a run: LAMMPS's binary dumps, tables of a user's own, lists of collisions.

Which number stands where, and what is wrong with a file; no physics.
"""
