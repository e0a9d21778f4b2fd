"""Scenes that do something best: `file.py` (what a user writes; fields and how a search moves them), `evaluator.py`
(designs on all cores, each once), `search.py`, `manufacture.py` (manufacturing tolerances), `found.py` (the result),
`study.py` (all of it, with LAMMPS for the best), `report.py` (the page).
"""
