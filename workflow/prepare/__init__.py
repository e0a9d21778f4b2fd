"""What is found before a run, by trying: time step, duration, width of the window. `settings` asks for all of them.

Nothing is written here. What follows from a scene without a trial is in `lammps_inputs.limits`.
"""
