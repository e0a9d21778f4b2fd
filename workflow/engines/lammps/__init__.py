"""LAMMPS: `engine` starts it in a process of its own, `worker` is that process, `invariants` are what it must pass."""
