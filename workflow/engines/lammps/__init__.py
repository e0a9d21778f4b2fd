"""LAMMPS: `engine` starts it in a process of its own, `worker` is that process and tests every state of the run."""
