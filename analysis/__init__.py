"""Trajectories, their energy and momentum, the waves in them, and figures.

Builds on `lammps_inputs` only. Starts no process and depends on no engine.
"""
