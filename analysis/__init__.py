"""What came out: trajectories, their energy and momentum, the waves in them, and their pictures.

Builds on `lammps_inputs` only. Starts no process and knows no engine.
"""
