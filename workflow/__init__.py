"""What is done: engines run scenes, and the command line runs, analyses, compares and reports.

Builds on `analysis` and `lammps_inputs`.
"""
