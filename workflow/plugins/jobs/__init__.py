"""Jobs that run decks on a cluster, as text: what a site asks for, the script, arrays of decks.

`schedulers` is the table of what differs between Slurm, PBS Professional and Grid Engine. Whoever asks a queue, or
counts ranks, is in `workflow`.
"""
