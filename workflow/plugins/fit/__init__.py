"""Unknown fields of a scene from measured traces: `model.py` (the traces of a scene, by what is free, and residuals),
`sensors.py` (gains and baselines of signals), `estimate.py` (least squares and their uncertainty), `goodness.py` (test
of fit), `result.py` (what an estimate means), `study.py` (all of it, with a run of LAMMPS at the end).
"""
