"""Scenes that do something best: `file.py` (what a user writes; fields and how a search moves them), `search.py`
(designs on all cores, each once), `result.py` (the result; manufacturing tolerances), `study.py` (all of it, with
LAMMPS for the best), `report.py` (the page).
"""
