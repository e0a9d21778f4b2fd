"""LAMMPS: `engine` starts it in a process of its own, `worker` is that process, and has what every state must satisfy."""
