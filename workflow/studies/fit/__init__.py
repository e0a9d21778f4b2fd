"""Unknown fields of a scene from measured traces: `fields.py` (what is free), `model.py` (the traces of a scene),
`estimate.py` (least squares and their uncertainty), `goodness.py` (test of fit), `study.py` (all of it, with a run of
LAMMPS at the end).
"""
