"""Scenes that do something best: `file.py` (what a user writes), `variables.py` (fields and how a search moves them),
`measures.py` (quantities of a scene), `evaluator.py` (designs on all cores, each once), `search.py`, `manufacture.py`
(manufacturing tolerances), `study.py` (all of it, with LAMMPS for the best), `found.py` (the result), `report.py` (the
page).
"""
