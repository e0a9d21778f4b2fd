"""Scenes that minimise or maximise a quantity.

`file.py`: the design file; fields and how a search changes them. `search.py`: the search, on all cores, each design
once. `result.py`: the result; manufacturing tolerances. `study.py`: the study, with LAMMPS for the best. `report.py`:
the page.
"""
