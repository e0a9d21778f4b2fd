"""Sweeps: a scene and lists or ranges of its fields -> one run directory per case, computed on all cores.

`file` is what a user writes, `fields` the dotted paths in a scene, `cases` the scenes that follow and their names,
`directory` what a case's directory holds, `pool` the processes, `worker` one of them, `carry_out` the sweep
itself; `on_cluster` writes it for Slurm, `collect` gathers the cases into one `table`. `command_job` writes a study's
command as a job on one node.
"""
