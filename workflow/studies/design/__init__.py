"""Scenes that do something best: `file.py` (what a user writes), `variables.py` (fields and how a search moves them),
`measures.py` (what is known of a scene), `memory.py` (all that was computed), `crew.py` (processes), `search.py`,
`manufacture.py` (what small errors do), `study.py` (all of it, with LAMMPS for the best), `found.py` (what it found),
`report.py` (the page).
"""
