"""LAMMPS: `engine` starts it in a process of its own, `worker` is that process, `checks` are what it must pass."""
