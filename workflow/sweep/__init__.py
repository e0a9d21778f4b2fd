"""Sweeps: a scene and lists or ranges of its fields -> one run directory per case, computed on all cores.

`file` is what a user writes and the cases that follow, `fields` the dotted paths in a scene, `directory` the directory
of a case and its computation, `carry_out` the sweep itself; `on_cluster` writes it for Slurm, `collect` gathers the
cases into one table.
"""
