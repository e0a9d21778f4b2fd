"""What a cluster is asked: its queue, how many ranks are worth while, the options that both come with.

The job script itself is text, and in `lammps_inputs.slurm`.
"""
